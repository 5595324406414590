//! Contact coupled over stochastic nodes: against collocation where the nodes decouple, and against the full system.

mod square;

use faer::Mat;
use faer::prelude::Solve;
use proptest::prelude::*;
use square::square;
use steklov_contact::proptest::{Friction, mixed, ordinary};
use steklov_contact::{ContactNode, Outcome, Problem, Solution, interior_point, kkt};
use steklov_stochastic::{
    CellBasis, CondensedOutcome, Nodes, StochasticError, StochasticMesh, TensorProblem, TensorSolution, Variable,
    solve_outcome, tensor_active_set, tensor_uzawa,
};

fn basis(degree: usize, nodes: Nodes) -> CellBasis {
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[1], &[degree]).unwrap();
    mesh.basis(0, nodes).unwrap()
}

/// A tensor problem that owns its parts.
#[derive(Debug, Clone)]
struct Owned {
    stiffness: Mat<f64>,
    mass: Mat<f64>,
    weights: Vec<f64>,
    load: Mat<f64>,
    nodes: Vec<Vec<ContactNode>>,
}

impl Owned {
    fn view(&self) -> TensorProblem<'_> {
        let Self { stiffness, mass, weights, load, nodes } = self;
        TensorProblem { stiffness, mass, weights, load, nodes }
    }

    /// M_E ⊗ S with all conditions, those of stochastic node j with weights times D_j.
    fn full(&self) -> Problem {
        let (m, nodes) = (self.stiffness.nrows(), self.weights.len());
        let stiffness =
            Mat::from_fn(m * nodes, m * nodes, |a, b| self.mass[(a / m, b / m)] * self.stiffness[(a % m, b % m)]);
        let load = (0..m * nodes).map(|a| self.load[(a % m, a / m)]).collect();
        let mut all = Vec::new();
        for (j, own) in self.nodes.iter().enumerate() {
            for mut node in own.iter().cloned() {
                node.first += j * m;
                for c in &mut node.conditions {
                    c.normal_weight *= self.weights[j];
                    c.tangent_weight *= self.weights[j];
                }
                all.push(node);
            }
        }
        Problem { stiffness, load, nodes: all }
    }

    /// Checks equilibrium and every condition; `size` is that of displacements, `tolerance` relative.
    fn judge(&self, solution: &TensorSolution, size: f64, tolerance: f64) -> Result<(), TestCaseError> {
        let full = self.full();
        let (displacement, multipliers) = (all(solution), solution.multipliers.concat());
        let judged = Solution::new(&full, displacement, multipliers, solution.outcome, vec![]);
        let stiffness = (0..full.load.len()).map(|i| full.stiffness[(i, i)]).fold(0.0, f64::max);
        let conditions = full.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)));
        for ((node, c), [normal, shear]) in conditions.zip(&judged.multipliers) {
            let w = node.pick(&judged.displacement);
            // displacement that a multiplier prevents; a force per displacement makes them comparable
            let press = |lambda: f64| c.normal_weight * lambda / stiffness;
            let small = tolerance * size;
            prop_assert!(c.opening(w) > -small && press(*normal) > -small, "{c:?} {w:?} {normal} {shear}");
            prop_assert!(c.opening(w).min(press(*normal)) < small, "{c:?} {w:?} {normal} {shear}");
            let (limit, slip) = (c.limit(*normal), c.slip(w));
            prop_assert!(press(shear.abs()) < press(limit) + small, "{c:?} {w:?} {normal} {shear}");
            prop_assert!(
                slip.abs() < small || press(limit - shear * slip.signum()) < small,
                "{c:?} {w:?} {normal} {shear}"
            );
        }
        prop_assert!(kkt(&full, &judged).equilibrium < tolerance);
        Ok(())
    }
}

fn column(solution: &TensorSolution, j: usize) -> &[f64] {
    solution.displacement.col_as_slice(j)
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// Largest difference of displacements over the largest one.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = largest(a).max(largest(b));
    let difference = a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    if scale == 0.0 { 0.0 } else { difference / scale }
}

fn all(solution: &TensorSolution) -> Vec<f64> {
    (0..solution.displacement.ncols()).flat_map(|j| column(solution, j).to_vec()).collect()
}

/// The square with the modulus at the nodes of a basis; load and conditions are those of all nodes.
fn of_square(basis: &CellBasis, modulus: &dyn Fn(&[f64]) -> f64, gap: f64, bound: f64) -> Owned {
    let square = square(8, [0.3, -1.0]);
    let weights = basis.weights.clone();
    let load = Mat::from_fn(square.load.len(), weights.len(), |i, j| square.load[i] * weights[j]);
    let nodes = vec![square.nodes(gap, bound); weights.len()];
    Owned { stiffness: square.stiffness, mass: basis.mass(modulus).unwrap(), weights, load, nodes }
}

fn affine(y: &[f64]) -> f64 {
    2000.0 + 200.0 * y[0]
}

fn exponential(y: &[f64]) -> f64 {
    2000.0 * (0.3 * y[0]).exp()
}

#[test]
fn at_gauss_points_with_an_affine_modulus_it_is_collocation() {
    for (gap, bound) in [(1.0, 0.0), (2e-4, 0.0), (2e-4, 0.35), (0.0, 0.35), (-1e-4, f64::INFINITY)] {
        for degree in [0, 3, 7] {
            let basis = basis(degree, Nodes::Gauss);
            let owned = of_square(&basis, &affine, gap, bound);
            let solution = tensor_active_set(&owned.view()).unwrap();
            assert_eq!(solution.outcome, Outcome::Converged);
            for (j, point) in basis.points.iter().enumerate() {
                let load = owned.load.col_as_slice(j).iter().map(|f| f / basis.weights[j]).collect();
                let outcome = CondensedOutcome { modulus: affine(point), load, nodes: owned.nodes[j].clone() };
                let single = solve_outcome(&owned.stiffness, outcome, &mut None).unwrap();
                let u = apart(column(&solution, j), &single.displacement);
                let lambda = apart(solution.multipliers[j].as_flattened(), single.multipliers.as_flattened());
                println!("{gap} {bound} {degree} {u:e} {lambda:e}");
                assert!(u < 1e-12 && lambda < 1e-12, "gap {gap}, bound {bound}, degree {degree}: {u:e}, {lambda:e}");
            }
        }
    }
}

fn agree(owned: &Owned) -> Result<(), TestCaseError> {
    let full = owned.full();
    let reference = interior_point(&full).unwrap();
    prop_assert!(reference.converged());
    let load = Mat::from_fn(full.load.len(), 1, |i, _| full.load[i]);
    let free = full.stiffness.partial_piv_lu().solve(&load);
    let gaps = full.nodes.iter().flat_map(|n| &n.conditions).fold(0.0f64, |m, c| m.max(c.gap.abs()));
    let size = largest(free.col_as_slice(0)) + gaps;
    for solution in [tensor_uzawa(&owned.view(), None).unwrap(), tensor_active_set(&owned.view()).unwrap()] {
        prop_assert_eq!(solution.outcome, Outcome::Converged, "{:?}", solution.history);
        let difference =
            all(&solution).iter().zip(&reference.displacement).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        prop_assert!(difference < 1e-9 * size, "{difference:e} of {size:e} after {:?}", solution.history);
        owned.judge(&solution, size, 1e-9)?;
    }
    Ok(())
}

/// A random problem, with gaps, bounds and loads that vary from one stochastic node to the other.
fn coupled(problem: impl Strategy<Value = Problem>) -> impl Strategy<Value = Owned> {
    let changes = prop::collection::vec(-1.0..1.0f64, 64);
    (problem, 0usize..5, any::<bool>(), -1.5..1.5f64, changes).prop_map(|(problem, degree, lobatto, slope, changes)| {
        let basis = basis(degree, if lobatto { Nodes::Lobatto } else { Nodes::Gauss });
        let mut change = changes.iter().cycle();
        let mut next = || change.next().expect("endless");
        let size = largest(&problem.load);
        let load = Mat::from_fn(problem.load.len(), basis.points.len(), |i, j| {
            basis.weights[j] * (problem.load[i] + 0.3 * size * next())
        });
        let mut nodes = vec![problem.nodes; basis.points.len()];
        for c in nodes.iter_mut().flatten().flat_map(|n| &mut n.conditions) {
            c.gap += 0.2 * next();
            c.bound *= 1.0 + 0.9 * next();
        }
        let mass = basis.mass(&|y| (slope * y[0]).exp()).unwrap();
        Owned { stiffness: problem.stiffness, mass, weights: basis.weights, load, nodes }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn tresca(owned in coupled(ordinary(6, Friction::Tresca))) { agree(&owned)?; }

    #[test]
    fn stick(owned in coupled(ordinary(6, Friction::Stick))) { agree(&owned)?; }

    #[test]
    fn tresca_with_corners(owned in coupled(mixed(5, Friction::Tresca))) { agree(&owned)?; }

    #[test]
    fn without_friction(owned in coupled(mixed(5, Friction::None))) { agree(&owned)?; }

    #[test]
    fn coulomb(owned in coupled(ordinary(6, Friction::Coulomb(0.2)))) { agree(&owned)?; }
}

//! Contact coupled over stochastic nodes: against collocation where the nodes decouple, and against the full system.

use crate::square::{ground, solve_outcome, square};
use faer::Mat;
use proptest::prelude::*;
use steklov_algebra::Lu;
use steklov_contact::proptest::{Friction, mixed, ordinary};
use steklov_contact::{ContactNode, Outcome, Problem, Solution, interior_point, kkt};
use steklov_stochastic::{
    CellBasis, Nodes, StochasticError, StochasticMesh, TensorProblem, TensorSolution, Variable, tensor_active_set,
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
        Problem { stiffness: stiffness.into(), load, nodes: all }
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
                let problem =
                    Problem { stiffness: owned.stiffness.clone().into(), load, nodes: owned.nodes[j].clone() };
                let single = solve_outcome(problem, affine(point), &mut None).unwrap();
                let u = apart(column(&solution, j), &single.displacement);
                let lambda = apart(solution.multipliers[j].as_flattened(), single.multipliers.as_flattened());
                // 1e-14 but for the condition number of S
                assert!(u < 5e-14 && lambda < 1e-14, "gap {gap}, bound {bound}, degree {degree}: {u:e}, {lambda:e}");
            }
        }
    }
}

/// A spring in two directions and no contact: the linear problem of four unknowns.
fn linear(basis: &CellBasis, modulus: &dyn Fn(&[f64]) -> f64) -> Owned {
    let rows = [[4.0, -1.0, 0.0, 0.3], [-1.0, 5.0, -2.0, 0.0], [0.0, -2.0, 6.0, -1.0], [0.3, 0.0, -1.0, 3.0]];
    let load = [1.0, 2.0, -1.0, 0.5];
    let nodes = ground(1, 1.0, 0.0);
    let weights = basis.weights.clone();
    Owned {
        stiffness: Mat::from_fn(4, 4, |i, j| rows[i][j]),
        mass: basis.mass(modulus).unwrap(),
        load: Mat::from_fn(4, weights.len(), |i, j| load[i] * weights[j]),
        nodes: vec![nodes; weights.len()],
        weights,
    }
}

#[test]
fn lobatto_nodes_have_the_same_solution_without_contact_and_lumping_another() {
    let [gauss, lobatto] = [Nodes::Gauss, Nodes::Lobatto].map(|nodes| basis(3, nodes));
    let [a, b] = [&gauss, &lobatto].map(|basis| tensor_active_set(&linear(basis, &affine).view()).unwrap());
    let mut theta = vec![0.0; 4];
    for (j, point) in gauss.points.iter().enumerate() {
        lobatto.evaluate(point, &mut theta);
        let at: Vec<f64> = (0..4).map(|i| (0..4).map(|k| theta[k] * b.displacement[(i, k)]).sum()).collect();
        assert!(apart(column(&a, j), &at) < 1e-14);
    }
    // collocation at Lobatto nodes is S⁻¹ f/E there; so is Galerkin's method at Gauss nodes
    let [difference, scale] = [1.0, 0.0].map(|share| {
        let single =
            |j: usize, i: usize| a.displacement[(i, 0)] * affine(&gauss.points[0]) / affine(&lobatto.points[j]);
        let entries = (0..16).map(|k| (k / 4, k % 4));
        entries.map(|(j, i)| (b.displacement[(i, j)] - share * single(j, i)).abs()).fold(0.0, f64::max)
    });
    assert!((difference / scale - 2.305508725e-5).abs() < 1e-13, "{:e}", difference / scale);
}

#[test]
fn a_modulus_that_is_not_affine_couples_and_agrees_with_the_full_system() {
    for nodes in [Nodes::Gauss, Nodes::Lobatto] {
        for (gap, bound) in [(1.0, 0.0), (2e-4, 0.35), (0.0, 0.35), (-1e-4, f64::INFINITY)] {
            let owned = of_square(&basis(3, nodes), &exponential, gap, bound);
            agree(&owned).unwrap();
        }
    }
    // it is not collocation
    let basis = basis(3, Nodes::Gauss);
    let coupled = tensor_active_set(&linear(&basis, &exponential).view()).unwrap();
    let single = |j: usize, i: usize| {
        let affine = tensor_active_set(&linear(&basis, &affine).view()).unwrap();
        affine.displacement[(i, j)] * self::affine(&basis.points[j]) / exponential(&basis.points[j])
    };
    let worst = (0..4).map(|j| (coupled.displacement[(0, j)] / single(j, 0) - 1.0).abs()).fold(0.0, f64::max);
    assert!((1e-6..1e-2).contains(&worst), "{worst:e}");
}

#[test]
fn nodes_of_tiny_weights_are_solved_as_well_as_the_others() {
    // weights of the normal density down to 1e-19
    let mesh = StochasticMesh::uniform(vec![Variable::normal(0.0, 1.0).unwrap()], &[1], &[30]).unwrap();
    let basis = mesh.basis(0, Nodes::Gauss).unwrap();
    assert!(basis.weights.iter().any(|w| *w < 1e-18));
    let mut owned = of_square(&basis, &|y| 2000.0 + 20.0 * y[0], 2e-4, 0.35);
    // the exact one: integrated, it has the rounding errors of the other nodes
    let diagonal = |j: usize| basis.weights[j] * (2000.0 + 20.0 * basis.points[j][0]);
    owned.mass = Mat::from_fn(31, 31, |j, k| if j == k { diagonal(j) } else { 0.0 });
    let solution = tensor_active_set(&owned.view()).unwrap();
    assert_eq!(solution.outcome, Outcome::Converged);
    for (j, point) in basis.points.iter().enumerate() {
        let load = owned.load.col_as_slice(j).iter().map(|f| f / basis.weights[j]).collect();
        let problem = Problem { stiffness: owned.stiffness.clone().into(), load, nodes: owned.nodes[j].clone() };
        let single = solve_outcome(problem, 2000.0 + 20.0 * point[0], &mut None).unwrap();
        let lambda = apart(solution.multipliers[j].as_flattened(), single.multipliers.as_flattened());
        assert!(lambda < 1e-12, "weight {:e}: {lambda:e}", basis.weights[j]);
    }
}

#[test]
fn nothing_moves_without_load_and_a_body_that_is_apart_is_free() {
    let basis = basis(3, Nodes::Gauss);
    let mut owned = of_square(&basis, &exponential, 0.0, 0.35);
    owned.load *= faer::Scale(0.0);
    let solution = tensor_active_set(&owned.view()).unwrap();
    assert_eq!(solution.outcome, Outcome::Converged);
    assert!(
        solution.displacement.norm_max() == 0.0 && solution.multipliers.concat().iter().flatten().all(|l| *l == 0.0)
    );
    let owned = of_square(&basis, &exponential, 1.0, 0.0);
    let free =
        Lu::new(owned.mass.as_ref()).solve(Lu::new(owned.stiffness.as_ref()).solve(owned.load.as_ref()).transpose());
    let solution = tensor_active_set(&owned.view()).unwrap();
    assert!((&solution.displacement - free.transpose()).norm_max() < 1e-13 * free.norm_max());
    assert!(solution.multipliers.concat().iter().flatten().all(|l| *l == 0.0));
}

#[test]
fn refused_is_what_cannot_be_solved() {
    let good = of_square(&basis(2, Nodes::Gauss), &exponential, 2e-4, 0.35);
    let refusal = |change: &dyn Fn(&mut Owned)| {
        let mut owned = good.clone();
        change(&mut owned);
        tensor_active_set(&owned.view()).unwrap_err()
    };
    let floating = refusal(&|o| o.stiffness = Mat::from_fn(18, 18, |i, j| if i == j && i > 0 { 1.0 } else { 0.0 }));
    assert!(matches!(floating, StochasticError::NotCoercive { smallest: 0.0, .. }));
    let singular = refusal(&|o| o.mass = Mat::from_fn(3, 3, |_, _| 1.0));
    assert!(matches!(singular, StochasticError::NotCoercive { .. }), "{singular}");
    let negative = refusal(&|o| o.weights[1] = -0.1);
    assert!(matches!(negative, StochasticError::Number { value: -0.1, .. }));
    let inconsistent: [&dyn Fn(&mut Owned); 7] = [
        &|o| o.nodes[1][3].conditions[0].normal_weight *= 2.0,
        &|o| o.nodes[2].truncate(8),
        &|o| o.mass[(0, 1)] += 1.0,
        &|o| o.mass[(0, 1)] = f64::NAN,
        &|o| o.load = Mat::zeros(18, 2),
        &|o| o.weights.truncate(2),
        &|o| {
            o.nodes
                .iter_mut()
                .flatten()
                .flat_map(|n| &mut n.conditions)
                .for_each(|c| (c.normal_weight, c.tangent_weight) = (0.0, 0.0))
        },
    ];
    for (i, change) in inconsistent.into_iter().enumerate() {
        let error = refusal(change);
        let contact = matches!(error, StochasticError::Contact(_)) && i == 1;
        assert!(contact || matches!(error, StochasticError::Inconsistent { .. }), "{i}: {error}");
    }
    let numbers: [&dyn Fn(&mut Owned); 3] =
        [&|o| o.load[(3, 1)] = f64::NAN, &|o| o.nodes[1][0].conditions[0].gap = f64::INFINITY, &|o| {
            o.nodes[1][0].conditions[0].bound = -1.0
        }];
    for change in numbers {
        assert!(matches!(refusal(change), StochasticError::Contact(_)));
    }
}

/// Unknowns whose compliance falls with their distance, and three germs; time and steps are printed.
#[test]
fn a_hundred_multipliers_at_64_nodes_take_a_few_steps() {
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap(); 3], &[1; 3], &[3; 3]).unwrap();
    let basis = mesh.basis(0, Nodes::Gauss).unwrap();
    let distance = |i: usize, j: usize| (i / 2).abs_diff(j / 2) as f64 / 50.0;
    let compliance = Mat::from_fn(100, 100, |i, j| if i % 2 == j % 2 { (-distance(i, j) / 0.3).exp() } else { 0.0 });
    let identity = Mat::from_fn(100, 100, |i, j| if i == j { 1.0 } else { 0.0 });
    let inverse = Lu::new(compliance.as_ref()).solve(identity.as_ref());
    let stiffness = Mat::from_fn(100, 100, |i, j| 0.5 * (inverse[(i, j)] + inverse[(j, i)]));
    let push = |i: usize| [0.1, 0.01 - 0.03 * (i as f64 / 100.0)][i % 2];
    let load = Mat::from_fn(100, 64, |i, j| basis.weights[j] * push(i) * (1.0 + 0.1 * basis.points[j][2]));
    let nodes = ground(49, 0.02, 0.5);
    let mass = basis.mass(&|y| (0.3 * y[0] + 0.2 * y[1] + 0.1 * y[2]).exp()).unwrap();
    let owned = Owned { stiffness, mass, nodes: vec![nodes; 64], load, weights: basis.weights };
    let clock = std::time::Instant::now();
    let active = tensor_active_set(&owned.view()).unwrap();
    let taken = clock.elapsed();
    println!("{} steps, {taken:?}", active.iterations);
    let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let [one, two] = [1, 2].map(|threads| pool(threads).install(|| tensor_active_set(&owned.view()).unwrap()));
    assert!(all(&one) == all(&two) && one.multipliers == two.multipliers);
    assert!(active.outcome == Outcome::Converged && active.iterations < 20);
    let touching = active.multipliers.concat().iter().filter(|l| l[0] > 0.0).count();
    assert!(touching > 0 && touching < 3200, "{touching}");
}

fn agree(owned: &Owned) -> Result<(), TestCaseError> {
    let full = owned.full();
    let reference = interior_point(&full).unwrap();
    prop_assert!(reference.converged());
    let load = Mat::from_fn(full.load.len(), 1, |i, _| full.load[i]);
    let free = Lu::new((*full.stiffness.full()).as_ref()).solve(load.as_ref());
    let gaps = full.nodes.iter().flat_map(|n| &n.conditions).fold(0.0f64, |m, c| m.max(c.gap.abs()));
    let size = largest(free.col_as_slice(0)) + gaps;
    let active = tensor_active_set(&owned.view()).unwrap();
    prop_assert_eq!(active.outcome, Outcome::Converged, "{:?}", active.history);
    let difference = all(&active).iter().zip(&reference.displacement).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    prop_assert!(difference < 1e-9 * size, "{difference:e} of {size:e} after {:?}", active.history);
    owned.judge(&active, size, 1e-9)
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
        Owned { stiffness: problem.stiffness.full().into_owned(), mass, weights: basis.weights, load, nodes }
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

    /// Next to a held end the tangential multiplier acts over more length than the normal one, or over less.
    #[test]
    fn coulomb_where_friction_and_pressure_have_different_weights(
        owned in coupled(ordinary(6, Friction::Coulomb(0.2))), shares in prop::collection::vec(0.4..2.0f64, 6),
    ) {
        let mut owned = owned;
        for node in &mut owned.nodes {
            for (c, share) in node.iter_mut().flat_map(|n| &mut n.conditions).zip(&shares) {
                c.tangent_weight = share * c.normal_weight;
            }
        }
        agree(&owned)?;
    }
}

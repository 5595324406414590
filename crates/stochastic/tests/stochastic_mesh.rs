//! Meshes of germs and the bases of their cells.

use faer::Mat;
use proptest::prelude::*;
use steklov_algebra::Lu;
use steklov_stochastic::{CellBasis, Distribution, Nodes, StochasticCell, StochasticError, StochasticMesh, Variable};

fn standard(degree: usize, nodes: Nodes) -> CellBasis {
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[1], &[degree]).unwrap();
    mesh.basis(0, nodes).unwrap()
}

fn off_diagonal(m: &Mat<f64>) -> f64 {
    let mut worst = 0.0f64;
    for i in 0..m.nrows() {
        for j in (0..m.ncols()).filter(|&j| j != i) {
            worst = worst.max(m[(i, j)].abs());
        }
    }
    worst
}

fn largest(m: &Mat<f64>) -> f64 {
    (0..m.nrows()).map(|i| m[(i, i)].abs()).fold(off_diagonal(m), f64::max)
}

#[test]
fn an_affine_modulus_decouples_gauss_nodes_and_couples_lobatto_nodes() {
    let modulus = |y: &[f64]| 2000.0 + 200.0 * y[0];
    let gauss = standard(3, Nodes::Gauss);
    let mass = gauss.mass(&modulus).unwrap();
    assert!(off_diagonal(&mass) < 1e-14 * largest(&mass), "{:e}", off_diagonal(&mass));
    for j in 0..4 {
        let wanted = gauss.weights[j] * modulus(&gauss.points[j]);
        assert!((mass[(j, j)] / wanted - 1.0).abs() < 1e-14);
    }
    let lobatto = standard(3, Nodes::Lobatto);
    let mass = lobatto.mass(&modulus).unwrap();
    let share = off_diagonal(&mass) / largest(&mass);
    assert!((share - 0.1606785314).abs() < 1e-10, "{share}");
    for (d, wanted) in lobatto.weights.iter().zip([1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0]) {
        assert!((d - wanted).abs() < 1e-15);
    }
    // a modulus that is not affine couples Gauss nodes as well, a little
    let mass = gauss.mass(&|y| 2000.0 * (0.3 * y[0]).exp()).unwrap();
    let share = off_diagonal(&mass) / largest(&mass);
    assert!((share - 0.003994806795).abs() < 1e-12, "{share}");
}

#[test]
fn galerkin_with_lobatto_nodes_is_collocation_at_gauss_points_and_lumping_is_not() {
    // E(y) u(y) = 1: ∫ θ_j E u ρ = ∫ θ_j ρ
    let modulus = |y: &[f64]| 2000.0 + 200.0 * y[0];
    let (gauss, lobatto) = (standard(3, Nodes::Gauss), standard(3, Nodes::Lobatto));
    let load = Mat::from_fn(4, 1, |j, _| lobatto.weights[j]);
    let galerkin = Lu::new(lobatto.mass(&modulus).unwrap().as_ref()).solve(load.as_ref());
    let mut theta = [0.0; 4];
    for point in &gauss.points {
        lobatto.evaluate(point, &mut theta);
        let u: f64 = (0..4).map(|j| theta[j] * galerkin[(j, 0)]).sum();
        assert!((u * modulus(point) - 1.0).abs() < 3e-15);
    }
    let apart = |j: usize| (galerkin[(j, 0)] - 1.0 / modulus(&lobatto.points[j])).abs();
    let share = (0..4).map(apart).fold(0.0, f64::max) / (0..4).map(|j| galerkin[(j, 0)]).fold(0.0, f64::max);
    assert!((share - 2.305508725e-5).abs() < 1e-13, "{share:e}");
}

#[test]
fn mass_matrices_are_exact_for_moduli_of_degree_thirteen_and_no_higher() {
    for nodes in [Nodes::Gauss, Nodes::Lobatto] {
        let basis = standard(2, nodes);
        for k in 0..=16 {
            let mass = basis.mass(&|y| y[0].powi(k)).unwrap();
            let sum: f64 = (0..9).map(|i| mass[(i / 3, i % 3)]).sum();
            let wanted = if k % 2 == 0 { 1.0 / f64::from(k + 1) } else { 0.0 };
            assert!((sum - wanted).abs() < 1e-15);
            // x² x² y^k: the highest degree that the products reach
            let top: f64 =
                (0..9).map(|i| (basis.points[i / 3][0] * basis.points[i % 3][0]).powi(2) * mass[(i / 3, i % 3)]).sum();
            let wanted = if k % 2 == 0 { 1.0 / f64::from(k + 5) } else { 0.0 };
            assert_eq!((top - wanted).abs() < 1e-15, k <= 13 || k % 2 == 1, "{k}: {:e}", top - wanted);
        }
    }
}

#[test]
fn mass_matrices_of_unbounded_cells_keep_their_digits() {
    let v = Variable::normal(0.0, 1.0).unwrap();
    for q in [1, 5, 20, 30] {
        let mesh = StochasticMesh::uniform(vec![v.clone()], &[4], &[q]).unwrap();
        for cell in 0..4 {
            let basis = mesh.basis(cell, Nodes::Gauss).unwrap();
            let mass = basis.mass(&|_| 1.0).unwrap();
            for i in 0..=q {
                for j in 0..=q {
                    let wanted = if i == j { basis.weights[j] } else { 0.0 };
                    // relative to what Schwarz allows: weights go down to 1e-33
                    let error = (mass[(i, j)] - wanted).abs() / (basis.weights[i] * basis.weights[j]).sqrt();
                    assert!(error < 1e-12, "q {q}, cell {cell}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn degree_zero_is_the_mean_for_both_kinds_of_nodes() {
    let v = Variable::new(Distribution::Normal { mean: 1.0, deviation: 2.0 }, 0.0, 2.5).unwrap();
    let mesh = StochasticMesh::uniform(vec![v.clone()], &[1], &[0]).unwrap();
    for nodes in [Nodes::Gauss, Nodes::Lobatto] {
        let basis = mesh.basis(0, nodes).unwrap();
        assert_eq!((basis.points.len(), basis.weights.len()), (1, 1));
        assert!((basis.points[0][0] - v.mean()).abs() < 1e-15 && (basis.weights[0] - 1.0).abs() < 1e-15);
        let mut one = [0.0];
        basis.evaluate(&[0.3], &mut one);
        assert_eq!(one, [1.0]);
    }
}

fn four() -> Vec<Variable> {
    vec![
        Variable::uniform(1800.0, 2200.0).unwrap(),
        Variable::normal(-1.0, 0.2).unwrap(),
        Variable::lognormal(200e9, 30e9).unwrap(),
        Variable::beta(2.0, 0.5, -3.0, 1.0).unwrap(),
    ]
}

#[test]
fn cells_of_equal_probability_fill_the_support() {
    let mesh = StochasticMesh::uniform(four(), &[2, 3, 1, 2], &[1, 0, 2, 1]).unwrap();
    assert_eq!(mesh.cells.len(), 12);
    for cell in 0..12 {
        assert!((mesh.probability(cell) * 12.0 - 1.0).abs() < 1e-13);
        let basis = mesh.basis(cell, Nodes::Gauss).unwrap();
        assert_eq!(basis.points.len(), 12);
        assert!((basis.weights.iter().sum::<f64>() * 12.0 - 1.0).abs() < 1e-12);
        assert!(basis.points.iter().all(|p| mesh.locate(p) == Some(cell)));
    }
    // last direction fastest, equal widths for the uniform variable
    assert_eq!(mesh.cells[0].bounds[0], [1800.0, 2000.0]);
    assert_eq!(mesh.cells[0].bounds[3][1], mesh.cells[1].bounds[3][0]);
    assert_eq!(mesh.locate(&[1700.0, 0.0, 26.0, 0.0]), None);
}

#[test]
fn splits_keep_the_probability_and_raises_the_other_directions() {
    let mut mesh = StochasticMesh::uniform(four(), &[1, 1, 1, 1], &[1, 1, 1, 1]).unwrap();
    assert_eq!(mesh.split(0, 1, -0.9).unwrap(), 1);
    assert_eq!(mesh.split(1, 0, 1850.0).unwrap(), 2);
    mesh.raise(2, 3).unwrap();
    assert_eq!((&mesh.cells[1].degree, &mesh.cells[2].degree), (&vec![1, 1, 1, 1], &vec![1, 1, 1, 2]));
    assert_eq!(mesh.cells[0].bounds[1], [f64::NEG_INFINITY, -0.9]);
    assert_eq!(mesh.cells[2].bounds[..2], [[1850.0, 2200.0], [-0.9, f64::INFINITY]]);
    assert!(((0..3).map(|c| mesh.probability(c)).sum::<f64>() - 1.0).abs() < 1e-14);
    assert_eq!(mesh.locate(&[1900.0, -0.5, 26.0, 0.0]), Some(2));

    let before = mesh.clone();
    assert!(mesh.split(0, 1, -0.9).is_err() && mesh.split(0, 1, f64::NAN).is_err() && mesh.split(0, 7, 0.0).is_err());
    assert!(mesh.split(9, 0, 1900.0).is_err() && mesh.raise(0, 4).is_err() && mesh.raise(9, 0).is_err());
    assert!(matches!(mesh.split(1, 1, 20.0), Err(StochasticError::NoProbability { .. })));
    assert_eq!(mesh, before, "a refused change leaves the mesh as it was");
    assert!(mesh.basis(9, Nodes::Gauss).is_err());
    assert!(matches!(mesh.basis(0, Nodes::Lobatto), Err(StochasticError::Number { .. })), "an infinite end");
}

#[test]
fn refused_are_meshes_of_wrong_or_too_large_sizes() {
    let make = |elements: &[usize], degree: &[usize]| StochasticMesh::uniform(four(), elements, degree);
    assert!(matches!(make(&[1, 1, 1], &[1; 4]), Err(StochasticError::Inconsistent { .. })));
    assert!(matches!(make(&[1, 1, 1, 0], &[1; 4]), Err(StochasticError::Number { .. })));
    assert!(matches!(make(&[1000; 4], &[1; 4]), Err(StochasticError::Number { .. })));
    let mesh = make(&[1; 4], &[usize::MAX / 2; 4]).unwrap();
    assert!(matches!(mesh.basis(0, Nodes::Gauss), Err(StochasticError::Number { .. })));
    let one = StochasticMesh::uniform(vec![Variable::uniform(0.0, 1.0).unwrap()], &[1], &[250]).unwrap();
    assert!(matches!(one.basis(0, Nodes::Gauss), Err(StochasticError::Number { .. })));
    let wrong = StochasticCell { bounds: vec![[0.0, 1.0]], degree: vec![] };
    assert!(CellBasis::new(&one.variables, &wrong, Nodes::Gauss).is_err());
    // nothing random: one cell, one node
    let certain = StochasticMesh::uniform(vec![], &[], &[]).unwrap();
    let basis = certain.basis(0, Nodes::Lobatto).unwrap();
    assert_eq!((basis.points, basis.weights), (vec![vec![]], vec![1.0]));
}

proptest! {
    #[test]
    fn bases_reproduce_their_polynomials(
        q in (0usize..5, 0usize..5, 0usize..4),
        lobatto in any::<bool>(),
        at in (0.001..0.999f64, 0.001..0.999f64, 0.001..0.999f64),
    ) {
        let variables = vec![
            Variable::uniform(1800.0, 2200.0).unwrap(),
            Variable::new(Distribution::Normal { mean: 1.0, deviation: 0.5 }, 0.2, 3.0).unwrap(),
            Variable::beta(2.0, 0.5, -3.0, 1.0).unwrap(),
        ];
        let degree = [q.0, q.1, q.2];
        let mesh = StochasticMesh::uniform(variables, &[1, 2, 1], &degree).unwrap();
        let basis = mesh.basis(1, if lobatto { Nodes::Lobatto } else { Nodes::Gauss }).unwrap();
        let f = |y: &[f64]| {
            let power = |d: usize, x: f64| x.powi(degree[d] as i32) + 0.5;
            power(0, (y[0] - 1900.0) / 200.0) * power(1, y[1]) * power(2, y[2])
        };
        let values: Vec<f64> = basis.points.iter().map(|y| f(y)).collect();
        let bounds = &mesh.cells[1].bounds;
        let germ: Vec<f64> = bounds.iter().zip([at.0, at.1, at.2]).map(|([a, b], s)| a + s * (b - a)).collect();
        let mut theta = vec![0.0; values.len()];
        basis.evaluate(&germ, &mut theta);
        let size = values.iter().fold(f(&germ).abs(), |m, v| m.max(v.abs()));
        let got: f64 = theta.iter().zip(&values).map(|(t, v)| t * v).sum();
        prop_assert!((got - f(&germ)).abs() < 1e-12 * size);
        prop_assert!((theta.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // nodes
        basis.evaluate(&basis.points[values.len() / 2].clone(), &mut theta);
        for (j, t) in theta.iter().enumerate() {
            prop_assert_eq!(*t, if j == values.len() / 2 { 1.0 } else { 0.0 });
        }
        // Parseval: the coefficients have the second moment, u·M u over the probability
        let mass = basis.mass(&|_| 1.0).unwrap();
        let n = values.len();
        let energy: f64 = (0..n * n).map(|i| values[i / n] * mass[(i / n, i % n)] * values[i % n]).sum();
        let squares: f64 = basis.coefficients(&values).iter().map(|c| c * c).sum();
        prop_assert!((squares / (energy / mesh.probability(1)) - 1.0).abs() < 1e-11, "{squares} {energy}");
    }
}

#[test]
fn coefficients_are_those_of_the_orthonormal_polynomials() {
    let variables = vec![Variable::uniform(-1.0, 1.0).unwrap(), Variable::normal(0.0, 1.0).unwrap()];
    let mesh = StochasticMesh::uniform(variables, &[1, 1], &[2, 3]).unwrap();
    let basis = mesh.basis(0, Nodes::Gauss).unwrap();
    // 3 p_0 p_1 + 2 p_2 p_0 with P_2 = (3x²-1)/2, p_2 = √5 P_2
    let f = |x: f64, y: f64| 3.0 * y + 2.0 * 5f64.sqrt() * 0.5 * (3.0 * x * x - 1.0);
    let values: Vec<f64> = basis.points.iter().map(|y| f(y[0], y[1])).collect();
    for (i, c) in basis.coefficients(&values).iter().enumerate() {
        let wanted = [(1, 3.0), (8, 2.0)].iter().find(|(at, _)| *at == i).map_or(0.0, |(_, c)| *c);
        assert!((c - wanted).abs() < 1e-14, "{i}: {c}");
    }
}

/// Legendre's polynomials are √(2k+1) at the end, Hermite's x and (x² - 1)/√2, and what they are beyond the degree is an error's.
#[test]
fn the_next_polynomial_is_that_of_the_next_degree() {
    for q in 0..6 {
        let basis = standard(q, Nodes::Gauss);
        assert!((basis.next_polynomial(0, 1.0) - (2.0 * q as f64 + 3.0).sqrt()).abs() < 1e-13);
        // the nodes are its zeros
        for x in &basis.points {
            let zero = basis.next_polynomial(0, x[0]);
            assert!(zero.abs() < 1e-13, "{zero}");
        }
    }
    let mesh = StochasticMesh::uniform(vec![Variable::normal(1.0, 2.0).unwrap()], &[1], &[1]).unwrap();
    let hermite = mesh.basis(0, Nodes::Gauss).unwrap().next_polynomial(0, 1.0 + 2.0 * 3.0);
    assert!((hermite - 8.0 / 2.0f64.sqrt()).abs() < 1e-13, "{hermite}");
}

#[test]
fn ends_of_cells_are_finite_and_leave_out_what_is_rare() {
    let variables = vec![Variable::uniform(-1.0, 3.0).unwrap(), Variable::normal(0.0, 1.0).unwrap()];
    let mesh = StochasticMesh::uniform(variables.clone(), &[1, 2], &[1, 1]).unwrap();
    for (cell, unbounded) in [(0, 0), (1, 1)] {
        let ends = mesh.ends(cell, 1e-4);
        assert_eq!(ends[0], [-1.0, 3.0]);
        assert_eq!(ends[1][1 - unbounded], mesh.cells[cell].bounds[1][1 - unbounded]);
        let rest = variables[1].probability([ends[1][0], ends[1][1]]);
        assert!((rest - 0.5 * (1.0 - 1e-4)).abs() < 1e-14, "{rest}");
    }
}

//! Estimates of the truncation of polynomials in germs, and refinement by them.

use steklov_stochastic::{CellBasis, DirectionError, Nodes, StochasticMesh, Variable, changes, refine, truncation};

fn square(u: &[f64]) -> f64 {
    u.iter().map(|u| u * u).sum()
}

fn one_germ(degree: usize) -> CellBasis {
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[1], &[degree]).unwrap();
    mesh.basis(0, Nodes::Gauss).unwrap()
}

fn at_nodes(basis: &CellBasis, u: &dyn Fn(f64) -> f64) -> Vec<Vec<f64>> {
    basis.points.iter().map(|p| vec![u(p[0])]).collect()
}

/// Estimate and truth of the error of interpolation at the Gauss points.
fn judged(degree: usize, u: &dyn Fn(f64) -> f64) -> (DirectionError, f64) {
    let basis = one_germ(degree);
    let answers = at_nodes(&basis, u);
    let estimate = truncation(&basis, &answers, &square)[0];
    // panels, so that a kink costs little
    let mesh = StochasticMesh::uniform(vec![Variable::uniform(-1.0, 1.0).unwrap()], &[64], &[15]).unwrap();
    let mut theta = vec![0.0; degree + 1];
    let mut truth = 0.0;
    for cell in 0..64 {
        let fine = mesh.basis(cell, Nodes::Gauss).unwrap();
        for (point, weight) in fine.points.iter().zip(&fine.weights) {
            basis.evaluate(point, &mut theta);
            let value: f64 = theta.iter().zip(&answers).map(|(t, a)| t * a[0]).sum();
            truth += weight * (value - u(point[0])).powi(2);
        }
    }
    (estimate, truth.sqrt())
}

#[test]
fn print_figures() {
    let cases: [(&str, &dyn Fn(f64) -> f64); 7] = [
        ("1/(1+.1y)", &|y| 1.0 / (1.0 + 0.1 * y)),
        ("1/(1+.5y)", &|y| 1.0 / (1.0 + 0.5 * y)),
        ("1/(1+.5y^2)", &|y| 1.0 / (1.0 + 0.5 * y * y)),
        ("y/(1+.5y^2)", &|y| y / (1.0 + 0.5 * y * y)),
        ("100+sin", &|y| 100.0 + (2.0 * y).sin()),
        ("kink", &|y| (200.0 / (2000.0 + 200.0 * y)).min(0.104)),
        ("|y|", &|y: f64| y.abs()),
    ];
    for (name, u) in cases {
        print!("{name}:");
        for degree in 1..14 {
            let (e, t) = judged(degree, u);
            print!(" {:.2}({:.2})", e.error.sqrt() / t, e.decay);
        }
        println!();
    }
}

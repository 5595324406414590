//! Energy of the medium and balance of forces, against matrices, closed forms and solutions that are none.

use crate::common::{PAIRS, around, close, double_layers, manufactured, outer, problem, traction};
use faer::Mat;
use steklov_coupling::{Coupled, Form, Interior, Medium, Radiation};
use steklov_quadrature::gauss_legendre;

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// ½ (ξᵀ W ξ + φᵀ V φ), which is ½ ⟨S ξ, ξ⟩ where V φ = (K - ½) ξ.
fn by_matrices(exterior: &Medium, solved: &Coupled) -> f64 {
    let form = |matrix: &Mat<f64>, v: &[f64]| {
        (0..v.len()).map(|i| (0..v.len()).map(|j| v[i] * matrix[(i, j)] * v[j]).sum::<f64>()).sum::<f64>()
    };
    let operators = &exterior.operators;
    0.5 * (form(&operators.w, &solved.exterior_displacement) + form(&operators.v, &solved.traction))
}

/// -½ ∮ σ(u)n·u of the two forces, n into the medium.
fn exact(exterior: &Medium) -> f64 {
    let (mesh, rule) = (&exterior.mesh, gauss_legendre(16));
    let density = |e: usize, t: f64| {
        let (u, stress) = outer(&exterior.material, mesh.point(e, t));
        let [x, y] = traction(stress, mesh.normal(e, 0.0));
        -0.5 * (x * u[0] + y * u[1])
    };
    (0..mesh.len()).map(|e| mesh.length(e) / 2.0 * rule.integrate(|t| density(e, t))).sum()
}

#[test]
fn the_energy_of_the_medium_is_that_of_its_tractions() {
    for (pair, body, medium) in PAIRS {
        let errors = [8, 16].map(|n| {
            let (grid, loads) = manufactured(n, body, medium);
            let interior = Interior::fine(&grid, &loads).unwrap();
            let exterior = around(&interior, 1, 1, medium);
            let (transmission, jump) = problem(interior, &exterior);
            let solve = |form, radiation| transmission.solve(&jump, form, radiation).unwrap();
            let decaying = solve(Form::TwoField, Radiation::Decaying);
            let energy = exterior.energy(&decaying);
            close(&format!("{pair} by matrices"), energy, by_matrices(&exterior, &decaying), 1e-10);
            let bounded = solve(Form::Schur, Radiation::Bounded);
            close(&format!("{pair} bounded"), exterior.energy(&bounded), energy, 1e-9);
            energy / exact(&exterior) - 1.0
        });
        println!("{pair}: {errors:?}");
        let ratio = errors[0] / errors[1];
        assert!((3.0..5.0).contains(&ratio) && errors[1].abs() < 0.02, "{pair}: {errors:?}");
    }
}

/// A solution is in balance, and one whose tractions are twice as large is out of it by what the tractions do on the interface.
#[test]
fn forces_out_of_balance_are_told() {
    for (pair, body, medium) in PAIRS {
        let (grid, loads) = manufactured(8, body, medium);
        let interior = Interior::fine(&grid, &loads).unwrap();
        let exterior = around(&interior, 1, 1, medium);
        let (transmission, jump) = problem(interior, &exterior);
        for radiation in [Radiation::Decaying, Radiation::Bounded] {
            let mut solved = transmission.solve(&jump, Form::Schur, radiation).unwrap();
            assert!(transmission.imbalance(&solved) < 1e-12, "{pair}: {:e}", transmission.imbalance(&solved));
            let [minus, _] = double_layers(&exterior);
            let phi = Mat::from_fn(solved.traction.len(), 1, |i, _| solved.traction[i]);
            let forces = minus.transpose() * phi;
            // each node of the boundary elements is a point of the trace: the projection is 1
            let inside = grid.forces(&solved.displacement);
            let scale = largest(&inside) + largest(&loads.nodal(&grid));
            solved.traction.iter_mut().for_each(|t| *t *= 2.0);
            close(pair, transmission.imbalance(&solved), largest(forces.col_as_slice(0)) / scale, 1e-10);
        }
    }
}

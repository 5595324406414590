//! Multiscale elements in the body.

use crate::common::{around, close, difference, energy_error, manufactured, number, problem, reference};
use steklov_coupling::{CouplingError, Form, Interior, Outline, Radiation, Trace, Transmission};
use steklov_elastic::Plane;
use steklov_msfem::{Basis, CoarseMesh, Elasticity, Extra, Grid, HeterogeneousBody, Loads, Multiscale};
use steklov_quadrature::unit_uniform;

const SAME: [f64; 2] = [2.0, 0.3];

#[test]
fn the_homogeneous_body_has_the_errors_of_the_reference_file() {
    let data = reference("transmission");
    let tolerance = number(&data["tol_rel"]);
    for cells in [4, 8, 16] {
        let (medium, loads) = manufactured(4 * cells, SAME, SAME);
        let mesh = CoarseMesh::uniform(&medium.grid, [4, 4]).unwrap();
        let mut elements = Multiscale::new(&medium, mesh, Basis::Coupled).unwrap();
        let interior = Interior::coarse(&mut elements, &loads, &mut |_| true).unwrap();
        let exterior = around(&interior, 1, 1, SAME);
        let (problem, jump) = problem(interior, &exterior);
        let solved = problem.solve(&jump, Form::TwoField, Radiation::Decaying).unwrap();
        let wanted = &data["emsfem_hom"][cells.to_string()];
        for (bubbles, key) in [(false, "b"), (true, "b_bubble")] {
            let extra = Extra { bubbles, ..Extra::default() };
            let u = elements.downscale(&solved.displacement, &loads, &extra, &mut |_| true).unwrap();
            close(key, energy_error(&medium, SAME, &u), number(&wanted[key]), tolerance);
        }
    }
}

/// E in [1, 10] on 64 × 64 cells, and the jump of tractions (n_x, -n_y/2).
fn rough() -> (HeterogeneousBody, Loads) {
    let n = 64;
    let grid = Grid::new([-0.5; 2], [1.0 / n as f64; 2], [n; 2], |_, _| true).unwrap();
    let young = (0..n * n).map(|k| 1.0 + 9.0 * unit_uniform(99, k as u64)).collect();
    let medium = HeterogeneousBody::new(grid, young, Elasticity::new(0.3, Plane::Strain).unwrap()).unwrap();
    let mut loads = Loads::default();
    let outline = Outline::new(&medium.grid).unwrap();
    outline.add_traction_jump(&medium.grid, &mut loads, |_, n| [n[0], -0.5 * n[1]]);
    (medium, loads)
}

#[test]
fn the_rough_body_has_the_errors_of_the_reference_file() {
    let data = &reference("transmission")["emsfem_het"];
    let (medium, loads) = rough();
    let interior = Interior::fine(&medium, &loads).unwrap();
    let exterior = around(&interior, 1, 1, SAME);
    let problem = Transmission::new(interior, &exterior).unwrap();
    let jump = vec![0.0; exterior.space.dofs()];
    let fine = problem.solve(&jump, Form::Schur, Radiation::Decaying).unwrap().displacement;
    let energy = medium.energy(&fine, &fine);
    let work: f64 = loads.nodal(&medium).iter().zip(&fine).map(|(f, u)| f * u).sum();
    close("energy", energy, number(&data["fine"]["interior_energy"]), 1e-6);
    close("work", work, number(&data["fine"]["work"]), 1e-6);
    for cells in [4, 8, 16, 32] {
        for (basis, word) in [(Basis::Q1, "q1"), (Basis::Coupled, "b"), (Basis::Oscillatory, "c")] {
            let mesh = CoarseMesh::uniform(&medium.grid, [64 / cells; 2]).unwrap();
            let mut elements = Multiscale::new(&medium, mesh, basis).unwrap();
            let interior = Interior::coarse(&mut elements, &loads, &mut |_| true).unwrap();
            let exterior = around(&interior, 1, 1, SAME);
            let problem = Transmission::new(interior, &exterior).unwrap();
            let jump = vec![0.0; exterior.space.dofs()];
            let solved = problem.solve(&jump, Form::Schur, Radiation::Decaying).unwrap();
            let u = elements.downscale(&solved.displacement, &loads, &Extra::default(), &mut |_| true).unwrap();
            let error: Vec<f64> = u.iter().zip(&fine).map(|(a, b)| a - b).collect();
            let relative = (medium.energy(&error, &error) / energy).sqrt();
            close(&format!("{word} {cells}"), relative, number(&data[format!("{word}_M{cells}")]["energy_err"]), 1e-6);
            // the trace is that of the fine field
            if basis == Basis::Oscillatory {
                let at = Outline::new(&medium.grid).unwrap().nodes;
                let trace: Vec<f64> = at.iter().flat_map(|n| [u[2 * n], u[2 * n + 1]]).collect();
                assert!(difference(&solved.trace, &trace) < 1e-12);
            }
        }
    }
}

#[test]
fn bases_that_do_not_conform_have_no_trace() {
    let (medium, _) = rough();
    let outline = Outline::new(&medium.grid).unwrap();
    for basis in [Basis::Oversampled(4), Basis::Periodic] {
        let mesh = CoarseMesh::uniform(&medium.grid, [8, 8]).unwrap();
        let elements = Multiscale::new(&medium, mesh, basis).unwrap();
        let refused = Trace::coarse(&elements, &outline).unwrap_err();
        assert!(matches!(&refused, CouplingError::Inconsistent { what } if what.contains(basis.word())), "{refused}");
    }
}

//! Indicators against errors that elements of higher degree tell.

use crate::common::{PAIRS, around, double_layers, lu, manufactured, outer, problem, traction, with_jumps};
use faer::Mat;
use steklov_bem_operators::{Mesh, Space};
use steklov_coupling::{Coupled, Form, InterfaceIndicators, Interior, Medium, Radiation};
use steklov_quadrature::{gauss_legendre, legendre_p};

/// A nodal field at the nodes of elements of higher degree.
fn raised(space: &Space, fine: &Space, nodal: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; fine.dofs()];
    for e in 0..space.next.len() {
        let mut phi = vec![0.0; space.degree(e) + 1];
        for (j, node) in fine.element_nodes(e).enumerate() {
            space.basis(e).evaluate(fine.basis(e).nodes[j], &mut phi);
            for i in 0..2 {
                values[2 * node + i] = space.element_nodes(e).zip(&phi).map(|(k, phi)| phi * nodal[2 * k + i]).sum();
            }
        }
    }
    values
}

/// φ of many degrees more: the errors of φ_h, in the norm of V, against the exact traction and against V⁻¹(K - ½)ξ_h, of which φ_h
/// is the best approximation.
fn errors_of_traction(exterior: &Medium, solved: &Coupled) -> [f64; 2] {
    let more = 8;
    let degree: Vec<usize> = exterior.mesh.degree.iter().map(|p| p + more).collect();
    let fine = Mesh { degree, ..exterior.mesh.clone() };
    let fine = Medium::new(fine, exterior.material, Some(exterior.operators.length)).unwrap();
    let (mesh, space, rule) = (&fine.mesh, &fine.space, gauss_legendre(16));
    let mut exact = vec![0.0; space.dofs()];
    let mut found = exact.clone();
    let xi = raised(&exterior.space, space, &solved.exterior_displacement);
    for e in 0..mesh.len() {
        let p = exterior.mesh.degree[e];
        let mut legendre = vec![0.0; mesh.degree[e]];
        for (&t, w) in rule.points.iter().zip(&rule.weights) {
            legendre_p(t, &mut legendre);
            let value = traction(outer(&exterior.material, mesh.point(e, t)).1, mesh.normal(e, 0.0));
            for (m, l) in legendre.iter().enumerate() {
                (0..2).for_each(|i| exact[2 * (space.offset[e] + m) + i] += w * l * (m as f64 + 0.5) * value[i]);
            }
        }
        for m in 0..2 * p {
            found[2 * space.offset[e] + m] = solved.traction[2 * exterior.space.offset[e] + m];
        }
    }
    let [k, _] = double_layers(&fine);
    let right = k * Mat::from_fn(xi.len(), 1, |i, _| xi[i]);
    let best = lu(fine.operators.v.as_ref(), right.col_as_slice(0));
    [exact, best].map(|phi| {
        let error = Mat::from_fn(phi.len(), 1, |i, _| phi[i] - found[i]);
        (error.transpose() * &fine.operators.v * &error)[(0, 0)].sqrt()
    })
}

#[test]
fn the_gain_of_two_degrees_more_is_the_error_of_the_traction_of_this_displacement() {
    for (pair, body, medium) in PAIRS {
        for degree in [1, 2, 3, 4] {
            for n in [4, 8] {
                let (grid, loads) = manufactured(n, body, medium);
                let interior = Interior::fine(&grid, &loads).unwrap();
                let exterior = around(&interior, 1, degree, medium);
                let (transmission, u0) = problem(interior, &exterior);
                let solved = transmission.solve(&u0, Form::TwoField, Radiation::Decaying).unwrap();
                let found = with_jumps(body, medium, 0, |jumps| {
                    let u = &solved.displacement;
                    InterfaceIndicators::new(&exterior, &grid, u, &solved, Form::TwoField, jumps).unwrap()
                });
                let estimate = found.traction_error.iter().sum::<f64>().sqrt();
                let [whole, of_displacement] = errors_of_traction(&exterior, &solved);
                let [loose, sharp] = [estimate / whole, estimate / of_displacement];
                println!("{pair} p = {degree} n = {n}: {loose:.3} of {whole:.2e}, {sharp:.3} of {of_displacement:.2e}");
                assert!((0.85..1.1).contains(&sharp), "{pair} p = {degree} n = {n}: {sharp}");
            }
        }
    }
}

//! Indicators against errors that elements of higher degree tell.

mod common;

use common::{PAIRS, around, double_layers, lu, manufactured, material, outer, problem, traction, with_jumps};
use faer::Mat;
use steklov_bem_operators::{Loop, Mesh, Polygon, Space};
use steklov_coupling::{
    Coupled, Form, Inclusion, InterfaceIndicators, Interior, Jumps, Medium, Radiation, Transmission,
};
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
            let value = traction(outer(&exterior.material, mesh.point(e, t)).1, mesh.normal(e));
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

/// Forces outside of a square in the field of the body, and inside of it in that of the medium.
#[test]
fn the_indicators_of_a_body_of_boundary_elements_follow_the_error() {
    let polygon = {
        let corners = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        Polygon::new(Loop { corners, sides: (0..4).map(|k| k.to_string()).collect() }, Vec::new()).unwrap()
    };
    for (pair, body, outside) in PAIRS {
        let (body, outside) = (material(body), material(outside));
        let shifted = |x: [f64; 2]| [x[0] + 1.1, x[1] - 0.3];
        let inner = |x: [f64; 2]| outer(&body, shifted(x));
        let u0 = |x: [f64; 2]| [0, 1].map(|i| inner(x).0[i] - outer(&outside, x).0[i]);
        let t0 = |x: [f64; 2], n: [f64; 2]| {
            let (t, c) = (traction(inner(x).1, n), traction(outer(&outside, x).1, n));
            [t[0] - c[0], t[1] - c[1]]
        };
        let jumps = Jumps { displacement: &u0, traction: &t0, halvings: 0 };
        for degree in [1, 2, 3] {
            for form in [Form::Schur, Form::ThreeField] {
                let mut before: Option<f64> = None;
                for elements in [16, 32] {
                    let exterior = Medium::new(Mesh::uniform(&polygon, elements, degree), outside, None).unwrap();
                    let inclusion = Inclusion::new(body, &exterior, t0).unwrap();
                    let transmission = Transmission::of_inclusion(&inclusion, &exterior).unwrap();
                    let given = exterior.space.interpolate(u0);
                    let solved = transmission.solve(&given, form, Radiation::Decaying).unwrap();
                    let found =
                        InterfaceIndicators::of_inclusion(&exterior, &inclusion, &solved, form, &jumps).unwrap();
                    let estimate = found.squared().iter().sum::<f64>().sqrt();
                    // ⟨S e, e⟩ of the error of u and that of φ, by elements of higher degree
                    let fine = Mesh { degree: vec![degree + 6; elements], ..exterior.mesh.clone() };
                    let fine = Medium::new(fine, outside, None).unwrap();
                    let stiffness = Inclusion::new(body, &fine, t0).unwrap().stiffness;
                    let (exact, u) =
                        (fine.space.interpolate(|x| inner(x).0), raised(&exterior.space, &fine.space, &solved.trace));
                    let e = Mat::from_fn(u.len(), 1, |i, _| u[i] - exact[i]);
                    let energy = (e.transpose() * &stiffness * &e)[(0, 0)].sqrt();
                    let error = energy.hypot(errors_of_traction(&exterior, &solved)[0]);
                    let effectivity = estimate / error;
                    println!(
                        "{pair} p = {degree} {elements} {form:?}: {effectivity:.3} of {error:.2e} (body {energy:.2e})"
                    );
                    let range = if form == Form::ThreeField { 1.2..12.5 } else { 0.9..5.0 };
                    assert!(range.contains(&effectivity), "{pair} {degree} {elements} {form:?}: {effectivity}");
                    if let Some(before) = before.replace(error) {
                        let rate = (before / error).log2();
                        assert!(rate > f64::min(degree as f64, 2.0), "{pair} {degree} {form:?}: rate {rate}");
                    }
                }
            }
        }
    }
}

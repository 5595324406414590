//! Fields inside the body and on its boundary, against exact ones.

mod common;

use common::*;
use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, polygon_and_mesh};
use steklov_bem_operators::{BoundaryField, Domain, Location, Material, Mesh, Operators, Space, Steklov};

struct Solved {
    mesh: Mesh,
    space: Space,
    field: Field,
    displacement: Vec<f64>,
    matrix: faer::Mat<f64>,
    boundary: BoundaryField,
}

/// The interpolated displacement of an exact field and the traction that the boundary operators give to it.
fn solve(mesh: Mesh, material: &Material, name: &str) -> Solved {
    let space = Space::new(&mesh);
    let field = Field::new(name, material);
    let operators = Operators::assemble(&mesh, &space, material, None).expect("operators");
    let length = operators.length;
    let steklov = Steklov::new(operators, Domain::Interior).expect("S");
    let displacement = space.interpolate(|x| field.displacement(x));
    let traction = steklov.traction.apply(&displacement);
    let boundary = BoundaryField::new(&mesh, &space, material, &displacement, &traction, length);
    Solved { mesh, space, field, displacement, matrix: steklov.matrix, boundary }
}

fn stress_error(got: [f64; 3], want: [f64; 3]) -> f64 {
    got.iter().zip(want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn stress_next_to_a_side_is_as_good_as_inside() {
    let material = Gold::read().material();
    for corners in [&SQUARE[..], &L_SHAPE[..]] {
        // the Kelvin source is 0.4 away from the body; p = 16 resolves it to 1e-10 of its largest stress
        let solved = solve(Mesh::uniform(&polygon(corners, &[]), 3 * corners.len(), 16), &material, "kelvin");
        let mut largest: f64 = 0.0;
        let mut worst: [f64; 3] = [0.0; 3];
        let mesh = &solved.mesh;
        for (band, distance) in [1e-10, 1e-6, 1e-2].into_iter().enumerate() {
            for e in 0..mesh.len() {
                let n = mesh.normal(e);
                for t in [-0.999_999_9, -0.7, -0.2, 0.31, 0.9] {
                    let s = mesh.edge_parameter(e, t);
                    if !(0.1..=0.9).contains(&s) {
                        continue;
                    }
                    let y = mesh.point(e, t);
                    let x = [y[0] - distance * n[0], y[1] - distance * n[1]];
                    let want = solved.field.stress(x);
                    largest = want.iter().fold(largest, |m, v| m.max(v.abs()));
                    worst[band] = worst[band].max(stress_error(solved.boundary.inside(x).stress, want));
                }
            }
        }
        println!("distance 1e-10, 1e-6, 1e-2: {:?} of {largest}", worst.map(|w| w / largest));
        assert!(worst.iter().all(|w| *w < 1e-8 * largest), "{worst:?} of {largest}");
    }
}

#[test]
fn displacement_and_stress_converge_exponentially_inside() {
    let material = Gold::read().material();
    let points = [[0.1, 0.2], [-0.3, 0.1], [0.45, 0.05], [0.2, -0.44]];
    let mut errors = Vec::new();
    for p in [4, 8, 12] {
        let solved = solve(Mesh::uniform(&polygon(&L_SHAPE, &[]), 12, p), &material, "kelvin");
        let mut worst: f64 = 0.0;
        for x in points {
            let (got, want) = (solved.boundary.inside(x).displacement, solved.field.displacement(x));
            worst = worst.max((got[0] - want[0]).abs().max((got[1] - want[1]).abs()));
            worst = worst.max(stress_error(solved.boundary.inside(x).stress, solved.field.stress(x)));
        }
        errors.push(worst);
    }
    println!("{errors:?}");
    assert!(errors[1] < 1e-2 * errors[0] && errors[2] < 1e-10, "{errors:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn linear_fields_are_exact_everywhere((polygon, mesh) in polygon_and_mesh(4), material in material(), depth in 1e-9..0.05f64, t in -0.98..0.98f64) {
        let solved = solve(mesh, &material, "linear");
        let scale = max_abs(&solved.displacement);
        let stress = solved.field.stress([0.0, 0.0]);
        let stress_scale = max_abs(&stress);
        for e in 0..solved.mesh.len() {
            let n = solved.mesh.normal(e);
            let y = solved.mesh.point(e, t);
            let step = depth * solved.mesh.length(e);
            let x = [y[0] - step * n[0], y[1] - step * n[1]];
            // next to an acute corner the step leads out of the body
            if polygon.contains(x) != Location::Inside {
                continue;
            }
            let (got, want) = (solved.boundary.inside(x).displacement, solved.field.displacement(x));
            prop_assert!((got[0] - want[0]).hypot(got[1] - want[1]) < 1e-10 * scale);
            prop_assert!(stress_error(solved.boundary.inside(x).stress, stress) < 1e-8 * stress_scale);
            let trace = solved.boundary.trace(e, t);
            prop_assert!(stress_error(trace.stress, stress) < 1e-8 * stress_scale);
            let want = solved.field.traction(y, n);
            let got = solved.boundary.steklov_trace(e, t);
            prop_assert!((got[0] - want[0]).hypot(got[1] - want[1]) < 1e-8 * stress_scale, "{got:?} {want:?}");
        }
    }
}

#[test]
fn the_pointwise_steklov_trace_has_the_weak_one_as_moments() {
    let material = Gold::read().material();
    let solved = solve(Mesh::uniform(&polygon(&SQUARE, &[]), 8, 5), &material, "exp");
    let rule =
        steklov_quadrature::graded(&steklov_quadrature::gauss_legendre(14), 12, 0.15, steklov_quadrature::End::Both);
    let mut moments = vec![0.0; solved.space.dofs()];
    for e in 0..solved.mesh.len() {
        let basis = solved.space.basis(e);
        let mut phi = vec![0.0; basis.degree + 1];
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            basis.evaluate(t, &mut phi);
            let sigma = solved.boundary.steklov_trace(e, t);
            for (j, node) in solved.space.element_nodes(e).enumerate() {
                for i in 0..2 {
                    moments[2 * node + i] += w * solved.mesh.length(e) / 2.0 * phi[j] * sigma[i];
                }
            }
        }
    }
    let weak = product(&solved.matrix, &solved.displacement);
    let error = moments.iter().zip(&weak).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / max_abs(&weak);
    println!("{error:e}");
    assert!(error < 1e-11, "{error:e}");
}

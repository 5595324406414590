//! Fields inside the body and on its boundary, against exact ones.

use crate::common::*;
use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, polygon_and_mesh};
use steklov_bem_operators::{BoundaryField, Domain, Location, Mesh, Operators, Space, Steklov};
use steklov_elastic::Material;

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
                let n = mesh.normal(e, 0.0);
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
            let n = solved.mesh.normal(e, 0.0);
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
            let [x, y] = solved.boundary.equation_slope(e, t);
            prop_assert!(x.hypot(y) < 1e-8 * stress_scale / material.young, "{x} {y}");
        }
    }

    /// A displacement and a traction that have nothing to do with each other: w' is the difference quotient of
    /// u less the field just inside, in which derivatives of the kernels do not occur.
    #[test]
    fn the_slope_of_the_equation_is_the_difference_of_the_field_inside(
        (polygon, mesh) in polygon_and_mesh(4), material in material(), t in -0.9..0.9f64,
        values in proptest::collection::vec(-1.0..1.0f64, 64),
    ) {
        let space = Space::new(&mesh);
        let size = mesh.diameter();
        let value = |i: usize| values[i % 64] + 0.3 * values[(i / 64) % 64];
        let displacement: Vec<f64> = (0..space.dofs()).map(|i| size * value(i)).collect();
        let traction: Vec<f64> = (0..space.dofs()).map(|i| material.mu() * value(i + 7)).collect();
        let field = BoundaryField::new(&mesh, &space, &material, &displacement, &traction, size);
        for e in 0..mesh.len() {
            let (n, half) = (mesh.normal(e, 0.0), mesh.length(e) / 2.0);
            let residual = |t: f64| {
                let (y, u) = (mesh.point(e, t), field.trace(e, t).displacement);
                let inside = field.inside([0, 1].map(|i| y[i] - 1e-9 * half * n[i])).displacement;
                [u[0] - inside[0], u[1] - inside[1]]
            };
            let y = mesh.point(e, t);
            prop_assume!(polygon.contains([0, 1].map(|i| y[i] - 1e-9 * half * n[i])) == Location::Inside);
            let step = 1e-4;
            let (up, down) = (residual(t + step), residual(t - step));
            let got = field.equation_slope(e, t);
            // the size of the terms that make up w'
            let scale = size / half * (1.0 + 1.0 / (1.0 - 2.0 * material.nu()));
            for i in 0..2 {
                let want = (up[i] - down[i]) / (2.0 * step * half);
                prop_assert!((got[i] - want).abs() < 1e-5 * scale, "{} {want} {scale}", got[i]);
            }
        }
    }
}

/// ∫ w A ds with A' = P_m, A = 0 at both ends, is -∫ w P_m, which is 0 for 1 ≤ m < p and for no more.
#[test]
fn the_equation_has_no_moments_against_the_traction_space() {
    let material = Gold::read().material();
    let p = 5;
    let solved = solve(Mesh::uniform(&polygon(&L_SHAPE, &[]), 9, p), &material, "exp");
    let rule =
        steklov_quadrature::graded(&steklov_quadrature::gauss_legendre(14), 12, 0.15, steklov_quadrature::End::Both);
    let (mut worst, mut next, mut size) = (0.0f64, f64::INFINITY, 0.0f64);
    let mut legendre = vec![0.0; p + 2];
    for e in 0..solved.mesh.len() {
        let mut moments = vec![[0.0; 2]; p + 1];
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            steklov_quadrature::legendre_p(t, &mut legendre);
            let slope = solved.boundary.equation_slope(e, t);
            size = size.max(slope[0].hypot(slope[1]));
            for m in 1..=p {
                let a = (legendre[m + 1] - legendre[m - 1]) / (2 * m + 1) as f64;
                (0..2).for_each(|i| moments[m][i] += w * a * slope[i]);
            }
        }
        worst = moments[..p].iter().flatten().fold(worst, |m, v| m.max(v.abs()));
        next = next.min(moments[p][0].hypot(moments[p][1]));
    }
    println!("largest moment {worst:e}, smallest one of degree p {next:e}, of slopes up to {size:e}");
    assert!(worst < 1e-13 && next > 1e-9, "{worst:e} {next:e}");
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

//! Homogeneous bodies by boundary elements: closed forms, what must not change them, and grids.

mod common;

use common::{around, difference, manufactured, material, problem, traction};
use proptest::prelude::*;
use steklov_bem_operators::{Loop, Mesh, Polygon};
use steklov_coupling::{CouplingError, Form, Inclusion, Interior, Medium, Radiation, Transmission};
use steklov_elastic::{Material, Plane};

const FORMS: [Form; 3] = [Form::TwoField, Form::ThreeField, Form::Schur];

fn polygon(corners: Vec<[f64; 2]>) -> Polygon {
    let sides = (0..corners.len()).map(|k| k.to_string()).collect();
    Polygon::new(Loop { corners, sides }, Vec::new()).unwrap()
}

fn linear(g: [[f64; 2]; 2], x: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| g[i][0] * x[0] + g[i][1] * x[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A strained plane of one material: the curve in it cannot be seen, whatever its shape and the elements.
    #[test]
    fn an_interface_in_one_material_is_invisible(
        radii in prop::collection::vec(0.4..1.5f64, 3..8),
        gradient in [[-1.0..1.0f64, -1.0..1.0], [-1.0..1.0, -1.0..1.0]],
        poisson in -0.5..0.45f64,
        degree in 1..5usize,
        elements in 8..24usize,
        stress in any::<bool>(),
    ) {
        let n = radii.len();
        let corner = |(k, r): (usize, &f64)| {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            [0.7 + r * angle.cos(), -0.2 + r * angle.sin()]
        };
        let mesh = Mesh::uniform(&polygon(radii.iter().enumerate().map(corner).collect()), elements, degree);
        let same = Material::new(3.0, poisson, if stress { Plane::Stress } else { Plane::Strain }).unwrap();
        let exterior = Medium::new(mesh, same, None).unwrap();
        let pulled = |_: [f64; 2], n: [f64; 2]| traction(same.stress(gradient), n);
        let body = Inclusion::new(same, &exterior, pulled).unwrap();
        let problem = Transmission::of_inclusion(&body, &exterior).unwrap();
        prop_assert!(problem.balance.is_balanced());
        let u0 = exterior.space.interpolate(|x| linear(gradient, x));
        for form in FORMS {
            let solved = problem.solve(&u0, form, Radiation::Decaying).unwrap();
            prop_assert!(difference(&solved.displacement, &u0) < 1e-10);
            let scale = u0.iter().fold(0.0f64, |m, u| m.max(u.abs()));
            prop_assert!(solved.exterior_displacement.iter().all(|u| u.abs() < 1e-10 * scale));
            prop_assert!(solved.traction.iter().all(|t| t.abs() < 1e-9 * 3.0));
            let inside = body.field(&exterior, &solved).inside([0.7, -0.2]);
            let exact = same.stress(gradient);
            (0..3).for_each(|i| assert!((inside.stress[i] - exact[i]).abs() < 1e-8, "{inside:?} {exact:?}"));
        }
    }
}

/// The uniform stress in a circle under a remote one: its mean and its deviator are multiplied each by a factor.
fn circle_stress(body: &Material, around: &Material, remote: [f64; 3]) -> [f64; 3] {
    let (m, n) = (body.mu(), around.mu());
    let mean = m * (1.0 + around.kappa()) / (2.0 * m + n * (body.kappa() - 1.0));
    let deviator = m * (1.0 + around.kappa()) / (n + m * around.kappa());
    let [p, q] = [(remote[0] + remote[1]) / 2.0, (remote[0] - remote[1]) / 2.0];
    [mean * p + deviator * q, mean * p - deviator * q, deviator * remote[2]]
}

/// Strain of a stress by Hooke's law in plane strain.
fn strain(m: &Material, [xx, yy, xy]: [f64; 3]) -> [[f64; 2]; 2] {
    let (mu, nu) = (m.mu(), m.nu());
    let of = |a: f64, b: f64| ((1.0 - nu) * a - nu * b) / (2.0 * mu);
    [[of(xx, yy), xy / (2.0 * mu)], [xy / (2.0 * mu), of(yy, xx)]]
}

/// Errors of the displacement at the vertices, over the largest of u0, and of the stress at the centre, of a body whose n vertices
/// are at these angles of the unit circle.
fn errors_of_circle(body: &Material, form: Form, n: usize, angle: impl Fn(f64) -> f64) -> [f64; 2] {
    let outside = material([1.0, 0.3]);
    let corner = |k: usize| {
        let angle = angle(std::f64::consts::TAU * k as f64 / n as f64);
        [angle.cos(), angle.sin()]
    };
    let mesh = Mesh::uniform(&polygon((0..n).map(corner).collect()), n, 1);
    let exterior = Medium::new(mesh, outside, None).unwrap();
    let remote = [1.0, 0.0, 0.4];
    let gradient = strain(&outside, remote);
    let inclusion = Inclusion::new(*body, &exterior, |_, n| traction(remote, n)).unwrap();
    let problem = Transmission::of_inclusion(&inclusion, &exterior).unwrap();
    let u0 = exterior.space.interpolate(|x| linear(gradient, x));
    let solved = problem.solve(&u0, form, Radiation::Decaying).unwrap();
    let stress = circle_stress(body, &outside, remote);
    let wanted = exterior.space.interpolate(|x| linear(strain(body, stress), x));
    let centre = inclusion.field(&exterior, &solved).inside([0.0; 2]).stress;
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0f64, |m, v| m.max(v.abs()));
    let displacements = largest(&mut solved.displacement.iter().zip(&wanted).map(|(a, b)| a - b));
    [displacements / largest(&mut u0.into_iter()), largest(&mut (0..3).map(|i| centre[i] - stress[i]))]
}

#[test]
fn a_circle_under_remote_tension_has_the_uniform_stress_of_the_closed_form() {
    for body in [[0.01, 0.2], [0.2, 0.4], [5.0, 0.1], [1000.0, 0.3]].map(material) {
        for form in FORMS {
            let [coarse, middle, fine] =
                [16, 32, 64].map(|n| errors_of_circle(&body, form, n, |t| t + 0.2 * t.sin() + 0.1 * (2.0 * t).cos()));
            println!("E = {} {form:?}: {coarse:?} {middle:?} {fine:?}", body.young);
            for k in 0..2 {
                let rates = [coarse[k] / middle[k], middle[k] / fine[k]].map(f64::log2);
                assert!(rates.iter().all(|rate| (1.8..2.2).contains(rate)), "{rates:?}");
                assert!(fine[k] < 4e-3, "{fine:?}");
            }
            // a regular polygon has the symmetry of the circle for all but harmonics of order n
            let regular = errors_of_circle(&body, form, 64, |t| t);
            assert!(regular.iter().all(|error| *error < 1e-8), "{regular:?}");
        }
    }
}

/// Balanced jumps: L of the medium does not matter.
#[test]
fn the_length_in_the_logarithm_does_not_matter() {
    let corners = vec![[0.0, 0.0], [1.3, 0.1], [0.9, 0.6], [1.1, 1.4], [-0.2, 0.8]];
    let mesh = Mesh::uniform(&polygon(corners), 20, 2);
    let (body, outside) = (material([20.0, 0.1]), material([2.0, 0.3]));
    let gradient = [[0.3, -0.1], [0.4, 0.2]];
    let solve = |length: f64, form| {
        let exterior = Medium::new(mesh.clone(), outside, Some(length)).unwrap();
        let inclusion = Inclusion::new(body, &exterior, |_, n| traction(outside.stress(gradient), n)).unwrap();
        let u0 = exterior.space.interpolate(|x| linear(gradient, x));
        Transmission::of_inclusion(&inclusion, &exterior).unwrap().solve(&u0, form, Radiation::Decaying).unwrap()
    };
    for form in FORMS {
        let (a, b) = (solve(2.0, form), solve(50.0, form));
        assert!(difference(&b.displacement, &a.displacement) < 1e-12, "{form:?}");
        assert!(difference(&b.traction, &a.traction) < 1e-11, "{form:?}");
    }
}

/// The same square body on finer and finer grids: the middle of its lower side.
#[test]
fn a_grid_tends_to_the_body_of_boundary_elements() {
    let (body, outside) = ([20.0, 0.25], [2.0, 0.3]);
    let gradient = [[1.0, 0.3], [0.3, -0.5]];
    let remote = material(outside).stress(gradient);
    let fine = {
        let (medium, _) = manufactured(4, body, outside);
        let mesh = Interior::fine(&medium, &Default::default()).unwrap().trace;
        let exterior = Medium::new(mesh.mesh(8, 2).unwrap(), material(outside), None).unwrap();
        let inclusion = Inclusion::new(material(body), &exterior, |_, n| traction(remote, n)).unwrap();
        let u0 = exterior.space.interpolate(|x| linear(gradient, x));
        let problem = Transmission::of_inclusion(&inclusion, &exterior).unwrap();
        problem.solve(&u0, Form::Schur, Radiation::Decaying).unwrap().trace[64..66].to_vec()
    };
    let mut before: Option<f64> = None;
    for n in [8, 16, 32] {
        let (medium, _) = manufactured(n, body, outside);
        let mut loads = steklov_msfem::Loads::default();
        let outline = steklov_coupling::Outline::new(&medium.grid).unwrap();
        outline.add_traction_jump(&medium.grid, &mut loads, |_, n| traction(remote, n));
        let interior = Interior::fine(&medium, &loads).unwrap();
        let exterior = around(&interior, 1, 1, outside);
        let u0 = exterior.space.interpolate(|x| linear(gradient, x));
        let (problem, _) = problem(interior, &exterior);
        let solved = problem.solve(&u0, Form::Schur, Radiation::Decaying).unwrap();
        let error = difference(&solved.trace[n..n + 2], &fine);
        println!("{n}: {error:.2e}");
        if let Some(before) = before.replace(error) {
            assert!(error < 0.6 * before, "{before} then {error}");
        }
    }
    assert!(before.is_some_and(|error| error < 5e-3));
}

#[test]
fn what_is_no_body_of_these_elements_is_refused() {
    let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let sides = |n: usize| (0..n).map(|k| k.to_string()).collect();
    let hole =
        Loop { corners: vec![[0.5, 0.5], [1.0, 0.5], [0.5, 1.0]], sides: ["a", "b", "c"].map(String::from).to_vec() };
    let holed = Polygon::new(Loop { corners: corners.clone(), sides: sides(4) }, vec![hole]).unwrap();
    let m = material([1.0, 0.3]);
    let still = |_: [f64; 2], _: [f64; 2]| [0.0; 2];
    let exterior = Medium::new(Mesh::uniform(&holed, 14, 1), m, None).unwrap();
    let refused = Inclusion::new(m, &exterior, still).unwrap_err();
    assert!(matches!(&refused, CouplingError::Inconsistent { what } if what.contains("no holes")), "{refused}");
    let [a, b] = [8, 12].map(|n| Medium::new(Mesh::uniform(&polygon(corners.clone()), n, 1), m, None).unwrap());
    let refused = Inclusion::new(m, &a, |_, _| [f64::NAN, 0.0]).unwrap_err();
    assert!(refused.to_string().contains("jump of tractions is NaN"), "{refused}");
    let body = Inclusion::new(m, &a, still).unwrap();
    let refused = Transmission::of_inclusion(&body, &b).unwrap_err();
    assert!(refused.to_string().contains("has 16 unknowns"), "{refused}");
    // a stiffness that leaves too few digits
    let rigid = Inclusion::new(material([1e12, 0.3]), &a, still).unwrap();
    let transmission = Transmission::of_inclusion(&rigid, &a).unwrap();
    let refused = transmission.solve(&[0.0; 16], Form::Schur, Radiation::Decaying).unwrap_err();
    assert!(matches!(refused, CouplingError::Contrast { .. }), "{refused}");
}

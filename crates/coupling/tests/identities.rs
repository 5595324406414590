//! Solutions in closed form, and what must not change them.

use crate::common::{around, difference, manufactured, material, problem, traction};
use proptest::prelude::*;
use steklov_coupling::{CouplingError, Form, Interior, Medium, Outline, Radiation, Transmission};
use steklov_elastic::{Material, Plane};
use steklov_msfem::{Elasticity, Grid, HeterogeneousBody, Loads};

const FORMS: [Form; 3] = [Form::TwoField, Form::ThreeField, Form::Schur];

/// An L of n × m cells with a corner cut away.
fn ell(origin: [f64; 2], spacing: [f64; 2], cells: [usize; 2]) -> Grid {
    Grid::new(origin, spacing, cells, |i, j| i < 2 || j < 2).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// u = G x + b in the body and nothing around it, by u0 = u and t0 = σ n: in all spaces.
    #[test]
    fn an_affine_field_in_a_medium_at_rest_is_exact(
        gradient in [[-1.0..1.0f64, -1.0..1.0], [-1.0..1.0, -1.0..1.0]],
        shift in [-1.0..1.0f64, -1.0..1.0],
        ratios in [0.0..0.45f64, 0.0..0.45],
        contrast in -3.0..3.0f64,
        cells in [3..7usize, 3..7],
        parts in 1..4usize,
        degree in 1..4usize,
        coarse in any::<bool>(),
        stress in any::<bool>(),
    ) {
        let grid = ell([0.3, -1.0], [0.25, 0.2], cells);
        let outline = Outline::new(&grid).unwrap();
        let young = 10f64.powf(contrast);
        let plane = if stress { Plane::Stress } else { Plane::Strain };
        let body = Material::new(young, ratios[0], plane).unwrap();
        let field = |[x, y]: [f64; 2]| [0, 1].map(|i| gradient[i][0] * x + gradient[i][1] * y + shift[i]);
        let mut loads = Loads::default();
        outline.add_traction_jump(&grid, &mut loads, |_, n| traction(body.stress(gradient), n));
        let count = cells[0] * cells[1];
        let medium = HeterogeneousBody::new(grid, vec![young; count], Elasticity::new(ratios[0], plane).unwrap()).unwrap();
        let interior = Interior::fine(&medium, &loads).unwrap();
        // one element an edge is coarser than the trace
        let mesh = if coarse {
            steklov_bem_operators::Mesh::uniform(&outline.polygon, 0, degree)
        } else {
            interior.trace.mesh(parts, degree).unwrap()
        };
        let exterior = Medium::new(mesh, Material::new(1.0, ratios[1], plane).unwrap(), None).unwrap();
        let problem = Transmission::new(interior, &exterior).unwrap();
        prop_assert!(problem.balance.is_balanced());
        let jump = exterior.space.interpolate(field);
        let wanted: Vec<f64> = (0..medium.grid.nodes()).flat_map(|n| field(medium.grid.point(n))).collect();
        for form in FORMS {
            let solved = problem.solve(&jump, form, Radiation::Decaying).unwrap();
            prop_assert!(difference(&solved.displacement, &wanted) < 1e-10);
            prop_assert!(difference(&solved.trace, &jump) < 1e-10);
            let scale = young.min(1.0);
            prop_assert!(solved.traction.iter().all(|t| t.abs() < 1e-9 * scale.max(1.0)));
            prop_assert!(solved.exterior_displacement.iter().all(|u| u.abs() < 1e-10));
        }
    }

    /// E, length and L in other units.
    #[test]
    fn units_do_not_matter(pressure in -9.0..12.0f64, length in -3.0..3.0f64) {
        let solve = |e: f64, l: f64, form| {
            let grid = ell([0.0; 2], [l * 0.25; 2], [4, 5]);
            let young = (0..20).map(|c| e * (1.0 + f64::from(c))).collect();
            let elasticity = Elasticity::new(0.3, steklov_elastic::Plane::Strain).unwrap();
            let medium = HeterogeneousBody::new(grid, young, elasticity).unwrap();
            let mut loads = Loads::default();
            loads.set_body_force(&medium, |[x, y]| [e / l * (1.0 + x / l), e / l * (y / l - 0.5)]).unwrap();
            let interior = Interior::fine(&medium, &loads).unwrap();
            let exterior =
                Medium::new(interior.trace.mesh(1, 2).unwrap(), material([3.0 * e, 0.2]), Some(5.0 * l)).unwrap();
            let jump = exterior.space.interpolate(|[x, y]| [y * y / l, x]);
            let solved = Transmission::new(interior, &exterior).unwrap().solve(&jump, form, Radiation::Decaying).unwrap();
            let u: Vec<f64> = solved.displacement.iter().map(|u| u / l).collect();
            let t: Vec<f64> = solved.traction.iter().map(|t| t / e).collect();
            (u, t)
        };
        let (e, l) = (10f64.powf(pressure), 10f64.powf(length));
        for form in FORMS {
            let (wanted, found) = (solve(1.0, 1.0, form), solve(e, l, form));
            prop_assert!(difference(&found.0, &wanted.0) < 1e-11);
            prop_assert!(difference(&found.1, &wanted.1) < 1e-10);
        }
    }
}

/// A couple f = (R² - r²)² (-y, x) for r < R in a plane of one material: u = M/(4πμr) e_θ around it, M = π R⁸/12.
#[test]
fn an_interface_in_one_material_cannot_be_seen() {
    let (young, poisson, radius) = (2.0, 0.3, 0.45f64);
    let around = material([young, poisson]);
    let moment = std::f64::consts::PI * radius.powi(8) / 12.0;
    let exact = |[x, y]: [f64; 2]| {
        let c = moment / (4.0 * std::f64::consts::PI * around.mu() * (x * x + y * y));
        [-c * y, c * x]
    };
    let mut before: Option<[f64; 2]> = None;
    for n in [8, 16, 32] {
        // off the centre, so that nothing cancels by symmetry
        let grid = Grid::new([-0.5, -0.75], [1.25 / n as f64; 2], [n; 2], |_, _| true).unwrap();
        let elasticity = Elasticity::new(poisson, steklov_elastic::Plane::Strain).unwrap();
        let medium = HeterogeneousBody::new(grid, vec![young; n * n], elasticity).unwrap();
        let mut loads = Loads::default();
        loads
            .set_body_force(&medium, |[x, y]| {
                let g = (radius * radius - x * x - y * y).max(0.0).powi(2);
                [-g * y, g * x]
            })
            .unwrap();
        let interior = Interior::fine(&medium, &loads).unwrap();
        let exterior = Medium::new(interior.trace.mesh(1, 1).unwrap(), around, None).unwrap();
        let problem = Transmission::new(interior, &exterior).unwrap();
        let jump = vec![0.0; exterior.space.dofs()];
        let solved = problem.solve(&jump, Form::TwoField, Radiation::Decaying).unwrap();
        let on_interface = difference(&solved.trace, &exterior.space.interpolate(exact));
        let x = [1.5, 2.0];
        let far = difference(&exterior.field(&solved).at(x).displacement, &exact(x));
        println!("n = {n}: {on_interface:.2e} on the interface, {far:.2e} around it");
        if let Some(before) = before.replace([on_interface, far]) {
            for (before, now) in before.into_iter().zip([on_interface, far]) {
                assert!(now < 0.32 * before, "{before} then {now}");
            }
        }
    }
    assert!(before.is_some_and(|[on, far]| on < 2e-3 && far < 1e-3), "{before:?}");
}

#[test]
fn balanced_loads_do_not_depend_on_the_length_and_others_shift_by_their_resultant() {
    let (body, outside) = ([20.0, 0.25], [2.0, 0.3]);
    let (medium, mut loads) = manufactured(8, body, outside);
    let force = [0.3, -0.7];
    for balanced in [true, false] {
        if !balanced {
            loads.add_side(0, 0, [force, [0.0; 2]]);
        }
        let interior = Interior::fine(&medium, &loads).unwrap();
        let mesh = interior.trace.mesh(1, 1).unwrap();
        let [a, b] = [1.0, 30.0].map(|l| Medium::new(mesh.clone(), material(outside), Some(l)).unwrap());
        let solve = |exterior, form| {
            let (problem, jump) = problem(interior.clone(), exterior);
            assert_eq!(problem.balance.is_balanced(), balanced);
            problem.solve(&jump, form, Radiation::Decaying).unwrap()
        };
        let m = material(outside);
        // V grows by c ∫φ, and ∫φ is less the resultant of the loads
        let c = m.kappa() * 30f64.ln() / (8.0 * std::f64::consts::PI * m.mu() * (1.0 - m.nu()));
        let shift = force.map(|f| if balanced { 0.0 } else { c * f });
        for form in FORMS {
            let (a, b) = (solve(&a, form), solve(&b, form));
            let moved: Vec<f64> = a.displacement.chunks(2).flat_map(|u| [u[0] + shift[0], u[1] + shift[1]]).collect();
            assert!(difference(&b.displacement, &moved) < 1e-12, "{form:?}");
            assert!(difference(&b.traction, &a.traction) < 1e-11);
            for i in 0..2 {
                let resultant: f64 = a.traction.iter().skip(i).step_by(2).sum::<f64>() / 8.0;
                let wanted = if balanced { 0.0 } else { -force[i] };
                assert!((resultant - wanted).abs() < 1e-11, "{resultant} {wanted}");
            }
        }
    }
}

/// The balance of a load of both signs, by hand.
#[test]
fn the_resultant_is_that_of_all_loads() {
    let (medium, _) = manufactured(4, [1.0, 0.3], [1.0, 0.3]);
    let mut loads = Loads::default();
    loads.add_side(0, 0, [[1.0, 0.0], [-0.75, 0.5]]);
    loads.set_body_force(&medium, |_| [0.0, 2.0]).unwrap();
    let interior = Interior::fine(&medium, &loads).unwrap();
    let exterior = around(&interior, 1, 1, [1.0, 0.3]);
    let balance = Transmission::new(interior, &exterior).unwrap().balance;
    assert!((balance.force[0] - 0.25).abs() < 1e-14 && (balance.force[1] - 2.5).abs() < 1e-14);
    assert!((balance.scale - 4.25).abs() < 1e-14);
    assert!((balance.relative() - 0.25f64.hypot(2.5) / 4.25).abs() < 1e-14);
}

/// u = G x + b in the body only, as above, for bodies far stiffer and far softer than the medium.
#[test]
fn digits_are_lost_as_the_body_becomes_stiffer_than_the_medium() {
    let error = |young: f64, form| {
        let body = material([young, 0.3]);
        let grid = ell([0.0; 2], [0.25; 2], [4, 4]);
        let mut loads = Loads::default();
        let gradient = [[0.3, -0.2], [0.5, 0.1]];
        let field = |[x, y]: [f64; 2]| [0.3 * x - 0.2 * y + 0.2, 0.5 * x + 0.1 * y - 0.4];
        let outline = Outline::new(&grid).unwrap();
        outline.add_traction_jump(&grid, &mut loads, |_, n| traction(body.stress(gradient), n));
        let elasticity = Elasticity::new(0.3, steklov_elastic::Plane::Strain).unwrap();
        let medium = HeterogeneousBody::new(grid, vec![young; 16], elasticity).unwrap();
        let interior = Interior::fine(&medium, &loads).unwrap();
        let exterior = around(&interior, 1, 1, [1.0, 0.3]);
        let jump = exterior.space.interpolate(field);
        let solved = Transmission::new(interior, &exterior).unwrap().solve(&jump, form, Radiation::Decaying);
        let wanted: Vec<f64> = (0..medium.grid.nodes()).flat_map(|n| field(medium.grid.point(n))).collect();
        solved.map(|s| difference(&s.displacement, &wanted))
    };
    for form in FORMS {
        assert!(error(1e4, form).unwrap() < 1e-10);
        assert!((1e-12..1e-4).contains(&error(1e9, form).unwrap()));
        assert!(matches!(error(1e11, form), Err(CouplingError::Contrast { .. })));
    }
    assert!(error(1e-14, Form::TwoField).unwrap() < 1e-12);
    assert!(error(1e-14, Form::Schur).unwrap() < 1e-12);
    assert!(error(1e-9, Form::ThreeField).unwrap() < 1e-6);
    assert!(matches!(error(1e-11, Form::ThreeField), Err(CouplingError::Contrast { .. })));
}

#[test]
fn the_interface_has_the_same_bits_for_any_number_of_threads() {
    let solve = |threads: usize, form| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (medium, _) = manufactured(32, [20.0, 0.25], [2.0, 0.3]);
            let interior = Interior::fine(&medium, &Loads::default()).unwrap();
            // coarser than the trace: projected
            let mesh = steklov_bem_operators::Mesh::uniform(&interior.trace.polygon, 24, 5);
            let exterior = Medium::new(mesh, material([2.0, 0.3]), None).unwrap();
            let (problem, jump) = problem(interior, &exterior);
            let solved = problem.solve(&jump, form, Radiation::Decaying).unwrap();
            (solved.trace, solved.traction, solved.exterior_displacement)
        })
    };
    for form in FORMS {
        let one = solve(1, form);
        assert!([2, 3, 5].iter().all(|&threads| solve(threads, form) == one), "{form:?}");
    }
}

//! Where methods fail: each case reaches its tolerance or returns its named error; a silent wrong number is the only
//! outcome that fails. What is tested elsewhere is not repeated here:
//!
//! | where | tests |
//! |---|---|
//! | degenerate scales | here `degenerate_scales_are_not_met`; `bem-operators/tests/stability.rs` (any unit of length, L forced: `SingleLayerIndefinite`); `apps/steklov/src/study/stability/single_layer.rs` (where they are) |
//! | ν → ½ | here `nearly_incompressible_bodies_in_contact`; `bem-operators/tests/stability.rs` (without contact); `adaptive_references.rs` (unknowns of adaptive runs); `edges.rs` (too close to ½: not converged) |
//! | slivers, 1° corners, near-touching sides, length ratio 1e6, degree 16 | here, in contact; `bem-operators/tests/stability.rs`, `moments.rs` (V positive, patch test, entries) |
//! | re-entrant corners, points of mixed conditions, crack tips | `stability_singular.rs`; `adaptive_rates.rs`, `adaptive_references.rs` (corners, ends of contact); `closed_forms.rs` (level: crack, punch) |
//! | friction: F = 0, huge bound, contact nowhere and everywhere, zero gap, floating bodies (`RigidMotion`) | `contact_limits.rs`; here `friction_bounds_from_nothing_to_infinity` |
//! | multiplier choice | `contact/tests/stabilised.rs` (β of pairs with and without stabilisation); `multipliers.rs` (pressures on finer and shifted meshes of multipliers) |
//! | γ too large | `contact/tests/stabilised.rs` (critical γ); `multipliers.rs` (refused with both numbers) |
//! | Coulomb friction: none, huge, several or no solutions | `coulomb.rs`; `contact/src/tests` (all states of few nodes) |
//! | cycling | `stability_iterations.rs`; here `waves_do_not_make_the_solvers_cycle` |
//! | Uzawa with too large a step | here |
//! | data that are not finite | here; `apps/steklov/tests/broken_scenes.rs` (place in the file) |

use faer::Mat;
use steklov_bem_operators::{
    BemError, Condensation, Datum, Domain, Mesh, Operators, PairCache, Partition, Space, Steklov,
};
use steklov_contact::{Outcome, Problem, SideData, contact_boundary, kkt, newton, uzawa};
use steklov_document::SceneErrorKind;
use steklov_model::error::SolveError;
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::solve::one_mesh::solve;
use steklov_model::solve::solution::Solved;
use steklov_problem::{DataErrorKind, Scene};
use steklov_tests::{Case, On, View, answer, answer_on, attempt, full, parse, scene};

const SOLVERS: [&str; 2] = ["newton", "active-set"];

fn parsed(case: &Case) -> Scene {
    parse(&case.toml(&View::PLAIN), &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// max |a - b| / max |a| of the nodal displacements.
fn off(a: &Solved, b: &Solved) -> f64 {
    let (a, b) = (&a.displacement, &b.displacement);
    let scale = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs())) / scale
}

/// Both solvers converge within so many iterations, to one answer that satisfies all conditions.
fn both(what: &str, scene: &Scene, mesh: &Mesh, most: [usize; 2]) -> Solved {
    both_judged(what, scene, mesh, most, 1e-10)
}

fn both_judged(what: &str, scene: &Scene, mesh: &Mesh, most: [usize; 2], judge: f64) -> Solved {
    let (mut scene, mut cache) = (scene.clone(), PairCache::default());
    let [one, other] = [steklov_problem::Solver::Newton, steklov_problem::Solver::ActiveSet].map(|solver| {
        scene.method.solver = solver;
        let solved = solve(&scene, (mesh.clone(), None), false, &mut cache, &mut |_| Ok(()));
        solved.unwrap_or_else(|e| panic!("{what}: {e}")).0
    });
    let off = off(&one, &other);
    for (k, solved) in [&one, &other].into_iter().enumerate() {
        let contact = solved.contact.as_ref().expect("contact");
        let (iterations, worst) = (contact.solution.iterations, contact.audit.worst());
        println!("{what} by {}: {iterations} iterations, judge {worst:.1e}, one answer to {off:.1e}", SOLVERS[k]);
        assert!(contact.solution.converged() && worst <= judge, "{what} by {}: {worst:e}", SOLVERS[k]);
        assert!(iterations <= most[k], "{what} by {}: {iterations} iterations", SOLVERS[k]);
    }
    assert!(off <= 1e-9, "{what}: {off:e}");
    one
}

/// The rows of the contact table.
fn rows(solved: &Solved) -> Vec<ContactRow> {
    contact_rows(solved.trace(), solved.contact.as_ref().expect("contact"))
}

/// Squares of degenerate size (side 2.21318821 at ν = 0.3 with L = 1) and in any unit of length have the answer of the
/// square of side 1, for L is the diameter.
#[test]
fn degenerate_scales_are_not_met() {
    let on = |length: f64| {
        let case = Case::square(0.3)
            .on("floor", On::rough("0.01*x^2 - 0.002", "0.5"))
            .on("top", On::held("0", "0"))
            .method("elements = 24\ndegree = 3");
        let view = View { angle: 0.0, length, stress: 1.0 };
        let scene = parse(&case.toml(&view), &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        let a = answer(&scene);
        assert!(a.converged() && a.judged().1 <= 1e-10, "{length}: {:?}", a.judged());
        let mesh = first_mesh(&scene);
        let forced =
            Operators::assemble(&mesh, &Space::new(&mesh), &scene.body().material(), Some(1.0)).expect("a valid mesh");
        (a.solved.energies.total / length.powi(2), Steklov::new(forced, Domain::Interior).err())
    };
    let (plain, none) = on(1.0);
    assert_eq!(none, None);
    for length in [1e-9, 1e-3, 2.2, 2.21318821, 2.214, 2.5, 1e3, 1e9] {
        let (energy, forced) = on(length);
        println!("side {length}: J off by {:.1e}, with L = 1 {forced:?}", energy / plain - 1.0);
        assert!((energy / plain - 1.0).abs() <= 1e-10, "side {length}");
        // a Galerkin method has its own degenerate size, above the exact one
        let indefinite = matches!(forced, Some(BemError::SingleLayerIndefinite { length: 1.0, .. }));
        assert!(indefinite || length < 2.4, "side {length}");
        assert!(forced.is_none() || length > 2.21318821, "side {length}: {forced:?}");
    }
}

/// The error of J does not grow as the body becomes incompressible. Stresses carry rounding times λ/μ = 2ν/(1-2ν), and
/// the judge sees that.
#[test]
fn nearly_incompressible_bodies_in_contact() {
    let error = |poisson: &str| {
        let on = |elements: &str, degree: &str| {
            let material = format!("material.poisson={poisson}");
            let scene = scene("wedge-gap", &[elements, degree, &material]);
            let rounding = 1e-16 / (1.0 - 2.0 * scene.body().material().poisson);
            let judge = (10.0 * rounding).max(1e-10);
            let a = both_judged(&format!("ν = {poisson}"), &scene, &first_mesh(&scene), [15, 15], judge);
            a.energies.total
        };
        let fine = on("method.elements=256", "method.degree=2");
        (on("method.elements=64", "method.degree=1") / fine - 1.0).abs()
    };
    let ordinary = error("0.3");
    for poisson in ["0.49", "0.499", "0.4999", "0.4999999"] {
        let error = error(poisson);
        println!("ν = {poisson}: error {error:.2e}, at 0.3 {ordinary:.2e}");
        assert!(error < 2.0 * ordinary, "ν = {poisson}: {error:e} against {ordinary:e}");
    }
}

/// Uniform stress in thin, sharp and slit bodies on a smooth floor: the pressure is the load's.
#[test]
fn slivers_sharp_corners_and_slits() {
    let strip = [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-3], [0.0, 1e-3]];
    let needle = [[0.0, 0.0], [1.0, 0.0], [1.0, 1f64.to_radians().tan()]];
    let slit = [[-0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [5e-7, 1.0], [5e-7, 0.5], [-5e-7, 0.5], [-5e-7, 1.0], [-0.5, 1.0]];
    for (what, corners) in [("strip", &strip[..]), ("needle", &needle), ("slit", &slit)] {
        for (elements, degree) in [(12, 1), (24, 3), (30, 6)] {
            let names: Vec<String> = (0..corners.len()).map(|k| format!("e{k}")).collect();
            let case = Case::new(corners, &names.iter().map(String::as_str).collect::<Vec<_>>(), 0.3);
            // σ = -(1, 1) q: pressure all around
            let case = names.iter().enumerate().fold(case, |case, (k, name)| {
                let strain = -3.0 * 1.3 * 0.4 / 200.0;
                let gap = format!("{strain:?}*({:?} - y)", corners[0][1]);
                case.on(name, if k == 0 { On::smooth(&gap) } else { On::pressure("3") })
            });
            let scene = parsed(&case.method(&format!("elements = {elements}\ndegree = {degree}")));
            let a = both(what, &scene, &first_mesh(&scene), [12, 12]);
            let off = rows(&a).iter().fold(0.0, |m: f64, r| m.max((r.pressure / 3.0 - 1.0).abs()));
            println!("{what}, {elements} elements of degree {degree}: pressure off by {off:.1e}");
            assert!(off <= 1e-9, "{what}: {off:e}");
        }
    }
}

/// Neighbouring elements from 1/4 down to 1e-6 of the side, at corners, ends of contact and the gap's kink.
#[test]
fn graded_meshes_of_length_ratio_a_million() {
    for (name, half) in [("block-on-floor", 0.42901463), ("wedge-gap", 0.25999231)] {
        let scene = scene(name, &[]);
        let inner = [0.5 - half, 0.5, 0.5 + half].map(|s| (0, s));
        let towards: Vec<(usize, f64)> = (0..4).map(|k| (k, 0.0)).chain(inner).collect();
        let high = if name == "wedge-gap" { 6 } else { 3 };
        // degrees that rise from layer to layer, or with every second one
        let mut of_layers = vec![(1, 0.0), (high, 0.0), (1, 3.0 / high as f64)];
        if full() {
            of_layers.extend([(9 - high, 0.0), (1, 1.0)]);
        }
        for (degree, slope) in of_layers {
            let of_layer = |j: usize| degree + (slope * j as f64) as usize;
            let mesh = Mesh::graded(&scene.problem.outline, &towards, 8, 0.17, of_layer).expect("a valid mesh");
            let lengths = (0..mesh.len()).map(|e| mesh.length(e));
            let ratio = lengths.clone().fold(0.0, f64::max) / lengths.fold(1.0, f64::min);
            assert!(ratio > 1e6);
            both(&format!("{name}, degree {degree}, slope {slope}, ratio {ratio:.0e}"), &scene, &mesh, [40, 40]);
            if degree == 1 && slope == 0.0 {
                // the estimate has no trouble with such a mesh either
                answer_on(&scene, mesh);
            }
        }
    }
}

#[test]
fn degree_sixteen() {
    for (name, energy) in [("block-on-floor", -2.9933291930708), ("wedge-gap", 0.6471940159869)] {
        let scene = scene(name, &["method.elements=16", "method.degree=16"]);
        let a = both(name, &scene, &first_mesh(&scene), [15, 15]);
        let error = (a.energies.total / energy - 1.0).abs();
        println!("{name}: relative error of J {error:.1e}");
        assert!(error < 1e-5, "{error:e}");
    }
}

/// Bounds of zero, of jumps and of any size side by side.
#[test]
fn friction_bounds_from_nothing_to_infinity() {
    for bound in ["max(0, x)", "if(x > 0, 1e100, 0)", "1e8*x^2", "if(abs(x) < 0.2, 0, 0.5)"] {
        for (elements, degree) in [(64, 1), (32, 3), (16, 8)] {
            let case = Case::square(0.3)
                .on("floor", On::rough("0.01*x^2 - 0.002", bound))
                .on("top", On::held("0.001*y", "-0.001"))
                .on("right", On::traction("1", "0.5"))
                .method(&format!("elements = {elements}\ndegree = {degree}"));
            let scene = parsed(&case);
            let a = both(&format!("F = {bound}, p = {degree}"), &scene, &first_mesh(&scene), [15, 15]);
            assert!(rows(&a).iter().filter(|r| r.bound == 0.0).all(|r| r.shear == 0.0), "no bound, no shear");
        }
    }
}

/// Many small contact zones, where sets of active nodes change a lot.
#[test]
fn waves_do_not_make_the_solvers_cycle() {
    for waves in [10, 40, 100] {
        for (elements, degree) in [(64, 1), (128, 1), (64, 2), (32, 5), (16, 10)] {
            let case = Case::square(0.3)
                .on("floor", On::rough(&format!("0.003*sin({waves}*(x + 0.5))"), "0.3*abs(sin(7*x))"))
                .on("top", On::traction("5*y", "-40 + 30*x"))
                .on("left", On::held("0", "0"))
                .method(&format!("elements = {elements}\ndegree = {degree}"));
            let scene = parsed(&case);
            both(&format!("{waves} waves, {elements} of degree {degree}"), &scene, &first_mesh(&scene), [20, 20]);
        }
    }
}

/// A condensed problem: the square, its top clamped, its floor in smooth contact with an overlap.
fn condensed() -> Problem {
    let scene = parsed(&Case::square(0.3).on("floor", On::smooth("0")).on("top", On::held("0", "0")));
    let mesh = Mesh::uniform(&scene.problem.outline, 24, 2);
    let space = Space::new(&mesh);
    let gap = |site: &steklov_bem_operators::Site| 0.02 * site.point[0].powi(2) - 0.001;
    let gap = Datum { name: "gap", value: &gap, kinks: &|_| Vec::new(), rounding: None };
    let boundary = contact_boundary(
        &mesh,
        &space,
        &[SideData { side: 0, gap, bound: None, coefficient: None, beyond: None }],
        &|_| [None, None],
    );
    let boundary = boundary.expect("a floor");
    let operators = Operators::assemble(&mesh, &space, &scene.body().material(), None).expect("a valid mesh");
    let matrix: Mat<f64> = Steklov::new(operators, Domain::Interior).expect("V is positive").matrix;
    let held = (0..space.dofs()).filter(|d| space.points[d / 2][1] == 0.5).map(|d| (d, 0.0)).collect();
    let partition = Partition { kept: boundary.kept(), held, frames: boundary.frames() };
    let condensation = Condensation::new(matrix, &partition, &[]).expect("the top is held");
    let load = condensation.load(&vec![0.0; space.dofs()]).kept;
    Problem { stiffness: condensation.stiffness().expect("no fault").into(), load, nodes: boundary.contact }
}

/// The safe step converges and is known: 1.9/2 of it does too, a step beyond it is reported as diverged.
#[test]
fn uzawa_with_a_step_that_is_too_large() {
    let problem = condensed();
    let exact = newton(&problem, None).expect("a solution");
    let safe = uzawa(&problem, None, None).expect("a positive definite stiffness");
    assert!(safe.outcome == Outcome::Converged && kkt(&problem, &safe).worst() < 1e-9);
    let far = exact.displacement.iter().zip(&safe.displacement).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(far <= 1e-9 * 0.001, "{far:e}");
    // the default step is 1.9/λ, the limit 2/λ; find it by the outcome of forced steps
    let mut works: f64 = 1e-9;
    let mut fails: f64 = 1e12;
    while fails / works > 1.2 {
        let step = (works * fails).sqrt();
        let forced = uzawa(&problem, Some(step), None).expect("a positive definite stiffness");
        if forced.outcome == Outcome::Diverged {
            fails = step;
        } else {
            works = step;
        }
    }
    let forced = |step: f64| uzawa(&problem, Some(step), None).expect("a positive definite stiffness");
    let near = forced(works / 1.3);
    println!(
        "steps from {works:.3e} work, from {fails:.3e} fail; {} iterations near the limit, {} by default",
        near.iterations, safe.iterations
    );
    assert!(near.converged() && kkt(&problem, &near).worst() < 1e-9);
    assert!(forced(10.0 * fails).outcome == Outcome::Diverged && !forced(10.0 * fails).converged());
}

/// Data that are not finite are refused with side, point and expression when the scene is read, also where only a stretch between
/// the points that are looked at has them; those that cannot be integrated, with the side and what to change.
#[test]
fn data_that_are_not_finite() {
    for (condition, expression) in [
        (On::smooth("sqrt(x)"), "sqrt(x)"),
        (On::smooth("1/x"), "1/x"),
        (On::smooth("exp(1e4*x)"), "exp(1e4*x)"),
        (On::rough("0", "log(x)"), "log(x)"),
        (On::rough("0", "0 - 1"), "0 - 1"),
        (On::traction("0", "atan2(0, 0)/0"), "atan2(0, 0)/0"),
        (On::held("1/(x + 0.5)", "0"), "1/(x + 0.5)"),
        // finite wherever one looks first, but not between
        (On::traction("0", "sqrt((x - 0.123456)^2 - 2e-6)"), "sqrt((x - 0.123456)^2 - 2e-6)"),
        (On::smooth("log((x - 0.123456)^2 - 2e-6)"), "log((x - 0.123456)^2 - 2e-6)"),
    ] {
        let (late, message) = refusal(&condition);
        println!("{late}: {}", message.lines().next().unwrap_or_default());
        assert!(!late, "{message}");
        let point = ["floor", "(", "-0.5)", expression];
        assert!(point.iter().all(|w| message.contains(w)), "{message}");
    }
    for (condition, expression) in [
        (On::traction("1/(x - 0.123456)", "0"), "1/(x - 0.123456)"),
        (On::pressure("log(abs(x - 0.25))/abs(x - 0.25)"), "log(abs(x - 0.25))"),
    ] {
        let (_, message) = refusal(&condition);
        assert!(["floor", expression].iter().all(|w| message.contains(w)), "{message}");
    }
}

/// The message with which a condition on the floor is refused, and whether only solving finds it.
fn refusal(condition: &On) -> (bool, String) {
    let case = Case::square(0.3).on("top", On::held("0", "0")).on("floor", condition.clone());
    match parse(&case.method("elements = 20\ndegree = 3").toml(&View::PLAIN), &[]) {
        Err(error) => {
            assert_eq!(error.kind, SceneErrorKind::Data(DataErrorKind::Data), "{}", error.render());
            (false, error.render())
        }
        Ok(scene) => match attempt(&scene, first_mesh(&scene)).err() {
            Some(SolveError::Data(error)) => (true, error.to_string()),
            other => panic!("{condition:?}: {other:?}"),
        },
    }
}

/// Young's modulus and lengths at the ends of what numbers can be.
#[test]
fn very_soft_and_very_stiff_bodies() {
    let on = |view: View| {
        let case = Case::square(0.3)
            .on("floor", On::rough("0.01*x^2 - 0.002", "0.5"))
            .on("top", On::held("0", "0"))
            .method("elements = 24\ndegree = 2");
        let scene = parse(&case.toml(&view), &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        let a = answer(&scene);
        assert!(a.converged() && a.judged().1 <= 1e-10, "{view:?}: {:?}", a.judged());
        println!("{view:?}: {:?}", a.judged());
        a.solved.energies.total / (view.stress * view.length.powi(2))
    };
    let plain = on(View::PLAIN);
    for (length, stress) in [(1.0, 1e-30), (1.0, 1e30), (1e-12, 1.0), (1e12, 1.0), (1e-6, 1e20)] {
        let j = on(View { angle: 0.0, length, stress });
        assert!((j / plain - 1.0).abs() <= 1e-10, "{length} {stress}: {j} and {plain}");
    }
}

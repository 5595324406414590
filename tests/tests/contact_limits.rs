//! Limits of contact and friction, and equalities between problems.

use faer::Mat;
use proptest::prelude::*;
use steklov_bem_operators::Mesh;
use steklov_contact::{Condition, ContactError, ContactNode, Problem};
use steklov_model::error::SolveError;
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_problem::Scene;
use steklov_tests::{Answer, Case, On, View, answer, answer_on, attempt, parse, scene, summary};

fn parsed(case: &Case) -> Scene {
    parse(&case.toml(&View::PLAIN), &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn solved(case: &Case) -> Answer {
    answer(&parsed(case))
}

fn refused(case: &Case) -> SolveError {
    let scene = parsed(case);
    attempt(&scene, first_mesh(&scene)).err().expect("the problem has no solution")
}

/// max |a - b| / max |a|.
fn off(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs())) / scale
}

fn pressures(a: &Answer) -> Vec<f64> {
    a.rows.iter().map(|r| r.pressure).collect()
}

fn close(what: &str, off: f64, tolerance: f64) {
    println!("{what}: {off:.1e}");
    assert!(off <= tolerance, "{what}: {off:e} > {tolerance:e}");
}

/// A held square on a curved obstacle, loaded unevenly, so that part of the floor is in contact.
fn held(friction: Option<&str>, method: &str) -> Case {
    let gap = "0.004*(x - 0.1)^2 - 0.0003";
    Case::square(0.3)
        .on("top", On::held("0.0005 + 0.001*x", "-0.0005"))
        .on("right", On::traction("0.5", "1 - y"))
        .on("floor", friction.map_or(On::smooth(gap), |f| On::rough(gap, f)))
        .method(method)
}

const METHOD: &str = "elements = 32\ndegree = 2";

#[test]
fn a_bound_of_zero_is_no_friction() {
    let (rough, smooth) = (solved(&held(Some("0"), METHOD)), solved(&held(None, METHOD)));
    close("displacement", off(&smooth.solved.displacement, &rough.solved.displacement), 1e-12);
    close("pressure", off(&pressures(&smooth), &pressures(&rough)), 1e-12);
    assert_eq!(rough.solved.energies.friction_work, 0.0);
    let other = solved(&held(Some("0.01"), METHOD));
    assert!(off(&smooth.solved.displacement, &other.solved.displacement) > 1e-4, "friction of 0.01 is seen");
}

/// A bound that is never reached holds the floor in both directions: the linear problem with that floor clamped.
#[test]
fn an_unreachable_bound_is_a_clamp() {
    let on_floor = |floor: On| {
        let case = Case::square(0.3).on("floor", floor).on("top", On::traction("1", "-20*(1 + x)"));
        solved(&case.method("elements = 24\ndegree = 3"))
    };
    let clamped = on_floor(On::held("0", "0"));
    for bound in ["1e3", "1e9", "1e100"] {
        let stuck = on_floor(On::rough("0", bound));
        // all pressures are positive, so contact is everywhere
        assert!(stuck.rows.iter().all(|r| r.pressure > 0.0 && r.status == 1), "bound {bound}");
        close("displacement", off(&clamped.solved.displacement, &stuck.solved.displacement), 1e-10);
        let forces = [clamped.solved.reactions[0].1, stuck.solved.reactions[0].1];
        close("reaction", off(&forces[0], &forces[1]), 1e-10);
    }
}

#[test]
fn all_solvers_have_one_answer() {
    for friction in [None, Some("0.2"), Some("0.3 + 0.5*x"), Some("if(x > 0.1, 0.4, 0)"), Some("1e6")] {
        for (elements, degree) in [(40, 1), (24, 3), (16, 7)] {
            let by = |solver: &str| {
                solved(&held(friction, &format!("elements = {elements}\ndegree = {degree}\nsolver = \"{solver}\"")))
            };
            let [newton, active_set, uzawa] = ["newton", "active-set", "uzawa"].map(by);
            for (name, other) in [("active-set", &active_set), ("uzawa", &uzawa)] {
                assert!(other.converged() && other.judged().1 <= 1e-9, "{name} {friction:?} {degree}");
                let what = format!("{name} with {friction:?}, p = {degree}");
                let displacement = off(&newton.solved.displacement, &other.solved.displacement);
                // Uzawa's iteration ends at a residual of 1e-11, which the condition number of the dual magnifies
                let tolerance = if name == "uzawa" { 1e-7 } else { 1e-9 };
                close(&what, displacement.max(off(&pressures(&newton), &pressures(other))), tolerance);
            }
        }
    }
}

/// Out of reach the obstacle is not there; pressed everywhere without friction it prescribes the normal displacement.
#[test]
fn contact_nowhere_and_everywhere_are_linear_problems() {
    let on_floor = |floor: Option<On>| {
        let case = Case::square(0.3).on("top", On::held("0", "0")).on("right", On::traction("1", "2*y"));
        let case = match floor {
            Some(floor) => case.on("floor", floor),
            None => case,
        };
        solved(&case.method("elements = 24\ndegree = 3"))
    };
    let apart = on_floor(Some(On::rough("0.5 + x^2", "0")));
    let free = on_floor(None);
    close("apart", off(&free.solved.displacement, &apart.solved.displacement), 1e-12);
    assert!(apart.contact().length == 0.0 && apart.contact().force == [0.0; 2] && apart.judged().1 <= 1e-10);
    assert!(apart.rows.iter().all(|r| r.pressure == 0.0 && r.status == 0));

    // the body is lifted by 0.1 against the top
    let pressed = on_floor(Some(On::smooth("-0.1")));
    let lifted = on_floor(Some(On::Partly(["free".into(), "0.1".into()], ["0".into(), "0".into()])));
    assert!(pressed.rows.iter().all(|r| r.pressure > 0.0));
    close("overlap", off(&lifted.solved.displacement, &pressed.solved.displacement), 1e-11);
    close("length", (pressed.contact().length - 1.0).abs(), 1e-13);
}

/// Resting on the obstacle at zero gap without a load, pressed on or lifted off it by a small one.
#[test]
fn touching_at_zero_gap() {
    for solver in ["newton", "active-set"] {
        let on_top = |top: On| {
            let case =
                Case::square(0.3).on("left", On::held("0", "0")).on("floor", On::rough("0", "0.3")).on("top", top);
            solved(&case.method(&format!("elements = 24\ndegree = 3\nsolver = \"{solver}\"")))
        };
        let rest = on_top(On::traction("0", "0"));
        assert!(rest.converged() && rest.solved.displacement.iter().all(|u| *u == 0.0), "{solver}");
        assert!(rest.contact().max_pressure == 0.0 && rest.judged().1 == 0.0, "{solver}");
        for sign in [1.0, -1.0] {
            let a = on_top(On::traction("0", &format!("{:?}", sign * 1e-9)));
            let (iterations, worst) = a.judged();
            println!("{solver}: load {sign}, {iterations} iterations, judge {worst:.1e}");
            assert!(a.converged() && worst <= 1e-10, "{solver}: {worst:e}");
        }
    }
}

fn floating(friction: Option<&str>, top: On) -> Case {
    let floor = friction.map_or(On::smooth("0"), |f| On::rough("0", f));
    Case::square(0.3).on("floor", floor).on("top", top).method("elements = 16\ndegree = 2")
}

/// What is not held and not balanced is named: the motion, the loads' work and the resistance.
#[test]
fn a_floating_body_is_held_by_contact_and_friction_or_refused() {
    let direction = |error: SolveError| {
        let text = error.to_string();
        let SolveError::Contact(ContactError::RigidMotion { motion, work, resistance, .. }) = error else {
            panic!("another error: {text}");
        };
        println!("{text}");
        assert!(work > resistance, "{work} and {resistance}");
        motion
    };
    // pushed sideways by 1 without friction, and with friction of 0.9; 1.1 holds it
    for friction in [None, Some("0.9")] {
        let motion = direction(refused(&floating(friction, On::traction("1", "-50"))));
        let along = motion.translation;
        assert!(motion.rotation.abs() < 1e-9 && along[0] > 0.0 && along[1].abs() < 1e-9 * along[0], "{motion:?}");
    }
    let stays = solved(&floating(Some("1.1"), On::traction("1", "-50")));
    close("friction carries the push", off(&[-1.0, 50.0], &stays.contact().force), 1e-11);
    // lifted
    let motion = direction(refused(&floating(Some("1e6"), On::traction("0", "1"))));
    assert!(motion.at([0.0, -0.5])[1] > 0.0, "{motion:?}");
    // overturned: the moment about the corner of the floor is 0.5 - 0.4 for a load of 1
    let motion = direction(refused(&floating(Some("1e6"), On::traction("1", "-1.5"))));
    assert!(motion.rotation < 0.0, "{motion:?}");
    // balanced loads leave the position free: reported, and rest along it
    let balanced = solved(&floating(None, On::traction("0", "-50*(1 + x)")));
    assert_eq!(balanced.solved.free_motions.len(), 1);
    close("balanced", off(&[0.0, 50.0], &balanced.contact().force), 1e-11);
}

/// Balanced loads on a body that its obstacle does not touch: σ_xx = -40 and no contact, wherever the body is.
#[test]
fn contact_that_never_closes_leaves_a_body_to_its_loads() {
    let on_floor = |floor: On, sides: &str| {
        let case =
            Case::square(0.3).on("floor", floor).on("left", On::pressure(sides)).on("right", On::pressure(sides));
        case.method("elements = 16\ndegree = 2")
    };
    let strain = |a: &Answer| {
        let (space, u) = (&a.solved.space, &a.solved.displacement);
        let at = |x: f64, y: f64| {
            let node = space.points.iter().position(|p| (p[0] - x).hypot(p[1] - y) < 1e-12).expect("a corner");
            [u[2 * node], u[2 * node + 1]]
        };
        [at(0.5, -0.5)[0] - at(-0.5, -0.5)[0], at(0.5, 0.5)[1] - at(0.5, -0.5)[1]]
    };
    let free = solved(&on_floor(On::traction("0", "0"), "40"));
    for gap in ["1", "1 + x"] {
        let squeezed = solved(&on_floor(On::smooth(gap), "40"));
        assert!(squeezed.converged() && squeezed.contact().length == 0.0 && squeezed.contact().force == [0.0; 2]);
        assert_eq!(squeezed.solved.free_motions.len(), 3);
        close("strain", off(&strain(&free), &strain(&squeezed)), 1e-12);
    }
    let rest = solved(&on_floor(On::smooth("0"), "0"));
    assert!(rest.solved.displacement.iter().all(|u| *u == 0.0) && rest.contact().force == [0.0; 2]);
    // an obstacle into which it bulges, or lies, pushes it off: it does not press then
    for (gap, sides) in [("0", "40"), ("-0.01", "0"), ("-0.01*(1 + x)", "40")] {
        let pushed = solved(&on_floor(On::smooth(gap), sides));
        assert!(pushed.converged() && pushed.contact().force == [0.0; 2] && pushed.contact().length == 0.0);
        let least = pushed.rows.iter().map(|r| r.gap - r.normal_displacement).fold(f64::INFINITY, f64::min);
        close("it touches", least.abs(), 1e-12);
        for row in &pushed.rows {
            let exact: f64 =
                [0.0, -0.01, -0.01 * (1.0 + row.point[0])][["0", "-0.01"].iter().position(|g| *g == gap).unwrap_or(2)];
            close("gap", (row.gap - exact).abs(), 1e-12);
        }
        if sides == "40" {
            close("strain", off(&strain(&free), &strain(&pushed)), 1e-9);
            close("energy", off(&[free.solved.energies.total], &[pushed.solved.energies.total]), 1e-12);
        }
    }
}

/// Loads, reactions and contact forces of a body beside whose contact side another one is held add up to 0.
#[test]
fn forces_balance_beside_a_held_side() {
    let load = [3.0 + 0.3, -20.0 - 0.7];
    for degree in [1, 2, 5] {
        for (words, left) in [
            ("clamped", On::held("0", "0")),
            ("moved", On::held("0.001*y", "0.002*(y + 0.5)")),
            ("held along x", On::Partly(["0".into(), "free".into()], ["0".into(), "0".into()])),
            ("moved along x", On::Partly(["0.001 + 0.001*y".into(), "free".into()], ["0".into(), "0".into()])),
            ("held along y", On::Partly(["free".into(), "0".into()], ["0".into(), "0".into()])),
            ("moved along y", On::Partly(["free".into(), "-0.001*y".into()], ["0".into(), "0".into()])),
        ] {
            for friction in ["0", "0.5", "1e3"] {
                let free_x = words.ends_with("along y");
                let mut case = Case::square(0.3)
                    .on("left", left.clone())
                    .on("floor", On::rough("0.001*(x + 0.5)^2", friction))
                    .on("top", On::traction("3", "-20"))
                    .method(&format!("elements = 20\ndegree = {degree}"));
                case.body_force = Some([0.3, -0.7]);
                if free_x && friction != "1e3" {
                    continue; // nothing holds it along x
                }
                let a = solved(&case);
                let (_, worst) = a.judged();
                let sum = a.solved.reactions.iter().fold(load, |s, r| [s[0] + r.1[0], s[1] + r.1[1]]);
                let rest = sum[0].abs().max(sum[1].abs()) / load[1].abs();
                println!(
                    "p {degree} {words} F {friction}: sum {rest:.1e}, judge {worst:.1e}, {:?}",
                    a.solved.reactions
                );
                assert!(rest <= 1e-11 && worst <= 1e-10, "p {degree} {words} F {friction}: {rest:e} {worst:e}");
            }
        }
    }
}

proptest! {
    /// A node with one component held at what is 0 but for rounding, at the end of an oblique side: it can slide along
    /// the other component to satisfy u_n ≤ g, and a finite friction forbids nothing.
    #[test]
    fn rounding_in_a_held_displacement_is_no_contradiction(
        angle in 0.1..1.4f64, weight in 1e-3..1.0f64, bound in 0.1..10.0f64, gap in -1e-18..1e-18f64, offset in -1e-18..1e-18f64,
    ) {
        let condition = Condition {
            normal: [angle.cos(), 0.0],
            tangent: [angle.sin(), 0.0],
            normal_weight: weight,
            tangent_weight: weight,
            gap,
            slip_offset: offset,
            bound,
            coefficient: 0.0,
        };
        let nodes = vec![ContactNode { first: 0, unknowns: 1, conditions: vec![condition] }];
        let problem = Problem { stiffness: Mat::from_fn(1, 1, |_, _| 1.0).into(), load: vec![1.0], nodes };
        prop_assert_eq!(problem.check(), Ok(()));
    }
}

/// Moments of a floating body: the multiplier of a node acts at the node, for ∫ψ_i x = D_i x_i.
#[test]
fn moments_balance_on_a_floating_body() {
    for degree in [1, 2, 5] {
        let case = floating(Some("0.4"), On::traction("0.3", "-20 - 6*x"));
        let a = solved(&case.method(&format!("elements = 20\ndegree = {degree}")));
        let moment: f64 = a
            .rows
            .iter()
            .map(|r| {
                let t = [-r.normal[1], r.normal[0]];
                let force = [0, 1].map(|i| -r.weight * (r.pressure * r.normal[i] + r.shear * t[i]));
                r.point[0] * force[1] - r.point[1] * force[0]
            })
            .sum();
        // of the load at y = ½ about the centre: -6∫x² - 0.3/2
        let load = -6.0 / 12.0 - 0.15;
        close("moment", (moment + load).abs() / load.abs(), 1e-11);
        close("forces", off(&[-0.3, 20.0], &a.contact().force), 1e-11);
    }
}

/// The symmetric block and its half on a roller: two different boundaries, so equal in the limit only.
#[test]
fn half_a_symmetric_block_on_a_roller_is_half_of_it() {
    let a = 0.42901463;
    let degree = 8;
    let full = scene("block-on-floor", &["method.solver=\"active-set\""]);
    let (layers, ratio) = (8, 0.17);
    let towards: Vec<(usize, f64)> =
        (0..4).map(|k| (k, 0.0)).chain([0.5 - a, 0.5, 0.5 + a].map(|s| (0, s))).chain([(2, 0.5)]).collect();
    let mesh = Mesh::graded(&full.problem.outline, &towards, layers, ratio, |_| degree).expect("a valid mesh");
    let full = answer_on(&full, mesh);

    let corners = [[0.0, -0.5], [0.5, -0.5], [0.5, 0.5], [0.0, 0.5]];
    let half = Case::new(&corners, &["floor", "right", "top", "middle"], 0.3)
        .on("floor", On::rough("0", "0.3"))
        .on("right", On::traction("-400*(y+0.5)*(0.5-y)*exp(-10*(y+0.3)^2)", "10*(y+0.5)*(0.5-y)"))
        .on("top", On::traction("0", "-500*(0.5-x)^2*(0.5+x)^2"))
        .on("middle", On::Partly(["0".into(), "free".into()], ["0".into(), "0".into()]))
        .method("solver = \"active-set\"");
    let half = parsed(&half);
    let towards: Vec<(usize, f64)> = (0..4).map(|k| (k, 0.0)).chain([(0, 2.0 * a)]).collect();
    let mesh = Mesh::graded(&half.problem.outline, &towards, layers, ratio, |_| degree).expect("a valid mesh");
    let half = answer_on(&half, mesh);

    println!("dofs {} and {}", full.solved.space.dofs(), half.solved.space.dofs());
    let (j, i) = (full.solved.energies.total, half.solved.energies.total);
    close("energy", (2.0 * i / j - 1.0).abs(), 1e-9);
    close("force", (2.0 * half.contact().force[1] / full.contact().force[1] - 1.0).abs(), 1e-9);
    let find = |x: [f64; 2]| full.rows.iter().find(|r| (r.point[0] - x[0]).abs() < 1e-12).expect("the same nodes");
    let largest = full.contact().max_pressure;
    let worst = half.rows.iter().filter(|r| r.point[0] > 0.0).fold(0.0, |m: f64, r| {
        let d = (r.pressure - find(r.point).pressure).abs();
        m.max(d * r.weight.min(find(r.point).weight))
    });
    close("nodal forces", worst / largest, 1e-9);
}

/// A block pressed into the smooth corner of a floor and a wall: constant stress.
#[test]
fn a_block_in_the_corner_of_two_walls() {
    for degree in [1, 3, 6] {
        for rough in [false, true] {
            let contact = || if rough { On::rough("0", "0.5") } else { On::smooth("0") };
            let case = Case::square(0.3)
                .on("floor", contact())
                .on("left", contact())
                .on("right", On::pressure("7"))
                .on("top", On::pressure("11"))
                .method(&format!("elements = 15\ndegree = {degree}"));
            let a = solved(&case);
            assert!(a.converged() && a.judged().1 <= 1e-10);
            let resultant = a.solved.reactions.iter().fold([0.0; 2], |s, r| [s[0] + r.1[0], s[1] + r.1[1]]);
            close("resultant", off(&[7.0, 11.0], &resultant), 1e-11);
            if !rough {
                let exact: Vec<f64> = a.rows.iter().map(|r| if r.normal[0] < -0.5 { 7.0 } else { 11.0 }).collect();
                close("pressures", off(&exact, &pressures(&a)), 1e-11);
                let strain = |one: f64, other: f64| -1.3 / 200.0 * (0.7 * one - 0.3 * other);
                let (e_x, e_y) = (strain(7.0, 11.0), strain(11.0, 7.0));
                let exact = a.solved.space.interpolate(|x| [e_x * (x[0] + 0.5), e_y * (x[1] + 0.5)]);
                close("displacement", off(&exact, &a.solved.displacement), 1e-11);
            }
        }
    }
}

/// A block pressed on the floor beside a roller: uniaxial stress, also in the node that the roller holds along x.
#[test]
fn a_roller_beside_a_floor_is_exact() {
    for degree in [1, 2, 5] {
        for friction in [None, Some("0")] {
            let case = Case::square(0.3)
                .on("floor", friction.map_or(On::smooth("0.01"), |f| On::rough("0.01", f)))
                .on("left", On::Partly(["0".into(), "free".into()], ["0".into(), "0".into()]))
                .on("top", On::pressure("8"))
                .method(&format!("elements = 15\ndegree = {degree}"));
            let a = solved(&case);
            close("pressures", off(&vec![8.0; a.rows.len()], &pressures(&a)), 1e-11);
            let exact = a
                .solved
                .space
                .interpolate(|x| [0.04 * 1.3 * 0.3 * (x[0] + 0.5), -0.01 - 0.04 * 1.3 * 0.7 * (x[1] + 0.5)]);
            close("displacement", off(&exact, &a.solved.displacement), 1e-11);
            close("roller", a.solved.reactions.iter().fold(0.0, |m: f64, r| m.max(r.1[0].abs())), 1e-11 * 8.0);
        }
    }
}

/// Squeezed between a floor and a ceiling that are too close by 2d: uniaxial stress E/(1-ν²) 2d.
#[test]
fn two_contact_sides_squeeze_a_block() {
    for degree in [1, 2, 5] {
        let case = Case::square(0.3).on("floor", On::smooth("-0.001")).on("top", On::smooth("-0.001"));
        let a = solved(&case.method(&format!("elements = 13\ndegree = {degree}")));
        let exact = vec![200.0 / (1.0 - 0.09) * 0.002; a.rows.len()];
        close("pressures", off(&exact, &pressures(&a)), 1e-11);
        assert!(a.solved.reactions[0].1[1] > 0.0 && a.solved.reactions[1].1[1] < 0.0);
    }
}

/// Overlap d on all four sides of a square: stress E/((1+ν)(1-2ν)) 2d all around, also under friction.
#[test]
fn contact_all_around_is_uniform_compression() {
    for (degree, rough) in [(1, false), (2, true), (5, false)] {
        let side = || if rough { On::rough("-0.001", "0") } else { On::smooth("-0.001") };
        let case = Case::square(0.3).on("floor", side()).on("right", side()).on("top", side()).on("left", side());
        let a = solved(&case.method(&format!("elements = 14\ndegree = {degree}")));
        let exact = vec![200.0 / (1.3 * 0.4) * 0.002; a.rows.len()];
        close("pressures", off(&exact, &pressures(&a)), 1e-11);
    }
}

/// A strip between rollers so narrow that its floor has one element in the first mesh: both of its ends are held, and the element is
/// halved for a node that carries the multiplier. Pressed on all of its floor, the force is the load.
#[test]
fn a_floor_of_one_element_between_rollers_is_solved() {
    let text =
        "body = { corners = [[0, 0], [0.05, 0], [0.05, 3], [0, 3]], sides = [\"floor\", \"right\", \"top\", \"left\"] }
        material = { young = 1, poisson = 0.3 }
        sides.floor.contact = {}
        sides.left.displacement = [0, \"free\"]
        sides.right.displacement = [0, \"free\"]
        sides.top.pressure = 0.01\n";
    let told = summary(&parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
    let contact = told.contact.as_ref().expect("contact");
    assert!(told.converged && (contact.force[1] - 5e-4).abs() < 1e-14, "{contact:?}");
    assert!((contact.length - 0.05).abs() < 1e-15 && (contact.max_pressure - 0.01).abs() < 1e-12, "{contact:?}");
}

//! Edges of what a scene may ask: held ends beside contact, one-element contact, kinks of the gap, lost digits.

use steklov_model::answer::report::{contact_summary, located};
use steklov_model::error::SolveError;
use steklov_model::solve::contact_rows::contact_rows;
use steklov_problem::DataErrorKind;
use steklov_tests::{adapt, answer, attempt, parse};

/// A unit square of E = 10, ν = 0.3 with the given tables of sides and method.
fn square(corners: &str, tables: &str) -> String {
    format!(
        "[body]\ncorners = {corners}\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
         [material]\nyoung = 10.0\npoisson = 0.3\n{tables}"
    )
}

const UNIT: &str = "[[0, 0], [1, 0], [1, 1], [0, 1]]";
const PRESSED: &str = "[sides.top]\ntraction = [\"0\", \"-1\"]\n";

fn method(elements: usize, degree: usize) -> String {
    format!("[method]\nelements = {elements}\ndegree = {degree}\n")
}

/// Largest entry of loads + reactions, (0, -1) being the load.
fn imbalance(reactions: &[(String, [f64; 2])]) -> f64 {
    let sum = reactions.iter().fold([0.0, -1.0], |s, (_, r)| [s[0] + r[0], s[1] + r[1]]);
    sum[0].abs().max(sum[1].abs())
}

#[test]
fn reactions_balance_where_one_node_carries_both_held_ends() {
    let sides = "[sides.floor]\ncontact = { gap = \"0\", friction = { tresca = \"0.1\" } }\n\
                 [sides.left]\ndisplacement = [\"0\", \"-0.01\"]\n[sides.right]\ndisplacement = [\"0\", \"-0.01\"]\n";
    for (elements, degree) in [(4, 2), (8, 1), (4, 3), (8, 2)] {
        // the walls press the ends to the floor, which lies 0.01 below them
        let sides = sides.replace("gap = \"0\"", "gap = \"0.01\"");
        let scene =
            parse(&square(UNIT, &format!("{sides}{PRESSED}{}", method(elements, degree))), &[]).expect("a scene");
        let reactions = answer(&scene).solved.reactions;
        let of = |name: &str| reactions.iter().find(|r| r.0 == name).expect("a reaction").1;
        assert!(imbalance(&reactions) < 1e-12, "{reactions:?}");
        // mirror images
        assert!((of("left")[1] - of("right")[1]).abs() < 1e-12 && (of("left")[0] + of("right")[0]).abs() < 1e-12);
    }
}

#[test]
fn reactions_balance_where_the_neighbour_is_itself_half_held() {
    let sides = "[sides.floor]\ncontact = { gap = \"0\", friction = { tresca = \"0.1\" } }\n\
                 [sides.left]\ndisplacement = [\"0\", \"0\"]\n[sides.right]\ndisplacement = [\"0\", \"free\"]\n";
    let sloped = "[[0, 0], [1, -0.5], [1, 1], [0, 1]]";
    for (elements, degree) in [(4, 1), (8, 1), (4, 2), (4, 4)] {
        let scene =
            parse(&square(sloped, &format!("{sides}{PRESSED}{}", method(elements, degree))), &[]).expect("a scene");
        assert!(imbalance(&answer(&scene).solved.reactions) < 1e-12);
    }
}

#[test]
fn an_end_held_inside_the_obstacle_is_refused() {
    let sides = "[sides.floor]\ncontact = { gap = \"0\" }\n[sides.left]\ndisplacement = [\"0\", \"-0.02\"]\n\
                 [sides.right]\ndisplacement = [\"0\", \"free\"]\n";
    let scene = parse(&square(UNIT, &format!("{sides}{PRESSED}{}", method(8, 2))), &[]).expect("a scene");
    let error = attempt(&scene, steklov_model::mesh::first_mesh::first_mesh(&scene))
        .err()
        .expect("no solution has finite energy");
    assert!(matches!(&error, SolveError::Data(e) if e.kind == DataErrorKind::Conflict), "{error}");
    // at the obstacle it may be held
    let fine = square(UNIT, &format!("{sides}{PRESSED}{}", method(8, 2))).replace("-0.02", "0");
    assert!(answer(&parse(&fine, &[]).expect("a scene")).converged());
}

#[test]
fn a_floating_body_on_one_element_is_solved() {
    for degree in [1, 2] {
        let text = square(UNIT, &format!("[sides.floor]\ncontact = {{ gap = \"0\" }}\n{PRESSED}{}", method(1, degree)));
        let answer = answer(&parse(&text, &[]).expect("a scene"));
        let contact = answer.summary.as_ref().expect("contact");
        assert!(answer.converged());
        assert!((contact.force[1] - 1.0).abs() < 1e-12 && (contact.max_pressure - 1.0).abs() < 1e-11);
    }
}

#[test]
fn loads_that_cancel_up_to_rounding_hold_a_floating_body() {
    // (cos(pi/2), -1): the horizontal force is 6e-17
    let text = square(
        UNIT,
        &format!(
            "[sides.floor]\ncontact = {{ gap = \"0\" }}\n[sides.top]\ntraction = [\"cos(pi/2)\", \"-sin(pi/2)\"]\n{}",
            method(8, 2)
        ),
    );
    assert!(answer(&parse(&text, &[]).expect("a scene")).converged());
}

#[test]
fn infinite_pressure_is_told_at_ridges_and_steps_in_any_unit() {
    let held = "[sides.top]\ndisplacement = [\"0\", \"-0.01\"]\n";
    for (gap, unbounded) in [
        ("abs(x - 0.5)/10", true),
        ("1e-6*abs(x - 0.5)", true),
        ("if(x < 0.5, 0, 0.002)", true),
        ("if(x > 0.5, 0, 0.002)", true),
        ("(x - 0.5)^2/10", false),
        ("0.002 - abs(x - 0.5)/1000", false),
        ("1e-6*(x - 0.5)^2", false),
    ] {
        let text = square(UNIT, &format!("[sides.floor]\ncontact = {{ gap = \"{gap}\" }}\n{held}{}", method(32, 2)));
        let contact = answer(&parse(&text, &[]).expect("a scene")).summary.expect("contact");
        assert_eq!(contact.max_pressure_unbounded, unbounded, "{gap}");
    }
}

#[test]
fn an_unloaded_body_far_from_its_obstacle_rests() {
    for friction in ["", ", friction = { tresca = \"0.3\" }"] {
        let contact = format!("[sides.floor]\ncontact = {{ gap = \"1\"{friction} }}\n");
        for lowered in ["0", "-0.01"] {
            let held = format!("[sides.top]\ndisplacement = [\"0\", \"{lowered}\"]\n");
            let text = square(UNIT, &format!("{contact}{held}{}", method(16, 1)));
            let scene = parse(&text, &[]).expect("a scene");
            let run = adapt(&scene).expect("a rest");
            assert!(run.converged(), "{friction} {lowered}: {:?}", run.reason);
            // rounding of E u²
            assert!(run.last.energies.total.abs() < 1e-14 * 10.0 * 0.01f64.powi(2), "{}", run.last.energies.total);
        }
    }
}

/// An answer that is nothing everywhere is exact, whatever the obstacle looks like where it touches.
#[test]
fn an_unloaded_body_at_rest_on_its_obstacle_is_not_doubted() {
    for gap in ["0", "0.01*abs(x-0.37)", "0.002*max(0, 1-abs(x-0.41)/3e-4)", "0.01*(1-cos(6*pi*x))"] {
        let held = "[sides.right]\ndisplacement = [0, 0]\n";
        let text = square(UNIT, &format!("[sides.floor]\ncontact = {{ gap = \"{gap}\" }}\n{held}"));
        let scene = parse(&text, &[]).expect("a scene");
        let run = adapt(&scene).expect("a rest");
        let estimate = run.step().estimate();
        assert!(run.converged() && run.last.displacement.iter().all(|u| *u == 0.0), "{gap}");
        assert_eq!((estimate.error, &estimate.doubts[..]), (0.0, &[][..]), "{gap}");
        let solved = run.last.contact.as_ref().expect("contact");
        let rows = contact_rows(run.last.trace(), solved);
        let contact =
            contact_summary(&scene, run.last.trace(), solved, &rows, located(&scene, &run.step().layout.located));
        assert_eq!((contact.length, contact.ends.unwrap_or_default().len()), (0.0, 0), "{gap}");
    }
}

#[test]
fn a_tiny_load_under_a_wide_gap_is_solved_to_the_last_digit() {
    // linear: J / q² does not depend on q
    let energy = |load: f64, solver: &str| {
        let sides = format!(
            "[sides.floor]\ncontact = {{ gap = \"1\" }}\n[sides.top]\ndisplacement = [\"0\", \"0\"]\n\
             [sides.left]\ntraction = [\"{load:e}\", \"0\"]\n"
        );
        let text = square(UNIT, &format!("{sides}{}solver = \"{solver}\"\n", method(16, 1)));
        let answer = answer(&parse(&text, &[]).expect("a scene"));
        assert!(answer.converged() && answer.solved.balanced, "{solver}, {load:e}");
        answer.solved.energies.total / (load * load)
    };
    let exact = energy(1e-3, "active-set");
    for solver in ["newton", "active-set"] {
        for load in [1e-6, 1e-9, 1e-12] {
            let error = energy(load, solver) / exact - 1.0;
            assert!(error.abs() < 1e-10, "{solver}, load {load:e}: {error:e}");
        }
    }
}

#[test]
fn lost_digits_are_no_solution() {
    let text = square(UNIT, &format!("[sides.floor]\ndisplacement = [\"0\", \"0\"]\n{PRESSED}{}", method(16, 2)));
    for (poisson, solved) in [("0.4999999", true), ("0.499999999999999", false)] {
        let text = text.replace("poisson = 0.3", &format!("poisson = {poisson}"));
        let scene = parse(&text, &[]).expect("a scene");
        let converged = adapt(&scene).is_ok_and(|r| r.converged());
        assert_eq!(converged, solved, "{poisson}");
    }
    // far from the origin the body has no shape left
    let far = square("[[1e12, 0], [1000000000001, 0], [1000000000001, 1], [1e12, 1]]", PRESSED);
    assert!(parse(&far, &[]).is_err());
}

/// The gap of a node that is held along x on a sloping floor is told without what the held displacement does.
#[test]
fn gaps_are_told_as_they_are_where_a_component_is_held() {
    let sides = "[sides.floor]\ncontact = { gap = \"0.02\", friction = { tresca = \"0.1\" } }\n\
                 [sides.right]\ndisplacement = [\"-0.01\", \"free\"]\n";
    let sloped = "[[0, 0], [1, -0.5], [1, 1], [0, 1]]";
    for (elements, degree) in [(8, 1), (4, 3)] {
        let scene =
            parse(&square(sloped, &format!("{sides}{PRESSED}{}", method(elements, degree))), &[]).expect("a scene");
        let rows = answer(&scene).rows;
        assert!(rows.iter().any(|row| row.point == [1.0, -0.5]), "the end is held along x alone");
        for row in rows {
            assert!((row.gap - 0.02).abs() < 1e-14 && row.normal_displacement < 0.02 + 1e-12, "{row:?}");
        }
    }
}

//! Every mistake in a scene is answered with the file, the line, the text that is meant and a remedy.

use std::path::Path;

use crate::broken::{SOUND, cases};
use proptest::prelude::*;
use steklov_document::{Document, SceneErrorKind, TEMPLATE};
use steklov_problem::{
    Condition, Contact, DataErrorKind, Expectation, Friction, Method, Model, Refine, Scene, Solver, Units,
};

fn parse(text: &str, overrides: &[&str]) -> Result<Scene, steklov_document::SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    steklov_document::parse(text, "broken.toml", &overrides)
}

fn sound(text: &str, overrides: &[&str]) -> Scene {
    parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

#[test]
fn every_mistake_is_named_with_its_line_and_remedy() {
    let mut wrong = String::new();
    for case in cases() {
        let text = case.scene();
        let Err(error) = parse(&text, case.set) else {
            wrong += &format!("accepted: {:?} {:?}\n", case.edit.1, case.set);
            continue;
        };
        let shown = error.render();
        let file = if case.set.is_empty() { "broken.toml" } else { "--set" };
        let line = if case.set.is_empty() { text.lines().nth(case.line - 1) } else { case.set.last().copied() };
        for (what, there) in [
            ("file and line", shown.contains(&format!("{file}:{}:", case.line))),
            ("line", error.line() == Some(case.line) && error.file() == file),
            ("line's text", shown.contains(line.unwrap_or("?"))),
            ("offending text", error.offending().starts_with(case.offending)),
            ("message", error.message.contains(case.message) && shown.contains(&error.message)),
            ("remedy", error.help.contains(case.remedy) && shown.contains(&error.help)),
        ] {
            if !there {
                wrong += &format!(
                    "{what} wrong for {:?} {:?}: offending {:?}\n{shown}\n",
                    case.edit.1,
                    case.set,
                    error.offending()
                );
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_sound_scene_and_the_template_are_read() {
    let scene = sound(SOUND, &[]);
    assert_eq!((scene.title.as_str(), scene.problem.outline.side_names().len()), ("Sound", 4));
    assert_eq!(scene.probe, [[1.0, 0.5]]);
    assert_eq!(scene.method.refine, Refine::UniformH);
    let names: Vec<&str> = scene.problem.sides.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["floor", "right", "top", "left"]);
    let Some(Contact { gap, friction: Friction::Tresca(bound) }) = scene.contact(0) else { panic!() };
    assert_eq!((gap.constant(), bound.constant()), (Some(0.0), Some(0.3)));
    assert!(matches!(scene.problem.sides[1].condition, Condition::Free));
    let template = sound(TEMPLATE, &[]);
    assert_eq!(template.method, Method::default());
    // Every line that is commented out is a line that can be used.
    let all: String = TEMPLATE
        .lines()
        .map(|l| match l.strip_prefix('#') {
            Some(rest) if !rest.starts_with(' ') => format!("{rest}\n"),
            _ => format!("{l}\n"),
        })
        .collect();
    let all = sound(&all, &[]);
    let named = Units { length: Some("mm".into()), stress: Some("N/mm²".into()) };
    assert_eq!((&all.units, template.units), (&named, Units::default()));
    assert_eq!((all.expect.len(), all.probe.len(), all.problem.outline.loops().len()), (1, 1, 2));
    assert_eq!((all.probe_lines.len(), all.probe_lines[0].points, all.probe_sides.len()), (1, 101, 1));
    let default = Method::default();
    let [tolerance, elements, max_dofs] = [default.tolerance(), default.elements() as f64, default.max_dofs() as f64];
    let given = |value: Option<usize>| value.map(|v| v as f64);
    let of = |m: &Method| [m.tolerance, given(m.elements), given(m.max_dofs)];
    assert_eq!(of(&all.method), [tolerance, elements, max_dofs].map(Some));
    assert_eq!(Method { tolerance: None, elements: None, max_dofs: None, ..all.method }, default);
    assert_eq!((all.body().grid.map(|g| g.cells()), all.model()), (Some([32, 32]), Model::Bem));
    // The moduli of cells, in place of the one modulus.
    let edits = [
        ("# cells = ", "cells = "),
        ("young = 200.0", "#"),
        ("#[grid]", "[grid]"),
        ("#coarse", "coarse"),
        ("#fine", "fine"),
    ];
    let cells = sound(&edits.iter().fold(TEMPLATE.to_owned(), |text, (from, to)| text.replacen(from, to, 1)), &[]);
    assert_eq!((cells.body().cells().is_some(), cells.model()), (true, Model::Msfem));
}

#[test]
fn defaults_are_those_of_the_contract() {
    let text = "[body]\ncorners = [[0,0],[1,0],[0,1]]\nsides = [\"a\",\"a\",\"b\"]\n[material]\nyoung = \"2*100\"\npoisson = 0.3\n[sides.a]\npressure = 1\n";
    let scene = sound(text, &[]);
    let m = scene.method;
    assert_eq!(
        (m.tolerance(), m.elements(), m.degree, m.max_dofs(), m.max_steps, m.smoothness),
        (1e-3, 16, 1, 20_000, 60, 0.6)
    );
    assert_eq!((m.refine, m.marking, m.gamma, m.solver), (Refine::Hp, None, None, Solver::Auto));
    assert_eq!(
        (scene.body().material().young, scene.title.as_str(), scene.problem.sides.len()),
        (200.0, "broken.toml", 2)
    );
    assert!(scene.body().force.is_none() && scene.probe.is_empty() && scene.expect.is_empty());
}

/// A name that data use by way of other parameters has an effect; a name of the file without one is left out of the plan's model.
#[test]
fn names_that_nothing_uses_are_told() {
    let text = SOUND.replace("F = 0.3", "twice = 2\nG = \"0.1*twice\"\nF = \"G + 0.1\"\nidle = \"F\"");
    let scene = sound(&text, &["parameters.twice=3"]);
    assert!((scene.parameters["F"] - 0.4).abs() < 1e-15);
    assert_eq!(scene.unused, ["idle"]);
    let plan = steklov_plan::plan(&scene);
    let told = |name: &str| plan.left_out.iter().any(|d| d.what == "parameter" && d.choice == name);
    assert_eq!(["twice", "G", "F", "idle"].map(told), [false, false, false, true]);
}

/// Friction that is given as 0 is none, and cells of one modulus do not differ.
#[test]
fn plans_say_what_zero_friction_and_equal_cells_are() {
    let choice = |scene: &Scene, what: &str| {
        let plan = steklov_plan::plan(scene);
        let found = plan.modelled.iter().find(|d| d.what == what).unwrap_or_else(|| panic!("no {what}"));
        format!("{} ({})", found.choice, found.why)
    };
    for (law, without) in [("tresca = 0.0", true), ("coulomb = \"F - 0.3\"", true), ("coulomb = \"F*x\"", false)] {
        let scene = sound(&SOUND.replace("tresca = \"F\"", law), &[]);
        assert_eq!(choice(&scene, "contact").starts_with("floor without friction"), without, "{law}");
    }
    for (young, one) in [("\"3*F\"", true), ("{ uniform = [3, 3] }", true), ("\"1 + x\"", false)] {
        let cells = format!("cells = {{ size = 0.5, young = {young} }}");
        let text = SOUND.replace("young = 200.0", &cells).replace("refine = \"uniform-h\"\n", "");
        let scene = sound(&(text + "[grid]\ncoarse = [2, 1]\nfine = [2, 2]\n"), &[]);
        // cells that do not differ are one material
        assert_eq!(scene.is_on_grid(), !one, "{young}");
        assert!(one || choice(&scene, "discretisation").contains("differs from cell to cell"), "{young}");
    }
}

#[test]
fn overrides_change_any_key() {
    let hole = "[[body.holes]]\ncorners = [[0.5, 0.5], [0.6, 0.5], [0.6, 0.6]]\nsides = [\"h\", \"h\", \"h\"]\n";
    let scene = sound(
        &(SOUND.to_owned() + hole),
        &[
            "method.tolerance=1e-6",
            "method.refine=\"none\"",
            "parameters.F = 2",
            "body.holes.0.corners.2=[0.7, 0.6]",
            "sides.\"right\".pressure=\"F\"",
            "sides.top={ displacement = [0, \"free\"] }",
            "body_force.value=[0, \"-9.81*F\"]",
            "expect.\"contact.force.y\".value=3",
            "expect.\"contact.force.y\".tol=1e-3",
            "expect.audit.friction={ value = 0, tol = 1, source = \"none\" }",
        ],
    );
    assert_eq!((scene.method.tolerance(), scene.method.refine), (1e-6, Refine::None));
    assert_eq!(scene.problem.outline.edges()[5].listed(), [[0.6, 0.5], [0.7, 0.6]]);
    assert!(matches!(&scene.problem.sides[1].condition, Condition::Pressure(p) if p.constant() == Some(2.0)));
    let Condition::Displacement { values: [Some(u), None], traction: None } = &scene.problem.sides[2].condition else {
        panic!()
    };
    assert_eq!(u.constant(), Some(0.0));
    assert_eq!(scene.body().constant_force(), Some([0.0, -9.81 * 2.0]));
    let expected =
        |path: &str, value, tol, source: &str| Expectation { path: path.into(), value, tol, source: source.into() };
    assert_eq!(
        scene.expect,
        [expected("contact.force.y", 3.0, 1e-3, ""), expected("audit.friction", 0.0, 1.0, "none")]
    );
}

#[test]
fn a_model_that_does_not_fit_is_refused_only_after_all_other_checks() {
    let text = format!("{SOUND}[exterior]\nyoung = 50\npoisson = 0.3\n");
    assert_eq!(parse(&text, &[]).unwrap_err().kind, SceneErrorKind::Data(DataErrorKind::Conflict));
    let negative = text.replace("tresca = \"F\"", "tresca = \"F-1\"");
    assert_eq!(parse(&negative, &[]).unwrap_err().kind, SceneErrorKind::Data(DataErrorKind::Data));
    let both = parse(&text, &["method.elements=0"]).unwrap_err();
    assert_eq!(both.kind, SceneErrorKind::Data(DataErrorKind::Value));
}

/// The scene with a random variable and a random field, both used.
fn random_scene(bound: &str) -> String {
    let random = "[random.xi]\ndistribution = \"beta\"\nalpha = 2\nbeta = 2\nlow = 0.1\nhigh = 1\n\
                  [random.rough]\ncovariance = \"matern32\"\ncorrelation = [0.3, 0.1]\non = \"floor\"\nmodes = 6\n";
    SOUND.replace("tresca = \"F\"", &format!("tresca = \"{bound}\"")) + random
}

#[test]
fn random_names_are_germs_where_they_are_used() {
    let scene = parse(&random_scene("xi*exp(rough)"), &[]).unwrap();
    let random = scene.random.as_ref().unwrap();
    let labels: Vec<&str> = random.germs.iter().map(|g| g.label.as_str()).collect();
    assert_eq!(labels, ["xi", "rough 1", "rough 2", "rough 3", "rough 4", "rough 5", "rough 6"]);
    let uses = scene.uses(random);
    assert!(uses.contact && !uses.young && !uses.loads && !uses.held);
    // at xi = 0.7 and the germs 0 of the field the bound is 0.7; with the first germ 1 it is above, by the mode's positive start
    let bound = |germs: &[f64]| {
        let outcome = scene.outcome(germs).unwrap();
        outcome.contact(0).unwrap().friction.bound().unwrap().eval(0.0, 0.0, 0.0)
    };
    let mut germs = [0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(bound(&germs), 0.7);
    germs[1] = 1.0;
    let field = random.fields().next().unwrap().0;
    assert!((bound(&germs) - 0.7 * field.expansion.modes([0.0; 2])[0].exp()).abs() < 1e-15 && bound(&germs) > 0.7);
    // what is not used is left out
    let scene = parse(&random_scene("F"), &[]).unwrap();
    assert!(scene.random.is_none() && scene.unused == ["xi", "rough"]);
}

#[test]
fn impossible_outcomes_are_refused_before_anything_is_solved() {
    // xi reaches 1: 0.9 - xi is negative there, though not in its middle
    let error = parse(&random_scene("0.9-xi"), &[]).unwrap_err();
    assert_eq!(error.kind, SceneErrorKind::Data(DataErrorKind::Data));
    assert!(error.message.contains("-0.09999999999999998"), "{}", error.message);
    let error = parse(&random_scene("xi"), &["material.young=\"200*(0.9-xi)\""]).unwrap_err();
    assert!(error.message.starts_with("for xi = 1") && error.message.contains("modulus"), "{}", error.message);
    // each of two germs alone is possible, both at their ends are not
    let two = random_scene("0.2+0.15*a+0.15*b")
        + "[random.a]\ndistribution = \"uniform\"\nlow = -1\nhigh = 1\n[random.b]\ndistribution = \"uniform\"\nlow = -1\nhigh = 1\n";
    assert_eq!(parse(&two, &[]).unwrap_err().kind, SceneErrorKind::Data(DataErrorKind::Data));
    // a field lives on its side
    let elsewhere = random_scene("F").replace("\"-1\"]", "\"-rough\"]");
    let error = parse(&elsewhere, &[]).unwrap_err();
    assert_eq!(error.kind, SceneErrorKind::Data(DataErrorKind::Conflict));
    assert!(error.message.contains("the field rough of side \"floor\""), "{}", error.message);
    let error = parse(&random_scene("xi"), &["material.young=\"200+rough\""]).unwrap_err();
    assert!(error.message.contains("depends on the place"), "{}", error.message);
    let error = parse(&random_scene("xi"), &["material.poisson=\"0.3*xi\""]).unwrap_err();
    assert!(error.message.contains("depends on the random xi"), "{}", error.message);
    let error = parse(&random_scene("rough+2"), &["random.rough.modes=100000"]).unwrap_err();
    assert_eq!(error.kind, SceneErrorKind::Data(DataErrorKind::Value));
}

#[test]
fn files_that_cannot_be_read_are_named() {
    for path in ["no/such/scene.toml", env!("CARGO_MANIFEST_DIR")] {
        let error = steklov_document::read(Path::new(path), &[]).unwrap_err();
        assert_eq!((error.kind, error.line()), (SceneErrorKind::Read, None));
        assert!(error.render().contains(path) && error.help.contains("steklov new"));
    }
}

#[test]
fn a_value_at_a_quadrature_point_is_judged_like_the_samples() {
    let text = SOUND.replace("\"-1\"", "\"1/(x-0.3)\"");
    let document = Document::parse(&text, "broken.toml", &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let scene = &document.scene;
    let Condition::Traction([_, load]) = &scene.problem.sides[2].condition else { panic!() };
    assert_eq!(scene.check_value("top", "traction", load, (1.3, 1.0, 0.5)).unwrap(), 1.0);
    let error = scene.check_value("top", "traction", load, (0.3, 1.0, 0.5)).unwrap_err();
    let error = document.error(error);
    assert_eq!(
        (error.kind, error.line(), error.offending()),
        (SceneErrorKind::Data(DataErrorKind::Data), Some(13), "\"1/(x-0.3)\"")
    );
}

/// Of a line of any length a part is shown, with the column that it has in the file.
#[test]
fn long_lines_are_shown_in_part() {
    for (points, outside) in [(3, 1), (60, 40), (40_000, 0), (40_000, 20_000), (40_000, 39_999)] {
        let point = |k: usize| if k == outside { "[8.0, 0.5]" } else { "[0.25, 0.5]" };
        let list = (0..points).map(point).collect::<Vec<_>>().join(", ");
        let line = format!("points = [{list}] # ausführlich");
        let (before, behind) = SOUND.split_once("[probe]\n").unwrap();
        let behind = behind.split_once('\n').unwrap().1;
        let text = format!("# {}\n{before}[probe]\n{line}\n{behind}", "ü".repeat(200));
        let Err(error) = parse(&text, &[]) else { panic!("a point outside") };
        let rendered = error.render();
        let longest = rendered.lines().map(|line| line.chars().count()).max().unwrap();
        let column = line.find("[8.0").unwrap() + 1;
        let of_line = 1 + text.lines().position(|other| other == line).unwrap();
        assert!(longest < 200, "{points}: {longest}");
        assert!(rendered.contains("(8, 0.5)") && rendered.contains("[8.0, 0.5]"), "{rendered}");
        assert!(rendered.contains(&format!("[broken.toml:{of_line}:{column}]")), "{rendered}");
    }
}

/// Columns count letters, not bytes.
#[test]
fn columns_are_those_of_an_editor() {
    let line = "sides = [\"flöör\", \"right\", \"top\", 5]";
    let text = SOUND.replace("sides = [\"floor\", \"right\", \"top\", \"left\"]", line);
    let Err(error) = parse(&text, &[]) else { panic!("a side that is a number") };
    let column = line.chars().position(|c| c == '5').unwrap() + 1;
    assert!(error.render().contains(&format!(":{column}]")), "{}", error.render());
}

proptest! {
    #[test]
    fn damaged_scenes_never_panic(at in 0..SOUND.len(), length in 0..20_usize, put in "\\PC{0,6}") {
        let end = (at + length).min(SOUND.len());
        if let Err(error) = parse(&(SOUND[..at].to_owned() + &put + &SOUND[end..]), &[]) {
            prop_assert!(error.render().contains("broken.toml") && !error.help.is_empty());
        }
    }

    #[test]
    fn no_override_panics(text in "\\PC*|(method|body|sides|[.=\"'\\[\\]{}0-9\n]){0,12}") {
        if let Err(error) = parse(SOUND, &[&text]) {
            prop_assert!(!error.render().is_empty());
        }
    }
}

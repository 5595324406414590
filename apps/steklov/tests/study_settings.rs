//! The command `study`: what a study sets in a scene, what the scene and the user set, and what is told and stored of it.

use crate::place::Place;
use serde_json::{Value, json};
use steklov_document::Document;
use steklov_problem::{DataError, DataErrorKind};

/// Settings of a short study of the block, and the first step of its strategy.
fn study(place: &Place, overrides: &[&str]) -> (Vec<String>, Value) {
    let arguments = ["study", "block.toml", "--strategies", "hp", "--repeat", "1", "--json", "--quiet", "--force"];
    let sets = overrides.iter().flat_map(|text| ["--set", text]);
    let o = place.run(arguments.into_iter().chain(sets)).demand(0).json();
    let settings: Vec<String> = serde_json::from_value(o["settings"].clone()).unwrap();
    let file = steklov_io::open(place.path("block-study/study.h5")).unwrap();
    assert_eq!(steklov_io::load_texts(&file, "overrides").unwrap(), settings);
    (settings, o["strategies"][0]["steps"][0].clone())
}

/// The study's settings win over the scene, the user's overrides win over the study, however their keys are written; what is
/// told in front of the overrides gives, read as overrides, the scene that was run.
#[test]
fn overrides_win_over_settings_which_win_over_the_scene() {
    let place = Place::new();
    let (elements, degree, max_dofs) = ("method.elements=16", "method.degree=1", "method.max_dofs=1100");
    for (overrides, own, first) in [
        (&["method.tolerance=0.1"][..], &[elements, degree, max_dofs][..], [16, 1]),
        (&["method . degree =2", " method.tolerance = 0.1"], &[elements, max_dofs], [16, 2]),
        (&["\"method\".'elements' = 12", "method.tolerance=0.1"], &[degree, max_dofs], [12, 1]),
        // a whole table decides all of its keys
        (&["method={tolerance=0.1, elements=20, degree=3}"], &[], [20, 3]),
        (&["method.max_dofs=1200", "method.tolerance=0.1", "title=\"method.degree=2\""], &[elements, degree], [16, 1]),
    ] {
        let (settings, step) = study(&place, overrides);
        assert_eq!(settings, [own, overrides].concat());
        assert_eq!([&step["elements"], &step["max_degree"]], first.map(|n| json!(n)).each_ref(), "{overrides:?}");
        let read = steklov_document::parse(crate::place::BLOCK, "block.toml", &settings).unwrap().method;
        assert_eq!([read.elements(), read.degree], first);
    }
}

#[test]
fn an_override_decides_its_key_and_what_is_in_it() {
    let overrides = ["method.elements=4".to_owned(), "sides.floor.\"contact\".gap = \"0\"".to_owned()];
    let document = Document::parse(crate::place::BLOCK, "block.toml", &overrides).unwrap();
    for setting in ["method.elements=1", "'method' . elements=1", "sides.floor.contact.gap=1"] {
        assert!(document.overrides(setting), "{setting}");
    }
    for setting in ["method.degree=1", "elements=1", "sides.floor.displacement=[0, 0]"] {
        assert!(!document.overrides(setting), "{setting}");
    }
}

/// Settings that a scene gets after it was read have places of their own, and leave those of overrides as they are.
#[test]
fn settings_and_overrides_keep_their_places() {
    let overrides = ["title=\"A\"".to_owned(), "sides.floor.contact.gap = \"x + 7\"".to_owned()];
    let mut document = Document::parse(crate::place::BLOCK, "block.toml", &overrides).unwrap();
    document.source.settings = vec!["method.degree=1".to_owned(), "method.tolerance=1e-3".to_owned()];
    let (_, gap) = document.scene.problem.side_data(0)[0];
    let of_gap = document.error(DataError::new(DataErrorKind::Data, gap.place, "", ""));
    assert_eq!((of_gap.file(), of_gap.offending()), ("--set", "\"x + 7\""));
    for (key, text) in [("degree", "1"), ("tolerance", "1e-3")] {
        let error = document.error(DataError::at(DataErrorKind::Value, &[vec!["method", key]], "", ""));
        assert_eq!((error.file(), error.offending()), ("--set", text));
    }
    let of_scene = document.error(DataError::at(DataErrorKind::Value, &[vec!["method", "elements"]], "", ""));
    assert_eq!((of_scene.file(), of_scene.offending()), ("block.toml", "8"));
}

/// A study whose limit a scene cannot keep ends with that limit, at the place where it is set, though the scene allows more; a
/// fault of an override is told at the override.
#[test]
fn conflicts_with_settings_are_told_at_their_places() {
    let place = Place::new();
    let corner = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / 600.0).sin_cos();
        format!("[{cos}, {sin}]")
    };
    let corners: Vec<String> = (0..600).map(corner).collect();
    let sides: Vec<&str> = (0..600).map(|k| if k < 300 { "\"held\"" } else { "\"pulled\"" }).collect();
    let text = format!(
        "[body]\ncorners = [{}]\nsides = [{}]\n[material]\nyoung = 1\npoisson = 0.3\n[sides.held]\ndisplacement = [0, 0]\n\
         [sides.pulled]\ntraction = [1, 0]\n[method]\nmax_dofs = 20000\n",
        corners.join(", "),
        sides.join(", ")
    );
    place.write("many.toml", text);
    let apart = ["sides.right.displacement=[1, 0]", "sides.top={displacement=[2, 3]}"];
    for (scene, overrides, parts) in [
        ("many.toml", &[][..], &["the first mesh has 1200 dofs, more than method.max_dofs = 1100", "--set:1:17"][..]),
        ("many.toml", &["method.max_dofs=100"], &["more than method.max_dofs = 100", "--set:1:17"]),
        ("block.toml", &apart, &["at different displacements x = 1 and 2", apart[1], "--set:1:26"]),
    ] {
        let arguments =
            ["study", scene, "--quiet"].into_iter().chain(overrides.iter().flat_map(|text| ["--set", text]));
        let ran = place.run(arguments).demand(1);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{parts:?}: {}", ran.err);
    }
    assert_eq!(place.names(), ["block.toml", "many.toml"]);
}

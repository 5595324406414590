//! The command `study --what coupling`: the errors of the reference file, bodies of any shape and unit, files that agree with
//! each other, refusals.

use std::sync::atomic::AtomicUsize;

use crate::place::{Place, names};
use serde_json::{Value, json};
use steklov_document::Source;
use steklov_problem::{Method, Scene};
use steklov_study::coupling::{
    CouplingStudy, Effectivity, OwnLoads, coarsest, conditioning, convergence, costs, effectivity, largest, levels,
    own_loads, pairs, pictures, report, settings, wrongs,
};
use steklov_study::{Setting, Watch};

const FILES: &str = "conditioning.csv conditioning.png conditioning.svg contrast.csv convergence.csv \
                     cost-entries.png cost-entries.svg cost-seconds.png cost-seconds.svg cost.csv coupling.h5 \
                     effectivity-cells.png effectivity-cells.svg effectivity-contrast.png effectivity-contrast.svg \
                     effectivity-terms.png effectivity-terms.svg effectivity.csv error-cells.png error-cells.svg \
                     error-dofs.png error-dofs.svg error-seconds.png error-seconds.svg own-effectivity.png \
                     own-effectivity.svg own-error-coarse.png own-error-coarse.svg own-error-fine.png \
                     own-error-fine.svg own-loads.csv own-parts.png own-parts.svg traction-cells.png \
                     traction-cells.svg wrong-signs.csv wrong-signs.png wrong-signs.svg";

/// The body of the reference file, elsewhere.
const SQUARE: &str = r#"title = "A square in a medium"
[body]
corners = [[3.0, -2.0], [4.0, -2.0], [4.0, -1.0], [3.0, -1.0]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 5.0
poisson = 0.3
[exterior]
young = 1.0
poisson = 0.25
displacement_jump = [0.01, 0]
remote_stress = [0.1, 0, 0]
[grid]
coarse = [4, 4]
fine = [2, 2]
[method]
model = "fem-bem"
"#;

/// An L with a hole, of random cells, in plane stress, in millimetres and pascals.
const FRAME: &str = r#"title = "A frame"
[body]
corners = [[0, 0], [400, 0], [400, 300], [200, 300], [200, 600], [0, 600]]
sides = ["bottom", "right", "step", "inner", "top", "left"]
holes = [{ corners = [[50, 150], [100, 150], [100, 250], [50, 250]], sides = ["a", "b", "c", "d"] }]
[material]
poisson = 0.2
plane = "stress"
cells = { size = 50, young = { uniform = [1e9, 3e9], seed = 3 } }
[exterior]
young = 1e9
poisson = 0.35
traction_jump = [1e3, 0]
[grid]
coarse = [8, 12]
fine = [2, 2]
[method]
model = "fem-bem"
"#;

fn parsed(scene: &str) -> Scene {
    steklov_document::parse(scene, "scene", &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[track_caller]
fn close(what: &str, got: f64, wanted: f64, tolerance: f64) {
    assert!((got - wanted).abs() <= tolerance * wanted.abs(), "{what}: {got} instead of {wanted}");
}

/// Errors of all forms, effectivities of the indicators and what wrong signs do are those of the reference file; the three-field
/// matrix is singular unless the rotation leaves, too.
#[test]
fn errors_and_effectivities_are_those_of_the_reference_file() {
    let all: Value =
        serde_json::from_str(include_str!("../../../crates/coupling/tests/data/transmission.json")).unwrap();
    let (data, run, tell) = (&all["transmission"], AtomicUsize::new(0), &mut |_: &str, _: &str| {});
    let tolerance = number(&data["tol_rel"]);
    let scene = parsed(SQUARE);
    let (pairs, levels) = (pairs(&scene).unwrap(), levels(&scene, 100_000, 128).unwrap());
    let convergence = convergence(&scene.problem.outline, &pairs, &levels, 1, &mut Watch::new(&run, tell));
    let indicators = effectivity(&scene.problem.outline, &pairs[..3], &levels, &mut Watch::new(&run, tell));
    assert!(convergence.failures.is_empty() && indicators.failures.is_empty());
    for (pair, name) in ["same", "stiff_in", "soft_in"].into_iter().enumerate() {
        let rows = &data[format!("manufactured_{name}")];
        for (form, key) in ["two", "two", "three"].into_iter().enumerate() {
            for (p, n) in convergence.of(pair, form).zip(["4", "8", "16"]) {
                let what = format!("{name} {key} {n}");
                assert_eq!(p.cells.map(|n| n.to_string()), [n, n]);
                close(&what, p.error, number(&rows[n][key]["energy"]), tolerance);
                close(&what, p.traction, number(&rows[n][key]["V"]), tolerance);
                close(&what, p.norm, number(&rows[n]["norm"]), tolerance);
            }
        }
        for (i, n) in indicators.of(pair, 0).zip([4, 8, 16]) {
            let wanted = &data["estimator"][format!("{name}_N{n}")];
            close(name, i.whole, number(&wanted["effectivity"]), tolerance);
            close(name, i.error, number(&wanted["err"]), tolerance);
            for (term, key) in ["vol", "jump", "traction", "ds"].into_iter().enumerate() {
                close(key, (i.terms[term] * i.error).powi(2), number(&wanted[key]), tolerance);
            }
            assert!(i.terms[4].is_nan() && (3.0..10.0).contains(&i.whole));
        }
        assert_eq!(indicators.of(pair, 1).filter(|i| i.terms[4] > 0.0 && (3.0..10.0).contains(&i.whole)).count(), 3);
    }
    let own: Vec<f64> = convergence.of(3, 0).map(|p| p.rate).collect();
    assert!(own[0].is_nan() && own[1..].iter().all(|r| (0.95..1.05).contains(r)), "{own:?}");
    // soft bodies are overestimated, stiff ones are not
    let contrasts: Vec<(f64, f64)> = indicators.over_contrast(0).map(|i| (i.contrast, i.whole)).collect();
    assert_eq!(contrasts.len(), 7);
    assert!(contrasts.iter().all(|(c, e)| *c < 0.05 || (3.0..10.0).contains(e)), "{contrasts:?}");
    assert!(contrasts[0].1 > 30.0, "{contrasts:?}");

    let conditions = conditioning(&scene.problem.outline, &pairs, &levels[..2], &mut Watch::new(&run, tell));
    assert_eq!(conditions.points.len(), 8);
    assert!(conditions.points.iter().all(|c| c.two < 1e-14 && c.three > 1e-4), "{conditions:?}");
    let wrongs = wrongs(&scene.problem.outline, &pairs[0], &levels, &mut Watch::new(&run, tell));
    let errors = |system: usize| wrongs.of(system).map(|w| w.error).collect::<Vec<f64>>();
    for (system, key) in [(0, "two"), (3, "three")] {
        for (error, n) in errors(system).into_iter().zip(["4", "8", "16"]) {
            close(key, error, number(&data["manufactured_same"][n][key]["energy"]), tolerance);
        }
    }
    for (system, least) in [(1, 10.0), (2, 0.39), (4, 0.165)] {
        assert!(errors(system).iter().all(|e| *e > least), "{system}: {:?}", errors(system));
    }
}

/// The solution is scaled to a body with a reentrant corner and a hole, and holes are loaded: all forms converge by order one.
#[test]
fn bodies_of_any_shape_and_unit_converge() {
    let scene = parsed(FRAME);
    assert_eq!(coarsest(&scene).unwrap(), [8, 12]);
    let (run, tell) = (AtomicUsize::new(0), &mut |_: &str, _: &str| {});
    let pairs = pairs(&scene).unwrap();
    let own = &pairs[3..];
    assert!((1.8e9..2.2e9).contains(&own[0].body.young) && own[0].medium.plane == own[0].body.plane);
    let levels = levels(&scene, 5000, usize::MAX).unwrap();
    let convergence = convergence(&scene.problem.outline, own, &levels, 1, &mut Watch::new(&run, tell));
    for form in 0..3 {
        let points: Vec<_> = convergence.of(0, form).collect();
        let rates: Vec<f64> = points.iter().map(|p| p.rate).collect();
        println!("{form} {rates:?} {:?}", points.iter().map(|p| p.traction_rate).collect::<Vec<_>>());
        assert_eq!(points.iter().map(|p| p.cells[0]).collect::<Vec<_>>(), [8, 16, 32]);
        assert!(rates[1..].iter().all(|r| (0.95..1.05).contains(r)), "{rates:?}");
        assert!(points[2].error < 0.05 * points[2].norm && points[2].traction_rate > 1.3);
    }
    // the same body in metres and gigapascals
    let metres = |n: &str| format!("{}", n.trim().parse::<f64>().unwrap() / 1000.0);
    let lists = FRAME.lines().map(|line| {
        let numbers = line.starts_with("corners") || line.starts_with("holes");
        let parts = line.split_inclusive(|c: char| "[], ".contains(c)).map(|part| {
            let (number, end) = part.split_at(part.trim_end_matches(|c: char| "[], ".contains(c)).len());
            if number.parse::<f64>().is_ok() { metres(number) + end } else { part.to_owned() }
        });
        if numbers {
            parts.collect()
        } else {
            line.replace("size = 50", "size = 0.05").replace("e9", "").replace("1e3", "1e-6")
        }
    });
    let other = parsed(&lists.collect::<Vec<String>>().join("\n"));
    let others = steklov_study::coupling::pairs(&other).unwrap();
    let condition = |scene: &Scene, pair, most: usize| {
        let levels = steklov_study::coupling::levels(scene, most, usize::MAX).unwrap();
        conditioning(&scene.problem.outline, pair, &levels, &mut Watch::new(&run, &mut |_, _| {})).points[0]
    };
    let (a, b) = (condition(&scene, own, 300), condition(&other, &others[3..], 300));
    assert_eq!((a.cells, b.cells), ([8, 12], [8, 12]));
    close("condition", a.three, b.three, 1e-6);
    assert!(a.two < 1e-14 && b.two < 1e-14 && a.three > 1e-4, "{a:?} {b:?}");
    let costs = costs(&scene.problem.outline, &own[0], &levels, 2, &mut Watch::new(&run, tell));
    assert!(costs.failures.is_empty() && costs.points.len() == 3, "{costs:?}");
    for c in &costs.points {
        let n = c.trace as f64;
        assert!(c.difference < 1e-10 && c.steklov < c.seconds[1].min(c.seconds[2]));
        // the triangle of S is part of any factor
        assert!(c.entries.iter().all(|e| *e > n * (n + 1.0) / 2.0 + 3.0 * c.dofs as f64), "{c:?}");
    }
}

/// A scene of the gallery.
fn scene(name: &str) -> Scene {
    let path = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    parsed(&std::fs::read_to_string(path).unwrap())
}

fn own(scene: &Scene, most_dofs: usize) -> OwnLoads {
    let (run, tell) = (AtomicUsize::new(0), &mut |_: &str, _: &str| {});
    let found = own_loads(scene, &levels(scene, most_dofs, 1100).unwrap(), &mut Watch::new(&run, tell));
    assert!(found.failures.is_empty(), "{:?}", found.failures);
    found
}

/// A jump that is a constant moves the body and strains nothing.
#[test]
fn a_body_at_rest_has_no_errors_of_its_own() {
    let scene = parsed(&SQUARE.replace("remote_stress = [0.1, 0, 0]\n", ""));
    assert!(own(&scene, 700).points.is_empty());
    assert!(!own(&parsed(SQUARE), 700).points.is_empty());
}

/// Random cells under a jump of tractions: the errors of the body against the fine coupling are those of an independent code.
#[test]
fn multiscale_errors_in_the_medium_are_those_of_the_reference_file() {
    let all: Value =
        serde_json::from_str(include_str!("../../../crates/coupling/tests/data/transmission.json")).unwrap();
    let data = &all["transmission"]["emsfem_het"];
    let scene = scene("41-random-cells-in-a-medium");
    let found = own(&scene, 9000);
    // two kinds of rows are over one grid only: nothing tells its own error
    assert!(found.of(1, 0).next().is_none() && found.points.iter().all(|p| p.total.is_nan()));
    let norm = number(&data["fine"]["interior_energy"]).sqrt() / found.norm;
    for (elements, key) in [(1, "q1"), (3, "b"), (4, "c")] {
        let points: Vec<_> = found.of(0, elements).collect();
        assert_eq!(points.iter().map(|p| p.coarse[0]).collect::<Vec<_>>(), [4, 8, 16, 32]);
        for p in points {
            let wanted = number(&data[format!("{key}_M{}", p.coarse[0])]["energy_err"]);
            close(key, p.errors[0] / norm, wanted, 1e-6);
            // the residuals of Theorem 5.6 lose no more than a third of the error, and exaggerate it by 4 at most
            assert!(elements == 1 || (0.66..4.0).contains(&p.effectivity()), "{p:?}");
            assert_eq!(p.residual.is_nan(), elements == 1);
        }
    }
}

/// Loads and jumps of the scene are those of a known solution: against the limit of fine grids the bilinear body has the errors that it has
/// against that, the finest one too. Halved cells halve them, ξ and φ gain more.
#[test]
fn bilinear_errors_are_those_against_the_known_solution() {
    let scene = scene("40-transmission");
    let found = own(&scene, 2500);
    let (run, tell) = (AtomicUsize::new(0), &mut |_: &str, _: &str| {});
    let levels = levels(&scene, 2500, 1100).unwrap();
    // the scene's materials are those of the first pair
    let pairs = pairs(&scene).unwrap();
    let known = convergence(&scene.problem.outline, &pairs[..1], &levels, 1, &mut Watch::new(&run, tell));
    let points: Vec<_> = found.of(1, 0).collect();
    assert_eq!(points.iter().map(|p| p.cells[0]).collect::<Vec<_>>(), [4, 8, 16, 32]);
    for (p, exact) in points.iter().zip(known.of(0, 0)) {
        // that of the finest grid is extrapolated alone
        let tolerance = if p.cells[0] == 32 { 0.03 } else { 0.01 };
        close("body", p.errors[0] * found.norm, exact.error, tolerance);
        assert!((2.0..6.0).contains(&p.effectivity()) && (p.total / p.error() - 1.0).abs() < 1e-12, "{p:?}");
        assert!(p.rate.is_nan() || (1.0..1.5).contains(&p.rate), "{p:?}");
    }
    let fall = |k: usize| points[1].errors[k] / points[2].errors[k];
    assert!((1.9..2.1).contains(&fall(0)) && (2.4..4.2).contains(&fall(1)) && (2.4..4.2).contains(&fall(2)));
    // on the same boundary elements multiscale errors and those of the fine grid are at right angles
    let fine = points[2].total;
    for p in found.of(0, 4) {
        close("right angles", p.total, p.error().hypot(fine), 0.05);
    }
}

/// The inclusion under remote tension: errors fall over H at one h; over h at one H they tend to a number.
#[test]
fn the_multiscale_part_falls_with_the_coarse_cells_only() {
    let found = own(&scene("42-stiff-inclusion-of-random-cells"), 9000);
    for elements in [3, 4] {
        let errors: Vec<f64> = found.of(0, elements).map(|p| p.error()).collect();
        assert_eq!(errors.len(), 4);
        assert!(errors.windows(2).all(|e| e[1] < 0.8 * e[0]), "{errors:?}");
    }
    let over_h: Vec<f64> = found.of(1, 3).map(|p| p.error()).collect();
    let steps: Vec<f64> = over_h.windows(2).map(|e| (e[1] - e[0]).abs()).collect();
    assert_eq!(over_h.len(), 3);
    assert!(steps[1] < 0.5 * steps[0] && steps[1] < 0.05 * over_h[2], "{over_h:?}");
    let bilinear: Vec<f64> = found.of(1, 0).map(|p| p.rate).skip(1).collect();
    // fine cells resolve the corners of moduli with the power of their singularities
    assert!(bilinear.len() == 3 && bilinear.iter().all(|r| (0.6..1.0).contains(r)), "{bilinear:?}");
}

#[test]
fn grids_double_and_the_largest_multiple_is_the_last() {
    let scene = parsed(SQUARE);
    assert_eq!(coarsest(&scene).unwrap(), [4, 4]);
    let all: Vec<usize> = levels(&scene, 2000, usize::MAX).unwrap().iter().map(|l| l.grid.cells[0]).collect();
    assert_eq!(all, [4, 8, 16]);
    assert_eq!(largest(&scene, 2000, 578).unwrap().unwrap().grid.cells, [28, 28]);
    assert!(largest(&scene, 700, 578).unwrap().is_none());
    assert_eq!(settings(&Method::default()), [Setting::MaxDofs(100_000)]);
    assert!(settings(&Method { max_dofs: Some(7), ..Method::default() }).is_empty());
}

/// Bit by bit the columns of HDF5 are those of the JSON object, and they say what they mean.
fn check(group: &steklov_io::Group, rows: &Value) {
    let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 0 } else { (x + 0.0).to_bits() }).collect::<Vec<_>>();
    for name in rows[0].as_object().unwrap().keys() {
        let column: Vec<f64> = rows.as_array().unwrap().iter().map(|r| number(&r[name])).collect();
        assert_eq!(bits(&column), bits(&steklov_io::load_vector(group, name).unwrap()), "{name}");
        assert!(!steklov_io::load_label(group, name).unwrap().meaning.is_empty());
    }
}

#[test]
fn files_agree() {
    let place = Place::new();
    place.write("scene.toml", SQUARE);
    let all = ["study", "scene.toml", "--what", "coupling", "--repeat", "1", "--out", "out"];
    let out = place.run(all.iter().chain(&["--set", "method.max_dofs=400"])).demand(0).out;
    let file = steklov_io::open(place.path("out/coupling.h5")).unwrap();
    let o: Value = serde_json::from_str(&steklov_io::load_text(&file, "summary").unwrap()).unwrap();
    assert_eq!((&o["complete"], &o["interrupted"], &o["failures"]), (&json!(true), &json!(false), &json!([])));
    assert_eq!(names(&place.path("out")).join(" "), FILES);
    for name in FILES.split_whitespace().filter(|n| n.ends_with("png") || n.ends_with("svg")) {
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("out/{name}")).starts_with(start), "{name}");
    }
    let csv = |name: &str| String::from_utf8(place.read(&format!("out/{name}"))).unwrap();
    let groups = [("effectivity", 16), ("contrast", 14), ("cost", 3), ("conditioning", 8), ("wrong_signs", 10)];
    for (group, count) in groups {
        let rows = &o[group];
        assert_eq!(rows.as_array().unwrap().len(), count, "{group}");
        check(&file.group(group).unwrap(), rows);
        assert_eq!(csv(&format!("{}.csv", group.replace('_', "-"))).lines().count(), 1 + count);
    }
    assert_eq!(csv("convergence.csv").lines().count(), 1 + 3 * 4 * 2);
    let own = &o["own_loads"];
    check(&file.group("own_loads").unwrap(), &own["points"]);
    assert_eq!(csv("own-loads.csv").lines().count(), 1 + own["points"].as_array().unwrap().len());
    assert!(number(&own["norm"]) > 0.0 && out.contains("the scene's own moduli and loads"));
    for (k, form) in o["forms"].as_array().unwrap().iter().enumerate() {
        check(&file.group(&format!("forms/{k:03}")).unwrap(), &form["points"]);
        let first = number(&form["points"][0]["error"]);
        assert!(csv("convergence.csv").contains(&format!("{},0,4,4,50,32,{first:?},", form["name"].as_str().unwrap())));
        assert!(out.contains(&format!("{first:.5}")), "{out}");
    }
    assert_eq!(steklov_io::load_vector(&file.group("pairs").unwrap(), "body_young").unwrap(), [2.0, 20.0, 1.0, 5.0]);
    for part in ["A square in a medium", "scene (5, 0.3 | 1, 0.25)", "12x12", "t = +S u", "38 in out"] {
        assert!(out.contains(part), "no {part} in\n{out}");
    }
}

/// After a wish to stop there is what there is, and it can be told and drawn.
#[test]
fn interruptions_keep_what_is_finished() {
    let scene = parsed(SQUARE);
    let (go, stopped, tell) = (AtomicUsize::new(0), AtomicUsize::new(1), &mut |_: &str, _: &str| {});
    let (pairs, levels, polygon) = (pairs(&scene).unwrap(), levels(&scene, 200, 200).unwrap(), &scene.problem.outline);
    let convergence = convergence(polygon, &pairs, &levels, 1, &mut Watch::new(&go, tell));
    let effectivity = effectivity(polygon, &pairs, &levels, &mut Watch::new(&stopped, tell));
    let costs = costs(polygon, &pairs[3], &levels, 1, &mut Watch::new(&stopped, tell));
    let conditioning = conditioning(polygon, &pairs, &levels, &mut Watch::new(&stopped, tell));
    let wrongs = wrongs(polygon, &pairs[0], &levels, &mut Watch::new(&stopped, tell));
    let own_loads = own_loads(&scene, &levels, &mut Watch::new(&stopped, tell));
    assert_eq!((own_loads.points.len(), own_loads.failures.len()), (0, 0));
    let Effectivity { grids, contrasts, .. } = &effectivity;
    assert!(grids.is_empty() && contrasts.is_empty() && costs.points.is_empty());
    assert!(conditioning.points.is_empty() && wrongs.points.is_empty() && convergence.points.len() == 24);
    let study = CouplingStudy {
        scene: &scene,
        source: &Source::default(),
        pairs,
        convergence,
        effectivity,
        costs,
        conditioning,
        wrongs,
        own_loads,
        repeat: 1,
        interrupted: true,
    };
    assert!(!study.complete() && report(&study).text().contains("interrupted: what was finished is here"));
    assert_eq!(report(&study).json()["interrupted"], json!(true));
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(pictures(&study, folder.path()).unwrap().len(), 8);
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let place = Place::new();
    std::fs::create_dir(place.path("full")).unwrap();
    place.write("full/old", "old");
    place.write("scene.toml", SQUARE);
    let whole = SQUARE.replace(
        "[exterior]\nyoung = 1.0\npoisson = 0.25\ndisplacement_jump = [0.01, 0]\nremote_stress = [0.1, 0, 0]",
        "[sides.top]\npressure = 1",
    );
    place.write("alone.toml", whole.replace("fem-bem", "fem"));
    let before = place.names();
    for (scene, arguments, parts) in [
        ("block.toml", &[][..], &["block.toml", "the scene does not have both", "[exterior] with young"][..]),
        ("alone.toml", &[], &["alone.toml", "the scene does not have both"]),
        ("scene.toml", &["--strategies", "h"], &["--strategies belongs to --what convergence"]),
        ("scene.toml", &["--multipliers", "stabilised"], &["--multipliers belongs to --what convergence"]),
        ("scene.toml", &["--beside", "none.json"], &["--beside belongs to --what stability"]),
        ("scene.toml", &["--out", "full"], &["full exists", "--force"]),
        (
            "scene.toml",
            &["--set", "method.max_dofs=40"],
            &["has 4 by 4 cells, more than 40 dofs", "raise method.max_dofs"],
        ),
    ] {
        let ran = place.run(["study", scene, "--what", "coupling", "--quiet"].iter().chain(arguments)).demand(1);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{parts:?}: {}", ran.err);
    }
    assert_eq!(place.names(), before);
}

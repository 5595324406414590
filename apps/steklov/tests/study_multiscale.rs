//! The command `study --what multiscale`: the errors of the reference file, files that agree with each other, refusals.

use std::sync::atomic::AtomicUsize;

use crate::place::{Place, names};
use serde_json::{Value, json};
use steklov_document::Source;
use steklov_study::Watch;
use steklov_study::multiscale::{
    Contrast, Laminates, MultiscaleStudy, coarse_cells, contrast, convergence, fine_grid, laminates, pictures, report,
};

const FILES: &str = "contrast-effectivity.png contrast-effectivity.svg contrast-error.png contrast-error.svg \
                     contrast.csv convergence.csv effectivity.png effectivity.svg error-dofs.png error-dofs.svg \
                     error-seconds.png error-seconds.svg error-size.png error-size.svg fine-grid.csv laminates.csv \
                     multiscale.h5 rates.csv resonance-cells-displacement.png resonance-cells-displacement.svg \
                     resonance-cells-effectivity.png resonance-cells-effectivity.svg resonance-cells.png \
                     resonance-cells.svg resonance-period-displacement.png resonance-period-displacement.svg \
                     resonance-period-effectivity.png resonance-period-effectivity.svg resonance-period.png \
                     resonance-period.svg";

/// The bar of the reference file.
const BAR: &str = r#"title = "A bar of random cells"
[body]
corners = [[0.0, 0.0], [6.0, 0.0], [6.0, 1.0], [0.0, 1.0]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.03125, young = { uniform = [2000, 3000], seed = 2014 } }
[sides.left]
displacement = [0, 0]
[sides.right]
traction = [0, -1]
[grid]
coarse = [12, 2]
fine = [16, 16]
"#;

/// The bar of 24 × 4 cells.
const SMALL: [&str; 4] = ["--set", "grid.fine=[2, 2]", "--set", "material.cells.size=0.25"];

/// A part of the reference file.
fn reference(key: &str) -> Value {
    let all: Value = serde_json::from_str(include_str!("../../../crates/msfem/tests/data/multiscale.json")).unwrap();
    all[key].clone()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[track_caller]
fn close(what: &str, got: f64, wanted: f64, tolerance: f64) {
    assert!((got - wanted).abs() <= tolerance * wanted.abs(), "{what}: {got} instead of {wanted}");
}

/// The parts of the study that are about the scene: the JSON object and the table.
fn of_scene(scene: &str, overrides: &[&str]) -> (Value, String) {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let scene = steklov_document::parse(scene, "scene", &overrides).unwrap_or_else(|e| panic!("{}", e.render()));
    let (run, tell) = (AtomicUsize::new(0), &mut |_: &str, _: &str| {});
    let fine = fine_grid(&scene, 1, &mut Watch::new(&run, tell)).unwrap();
    let convergence = convergence(&scene, &fine, &coarse_cells(&scene).unwrap(), 1, &mut Watch::new(&run, tell));
    let (laminates, contrast) = (Laminates::default(), Contrast::default());
    let study = MultiscaleStudy {
        scene: &scene,
        source: &Source::default(),
        fine_grid: fine,
        convergence,
        laminates,
        contrast,
        repeat: 1,
        interrupted: false,
    };
    (report(&study).json(), report(&study).text())
}

/// Errors, effectivities, unknowns and local problems of all bases are those of the reference file; with the fine grid's own error
/// they are the differences of the work of the load from its limit, and that error is 6 %, and 3 % on halved cells.
#[test]
fn the_bar_has_the_published_errors_and_the_fine_grid_its_own() {
    let (o, out) = of_scene(BAR, &[]);
    assert_eq!((&o["complete"], &o["interrupted"], &o["failures"]), (&json!(true), &json!(false), &json!([])));
    let data = reference("bar");
    let (tolerance, of_estimates) = (number(&data["tol_rel"]), number(&data["tol_estimator_rel"]));
    let levels = o["fine_grid"]["levels"].as_array().unwrap();
    let work: Vec<f64> = levels.iter().map(|l| -2.0 * number(&l["energy"])).collect();
    for (work, name) in work.iter().zip(["h=1/32", "h=1/64", "h=1/128"]) {
        close(name, *work, number(&data["rand_refined_fine_compliance"][name]), tolerance);
    }
    let (error, halved) = (number(&levels[0]["error"]), number(&levels[1]["error"]));
    assert!((error - 0.06).abs() < 0.001 && (halved - 0.03).abs() < 0.004, "{error} {halved}");
    assert_eq!(number(&o["fine_grid"]["error"]), error);
    // differences of works from their limit fall by one factor
    let limit = -2.0 * number(&o["fine_grid"]["limit"]);
    close("factor", (limit - work[0]) / (limit - work[1]), (limit - work[1]) / (limit - work[2]), 1e-6);

    for (name, word) in [("q1", "q1"), ("linear", "a"), ("coupled", "b"), ("oscillatory", "c"), ("oversampled", "d")] {
        let points = called(&o["bases"], name)["points"].as_array().unwrap();
        assert_eq!(points.len(), 4);
        for (p, mesh) in points.iter().zip(["12x2", "24x4", "48x8", "96x16"]) {
            let wanted = &data["rand"][format!("{word}_{mesh}")];
            let what = format!("{name} {mesh}");
            assert_eq!(format!("{}x{}", p["coarse_x"], p["coarse_y"]), mesh);
            close(&what, number(&p["error"]), number(&wanted["energy_err"]), tolerance);
            // the file has the root of the sum over nodes: the integral of such fields is within two percent of it
            let ratio = number(&p["displacement_error"]) / number(&wanted["l2_err"]);
            assert!((0.98..1.02).contains(&ratio), "{what}: L2 over nodal {ratio}");
            assert_eq!((&p["patterns"], &p["dofs"]), (&wanted["n_local_solves"], &wanted["n_coarse"]), "{what}");
            if name == "oversampled" {
                assert_eq!((&p["estimate"], &p["effectivity"]), (&Value::Null, &Value::Null));
            } else {
                close(&what, number(&p["effectivity"]), number(&wanted["eff_nodal"]), of_estimates);
                let squared = (limit - number(&wanted["compliance"])) / work[0];
                close(&what, number(&p["total_error"]), squared.sqrt(), 1e-6);
            }
        }
    }
    for part in ["A bar of random cells", "192x32", "96x16", "0.0594", "oversampled", "extrapolated"] {
        assert!(out.contains(part), "no {part} in\n{out}");
    }
}

/// Cells below the scale of moduli that do not vary: q1 has the order of bilinear elements, one in the energy norm and two in the L²
/// norm but for the corners of the held side, whose exponent is about 0.71; no fitted basis is of a lower one.
#[test]
fn a_homogeneous_bar_has_the_orders_of_bilinear_elements() {
    let (o, out) = of_scene(&BAR.replace("{ uniform = [2000, 3000], seed = 2014 }", "2000"), &[]);
    let rates: Vec<&Value> = o["rates"].as_array().unwrap().iter().filter(|r| r["over"] == 0).collect();
    assert_eq!(rates.len(), 5);
    for rate in rates {
        let [energy, displacement] = ["rate", "displacement_rate"].map(|name| number(&rate[name]));
        println!("{rate}");
        assert!((0.8..1.1).contains(&energy), "{rate}");
        assert!((1.5..2.1).contains(&displacement) && displacement > energy + 0.5, "{rate}");
        assert!(number(&rate["r_squared"]) > 0.99 && number(&rate["displacement_r_squared"]) > 0.99, "{rate}");
        assert!(
            out.contains(&format!("error ~ H^{energy:.2} (R²"))
                && out.contains(&format!("L2 error ~ H^{displacement:.2}"))
        );
    }
}

fn called<'a>(list: &'a Value, name: &str) -> &'a Value {
    list.as_array().unwrap().iter().find(|o| o["name"] == name).unwrap_or_else(|| panic!("no {name} in {list}"))
}

fn column(rows: &Value, name: &str) -> Vec<f64> {
    rows.as_array().unwrap().iter().map(|r| number(&r[name])).collect()
}

/// Bit by bit the columns of HDF5 are those of the JSON object, and they say what they mean.
fn check(group: &steklov_io::Group, rows: &Value) {
    let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 0 } else { (x + 0.0).to_bits() }).collect::<Vec<_>>();
    for name in rows[0].as_object().unwrap().keys() {
        assert_eq!(bits(&column(rows, name)), bits(&steklov_io::load_vector(group, name).unwrap()), "{name}");
        assert!(!steklov_io::load_label(group, name).unwrap().meaning.is_empty());
    }
}

/// The fine grid is that of the scene's model "fem"; HDF5, CSV, JSON object and table tell the same.
#[test]
fn files_agree() {
    let place = Place::new();
    place.write("scene.toml", BAR);
    let all = ["study", "scene.toml", "--what", "multiscale", "--repeat", "1", "--out", "out"];
    let out = place.run(all.iter().chain(&SMALL)).demand(0).out;
    let file = steklov_io::open(place.path("out/multiscale.h5")).unwrap();
    let o: Value = serde_json::from_str(&steklov_io::load_text(&file, "summary").unwrap()).unwrap();
    assert_eq!((&o["complete"], &o["interrupted"], &o["failures"]), (&json!(true), &json!(false), &json!([])));
    assert_eq!(names(&place.path("out")).join(" "), FILES);
    for name in FILES.split_whitespace().filter(|n| n.ends_with("png") || n.ends_with("svg")) {
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("out/{name}")).starts_with(start), "{name}");
    }
    let csv = |name: &str| String::from_utf8(place.read(&format!("out/{name}"))).unwrap();
    let levels = &o["fine_grid"]["levels"];
    check(&file.group("fine_grid").unwrap(), levels);
    assert_eq!(csv("fine-grid.csv").lines().count(), 1 + levels.as_array().unwrap().len());
    for (k, basis) in o["bases"].as_array().unwrap().iter().enumerate() {
        check(&file.group(&format!("bases/{k:03}")).unwrap(), &basis["points"]);
        let table = csv("convergence.csv");
        let start = format!("{},", basis["name"].as_str().unwrap());
        let lines: Vec<&str> = table.lines().filter(|l| l.starts_with(&start)).collect();
        assert_eq!(lines.len(), 1, "{table}");
        let names = table.lines().next().unwrap().split(',').position(|name| name == "error").unwrap();
        let error = column(&basis["points"], "error")[0];
        assert_eq!(lines[0].split(',').nth(names).unwrap().parse::<f64>().unwrap().to_bits(), error.to_bits());
        assert!(out.contains(&format!("{error:.4}")), "{out}");
    }
    let solved = place.json(
        0,
        &[
            "scene.toml",
            "--set",
            "method.refine=\"none\"",
            "--set",
            "method.model=\"fem\"",
            SMALL[0],
            SMALL[1],
            SMALL[2],
            SMALL[3],
        ],
    );
    close("fine grid", column(levels, "energy")[0], number(&solved["energy"]), 1e-12);
    for (group, name, rows) in [
        ("laminates", "laminates.csv", &o["laminates"]),
        ("contrast", "contrast.csv", &o["contrast"]),
        ("rates", "rates.csv", &o["rates"]),
    ] {
        check(&file.group(group).unwrap(), rows);
        assert_eq!(csv(name).lines().count(), 1 + rows.as_array().unwrap().len());
    }
    assert!(out.contains("30 in out"), "{out}");
    laminates_resonate(&o["laminates"]);
    layers_vanish(&o["rates"]);
    stiff_parts_mislead(&o["contrast"]);
}

/// Errors are those of the reference file. The estimate of bases that conform is never below the error.
fn laminates_resonate(rows: &Value) {
    let data = reference("laminate");
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 2 * 8 * 3);
    for row in rows {
        let at = |name: &str, words: [&'static str; 3]| words[row[name].as_u64().unwrap() as usize];
        let (laminate, word) = (at("laminate", ["straight", "diagonal", ""]), at("basis", ["b", "c", "d"]));
        let key = format!("{laminate}_eps1/{}_H1/{}_{word}", row["periods"], row["coarse"]);
        close(&key, number(&row["error"]), number(&data["data"][&key]), number(&data["tol_rel"]));
        assert_eq!(row["estimate"].is_null(), word == "d");
        assert!(word == "d" || (1.0..6.0).contains(&number(&row["effectivity"])), "{row}");
        let displacement = number(&row["displacement_error"]);
        assert!(displacement > 0.0 && displacement < number(&row["error"]), "{row}");
    }
}

/// On coarse cells of one size the errors fall as layers become thin, in the L² norm faster; what C₁ H leaves keeps the rates below
/// those of (ε/H)^½ and ε/H. One grid of the scene has no rate over H.
fn layers_vanish(rates: &Value) {
    let rates = rates.as_array().unwrap();
    assert_eq!(rates.len(), 2 * 3);
    for rate in rates {
        let [energy, displacement] = ["rate", "displacement_rate"].map(|name| number(&rate[name]));
        println!("{rate}");
        assert!(rate["over"] != 0 && (0.05..0.5).contains(&energy) && (energy..1.0).contains(&displacement), "{rate}");
    }
}

/// Errors and effectivities are those of the reference file. Where stiff parts lie inside of coarse cells nothing fails and
/// nothing is said; across edges the estimates lose the error, which the warning tells from 10² on.
fn stiff_parts_mislead(rows: &Value) {
    let data = reference("high_contrast");
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 3 * 6 * 3);
    let of = |part: usize, contrast: f64, basis: usize| {
        let found =
            rows.iter().find(|r| r["part"] == part && number(&r["contrast"]) == contrast && r["basis"] == basis);
        found.unwrap_or_else(|| panic!("{part} {contrast} {basis}"))
    };
    for (part, name) in ["inside", "crossing", "channel"].into_iter().enumerate() {
        for (basis, word) in ["b", "c", "d8"].into_iter().enumerate() {
            let wanted = &data["data"][format!("stiff_{name}")][word]["energy_err"];
            close(name, number(&of(part, 1e4, basis)["error"]), number(wanted), number(&data["tol_rel"]));
        }
        for contrast in [1e1, 1e2, 1e3, 1e4, 1e5, 1e6] {
            let row = of(part, contrast, 0);
            assert_eq!(row["warned"] == 1, part > 0 && contrast >= 1e2, "{row}");
            let wanted = &data["estimator"][format!("{name}_{contrast}")];
            if wanted.is_object() {
                close(name, number(&row["error"]), number(&wanted["energy_err"]), 1e-6);
                close(name, number(&row["nodal"]), number(&wanted["eff_nodal"]), 1e-6);
                close(name, number(&row["jump"]), number(&wanted["eff_jump"]), 1e-6);
            }
        }
    }
    assert!(number(&of(0, 1e6, 0)["nodal"]) > 2.0 && number(&of(1, 1e6, 0)["nodal"]) < 0.1);
}

/// Contact with friction, another model, coarse cells that are not square: errors fall with the coarse cells.
#[test]
fn contact_and_other_models_are_studied() {
    let contact = BAR
        .replace("displacement = [0, 0]", "displacement = [0, \"free\"]")
        .replace("traction = [0, -1]", "traction = [-1, 0]")
        + "[sides.bottom]\ncontact = { gap = \"0\", friction = { tresca = \"0.1\" } }\n[sides.top]\npressure = 1\n\
           [method]\nmodel = \"fem\"\n";
    let sizes = ["grid.fine=[8, 4]", "material.cells.size=0.25", "grid.coarse=[6, 1]"];
    let (o, _) = of_scene(&contact, &sizes);
    assert_eq!((&o["complete"], &o["failures"]), (&json!(true), &json!([])));
    let errors = column(&called(&o["bases"], "coupled")["points"], "error");
    assert_eq!(column(&called(&o["bases"], "coupled")["points"], "fine_x"), [8.0, 4.0, 2.0]);
    assert!(errors.windows(2).all(|e| e[1] < e[0]) && errors[2] < 0.6 * errors[0], "{errors:?}");
}

/// After a wish to stop there is what there is, and it can be told and drawn.
#[test]
fn interruptions_keep_what_is_finished() {
    let scene = steklov_document::parse(BAR, "scene", &["grid.fine=[4, 4]".into(), "material.cells.size=0.125".into()])
        .unwrap();
    let (go, stopped, tell) = (AtomicUsize::new(0), AtomicUsize::new(1), &mut |_: &str, _: &str| {});
    assert!(fine_grid(&scene, 1, &mut Watch::new(&stopped, tell)).is_err());
    let fine = fine_grid(&scene, 1, &mut Watch::new(&go, tell)).unwrap();
    let sizes = coarse_cells(&scene).unwrap();
    assert_eq!(sizes, [[4, 4], [2, 2]]);
    let convergence = convergence(&scene, &fine, &sizes, 1, &mut Watch::new(&stopped, tell));
    let (laminates, contrast) = (laminates(&mut Watch::new(&stopped, tell)), contrast(&mut Watch::new(&stopped, tell)));
    assert!(convergence.points.is_empty() && laminates.points.is_empty() && contrast.points.is_empty());
    let study = MultiscaleStudy {
        scene: &scene,
        source: &Source::default(),
        fine_grid: fine,
        convergence,
        laminates,
        contrast,
        repeat: 1,
        interrupted: true,
    };
    assert!(!study.complete() && report(&study).text().contains("interrupted: what was finished is here"));
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(pictures(&study, folder.path()).unwrap().len(), 2);
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let place = Place::new();
    std::fs::create_dir(place.path("full")).unwrap();
    place.write("full/old", "old");
    place.write("scene.toml", BAR);
    let before = place.names();
    for (scene, arguments, parts) in [
        ("block.toml", &[][..], &["block.toml", "the scene has no [grid]", "add [grid] coarse"][..]),
        ("scene.toml", &["--strategies", "h"], &["--strategies belongs to --what convergence"]),
        ("scene.toml", &["--multipliers", "stabilised"], &["--multipliers belongs to --what convergence"]),
        ("scene.toml", &["--beside", "none.json"], &["--beside belongs to --what stability"]),
        ("scene.toml", &["--out", "full"], &["full exists", "--force"]),
        (
            "scene.toml",
            &["--set", "grid.coarse=[192, 32]", "--set", "grid.fine=[1, 1]"],
            &["coarse cells of more than one fine cell", "grid.fine is [1, 1]", "grid.fine = [8, 8]"],
        ),
        (
            "scene.toml",
            &["--set", "grid.fine=[160, 160]"],
            &["the fine grid has 1233282 dofs", "take fewer fine cells"],
        ),
    ] {
        let ran = place.run(["study", scene, "--what", "multiscale", "--quiet"].iter().chain(arguments)).demand(1);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{parts:?}: {}", ran.err);
    }
    assert_eq!(place.names(), before);
}

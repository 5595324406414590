//! The command `study --what stability`: energies of a closed form at every Poisson's ratio, signs of eigenvalues, files
//! that agree with each other, refusals.

use std::process::Stdio;
use std::sync::atomic::AtomicUsize;

use crate::place::{Place, Ran, names};
use serde_json::{Value, json};
use steklov_document::Source;
use steklov_study::Watch;
use steklov_study::stability::{
    Critical, Incompressible, POISSON, Point, SingleLayer, Stabilisation, Stability, Truth, WithGamma, incompressible,
    read_beside, report, stabilisation,
};

const FILES: &str = "incompressible-energy.png incompressible-energy.svg incompressible-error.png \
                     incompressible-error.svg incompressible.csv single-layer.csv single-layer.png single-layer.svg \
                     stabilisation-critical.csv stabilisation-degree.png stabilisation-degree.svg \
                     stabilisation-elements.png stabilisation-elements.svg stabilisation-error.png \
                     stabilisation-error.svg stabilisation-errors.csv stability.h5";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn array(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap_or_else(|| panic!("{value} is no array"))
}

/// Pure bending of a 4 by 1 plate by σ_xx = 20 y.
fn bending(plane: &str) -> String {
    format!(
        "title = \"Bending\"\n[body]\ncorners = [[0, -0.5], [4, -0.5], [4, 0.5], [0, 0.5]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\n[material]\nyoung = 200\npoisson = 0.1\nplane = \"{plane}\"\n\
         [sides.left]\ndisplacement = [0, \"free\"]\n[sides.right]\ntraction = [\"20*y\", 0]\n\
         [expect]\nenergy = {{ value = 7, tol = 1, source = \"of no use at another ratio\" }}\n"
    )
}

/// Relative rounding of J grows like 1/(1-2ν).
fn rounding(poisson: f64) -> f64 {
    1e-12 + 5e-15 / (1.0 - 2.0 * poisson)
}

/// The JSON object of the study of `scene.toml` with `beside.json`: of the command, or of the part about Poisson's ratios alone.
fn studied(place: &Place, by_command: bool) -> Value {
    if by_command {
        let arguments =
            ["study", "scene.toml", "--what=stability", "--json", "--quiet", "--force", "--beside=beside.json"];
        return place.run(arguments).demand(0).json();
    }
    let scene = steklov_document::read(&place.path("scene.toml"), &[]).unwrap();
    let study = Stability {
        scene: &scene,
        source: &Source::default(),
        incompressible: incompressible(&scene, &mut Watch::new(&AtomicUsize::new(0), &mut |_, _| {})).unwrap(),
        beside: read_beside(&place.path("beside.json")).unwrap(),
        single_layer: SingleLayer::default(),
        stabilisation: None,
        interrupted: false,
    };
    report(&study).json()
}

/// J = -20² L/(24 E'), E' = E/(1-ν²) in plane strain and E in plane stress; quadratic, so degree 2 is exact. Errors are by
/// their definitions, also those of the results beside.
#[test]
fn energies_of_pure_bending_at_every_ratio() {
    let place = Place::new();
    for plane in ["strain", "stress"] {
        place.write("scene.toml", bending(plane));
        let exact =
            POISSON.map(|nu| -20f64.powi(2) * 4.0 / 24.0 / 200.0 * if plane == "strain" { 1.0 - nu * nu } else { 1.0 });
        let beside: Vec<Value> = (0..POISSON.len())
            .flat_map(|k| {
                let at =
                    |name, factor: f64| json!({ "name": name, "poisson": POISSON[k], "energy": factor * exact[k] });
                [at("Q1", 0.91), at("Q2", 0.99)]
            })
            .collect();
        place.write("beside.json", json!(beside).to_string());
        let o = studied(&place, plane == "strain");
        assert_eq!(o["note"].is_null(), plane == "strain", "{}", o["note"]);
        assert!(o["stabilisation"].is_null(), "without contact");
        let all = &o["incompressible"];
        let truths = array(&all["references"]);
        assert_eq!(truths.len(), POISSON.len());
        for (k, truth) in truths.iter().enumerate() {
            let (nu, energy) = (number(&truth["poisson"]), number(&truth["energy"]));
            assert_eq!(nu, POISSON[k]);
            assert!((energy / exact[k] - 1.0).abs() < rounding(nu), "{plane} {nu}: {energy}");
        }
        let points = array(&all["points"]);
        assert_eq!(points.len(), 5 * POISSON.len());
        for point in points {
            let (nu, degree) = (number(&point["poisson"]), number(&point["degree"]));
            let exact = exact[POISSON.iter().position(|p| *p == nu).unwrap()];
            assert_eq!(number(&point["dofs"]), 2.0 * degree * number(&point["elements"]));
            let off = ((number(&point["energy"]) - exact) / exact).abs().sqrt();
            let rounding = rounding(nu).sqrt();
            assert!((number(&point["energy_error"]) - off).abs() < rounding, "{point}");
            match degree as usize {
                1 => assert!(number(&point["error"]) > 0.01 && off > 1e-3, "{point}"),
                _ => assert!(
                    point["error"].is_null() && off < rounding,
                    "an exact mesh has no error to measure: {point}"
                ),
            }
        }
        // linear elements lock no more than by a fifth
        let of = |elements: f64, nu: f64| {
            let found = points
                .iter()
                .find(|p| [number(&p["elements"]), number(&p["degree"]), number(&p["poisson"])] == [elements, 1.0, nu]);
            number(&found.unwrap()["error"])
        };
        for elements in [16.0, 64.0] {
            assert!(POISSON.iter().all(|nu| of(elements, *nu) < 1.2 * of(elements, 0.3)), "{plane} {elements}");
        }
        for (group, (name, error)) in array(&all["beside"]).iter().zip([("Q1", 0.3), ("Q2", 0.1)]) {
            assert_eq!(group["name"], name);
            assert!(
                array(&group["points"]).iter().all(|p| (number(&p["energy_error"]) - error).abs() < 1e-7),
                "{group}"
            );
        }
    }
}

/// The table of a CSV file by columns; empty cells are NaN.
fn columns(place: &Place, file: &str) -> Vec<(String, Vec<f64>)> {
    let text = String::from_utf8(place.read(file)).unwrap();
    let mut lines = text.lines();
    let names: Vec<String> = lines.next().unwrap().split(',').map(String::from).collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|l| l.split(',').map(|c| if c.is_empty() { f64::NAN } else { c.parse().unwrap() }).collect())
        .collect();
    names.into_iter().enumerate().map(|(k, name)| (name, rows.iter().map(|r| r[k]).collect())).collect()
}

/// HDF5, CSV, JSON object and table tell the same; the signs of eigenvalues are those that the degenerate sizes ask for.
#[test]
fn the_files_agree_and_eigenvalues_change_sign_at_degenerate_sizes() {
    let place = Place::new();
    let ran = place.run(["study", "block.toml", "--what", "stability"]).demand(0);
    let told: Vec<&str> = ran.err.lines().filter_map(|l| l.split_once(" s  ")).map(|(_, what)| what).collect();
    let ratios: Vec<String> = POISSON.iter().map(|nu| format!("ν = {nu}")).collect();
    let expected: Vec<&str> =
        ratios.iter().map(String::as_str).chain(["single layer", "stabilisation", "files"]).collect();
    assert_eq!(told, expected);
    assert_eq!(place.names(), ["block-stability", "block.toml"]);
    assert_eq!(names(&place.path("block-stability")).join(" "), FILES);
    for name in FILES.split_whitespace().filter(|n| n.ends_with("png") || n.ends_with("svg")) {
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("block-stability/{name}")).starts_with(start), "{name}");
    }

    let file = steklov_io::open(place.path("block-stability/stability.h5")).unwrap();
    let o: Value = serde_json::from_str(&steklov_io::load_text(&file, "summary").unwrap()).unwrap();
    assert_eq!((&o["complete"], &o["interrupted"], &o["note"]), (&json!(true), &json!(false), &Value::Null));
    for (table, group, object) in [
        ("incompressible.csv", "incompressible/points", &o["incompressible"]["points"]),
        ("single-layer.csv", "single_layer/points", &o["single_layer"]["points"]),
        ("stabilisation-critical.csv", "stabilisation/critical", &o["stabilisation"]["critical"]),
        ("stabilisation-errors.csv", "stabilisation/errors", &o["stabilisation"]["errors"]),
    ] {
        let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 0 } else { x.to_bits() }).collect::<Vec<_>>();
        for (name, values) in columns(&place, &format!("block-stability/{table}")) {
            let group = file.group(group).unwrap();
            assert_eq!(bits(&values), bits(&steklov_io::load_vector(&group, &name).unwrap()), "{table}: {name}");
            let told: Vec<f64> = array(object).iter().map(|r| r[&name].as_f64().unwrap_or(f64::NAN)).collect();
            assert_eq!(bits(&values), bits(&told), "{table}: {name}");
            assert!(!steklov_io::load_label(&group, &name).unwrap().meaning.is_empty());
        }
    }

    let layer = &o["single_layer"];
    let [first, second] = [0, 1].map(|k| number(&layer["degenerate"][k]));
    assert!(first < second && (number(&layer["diameter"]) - 5f64.sqrt()).abs() < 1e-15);
    let points = array(&layer["points"]);
    let own = number(&points[0]["smallest_diameter"]);
    let mut signs = [false; 3];
    for p in points {
        let d = number(&p["diameter"]);
        assert_eq!(number(&p["smallest_unit"]) > 0.0, d < first, "{p}");
        assert_eq!(number(&p["second_unit"]) > 0.0, d < second, "{p}");
        assert!(own > 0.0 && (number(&p["smallest_diameter"]) / own - 1.0).abs() < 1e-9, "{p}");
        signs[usize::from(d > first) + usize::from(d > second)] = true;
    }
    assert_eq!(signs, [true; 3], "sizes below, between and above");

    for part in [
        "A block",
        "method.tolerance=1e-3",
        "16 elements, p = 1",
        "V would be positive definite",
        "17 in block-stability",
    ] {
        assert!(ran.out.contains(part), "no {part} in\n{}", ran.out);
    }
    let last = array(&o["incompressible"]["points"]).last().unwrap();
    assert!(ran.out.contains(&format!("{:.2e}", number(&last["error"]))), "{}", ran.out);
}

/// A ratio without a reference or a mesh without a solution is told, and the study is not complete.
#[test]
fn failures_are_told_with_their_ratio() {
    let scene = steklov_document::parse(crate::place::BLOCK, "block.toml", &[]).unwrap();
    let truth = |poisson, failure: Option<&str>| {
        let energy = if failure.is_some() { f64::NAN } else { -1.0 };
        Truth { poisson, energy, estimate: 1e-5, dofs: 100, failure: failure.map(String::from) }
    };
    let point = |poisson, failure: Option<&str>| Point {
        poisson,
        elements: 16,
        degree: 1,
        dofs: 32,
        energy: -0.9,
        error: 0.1,
        energy_error: 0.3,
        failure: failure.map(String::from),
    };
    let of = |truths, points, interrupted| {
        let incompressible = Incompressible { truths, points };
        let study = Stability {
            scene: &scene,
            source: &Source::default(),
            incompressible,
            beside: Vec::new(),
            single_layer: SingleLayer::default(),
            stabilisation: None,
            interrupted,
        };
        (study.complete(), report(&study).text())
    };
    assert!(of(vec![truth(0.3, None)], vec![point(0.3, None)], false).0);
    let (complete, text) =
        of(vec![truth(0.3, None), truth(0.4, Some("no reference"))], vec![point(0.3, Some("no contact"))], true);
    assert!(
        !complete && text.contains("FAILED at ν = 0.4: no reference") && text.contains("FAILED at ν = 0.3: no contact")
    );
    assert!(text.contains("interrupted: what was finished is here"));
    assert!(!of(vec![truth(0.3, None)], vec![point(0.3, None)], true).0);
    assert!(text.contains("left out, no side is in contact"));
    let failed = Critical {
        elements: 16,
        degree: 2,
        dofs: 64,
        gamma: f64::NAN,
        gamma_young: f64::NAN,
        failure: Some("too large".into()),
    };
    let stabilisation = Stabilisation { critical: vec![failed], ..Default::default() };
    let study = Stability {
        scene: &scene,
        source: &Source::default(),
        incompressible: Incompressible::default(),
        beside: Vec::new(),
        single_layer: SingleLayer::default(),
        stabilisation: Some(stabilisation),
        interrupted: false,
    };
    let text = report(&study).text();
    assert!(
        !study.complete() && text.contains("FAILED at critical γ₀ on 16 elements of degree 2: too large"),
        "{text}"
    );
}

/// The critical γ₀ E of a clamped square as another code has it, in any unit of stress, and errors that grow near it.
#[test]
fn stabilised_multipliers_have_a_critical_gamma() {
    for young in [7.0, 7e4] {
        let text = format!(
            "[body]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
             [material]\nyoung = {young}\npoisson = 0.3\n\
             [sides.floor]\ncontact = {{ gap = \"abs(x-0.5)/10 - 0.05\", friction = {{ tresca = \"{}\" }} }}\n\
             [sides.top]\ndisplacement = [\"0\", \"0\"]\n[method]\ntolerance = 1e-3\nmax_dofs = 400\n",
            3e-4 * young
        );
        let sets = ["method.elements=16".into(), "method.degree=1".into()];
        let scene = steklov_document::parse(&text, "scene", &sets).unwrap();
        let all = stabilisation(&scene, &mut Watch::new(&AtomicUsize::new(0), &mut |_, _| {})).unwrap();
        assert!(all.complete());
        for (elements, degree, want) in [(32, 1, 0.644), (64, 1, 0.627), (32, 2, 0.99), (16, 4, 1.49), (16, 12, 1.95)] {
            let found = all.critical.iter().find(|c| (c.elements, c.degree) == (elements, degree)).unwrap();
            assert!((found.gamma_young / want - 1.0).abs() < 0.025, "{found:?}, not {want}");
            assert!((found.gamma * young / found.gamma_young - 1.0).abs() < 1e-15);
        }
        for (elements, degree) in all.meshes() {
            let of = |ratio: f64| {
                let at = |p: &&WithGamma| (p.elements, p.degree, p.ratio) == (elements, degree, ratio);
                all.errors.iter().find(at).unwrap().error
            };
            println!("{elements} {degree}: {:e} {:e} {:e}", of(1e-4), of(0.5), of(0.99));
            assert!(of(0.5) < 1.5 * of(1e-4) && of(0.99) > 1.1 * of(0.5), "{elements} {degree}");
        }
    }
    let free = steklov_document::parse(&bending("strain"), "scene", &[]).unwrap();
    assert_eq!(stabilisation(&free, &mut Watch::new(&AtomicUsize::new(0), &mut |_, _| {})), None);
}

#[test]
fn what_cannot_be_studied_is_refused_before_anything_is_solved() {
    let place = Place::new();
    std::fs::create_dir(place.path("full")).unwrap();
    place.write("full/old", "old");
    place.write("text.json", "Q1 0.3 -1");
    place.write("key.json", r#"[{ "name": "Q1", "poison": 0.3, "energy": -1 }]"#);
    place.write("ratio.json", r#"[{ "name": "Q1", "poisson": 0.31, "energy": -1 }]"#);
    place.write("lifted.toml", crate::place::BLOCK.replace("\"-1\"", "\"1\""));
    let before = place.names();
    for (scene, arguments, status, parts) in [
        ("block.toml", &["--beside", "none.json"][..], 1, &["none.json cannot be read"][..]),
        ("block.toml", &["--beside", "text.json"], 1, &["text.json is not a list", "line 1"]),
        ("block.toml", &["--beside", "key.json"], 1, &["key.json", "poison", "line 1"]),
        ("block.toml", &["--beside", "ratio.json"], 1, &["ratio.json", "Q1", "0.31", "0.4999999"]),
        ("block.toml", &["--strategies", "hp"], 1, &["--strategies belongs to --what convergence"]),
        ("block.toml", &["--out", "full"], 1, &["full exists", "--force"]),
        ("block.toml", &["--set", "material.poisson=0.5"], 1, &["poisson", "0.5"]),
        ("block.toml", &["--set", "method.max_dofs=8"], 1, &["max_dofs"]),
        ("lifted.toml", &[], 1, &["nothing holds the body"]),
    ] {
        let ran = place.run(["study", scene, "--what", "stability", "--quiet"].iter().chain(arguments)).demand(status);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{parts:?}: {}", ran.err);
    }
    let ran = place.run(["study", "block.toml", "--beside", "ratio.json"]).demand(1);
    assert!(ran.err.contains("--beside belongs to --what stability"), "{}", ran.err);
    assert_eq!(place.names(), before);
}

/// Ctrl-C: the ratios that are finished are stored, marked and drawn.
#[cfg(unix)]
#[test]
fn an_interrupted_study_stores_what_is_finished() {
    use std::io::{BufRead as _, BufReader};
    let place = Place::new();
    let arguments = ["study", "block.toml", "--what", "stability", "--json", "--set", "method.tolerance=1e-6"];
    let mut child = place.command().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(told.any(|line| line.ends_with("ν = 0.4")), "the second ratio does not begin");
    let id = child.id().to_string();
    let kill = std::process::Command::new("sh").args(["-c", "kill -INT \"$0\"", &id]).status().unwrap();
    assert!(kill.success() && told.any(|line| line == "finishing this step; again to stop at once"));
    let o = Ran::new(child.wait_with_output().unwrap()).demand(3).json();
    assert_eq!((&o["interrupted"], &o["complete"]), (&json!(true), &json!(false)));
    let done = array(&o["incompressible"]["references"]).len();
    assert!((1..POISSON.len()).contains(&done), "{done}");
    assert!(names(&place.path("block-stability")).contains(&"incompressible-error.png".to_owned()));
}

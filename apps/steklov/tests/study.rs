//! The command `study`: files that agree with each other, refusals, failures, multipliers.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicUsize;

use crate::place::{Place, Ran, names};
use serde_json::{Value, json};
use steklov_bem_operators::Mesh;
use steklov_document::Source;
use steklov_problem::Refine;
use steklov_study::Watch;
use steklov_study::convergence::{End, NAMES, Study, report, strategy};
use steklov_study::reference::Reference;

/// The strategy of a study's JSON object.
fn of<'a>(o: &'a Value, name: &str) -> &'a Value {
    o["strategies"].as_array().unwrap().iter().find(|s| s["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

const FILES: &str = "contact-floor.png contact-floor.svg effectivity.png effectivity.svg energy-dofs.png energy-dofs.svg \
                     energy-seconds.png energy-seconds.svg error-dofs.png error-dofs.svg error-root-dofs.png \
                     error-root-dofs.svg error-seconds.png error-seconds.svg meshes-h.png meshes-h.svg \
                     meshes-hp-decay.png meshes-hp-decay.svg meshes-hp.png meshes-hp.svg meshes-uniform-h.png \
                     meshes-uniform-h.svg meshes-uniform-p.png meshes-uniform-p.svg study.csv study.h5";

const NUMBERS: [&str; 10] = [
    "seconds",
    "error",
    "energy",
    "energy_error",
    "estimate",
    "effectivity",
    "energy_extrapolated",
    "energy_uncertainty",
    "residual",
    "residual_effectivity",
];

/// The rows of a CSV table by strategy, each by column; empty numbers are NaN.
fn rows(table: &str) -> BTreeMap<String, Vec<BTreeMap<String, f64>>> {
    let (head, body) = table.split_once('\n').unwrap();
    let names: Vec<&str> = head.split(',').collect();
    let mut rows: BTreeMap<String, Vec<BTreeMap<String, f64>>> = BTreeMap::new();
    for line in body.lines() {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        let number = |cell: &str| if cell.is_empty() { f64::NAN } else { cell.parse().unwrap_or(f64::INFINITY) };
        let row = names.iter().zip(&cells).skip(1).map(|(n, c)| ((*n).to_owned(), number(c))).collect();
        rows.entry(cells[0].to_owned()).or_default().push(row);
    }
    rows
}

/// Slope of the least squares line by Cramer's rule.
fn slope(points: &[[f64; 2]]) -> f64 {
    let sum = |f: fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>();
    let (n, x, y) = (points.len() as f64, sum(|p| p[0]), sum(|p| p[1]));
    (n * sum(|p| p[0] * p[1]) - x * y) / (n * sum(|p| p[0] * p[0]) - x * x)
}

/// HDF5, CSV, JSON object and table of one study tell the same, and what they tell fits together.
#[test]
fn the_files_of_a_study_agree() {
    let place = Place::new();
    let arguments = ["study", "block.toml", "--repeat", "2", "--quiet", "--set", "method.max_dofs=130"];
    let ran = place.run(arguments).demand(0);
    assert_eq!(ran.err, "", "quiet");
    assert_eq!(place.names(), ["block-study", "block.toml"]);
    assert_eq!(names(&place.path("block-study")).join(" "), FILES);
    for name in FILES.split_whitespace().filter(|n| n.ends_with("png") || n.ends_with("svg")) {
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("block-study/{name}")).starts_with(start), "{name}");
    }
    let file = steklov_io::open(place.path("block-study/study.h5")).unwrap();
    let o: Value = serde_json::from_str(&steklov_io::load_text(&file, "summary").unwrap()).unwrap();
    assert_eq!((&o["complete"], &o["interrupted"], &o["repeat"]), (&json!(true), &json!(false), &json!(2)));
    let table = rows(&String::from_utf8(place.read("block-study/study.csv")).unwrap());
    let wanted = NAMES.map(|(name, _)| name);
    assert_eq!(steklov_io::load_texts(&file, "strategy_names").unwrap(), wanted);
    assert_eq!(table.len(), wanted.len());
    let reference = file.group("reference").unwrap();
    let [energy, own] = ["energy", "own_energy"].map(|n| steklov_io::load_number(&reference, n).unwrap());
    assert_eq!(energy, own, "the scene expects nothing");
    for name in wanted {
        let (rows, group) = (&table[name], file.group(&format!("strategies/{name}")).unwrap());
        check_columns(name, rows, &group, of(&o, name));
        check_numbers(name, rows, energy);
        check_residuals(name, rows, &group, of(&o, name));
        check_fits(name, rows, of(&o, name));
        // the floor carries the load on the top
        let contact = group.group("contact").unwrap();
        let [pressure, weight] = ["pressure", "weight"].map(|n| steklov_io::load_vector(&contact, n).unwrap());
        let force: f64 = pressure.iter().zip(&weight).map(|(p, w)| p * w).sum();
        assert!((force - 2.0).abs() < 1e-10, "{name}: {force}");
        // what is printed
        let last = rows.last().unwrap();
        let dofs = format!("{}", last["dofs"]);
        let line =
            ran.out.lines().skip_while(|l| !l.starts_with(name)).find(|l| l.split_whitespace().any(|w| w == dofs));
        let estimate = format!("{:.2e}", last["estimate"]);
        assert!(line.is_some_and(|l| l.contains(&estimate)), "{name}: {dofs}, {estimate} in\n{}", ran.out);
    }
    for part in ["A block", "method.max_dofs=130", "tolerance", "max_dofs", "R²", "26 in block-study"] {
        assert!(ran.out.contains(part), "no {part} in\n{}", ran.out);
    }
}

/// Bit by bit the columns of the CSV are those of HDF5 and of the JSON object; the meshes are those of the steps.
fn check_columns(name: &str, rows: &[BTreeMap<String, f64>], group: &steklov_io::Group, o: &Value) {
    let column = |n: &str| rows.iter().map(|r| r[n]).collect::<Vec<f64>>();
    let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 0 } else { x.to_bits() }).collect::<Vec<_>>();
    for n in NUMBERS {
        assert_eq!(bits(&column(n)), bits(&steklov_io::load_vector(group, n).unwrap()), "{name}: {n}");
        let told: Vec<f64> = o["steps"].as_array().unwrap().iter().map(|s| s[n].as_f64().unwrap_or(f64::NAN)).collect();
        assert_eq!(bits(&column(n)), bits(&told), "{name}: {n}");
        assert!(!steklov_io::load_label(group, n).unwrap().meaning.is_empty());
    }
    for n in ["dofs", "elements", "max_degree"] {
        let stored: Vec<f64> = steklov_io::load_integers(group, n).unwrap().into_iter().map(|k| k as f64).collect();
        assert_eq!(column(n), stored, "{name}: {n}");
    }
    for (k, row) in rows.iter().enumerate() {
        let mesh: Mesh = steklov_io::load(&group.group(&format!("steps/{k:03}")).unwrap(), "mesh").unwrap();
        // on a closed boundary p nodes an element, two unknowns each
        let (dofs, highest) = (2 * mesh.degree.iter().sum::<usize>(), mesh.degree.iter().max().unwrap());
        assert_eq!([row["dofs"], row["elements"], row["max_degree"]], [dofs, mesh.len(), *highest].map(|n| n as f64));
    }
}

/// Effectivity and energy error by their definitions; seconds that rise; enough errors that are known.
fn check_numbers(name: &str, rows: &[BTreeMap<String, f64>], reference: f64) {
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row["step"], k as f64);
        assert!(row["error"].is_nan() == row["effectivity"].is_nan());
        assert!(row["error"].is_nan() || row["effectivity"] == row["estimate"] / row["error"], "{name}: {row:?}");
        let error = ((row["energy"] - reference).abs() / reference.abs()).sqrt();
        assert!((row["energy_error"] - error).abs() <= 1e-12 * error, "{name}: {row:?}");
        assert!(row["seconds"] > if k == 0 { 0.0 } else { rows[k - 1]["seconds"] }, "{name}: {row:?}");
    }
    let known: Vec<f64> = rows.iter().map(|r| r["error"]).filter(|e| e.is_finite()).collect();
    assert!(known.len() >= 3 && rows[0]["error"].is_finite(), "{name}: {known:?}");
    assert!(known.windows(2).all(|e| e[1] < e[0]), "{name}: errors rise, {known:?}");
}

/// The residual estimator is that of its parts, its effectivities and constants follow by their definitions, and it is the error but for
/// a factor that a block with friction keeps.
fn check_residuals(name: &str, rows: &[BTreeMap<String, f64>], group: &steklov_io::Group, o: &Value) {
    let parts = group.member_names().unwrap();
    let parts: Vec<Vec<f64>> = parts
        .iter()
        .filter(|n| n.starts_with("residual_") && !["residual_effectivity", "residual_constants"].contains(&n.as_str()))
        .map(|n| steklov_io::load_vector(group, n).unwrap())
        .collect();
    assert_eq!(parts.len(), 10);
    let (mut least, mut most, mut count) = (f64::INFINITY, 0.0f64, 0);
    for (k, row) in rows.iter().enumerate() {
        let sum: f64 = parts.iter().map(|part| part[k]).filter(|part| part.is_finite()).map(|part| part * part).sum();
        assert!((sum.sqrt() / row["residual"] - 1.0).abs() < 1e-12, "{name}: {row:?}");
        let ratio = row["residual"] / row["error"];
        assert!(ratio == row["residual_effectivity"] || ratio.is_nan(), "{name}: {row:?}");
        if ratio.is_finite() {
            (least, most, count) = (least.min(ratio), most.max(ratio), count + 1);
        }
    }
    assert!(1.0 < least && most < 7.0, "{name}: {least} to {most}");
    let told = &o["residual_constants"];
    let kept = group.group("residual_constants").unwrap();
    for (n, wanted) in [("reliability", 1.0 / least), ("efficiency", most)] {
        assert!((number(&told[n]) / wanted - 1.0).abs() < 1e-14, "{name}: {told}");
        assert_eq!(steklov_io::load_number(&kept, n).unwrap(), number(&told[n]));
    }
    assert_eq!(told["steps"], count);
}

/// What the logarithm of an error is linear in.
type Abscissa = fn(f64) -> f64;

/// The fitted rates follow from the columns.
fn check_fits(name: &str, rows: &[BTreeMap<String, f64>], o: &Value) {
    let laws: &[(&str, Abscissa)] = if name.starts_with("hp") {
        &[("square_root", f64::sqrt), ("cube_root", f64::cbrt)]
    } else {
        &[("algebraic", f64::ln)]
    };
    let fits = o["fits"].as_array().unwrap();
    assert_eq!(fits.len(), laws.len(), "{name}");
    for (fit, (law, abscissa)) in fits.iter().zip(laws) {
        assert_eq!(fit["law"], *law);
        let known: Vec<[f64; 2]> =
            rows.iter().filter(|r| r["error"].is_finite()).map(|r| [abscissa(r["dofs"]), r["error"].ln()]).collect();
        let last = &known[known.len() - fit["points"].as_u64().unwrap() as usize..];
        let rate = slope(last);
        assert!((number(&fit["rate"]) - rate).abs() < 1e-9 * rate.abs(), "{name}: {rate}, {fit}");
    }
}

/// A strategy that fails is told, and the others are there; one that is stopped keeps its step.
#[test]
fn strategies_that_fail_or_are_stopped_are_told() {
    let scene = |solver: &str| {
        let set = [format!("method.solver=\"{solver}\""), "method.tolerance=1e-2".into()];
        steklov_document::parse(crate::place::BLOCK, "block.toml", &set).unwrap()
    };
    let (good, bad) = (scene("auto"), scene("uzawa"));
    let reference = Reference::new(&good, &AtomicUsize::new(0), &mut |_, _| Ok(())).unwrap();
    let run = |scene, stops| {
        strategy(scene, ("hp", Refine::Hp), &reference, 1, &mut Watch::new(&AtomicUsize::new(stops), &mut |_, _| {}))
    };
    let strategies = [run(&bad, 0), run(&good, 1), run(&good, 0)];
    // Uzawa needs a body that is held
    let End::Failed(why) = &strategies[0].end else { panic!("{:?}", strategies[0].end) };
    assert!(strategies[0].points.is_empty() && !why.is_empty());
    assert_eq!((strategies[1].end.word(), strategies[1].points.len()), ("interrupted", 1));
    assert_eq!(strategies[2].end.word(), "tolerance");
    assert_eq!(strategies.each_ref().map(|s| s.complete()), [false, false, true]);
    let source = Source::default();
    let (why, steps) = (why.clone(), strategies[2].points.len());
    let strategies = strategies.to_vec();
    let mut study = Study { scene: &good, source: &source, reference, strategies, repeat: 1, interrupted: false };
    assert!(!study.complete() && report(&study).text().contains(&format!("FAILED after 0 steps: {why}")));
    assert_eq!(report(&study).tables[0].1.lines().count(), 1 + 1 + steps);
    study.interrupted = true;
    assert!(report(&study).text().contains("interrupted: what was finished is here"));
}

#[test]
fn a_study_that_cannot_be_made_is_refused_before_anything_is_solved() {
    let place = Place::new();
    fs::create_dir(place.path("empty")).unwrap();
    fs::create_dir(place.path("full")).unwrap();
    place.write("full/study.csv", "old");
    for (arguments, status, parts) in [
        (&["--what", "speed"][..], 2, &["speed"][..]),
        (&["--multipliers", "dual"], 2, &["dual", "biorthogonal", "stabilised"]),
        (&["--what", "stability", "--multipliers", "stabilised"], 1, &["--multipliers belongs to --what convergence"]),
        (
            &["--multipliers", "stabilised", "--set", "sides.floor={displacement=[\"0\", \"0\"]}"],
            1,
            &["no side", "leave it out"],
        ),
        (&["--strategies", "hp,best"], 2, &["best", "hp-decay"]),
        (&["--repeat", "0"], 2, &["0"]),
        (&["--out", "full"], 1, &["full exists", "--force"]),
        (&["--out", "block.toml"], 1, &["block.toml is not a folder"]),
        (&["--out", "block.toml/x"], 1, &["can be written into block.toml/x"]),
        (&["--set", "method.degre=1"], 1, &["degre", "degree"]),
        (&["--set", "method.max_dofs=8"], 1, &["max_dofs"]),
    ] {
        let ran = place.run(["study", "block.toml", "--quiet"].iter().chain(arguments)).demand(status);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{arguments:?}: {}", ran.err);
    }
    assert_eq!(place.names(), ["block.toml", "empty", "full"]);
    assert_eq!(place.read("full/study.csv"), b"old");
    let quick = ["--strategies", "hp", "--repeat", "1", "--set", "method.tolerance=0.1"];
    place.run(["study", "block.toml", "--out", "empty"].iter().chain(&quick)).demand(0);
    let forced = place.run(["study", "block.toml", "--out", "full", "--force"].iter().chain(&quick)).demand(0);
    assert!(place.read("full/study.csv").starts_with(b"strategy,step,"));
    let told: Vec<&str> = forced.err.lines().filter_map(|l| l.split_once(" s  ")).map(|(_, what)| what).collect();
    assert_eq!(told, ["reference", "hp, run 1 of 1", "hp, true errors", "files"]);
}

/// Ctrl-C in a long run: the step is finished, and what there is is stored, marked and drawn.
#[cfg(unix)]
#[test]
fn an_interrupted_study_stores_what_is_finished() {
    let place = Place::new();
    let long = ["study", "block.toml", "--strategies", "uniform-h,hp", "--json", "--set", "method.max_dofs=100000"];
    let mut child = place.command().args(long).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(told.any(|line| line.ends_with("uniform-h, run 1 of 3")), "the first strategy does not begin");
    let kill = Command::new("sh").args(["-c", "kill -INT \"$0\"", &child.id().to_string()]).status().unwrap();
    assert!(kill.success() && told.any(|line| line == "finishing this step; again to stop at once"));
    let o = Ran::new(child.wait_with_output().unwrap()).demand(3).json();
    assert_eq!((&o["interrupted"], &o["complete"]), (&json!(true), &json!(false)));
    let strategies = o["strategies"].as_array().unwrap();
    assert_eq!((strategies.len(), &strategies[0]["reason"]), (1, &json!("interrupted")));
    let steps = strategies[0]["steps"].as_array().unwrap().len();
    let stored = steklov_io::open(place.path("block-study/study.h5")).unwrap();
    let dofs = stored.group("strategies/uniform-h").unwrap();
    assert_eq!(steklov_io::load_integers(&dofs, "dofs").unwrap().len(), steps);
    assert!(names(&place.path("block-study")).contains(&"error-dofs.png".to_owned()));
}

/// Every strategy with each multiplier: the energies are those of the multipliers alone, and the true errors are close.
#[test]
fn multipliers_are_compared() {
    let place = Place::new();
    let few = ["--repeat", "1", "--quiet", "--force", "--set", "method.max_dofs=130"];
    let both = ["study", "block.toml", "--strategies", "hp,uniform-h", "--multipliers", "stabilised,biorthogonal"];
    place.run(both.iter().chain(&few)).demand(0);
    let file = steklov_io::open(place.path("block-study/study.h5")).unwrap();
    let wanted = ["uniform-h, biorthogonal", "uniform-h, stabilised", "hp, biorthogonal", "hp, stabilised"];
    assert_eq!(steklov_io::load_texts(&file, "strategy_names").unwrap(), wanted);
    let table = String::from_utf8(place.read("block-study/study.csv")).unwrap();
    let files = names(&place.path("block-study"));
    let column = |name: &str, column: &str| {
        let group = file.group(&format!("strategies/{name}")).unwrap();
        steklov_io::load_vector(&group, column).unwrap()
    };
    for name in wanted {
        assert!(files.contains(&format!("meshes-{}.png", name.replace(", ", "-"))), "{files:?}");
        let rows = table.lines().filter(|l| l.starts_with(&format!("\"{name}\",0,16,1,32,"))).count();
        assert_eq!(rows, 1, "{name}");
    }
    for multiplier in ["biorthogonal", "stabilised"] {
        let set = format!("method.multiplier=\"{multiplier}\"");
        let alone = ["study", "block.toml", "--strategies", "uniform-h", "--json", "--out", "alone", "--set", &set];
        let o = place.run(alone.iter().chain(&few)).demand(0).json();
        let energies: Vec<f64> =
            of(&o, "uniform-h")["steps"].as_array().unwrap().iter().map(|s| number(&s["energy"])).collect();
        assert_eq!(energies, column(&format!("uniform-h, {multiplier}"), "energy"));
    }
    let [a, b] = ["biorthogonal", "stabilised"].map(|m| column(&format!("uniform-h, {m}"), "error"));
    assert!(a != b && a.len() == 3 && a.iter().zip(&b).all(|(a, b)| (a / b - 1.0).abs() < 0.2), "{a:?} {b:?}");
}

//! The command `study --what inf-sup`: kernels that dimensions tell of, stable pairs, pressures that oscillate, files that
//! agree with each other, refusals.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicUsize;

use crate::place::{Place, names};
use serde_json::{Value, json};
use steklov_document::Source;
use steklov_study::Watch;
use steklov_study::inf_sup::{InfSup, PAIRS, Point, Pressure, Pressures, pairs, pictures, pressures, report};

const FILES: &str = "inf-sup-degree.png inf-sup-degree.svg inf-sup-elements-1.png inf-sup-elements-1.svg \
                     inf-sup-elements-2.png inf-sup-elements-2.svg inf-sup-elements-3.png inf-sup-elements-3.svg \
                     inf-sup.csv inf-sup.h5 pressure-floor.png pressure-floor.svg pressure.csv";

/// A square of side 2, of which the floor has a quarter of the elements; `top` is the condition of its top.
fn square(young: f64, top: &str) -> String {
    format!(
        "[body]\ncorners = [[0, 0], [2, 0], [2, 2], [0, 2]]\nsides = [\"floor\", \"right\", \"top\", \"left\"]\n\
         [material]\nyoung = {young}\npoisson = 0.3\n[sides.floor]\ncontact = {{ gap = \"0\" }}\n\
         [sides.top]\n{top}\n[method]\nelements = 8\nmax_dofs = 64\n"
    )
}

fn betas(text: &str) -> Vec<Point> {
    pairs(&steklov_document::parse(text, "scene", &[]).unwrap(), &mut Watch::new(&AtomicUsize::new(0), &mut |_, _| {}))
        .unwrap()
}

fn called(name: &str) -> usize {
    PAIRS.iter().position(|p| p.name == name).unwrap()
}

/// A pair of more multipliers than displacements on the floor has β = 0, whatever holds the body; biorthogonal and
/// continuous ones have β far above it on every mesh; all have it with stabilisation. β has no unit.
#[test]
fn dimensions_tell_of_kernels_and_stabilisation_removes_them() {
    for top in ["traction = [\"0\", \"-1\"]", "displacement = [\"0\", \"0\"]"] {
        let all = betas(&square(1.0, top));
        assert_eq!(all.len() % PAIRS.len(), 0);
        for p in &all {
            let (name, n) = (PAIRS[p.pair].name, p.elements / 4);
            // two components each
            let (displacements, q) = (2 * (n * p.degree + 1), p.degree + 1);
            let multipliers = match name {
                "biorthogonal" | "continuous P_p" => displacements,
                "discontinuous P_p" => 2 * n * q,
                "discontinuous P_(p-1)" => 2 * n * p.degree,
                "P_p, halved elements" => 4 * n * q,
                "P_p, joined elements" => n * q,
                _ => 2 * (n + 1) * q,
            };
            assert_eq!(p.multipliers, multipliers, "{name}");
            let stable = match multipliers.cmp(&displacements) {
                std::cmp::Ordering::Greater => 0.0..1e-6,
                std::cmp::Ordering::Equal => 0.7..1.0,
                std::cmp::Ordering::Less => 0.1..1.0,
            };
            assert!(p.failure.is_none() && stable.contains(&p.plain), "{top}, {name}: {p:?}");
            assert!(p.stabilised > 0.4 && p.stabilised > p.plain && p.stabilised < 1.0, "{top}, {name}: {p:?}");
        }
        // a subspace has no smaller constant
        for mesh in all.chunks(PAIRS.len()) {
            let whole = mesh[called("discontinuous P_p")].stabilised;
            for part in ["biorthogonal", "continuous P_p"] {
                assert!(mesh[called(part)].stabilised >= whole, "{part}: {mesh:?}");
            }
        }
        // one unknown short of a kernel: β falls with the elements, where that of biorthogonal ones does not
        let of = |name: &str, elements: usize| {
            let at = |p: &&Point| (p.pair, p.elements, p.degree) == (called(name), elements, 1);
            all.iter().find(at).unwrap().plain
        };
        assert!(of("discontinuous P_(p-1)", 32) < 0.6 * of("discontinuous P_(p-1)", 8));
        assert!(of("biorthogonal", 32) > 0.95 * of("biorthogonal", 8));
        for (a, b) in all.iter().zip(betas(&square(1e6, top))) {
            assert!((a.plain - b.plain).abs() < 1e-6 && (a.stabilised - b.stabilised).abs() < 1e-6, "{a:?} {b:?}");
        }
    }
}

/// HDF5, CSV, JSON object and table tell the same; both pressures carry the load.
#[test]
fn the_files_agree() {
    let place = Place::new();
    let ran = place.run(["study", "block.toml", "--what", "inf-sup", "--set", "method.max_dofs=128"]).demand(0);
    let told: Vec<&str> = ran.err.lines().filter_map(|l| l.split_once(" s  ")).map(|(_, what)| what).collect();
    assert_eq!(told, ["pressure", "inf-sup constants", "files"]);
    assert_eq!(names(&place.path("block-inf-sup")).join(" "), FILES);
    for name in FILES.split_whitespace().filter(|n| n.ends_with("png") || n.ends_with("svg")) {
        let start = if name.ends_with("png") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"<" };
        assert!(place.read(&format!("block-inf-sup/{name}")).starts_with(start), "{name}");
    }
    let file = steklov_io::open(place.path("block-inf-sup/inf-sup.h5")).unwrap();
    let o: Value = serde_json::from_str(&steklov_io::load_text(&file, "summary").unwrap()).unwrap();
    assert_eq!((&o["complete"], &o["interrupted"], &o["failures"]), (&json!(true), &json!(false), &json!([])));
    let [pairs, pressure] = ["inf-sup.csv", "pressure.csv"].map(|f| tables(&place, &format!("block-inf-sup/{f}")));
    assert_eq!(pairs.len(), PAIRS.len());
    for (k, pair) in o["pairs"].as_array().unwrap().iter().enumerate() {
        let group = file.group(&format!("pairs/{k:03}")).unwrap();
        assert_eq!(pair["name"], steklov_io::load_text(&group, "name").unwrap());
        assert_eq!(pair["name"], PAIRS[k].name);
        check(&group, &pairs[PAIRS[k].name], &pair["points"]);
    }
    let solutions = o["pressure"]["solutions"].as_array().unwrap();
    assert_eq!((solutions.len(), pressure.len()), (2, 2));
    for (k, solution) in solutions.iter().enumerate() {
        let group = file.group(&format!("pressure/{k:03}")).unwrap();
        let columns = &pressure[&format!("{:?}", solution["gamma"].as_f64().unwrap())];
        check(&group, columns, &solution["points"]);
        let force: f64 = columns["pressure"].iter().zip(&columns["weight"]).map(|(p, w)| p * w).sum();
        assert!((force - 2.0).abs() < 1e-7, "{force}");
        let largest = columns["pressure"].iter().fold(0.0, |m: f64, p| m.max(*p));
        let variation: f64 = columns["pressure"].windows(2).map(|p| (p[1] - p[0]).abs()).sum();
        assert_eq!([&solution["largest"], &solution["variation"]], [&json!(largest), &json!(variation)]);
        assert!(ran.out.contains(&format!("largest {largest:.4e}, rises and falls {variation:.4e}")), "{}", ran.out);
    }
    for part in ["A block", "method.elements=8", "biorthogonal", "16  elements", "13 in block-inf-sup"] {
        assert!(ran.out.contains(part), "no {part} in\n{}", ran.out);
    }
}

/// Over a wedge, where the pressure is no polynomial: it rises to one peak and falls, but for small steps, with
/// stabilisation; without it goes up and down several times.
#[test]
fn the_unstable_pressure_oscillates() {
    let wedge = square(1000.0, "displacement = [\"0\", \"0\"]").replace("\"0\" }", "\"abs(x-1)/10 - 0.1\" }");
    let wedge = wedge.replace("max_dofs = 64", "max_dofs = 128");
    let scene = steklov_document::parse(&wedge, "scene", &[]).unwrap();
    let all = pressures(&scene, &mut Watch::new(&AtomicUsize::new(0), &mut |_, _| {})).unwrap();
    let [stable, unstable] = &all.solutions[..] else { panic!("{all:?}") };
    assert!((stable.gamma / stable.critical - 0.5).abs() < 1e-12 && unstable.gamma < 1e-4 * stable.gamma);
    let peaks = [stable, unstable].map(|p| p.variation() / (2.0 * p.largest()));
    println!("{peaks:?}");
    assert_eq!((all.elements, all.degree), (32, 2));
    assert!(stable.converged && peaks[0] > 0.99 && peaks[0] < 1.5 && peaks[1] > 3.0, "{peaks:?}");
}

/// Columns by name.
type Table = BTreeMap<String, Vec<f64>>;

/// The tables of a CSV file by its first column; empty cells are NaN.
fn tables(place: &Place, file: &str) -> BTreeMap<String, Table> {
    let text = String::from_utf8(place.read(file)).unwrap();
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap().split(',').skip(1).collect();
    let mut all: BTreeMap<String, Table> = BTreeMap::new();
    for line in lines {
        let (key, rest) = match line.strip_prefix('"') {
            Some(quoted) => quoted.split_once("\",").unwrap(),
            None => line.split_once(',').unwrap(),
        };
        let cells: Vec<&str> = rest.split(',').collect();
        assert_eq!(cells.len(), heads.len(), "{line}");
        for (head, cell) in heads.iter().zip(cells) {
            let value = if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
            all.entry(key.to_owned()).or_default().entry((*head).to_owned()).or_default().push(value);
        }
    }
    all
}

/// Bit by bit the columns are those of HDF5 and of the JSON object.
fn check(group: &steklov_io::Group, table: &Table, object: &Value) {
    let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 0 } else { (x + 0.0).to_bits() }).collect::<Vec<_>>();
    for (name, values) in table {
        assert_eq!(bits(values), bits(&steklov_io::load_vector(group, name).unwrap()), "{name}");
        let rows = object.as_array().unwrap();
        let told: Vec<f64> = rows.iter().map(|r| r[name].as_f64().unwrap_or(f64::NAN)).collect();
        assert_eq!(bits(values), bits(&told), "{name}");
        assert!(!steklov_io::load_label(group, name).unwrap().meaning.is_empty());
    }
}

/// What failed is told with its mesh; after a wish to stop there is what there is, and it can be drawn.
#[test]
fn failures_and_interruptions_are_told() {
    let scene = steklov_document::parse(crate::place::BLOCK, "block.toml", &[]).unwrap();
    let stopped = AtomicUsize::new(1);
    let (none, nothing) = (
        pairs(&scene, &mut Watch::new(&stopped, &mut |_, _| {})).unwrap(),
        pressures(&scene, &mut Watch::new(&stopped, &mut |_, _| {})).unwrap(),
    );
    assert!(none.is_empty() && nothing.solutions.is_empty());
    let source = &Source::default();
    let study = InfSup { scene: &scene, source, points: none, pressures: nothing.clone(), interrupted: true };
    assert!(!study.complete() && report(&study).text().contains("interrupted: what was finished is here"));
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(pictures(&study, folder.path()).unwrap().len(), 2);

    let failed = Point {
        pair: 4,
        elements: 16,
        degree: 2,
        dofs: 64,
        multipliers: 48,
        plain: f64::NAN,
        stabilised: 0.5,
        failure: Some("not positive".into()),
    };
    let solutions =
        vec![Pressure { gamma: 1e-9, critical: 1.0, converged: false, rows: vec![], failure: Some("lost".into()) }];
    let pressures = Pressures { solutions, ..nothing };
    let study = InfSup { scene: &scene, source, points: vec![failed], pressures, interrupted: false };
    let told = report(&study).text();
    assert!(!study.complete(), "{told}");
    for part in ["FAILED: P_p, halved elements on 16 elements of degree 2: not positive", "no solution: lost"] {
        assert!(told.contains(part), "no {part} in\n{told}");
    }
}

#[test]
fn what_cannot_be_studied_is_refused_before_anything_is_solved() {
    let place = Place::new();
    std::fs::create_dir(place.path("full")).unwrap();
    place.write("full/old", "old");
    let free =
        crate::place::BLOCK.replace("contact = { gap = \"0\", friction = { tresca = \"F\" } }", "pressure = \"1\"");
    place.write("free.toml", &free);
    place.write("lifted.toml", crate::place::BLOCK.replace("\"-1\"", "\"1\""));
    let before = place.names();
    for (scene, arguments, parts) in [
        ("free.toml", &[][..], &["free.toml", "no side is in contact", "give a side contact"][..]),
        ("block.toml", &["--strategies", "hp"], &["--strategies belongs to --what convergence"]),
        ("block.toml", &["--multipliers", "stabilised"], &["--multipliers belongs to --what convergence"]),
        ("block.toml", &["--beside", "none.json"], &["--beside belongs to --what stability"]),
        ("block.toml", &["--out", "full"], &["full exists", "--force"]),
        ("block.toml", &["--set", "method.max_dofs=8"], &["max_dofs"]),
        ("lifted.toml", &[], &["nothing holds the body"]),
    ] {
        let ran = place.run(["study", scene, "--what", "inf-sup", "--quiet"].iter().chain(arguments)).demand(1);
        assert!(parts.iter().all(|part| ran.err.contains(part)), "{parts:?}: {}", ran.err);
    }
    assert_eq!(place.names(), before);
}

//! Pictures and tables of results on grids: which there are, and that they tell what was solved.

use crate::place::{Place, names};

/// A strip on rollers, pulled at its right end: the stress is (3, 0, 0) everywhere.
const STRIP: &str = r#"title = "Strip"
[body]
corners = [[1, -1], [5, -1], [5, 0], [1, 0]]
sides = ["lower", "right", "upper", "left"]
[material]
young = 100
poisson = 0.3
[sides.left]
displacement = [0, "free"]
[sides.lower]
displacement = ["free", 0]
[sides.right]
traction = [3, 0]
[grid]
coarse = [4, 2]
fine = [4, 3]
[method]
model = "msfem"
refine = "none"
"#;

/// Names of the pictures of a scene without the part that all have; all are there in both formats, and `show` draws the same.
fn drawn(place: &Place, scene: &str, set: &[&str]) -> Vec<String> {
    place.write("it.toml", scene);
    let sets = set.iter().flat_map(|s| ["--set", s]);
    place.run(["solve", "it.toml", "--quiet", "--force", "--plots", "solved"].into_iter().chain(sets));
    place.run(["show", "it.vtkhdf", "--plots", "shown"]).demand(0);
    let files = names(&place.path("solved"));
    assert_eq!(files, names(&place.path("shown")));
    for file in &files {
        assert!(place.read(&format!("solved/{file}")) == place.read(&format!("shown/{file}")), "{file}");
    }
    let pngs: Vec<String> =
        files.iter().filter_map(|f| f.strip_suffix(".png")?.strip_prefix("it-").map(str::to_owned)).collect();
    assert_eq!(2 * pngs.len(), files.len());
    for folder in ["solved", "shown"] {
        std::fs::rename(place.path(folder), place.path(&format!("{folder}-of-{}", place.names().len()))).unwrap();
    }
    pngs
}

const CELLS: &str = "material.cells={ size = 0.25, young = \"if(x > 2, 99, 1)\" }";
const NO_YOUNG: (&str, &str) = ("young = 100\n", "");

#[test]
fn a_result_has_the_pictures_that_belong_to_it() {
    let place = Place::new();
    let rough = STRIP.replace(NO_YOUNG.0, NO_YOUNG.1);
    let cells = [CELLS, "grid.fine=[4, 2]"];
    assert_eq!(drawn(&place, STRIP, &["method.model=\"bem\""]), ["body"]);
    assert_eq!(drawn(&place, STRIP, &["method.model=\"fem\""]), ["body", "stress"]);
    assert_eq!(drawn(&place, &rough, &[&cells[..], &["method.model=\"fem\""]].concat()), ["body", "moduli", "stress"]);
    // the error of a basis that does not conform is not estimated
    let periodic = [&cells[..], &["grid.basis=\"periodic\""]].concat();
    assert_eq!(drawn(&place, &rough, &periodic), ["basis-deformed", "basis", "body", "moduli", "stress"]);
    assert_eq!(drawn(&place, &rough, &cells), ["basis-deformed", "basis", "body", "estimate", "moduli", "stress"]);
    let steps = [&cells[..], &["method.refine=\"h\"", "method.max_steps=2"]].concat();
    assert_eq!(
        drawn(&place, &rough, &steps),
        ["basis-deformed", "basis", "body", "estimate", "moduli", "steps", "stress"]
    );
    let on_floor = STRIP.replace("displacement = [\"free\", 0]", "contact = { gap = \"0\" }");
    assert!(drawn(&place, &on_floor, &[]).contains(&"contact-lower".to_owned()));
}

#[test]
fn moduli_of_many_magnitudes_are_drawn_by_their_logarithms() {
    let place = Place::new();
    place.write("it.toml", STRIP.replace(NO_YOUNG.0, NO_YOUNG.1));
    for (cells, logarithmic) in [(CELLS.to_owned(), false), (CELLS.replace("99", "100"), true)] {
        let set = ["--set", &cells, "--set", "grid.fine=[4, 2]", "--plots", "."];
        place.run(["solve", "it.toml", "--quiet", "--force"].iter().chain(&set)).demand(0);
        let svg = String::from_utf8(place.read("it-moduli.svg")).unwrap();
        assert!(svg.contains("Young") && svg.contains("log10 of Young") == logarithmic);
    }
}

/// The rows of a table under its head.
fn table(place: &Place, name: &str, head: &str) -> Vec<Vec<f64>> {
    let text = String::from_utf8(place.read(&format!("tables/it-{name}.csv"))).unwrap();
    let (first, rest) = text.split_once('\n').unwrap();
    assert_eq!(first, head);
    rest.lines().map(|line| line.split(',').map(|v| v.parse().unwrap_or(f64::NAN)).collect()).collect()
}

#[test]
fn tables_have_the_closed_form_of_a_pulled_strip() {
    let place = Place::new();
    place.write("it.toml", STRIP);
    for (set, coarse) in [("method.model=\"fem\"", false), ("method.model=\"msfem\"", true)] {
        place.run(["solve", "it.toml", "--quiet", "--force", "--set", set]).demand(0);
        place.run(["show", "it.vtkhdf", "--csv", "tables"]).demand(0);
        let cells = table(&place, "cells", "x,y,young,sigma_xx,sigma_yy,sigma_xy,von_mises");
        assert_eq!(cells.len(), 16 * 6);
        // plane strain: the stress across the plane is ν 3
        let von_mises = (0.5 * (9.0 + 0.81 + 4.41_f64)).sqrt();
        for row in &cells {
            let wanted = [100.0, 3.0, 0.0, 0.0, von_mises];
            assert!(row[2..].iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-11), "{row:?}");
        }
        let centre = |k: usize| cells.iter().map(|row| row[k]).sum::<f64>() / cells.len() as f64;
        assert!((centre(0) - 3.0).abs() < 1e-13 && (centre(1) + 0.5).abs() < 1e-13);
        let nodes = table(&place, "nodes", "x,y,ux,uy");
        assert_eq!(nodes.len(), 17 * 7);
        for row in &nodes {
            let wanted = [3.0 * 0.91 / 100.0 * (row[0] - 1.0), -3.0 * 0.39 / 100.0 * (row[1] + 1.0)];
            assert!((row[2] - wanted[0]).hypot(row[3] - wanted[1]) < 1e-13, "{row:?}");
        }
        assert_eq!(place.path("tables/it-coarse.csv").exists(), coarse);
    }
    // a load that bends: the squares of the indicators are the estimate, the coarse cells fill the body
    let set = ["--set", "sides.right.traction=[0, 1]", "--set", "sides.left.displacement=[0, 0]"];
    let set = [&set[..], &["--set", "sides.lower={}"]].concat();
    let told = place.json(0, &[&["it.toml", "--quiet"], &set[..]].concat());
    place.run(["show", "it.vtkhdf", "--csv", "tables"]).demand(0);
    let coarse = table(&place, "coarse", "x0,y0,x1,y1,indicator");
    assert_eq!(coarse.len(), 8);
    let area: f64 = coarse.iter().map(|row| (row[2] - row[0]) * (row[3] - row[1])).sum();
    assert!((area - 4.0).abs() < 1e-14);
    let estimate = coarse.iter().map(|row| row[4]).sum::<f64>().sqrt();
    let wanted = told["grid"]["estimate_multiscale"].as_f64().unwrap();
    assert!(wanted > 0.0 && (estimate / wanted - 1.0).abs() < 1e-13, "{estimate} {wanted}");
    // without an estimate its column is empty
    let set = [&set[..], &["--set", "grid.basis=\"periodic\""]].concat();
    place.json(0, &[&["it.toml", "--quiet"], &set[..]].concat());
    place.run(["show", "it.vtkhdf", "--csv", "tables"]).demand(0);
    let coarse = table(&place, "coarse", "x0,y0,x1,y1,indicator");
    assert!(coarse.len() == 8 && coarse.iter().all(|row| row.len() == 5 && row[4].is_nan()));
}

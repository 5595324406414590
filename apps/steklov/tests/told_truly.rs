//! What pictures, tables and summaries say is what the solution has.

use crate::place::Place;

/// A block with a short crack that a pressure opens.
const CRACK: &str = r#"title = "Opened"
[body]
corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[body.cracks]]
points = [[-0.05, 0], [0.05, 0]]
side = "flaw"
[material]
young = 1000.0
poisson = 0.3
[sides.flaw]
pressure = 1
[sides.bottom]
displacement = ["0", "0"]
"#;

/// A table of `show --csv`.
fn table(place: &Place, name: &str) -> Vec<Vec<f64>> {
    let text = String::from_utf8(place.read(name)).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect()
}

/// The faces of a crack in the plane open by 2 (1-ν²) p a / E each in the middle: 9.1e-5. The drawn points are the ends of so short
/// a crack, which do not move.
#[test]
fn the_largest_displacement_of_a_picture_is_that_of_the_solution() {
    let place = Place::new();
    place.write("crack.toml", CRACK);
    place.run(["solve", "crack.toml", "--plots", "p"]).demand(0);
    place.run(["show", "crack.vtkhdf", "--csv", "p"]).demand(0);
    let largest = table(&place, "p/crack-displacement.csv").iter().map(|r| r[2].hypot(r[3])).fold(0.0, f64::max);
    assert!((largest / 9.1e-5 - 1.0).abs() < 0.1, "{largest}");
    let svg = String::from_utf8(place.read("p/crack-body.svg")).unwrap();
    let told = svg.split("the largest displacement is ").nth(1).unwrap().split('<').next().unwrap();
    let told: f64 = told.replace("·10⁻⁵", "e-5").parse().expect(told);
    assert!((told / largest - 1.0).abs() < 0.01, "{told} {largest}");
}

/// A block held at its left side and pulled at its right one.
const HELD: &str = r#"
[body]
corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1000.0
poisson = 0.3
[sides.left]
displacement = ["0", "free"]
traction = ["0", "0.25*y"]
[sides.right]
traction = ["1 + y", "0"]
[sides.bottom]
displacement = ["0", "0"]
[sides.top]
pressure = "0.5*x"
"#;

#[test]
fn tractions_are_what_is_prescribed_where_they_are() {
    let place = Place::new();
    place.write("held.toml", HELD);
    let grid = ["--set", "method.model=\"fem\"", "--set", "grid.coarse=[8, 4]", "--set", "grid.fine=[2, 2]"];
    for more in [&[][..], &grid] {
        place.run(["solve", "held.toml", "--force"].iter().chain(more));
        place.run(["show", "held.vtkhdf", "--csv", "p"]).demand(0);
        let rows = table(&place, "p/held-traction.csv");
        let (mut sides, mut held) = ([0; 4], 0.0_f64);
        for row in &rows {
            let &[x, y, tx, ty] = row.as_slice() else { panic!() };
            let (side, given) = match (x, y) {
                (2.0, _) => (0, [Some(1.0 + y), Some(0.0)]),
                (_, 1.0) => (1, [Some(0.0), Some(-0.5 * x)]),
                (0.0, _) => (2, [None, Some(0.25 * y)]),
                _ => (3, [None; 2]),
            };
            sides[side] += 1;
            for (given, told) in given.iter().zip([tx, ty]) {
                assert!(given.is_none_or(|given| (given - told).abs() < 1e-14), "({x}, {y}): {given:?} {told}");
            }
            held = if side == 3 { held.max(ty.abs()) } else { held };
        }
        assert!(sides.iter().all(|&n| n > 3), "{sides:?}");
        // where displacements are given it is that of the solution
        assert!(held > 0.5, "{held}");
    }
}

/// A body of 4 by 2 modulus cells, of which one is stiff.
const CELLS: &str = r#"
[body]
corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
[material.cells]
size = 0.5
young = { file = "young.h5", dataset = "/E" }
[grid]
coarse = [4, 2]
fine = [2, 2]
[sides.left]
displacement = ["0", "0"]
[sides.right]
traction = ["1", "0"]
[method]
model = "fem"
refine = "none"
"#;

/// Writes a table with an attribute as h5py does.
fn write_table(place: &Place, rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64, axes: &str) {
    let rows: Vec<Vec<f64>> = (0..rows).map(|i| (0..columns).map(|j| value(i, j)).collect()).collect();
    let attribute = if axes.is_empty() { String::new() } else { format!("f['E'].attrs['axes'] = {axes}") };
    let program =
        format!("import h5py\nwith h5py.File('young.h5', 'w') as f:\n    f['E'] = {rows:?}\n    {attribute}\n");
    let python = std::env::var("STEKLOV_PYTHON").expect("STEKLOV_PYTHON: a Python with h5py, as scripts/test makes it");
    let ran = std::process::Command::new(python).args(["-c", &program]).current_dir(place.path("")).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
}

/// The moduli of a table by its order, each of which is told; the stiff cell is the second one along x in the upper row.
#[test]
fn tables_of_moduli_lie_as_they_are_said_to() {
    let place = Place::new();
    let stiff = |ix: usize, iy: usize| if [ix, iy] == [1, 1] { 100.0 } else { 1.0 + ix as f64 + 4.0 * iy as f64 };
    place.write("cells.toml", CELLS);
    let columns = "first index along x, second one along y upwards";
    let image = "rows along y from the top, columns along x, as in an image";
    let upwards = "first index along y upwards, second one along x";
    let order = |word: &'static str| ["--set", word];
    let rows = order("material.cells.young.order=\"rows\"");
    let xy = order("material.cells.young.order=\"xy\"");
    let mut energies = Vec::new();
    for (kind, axes, set, told) in [
        ("xy", "", &[][..], columns),
        ("xy", "", &xy, columns),
        ("xy", "['ix', 'iy']", &[], columns),
        ("rows", "", &rows, image),
        ("rows", "'rows'", &[], image),
        ("rows", "['row', 'column']", &rows, image),
        ("yx", "['y', 'x']", &[], upwards),
    ] {
        match kind {
            "xy" => write_table(&place, 4, 2, stiff, axes),
            "rows" => write_table(&place, 2, 4, |row, column| stiff(column, 1 - row), axes),
            _ => write_table(&place, 2, 4, |iy, ix| stiff(ix, iy), axes),
        }
        let ran = place.run(["solve", "cells.toml", "--force"].iter().chain(set)).demand(0);
        assert!(ran.out.contains(&format!("modulus /E of young.h5: {told}\n")), "{}", ran.out);
        let plan = place.run(["plan", "cells.toml"].iter().chain(set)).demand(0);
        assert!(plan.out.contains(&format!("/E of young.h5: {told}")), "{}", plan.out);
        energies.push(place.run(["show", "cells.vtkhdf", "--json"]).demand(0).json()["energy"].as_f64().unwrap());
    }
    assert!(energies.iter().all(|e| *e == energies[0]), "{energies:?}");
    // another order than that of the file is refused, and a word that is none
    write_table(&place, 4, 2, stiff, "['x', 'y']");
    let ran = place.run(["plan", "cells.toml"].iter().chain(&rows)).demand(1);
    assert!(ran.err.contains("is another one than that of the attribute axes"), "{}", ran.err);
    let ran = place.run(["plan", "cells.toml", "--set", "material.cells.young.order=\"row\""]).demand(1);
    assert!(ran.err.contains("did you mean rows? The choices are xy, rows"), "{}", ran.err);
    // an image of the transposed shape is answered by the key
    write_table(&place, 2, 4, stiff, "");
    let ran = place.run(["plan", "cells.toml"]).demand(1);
    assert!(ran.err.contains("order = \"rows\""), "{}", ran.err);
    // the entry of an impossible modulus is that of the file
    write_table(&place, 2, 4, |row, column| if [row, column] == [0, 3] { -1.0 } else { 1.0 }, "'rows'");
    let ran = place.run(["plan", "cells.toml"]).demand(1);
    assert!(ran.err.contains("centre (1.75, 0.75): entry [0, 3] of /E"), "{}", ran.err);
}

/// A block on a floor of which the gap is random: in half of the outcomes it touches nowhere.
const OUTCOMES: &str = r#"
[body]
corners = [[0, 0], [10, 0], [10, 2], [0, 2]]
sides = ["floor", "right", "top", "left"]
[material]
young = 1000.0
poisson = 0.3
[random.rise]
distribution = "uniform"
low = -1.0
high = 1.0
[random.more]
distribution = "uniform"
low = -1.0
high = 1.0
[sides.floor]
contact = { gap = "0.001*rise + 0.0005*more" }
[sides.top]
displacement = ["0", "-0.0001"]
[method]
refine = "none"
elements = 24
[stochastic]
degree = 2
quantities = ["contact.length", "contact.force.x", "contact.force.y", "energy", "strain_energy"]
"#;

#[test]
fn numbers_of_the_mean_input_are_told_to_be_that() {
    let place = Place::new();
    place.write("random.toml", OUTCOMES);
    let out = place.run([
        "solve",
        "random.toml",
        "--set",
        "stochastic.method=\"monte-carlo\"",
        "--set",
        "stochastic.samples=50",
    ]);
    let told =
        out.out.find("mean input  what follows is one solution, of the mean of the random input").expect(&out.out);
    assert!(told < out.out.find("energy J").unwrap() && told < out.out.find("outcomes ").unwrap());
    assert!(!place.run(["solve", "block.toml"]).demand(0).out.contains("mean input"));
}

/// The force along x is 0 but for rounding, whatever the outcome: a constant, not a density.
#[test]
fn a_spread_of_rounding_has_no_quantiles() {
    let place = Place::new();
    place.write("random.toml", OUTCOMES);
    for method in ["galerkin", "monte-carlo"] {
        let set = format!("stochastic.method=\"{method}\"");
        let ran =
            place.run(["solve", "random.toml", "--force", "--json", "--set", &set, "--set", "stochastic.samples=200"]);
        let o = ran.json();
        let of = |path: &str| o.pointer(&format!("/stochastic/contact/{path}")).unwrap().clone();
        assert_eq!((of("force/x/quantiles").is_null(), of("force/y/quantiles").is_array()), (true, true), "{method}");
        assert!(of("length/quantiles").is_array() && of("force/x/effects").is_null(), "{method}");
        let force = |component: &str| of(&format!("force/{component}/mean")).as_f64().unwrap();
        assert!(force("x").abs() < 1e-9 * force("y").abs(), "{} {}", force("x"), force("y"));
        place.run(["show", "random.vtkhdf", "--plots", "p"]).demand(0);
        let svg = String::from_utf8(place.read("p/random-density.svg")).unwrap();
        assert!(svg.contains(">contact.force.y<") && svg.contains(">contact.force.x<"));
        assert_eq!(svg.matches(">constant ").count(), 1, "{method}");
    }
}

/// A sparse grid has a negative weight in the middle: where the block touches everywhere but there the mean of the length is more than
/// all of the floor, the other way round less than nothing.
#[test]
fn a_mean_out_of_its_bounds_is_told_as_such() {
    let place = Place::new();
    place.write("random.toml", OUTCOMES);
    let (open, closed) = ("0.001 - 0.02*(rise^2 + more^2)", "0.02*(rise^2 + more^2) - 0.001");
    for (gap, level, beyond) in [
        (open, 1, Some(11.111)),
        (open, 2, Some(11.225)),
        (closed, 1, Some(-1.111)),
        ("0.001*rise + 0.0005*more", 1, None),
        ("0.001*rise + 0.0005*more", 3, None),
    ] {
        let set = [
            "stochastic.method=\"sparse\"".to_owned(),
            format!("stochastic.level={level}"),
            format!("sides.floor.contact.gap=\"{gap}\""),
        ];
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let ran = place.run(["solve", "random.toml", "--force"].iter().chain(&set));
        let o = place.run(["show", "random.vtkhdf", "--json"]).demand(0).json();
        let length = &o["stochastic"]["contact"]["length"];
        let mean = length["mean"].as_f64().unwrap();
        match beyond {
            Some(wanted) => {
                assert!((mean - wanted).abs() < 1e-3, "{gap} {level}: {mean}");
                assert_eq!(length["bounds_left"], serde_json::json!([0.0, 10.0]));
            }
            None => assert!((0.0..10.0).contains(&mean) && length.get("bounds_left").is_none(), "{length}"),
        }
        let told = "NOT RESOLVED: out of 0 to 10, which it cannot leave, by this rule";
        assert_eq!(ran.out.contains(told), beyond.is_some(), "{}", ran.out);
        assert!(beyond.is_none() || o["estimate_doubts"].as_array().unwrap().contains(&"outcomes".into()));
    }
}

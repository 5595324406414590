//! Numbers of the JSON objects follow the units that `docs/reference/json.md` gives them: each scene in two systems of units.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::json_reference::{Row, Table, parts_of_page};
use crate::place::Place;

/// Scenes of one shape in other units: <2 L> is 2 times the factor of lengths, P that of stresses.
const IN_UNITS: [&str; 5] = [
    r#"[body]
corners = [[0, 0], [<2 L>, 0], [<2 L>, <1 L>], [0, <1 L>]]
sides = ["floor", "right", "top", "left"]
[material]
young = <20 P>
poisson = 0.3
[sides.floor]
contact = { gap = "<0.1 /L>*x*x", friction = { coulomb = "0.3" } }
[sides.left]
springs = "<1 P/L>"
[sides.top]
traction = ["<0.5 P>", "<-1 P>"]
[probe]
points = [[<1 L>, <0.5 L>]]
lines = [{ from = [<0.5 L>, 0], to = [<1.5 L>, <1 L>], points = 3 }]
sides = ["top"]
[quantities]
press = { pressure_at = [<0.4 L>, 0] }
sinks = { mean_displacement = "top" }
turns = { moment = "floor", about = [0, 0] }
works = { weighted_force = "floor", weight = [0, 2] }
opens = { opening_at = [<1.9 L>, 0] }
[method]
max_steps = 3
estimators = true
multiplier = "stabilised"
"#,
    r#"[material]
young = <1 P>
poisson = 0.3
[[body]]
name = "lower"
corners = [[0, 0], [<1 L>, 0], [<1 L>, <1 L>], [0, <1 L>]]
sides = ["bottom", "right", "top", "left"]
[[body]]
name = "upper"
corners = [[0, <1 L>], [<1 L>, <1.1 L>], [<1 L>, <2 L>], [0, <2 L>]]
sides = ["bottom", "right", "top", "left"]
[[body]]
name = "beside"
corners = [[<1.1 L>, 0], [<2 L>, 0], [<2 L>, <1 L>], [<1.1 L>, <1 L>]]
sides = ["bottom", "right", "top", "left"]
[sides.lower.bottom]
displacement = ["0", "0"]
[sides.upper.top]
displacement = ["<0.3 L>", "<-0.2 L>"]
[sides.beside.right]
displacement = ["<-0.3 L>", "0"]
[[interface]]
between = ["lower.top", "upper.bottom"]
contact = { friction = { tresca = "<0.02 P>" } }
[method]
refine = "none"
elements = 24
"#,
    r#"[body]
corners = [[0, 0], [<2 L>, 0], [<2 L>, <1 L>], [0, <1 L>]]
sides = ["floor", "right", "top", "left"]
[material]
young = <20 P>
poisson = 0.3
[random.rise]
distribution = "uniform"
low = -1
high = 1
[sides.floor]
contact = { gap = "<0.02 L>*rise", friction = { tresca = "<0.1 P>" } }
[sides.top]
displacement = ["0", "<-0.1 /L>*x*x"]
[probe]
points = [[<1 L>, <0.5 L>]]
[method]
refine = "none"
elements = 8
estimators = true
[stochastic]
quantities = ["energy", "contact.length", "contact.force.y", "contact.max_pressure", "probe.0.stress.yy", "reactions.top.y"]
"#,
    r#"[body]
corners = [[0, 0], [<1 L>, 0], [<1 L>, <1 L>], [0, <1 L>]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
[material.cells]
size = <0.125 L>
young = "<1 P> + <1 P/L>*x"
[exterior]
young = <1 P>
poisson = 0.3
traction_jump = ["<1 P>", "<0.5 P/L>*x"]
displacement_jump = ["<0.1 /L>*x*x", "0"]
[body_force]
value = ["<1 P/L>", "<2 P/LL>*y"]
[grid]
coarse = [2, 2]
fine = [4, 4]
[method]
model = "msfem-bem"
max_steps = 2
estimators = true
"#,
    r#"[body]
circle = { centre = [0, 0], radius = <2 L> }
side = "outside"
[[body.holes]]
circle = { centre = [<0.3 L>, <0.1 L>], radius = <0.8 L> }
side = "inside"
[material]
young = <20 P>
poisson = 0.3
[sides.inside]
pressure = "<1 P>"
[probe]
points = [[<-1 L>, 0]]
[method]
max_steps = 3
"#,
];

/// A scene with these factors in its places.
fn in_units(scene: &str, length: f64, stress: f64) -> String {
    let mut pieces = scene.split('<');
    let first = pieces.next().unwrap().to_owned();
    pieces.fold(first, |text, piece| {
        let (number, rest) = piece.split_once('>').unwrap();
        let (number, unit) = number.split_once(' ').unwrap();
        let factor = match unit {
            "L" => length,
            "P" => stress,
            "P/L" => stress / length,
            "P/LL" => stress / (length * length),
            "/L" => 1.0 / length,
            other => panic!("{other} is no unit"),
        };
        text + &format!("{:?}", number.parse::<f64>().unwrap() * factor) + rest
    })
}

/// The powers of length and stress in a unit; none of what no scale changes in a known way.
fn powers(table: &Table, unit: &str, path: &[&str]) -> Option<[f64; 2]> {
    let of_quantity = || {
        let mut keys: Vec<&str> = path[1..path.len() - 1].to_vec();
        keys.pop_if(|key| ["x", "y", "xx", "yy", "xy"].contains(key));
        keys.iter_mut().filter(|key| key.parse::<usize>().is_ok()).for_each(|key| *key = "N");
        powers(table, table.rows[table.row(&keys).unwrap()].unit, &[])
    };
    Some(match unit {
        "1" | "radian" => [0.0, 0.0],
        "length" => [1.0, 0.0],
        "stress" => [0.0, 1.0],
        "1/stress" => [0.0, -1.0],
        "stress × length" => [1.0, 1.0],
        "stress × length²" => [2.0, 1.0],
        "(stress × length²)^½" => [1.0, 0.5],
        "of the quantity" => of_quantity()?,
        "square of the quantity" => of_quantity()?.map(|power| 2.0 * power),
        _ => return None,
    })
}

/// The pairs of numbers of two objects with their paths.
fn pairs<'a>(path: &[&'a str], [a, b]: [&'a Value; 2], found: &mut Vec<(Vec<&'a str>, [f64; 2])>) {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{path:?}");
            a.iter().for_each(|(key, value)| pairs(&[path, &[key]].concat(), [value, &b[key]], found));
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path:?}");
            let of_items = |items: &[Value]| items.iter().any(Value::is_object);
            let path = if of_items(a) { [path, &["N"]].concat() } else { path.to_vec() };
            a.iter().zip(b).for_each(|(a, b)| pairs(&path, [a, b], found));
        }
        _ => found.extend(a.as_f64().zip(b.as_f64()).map(|(a, b)| (path.to_vec(), [a, b]))),
    }
}

/// Rows with a unit of length or stress of which these scenes have no number.
const NOT_COMPARED: [&str; 7] = [
    "estimators.NAME.parts.volume_mean",
    "estimators.NAME.parts.volume_oscillation",
    "estimators.NAME.parts.volume",
    "estimators.NAME.parts.jump",
    "contact.ends",
    "interfaces.N.ends",
    "exterior.constant",
];

/// A scene in units 2 times as small for lengths and 16 times for stresses has numbers larger by what their units say.
#[test]
fn numbers_follow_the_units_of_the_page() {
    let (place, table) = (Place::new(), Table::new(parts_of_page()[0]));
    let mut compared = BTreeSet::new();
    for scene in IN_UNITS {
        let objects = [[1.0, 1.0], [2.0, 16.0]].map(|[length, stress]| {
            place.write("scene.toml", in_units(scene, length, stress));
            let ran = place.run(["solve", "scene.toml", "--quiet", "--json", "--force"]);
            assert!(ran.status == 0 || ran.status == 3, "{}", ran.err);
            ran.json()
        });
        let mut found = Vec::new();
        pairs(&[], [&objects[0], &objects[1]], &mut found);
        for (path, [a, b]) in found {
            let row = &table.rows[table.row(&path).unwrap()];
            let Some([length, stress]) = powers(&table, row.unit, &path) else { continue };
            let scaled = a * 2f64.powf(length) * 16f64.powf(stress);
            // rounding errors do not scale
            if a.abs() > 1e-7 && row.kind != "count" {
                assert!((b - scaled).abs() <= 1e-5 * scaled.abs(), "{} is {a} and {b}, not {scaled}", path.join("."));
                compared.insert(row.keys.join("."));
            }
        }
    }
    let is_measured = |row: &&Row| row.unit.contains("length") || row.unit.contains("stress");
    let left =
        table.rows.iter().filter(is_measured).map(|row| row.keys.join(".")).filter(|row| !compared.contains(row));
    assert_eq!(Vec::from_iter(left), NOT_COMPARED);
}

//! What a message says to do can be done, and helps.

use crate::place::{BLOCK, Place};

/// A pin in a hole of a plate; PIN stands for its radius, MEETS for the interface.
const PIN: &str = r#"title = "Pin"
[[body]]
name = "pin"
circle = { centre = [0, 0], radius = PIN }
side = "rim"
[[body]]
name = "plate"
corners = [[-50, -50], [50, -50], [50, 50], [-50, 50]]
sides = ["bottom", "right", "top", "left"]
[[body.holes]]
circle = { centre = [0, 0], radius = 20 }
side = "eye"
[material]
young = 1000.0
poisson = 0.3
[sides.plate.bottom]
displacement = ["0", "0"]
[[interface]]
MEETS
[method]
refine = "none"
"#;

fn pin(radius: &str, meets: &str) -> String {
    PIN.replace("PIN", radius).replace("MEETS", meets)
}

/// What is said on stderr of `plan` with these overrides; the status is 1.
fn refused(place: &Place, scene: &str, overrides: &[&str]) -> String {
    place.write("scene.toml", scene);
    let overrides = overrides.iter().flat_map(|set| ["--set", set]);
    place.run(["plan", "scene.toml"].into_iter().chain(overrides)).demand(1).err
}

#[test]
fn an_overlap_is_told_as_an_interference() {
    let place = Place::new();
    let meets = "between = [\"pin.rim\", \"plate.eye\"]\n";
    for law in ["contact = {}", "tied = true"] {
        let err = refused(&place, &pin("20.002", &format!("{meets}{law}")), &[]);
        assert!(err.contains("lies 0.002 deep in body \"plate\"") && err.contains("gap = \"-0.002\""), "{err}");
        assert!(!err.contains("move the bodies together"), "{err}");
    }
    // as it says: the fit presses all around
    place.write("fit.toml", pin("20", &format!("{meets}contact = {{ gap = \"-0.002\" }}")));
    let o = place.json(0, &["fit.toml"]);
    let length = o["contact"]["length"].as_f64().unwrap();
    assert!((length / (40.0 * std::f64::consts::PI) - 1.0).abs() < 1e-6, "{length}");
}

/// A roller beside a flat side that a cylinder faces: the direction of contact at its corner is oblique.
#[test]
fn a_corner_that_a_roller_holds_is_left_to_the_other_body() {
    let place = Place::new();
    let scene = r#"[[body]]
name = "cylinder"
corners = [[-1, 1], [1, 1]]
sides = ["belly", "top"]
arcs = { belly = { through = [0, 0] } }
material = { young = 3000.0, poisson = 0.2 }
[[body]]
name = "block"
corners = [[-2, -2], [2, -2], [2, 0], [-2, 0]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1000.0
poisson = 0.3
[sides.cylinder.top]
traction = ["0", "-8"]
[sides.block.bottom]
displacement = ["0.01", "0"]
[sides.block.right]
displacement = ["0.01", "free"]
[[interface]]
between = ["cylinder.belly", "block.top"]
contact = { friction = { coulomb = "0.6" } }
[method]
tolerance = 0.3
"#;
    place.write("scene.toml", scene);
    let err = place.run(["solve", "scene.toml"]).demand(1).err;
    let told = err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("the point (2, 0) is held in x or y alone") && told.contains("[[interface]]"), "{err}");
    assert!(told.contains("name its side as `multiplier` of the interface"), "{err}");
    place.write("other.toml", scene.replace("contact =", "multiplier = \"cylinder.belly\"\ncontact ="));
    let o = place.json(0, &["other.toml"]);
    assert!((o["interfaces"][0]["force"][1].as_f64().unwrap() - 16.0).abs() < 1e-6, "{}", o["interfaces"]);
}

#[test]
fn sides_that_are_not_there_are_answered_by_those_of_their_body() {
    let place = Place::new();
    let err = refused(&place, &pin("19.9", "between = [\"pin.rim\"]\ncontact = {}"), &[]);
    assert!(err.contains("has 1 entry\n") && err.contains("it takes two, one for each of the two bodies"), "{err}");
    assert!(!err.contains("one for x"), "{err}");
    for (name, remedy) in [
        ("plate.hole", "the sides of plate are bottom, right, top, left, eye"),
        ("plate.eys", "did you mean plate.eye?"),
        ("plat.eye", "did you mean plate.eye?"),
    ] {
        let err = refused(&place, &pin("19.9", &format!("between = [\"pin.rim\", \"{name}\"]\ncontact = {{}}")), &[]);
        assert!(err.contains(remedy), "{err}");
    }
}

#[test]
fn keys_of_bodies_in_a_list_have_its_numbers() {
    let place = Place::new();
    let scene = pin("19.9", "between = [\"pin.rim\", \"plate.eye\"]\ncontact = {}");
    let err = refused(&place, &scene, &["fillet.3=6"]);
    assert!(err.contains("did you mean body.0.fillet?"), "{err}");
    let err = refused(&place, &scene, &["body.plate.fillet.3=6"]);
    assert!(err.contains("did you mean body.1?"), "{err}");
    place.write("scene.toml", &scene);
    place.run(["plan", "scene.toml", "--set", "body.1.fillet.3=6"]).demand(0);
    // of one body it stays as it was
    assert!(refused(&place, BLOCK, &["fillet.3=0.1"]).contains("did you mean body.fillet?"));
}

#[test]
fn keys_of_other_programs_are_answered_by_what_to_write() {
    let place = Place::new();
    for (key, remedy) in [
        ("thickness", "everything is per unit thickness"),
        ("material.thickness", "everything is per unit thickness"),
        ("density", "[body_force] value = "),
        ("material.rho", "[body_force] value = "),
        ("force", "[sides.NAME] traction = "),
        ("sides.top.Force", "[sides.NAME] traction = "),
        ("sides.top.moment", "a traction that varies along its side"),
        ("sides.top.fixed", "displacement = [\"0\", \"0\"]"),
        ("material.E", "write young = "),
        ("material.nu", "write poisson = "),
        ("mesh", "method.elements"),
    ] {
        let err = refused(&place, BLOCK, &[&format!("{key}=1")]);
        assert!(err.contains(&format!("unknown key {key}")) && err.contains(remedy), "{err}");
    }
    // a name of the scene's own comes first
    assert!(refused(&place, &BLOCK.replace("F", "force"), &["force=1"]).contains("did you mean parameters.force?"));
}

/// A ring in a medium, as one body that a medium surrounds.
const RING: &str = r#"
[body]
circle = { centre = [0, 0], radius = 2 }
side = "rim"
[[body.holes]]
circle = { centre = [0, 0], radius = 1 }
side = "bore"
[material]
young = 1000.0
poisson = 0.3
[exterior]
young = 50.0
poisson = 0.3
[sides.bore]
pressure = 1
"#;
/// The same as two bodies.
const TWO_BODIES: &str = r#"
[[body]]
name = "ring"
circle = { centre = [0, 0], radius = 2 }
side = "rim"
material = { young = 1000.0, poisson = 0.3 }
[[body.holes]]
circle = { centre = [0, 0], radius = 1 }
side = "bore"
[[body]]
name = "rock"
medium = {}
material = { young = 50.0, poisson = 0.3 }
[[body.holes]]
circle = { centre = [0, 0], radius = 2 }
side = "wall"
[sides.ring.bore]
pressure = 1
[[interface]]
between = ["ring.rim", "rock.wall"]
tied = true
"#;

/// Lamé: the ring under p inside and q outside has the displacement of the hole under q where they meet.
#[test]
fn a_ring_in_a_medium_is_two_bodies() {
    let place = Place::new();
    let err = refused(&place, RING, &["exterior.stress_jump=[1, 0, 0]"]);
    assert!(
        err.contains("write exterior.stress_jump as exterior.traction_jump") && !err.contains("add [grid]"),
        "{err}"
    );
    place.write("two.toml", TWO_BODIES);
    place.write("one.toml", RING);
    let sharp = ["--set", "method.tolerance=1e-6"];
    let two = place.json(0, &[&["two.toml"][..], &sharp].concat());
    let grid = ["--set", "grid.coarse=[4, 4]", "--set", "grid.fine=[4, 4]"];
    for more in [&[][..], &grid, &["--set", "method.model=\"bem\""]] {
        let one = place.json(0, &[&["one.toml"][..], &sharp, more].concat());
        assert_eq!((&one["energy"], &one["model"]), (&two["energy"], &two["model"]), "{more:?}");
    }
    let o = two;
    let (young, rock, nu) = (1000.0, 50.0, 0.3_f64);
    // u(r) = (1+ν)/E ((1-2ν) A r + B/r), σ_rr = A - B/r², of the medium u(b) = (1+ν)/E q b
    let of_ring = |q: f64| [(1.0 - 4.0 * q) / 3.0, (1.0 - q) * 4.0 / 3.0];
    let at = |q: f64, r: f64| {
        let [a, b] = of_ring(q);
        (1.0 + nu) / young * ((1.0 - 2.0 * nu) * a * r + b / r)
    };
    let apart = |q: f64| at(q, 2.0) - (1.0 + nu) / rock * q * 2.0;
    let q = apart(0.0) / (apart(0.0) - apart(1.0));
    let energy = -std::f64::consts::PI * at(q, 1.0); // half of the work of p
    let found = o["energy"].as_f64().unwrap();
    assert!((found / energy - 1.0).abs() < 1e-9, "{found} {energy}");
}

/// Boxes that no grid fits are not told to add one, nor to leave out what they need.
#[test]
fn outlines_that_no_grid_fits_are_not_told_to_take_one() {
    let place = Place::new();
    let oblique = BLOCK.replace("[2.0, 1.0]", "[2.0, 1.1]");
    let cells = oblique.replace("young = 200.0", "cells = { size = 0.25, young = \"1 + x\" }");
    for grid in [&[][..], &["grid.coarse=[4, 2]", "grid.fine=[2, 2]"]] {
        let err = refused(&place, &cells, grid);
        assert!(err.contains("give one Young's modulus, material.young") && !err.contains("add [grid]"), "{err}");
    }
    let err = refused(&place, &oblique, &["method.model=\"fem\""]);
    assert!(err.contains("leave method.model at \"auto\"") && !err.contains("add [grid]"), "{err}");
    let err = refused(&place, BLOCK, &["method.model=\"fem\""]);
    assert!(err.contains("add [grid] coarse = "), "{err}");
}

/// The limit of unknowns that the warning names is the least with which the other model is taken.
#[test]
fn the_model_that_a_warning_names_is_not_refused() {
    let place = Place::new();
    let text = include_str!("../../../scenes/36-stiff-inclusions.toml");
    let scene = "inclusions.toml";
    place.write(scene, text.split("[expect]").next().unwrap()); // what it expects is of other places of the inclusions
    let shift = ["--force", "--set", "parameters.shift=0.125"];
    let ran = place.run(["solve", scene].iter().chain(&shift));
    let limit = ran.out.split("use model = \"fem\" with method.max_dofs = ").nth(1).expect(&ran.out);
    let limit: usize = limit.split_whitespace().next().unwrap().parse().unwrap();
    let fem = |limit: usize| {
        let set =
            ["method.model=\"fem\"", "method.refine=\"none\"", &format!("method.max_dofs={limit}")].map(str::to_owned);
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        place.run(["solve", scene].iter().chain(&shift).chain(&set)).status
    };
    assert_eq!([fem(limit), fem(limit - 1)], [0, 1]);
}

#[test]
fn a_folder_that_is_not_there_is_named_and_no_other_file() {
    let place = Place::new();
    for (out, what) in [
        ("nodir/a.vtkhdf", "nodir of the result file does not exist: create it"),
        ("block.toml/a.vtkhdf", "is no folder"),
    ] {
        let err = place.run(["solve", "block.toml", "--out", out]).demand(1).err;
        assert!(err.contains(what) && !err.contains(".part"), "{err}");
    }
    std::fs::create_dir(place.path("nodir")).unwrap();
    place.run(["solve", "block.toml", "--out", "nodir/a.vtkhdf"]).demand(0);
}

#[test]
fn letters_of_options_are_answered_by_the_option() {
    let place = Place::new();
    for (letter, long) in [("-o", "--out"), ("-j", "--threads"), ("-f", "--force"), ("-q", "--quiet"), ("-s", "--set")]
    {
        let err = place.run(["solve", "block.toml", letter, "x"]).demand(2).err;
        assert!(err.contains(&format!("'{long}'")) && !err.contains("as a value"), "{err}");
    }
    assert!(place.run(["solve", "block.toml", "-z"]).demand(2).err.contains("unexpected argument '-z'"));
}

#[test]
fn files_of_other_kinds_are_told_to_be_them() {
    let place = Place::new();
    place.run(["solve", "block.toml"]).demand(0);
    for (name, text, what) in [
        ("a.svg", &b"<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>"[..], "a drawing (SVG)"),
        ("a.dxf", b"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", "a drawing (DXF)"),
        ("b.dxf", b"AutoCAD Binary DXF\r\n\x1a\0", "a drawing (DXF)"),
        ("a.dwg", b"AC1032\0\0\0\xff", "a drawing (DWG)"),
        ("a.step", b"ISO-10303-21;\nHEADER;", "a drawing (STEP)"),
        ("a.png", b"\x89PNG\r\n\x1a\n", "a picture (PNG or JPEG)"),
        ("block.vtkhdf", b"", "an HDF5 file"),
    ] {
        if !text.is_empty() {
            place.write(name, text);
        }
        for command in ["solve", "plan"] {
            let err = place.run([command, name]).demand(1).err;
            assert!(err.contains(&format!("{name}: it is {what}, not a scene")), "{err}");
        }
    }
    // words of drawings do not make one
    place.write("named.toml", BLOCK.replace("A block", "<svg> SECTION"));
    place.run(["plan", "named.toml"]).demand(0);
}

//! A scene that cannot be solved, through the command: status 1, nothing on stdout, file, line, text and remedy on
//! stderr, and an existing result untouched.

use crate::broken::cases;
use crate::place::{BLOCK, Place};

/// Solves with --force onto an old result, which must stay as it is; gives stderr.
fn refused(place: &Place, arguments: &[&str]) -> String {
    let modified = || std::fs::metadata(place.path("old.vtkhdf")).unwrap().modified().unwrap();
    place.write("old.vtkhdf", "an old result");
    let before = (modified(), place.names());
    let ran = place.run(["solve", "--json", "--force", "--out", "old.vtkhdf"].iter().chain(arguments)).demand(1);
    assert_eq!(place.read("old.vtkhdf"), b"an old result");
    assert_eq!((modified(), place.names()), before);
    ran.err
}

/// Every part, also where the message is broken into lines: white space and the frame are left out.
fn missing<'a>(message: &str, parts: &[&'a str]) -> Vec<&'a str> {
    let squeeze = |text: &str| text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect::<String>();
    let message = squeeze(message);
    parts.iter().copied().filter(|part| !message.contains(&squeeze(part))).collect()
}

#[test]
fn every_mistake_of_the_table_is_told_by_the_command() {
    let place = Place::new();
    let mut wrong = String::new();
    for case in cases() {
        let text = case.scene();
        place.write("broken.toml", &text);
        let arguments: Vec<&str> =
            ["broken.toml"].into_iter().chain(case.set.iter().flat_map(|s| ["--set", s])).collect();
        let message = refused(&place, &arguments);
        let file = format!("{}:{}:", if case.set.is_empty() { "broken.toml" } else { "--set" }, case.line);
        let line = if case.set.is_empty() { text.lines().nth(case.line - 1) } else { case.set.last().copied() };
        let lost = missing(&message, &[&file, line.unwrap_or(""), case.offending, case.message, case.remedy, "help:"]);
        if !lost.is_empty() {
            wrong += &format!("{:?} {:?}: no {lost:?} in\n{message}\n", case.edit.1, case.set);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// Mistakes that only solving finds: edits of the sound scene, line, and parts of the message and of the remedy.
struct Hidden {
    edits: &'static [(&'static str, &'static str)],
    line: usize,
    parts: &'static [&'static str],
}

const CONTACT: &str = "contact = { gap = \"0\", friction = { tresca = \"F\" } }";
const LOAD: &str = "traction = [\"0\", \"-1\"]";

const HIDDEN: &[Hidden] = &[
    // Nothing holds the body
    Hidden {
        edits: &[(CONTACT, "")],
        line: 13,
        parts: &["nothing holds the body", "translation along (0, 1)", "2.000e0", "[\"0\", \"-1\"]", "hold a side"],
    },
    Hidden {
        edits: &[(CONTACT, ""), (LOAD, "traction = [0, \"1-2*s\"]")],
        line: 13,
        parts: &["nothing holds the body", "rotation about (1, 0.5)", "\"1-2*s\"", "force and moment vanish"],
    },
    Hidden {
        edits: &[(CONTACT, "displacement = [0, \"free\"]"), (LOAD, "pressure = 2")],
        line: 13,
        parts: &["nothing holds the body against translation along (0, 1)", "4.000e0", "hold a side"],
    },
    Hidden {
        edits: &[(CONTACT, ""), (LOAD, "traction = [0, 0]"), ("[probe]", "[body_force]\nvalue = [0, -1]\n[probe]")],
        line: 15,
        parts: &["nothing holds the body", "[0, -1]", "hold a side"],
    },
    // Contact and friction do not do
    Hidden {
        edits: &[(LOAD, "traction = [0, 1]")],
        line: 13,
        parts: &["nothing holds the body", "[0, 1]", "press the body on its obstacle"],
    },
    Hidden {
        edits: &[(LOAD, "traction = [3, -1]")],
        line: 11,
        parts: &[
            "translation along (1, 0)",
            "work 6.000e0",
            "friction resists with 6.000e-1",
            "raise the friction bound",
        ],
    },
    Hidden {
        edits: &[(CONTACT, "contact = { gap = \"0\" }"), (LOAD, "traction = [\"1e-6\", -1]")],
        line: 13,
        parts: &["nothing holds the body", "translation along (1, 0)", "[\"1e-6\", -1]", "hold a side"],
    },
    Hidden {
        edits: &[("elements = 8", "elements = 8\nsolver = \"uzawa\"")],
        line: 19,
        parts: &["positive definite", "\"uzawa\"", "set solver = \"newton\""],
    },
    // Held sides that do not agree at their corner
    Hidden {
        edits: &[(LOAD, "displacement = [\"1e-3\", 0]\n[sides.left]\ndisplacement = [0, 0]")],
        line: 15,
        parts: &["\"top\" and \"left\"", "(0, 1)", "x = 0.001 and 0", "the same value at their common point"],
    },
    Hidden {
        edits: &[(LOAD, "displacement = [\"free\", \"x\"]\n[sides.right]\ndisplacement = [\"free\", \"y\"]")],
        line: 13,
        parts: &["\"right\" and \"top\"", "(2, 1)", "y = 1 and 2", "\"x\"", "\"free\""],
    },
    // Data that only quadrature sees
    Hidden {
        edits: &[(LOAD, "traction = [\"x\", \"1/(x-0.3)\"]")],
        line: 13,
        parts: &["traction on side \"top\" cannot be integrated", "\"1/(x-0.3)\"", "keep the values bounded"],
    },
    Hidden {
        edits: &[(CONTACT, "contact = { gap = \"1/(x-0.3712)^2\" }")],
        line: 11,
        parts: &["gap on side \"floor\" cannot be integrated", "\"1/(x-0.3712)^2\"", "keep the values bounded"],
    },
    Hidden {
        edits: &[(LOAD, "displacement = [\"1/(x-0.3)\", 0]")],
        line: 13,
        parts: &["displacement on side \"top\" cannot be integrated", "\"1/(x-0.3)\"", "keep the values bounded"],
    },
    // Numbers at the end of the range
    Hidden {
        edits: &[(CONTACT, "displacement = [0, 0]"), (LOAD, "traction = [0, -1e300]")],
        line: 13,
        parts: &["range of floating point", "[0, -1e300]", "choose units"],
    },
    Hidden {
        edits: &[(CONTACT, "contact = { gap = \"-0.1*s\" }"), (LOAD, "displacement = [0, 0]"), ("200.0", "1e200")],
        line: 10,
        parts: &["range of floating point", "estimated error", "choose units"],
    },
    Hidden {
        edits: &[
            (CONTACT, "contact = { gap = \"-0.1*s\" }"),
            (LOAD, "displacement = [0, 0]"),
            ("200.0", "1e-200"),
            ("elements = 8", "multiplier = \"stabilised\""),
        ],
        line: 6,
        parts: &["entries are probably too large or too small", "1e-200", "choose units"],
    },
    Hidden {
        edits: &[("elements = 8", "multiplier = \"stabilised\"\ngamma = 1e-12")],
        line: 19,
        parts: &["1.000000e-12", "a number from", "to below"],
    },
    Hidden {
        edits: &[("poisson = 0.3", "poisson = 0.4999999999999999")],
        line: 7,
        parts: &["not positive definite", "0.4999999999999999", "a smaller ratio"],
    },
    // Meshes
    Hidden {
        edits: &[("elements = 8", "max_dofs = 31")],
        line: 18,
        parts: &["the first mesh has 32 dofs", "max_dofs = 31", "fewer elements or a lower degree"],
    },
];

#[test]
fn mistakes_that_only_solving_finds_are_told_as_well() {
    let place = Place::new();
    let mut wrong = String::new();
    for case in HIDDEN {
        let mut text = BLOCK.to_owned();
        for (from, to) in case.edits {
            assert_eq!(text.matches(from).count(), 1, "{from:?}");
            text = text.replace(from, to);
        }
        place.write("broken.toml", &text);
        let message = refused(&place, &["broken.toml"]);
        let file = format!("broken.toml:{}:", case.line);
        let line = text.lines().nth(case.line - 1).unwrap();
        let lost = missing(&message, &[&[&file, line, "help:"], case.parts].concat());
        if !lost.is_empty() {
            wrong += &format!("{:?}: no {lost:?} in\n{message}\n", case.edits);
        }
        // The plan is made of the scene alone: it does not fail for what only solving finds.
        let planned = place.run(["plan", "broken.toml"]);
        assert!(planned.status == 0, "{}", planned.err);
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The two sides of a claim: what just holds is solved, what just does not is refused.
#[test]
fn the_edge_of_what_holds_the_body() {
    let place = Place::new();
    // A load along x against friction F on a length of 2: it holds below a traction of F.
    for (traction, status) in [("0.29", 0), ("0.31", 1)] {
        let set = format!("sides.top.traction=[\"{traction}\", -1]");
        place.run(["solve", "block.toml", "--force", "--set", &set]).demand(status);
    }
    // A pressure q on the right side has the moment q/2 about (0, 0), the load on the top 2: the block tips beyond q = 4.
    for (pressure, status) in [("3.9", 0), ("4.1", 1)] {
        let friction = "sides.floor.contact.friction.tresca=10";
        let set = format!("sides.right.pressure={pressure}");
        place.run(["solve", "block.toml", "--force", "--set", friction, "--set", &set]).demand(status);
    }
    // dofs: as many as allowed, and one less
    for (limit, status) in [("16", 0), ("15", 1)] {
        place.run(["solve", "block.toml", "--force", "--set", &format!("method.max_dofs={limit}")]).demand(status);
    }
}

#[test]
fn scenes_that_cannot_be_read_are_named() {
    let place = Place::new();
    for scene in ["none.toml", ".", "block.toml/x"] {
        let message = refused(&place, &[scene]);
        assert!(missing(&message, &["cannot read the scene", scene, "steklov new"]).is_empty(), "{message}");
        assert_eq!(place.run(["plan", scene]).demand(1).err, message);
    }
}

//! What pictures show, as the command line asks.

mod place;

use place::Place;

/// A column of cells that is pulled to the right.
const STRIP: &str = r#"title = "A strip"
[body]
corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]
sides = ["below", "right", "above", "left"]
[material]
young = 100
poisson = 0.3
[sides.left]
displacement = [0, 0]
[sides.right]
traction = [3, 0]
[grid]
coarse = [4, 2]
fine = [4, 3]
[method]
model = "msfem"
refine = "none"
"#;

/// A solved block and a solved strip on a grid, `block.vtkhdf` and `strip.vtkhdf`.
fn solved() -> Place {
    let place = Place::new();
    place.write("strip.toml", STRIP);
    for name in ["block", "strip"] {
        place.run(["solve", &format!("{name}.toml"), "--quiet", "--plots", "default"]);
    }
    place
}

/// The SVG of a part of a result that `show` draws with these options into a new folder.
fn shown(place: &Place, result: &str, part: &str, options: &[&str]) -> String {
    let folder = options.concat().replace(|c: char| !c.is_alphanumeric(), "_") + "_";
    let file = format!("{result}.vtkhdf");
    place.run(["show", &file, "--plots", &folder].iter().chain(options)).demand(0);
    String::from_utf8(place.read(&format!("{folder}/{result}-{part}.svg"))).unwrap()
}

/// The texts of an SVG.
fn texts(svg: &str) -> Vec<&str> {
    svg.split("</text>").filter_map(|part| Some(part.rsplit_once('>')?.1)).collect()
}

#[test]
fn a_range_clips_the_colours_of_body_and_cells() {
    let place = solved();
    for (result, part) in [("block", "body"), ("strip", "body"), ("strip", "stress")] {
        let free = shown(&place, result, part, &[]);
        let svg = shown(&place, result, part, &["--range", "0.3:0.4"]);
        for tick in ["0.30", "0.40"] {
            assert!(texts(&svg).contains(&tick) && !texts(&free).contains(&tick), "{result} {part} {tick}");
        }
    }
    let body = shown(&place, "block", "body", &["--range", "0.3:0.4"]);
    assert!(body.contains(">colours end below the largest stress that is drawn, "), "{body}");
    // solve draws what show draws, and without options what it drew before
    place.run(["solve", "block.toml", "--quiet", "--force", "--plots", "solved", "--range", "0.3:0.4"]).demand(0);
    assert!(place.read("solved/block-body.svg") == body.as_bytes());
    assert!(place.read("default/block-body.svg") == shown(&place, "block", "body", &[]).as_bytes());
    // contact charts have no colours
    let chart = place.read("default/block-contact-floor.svg");
    assert!(place.read("solved/block-contact-floor.svg") == chart);
}

#[test]
fn views_that_make_no_sense_are_refused_with_a_remedy() {
    let place = solved();
    let refused = |options: &[&str], told: &str| {
        for command in [&["solve", "block.toml", "--force"][..], &["show", "block.vtkhdf"]] {
            let ran = place.run(command.iter().chain(&["--plots", "refused"]).chain(options)).demand(2);
            assert!(ran.err.contains(options[0]) && ran.err.contains(told), "{options:?}: {}", ran.err);
        }
    };
    refused(&["--range", "2:1"], "the smaller number stands first: 1:2");
    refused(&["--range", "1:1"], "nothing between two equal numbers");
    refused(&["--range", "one:2"], "\"one\" is no number");
    refused(&["--range", "0:inf"], "\"inf\" is no number");
    refused(&["--range", "-3"], "two numbers with a colon between them");
    for options in [["--range", "-2:1"]] {
        for command in [&["solve", "block.toml", "--force"][..], &["show", "block.vtkhdf"]] {
            let ran = place.run(command.iter().chain(&options)).demand(1);
            assert!(ran.err.contains(options[0]) && ran.err.contains("add --plots DIR"), "{}", ran.err);
        }
    }
    assert!(!place.path("refused").exists());
}

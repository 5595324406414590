//! What pictures show, as the command line asks.

use std::sync::LazyLock;

use crate::place::Place;

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

/// What `solved` has beside the scenes.
const SOLVED: [&str; 4] = ["block.vtkhdf", "strip.vtkhdf", "default/block-body.svg", "default/block-contact-floor.svg"];

/// A solved block and a solved strip on a grid, `block.vtkhdf` and `strip.vtkhdf`, and pictures of the block. They are solved once.
fn solved() -> Place {
    static FILES: LazyLock<[Vec<u8>; 4]> = LazyLock::new(|| {
        let place = Place::new();
        place.write("strip.toml", STRIP);
        place.run(["solve", "block.toml", "--quiet", "--plots", "default"]);
        place.run(["solve", "strip.toml", "--quiet"]);
        SOLVED.map(|name| place.read(name))
    });
    let place = Place::new();
    place.write("strip.toml", STRIP);
    std::fs::create_dir(place.path("default")).unwrap();
    SOLVED.iter().zip(&*FILES).for_each(|(name, bytes)| place.write(name, bytes));
    place
}

/// The SVG of a part of a result that `show` draws with these options; all parts are drawn at once, into a folder of these options.
fn shown(place: &Place, result: &str, part: &str, options: &[&str]) -> String {
    let folder = options.concat().replace(|c: char| !c.is_alphanumeric(), "_") + "_";
    let (file, svg) = (format!("{result}.vtkhdf"), format!("{folder}/{result}-{part}.svg"));
    if !place.path(&svg).exists() {
        place.run(["show", &file, "--plots", &folder].iter().chain(options)).demand(0);
    }
    String::from_utf8(place.read(&svg)).unwrap()
}

/// The texts of an SVG.
fn texts(svg: &str) -> Vec<&str> {
    svg.split("</text>").filter_map(|part| Some(part.rsplit_once('>')?.1)).collect()
}

/// The ticks whose labels are anchored so: "start" those of the colours, "middle" of x, "end" of y.
fn ticks(svg: &str, anchor: &str) -> Vec<f64> {
    let anchored = svg.lines().filter(|line| line.contains("<text") && line.contains(&format!("\"{anchor}\"")));
    let texts = anchored.filter_map(|line| line.split('>').nth(1)?.split('<').next());
    texts.filter_map(|text| text.replace('−', "-").parse().ok()).collect()
}

#[test]
fn a_range_clips_the_colours_of_body_and_cells() {
    let place = solved();
    for (result, part) in [("block", "body"), ("strip", "body"), ("strip", "stress")] {
        let free = shown(&place, result, part, &[]);
        let svg = shown(&place, result, part, &["--range", "0.3:0.4"]);
        for tick in [0.3, 0.4] {
            assert!(ticks(&svg, "start").contains(&tick), "{result} {part} {tick}");
        }
        assert!(ticks(&free, "start").iter().any(|tick| !(0.3..=0.4).contains(tick)), "{result} {part}");
        assert!(ticks(&svg, "start").iter().all(|tick| (0.3..=0.4).contains(tick)), "{result} {part}");
    }
    let body = shown(&place, "block", "body", &["--range", "0.3:0.4"]);
    // the shear of the floor does not go on around its corners
    assert!(body.contains(">the stress is infinite at (0, 0) and at (2, 0)<"), "{body}");
    // solve draws what show draws, and without options what it drew before
    place.run(["solve", "block.toml", "--quiet", "--force", "--plots", "solved", "--range", "0.3:0.4"]).demand(0);
    assert!(place.read("solved/block-body.svg") == body.as_bytes());
    assert!(place.read("default/block-body.svg") == shown(&place, "block", "body", &[]).as_bytes());
    // contact charts have no colours
    let chart = place.read("default/block-contact-floor.svg");
    assert!(place.read("solved/block-contact-floor.svg") == chart);
}

#[test]
fn a_field_colours_body_and_cells() {
    let place = solved();
    for (result, part) in [("block", "body"), ("strip", "body"), ("strip", "stress")] {
        let von_mises = shown(&place, result, part, &[]);
        assert!(von_mises == shown(&place, result, part, &["--field", "von-mises"]));
        let mut seen = vec![von_mises];
        for (name, label) in [
            ("xx", "stress σxx"),
            ("yy", "stress σyy"),
            ("xy", "stress σxy"),
            ("principal-1", "larger principal stress σ₁"),
            ("principal-2", "smaller principal stress σ₂"),
            ("u-x", "displacement ux"),
            ("u-y", "displacement uy"),
            ("displacement", "displacement |u|"),
        ] {
            let part = if part == "stress" && label.starts_with("displacement") { "displacement" } else { part };
            let svg = shown(&place, result, part, &["--field", name]);
            assert!(svg.contains(&format!(">{label}")), "{result} {part} {name}");
            assert!(!seen.contains(&svg), "{result} {part} {name}");
            if name != "displacement" {
                assert!(ticks(&svg, "start").contains(&0.0), "{result} {part} {name}");
            }
            seen.push(svg);
        }
    }
    let svg = shown(&place, "block", "body", &["--field", "yy", "--range", "-2:0"]);
    let bar = ticks(&svg, "start");
    assert!([-2.0, -1.0, 0.0].iter().all(|tick| bar.contains(tick)), "{bar:?}");
    assert!(bar.iter().all(|tick| (-2.0..=0.0).contains(tick)), "{bar:?}");
}

/// A square that a uniform stress of 3 along x and -1 along y acts on: what is known is what is told beyond the colours.
#[test]
fn fields_have_the_values_of_a_uniform_stress() {
    let place = Place::new();
    let square = r#"title = "Uniform"
[body]
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["below", "right", "above", "left"]
[material]
young = 100
poisson = 0.25
plane = "stress"
[sides.below]
displacement = ["free", 0]
[sides.left]
displacement = [0, "free"]
[sides.right]
traction = [3, 0]
[sides.above]
traction = [0, -1]
"#;
    place.write("square.toml", square);
    for set in [
        &["--set", "method.model=\"bem\""][..],
        &["--set", "method.model=\"fem\"", "--set", "grid={ coarse = [2, 2], fine = [2, 2] }"],
    ] {
        place.run(["solve", "square.toml", "--quiet", "--force"].iter().chain(set));
        // ux = (3 + 1/4)/100 x, uy = -(1 + 3/4)/100 y
        let known = [("xx", "3"), ("yy", "−1"), ("principal-1", "3"), ("principal-2", "−1"), ("von-mises", "3.61")];
        let of_displacement = [("u-x", "0.0325"), ("u-y", "−0.0175"), ("displacement", "0.0369")];
        for (name, value) in known.into_iter().chain(of_displacement) {
            let (range, told) = match value.starts_with('−') {
                true => ("1e-9:1", "colours end above the smallest"),
                false => ("-2:-1e-9", "colours end below the largest"),
            };
            let svg = shown(&place, "square", "body", &["--field", name, "--range", range]);
            let line = texts(&svg).into_iter().find(|text| text.starts_with(told)).unwrap().to_owned();
            assert!(line.contains(&format!(" that is drawn, {value} at (")), "{name}: {line}");
        }
    }
}

#[test]
fn a_window_shows_a_part_of_the_undeformed_body() {
    let place = solved();
    for (result, part) in [("block", "body"), ("strip", "body"), ("strip", "stress")] {
        let all = shown(&place, result, part, &["--enlarge", "1"]);
        let svg = shown(&place, result, part, &["--enlarge", "1", "--window", "0.5:1.5,0:0.75"]);
        // a frame has a margin of 6 % of the longer side, and displacements are at most 0.2
        for (anchor, low, high) in [("middle", 0.5, 1.5), ("end", 0.0, 0.75)] {
            let (ticks, of_all) = (ticks(&svg, anchor), ticks(&all, anchor));
            assert!(ticks.len() > 1 && ticks.iter().all(|t| (low - 0.3..high + 0.3).contains(t)), "{result} {ticks:?}");
            assert!(of_all.iter().any(|t| *t > high + 0.2), "{result} {of_all:?}");
        }
    }
    let body = shown(&place, "block", "body", &["--window", "0.5:1.5,0:0.75"]);
    assert!(body.contains("; the largest displacement of this part is "), "{body}");
    // what lies outside of the window does not decide the colours
    let stressed =
        |options: &[&str]| ticks(&shown(&place, "strip", "body", options), "start").into_iter().fold(0.0, f64::max);
    assert!(stressed(&["--window", "3:4,0.5:1.5"]) < stressed(&[]));
    let chart = place.read("default/block-contact-floor.svg");
    assert!(shown(&place, "block", "contact-floor", &["--window", "0.5:1.5,0:0.75"]).as_bytes() == chart);
    for command in [&["solve", "block.toml", "--force"][..], &["show", "block.vtkhdf"]] {
        let options = ["--plots", "refused", "--window", "2.5:3,-1:1"];
        let ran = place.run(command.iter().chain(&options)).demand(1);
        assert!(ran.err.contains("--window 2.5:3,-1:1 shows nothing: the body lies in 0:2,0:1"), "{}", ran.err);
    }
    assert!(!place.path("refused").exists());
}

#[test]
fn displacements_are_enlarged_as_is_asked_for() {
    let place = solved();
    for result in ["block", "strip"] {
        let scale = shown(&place, result, "body", &["--enlarge", "1"]);
        assert!(scale.contains(">drawn to scale; "), "{scale}");
        let large = shown(&place, result, "body", &["--enlarge", "12.5"]);
        assert!(large.contains(" drawn 12.5 times as large; ") && large != scale, "{large}");
    }
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
    refused(&["--field", "von-misses"], "von-mises");
    refused(&["--field", "pressure"], "principal-1");
    refused(&["--window", "0:1"], "an interval of x and one of y");
    refused(&["--window", "0:1,3:2"], "the smaller number stands first: 2:3");
    refused(&["--window", "0:1,2:2"], "nothing between two equal numbers");
    refused(&["--enlarge", "0"], "it must be positive; 1 draws to scale");
    refused(&["--enlarge", "-2"], "it must be positive");
    refused(&["--enlarge", "much"], "\"much\" is no number");
    let whole = "0:1,0:1";
    for options in [["--range", "-2:1"], ["--field", "xx"], ["--window", whole], ["--enlarge", "1"], ["--steps", "0"]] {
        for command in [&["solve", "block.toml", "--force"][..], &["show", "block.vtkhdf"]] {
            let ran = place.run(command.iter().chain(&options)).demand(1);
            assert!(ran.err.contains(options[0]) && ran.err.contains("add --plots DIR"), "{}", ran.err);
        }
    }
    assert!(!place.path("refused").exists());
}

#[test]
fn units_are_named_in_pictures_and_summary_and_change_no_number() {
    let place = solved();
    let named = format!("{}[units]\nlength = \"mm\"\nstress = \"MPa\"\n", crate::place::BLOCK);
    place.write("named.toml", named);
    let without = place.json(0, &["block.toml"]);
    let with = place.json(0, &["named.toml", "--plots", "named"]);
    assert_eq!(with["units"], serde_json::json!({ "length": "mm", "stress": "MPa" }));
    assert!(without.get("units").is_none());
    assert_eq!(with["energy"], without["energy"]);
    let picture = |folder: &str, name: &str| String::from_utf8(place.read(&format!("{folder}/{name}.svg"))).unwrap();
    let body = picture("named", "named-body");
    for text in [">x in mm<", ">y in mm<", ">von Mises stress in MPa<"] {
        assert!(body.contains(text), "{text} {body}");
    }
    assert!(texts(&body).iter().any(|text| text.contains("the largest displacement is ") && text.ends_with(" mm")));
    let chart = picture("named", "named-contact-floor");
    for text in [">x in mm<", ">pressure in MPa<", ">shear in MPa<", ">pressure λₙ, in MPa<", ", in MPa<"] {
        assert!(chart.contains(text), "{text} {chart}");
    }
    // a stored result names them too
    let summary = place.run(["show", "named.vtkhdf", "--plots", "shown", "--field", "u-y"]).demand(0);
    assert!(summary.out.contains("units       length mm, stress MPa"), "{}", summary.out);
    assert!(picture("shown", "named-body").contains(">displacement uy in mm<"));
    assert!(picture("shown", "named-contact-floor") == chart);
    let summary = place.run(["show", "block.vtkhdf"]).demand(0);
    assert!(!summary.out.contains("\nunits "), "{}", summary.out);
    let set = ["solve", "strip.toml", "--quiet", "--force", "--plots", "cells", "--set", "units={ length = \"m\" }"];
    place.run(set);
    let cells = picture("cells", "strip-stress");
    assert!(cells.contains(">x in m<") && cells.contains(">von Mises stress"), "{cells}");
    // what is no name is refused at its place
    for (table, told) in [
        ("length = \"\"", "units.length is empty"),
        ("length = 1", "units.length is a"),
        ("lenght = \"mm\"", "did you mean length?"),
    ] {
        place.write("wrong.toml", format!("{}[units]\n{table}\n", crate::place::BLOCK));
        let ran = place.run(["solve", "wrong.toml"]).demand(1);
        assert!(ran.err.contains(told) && ran.err.contains("wrong.toml:"), "{}", ran.err);
    }
}

#[test]
fn meshes_of_chosen_steps_are_drawn() {
    let place = solved();
    let few = ["block.toml", "--set", "method.refine=\"uniform-h\"", "--set", "method.max_steps=3"];
    let solved = ["--plots", "meshes", "--steps", "0,2", "--out", "uniform.vtkhdf", "--quiet"];
    place.run(["solve"].iter().chain(&few).chain(&solved));
    let svg = String::from_utf8(place.read("meshes/uniform-meshes.svg")).unwrap();
    let captions: Vec<&str> = texts(&svg).into_iter().filter(|text| text.starts_with("step ")).collect();
    assert!(
        captions.len() == 2 && captions[0].starts_with("step 0: ") && captions[1].starts_with("step 2: "),
        "{captions:?}"
    );
    // twice the elements in each step
    let elements =
        |text: &str| text.split([' ', ':']).find_map(|word| word.parse::<usize>().ok().filter(|n| *n > 2)).unwrap();
    assert_eq!(elements(captions[1]), 4 * elements(captions[0]));
    assert_eq!(svg, shown(&place, "uniform", "meshes", &["--steps", "0,2"]));
    for (result, steps, says) in [("uniform", "3", "steps 0 to 2"), ("strip", "0", "on a grid")] {
        let file = format!("{result}.vtkhdf");
        let ran = place.run(["show", &file, "--plots", "other", "--steps", steps]).demand(1);
        assert!(ran.err.contains(says), "{}", ran.err);
    }
}

//! Profiles of scenes: read from tables and from files, refused with place and remedy.

use std::path::Path;

use steklov_document::{SceneError, parse};
use steklov_problem::Scene;

/// A block over a floor whose height is a profile.
fn block(profile: &str, gap: &str) -> String {
    format!(
        "body = {{ corners = [[0, 0], [1, 0], [1, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"left\"] }}\n\
         material = {{ young = 100, poisson = 0.3 }}\nparameters.a = 0.25\nprofiles.rough = {profile}\n\
         sides.floor.contact.gap = {gap:?}\nsides.top.displacement = [0, -0.01]\n"
    )
}

fn gap(scene: &Scene, at: f64) -> f64 {
    scene.problem.side_data(0)[0].1.eval(at, 0.0, at)
}

fn read_in(folder: &Path, text: &str) -> Result<Scene, SceneError> {
    parse(text, &folder.join("scene.toml").display().to_string(), &[])
}

#[test]
fn points_and_files_are_the_same_function() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("plain.csv", "0,0.5\n0.25,-1\n1,2\n"),
        ("named.csv", "x, height\n0, 0.5\n 0.25 , -1\n1,2e0"),
        ("semicolon.csv", "\u{feff}# measured\nx;h\n0;0.5\n0.25;-1\n\n1;2\n"),
        ("tab.txt", "0\t0.5\r\n0.25\t-1\r\n1\t2\r\n"),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let scene = read_in(folder.path(), &block(&format!("{{ file = {name:?} }}"), "2*rough(x)"));
        let scene = scene.unwrap_or_else(|e| panic!("{name}: {e}"));
        let inline = parse(&block("{ points = [[0, 0.5], [\"a\", -1], [1, 2]] }", "2*rough(x)"), "t", &[]).unwrap();
        for (at, value) in [(0.0, 1.0), (0.125, -0.5), (0.25, -2.0), (0.625, 1.0), (1.0, 4.0)] {
            assert_eq!((gap(&scene, at), gap(&inline, at)), (value, value), "{name} at {at}");
        }
        assert!(scene.unused.contains(&"a".to_owned()) && !inline.unused.contains(&"a".to_owned()), "{name}");
    }
}

#[test]
fn cubics_have_the_slopes_of_the_scene_or_smooth_ones() {
    let at = |profile: &str, at: f64| gap(&parse(&block(profile, "rough(x)"), "t", &[]).unwrap(), at);
    let points = "points = [[0, 0], [0.5, 0.125], [1, 1]]";
    // x^3
    let cubic = format!("{{ {points}, slopes = [[0, 0], [0.75, 0.75], [3, 3]] }}");
    assert!((at(&cubic, 0.2) - 0.008).abs() < 1e-16 && (at(&cubic, 0.8) - 0.512).abs() < 1e-15);
    // weighted harmonic means of the secants 1/4 and 7/4 inside, parabolas kept from turning at the ends
    let (inner, [first, last]) = (2.0 / (1.0 / 0.25 + 1.0 / 1.75), [0.0, 2.5]);
    let smooth = format!("{{ {points}, smooth = true }}");
    let same = format!("{{ {points}, slopes = [[{first}, {first}], [{inner}, {inner}], [{last}, {last}]] }}");
    for x in [0.1, 0.3, 0.6, 0.9] {
        assert!((at(&smooth, x) - at(&same, x)).abs() < 1e-15, "{x}");
        let straight = format!("{{ {points}, smooth = false }}");
        assert_eq!(at(&straight, x), at(&format!("{{ {points} }}"), x));
    }
}

#[test]
fn a_profile_that_nothing_uses_is_told() {
    let scene = parse(&block("{ points = [[0, 0], [1, 1]] }", "0"), "t", &[]).unwrap();
    assert_eq!(scene.unused, ["rough", "a"]);
}

#[test]
fn a_wrong_profile_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("three.csv", "0,1,2\n1,2,3\n"),
        ("word.csv", "x,h\n0,0\n1,high\n"),
        ("falling.csv", "x,h\n0,0\n1,1\n0.5,0\n"),
        ("nan.csv", "0,0\n1,NaN\n"),
        ("empty.csv", ""),
        ("comma.csv", "0,5;1\n0,7;2\n"),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    std::fs::write(folder.path().join("binary.csv"), [0xffu8, 0xfe, 0x00]).unwrap();
    for (profile, told) in [
        ("{ file = \"three.csv\" }", "line 1 has 3 entries, not 2"),
        ("{ file = \"word.csv\" }", "\"high\" in line 3 is not a number"),
        ("{ file = \"falling.csv\" }", "at 0.5, not beyond 1: list the knots by rising positions, each once (line 4)"),
        ("{ file = \"nan.csv\" }", "(1, NaN): both must be finite (line 2)"),
        ("{ file = \"empty.csv\" }", "0 positions and 0 values"),
        ("{ file = \"comma.csv\" }", "\"0,5\" in line 1 is not a number"),
        ("{ file = \"nix.csv\" }", "nix.csv: "),
        ("{ file = \"binary.csv\" }", "binary.csv: "),
        ("{ file = 3 }", "profiles.rough.file is an integer"),
        ("{ points = [[0, 0]] }", "1 positions and 1 values"),
        (
            "{ points = [[0, 0], [0, 1]] }",
            "not beyond 0: list the knots by rising positions, each once (profiles.rough.points[1])",
        ),
        ("{ points = [[0, 0], [1]] }", "profiles.rough.points[1] has 1 entry"),
        ("{ points = [[0, 0], [1, 1]], file = \"a.csv\" }", "has both file and points"),
        ("{ points = [[0, 0], [1, 1]], slopes = [[0, 0]] }", "1 pairs of slopes for 2 knots"),
        ("{ points = [[0, 0], [1, 1]], slopes = [[0, 0], [0, 0]], smooth = true }", "stands beside smooth"),
        ("{ file = \"three.csv\", slopes = [[0, 0]] }", "three.csv: line 1"),
        ("{ points = [[0, 0], [1, 1]], smooth = 1 }", "profiles.rough.smooth is an integer"),
        ("{}", "has neither file nor points"),
        ("{ pointz = [[0, 0], [1, 1]] }", "unknown key profiles.rough.pointz"),
        ("3", "profiles.rough is an integer"),
    ] {
        let error = read_in(folder.path(), &block(profile, "rough(x)")).unwrap_err();
        assert!(error.message.contains(told), "{profile}: {error}");
        assert_eq!(error.line(), Some(4), "{profile}: {error}");
    }
}

#[test]
fn a_name_is_a_profile_alone_and_has_an_argument() {
    let points = "{ points = [[0, 0], [1, 1]] }";
    for (text, told) in [
        (block(points, "rough"), "the profile rough needs its argument"),
        (block(points, "rough(x, y)"), "stands where \")\" is expected"),
        (block(points, "ruogh(x)"), "unknown function ruogh"),
        (block(points, "rough(x)").replace("profiles.rough", "profiles.sin"), "has a meaning of its own"),
        (block(points, "rough(x)").replace("profiles.rough", "profiles.a"), "a is a parameter as well as a profile"),
        (
            block(points, "rough(x)") + "random.rough = { distribution = \"uniform\", low = 0, high = 1 }\n",
            "rough is a random input as well as a profile",
        ),
        (block(points, "rough(x)").replace("[1, 0]", "[\"rough(1)\", 0]"), "uses rough, which is a profile"),
    ] {
        let error = parse(&text, "t", &[]).unwrap_err();
        assert!(error.message.contains(told), "{text}: {error}");
    }
}

#[test]
fn a_side_beyond_the_ends_of_a_profile_is_refused_with_both() {
    for (points, told) in [
        ("{ points = [[0.1, 0], [1, 1]] }", "reaches from 0.1 to 1, and here it is asked at 0"),
        ("{ points = [[0, 0], [0.9999, 1]] }", "reaches from 0 to 0.9999, and here it is asked at"),
    ] {
        let error = parse(&block(points, "rough(x)"), "t", &[]).unwrap_err();
        assert!(error.message.contains("the gap of side \"floor\" is NaN at the point ("), "{error}");
        assert!(error.help.contains(told), "{}", error.help);
        let kept = block(points, "rough(min(max(x, 0.1), 0.9))");
        assert!(parse(&kept, "t", &[]).is_ok());
    }
    // a part of the side that no sampled point sees
    let short = "{ points = [[0, 0], [0.50001, 1]] }";
    let error = parse(&block(short, "if(abs(x - 0.5) < 2e-5, rough(x), 0)"), "t", &[]).unwrap_err();
    assert!(error.help.contains("reaches from 0 to 0.50001"), "{error}");
}

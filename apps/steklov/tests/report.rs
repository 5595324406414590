//! `steklov report`: a page of a stored result.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use crate::place::{Place, Ran};
use serde_json::Value;

/// The scene of the gallery with this number.
fn scene(number: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let named = |name: &String| name.starts_with(&format!("{number}-"));
    let name = crate::place::names(&folder).into_iter().find(named).unwrap();
    folder.join(name)
}

/// The page of a scene that is solved with `--report`, and its JSON object.
fn solved(place: &Place, scene: &str) -> (String, Value) {
    let object = place.json(0, &[scene, "--quiet", "--out", "result.vtkhdf", "--report", "page"]);
    (page(place, "page"), object)
}

fn page(place: &Place, folder: &str) -> String {
    assert_eq!(crate::place::names(&place.path(folder)), ["index.html"]);
    String::from_utf8(place.read(&format!("{folder}/index.html"))).unwrap()
}

/// All numbers that the page has with all of their digits.
fn numbers(page: &str) -> BTreeSet<u64> {
    let texts = page.split("<data value=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    texts.map(|text| text.parse::<f64>().unwrap().to_bits()).collect()
}

/// The page with its letters as a browser shows them.
fn shown(page: &str) -> String {
    let letters = [("&#x2f;", "/"), ("&#x27;", "'"), ("&quot;", "\""), ("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")];
    letters.iter().fold(page.to_owned(), |text, (code, letter)| text.replace(code, letter))
}

/// What stands between two texts, the first time.
fn between<'a>(page: &'a str, begin: &str, end: &str) -> &'a str {
    page.split_once(begin).and_then(|(_, rest)| rest.split_once(end)).unwrap_or_else(|| panic!("no {begin}")).0
}

/// Every number of these keys of an object, lists and groups with all of theirs.
fn leaves(value: &Value, found: &mut Vec<f64>) {
    match value {
        Value::Number(number) => found.push(number.as_f64().unwrap()),
        Value::Array(values) => values.iter().for_each(|value| leaves(value, found)),
        Value::Object(values) => values.values().for_each(|value| leaves(value, found)),
        _ => {}
    }
}

const TOLD: [&str; 13] = [
    "energy",
    "energy_extrapolated",
    "energy_uncertainty",
    "strain_energy",
    "load_work",
    "estimate",
    "estimate_relative",
    "reactions",
    "probe",
    "audit",
    "/contact/length",
    "/contact/force",
    "/contact/ends",
];

#[test]
fn pages_of_the_gallery_load_nothing_and_have_the_numbers_of_the_object_and_the_body_of_the_file() {
    for number in ["15", "45", "60", "33", "40", "29"] {
        let place = Place::new();
        let (page, object) = solved(&place, scene(number).to_str().unwrap());
        assert!(page.len() < 1_000_000, "{number}: {}", page.len());
        for loaded in ["http:", "https:", "file:", "<link", "@import", "<script src", "url(", "import(", "fetch("] {
            assert!(!page.contains(loaded), "{number}: {loaded}");
        }
        let sources = page.split("src=\"").skip(1);
        assert!(sources.clone().count() > 0 && sources.clone().all(|source| source.starts_with("data:image/")));
        assert_eq!(page.matches("<img").count(), page.matches("alt=\"").count(), "{number}");
        let title = object["title"].as_str().unwrap();
        let text = shown(&page);
        assert!(text.contains(&format!("<h1>{title}</h1>")) && text.contains(&format!("<title>{title}</title>")));

        let known = numbers(&page);
        let mut told = Vec::new();
        for key in TOLD {
            let value = if key.starts_with('/') { object.pointer(key) } else { object.get(key) };
            value.into_iter().for_each(|value| leaves(value, &mut told));
        }
        assert!(told.len() > 5, "{number}: {told:?}");
        for value in told {
            assert!(known.contains(&value.to_bits()), "{number}: {value:?} is not on the page");
        }
        for doubt in object["estimate_doubts"].as_array().unwrap() {
            let word = doubt.as_str().unwrap();
            let told = between(&page, &format!("<dt>{word}</dt>"), "</dl>");
            assert!(told.contains("Remedy: "), "{number}: {word}");
        }
        for entry in object["expect"].as_array().unwrap() {
            let row = between(&text, &format!("<tr><td>{}</td>", entry["path"].as_str().unwrap()), "</tr>");
            assert_eq!(row.contains(">holds<"), entry["holds"] == true, "{number}: {row}");
        }
        if number != "29" {
            the_embedded_body_is_that_of_the_file(&place, number);
        }
    }
}

/// The arrays of the page are those of the file.
fn the_embedded_body_is_that_of_the_file(place: &Place, number: &str) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/embedded_body.py");
    let said = place.python(script, &["result.vtkhdf", "page/index.html"]).demand(0).out;
    assert!(said.contains("the body of the page is that of the file"), "{number}: {said}");
}

/// What is written at once is what is made of the file afterwards.
#[test]
fn a_page_at_once_is_that_of_the_file() {
    let place = Place::new();
    let (at_once, _) = solved(&place, "block.toml");
    let said = place.run(["report", "result.vtkhdf", "--out", "again"]).demand(0).out;
    assert_eq!(said.trim(), "page        again/index.html");
    assert_eq!(page(&place, "again"), at_once);
    // the plan with its reasons, and the scene
    let plan: Value = place.run(["plan", "block.toml", "--json"]).demand(0).json();
    for decision in plan["modelled"].as_array().unwrap() {
        let what = decision["what"].as_str().unwrap();
        assert!(shown(&at_once).contains(&format!("<dt>{what}: ")), "{decision}");
    }
    assert!(shown(&at_once).contains(crate::place::BLOCK), "the scene");
}

/// The sums of the contact nodes on the page are the force on the body.
#[test]
fn contact_sides_bear_the_force() {
    let place = Place::new();
    // pushed along the floor, which holds by friction
    let text = crate::place::BLOCK.replace("[\"0\", \"-1\"]", "[\"0.2\", \"-1\"]");
    place.write("pushed.toml", text);
    let (page, object) = solved(&place, "pushed.toml");
    let side = between(between(&page, "<section id=\"contact\">", "</section>"), "<tr><td>floor</td>", "</tr>");
    let texts = side.split("<data value=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let [length, _, _, x, y, pressure] = texts.map(|t| t.parse::<f64>().unwrap()).collect::<Vec<_>>()[..] else {
        panic!("{side}")
    };
    let contact = &object["contact"];
    for (told, exact) in [(x, &contact["force"][0]), (y, &contact["force"][1]), (pressure, &contact["max_pressure"])] {
        assert!((told - exact.as_f64().unwrap()).abs() < 1e-12, "{told} {exact}");
    }
    assert!((x + 0.4).abs() < 1e-9 && (y - 2.0).abs() < 1e-9 && length > 1.0, "{side}");
}

/// The script of the page finds triangles and interpolates linear fields exactly; where node is not installed nothing runs it.
#[test]
fn the_script_interpolates() {
    let place = Place::new();
    solved(&place, "block.toml");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/javascript/body.js");
    let Ok(output) = Command::new("node").arg(script).arg(place.path("page/index.html")).output() else {
        eprintln!("node is not installed: the script of the page was not run");
        return;
    };
    let said = Ran::new(output).demand(0).out;
    assert!(said.contains("the script is right"), "{said}");
}

#[test]
fn what_cannot_be_reported_is_refused() {
    let place = Place::new();
    let refused = |arguments: &[&str], words: &[&str]| {
        let said = place.run(arguments).demand(1).err;
        words.iter().for_each(|word| assert!(said.contains(word), "{word}: {said}"));
    };
    refused(&["report", "none.vtkhdf", "--out", "page"], &["none.vtkhdf"]);
    refused(&["report", "block.toml", "--out", "page"], &["is a scene", "steklov solve block.toml"]);
    place.write("mine.png", b"\x89PNG\r\n\x1a\n");
    refused(&["report", "mine.png", "--out", "page"], &["mine.png"]);
    assert!(!place.path("page").exists());
    std::fs::create_dir(place.path("page")).unwrap();
    place.write("page/mine.txt", "mine");
    refused(&["report", "none.vtkhdf", "--out", "page"], &["not empty", "--force"]);
    refused(&["report", "none.vtkhdf", "--out", "block.toml"], &["--out needs a folder"]);
    // before anything is solved
    refused(&["solve", "block.toml", "--report", "page"], &["not empty", "--force", "--report"]);
    assert!(!place.path("block.vtkhdf").exists());
    place.run(["solve", "block.toml", "--report", "page", "--force"]).demand(0);
    place.run(["report", "block.vtkhdf", "--out", "page", "--force"]).demand(0);
    assert_eq!(crate::place::names(&place.path("page")), ["index.html", "mine.txt"]);
}

/// A study is one page too: its tables with the numbers of the JSON object, and its pictures.
#[test]
fn a_study_has_a_page() {
    let place = Place::new();
    let options =
        ["--strategies", "uniform-h", "--repeat", "1", "--set", "method.max_dofs=80", "--out", "of block", "--json"];
    let told = place.run(["study", "block.toml"].iter().chain(&options)).demand(0).json();
    place.run(["report", "of block/study.h5", "--out", "page"]).demand(0);
    let page = String::from_utf8(place.read("page/index.html")).unwrap();
    assert!(page.len() < steklov_report::LARGEST, "{}", page.len());
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("file:"));
    assert!(page.contains("<h3>strategies, uniform-h, steps</h3>"));
    let steps = told["strategies"][0]["steps"].as_array().unwrap();
    assert!(steps.len() > 1);
    for step in steps {
        assert!(page.contains(&format!("<td>{}</td>", step["dofs"])), "{}", step["dofs"]);
    }
    for picture in ["error-dofs", "meshes-uniform-h"] {
        let source = steklov_picture::data_uri("svg+xml", place.read(&format!("of block/{picture}.svg")));
        assert!(page.contains(&source), "{picture}");
        assert!(page.contains(&format!("alt=\"{}\"", picture.replace('-', " "))));
    }
    // without the pictures beside it, and of a file that is none
    std::fs::create_dir(place.path("alone")).unwrap();
    std::fs::copy(place.path("of block/study.h5"), place.path("alone/study.h5")).unwrap();
    place.run(["report", "alone/study.h5", "--out", "bare"]).demand(0);
    assert!(!String::from_utf8(place.read("bare/index.html")).unwrap().contains("<img"));
}

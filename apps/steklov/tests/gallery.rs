//! `steklov gallery`: a page of figures, their numbers, and the commands that make them by hand.

use crate::place::Place;
use serde_json::Value;

fn gallery(place: &Place, only: &[&str], status: i32) -> (String, Value) {
    let mut arguments = vec!["gallery", "--out", "page", "--quiet", "--force"];
    arguments.extend(only.iter().flat_map(|name| ["--only", name]));
    place.run(arguments).demand(status);
    let read = |name: &str| String::from_utf8(place.read(&format!("page/{name}"))).unwrap();
    (read("index.html"), serde_json::from_str(&read("gallery.json")).unwrap())
}

fn figures(object: &Value) -> &[Value] {
    object["figures"].as_array().unwrap()
}

#[test]
fn one_figure_is_a_page_that_loads_nothing() {
    let place = Place::new();
    let (page, object) = gallery(&place, &["fig-2-3"], 0);
    let [figure] = figures(&object) else { panic!("{object}") };
    assert_eq!(
        (&figure["name"], &figure["verdict"], &figure["holds"]),
        (&"fig-2-3".into(), &"same".into(), &true.into())
    );
    assert!(
        page.contains("Multiplier") && page.contains("data:image/svg+xml;base64,") && page.contains("alt=\"Pressure")
    );
    for loaded in ["http:", "https:", "file:", "<script", "<link", "@import"] {
        assert!(!page.contains(loaded), "{loaded}");
    }
    for number in figure["numbers"].as_array().unwrap() {
        let what = number["what"].as_str().unwrap();
        assert!(page.contains(what) && number["holds"] == true && number["computed"].is_number(), "{number}");
    }
    assert!(place.read("page/fig-2-3.png").starts_with(b"\x89PNG"));
}

/// The numbers of a page are those of its commands.
#[test]
fn the_commands_by_hand_give_the_same_numbers() {
    let place = Place::new();
    let (_, object) = gallery(&place, &["fig-2-3", "fig-3-1", "fig-5-10"], 0);
    // on another grid than the scene's own its [expect] does not hold
    for (name, what, pointer, status) in [
        ("fig-2-3", "largest pressure at a node", "/contact/max_pressure", 0),
        ("fig-3-1", "J", "/energy", 0),
        ("fig-5-10", "u_y at the end of the axis", "/probe/0/displacement/1", 3),
    ] {
        let figure = figures(&object).iter().find(|f| f["name"] == name).unwrap();
        let [command] = figure["commands"].as_array().unwrap().as_slice() else { panic!("{figure}") };
        let command = command.as_str().unwrap().replace('\'', "");
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        let scene = format!("{}/../../{}", env!("CARGO_MANIFEST_DIR"), words[1]);
        let arguments = ["solve", &scene, "--json", "--quiet", "--force"].into_iter().chain(words[2..].iter().copied());
        let by_hand: Value =
            serde_json::from_str(&place.run(arguments.collect::<Vec<_>>()).demand(status).out).unwrap();
        let number = figure["numbers"].as_array().unwrap().iter().find(|n| n["what"] == what).unwrap();
        assert_eq!(&number["computed"], by_hand.pointer(pointer).unwrap(), "{name}: {what}");
    }
}

/// A figure that is wanted stands in the table of contents with its verdict and commands, and holds. `make gallery` makes all.
#[test]
fn figures_of_two_chapters_hold() {
    let place = Place::new();
    let (page, object) = gallery(&place, &["fig-2-1", "fig-2-3", "fig-4"], 0);
    let names: Vec<&str> = figures(&object).iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["fig-2-1", "fig-2-3", "fig-4-1", "fig-4-2"]);
    for figure in figures(&object) {
        let name = figure["name"].as_str().unwrap();
        assert!(page.contains(&format!("href=\"#{name}\"")) && page.contains(&format!("id=\"{name}\"")), "{name}");
        assert!(["same", "chosen", "differs"].contains(&figure["verdict"].as_str().unwrap()), "{name}");
        assert!(
            !figure["commands"].as_array().unwrap().is_empty() && figure["numbers"].as_array().unwrap().len() >= 2,
            "{name}"
        );
    }
    // every picture says what it shows
    assert_eq!(page.matches("<img").count(), page.matches("alt=\"").count());
    assert!(!page.contains("alt=\"\""));
}

#[test]
fn names_and_folders_that_are_wrong_are_refused_before_anything_is_run() {
    let place = Place::new();
    let said = place.run(["gallery", "--out", "page", "--only", "fig-2-9"]).demand(1).err;
    assert!(said.contains("fig-2-9") && said.contains("fig-2-1") && said.contains("own-coupling"), "{said}");
    std::fs::create_dir(place.path("page")).unwrap();
    place.write("page/mine.txt", "mine");
    let said = place.run(["gallery", "--out", "page", "--only", "fig-2-3"]).demand(1).err;
    assert!(said.contains("--force"), "{said}");
}

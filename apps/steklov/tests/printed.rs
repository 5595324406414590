//! What the command prints that solves nothing: templates, scenes of the gallery, the schema, completions and manual pages.

use std::path::Path;

use serde_json::json;

use crate::place::Place;

#[test]
fn new_prints_scenes_that_are_solved_without_a_doubt() {
    let place = Place::new();
    let new = place.run(["new"]).demand(0);
    assert!(new.err.is_empty() && new.out.starts_with('#'));
    for (kind, title) in [
        ("contact", "Block on a rigid floor"),
        ("bodies", "Cylinder on a block"),
        ("crack", "Plate with a slanted crack"),
        ("random", "Block on a rough floor under a random load"),
        ("grid", "Plate of random cells"),
        ("medium", "Tunnel in rock"),
    ] {
        let printed = place.run(["new", "--kind", kind]).demand(0).out;
        assert_eq!(printed == new.out, kind == "contact");
        let name = format!("{kind}.toml");
        place.write(&name, &printed);
        let o = place.json(0, &[&name]);
        assert_eq!((&o["file"], &o["title"]), (&json!(format!("{kind}.vtkhdf")), &json!(title)));
        assert_eq!(o["estimate_doubts"], json!([]), "{kind}");
        // every comment that could be a line of its own is one
        let all: String = printed
            .lines()
            .map(|l| l.strip_prefix('#').filter(|rest| rest.starts_with(|c: char| !c.is_whitespace())).unwrap_or(l))
            .flat_map(|line| [line, "\n"])
            .collect();
        place.write("all.toml", &all);
        place.run(["plan", "all.toml"]).demand(0);
    }
}

#[test]
fn scenes_of_the_gallery_are_listed_and_printed() {
    let place = Place::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .filter_map(|entry| Some(entry.unwrap().file_name().to_str()?.strip_suffix(".toml")?.to_owned()))
        .collect();
    names.sort_unstable();
    let list = place.run(["scenes"]).demand(0).out;
    let listed: Vec<&str> = list.lines().map(|line| line.split_whitespace().next().unwrap()).collect();
    assert_eq!(listed, names);
    assert!(list.lines().all(|line| line.split_whitespace().count() > 1), "{list}");
    let hertz = std::fs::read_to_string(folder.join("12-hertz.toml")).unwrap();
    for name in ["12-hertz", "12-hertz.toml", "hertz", "12"] {
        assert_eq!(place.run(["scenes", name]).demand(0).out, hertz);
    }
    assert!(place.run(["scenes", "herz"]).demand(1).err.contains("did you mean hertz?"));
}

#[test]
fn the_schema_is_one_json_object() {
    let place = Place::new();
    let schema = place.run(["schema"]).demand(0).json();
    assert_eq!(schema["$schema"], json!("https://json-schema.org/draft/2020-12/schema"));
    assert_eq!(schema["$defs"]["method"]["properties"]["max_steps"]["default"], json!(60));
}

#[test]
fn completions_and_man_pages_know_every_command() {
    let place = Place::new();
    let help = place.run(["help"]).demand(0).out;
    let commands = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names: Vec<&str> = commands
        .lines()
        .filter(|l| l.starts_with("  ") && !l.starts_with("   "))
        .filter_map(|l| l.split_whitespace().next())
        .collect();
    assert!(names.len() >= 11, "{names:?}");
    let page = place.run(["man"]).demand(0).out;
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let text = place.run(["completions", shell]).demand(0).out;
        assert!(names.iter().all(|name| text.contains(name)), "{shell}");
    }
    for name in names {
        assert!(page.contains(&format!("steklov\\-{name}(1)")), "{name}: {page}");
        let own = place.run(["man", name]).demand(0).out;
        assert!(own.starts_with(".ie") && own.contains(&format!("steklov\\-{name} \\-")), "{name}: {own}");
    }
    place.run(["man", "bogus"]).demand(1);
}

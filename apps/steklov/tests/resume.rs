//! `--resume`: what was on disk stays, what does not belong to the scene is refused.

use std::fs;

use crate::place::Place;
use serde_json::{Value, json};
use steklov_bem_operators::Mesh;
use steklov_io::{File, Group, IoError, Label, copy, create_atomically, load, load_dense, open, save, save_dense};

/// The block, refined adaptively.
fn adaptive() -> Place {
    let place = Place::new();
    place.write("block.toml", crate::place::BLOCK.replace("refine = \"none\"\n", "tolerance = 1e-4\n"));
    place
}

/// The results that another way to them must not change.
fn results(o: &Value) -> Vec<&Value> {
    ["energy", "estimate", "dofs", "steps", "contact", "audit"].iter().map(|key| &o[key]).collect()
}

/// The matrices of all steps survive an interruption, with the bits of a run that had none.
#[test]
fn matrices_of_earlier_steps_stay() {
    let place = adaptive();
    let saved = ["block.toml", "--save", "matrices"];
    let whole = place.json(0, &[&saved[..], &["--out", "whole.vtkhdf"]].concat());
    let steps = whole["steps"].as_u64().unwrap() as usize;
    assert!(steps > 4);
    let matrix = |file: &str, k: usize, name: &str| {
        let step = open(place.path(file)).unwrap().group(&format!("steps/{k:03}")).unwrap();
        step.link_exists("matrices").then(|| load_dense(&step.group("matrices").unwrap(), name).unwrap())
    };
    let limit = |n: usize| format!("method.max_steps={n}");
    for (with, kept) in [(&["--save", "matrices"][..], steps), (&[], 2)] {
        place.json(3, &[&saved[..], &["--set", &limit(2)]].concat());
        // twice: what was copied once is copied again
        place.json(3, &[&["block.toml", "--resume", "--set", &limit(4)], with].concat());
        let o = place.json(0, &[&["block.toml", "--resume"], with].concat());
        assert_eq!(results(&o), results(&whole));
        for k in 0..steps {
            for name in ["V", "K", "W", "S"] {
                let there = matrix("block.vtkhdf", k, name);
                assert_eq!(there.is_some(), k < kept, "step {k}");
                assert!(there.is_none_or(|m| m == matrix("whole.vtkhdf", k, name).unwrap()), "step {k}: {name}");
            }
        }
        assert_eq!(open(place.path("block.vtkhdf")).unwrap().link_exists("matrices"), kept == steps);
    }
}

/// Other overrides are those that give another scene, not those that are written otherwise.
#[test]
fn overrides_are_compared_by_what_they_set() {
    let place = adaptive();
    let solve = |status: i32, arguments: &[&str], sets: &[&str]| {
        let sets = sets.iter().flat_map(|s| ["--set", s]);
        place.run(["solve", "--json", "block.toml"].iter().chain(arguments).copied().chain(sets)).demand(status)
    };
    let first = ["material.young=100", "sides.top.traction=[\"0\", -2]", "method.max_steps=2"];
    let whole = solve(0, &[], &first[..2]).json();
    for (status, sets, differs) in [
        (0, &["sides.top.traction=[\"0\", -2]", "material.young=100"][..], ""),
        (0, &["material . \"young\" = 1e2", "sides.top.traction.0='0'", "sides.top.traction.1=-2.0"], ""),
        (0, &["material.young=7", "sides.'top'={ traction = [\"0\", -2] }", "material.young=100.0"], ""),
        (0, &["material.young=100", "sides.top.traction=[\"0\", -2]", "\"method\".\"tolerance\"=1e-4"], ""),
        (0, &["material.young=100", "sides.top.traction=[\"0\", -2]", "material.poisson=0.3"], ""),
        (1, &["material.young=100"], "in sides.top.traction;"),
        (1, &["material.young=100", "sides.top.traction=[-2, \"0\"]"], "in sides.top.traction;"),
        (1, &["material.young=100.1", "sides.top.traction=[\"0\", -2]"], "in material.young;"),
        (1, &["material.young=100", "sides.top.traction=[\"0\", -2]", "method.degree=2"], "in method.degree;"),
    ] {
        solve(3, &["--force"], &first);
        let before = place.read("block.vtkhdf");
        let ran = solve(status, &["--resume"], sets);
        if status == 0 {
            assert_eq!(results(&ran.json()), results(&whole), "{sets:?}");
        } else {
            assert!(ran.err.contains(differs) && ran.err.contains("block.vtkhdf"), "{sets:?}: {}", ran.err);
            assert!(place.read("block.vtkhdf") == before);
        }
    }
}

const LAST: &str = "steps/001";

fn replace_mesh(file: &File, change: impl Fn(&mut Mesh)) -> Result<(), IoError> {
    let step = file.group(LAST).unwrap();
    let mut mesh: Mesh = load(&step, "mesh")?;
    change(&mut mesh);
    step.unlink("mesh").unwrap();
    save(&step, "mesh", &mesh)
}

fn replace_table(file: &File, name: &str, row: &[f64]) -> Result<(), IoError> {
    let step = file.group(LAST).unwrap();
    step.unlink(name).unwrap();
    let table = faer::Mat::from_fn(1, row.len(), |_, j| row[j]);
    save_dense(&step, name, table.as_ref(), &Label { unit: "1", meaning: "a row", axes: &["row", "column"] })
}

/// A change of a stored file, and what the message about it says.
type Change = (fn(&File) -> Result<(), IoError>, &'static [&'static str]);

const CHANGES: &[Change] = &[
    (|f| replace_table(f, "tips", &[1000.0, 0.0, 0.5, 1.0]), &["/steps/001/tips", "row 0: edge 1000 of 4"]),
    (|f| replace_table(f, "tips", &[1e300, 0.0, 0.5, 1.0]), &["/steps/001/tips", "edge"]),
    (|f| replace_table(f, "tips", &[-1.0, 0.0, 0.5, 1.0]), &["/steps/001/tips", "-1 is no edge"]),
    (|f| replace_table(f, "tips", &[f64::NAN, 0.0, 0.5, 1.0]), &["/steps/001/tips", "NaN is no edge"]),
    (|f| replace_table(f, "tips", &[1.0, 0.0, 0.5, 1.0]), &["/steps/001/tips", "edge 1 is not in contact"]),
    (|f| replace_table(f, "tips", &[0.0, 3.0, 0.5, 1.0]), &["/steps/001/tips", "unknown kind 3"]),
    (|f| replace_table(f, "tips", &[0.0, 0.5, 0.5, 1.0]), &["/steps/001/tips", "unknown kind 0.5"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, 5.0, 1.0]), &["/steps/001/tips", "edge parameter 5,"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, -1e-9, 1.0]), &["/steps/001/tips", "edge parameter -0.000000001,"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, f64::NAN, 1.0]), &["/steps/001/tips", "edge parameter NaN"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, 0.5, 2.0]), &["/steps/001/tips", "regular is 2"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, 0.5, f64::NAN]), &["/steps/001/tips", "regular is NaN"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, 0.5, 0.0]), &["/steps/001/tips", "regular is 0"]),
    (|f| replace_table(f, "tips", &[0.0, 2.0, 0.5, 1.0]), &["/steps/001/tips", "regular is 1"]),
    (|f| replace_table(f, "tips", &[0.0, 0.0, 0.5]), &["/steps/001/tips", "3 columns, not 4"]),
    (
        |f| replace_table(f, "transitions", &[9.0, 0.0, 0.5, 0.1, 1.0, 1.0]),
        &["/steps/001/transitions", "row 0: edge 9 of 4"],
    ),
    (
        |f| replace_table(f, "transitions", &[0.0, 0.0, 0.5, f64::NAN, 1.0, 1.0]),
        &["/steps/001/transitions", "not finite"],
    ),
    (|f| replace_mesh(f, |m| m.edge[3] = 99), &["/steps/001/mesh/edge", "element 3 is on edge 99 of 4"]),
    (|f| replace_mesh(f, |m| m.edge.fill(1)), &["/steps/001/mesh/span", "edge 0"]),
    (|f| replace_mesh(f, |m| m.span.fill([0.0, 0.0])), &["/steps/001/mesh/span", "do not cover"]),
    (|f| replace_mesh(f, |m| m.span[0][1] = f64::NAN), &["/steps/001/mesh/span", "do not cover"]),
    (|f| replace_mesh(f, |m| m.span.iter_mut().for_each(|s| s[1] *= 2.0)), &["/steps/001/mesh/span", "do not cover"]),
    (|f| replace_mesh(f, |m| m.span[0].reverse()), &["/steps/001/mesh/span", "direction of the edge"]),
    (
        |f| replace_mesh(f, |m| m.vertices.iter_mut().for_each(|x| x[0] *= 2.0)),
        &["/steps/001/mesh/nodes", "the scene's polygon"],
    ),
    (|f| replace_mesh(f, |m| m.vertices[1][0] += 1e-9), &["/steps/001/mesh/nodes", "the scene's polygon"]),
    (|f| replace_mesh(f, |m| m.side[0] = 1), &["/steps/001/mesh/side ", "not that of the edge"]),
    (|f| replace_mesh(f, |m| m.side_names.swap(0, 1)), &["/steps/001/mesh/side_names", "not the scene's"]),
    (|f| replace_mesh(f, |m| m.degree[0] = 0), &["/steps/001/mesh", "degree 0"]),
    (|f| replace_mesh(f, |m| m.degree[0] = 1000), &["/steps/001/mesh", "degree 1000"]),
    (|f| replace_mesh(f, |m| m.degree[0] += 1), &["/steps/001/dofs", "but the mesh has"]),
    (|f| unlinked(f, "steps"), &["has no", "/steps"]),
    (|f| unlinked(f, "steps/000"), &["/steps ", "\"001\" is where step \"000\" should be"]),
    (
        |f| {
            unlinked(f, "steps")?;
            steklov_io::create_group(f, "steps").map(|_| ())
        },
        &["/steps ", "there is no step"],
    ),
    (
        |f| {
            let step = f.group(LAST).unwrap();
            copy(&step, "mesh", &f.group("steps").unwrap())
        },
        &["/steps ", "\"mesh\" is where step \"002\" should be"],
    ),
];

fn unlinked(file: &File, name: &str) -> Result<(), IoError> {
    file.unlink(name).unwrap();
    Ok(())
}

/// Files whose checksums are right, but not their content.
#[test]
fn steps_that_are_not_the_scenes_are_refused() {
    let place = adaptive();
    place.json(3, &["block.toml", "--set", "method.max_steps=2", "--out", "sound.vtkhdf"]);
    let altered = |change: fn(&File) -> Result<(), IoError>| {
        let sound = open(place.path("sound.vtkhdf")).unwrap();
        create_atomically(place.path("block.vtkhdf"), true, |file| -> Result<(), IoError> {
            let root: &Group = &sound;
            root.member_names().unwrap().iter().try_for_each(|name| copy(root, name, file))?;
            change(file)
        })
        .unwrap();
    };
    let mut wrong = String::new();
    for (change, parts) in CHANGES {
        altered(*change);
        let before = place.read("block.vtkhdf");
        let ran = place.run(["solve", "block.toml", "--resume", "--json"]);
        let told = parts.iter().chain(&["error: ", "block.vtkhdf"]).all(|part| ran.err.contains(part));
        if ran.status != 1 || !ran.out.is_empty() || !told || place.read("block.vtkhdf") != before {
            wrong += &format!("{parts:?}: status {}\n{}\n", ran.status, ran.err);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    // what is not altered is accepted
    altered(|_| Ok(()));
    place.run(["solve", "block.toml", "--resume", "--json"]).demand(0);
}

/// Stopped at once, before the last step is solved again: the file stays, and the command tells what it holds.
#[cfg(unix)]
#[test]
fn a_resumed_run_that_is_stopped_at_once_leaves_the_file() {
    let place = Place::new();
    // a step that takes seconds
    let large = ["--set", "method.elements=901"];
    let whole = place.json(0, &[&["block.toml"], &large[..]].concat());
    let before = place.read("block.vtkhdf");
    for json in [true, false] {
        let mut command = place.command();
        command.args(["solve", "block.toml", "--resume"]).args(large).args(json.then_some("--json"));
        let run = crate::place::Running::start(command);
        run.wait_for_output(&place, 0);
        run.signal("INT");
        std::thread::sleep(std::time::Duration::from_millis(20)); // two equal signals at once are one
        run.signal("INT");
        let ran = run.end().demand(3);
        assert!(ran.err.contains("block.vtkhdf is unchanged and holds 1 step(s)"), "{}", ran.err);
        if json {
            let o = ran.json();
            assert_eq!((&o["reason"], &o["converged"]), (&json!("interrupted"), &json!(false)));
            assert_eq!((&o["energy"], &o["steps"]), (&whole["energy"], &json!(1)));
        } else {
            assert!(ran.out.contains("NOT CONVERGED") && ran.out.contains("interrupted"), "{}", ran.out);
        }
        assert!(place.read("block.vtkhdf") == before);
        assert_eq!(place.names(), ["block.toml", "block.vtkhdf"]);
    }
    assert!(fs::metadata(place.path("block.vtkhdf")).unwrap().is_file());
}

//! `[expect]`: what the result has beside what it is to have, in the JSON object, the summary and the status.

use crate::place::{BLOCK, Place};

use serde_json::json;

fn expecting(lines: &str) -> String {
    format!("{BLOCK}[expect]\n{lines}\n")
}

#[test]
fn entries_that_hold_are_told_and_one_that_does_not_is_status_3() {
    let place = Place::new();
    let o = place.json(0, &["block.toml"]);
    assert!(o.get("expect").is_none());
    let (energy, force) = (o["energy"].as_f64().unwrap(), o["contact"]["force"][1].as_f64().unwrap());
    // one just within its tolerance, one just beyond
    for (off, holds) in [(0.99e-6, true), (1.01e-6, false), (-1.01e-6, false)] {
        let status = if holds { 0 } else { 3 };
        let lines = format!(
            "energy = {{ value = {:?}, tol = 1e-6, source = \"here\" }}\n\"contact.force.y\" = {{ value = 2, tol = 1e-9 }}",
            energy + off
        );
        place.write("expect.toml", expecting(&lines));
        let ran = place.run(["solve", "expect.toml", "--json", "--force"]).demand(status);
        let told = ran.json();
        let wanted = json!([
            { "path": "energy", "value": energy, "expected": energy + off, "tol": 1e-6, "holds": holds },
            { "path": "contact.force.y", "value": force, "expected": 2.0, "tol": 1e-9, "holds": true },
        ]);
        assert_eq!(told["expect"], wanted);
        assert_eq!((&told["converged"], &told["reason"]), (&json!(true), &json!("solved")));
        assert_eq!(ran.err.contains("DOES NOT HOLD"), !holds, "{}", ran.err);
        let ran = place.run(["solve", "expect.toml", "--force"]).demand(status);
        let lines: Vec<&str> = ran.out.lines().filter(|l| l.starts_with("expected    ")).collect();
        assert_eq!(lines.len(), 2, "{}", ran.out);
        assert!(lines[0].ends_with(if holds { ": holds" } else { ": DOES NOT HOLD" }), "{}", lines[0]);
        assert!(lines[1].ends_with(": holds") && lines[1].contains("contact.force.y = 2 ± 1e-9"), "{}", lines[1]);
        // what is stored says so too
        let shown = place.run(["show", "expect.vtkhdf", "--json"]).demand(0).json();
        assert_eq!(shown["expect"], wanted);
    }
}

#[test]
fn paths_that_no_result_of_the_scene_has_are_refused_with_the_nearest() {
    let place = Place::new();
    for (path, remedy) in [
        ("enrgy", "did you mean energy?"),
        ("contact.force.z", "did you mean contact.force.x?"),
        ("contact.lenght", "did you mean contact.length?"),
        ("reactions.flor.y", "did you mean reactions.floor.y?"),
        ("probe.2.stress.xx", "did you mean probe.0.stress.xx?"),
        ("stochastic.energy.mean", "paths of the JSON object"),
        ("title", "paths of the JSON object"),
        ("contact", "paths of the JSON object"),
    ] {
        for line in [format!("\"{path}\""), path.to_owned()] {
            place.write("expect.toml", expecting(&format!("{line} = {{ value = 1, tol = 1 }}")));
            for command in ["solve", "plan"] {
                let ran = place.run([command, "expect.toml"]).demand(1);
                let message = format!("the result of this scene has no number at {path:?}");
                assert!(ran.err.contains(&message) && ran.err.contains(remedy), "{}", ran.err);
                assert!(ran.err.contains("[expect.toml:20:"), "{}", ran.err);
            }
        }
    }
    assert!(!place.names().contains(&"expect.vtkhdf".to_owned()), "{:?}", place.names());
    // of a scene without contact
    let held = BLOCK.replace("contact = { gap = \"0\", friction = { tresca = \"F\" } }", "displacement = [0, 0]");
    place.write("held.toml", format!("{held}[expect]\ncontact.length = {{ value = 2, tol = 1 }}\n"));
    assert!(place.run(["solve", "held.toml"]).demand(1).err.contains("no number at \"contact.length\""));
}

/// Numbers that a result may have and this one has not: a mesh without an estimate, ends that nothing locates.
#[test]
fn a_number_that_is_missing_does_not_hold() {
    let place = Place::new();
    place.write(
        "expect.toml",
        expecting("contact.ends.0.x = { value = 0, tol = 10 }\nprobe.1.displacement.y = { value = 0, tol = 10 }"),
    );
    let told = place.json(3, &["expect.toml"]);
    assert_eq!((&told["expect"][0]["value"], &told["expect"][0]["holds"]), (&json!(null), &json!(false)));
    assert_eq!(told["expect"][1]["holds"], true);
    let out = place.run(["solve", "expect.toml", "--force"]).demand(3).out;
    assert!(out.contains("contact.ends.0.x = 0 ± 1e1: this result has no such number: DOES NOT HOLD"), "{out}");
}

/// Sides of several bodies have a point in their names; statistics stand at the paths of their quantities.
#[test]
fn paths_of_several_bodies_and_of_outcomes_are_known() {
    let place = Place::new();
    place.write(
        "two.toml",
        r#"
[[body]]
name = "upper"
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[body]]
name = "lower"
corners = [[0, -1], [1, -1], [1, 0], [0, 0]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.3
[sides.lower.bottom]
displacement = ["free", "0"]
[sides.lower.left]
displacement = ["0", "free"]
[sides.upper.top]
traction = ["0", "-0.1"]
[[interface]]
between = ["upper.bottom", "lower.top"]
contact = { friction = { coulomb = "0.3" } }
[method]
refine = "none"
[expect]
"reactions.lower.bottom.y" = { value = 0.1, tol = 1e-9 }
"interfaces.0.force.y" = { value = 0.1, tol = 1e-9 }
"bodies.1.strain_energy" = { value = 0.00455, tol = 1e-9 }
"#,
    );
    let told = place.json(0, &["two.toml"]);
    assert_eq!(told["expect"].as_array().unwrap().len(), 3);
    let random =
        BLOCK.replace("[parameters]\nF = 0.3", "[random.F]\ndistribution = \"uniform\"\nlow = 0.2\nhigh = 0.4");
    let stochastic = "[stochastic]\nquantities = [\"energy\", \"contact.force.y\"]\n[expect]\n\
                      stochastic.contact.force.y.mean = { value = 2, tol = 1e-9 }\n\
                      stochastic.contact.force.y.variance = { value = 0, tol = 1e-12 }\n";
    place.write("random.toml", format!("{random}{stochastic}"));
    let o = place.run(["solve", "random.toml", "--json"]).json();
    assert!(o["expect"].as_array().unwrap().iter().all(|e| e["holds"] == true), "{}", o["expect"]);
    place.write("wrong.toml", format!("{random}{stochastic}").replace("force.y.mean", "force.y.meen"));
    let err = place.run(["solve", "wrong.toml"]).demand(1).err;
    assert!(err.contains("did you mean stochastic.contact.force.y.mean?"), "{err}");
}

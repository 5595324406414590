//! The command `steklov`: arguments, exit statuses, the JSON object, the output file.

use crate::place::{Place, Ran};
use serde_json::{Map, Value, json};

/// The names of an object's keys, sorted as the list is.
fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

fn sorted(list: &str) -> Vec<&str> {
    let mut keys: Vec<&str> = list.split(' ').collect();
    keys.sort_unstable();
    keys
}

const KEYS: &str = "title model file converged reason failure dofs steps energy energy_extrapolated energy_uncertainty \
                    strain_energy load_work friction_work estimate estimate_relative estimate_doubts quantities iterations contact audit reactions probe infinite_stress stochastic seconds \
                    peak_memory_bytes";

/// Every key, its type, and what must hold between the numbers.
#[test]
fn the_json_object_has_all_keys_and_they_agree() {
    let place = Place::new();
    let ran = place.run(["solve", "block.toml", "--json"]).demand(0);
    let o = ran.json();
    assert_eq!(keys(&o), sorted(KEYS));
    let contact = "length stick slip max_pressure max_pressure_unbounded force ends";
    assert_eq!(keys(&o["contact"]), sorted(contact));
    assert_eq!(keys(&o["audit"]), sorted("equilibrium penetration tension complementarity friction"));
    assert_eq!(keys(&o["seconds"]), sorted("total set_up assemble factorise solve estimate write"));
    for (key, value) in [
        ("title", json!("A block")),
        ("model", json!("bem")),
        ("file", json!("block.vtkhdf")),
        ("converged", json!(true)),
        ("reason", json!("solved")),
        ("dofs", json!(16)),
        ("steps", json!(1)),
        ("stochastic", Value::Null),
    ] {
        assert_eq!(o[key], value, "{key}");
    }
    assert_eq!(o["contact"]["ends"], Value::Null); // only refinement by hp locates them
    assert!(o["contact"]["max_pressure_unbounded"].is_boolean());
    assert!(o["iterations"].as_u64().unwrap() > 0 && o["peak_memory_bytes"].as_u64().unwrap() > 1 << 20);
    let number = |path: &str| {
        let value = o.pointer(path).and_then(Value::as_f64);
        value.unwrap_or_else(|| panic!("{path} is no number"))
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() <= 1e-11 * a.abs().max(b.abs()).max(1e-3), "{a} is not {b}");
    // J = strain energy - load work + friction work; the load on the top has the resultant (0, -2).
    close(number("/energy"), number("/strain_energy") - number("/load_work") + number("/friction_work"));
    close(number("/contact/force/0"), 0.0);
    close(number("/contact/force/1"), 2.0);
    close(number("/contact/length"), number("/contact/stick") + number("/contact/slip"));
    close(number("/contact/length"), 2.0);
    assert_eq!(o["reactions"], json!({ "floor": o["contact"]["force"] }));
    for key in keys(&o["audit"]) {
        assert!((0.0..1e-10).contains(&number(&format!("/audit/{key}"))), "{key}");
    }
    let parts: f64 = ["set_up", "assemble", "factorise", "solve", "estimate", "write"]
        .map(|k| number(&format!("/seconds/{k}")))
        .iter()
        .sum();
    assert!(0.0 < parts && parts <= number("/seconds/total"));
    // the estimate over (2 strain energy)^½; J on a much finer mesh is within the uncertainty
    close(number("/estimate_relative"), number("/estimate") / (2.0 * number("/strain_energy")).sqrt());
    let (coarse, uncertainty) = (number("/energy_extrapolated"), number("/energy_uncertainty"));
    let fine = ["method.refine=\"hp\"", "method.tolerance=1e-5"].map(|s| ["--set", s]).concat();
    let fine = place.json(0, &[&["block.toml", "--out", "fine.vtkhdf"], &fine[..]].concat());
    let off = (coarse - fine["energy"].as_f64().unwrap()).abs();
    assert!(off < uncertainty && uncertainty < 30.0 * off, "{off} {uncertainty}");
    assert_eq!(o["estimate_doubts"], json!(["sets", "coarse"]));
    let probe = o["probe"].as_array().unwrap();
    assert_eq!(probe.iter().map(|p| p["point"].clone()).collect::<Vec<_>>(), [json!([1.0, 0.5]), json!([2.0, 0.5])]);
    for p in probe {
        assert_eq!(keys(p), sorted("point displacement stress von_mises max_principal min_principal"));
        assert_eq!((p["displacement"].as_array().unwrap().len(), p["stress"].as_array().unwrap().len()), (2, 3));
    }
    assert_eq!(place.names(), ["block.toml", "block.vtkhdf", "fine.vtkhdf"]);
}

#[test]
fn without_contact_the_parts_of_contact_are_null() {
    let place = Place::new();
    let held = ["block.toml", "--set", "sides.floor={ displacement = [0, 0] }"];
    let o = place.json(0, &held);
    assert_eq!(keys(&o), sorted(KEYS));
    // the ends of the held side
    assert_eq!(o["infinite_stress"], json!([[0.0, 0.0], [2.0, 0.0]]));
    assert_eq!((&o["contact"], &o["audit"], &o["iterations"]), (&Value::Null, &Value::Null, &json!(0)));
    let [x, y] = [0, 1].map(|i| o["reactions"]["floor"][i].as_f64().unwrap());
    assert!(x.abs() < 1e-12 && (y - 2.0).abs() < 1e-12, "({x}, {y})");
    let o = place.json(0, &[&held[..], &["--set", "probe.points=[]"]].concat());
    assert_eq!(o["probe"], json!([]));
}

/// A block on rollers under a uniform load: σ_yy = -1, u = (ν(1+ν) x, -(1-ν²) y)/E in plane strain, exact on any mesh.
#[test]
fn a_linear_field_is_exact() {
    let place = Place::new();
    let rollers = ["sides.floor={ displacement = [\"free\", 0] }", "sides.left.displacement=[0, \"free\"]"];
    let solve = |mesh: &str| place.json(0, &["block.toml", "--set", rollers[0], "--set", rollers[1], "--set", mesh]);
    // the highest degree there is
    let o = solve("method={ elements = 4, degree = 64 }");
    assert_eq!(o["dofs"], 512);
    assert!((o["energy"].as_f64().unwrap() + 0.91 / 200.0).abs() < 1e-12, "{}", o["energy"]);
    let o = solve("method.elements=8");
    for p in o["probe"].as_array().unwrap() {
        let value = |key: &str, i: usize| p[key][i].as_f64().unwrap();
        let [x, y] = [0, 1].map(|i| value("point", i));
        let exact = [0.39 * x / 200.0, -0.91 * y / 200.0];
        assert!((0..2).all(|i| (value("displacement", i) - exact[i]).abs() < 1e-14), "{p} is not {exact:?}");
        assert!((0..3).all(|i| (value("stress", i) - [0.0, -1.0, 0.0][i]).abs() < 1e-11), "{p}");
    }
    // J = -½ load work = -½ · 2 · 0.91/200
    assert!((o["energy"].as_f64().unwrap() + 0.91 / 200.0).abs() < 1e-15, "{}", o["energy"]);
    let close = |side: &str, i: usize, wanted: f64| (o["reactions"][side][i].as_f64().unwrap() - wanted).abs() < 1e-12;
    assert!(close("floor", 0, 0.0) && close("floor", 1, 2.0) && close("left", 0, 0.0), "{}", o["reactions"]);
}

/// Contact that never closes is solved: no length, no force but the prescribed friction's, and zeros without a sign.
#[test]
fn contact_that_never_closes_is_solved() {
    let place = Place::new();
    let apart = ["--set", "sides.floor.contact={ gap = 1 }", "--set", "sides.left.displacement=[0, 0]"];
    let ran = place.run(["solve", "block.toml", "--json"].iter().chain(&apart)).demand(0);
    assert!(!ran.out.contains("-0.0,") && !ran.out.contains("-0.0\n"), "{}", ran.out);
    let contact = &ran.json()["contact"];
    for key in ["length", "stick", "slip", "max_pressure"] {
        assert_eq!(contact[key], json!(0.0), "{key}");
    }
    assert_eq!((&contact["force"], &contact["max_pressure_unbounded"]), (&json!([0.0, 0.0]), &json!(false)));
}

/// 3: the solver's criterion is not reached, the result is stored all the same and says why.
#[test]
fn a_solver_that_gives_up_is_status_3_with_a_result() {
    let place = Place::new();
    // an obstacle so far away that rounding hides the forces
    let o = place.json(3, &["block.toml", "--set", "sides.floor.contact.gap=1e9"]);
    assert_eq!((&o["converged"], &o["reason"]), (&json!(false), &json!("solver")));
    assert_eq!(keys(&o), sorted(KEYS));
    let failure = o["failure"].as_str().unwrap();
    assert!(failure.contains("equilibrium is off by") && failure.contains("nearer to each other"), "{failure}");
    let shown = place.run(["show", "block.vtkhdf"]).demand(0);
    assert!(shown.out.contains("NOT CONVERGED") && shown.out.contains("solver"), "{}", shown.out);
    // with --json the advice is on stderr, unless that is to be quiet; without it is part of the summary
    let far = ["block.toml", "--force", "--set", "sides.floor.contact.gap=1e9"];
    for (named, advice) in [("auto", "nearer to each other"), ("newton", "leave that at \"auto\"")] {
        let set = format!("method.solver=\"{named}\"");
        let solve = |more: &[&str]| place.run([&["solve", "--set", &set], &far[..], more].concat()).demand(3);
        assert!(solve(&["--json"]).err.contains(advice), "{named}");
        assert_eq!(solve(&["--json", "--quiet"]).err, "");
        assert!(solve(&["--quiet"]).out.contains(advice), "{named}");
        assert!(place.run(["show", "block.vtkhdf"]).demand(0).out.contains(advice), "{named}");
    }
}

#[test]
fn wrong_usage_is_status_2() {
    let place = Place::new();
    for arguments in [
        &[][..],
        &["solve"],
        &["show"],
        &["plan"],
        &["solve", "block.toml", "second.toml"],
        &["solve", "block.toml", "--tolerance", "1"],
        &["solve", "block.toml", "--out"],
        &["solve", "block.toml", "--set"],
        &["solve", "block.toml", "--save", "everything"],
        &["solve", "block.toml", "--threads", "0"],
        &["solve", "block.toml", "--threads", "two"],
        &["plan", "block.toml", "--out", "x.vtkhdf"],
        &["new", "block.toml"],
        &["gallery"],
        &["gallery", "--out", "page", "--only"],
    ] {
        let ran = place.run(arguments).demand(2);
        assert!(ran.err.contains("--help") || ran.err.contains("Usage"), "{arguments:?}: {}", ran.err);
    }
    assert_eq!(place.names(), ["block.toml"]);
    for arguments in [&["--help"][..], &["help"], &["solve", "--help"], &["study", "--help"], &["--version"]] {
        let ran = place.run(arguments).demand(0);
        assert!(ran.err.is_empty() && !ran.out.is_empty());
    }
}

#[test]
fn a_stored_run_goes_on_to_the_bits_of_an_uninterrupted_one() {
    let place = Place::new();
    place.write("block.toml", crate::place::BLOCK.replace("refine = \"none\"\n", "tolerance = 1e-4\n"));
    let whole = place.json(0, &["block.toml", "--resume"]); // there is nothing to go on from
    assert_eq!(whole["contact"]["ends"], json!([])); // the floor is in contact all along it
    for steps in [1, 3] {
        let limit = format!("method.max_steps={steps}");
        let first = place.json(3, &["block.toml", "--set", &limit]);
        assert_eq!((&first["steps"], &first["reason"]), (&json!(steps), &json!("max_steps")));
        let rest = place.json(0, &["block.toml", "--resume"]);
        for key in ["energy", "energy_extrapolated", "estimate", "dofs", "steps", "contact", "audit", "probe"] {
            assert_eq!(rest[key], whole[key], "{key}");
        }
    }
    // another scene is not the one that was stored
    let other = place.run(["solve", "block.toml", "--resume", "--set", "material.young=100"]).demand(1);
    assert!(other.err.contains("other overrides"), "{}", other.err);
}

/// Integers, numbers, texts, lists, tables, and keys that need quotes.
#[test]
fn overrides_of_every_type_reach_the_solver() {
    let place = Place::new();
    let solve = |sets: &[&str]| {
        let arguments: Vec<&str> = ["block.toml"].into_iter().chain(sets.iter().flat_map(|s| ["--set", s])).collect();
        place.json(0, &arguments)
    };
    assert_eq!(solve(&["method.elements=12", "method.degree = 2"])["dofs"], 48);
    assert_eq!(solve(&["title='Größe \"1\"'"])["title"], "Größe \"1\"");
    assert_eq!(solve(&["probe.points=[[0.5, 0.5]]"])["probe"][0]["point"], json!([0.5, 0.5]));
    assert_eq!(solve(&["body.corners.2=[2, 1]", "sides.\"left\"={ pressure = 0 }"])["dofs"], 16);
    let force = |o: &Value| o["contact"]["force"][1].as_f64().unwrap();
    assert!((force(&solve(&["sides.top.traction=[0, \"-3*F\"]", "parameters.F=0.5"])) - 3.0).abs() < 1e-11);
    // the last of two wins
    assert!((force(&solve(&["sides.top.traction.1=-2", "sides.top.traction.1=-4.0"])) - 8.0).abs() < 1e-11);
    let solvers =
        ["newton", "active-set"].map(|s| solve(&[&format!("method.solver=\"{s}\"")])["energy"].as_f64().unwrap());
    assert!((solvers[0] - solvers[1]).abs() < 1e-10 * solvers[0].abs(), "{solvers:?}");
}

#[test]
fn wrong_overrides_are_status_1() {
    let place = Place::new();
    for (set, parts) in [
        ("method.elements=\"x\"", ["method.elements depends on the place", "the names in [parameters]"]),
        ("method.elements=8.5", ["method.elements is a number", "a whole number"]),
        ("method.solver=newton", ["not TOML", "text needs quotes"]),
        ("method.solver=\"newtn\"", ["not a choice", "did you mean newton?"]),
        ("methd.elements=8", ["unknown key methd", "did you mean method?"]),
        ("method.elements", ["not of the form KEY=VALUE", "--set"]),
        ("=8", ["not of the form KEY=VALUE", "--set"]),
        ("", ["not of the form KEY=VALUE", "--set"]),
        ("sides.top.traction=[0, -1, 0]", ["has 3 entries", "one for x and one for y"]),
        ("sides.roof.traction=[0, -1]", ["no side \"roof\"", "floor, right, top, left"]),
    ] {
        let ran = place.run(["solve", "block.toml", "--set", set]).demand(1);
        for part in ["--set:1:"].iter().chain(&parts) {
            assert!(ran.err.contains(part), "{set}: no {part:?} in\n{}", ran.err);
        }
        assert_eq!(place.run(["plan", "block.toml", "--set", set]).demand(1).err, ran.err);
    }
    assert_eq!(place.names(), ["block.toml"]);
}

/// Any number of threads gives the bits of one, step by step.
#[test]
fn the_number_of_threads_changes_no_bit() {
    let place = Place::new();
    place.write("block.toml", crate::place::BLOCK.replace("refine = \"none\"\n", "tolerance = 1e-5\n"));
    let solve = |threads: &str, mesh: &[&str]| -> Map<String, Value> {
        let o = place.json(0, &[&["block.toml", "--threads", threads], mesh].concat());
        let keep = |key: &str| !["seconds", "peak_memory_bytes"].contains(&key);
        o.as_object().unwrap().iter().filter(|(key, _)| keep(key)).map(|(k, v)| (k.clone(), v.clone())).collect()
    };
    let large = ["method.refine=\"none\"", "method.elements=150", "method.degree=3"].map(|s| ["--set", s]).concat();
    for mesh in [&[][..], &large] {
        let one = solve("1", mesh);
        for threads in ["2", "3", "4"] {
            assert_eq!(solve(threads, mesh), one, "{threads} threads");
        }
    }
}

/// More than four threads a processor are not used, and the command says so.
#[test]
fn too_many_threads_are_cut() {
    let place = Place::new();
    let most = 4 * std::thread::available_parallelism().unwrap().get();
    let used = || {
        let file = steklov_io::open(place.path("block.vtkhdf")).unwrap();
        steklov_io::read_integer_attribute(&file, "threads").unwrap()
    };
    for (threads, option, told) in [(most, "--json", false), (most + 1, "--json", true), (most + 1, "--quiet", false)] {
        let ran = place.run(["solve", "block.toml", "--force", option, "--threads", &threads.to_string()]).demand(0);
        assert_eq!(used(), [most as i64]);
        assert_eq!(ran.err.contains(&format!("--threads {threads} is more than 4")), told, "{}", ran.err);
        assert_eq!(ran.err.is_empty(), !told, "{}", ran.err);
    }
}

/// Progress goes to stderr, and nowhere under --quiet.
#[test]
fn progress_is_on_stderr_only() {
    let place = Place::new();
    let long =
        ["solve", "block.toml", "--force", "--set", "method.refine=\"uniform-h\"", "--set", "method.max_dofs=1500"];
    let loud = place.run(long).demand(3);
    assert!(loud.out.starts_with("A block\n") && !loud.out.contains("step 1 "), "{}", loud.out);
    for line in loud.err.lines() {
        assert!(line.contains(" s  step "), "{line}");
    }
    let quiet = place.run(long.iter().chain(&["--quiet"])).demand(3);
    assert_eq!(quiet.err, "");
    assert!(quiet.out.starts_with("A block\n"));
}

/// Uniform strategies have no target: they end at a limit with status 3, every step is stored.
#[test]
fn uniform_strategies_end_at_their_limits() {
    let place = Place::new();
    let dofs = |steps: usize| -> Vec<usize> {
        let file = steklov_io::open(place.path("block.vtkhdf")).unwrap();
        let all = file.group("steps").unwrap().member_names().unwrap();
        assert_eq!(all, (0..steps).map(|k| format!("{k:03}")).collect::<Vec<_>>());
        let mut dofs = Vec::new();
        for name in &all {
            let step = file.group(&format!("steps/{name}")).unwrap();
            let mesh: steklov_bem_operators::Mesh = steklov_io::load(&step, "mesh").unwrap();
            dofs.push(steklov_io::load_integers(&step, "dofs").unwrap()[0]);
            assert_eq!(2 * mesh.degree.iter().sum::<usize>(), dofs[dofs.len() - 1]);
            assert!(steklov_io::load_number(&step, "energy").unwrap() < 0.0);
            assert!(!steklov_io::load_vector(&step, "history").unwrap().is_empty());
            assert_eq!(steklov_io::load_vector(&step, "seconds").unwrap().len(), 5);
        }
        dofs
    };
    for (refine, limit, reason, expected) in [
        ("uniform-h", "method.max_dofs=64", "max_dofs", &[16, 32, 64][..]),
        ("uniform-h", "method.max_dofs=63", "max_dofs", &[16, 32]),
        ("uniform-h", "method.max_steps=2", "max_steps", &[16, 32]),
        ("uniform-p", "method.max_dofs=48", "max_dofs", &[16, 32, 48]),
        ("uniform-p", "method.max_steps=1", "max_steps", &[16]),
        ("none", "method.max_steps=5", "solved", &[16]),
    ] {
        let done = reason == "solved";
        let status = if done { 0 } else { 3 };
        let o = place.json(status, &["block.toml", "--set", &format!("method.refine=\"{refine}\""), "--set", limit]);
        assert_eq!((&o["reason"], &o["converged"]), (&json!(reason), &json!(done)), "{refine} {limit}");
        assert_eq!((&o["steps"], &o["dofs"]), (&json!(expected.len()), &json!(expected[expected.len() - 1])));
        assert_eq!(dofs(expected.len()), expected);
    }
}

#[test]
fn a_scene_that_names_no_refinement_is_refined_to_its_tolerance() {
    let place = Place::new();
    place.write("block.toml", crate::place::BLOCK.replace("refine = \"none\"\n", "tolerance = 1e-2\n"));
    let o = place.json(0, &["block.toml"]);
    assert_eq!(o["reason"], json!("tolerance"));
    let relative = o["estimate_relative"].as_f64().unwrap();
    assert!(o["steps"].as_u64().unwrap() > 1 && 0.0 < relative && relative <= 1e-2, "{o}");
    let plan = place.run(["plan", "block.toml", "--json"]).demand(0).json();
    let find = |what: &str| plan["modelled"].as_array().unwrap().iter().find(|d| d["what"] == what).unwrap().clone();
    assert_eq!(find("refinement")["choice"], "hp");
    assert_eq!(find("elements")["choice"], "8");
    assert_eq!((&plan["cost"]["dofs"], &plan["cost"]["elements"]), (&json!(16), &json!(8)));
    assert_eq!(keys(&plan), sorted("model modelled left_out cost"));
    // One large mesh is not estimated; the plan says so, and that it costs less.
    let cost = |elements: usize| {
        let elements = format!("method.elements={elements}");
        let single = ["--set", "method.refine=\"none\"", "--set", &elements];
        let plan = place.run([&["plan", "block.toml", "--json"], &single[..]].concat()).demand(0).json();
        let left_out = plan["left_out"].as_array().unwrap().iter().any(|d| d["what"] == "error estimate");
        (left_out, plan["cost"]["memory_bytes"].as_f64().unwrap() / (elements.len() as f64))
    };
    let (few, many) = (cost(2000), cost(2001));
    assert!(!few.0 && many.0 && many.1 < 0.5 * few.1, "{few:?} {many:?}");
    // Fewer elements than edges are raised, and the plan says so.
    let few = place.run(["plan", "block.toml", "--set", "method.elements=1"]).demand(0).out;
    assert!(few.contains("4 elements instead of 1") && few.starts_with("A block\n"), "{few}");
    // The plan solves nothing and writes nothing.
    assert_eq!(place.names(), ["block.toml", "block.vtkhdf"]);
}

/// A reader that goes away early, as `head` does, is no error.
#[test]
fn a_closed_pipe_is_no_error() {
    let place = Place::new();
    for arguments in [&["new"][..], &["solve", "block.toml", "--quiet"]] {
        let mut child = place
            .command()
            .args(arguments)
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let ran = Ran::new(child.wait_with_output().unwrap());
        assert_eq!((ran.status, ran.err.as_str()), (0, ""));
    }
}

#[test]
fn every_text_encoding_of_a_scene_is_read_or_refused() {
    let place = Place::new();
    let energy = |o: Value| o["energy"].as_f64().unwrap();
    let wanted = energy(place.json(0, &["block.toml"]));
    place.write("windows.toml", crate::place::BLOCK.replace('\n', "\r\n"));
    place.write("marked.toml", format!("\u{feff}{}", crate::place::BLOCK));
    for scene in ["windows.toml", "marked.toml"] {
        let o = energy(place.json(0, &[scene]));
        assert!((o - wanted).abs() <= 1e-13 * wanted.abs(), "{scene}: {o} is not {wanted}");
    }
    place.write("wide.toml", crate::place::BLOCK.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>());
    let ran = place.run(["solve", "wide.toml"]).demand(1);
    assert!(ran.err.contains("wide.toml"), "{}", ran.err);
    place.write("latin.toml", b"title = \"Gr\xf6\xdfe\"\n");
    let ran = place.run(["solve", "latin.toml"]).demand(1);
    assert!(ran.err.contains("latin.toml") && ran.err.contains("UTF-8"), "{}", ran.err);
}

/// Two floors on one line, of which the second is out of reach.
#[test]
fn a_contact_side_that_nothing_touches_is_named() {
    let place = Place::new();
    let scene = r#"
body.corners = [[0,0],[1,0],[2,0],[2,1],[0,1]]
body.sides = ["near","far","right","top","left"]
material = { young = 100.0, poisson = 0.3 }
sides.near.contact = { gap = "0" }
sides.far.contact = { gap = "1" }
sides.top.displacement = ["0","-0.01"]
method.tolerance = 0.1
"#;
    place.write("floors.toml", scene);
    let told = place.run(["solve", "floors.toml", "--quiet"]).demand(0).out;
    assert!(told.contains("nothing touches side far") && !told.contains("nothing touches side near"), "{told}");
}

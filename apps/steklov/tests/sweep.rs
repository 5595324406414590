//! Sweeps as a user runs them: stopped, killed, in parts, read by pandas' columns.

use serde_json::Value;

use crate::place::{Place, Ran, Running};

const VARY: [&str; 4] = ["--vary", "parameters.F=0.1:0.6:6", "--vary", "material.poisson=0.2,0.3"];

fn sweep(place: &Place, more: &[&str]) -> Ran {
    place.run(["sweep", "block.toml", "--quiet"].iter().chain(&VARY).chain(more))
}

#[test]
fn parts_and_resumed_sweeps_are_one_run_to_the_byte() {
    let place = Place::new();
    let told = sweep(&place, &["--out", "whole.h5", "--json"]).demand(0).json();
    assert_eq!((&told["points"], &told["converged"], &told["file"]), (&12.into(), &12.into(), &"whole.h5".into()));
    sweep(&place, &["--out", "1.h5", "--part", "1/3", "--threads", "1"]).demand(0);
    sweep(&place, &["--out", "2.h5", "--part", "2/3"]).demand(0);
    let two = place.run(["merge", "2.h5", "1.h5", "--out", "two.h5", "--json"]).demand(3).json();
    assert_eq!(two["missing"], 4);
    // the parts that are there are kept, the last one is solved
    sweep(&place, &["--out", "two.h5", "--resume"]).demand(0);
    sweep(&place, &["--out", "3.h5", "--part", "3/3"]).demand(0);
    place.run(["merge", "3.h5", "1.h5", "2.h5", "--out", "three.h5"]).demand(0);
    for name in ["two", "three"] {
        for ending in ["h5", "csv"] {
            let same = place.read(&format!("{name}.{ending}")) == place.read(&format!("whole.{ending}"));
            assert!(same, "{name}.{ending} is another one than whole.{ending}");
        }
    }
    assert!(!place.names().iter().any(|name| name.ends_with("journal")), "{:?}", place.names());
}

#[cfg(unix)]
#[test]
fn a_killed_sweep_goes_on_and_a_stopped_one_is_stored() {
    let place = Place::new();
    let many = ["sweep", "block.toml", "--vary", "parameters.F=0.1:0.6:40", "--set", "method.refine=\"hp\""];
    let start = |out: &str| {
        let mut command = place.command();
        command.args(many).args(["--out", out]);
        let running = Running::start(command);
        let journal = format!("{out}.journal");
        while !place.path(&journal).exists() || place.read(&journal).iter().filter(|b| **b == b'\n').count() < 4 {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        running
    };
    let killed = start("killed.h5");
    killed.signal("KILL");
    killed.wait();
    assert!(!place.path("killed.h5").exists());
    let refused = place.run(many.iter().chain(&["--out", "killed.h5"])).demand(1);
    assert!(refused.err.contains("go on with --resume"), "{}", refused.err);

    let stopped = start("stopped.h5");
    stopped.signal("INT");
    let ran = stopped.end().demand(3);
    assert!(ran.out.contains("not solved yet") && ran.err.contains("finishing the points"), "{}{}", ran.out, ran.err);

    for out in ["killed.h5", "stopped.h5", "whole.h5"] {
        place.run(many.iter().chain(&["--quiet", "--resume", "--out", out])).demand(0);
        assert!(place.read(out) == place.read("killed.h5"), "{out}");
    }
}

#[test]
fn failed_points_are_status_3_and_files_are_not_replaced() {
    let place = Place::new();
    let failed = place.run(["sweep", "block.toml", "--quiet", "--vary", "parameters.F=-1,0.3"]).demand(3);
    assert!(failed.out.contains("point 0     parameters.F=-1: the friction bound"), "{}", failed.out);
    let again = place.run(["sweep", "block.toml", "--vary", "parameters.F=0.2,0.3"]).demand(1);
    assert!(again.err.contains("block-sweep.h5 exists"), "{}", again.err);
    place.write("points.csv", "parameters.F\n0.1\n0.2\n");
    let own = place.run(["sweep", "block.toml", "--points", "points.csv", "--out", "points.h5", "--force"]).demand(1);
    assert!(own.err.contains("would replace that of its points"), "{}", own.err);
    place.run(["sweep", "block.toml", "--points", "points.csv", "--out", "other.h5"]).demand(0);
    let other = place.run(["merge", "other.h5", "block-sweep.h5", "--out", "both.h5"]).demand(1);
    assert!(other.err.contains("is of another sweep: its points"), "{}", other.err);
    let scene = place.run(["solve", "block.toml", "--quiet"]).demand(0);
    assert!(scene.err.is_empty());
    let result = place.run(["merge", "block.vtkhdf", "--out", "both.h5"]).demand(1);
    assert!(result.err.contains("it is no sweep"), "{}", result.err);
    for wrong in [&["--vary", "parameters.F=1,2", "--part", "0/2"][..], &["--points", "a.csv", "--zip"], &[]] {
        place.run(["sweep", "block.toml"].iter().chain(wrong)).demand(2);
    }
}

#[test]
fn python_reads_the_columns_and_charts_are_drawn() {
    let place = Place::new();
    sweep(&place, &["--out", "s.h5", "--plots", "charts"]).demand(0);
    place.write(
        "read.py",
        "import csv, json, h5py\nfile = h5py.File('s.h5')\nkeys = list(file['points/keys'].asstr())\n\
         paths = list(file['quantities/paths'].asstr())\nvalues, numbers = file['points/values'][()], file['quantities/values'][()]\n\
         for k, line in enumerate(csv.DictReader(open('s.csv'))):\n    assert int(line['point']) == k\n    \
         for key, value in zip(keys, values[k]): assert float(line[key]) == value\n    \
         for path, number in zip(paths, numbers[k]):\n        \
         if line[path] == '': assert number != number and path.endswith('.uncertainty'), path\n        \
         else: assert float(line[path]) == number\n\
         answers = [json.loads(text) for text in file['points/answers'].asstr()]\n\
         print(json.dumps({'slip': [answer['contact']['slip'] for answer in answers], 'keys': keys}))\n",
    );
    let read = place.python("read.py", &[]).demand(0).json();
    let slip: Vec<f64> = read["slip"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
    // more friction, less slip, at both ratios
    assert!(
        slip.len() == 12 && slip.chunks(2).collect::<Vec<_>>().windows(2).all(|w| (0..2).all(|k| w[1][k] <= w[0][k]))
    );
    let names = crate::place::names(&place.path("charts"));
    assert!(
        ["s-contact.png", "s-energy.svg", "s-probe-1.svg"].iter().all(|name| names.contains(&(*name).to_owned())),
        "{names:?}"
    );
    let svg = String::from_utf8(place.read("charts/s-energy.svg")).unwrap();
    assert!(["parameters.F", "poisson = 0.2", "J, exact"].iter().all(|text| svg.contains(text)));
    // a component that is zero but for rounding is not drawn
    let svg = String::from_utf8(place.read("charts/s-contact.svg")).unwrap();
    assert!(svg.contains("contact.slip") && !svg.contains("contact.force.x"));
}

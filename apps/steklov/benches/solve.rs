//! Whole solves of the two contact references: wall time of a run of the command beside its error.
//!
//! `cargo bench -p steklov --bench solve`

use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Scenes and their exact J, thirteen digits.
const SCENES: [(&str, f64); 2] = [("15-block-on-floor", -2.993_329_193_070_8), ("17-wedge-gap", 0.647_194_015_986_9)];
/// Keys of a run: adaptive ones from 16 linear elements, then single meshes.
const SETTINGS: [&[&str]; 8] = [
    &["tolerance=1e-3"],
    &["tolerance=3e-4"],
    &["tolerance=3e-5"],
    &["tolerance=5e-6"],
    &["tolerance=1e-6"],
    &["refine=\"none\"", "elements=256"],
    &["refine=\"none\"", "elements=76", "degree=4"],
    &["refine=\"none\"", "elements=152", "degree=4"],
];
const RUNS: usize = 15;

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.vtkhdf");
    println!(
        "median of {RUNS} runs of `steklov solve --json`: wall milliseconds, energy error (|J - J*|/|J*|)^1/2, relative estimate in the energy norm"
    );
    for (name, exact) in SCENES {
        println!("{name}");
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"));
        for settings in SETTINGS {
            let mut times = Vec::new();
            let mut answer = serde_json::Value::Null;
            for _ in 0..RUNS {
                let start = Instant::now();
                let output = Command::new(env!("CARGO_BIN_EXE_steklov"))
                    .arg("solve")
                    .arg(&scene)
                    .args(["--json", "--quiet", "--force", "--out"])
                    .arg(&out)
                    .args(settings.iter().flat_map(|key| ["--set".to_owned(), format!("method.{key}")]))
                    .output()
                    .expect("the command runs");
                times.push(start.elapsed().as_secs_f64() * 1e3);
                answer = serde_json::from_slice(&output.stdout).expect("one JSON object");
            }
            times.sort_by(f64::total_cmp);
            let number = |key: &str| answer[key].as_f64().expect("a number");
            let error = ((number("energy") - exact) / exact).abs().sqrt();
            println!(
                "  {:32} {:5} dofs {:7.1} ms ({:.1} to {:.1})  {error:.1e}  {:.1e}",
                settings.join(" "),
                number("dofs"),
                times[RUNS / 2],
                times[0],
                times[RUNS - 1],
                number("estimate_relative"),
            );
        }
    }
}

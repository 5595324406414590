//! Whole solves of the block on a floor: wall seconds of a run of the command beside the error of its energy.
//!
//! `cargo bench -p steklov --bench solve`

use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// J of the exact solution, thirteen digits.
const EXACT: f64 = -2.993_329_193_070_8;

fn main() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/block-on-floor.toml");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("block.vtkhdf");
    println!(
        "block-on-floor, median of 9 runs of `steklov solve --json`: wall milliseconds, energy error |J - J*|/|J*|"
    );
    for (degree, elements) in [(1, 64), (1, 256), (2, 152), (4, 76), (4, 152), (8, 76)] {
        let mut times = Vec::new();
        let mut energy = 0.0;
        let mut dofs = 0;
        for _ in 0..9 {
            let start = Instant::now();
            let output = Command::new(env!("CARGO_BIN_EXE_steklov"))
                .arg("solve")
                .arg(&scene)
                .args(["--json", "--quiet", "--force", "--set"])
                .arg(format!("method.elements={elements}"))
                .arg("--set")
                .arg(format!("method.degree={degree}"))
                .arg("--out")
                .arg(&out)
                .output()
                .expect("the command runs");
            times.push(start.elapsed().as_secs_f64() * 1e3);
            let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
            energy = json["energy"].as_f64().expect("an energy");
            dofs = json["dofs"].as_u64().expect("a number");
        }
        times.sort_by(f64::total_cmp);
        let error = ((energy - EXACT) / EXACT).abs();
        println!(
            "  p = {degree}, {dofs:5} dofs: {:7.1} ms ({:.1} to {:.1}), {error:.1e}",
            times[4], times[0], times[8]
        );
    }
}

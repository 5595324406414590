//! Other programs read the command's result: h5py every path of the file, VTK the body.

mod place;

use std::path::PathBuf;
use std::process::Command;

use place::{Place, Ran};

/// Runs a script of `tests/python` in the private Python environment, which must be there.
fn python(script: &str, place: &Place, arguments: &[&str]) {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let python =
        std::env::var_os("STEKLOV_PYTHON").map_or_else(|| here.join("../../target/python/bin/python"), PathBuf::from);
    let mut run = Command::new(&python);
    run.arg(here.join("tests/python").join(script)).args(arguments).current_dir(place.path(""));
    let remedy = "`scripts/python-env target/python numpy h5py vtk` makes the environment";
    let output = run.output().unwrap_or_else(|e| panic!("no Python at {}: {e}; {remedy}", python.display()));
    let Ran { status, out, err } = Ran::new(output);
    let remedy = if err.contains("ModuleNotFoundError") { remedy } else { "" };
    assert!(status == 0, "{script} failed; {remedy}\n{out}\n{err}");
}

/// The block on the floor, stored with its matrices after two steps, and what the command said of it.
fn block_on_floor() -> Place {
    let place = Place::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/block-on-floor.toml");
    let steps = [
        "--set",
        "method.refine=\"uniform-h\"",
        "--set",
        "method.max_steps=2",
        "--set",
        "method.elements=32",
        "--set",
        "method.degree=4",
    ];
    let probe = ["--set", "probe.points=[[0, 0], [0.5, 0.1]]", "--save", "matrices"];
    let solve = ["solve", scene, "--json", "--quiet", "--out", "block.vtkhdf"];
    let told = place.run([&solve[..], &steps, &probe].concat()).demand(3).out;
    place.write("told.json", told);
    place
}

#[test]
fn h5py_reads_every_path_of_the_file() {
    python("read_result.py", &block_on_floor(), &["block.vtkhdf", "told.json"]);
}

#[test]
fn h5py_reads_symmetric_matrices_with_the_rigid_motions_in_their_kernel() {
    python("read_matrices.py", &block_on_floor(), &["block.vtkhdf"]);
}

#[test]
fn vtk_reads_the_body() {
    python("read_body.py", &block_on_floor(), &["block.vtkhdf"]);
}

//! Results on grids: other programs read them, they are shown as they were told, an interrupted run goes on with the same bits,
//! and what is damaged is refused.

use std::path::PathBuf;
use std::process::Command;

use crate::place::{Place, Ran};
use serde_json::Value;
use steklov_io::{
    File, Group, IoError, Label, copy, create_atomically, load_dense, load_points, load_vector, open, open_group,
    save_dense, save_integers, save_points, save_vector, vtkhdf,
};

/// An L of 16 × 16 fine cells without the upper right quarter, glued at the left, on a floor with friction.
const L: &str = r#"title = "L"
[body]
corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
sides = ["floor", "right", "step", "inner", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.25, young = "1 + x + 10*y" }
[sides.floor]
contact = { gap = "0", friction = { tresca = "0.02" } }
[sides.left]
displacement = [0, 0]
[sides.top]
traction = ["0.01", "-0.1"]
[probe]
points = [[0.3, 0.7], [2, 1]]
[grid]
coarse = [8, 8]
fine = [2, 2]
[method]
refine = "none"
"#;

fn with(set: &[&str]) -> (Place, Value) {
    let place = Place::new();
    place.write("l.toml", L);
    let sets = set.iter().flat_map(|s| ["--set", s]);
    let solve = ["solve", "l.toml", "--json", "--quiet", "--save", "matrices"];
    let ran = place.run(solve.into_iter().chain(sets)).demand(0);
    place.write("told.json", &ran.out);
    (place, ran.json())
}

/// What `show` and `solve` tell is the same object, but for the clock.
#[test]
fn the_result_is_shown_as_it_was_told() {
    for model in ["fem", "msfem"] {
        let (place, mut told) = with(&[&format!("method.model=\"{model}\"")]);
        let mut shown = place.run(["show", "l.vtkhdf", "--json"]).demand(0).json();
        assert!(told["seconds"]["total"].as_f64() > Some(0.0) && told["grid"].is_object());
        [&mut told, &mut shown].into_iter().for_each(|o| {
            o.as_object_mut().unwrap().remove("seconds");
        });
        assert_eq!(told, shown, "{model}");
    }
}

#[test]
fn h5py_reads_the_grid_and_matrices_with_rigid_motions_in_their_kernel() {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let python =
        std::env::var_os("STEKLOV_PYTHON").map_or_else(|| here.join("../../target/python/bin/python"), PathBuf::from);
    for model in ["fem", "msfem"] {
        let (place, _) = with(&[&format!("method.model=\"{model}\"")]);
        let mut run = Command::new(&python);
        run.arg(here.join("tests/python/read_grid.py")).args(["l.vtkhdf", "told.json"]).current_dir(place.path(""));
        let output = run.output().unwrap_or_else(|e| panic!("no Python at {}: {e}", python.display()));
        let Ran { status, out, err } = Ran::new(output);
        assert!(status == 0, "{model}: read_grid.py failed\n{out}\n{err}");
    }
}

/// All numbers of a result that do not depend on the clock, by their bits.
fn bits(place: &Place, name: &str) -> Vec<u64> {
    let file = open(place.path(name)).unwrap();
    let steps = open_group(&file, "steps").unwrap();
    let mut all = Vec::new();
    for name in steps.member_names().unwrap() {
        let step = open_group(&steps, &name).unwrap();
        for vector in ["energy", "strain_energy", "history", "estimate", "estimate_terms", "indicators/squared"] {
            all.extend(load_vector(&step, vector).unwrap());
        }
        let cells = load_dense(&step, "coarse_cells").unwrap();
        all.extend((0..cells.nrows()).flat_map(|i| (0..4).map(|j| cells[(i, j)]).collect::<Vec<_>>()));
    }
    let fields = vtkhdf::read(&file).unwrap();
    fields.point_data.iter().chain(&fields.cell_data).for_each(|f| all.extend(&f.values));
    let at = open_group(&file, "multiscale").unwrap();
    all.extend(load_points(&at, "vertex_displacement").unwrap().as_flattened());
    all.into_iter().map(f64::to_bits).collect()
}

#[test]
fn an_adaptive_run_that_goes_on_has_the_bits_of_one_that_never_stopped() {
    let place = Place::new();
    place.write(
        "l.toml",
        L.replace("refine = \"none\"", "refine = \"h\"\ntolerance = 1e-6").replace("[2, 2]\n[m", "[8, 8]\n[m"),
    );
    let solve = |steps: usize, arguments: &[&str]| {
        let limit = format!("method.max_steps={steps}");
        place.run(["solve", "l.toml", "--json", "--quiet", "--set", &limit].iter().chain(arguments)).demand(3).json()
    };
    let whole = solve(4, &["--out", "whole.vtkhdf"]);
    assert_eq!((&whole["steps"], &whole["reason"]), (&4.into(), &"max_steps".into()));
    solve(1, &[]);
    assert!(bits(&place, "l.vtkhdf") != bits(&place, "whole.vtkhdf"));
    for steps in [3, 4] {
        solve(steps, &["--resume"]);
    }
    assert!(bits(&place, "l.vtkhdf") == bits(&place, "whole.vtkhdf"));
    let told = |name: &str| {
        let mut o = place.run(["show", name, "--json"]).demand(0).json();
        ["seconds", "file", "peak_memory_bytes"].iter().for_each(|key| drop(o.as_object_mut().unwrap().remove(*key)));
        o
    };
    assert_eq!(told("l.vtkhdf"), told("whole.vtkhdf"));
}

#[test]
fn changed_bytes_and_cut_files_are_refused_or_change_nothing() {
    let (place, _) = with(&[]);
    let sound = place.read("l.vtkhdf");
    let show = || place.run(["show", "broken.vtkhdf", "--json"]);
    let (mut refused, count) = (0, 60);
    place.write("broken.vtkhdf", &sound);
    let told = show().demand(0).out;
    for k in 0..count {
        let mut bytes = sound.clone();
        let at = k * (bytes.len() - 1) / (count - 1);
        bytes[at] ^= 0x10;
        place.write("broken.vtkhdf", &bytes);
        let ran = show();
        assert!(!ran.err.contains("panicked"), "byte {at}: {}", ran.err);
        match ran.status {
            0 => assert_eq!(ran.out, told, "byte {at}"),
            _ => refused += usize::from(ran.demand(1).err.contains("broken.vtkhdf")),
        }
        place.write("broken.vtkhdf", &sound[..at]);
        assert!(show().demand(1).err.contains("broken.vtkhdf"), "cut to {at} bytes");
    }
    assert!(refused > count / 4, "{refused} of {count}");
}

fn at<'a>(file: &File, path: &'a str) -> (Group, &'a str) {
    let (group, name) = path.rsplit_once('/').unwrap();
    let group = open_group(file, group).unwrap();
    group.unlink(name).unwrap();
    (group, name)
}

fn vector(file: &File, path: &str, values: &[f64]) -> Result<(), IoError> {
    let (group, name) = at(file, path);
    save_vector(&group, name, values, &Label { unit: "1", meaning: "changed", axes: &["entry"] })
}

fn integers(file: &File, path: &str, values: &[usize]) -> Result<(), IoError> {
    let (group, name) = at(file, path);
    save_integers(&group, name, values, &Label { unit: "1", meaning: "changed", axes: &["entry"] })
}

fn cells(file: &File, path: &str, of: impl Fn(usize) -> [usize; 4], n: usize) -> Result<(), IoError> {
    let (group, name) = at(file, path);
    let table = faer::Mat::from_fn(n, 4, |i, j| of(i)[j] as f64);
    save_dense(&group, name, table.as_ref(), &Label { unit: "1", meaning: "changed", axes: &["row", "column"] })
}

/// A change of a stored file, and what the message about it says.
type Change = (fn(&File) -> Result<(), IoError>, &'static [&'static str]);

const CHANGES: &[Change] = &[
    (|f| vector(f, "multiscale/spacing", &[0.0, 0.125]), &["/multiscale", "length 0"]),
    (|f| vector(f, "multiscale/spacing", &[0.125]), &["/multiscale/spacing", "1 numbers, not 2"]),
    (|f| vector(f, "multiscale/origin", &[f64::NAN, 0.0]), &["/multiscale", "coordinate NaN"]),
    (|f| integers(f, "multiscale/cells", &[1 << 40, 1 << 40]), &["/multiscale/rows", "256 numbers"]),
    (|f| integers(f, "multiscale/cells", &[8, 32]), &["/multiscale/rows", "not the quadrilaterals"]),
    (|f| integers(f, "multiscale/rows", &[0; 256]), &["/multiscale/rows", "none of 16 by 16"]),
    (|f| integers(f, "multiscale/rows", &[1; 256]), &["/multiscale/rows", "not the quadrilaterals"]),
    (|f| vector(f, "multiscale/elasticity/poisson", &[0.5]), &["/multiscale/elasticity/poisson", "0.5"]),
    (|f| vector(f, "VTKHDF/CellData/young", &[-1.0; 256]), &["/multiscale", "-1"]),
    (|f| cells(f, "multiscale/coarse_cells", |_| [0, 0, 2, 2], 48), &["/multiscale/coarse_cells", "overlaps another"]),
    (|f| cells(f, "multiscale/coarse_cells", |_| [0, 0, 0, 0], 48), &["/multiscale/coarse_cells", "0 by 0"]),
    (
        |f| cells(f, "multiscale/coarse_cells", |_| [0, 0, 1 << 31, 2], 48),
        &["/multiscale/coarse_cells", "leaves the body"],
    ),
    (
        // halves of the body, in place of the cells that were solved
        |f| cells(f, "multiscale/coarse_cells", |i| [[0, 0, 8, 8], [0, 8, 8, 8], [8, 0, 8, 8]][i], 3),
        &["/multiscale/vertex_displacement", "of 8 vertices"],
    ),
    (|f| cells(f, "steps/000/coarse_cells", |_| [0, 0, 2, 2], 48), &["/multiscale", "those of the last step"]),
    (
        |f| {
            let (group, name) = at(f, "multiscale/vertex_displacement");
            save_points(&group, name, &[[0.0; 2]], &Label { unit: "1", meaning: "changed", axes: &["row", "column"] })
        },
        &["/multiscale/vertex_displacement", "1 of 65 vertices"],
    ),
    (
        |f| vector(f, "steps/000/indicators/squared", &[1.0; 47]),
        &["/steps/000/indicators/squared", "47 indicators of 48"],
    ),
    (|f| integers(f, "steps/000/parts", &[0]), &["/steps/000/parts", "0 parts"]),
    (|f| f.unlink("multiscale/elasticity").map_err(|e| panic!("{e}")), &["has no", "/multiscale/elasticity"]),
];

/// Files whose checksums are right, but not their content.
#[test]
fn parts_that_do_not_fit_are_refused() {
    let (place, _) = with(&[]);
    let altered = |change: fn(&File) -> Result<(), IoError>| {
        let sound = open(place.path("l.vtkhdf")).unwrap();
        create_atomically(place.path("altered.vtkhdf"), true, |file| -> Result<(), IoError> {
            let root: &Group = &sound;
            root.member_names().unwrap().iter().try_for_each(|name| copy(root, name, file))?;
            change(file)
        })
        .unwrap();
    };
    altered(|_| Ok(()));
    place.run(["show", "altered.vtkhdf", "--plots", "pictures"]).demand(0);
    let mut wrong = String::new();
    for (change, parts) in CHANGES {
        altered(*change);
        let ran = place.run(["show", "altered.vtkhdf", "--plots", "other"]);
        let told = parts.iter().chain(&["error: ", "altered.vtkhdf"]).all(|part| ran.err.contains(part));
        if ran.status != 1 || !ran.out.is_empty() || !told {
            wrong += &format!("{parts:?}: status {}\n{}\n", ran.status, ran.err);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(!place.path("other").exists());
}

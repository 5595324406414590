//! Results of bodies in a medium: other programs read them, they are shown as they were told, an interrupted run goes on with
//! the same bits, and what is damaged is refused.

use std::path::PathBuf;
use std::process::Command;

use crate::place::{Place, Ran};
use serde_json::Value;
use steklov_bem_operators::Mesh;
use steklov_coupling::InterfaceIndicators;
use steklov_io::{
    File, Group, IoError, Label, copy, create_atomically, load, load_dense, load_points, load_vector, open, open_group,
    save, save_dense, save_points, save_vector, vtkhdf,
};

/// A stiff square that is too large for its hole along x and too small along y, under remote stress.
const SQUARE: &str = r#"title = "square"
[body]
corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 10
poisson = 0.3
[exterior]
young = 2
poisson = 0.3
remote_stress = [1, -0.5, 0.25]
displacement_jump = ["-0.01*x", "0.02*y"]
[grid]
coarse = [4, 4]
fine = [2, 2]
[probe]
points = [[0.1, 0.2], [0.7, 0.4]]
[method]
refine = "none"
"#;

const MODELS: [&str; 2] = ["fem-bem", "msfem-bem"];

fn solved(model: &str) -> (Place, Value) {
    let place = Place::new();
    place.write("square.toml", SQUARE);
    let model = format!("method.model=\"{model}\"");
    let ran = place.run(["solve", "square.toml", "--json", "--quiet", "--save", "matrices", "--set", &model]).demand(0);
    place.write("told.json", &ran.out);
    (place, ran.json())
}

#[test]
fn the_result_is_shown_as_it_was_told() {
    for model in MODELS {
        let (place, mut told) = solved(model);
        let mut shown = place.run(["show", "square.vtkhdf", "--json"]).demand(0).json();
        assert!(told["exterior"].is_object() && told["grid"]["estimate_medium"].as_f64() > Some(0.0), "{model}");
        [&mut told, &mut shown].into_iter().for_each(|o| drop(o.as_object_mut().unwrap().remove("seconds")));
        assert_eq!(told, shown, "{model}");
    }
}

#[test]
fn other_programs_read_body_and_medium_and_the_matrices_of_the_interface() {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let python =
        std::env::var_os("STEKLOV_PYTHON").map_or_else(|| here.join("../../target/python/bin/python"), PathBuf::from);
    for model in MODELS {
        let (place, _) = solved(model);
        let mut run = Command::new(&python);
        let script = here.join("tests/python/read_coupled.py");
        run.arg(script).args(["square.vtkhdf", "told.json"]).current_dir(place.path(""));
        let output = run.output().unwrap_or_else(|e| panic!("no Python at {}: {e}", python.display()));
        let Ran { status, out, err } = Ran::new(output);
        assert!(status == 0, "{model}: read_coupled.py failed\n{out}\n{err}");
    }
}

/// All numbers of a result that do not depend on the clock, by their bits; the boundary elements of the steps that were halved.
fn bits(place: &Place, name: &str) -> (Vec<u64>, Vec<Mesh>) {
    let file = open(place.path(name)).unwrap();
    let steps = open_group(&file, "steps").unwrap();
    let (mut all, mut meshes) = (Vec::new(), Vec::new());
    for name in steps.member_names().unwrap() {
        let step = open_group(&steps, &name).unwrap();
        for vector in ["energy", "strain_energy", "estimate", "estimate_terms", "indicators/squared"] {
            all.extend(load_vector(&step, vector).unwrap());
        }
        let terms: InterfaceIndicators = load(&step, "interface").unwrap();
        all.extend([terms.traction, terms.displacement, terms.traction_error].concat());
        let cells = load_dense(&step, "coarse_cells").unwrap();
        all.extend((0..cells.nrows()).flat_map(|i| (0..4).map(|j| cells[(i, j)]).collect::<Vec<_>>()));
        if step.link_exists("boundary_elements") {
            meshes.push(load(&step, "boundary_elements").unwrap());
        }
    }
    let fields = vtkhdf::read(&file).unwrap();
    fields.point_data.iter().chain(&fields.cell_data).for_each(|f| all.extend(&f.values));
    let at = open_group(&file, "coupling").unwrap();
    for name in ["points", "displacement", "traction"] {
        all.extend(load_points(&at, name).unwrap().as_flattened());
    }
    (all.into_iter().map(f64::to_bits).collect(), meshes)
}

#[test]
fn an_adaptive_run_that_goes_on_has_the_bits_of_one_that_never_stopped() {
    let place = Place::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/42-stiff-inclusion-of-random-cells.toml");
    place.write("random.toml", std::fs::read(scene).unwrap());
    let solve = |steps: usize, arguments: &[&str]| {
        let steps = format!("method.max_steps={steps}");
        let sets = ["grid.fine=[4, 4]", "method.marking=0.8", "method.tolerance=1e-6", &steps];
        let sets = sets.into_iter().flat_map(|s| ["--set", s]);
        let solve = ["solve", "random.toml", "--json", "--quiet"];
        place.run(solve.into_iter().chain(sets).chain(arguments.iter().copied())).demand(3).json()
    };
    let whole = solve(4, &["--out", "whole.vtkhdf"]);
    assert_eq!((&whole["steps"], &whole["reason"]), (&4.into(), &"max_steps".into()));
    solve(1, &[]);
    let wanted = bits(&place, "whole.vtkhdf");
    assert!(bits(&place, "random.vtkhdf") != wanted);
    for steps in [3, 4] {
        solve(steps, &["--resume"]);
    }
    assert!(bits(&place, "random.vtkhdf") == wanted);
    // elements were halved, so that some are shorter than others on the same side
    let halved = wanted.1.last().expect("boundary elements that are halved");
    let lengths: Vec<f64> = (0..halved.len()).map(|e| halved.length(e)).collect();
    let [least, most] = [f64::min, f64::max].map(|pick| lengths.iter().copied().reduce(pick).unwrap());
    assert!(most > 1.9 * least, "{least} to {most}");
    let told = |name: &str| {
        let mut o = place.run(["show", name, "--json"]).demand(0).json();
        ["seconds", "file", "peak_memory_bytes"].iter().for_each(|key| drop(o.as_object_mut().unwrap().remove(*key)));
        o
    };
    assert_eq!(told("random.vtkhdf"), told("whole.vtkhdf"));
}

/// A bit of the data of every part of `/coupling`, wherever the same numbers lie in the file, and cut files.
#[test]
fn changed_bytes_of_the_medium_and_cut_files_are_refused() {
    let (place, _) = solved("msfem-bem");
    let sound = place.read("square.vtkhdf");
    let file = open(place.path("square.vtkhdf")).unwrap();
    let show = |bytes: &[u8]| {
        place.write("broken.vtkhdf", bytes);
        place.run(["show", "broken.vtkhdf", "--json"])
    };
    let told = show(&sound).demand(0).out;
    for name in ["points", "displacement", "traction", "exterior/points", "exterior/displacement", "exterior/stress"] {
        let at = open_group(&file, "coupling").unwrap();
        let row: Vec<f64> = match name {
            "exterior/stress" => load_dense(&at, name).unwrap().row(7).iter().copied().collect(),
            _ => load_points(&at, name).unwrap()[6..8].as_flattened().to_vec(),
        };
        let row: Vec<u8> = row.iter().flat_map(|x| x.to_le_bytes()).collect();
        let places = (0..sound.len() - row.len()).filter(|&k| sound[k..].starts_with(&row));
        let refused: Vec<String> = places
            .filter_map(|k| {
                let mut bytes = sound.clone();
                bytes[k + 3] ^= 1;
                let ran = show(&bytes);
                // parts that are not shown, as the matrices, change nothing
                if ran.status == 0 {
                    assert_eq!(ran.out, told, "{name}");
                    return None;
                }
                Some(ran.demand(1).err)
            })
            .collect();
        let here = format!("/coupling/{name} ");
        assert!(refused.iter().any(|err| err.contains(&here) && err.contains("damaged")), "{name}: {refused:?}");
    }
    for k in 0..40 {
        assert!(show(&sound[..k * (sound.len() - 1) / 39]).demand(1).err.contains("broken.vtkhdf"));
    }
}

fn unlinked(file: &File, path: &str) -> Group {
    let (group, name) = path.rsplit_once('/').unwrap_or(("/", path));
    let group = open_group(file, group).unwrap();
    group.unlink(name).unwrap();
    group
}

fn removed(file: &File, path: &str) -> Result<(), IoError> {
    unlinked(file, path);
    Ok(())
}

fn vector(file: &File, path: &str, values: &[f64]) -> Result<(), IoError> {
    let name = path.rsplit('/').next().unwrap();
    save_vector(&unlinked(file, path), name, values, &Label { unit: "1", meaning: "changed", axes: &["entry"] })
}

const TABLE: Label<'static> = Label { unit: "1", meaning: "changed", axes: &["row", "column"] };

/// Rows of two numbers after a change.
fn points(file: &File, path: &str, change: impl Fn(&mut Vec<[f64; 2]>)) -> Result<(), IoError> {
    let (group, name) = path.rsplit_once('/').unwrap();
    let mut values = load_points(&open_group(file, group)?, name)?;
    change(&mut values);
    save_points(&unlinked(file, path), name, &values, &TABLE)
}

/// A table after a change of its shape or one of its numbers.
fn table(file: &File, path: &str, rows: usize, change: impl Fn(usize, usize, f64) -> f64) -> Result<(), IoError> {
    let (group, name) = path.rsplit_once('/').unwrap();
    let old = load_dense(&open_group(file, group)?, name)?;
    let new = faer::Mat::from_fn(old.nrows() - rows, old.ncols(), |i, j| change(i, j, old[(i, j)]));
    save_dense(&unlinked(file, path), name, new.as_ref(), &TABLE)
}

/// A change of a stored file, and what the message about it says.
type Change = (fn(&File) -> Result<(), IoError>, &'static [&'static str]);

const CHANGES: &[Change] = &[
    (|f| removed(f, "coupling"), &["has no /coupling"]),
    (|f| removed(f, "coupling/material"), &["has no /coupling/material"]),
    (|f| removed(f, "coupling/traction"), &["has no /coupling/traction"]),
    (|f| removed(f, "coupling/exterior"), &["has no /coupling/exterior"]),
    (|f| vector(f, "coupling/material/young", &[-2.0]), &["/coupling/material", "-2"]),
    (
        |f| {
            let mut mesh: Mesh = load(&open_group(f, "coupling")?, "mesh")?;
            mesh.degree[3] = 2;
            save(&unlinked(f, "coupling/mesh"), "mesh", &mesh)
        },
        &["/coupling/points", "nodes of its mesh"],
    ),
    (|f| points(f, "coupling/points", |x| x[2][0] += 1e-9), &["/coupling/points", "nodes of its mesh"]),
    (|f| points(f, "coupling/displacement", |u| u[2][0] = f64::NAN), &["/coupling/displacement", "NaN is not finite"]),
    (
        |f| points(f, "coupling/displacement", |u| u.truncate(u.len() - 1)),
        &["/coupling/displacement", "30 numbers, not 32"],
    ),
    (|f| points(f, "coupling/traction", |t| t.push([0.0; 2])), &["/coupling/traction", "34 numbers, not 32"]),
    (|f| vector(f, "coupling/constant", &[0.0; 3]), &["/coupling/constant", "3 numbers, not 2"]),
    (|f| vector(f, "coupling/constant", &[0.0, 1e-9]), &["/coupling/constant", "the summary tells"]),
    (|f| vector(f, "coupling/resultant", &[1.0, 0.0]), &["/coupling/resultant", "the summary tells"]),
    (|f| vector(f, "coupling/length", &[2.0]), &["/coupling/length", "the summary tells"]),
    (|f| vector(f, "coupling/length", &[f64::INFINITY]), &["/coupling/length", "inf is not finite"]),
    (|f| vector(f, "coupling/remote_stress", &[1.0; 2]), &["/coupling/remote_stress", "2 numbers, not 3"]),
    (|f| points(f, "coupling/exterior/points", |x| x[9][1] += 1e-9), &["/coupling/exterior/points", "/VTKHDF"]),
    (|f| points(f, "coupling/exterior/points", |x| x.truncate(x.len() - 1)), &["/coupling/exterior/points", "/VTKHDF"]),
    (
        |f| points(f, "coupling/exterior/displacement", |u| u[9][1] = f64::NAN),
        &["/coupling/exterior/displacement", "/VTKHDF"],
    ),
    (
        |f| points(f, "coupling/exterior/displacement", |u| u.truncate(u.len() - 1)),
        &["/coupling/exterior/displacement", "/VTKHDF"],
    ),
    (|f| table(f, "coupling/exterior/stress", 1, |_, _, s| s), &["/coupling/exterior/stress", "×3, not"]),
    (
        |f| table(f, "coupling/exterior/triangles", 0, |i, j, k| if (i, j) == (5, 1) { k + 0.5 } else { k }),
        &["/coupling/exterior/triangles", "/VTKHDF"],
    ),
    (
        |f| table(f, "coupling/exterior/triangles", 0, |i, _, k| if i == 5 { f64::NAN } else { k }),
        &["/coupling/exterior/triangles", "/VTKHDF"],
    ),
    (
        |f| {
            // a triangle on nodes of the body
            let mut grid = vtkhdf::read(f)?;
            grid.triangles[0] = [0, 1, 2];
            unlinked(f, "VTKHDF");
            vtkhdf::write(f, &grid)
        },
        &["/coupling/exterior/triangles", "/VTKHDF"],
    ),
    (
        |f| {
            // the medium taken away, its triangles left
            let mut grid = vtkhdf::read(f)?;
            grid.triangles[0] = [0, 1, 2];
            grid.cell_data.retain(|field| field.name != "region");
            unlinked(f, "VTKHDF");
            unlinked(f, "coupling");
            vtkhdf::write(f, &grid)
        },
        &["/multiscale/rows", "not the quadrilaterals"],
    ),
    (
        |f| vector(f, "steps/000/interface/displacement", &[1.0; 3]),
        &["/steps/000/interface/displacement", "3 entries where 16"],
    ),
    (
        |f| vector(f, "steps/000/interface/traction_error", &[-1.0; 16]),
        &["/steps/000/interface/traction_error", "square of an energy"],
    ),
];

/// Files whose checksums are right, but not their content.
#[test]
fn parts_that_do_not_fit_are_refused() {
    let (place, _) = solved("msfem-bem");
    let altered = |change: fn(&File) -> Result<(), IoError>| {
        let sound = open(place.path("square.vtkhdf")).unwrap();
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

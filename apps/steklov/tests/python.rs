//! Other programs read the command's result: h5py every path of the file, VTK the body.

use crate::check_result::checked;
use crate::place::Place;

/// Runs a script of `tests/python`, which must succeed.
fn python(script: &str, place: &Place, arguments: &[&str]) {
    let script = format!("{}/tests/python/{script}", env!("CARGO_MANIFEST_DIR"));
    place.python(&script, arguments).demand(0);
}

/// Runs `docs/check_result.py`, which must find of each file that all of these hold, by the first words of its lines.
fn check_results(place: &Place, files: &[String], wanted: &[&[&str]]) {
    for ((file, (status, said)), wanted) in files.iter().zip(checked(place, files)).zip(wanted) {
        assert_eq!(status, 0, "{file}:\n{said}");
        for what in *wanted {
            assert!(said.lines().any(|line| line.starts_with(what)), "{file}: {what} is not checked:\n{said}");
        }
    }
}

/// Solves scenes of the gallery, each with some arguments of its own and some of all, and checks their results.
fn results_hold(scenes: &[(&str, &[&str], &[&str])], of_all: &[&str]) {
    let place = Place::new();
    let files: Vec<String> = (0..scenes.len()).map(|k| format!("{k}.vtkhdf")).collect();
    for ((name, own, _), file) in scenes.iter().zip(&files) {
        let scene = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        place.run([&["solve", &scene, "--quiet", "--out", file], of_all, own].concat());
    }
    let wanted: Vec<&[&str]> = scenes.iter().map(|(.., wanted)| *wanted).collect();
    check_results(&place, &files, &wanted);
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
fn matrices_of_a_body_make_its_steklov_poincare_matrix() {
    let place = block_on_floor();
    check_results(&place, &["block.vtkhdf".to_owned()], &[&["V  ", "W  ", "(M/2 + K)", "S  ", "strain energy"]]);
    python("stiffness_of_block.py", &place, &["block.vtkhdf"]);
}

#[test]
fn vtk_reads_the_body() {
    python("read_body.py", &block_on_floor(), &["block.vtkhdf"]);
}

#[test]
fn h5py_reads_the_outcomes_of_random_input() {
    let place = Place::new();
    let random = "[random.rough]\ncovariance = \"exponential\"\ncorrelation = 0.5\non = \"floor\"\nmodes = 2\n\
                  [random.p]\ndistribution = \"uniform\"\nlow = 0.8\nhigh = 1.2\n\
                  [stochastic]\ndegree = 2\nsamples = 400\n";
    let scene = crate::place::BLOCK.replace("gap = \"0\"", "gap = \"0.01*(x-1)^2 + 0.001*rough\"");
    place.write("rough.toml", scene.replace("[\"0\", \"-1\"]", "[\"0\", \"-p\"]") + random);
    let told = place.run(["solve", "rough.toml", "--json", "--quiet"]).demand(0).out;
    place.write("told.json", told);
    python("read_stochastic.py", &place, &["rough.vtkhdf", "told.json"]);
}

#[test]
fn h5py_reads_contact_problems_that_their_solutions_solve() {
    let names = ["block-on-floor", "25-coulomb-wedge", "60-two-cylinders", "37-block-of-random-cells"];
    let scenes = names.map(|name| (name, &[][..], &["contact problem", "contact  "][..]));
    results_hold(&scenes, &["--set", "method.max_steps=3", "--save", "contact"]);
}

#[test]
fn h5py_reads_stabilised_multipliers_that_obey_their_equations() {
    let forms = ["--set", "method.multiplier=\"stabilised\"", "--set", "method.max_steps=3", "--save", "stabilisation"];
    let weight = ["--set", "body_force.value=[\"0.1\", \"-0.3\"]"];
    let scenes: [(&str, &[&str]); 4] =
        [("17-wedge-gap", &[]), ("25-coulomb-wedge", &[]), ("57-hertz-cylinder", &[]), ("15-block-on-floor", &weight)];
    results_hold(&scenes.map(|(name, more)| (name, more, &["stabilisation", "stabilised contact"][..])), &forms);
}

#[test]
fn h5py_rebuilds_coarse_stiffness_from_multiscale_bases() {
    let of = |key: &str, value: &str| ["--set".to_owned(), format!("{key}={value}")];
    let bases = ["q1", "linear", "coupled", "oscillatory", "oversampled", "periodic"];
    let checkerboard = bases.map(|basis| (basis, "35-checkerboard", 1, ""));
    let adapted = ["linear", "oscillatory"].map(|basis| (basis, "38-l-shape-of-random-cells", 4, "hanging"));
    let others = [("oscillatory", "34-laminate", 1, ""), ("coupled", "42-stiff-inclusion-of-random-cells", 1, "")];
    let place = Place::new();
    let (mut files, mut arguments) = (Vec::new(), Vec::new());
    for (k, (basis, name, steps, hanging)) in checkerboard.into_iter().chain(adapted).chain(others).enumerate() {
        let file = format!("{k}.vtkhdf");
        let scene = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let sets = [
            of("grid.basis", &format!("\"{basis}\"")),
            of("grid.fine", "[4, 4]"),
            of("method.max_steps", &steps.to_string()),
        ];
        let save = ["solve", &scene, "--quiet", "--save", "matrices,basis", "--out", &file].map(str::to_owned);
        place.run(save.into_iter().chain(sets.into_iter().flatten()));
        arguments.extend([file.clone(), hanging.to_owned()]);
        files.push(file);
    }
    check_results(&place, &files, &vec![&["basis", "equilibrium"][..]; files.len()]);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    python("rigid_motions_of_basis.py", &place, &arguments);
}

/// A run that is stopped after two steps and goes on has what an uninterrupted one has.
#[test]
fn all_that_is_saved_stays_when_a_run_goes_on() {
    let stabilised = ["matrices", "contact_problem", "stabilisation"];
    let rough = ["--set", "random.rough.modes=2", "--set", "method.tolerance=1e-3"];
    let outcomes = ["stochastic/outcomes", "stochastic/cells", "stochastic/eigenpairs"];
    let scenes: [(&str, &[&str], &[&str]); 3] = [
        ("30-rough-obstacle", &rough, &[&["matrices", "contact_problem"][..], &outcomes].concat()),
        ("17-wedge-gap", &["--set", "method.multiplier=\"stabilised\""], &stabilised),
        ("38-l-shape-of-random-cells", &["--set", "grid.fine=[4, 4]"], &["matrices", "basis"]),
    ];
    for (name, sets, expected) in scenes {
        let place = Place::new();
        let scene = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let solve = |out: &str, steps: usize, more: &[&str]| {
            let steps = format!("method.max_steps={steps}");
            let settings = ["--quiet", "--out", out, "--set", &steps];
            place.run([&["solve", &scene], &settings[..], sets, more].concat());
        };
        solve("whole.vtkhdf", 4, &["--save", "all"]);
        solve("parts.vtkhdf", 2, &["--save", "all"]);
        solve("parts.vtkhdf", 4, &["--save", "all", "--resume"]);
        python("same_saved.py", &place, &[&["whole.vtkhdf", "parts.vtkhdf"], expected].concat());
        // the same steps once more: what is not asked for again is kept
        solve("parts.vtkhdf", 4, &["--resume"]);
        python("same_saved.py", &place, &[&["whole.vtkhdf", "parts.vtkhdf"], expected].concat());
    }
}

#[test]
fn h5py_rebuilds_stochastic_masses_and_moments_from_outcomes() {
    let cells = ["outcomes", "stochastic cells"];
    let modulus = ["outcomes", "stochastic cells     M_E"];
    let scenes: [(&str, &[&str], &[&str]); 4] = [
        ("29-random-modulus", &["stochastic.method=\"collocation\"", "stochastic.elements=2"], &modulus),
        ("30-rough-obstacle", &["random.rough.modes=3"], &[&cells[..], &["eigenpairs"]].concat()),
        (
            "30-rough-obstacle",
            &["random.rough.modes=2", "stochastic.method=\"monte-carlo\"", "stochastic.samples=1500"],
            &["outcomes", "eigenpairs"],
        ),
        ("31-random-load-and-modulus", &[], &modulus),
    ];
    let scenes = scenes
        .map(|(name, sets, wanted)| (name, sets.iter().flat_map(|set| ["--set", set]).collect::<Vec<&str>>(), wanted));
    let scenes: Vec<_> = scenes.iter().map(|(name, sets, wanted)| (*name, &sets[..], *wanted)).collect();
    results_hold(&scenes, &["--save", "stochastic", "--set", "method.tolerance=5e-2"]);
}

//! Result files of all kinds of scenes: `docs/check_result.py` finds them right, or wrong where one entry is,
//! `docs/result-file.md` describes every array, and `docs/reference/json.md` every path of their JSON objects.

use crate::json_reference::all_paths_are_described;
use crate::place::{CHECK_RESULT, Place, Ran};

use serde_json::Value;

/// A scene of the gallery, solved with `--save all`.
struct Kind {
    name: &'static str,
    scene: &'static str,
    settings: &'static [&'static str],
    /// First words of lines that the script must print.
    wanted: &'static [&'static str],
}

const fn kind(
    name: &'static str,
    scene: &'static str,
    settings: &'static [&'static str],
    wanted: &'static [&'static str],
) -> Kind {
    Kind { name, scene, settings, wanted }
}

const MATRICES: &[&str] = &["V ", "W ", "S ", "(M/2 + K)", "strain energy"];
const CONTACT: &[&str] = &["S ", "contact problem", "contact  ", "strain energy"];
const MEDIUM: &[&str] = &["V ", "B ", "medium", "A_interface", "equilibrium", "strain energy"];
const FEW: &str = "method.max_steps=3";

const KINDS: [Kind; 28] = [
    kind("contact", "15-block-on-floor", &["probe.sides=[\"floor\"]", FEW], CONTACT),
    kind(
        "stabilised",
        "17-wedge-gap",
        &["method.multiplier=\"stabilised\"", "method.estimators=true", FEW],
        &["stabilisation", "stabilised contact"],
    ),
    kind("coulomb", "25-coulomb-wedge", &[FEW], CONTACT),
    kind(
        "by-names",
        "22-flat-punch",
        &[
            "quantities.edge={ pressure_at = [0.1, 0] }",
            "quantities.middle={ pressure_at = [0.05, 0] }",
            "quantities.sinks={ mean_displacement = \"top\" }",
            "quantities.turns={ moment = \"floor\", about = [0, 0] }",
            "quantities.works={ weighted_force = \"floor\", weight = [0, \"x\"] }",
            "quantities.opens={ opening_at = [0.2, 0] }",
        ],
        CONTACT,
    ),
    kind("two-bodies", "60-two-cylinders", &["probe.lines=[{ from = [0, 0], to = [0, 1] }]", FEW], CONTACT),
    kind("tied", "59-tied-blocks", &[], MATRICES),
    kind("crack", "66-crack-that-closes", &[FEW], CONTACT),
    kind("curved", "50-lame-tube", &["method.indicator=\"residual\""], MATRICES),
    kind("random-modulus", "29-random-modulus", &["method.estimators=true"], &["outcomes", "stochastic cells     M_E"]),
    kind(
        "random-gap",
        "30-rough-obstacle",
        &["random.rough.modes=2", "stochastic.degree=2", FEW],
        &["outcomes", "stochastic cells", "eigenpairs"],
    ),
    kind(
        "monte-carlo",
        "30-rough-obstacle",
        &["random.rough.modes=2", "stochastic.method=\"monte-carlo\"", "stochastic.samples=200", "method.max_steps=2"],
        &["outcomes", "eigenpairs"],
    ),
    kind(
        "random-load",
        "31-random-load-and-modulus",
        &["stochastic.method=\"sparse\"", "stochastic.level=2", "method.estimators=true", FEW],
        &["outcomes"],
    ),
    kind(
        "large-cell",
        "04-cantilever",
        &[
            "random.a={ distribution = \"uniform\", low = 0, high = 1 }",
            "random.b={ distribution = \"uniform\", low = 0, high = 1 }",
            "random.c={ distribution = \"uniform\", low = 0, high = 1 }",
            "stochastic.degree=9",
            "body_force.value=[\"0\", \"a + b + c\"]",
            "method.refine=\"none\"",
        ],
        &["outcomes", "not checked: masses of stochastic cells"],
    ),
    kind(
        "random-cells",
        "68-bar-of-a-random-field",
        &["random.g.modes=2", "stochastic.level=2"],
        &["outcomes", "eigenpairs", "K ", "equilibrium"],
    ),
    kind(
        "multilevel",
        "68-bar-of-a-random-field",
        &["random.g.modes=2", "stochastic.method=\"multilevel\"", "stochastic.tolerance=0.1"],
        &["eigenpairs", "K ", "equilibrium"],
    ),
    kind(
        "drawn-field",
        "68-bar-of-a-random-field",
        &["random.g.modes=\"all\"", "stochastic.method=\"corrected\"", "stochastic.tolerance=0.2"],
        &["K ", "equilibrium"],
    ),
    kind(
        "kept-germs",
        "68-bar-of-a-random-field",
        &["random.g.modes=12", "stochastic.method=\"corrected\"", "stochastic.tolerance=0.05"],
        &["eigenpairs", "K ", "equilibrium"],
    ),
    kind(
        "affine",
        "68-bar-of-a-random-field",
        &[
            "material.cells.young=\"1 + 0.2*g\"",
            "random.g.modes=2",
            "random.g.variables=\"uniform\"",
            "stochastic.method=\"galerkin\"",
        ],
        &["eigenpairs", "K ", "equilibrium"],
    ),
    kind("ratios", "69-checkerboard-of-two-materials", &[], &["K ", "equilibrium", "strain energy"]),
    kind("fem", "39-weight-that-varies", &[], &["K ", "equilibrium", "strain energy"]),
    kind("msfem", "38-l-shape-of-random-cells", &["grid.fine=[4, 4]", FEW], &["K_H ", "basis", "strain energy"]),
    kind("msfem-contact", "37-block-of-random-cells", &["method.estimators=true"], &["basis", "contact problem"]),
    kind("nonconforming", "35-checkerboard", &["grid.fine=[4, 4]", "grid.oversample=2"], &["K_H ", "basis"]),
    kind("fem-bem", "40-transmission", &["method.estimators=true"], MEDIUM),
    kind("msfem-bem", "42-stiff-inclusion-of-random-cells", &["grid.fine=[4, 4]", "method.max_steps=2"], MEDIUM),
    kind("cut", "74-plate-with-holes", &["method.max_steps=1"], &["V ", "W ", "S "]),
    kind(
        "blocks",
        "24-kink-in-an-element",
        &[
            "method.tolerance=1e-1",
            FEW,
            "body.corners=[[0, 0], [8, 0], [8, 2], [0, 2]]",
            "sides.floor.contact.gap=\"0.0016*(cos(31.4159265359*x) + 0.6*cos(11.6238928183*x + 1)) - 0.003\"",
        ],
        &["S ", "contact problem", "contact  "],
    ),
    kind("medium", "65-lining-with-friction", &["method.max_steps=2"], &["V ", "S ", "contact problem"]),
];

/// Datasets of which one entry is changed, and the kind of scene.
const CHANGED: [(&str, &str); 20] = [
    ("contact", "matrices/V"),
    ("contact", "matrices/K"),
    ("contact", "matrices/W"),
    ("contact", "matrices/M/data"),
    ("contact", "contact_problem/problem/stiffness"),
    ("random-gap", "contact_problem/problem/load"),
    ("blocks", "contact_problem/problem/stiffness/data"),
    ("coulomb", "contact_problem/solution/multipliers"),
    ("two-bodies", "matrices/body_1/S"),
    ("cut", "matrices/body_1/S"),
    ("stabilised", "stabilisation/forms/B_gamma"),
    ("stabilised", "stabilisation/multipliers"),
    ("random-modulus", "stochastic/cells/00000/M_E"),
    ("random-gap", "stochastic/outcomes/pressure"),
    ("random-gap", "stochastic/eigenpairs/0/modes"),
    ("fem", "matrices/K/data"),
    ("msfem", "basis/P/data"),
    ("msfem", "basis/R"),
    ("msfem", "matrices/K_H/data"),
    ("fem-bem", "matrices/A_interface"),
];

/// A command with the scene and the settings of a kind, and its JSON object.
fn run(place: &Place, command: &str, kind: &Kind, arguments: &[&str]) -> Ran {
    let scene = format!("{}/../../scenes/{}.toml", env!("CARGO_MANIFEST_DIR"), kind.scene);
    let first = [command, &scene, "--json", "--set", "method.tolerance=1e-2"];
    let settings = kind.settings.iter().flat_map(|setting| ["--set", setting]);
    let ran = place.run(first.iter().chain(arguments).copied().chain(settings));
    assert!(ran.status == 0 || ran.status == 3, "{}: {}", kind.name, ran.err);
    ran
}

fn script(name: &str) -> String {
    format!("{}/tests/python/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn results_of_all_kinds_hold_are_described_and_wrong_entries_are_noticed() {
    let place = Place::new();
    let results = results_hold(&place);
    let plans = KINDS.iter().map(|kind| (kind.name.to_owned(), run(&place, "plan", kind, &[]).json()));
    all_paths_are_described(&place, results, plans.collect());
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/result-file.md");
    let files = KINDS.map(|kind| format!("{}.vtkhdf", kind.name));
    let arguments: Vec<&str> = std::iter::once(table).chain(files.iter().map(String::as_str)).collect();
    print!("{}", place.python(&script("described.py"), &arguments).demand(0).out);
    wrong_entries_are_noticed(&place);
}

/// Name and JSON object of each kind.
fn results_hold(place: &Place) -> Vec<(String, Value)> {
    let solve = |kind: &Kind| {
        let file = format!("{}.vtkhdf", kind.name);
        run(place, "solve", kind, &["--quiet", "--save", "all", "--out", &file]).json()
    };
    let solved: Vec<Value> = KINDS.iter().map(solve).collect();
    let said = checked(place, &KINDS.map(|kind| format!("{}.vtkhdf", kind.name)));
    for (kind, (status, said)) in KINDS.iter().zip(&said) {
        assert_eq!(*status, 0, "{}:\n{said}", kind.name);
        for what in kind.wanted {
            assert!(said.lines().any(|line| line.starts_with(what)), "{}: {what} is not checked:\n{said}", kind.name);
        }
        println!("{}: {}", kind.name, said.lines().last().unwrap());
    }
    KINDS.iter().map(|kind| kind.name.to_owned()).zip(solved).collect()
}

fn wrong_entries_are_noticed(place: &Place) {
    let copies: Vec<String> = (0..CHANGED.len()).map(|k| format!("wrong-{k}.vtkhdf")).collect();
    let originals = CHANGED.map(|(kind, _)| format!("{kind}.vtkhdf"));
    let each = originals.iter().zip(CHANGED).zip(&copies);
    let arguments: Vec<&str> = each.flat_map(|((file, (_, dataset)), copy)| [file.as_str(), dataset, copy]).collect();
    place.python(&script("change_entries.py"), &arguments).demand(0);
    for ((kind, dataset), (status, said)) in CHANGED.iter().zip(checked(place, &copies)) {
        assert!(status == 1 && said.contains("DOES NOT HOLD"), "{kind}: {dataset} is not noticed:\n{said}");
        println!("{kind} with a wrong {dataset}: {}", said.lines().last().unwrap());
    }
}

/// The exit status of `docs/check_result.py` for each file, and what it says.
pub fn checked(place: &Place, files: &[String]) -> Vec<(i32, String)> {
    let arguments: Vec<&str> = std::iter::once(CHECK_RESULT).chain(files.iter().map(String::as_str)).collect();
    let all = format!("\n{}", place.python(&script("check_many.py"), &arguments).demand(0).out);
    let of = |(part, file): (&str, &String)| {
        let (head, said) = part.split_once('\n').unwrap();
        let status = head.strip_prefix(file.as_str()).unwrap_or_else(|| panic!("{file}: {head}"));
        (status.trim().parse().unwrap(), said.to_owned())
    };
    let parts: Vec<&str> = all.split("\n== ").skip(1).collect();
    assert_eq!(parts.len(), files.len());
    parts.into_iter().zip(files).map(of).collect()
}

/// A disc with a hole beside its centre, held by nothing: the displacement has a rotation in it, which polynomials on arcs do not
/// follow, and the strain energy of the matrices is that without it.
#[test]
fn the_energy_of_a_free_body_with_curves_is_that_without_its_motion() {
    let place = Place::new();
    place.write(
        "disc.toml",
        "title = \"disc\"\n[body]\ncircle = { centre = [3, 1], radius = 2 }\nside = \"outside\"\n[[body.holes]]\n\
         circle = { centre = [3.7, 1.4], radius = 0.6 }\nside = \"hole\"\n[material]\nyoung = 1\npoisson = 0.3\n\
         [sides.outside]\ntraction = [\"0.1*(x-3) + 0.2*(y-1)\", \"0.2*(x-3) - 0.05*(y-1)\"]\n\
         [method]\ntolerance = 0.1\n",
    );
    place.run(["solve", "disc.toml", "--quiet", "--save", "all"]).demand(0);
    let said = place.python(CHECK_RESULT, &["disc.vtkhdf"]).demand(0).out;
    assert!(said.lines().any(|line| line.starts_with("strain energy")), "{said}");
}

#[test]
fn a_result_that_saved_nothing_says_how_to_save() {
    let place = Place::new();
    place.run(["solve", "block.toml", "--quiet"]).demand(0);
    let ran = place.python(CHECK_RESULT, &["block.vtkhdf"]);
    assert!(ran.status == 2 && ran.out.contains("solve with --save all"), "{}{}", ran.out, ran.err);
}

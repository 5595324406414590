//! Natural mistakes of users, each told with the remedy that is true.

use crate::place::{BLOCK, Place};
use steklov_io::{Label, create_atomically, save_dense};

/// A lining in rock, two bodies in contact.
const LINING: &str = r#"title = "Lining"
[[body]]
name = "lining"
material = { young = 3000, poisson = 0.2 }
circle = { centre = [0, 0], radius = 3 }
side = "outside"
[[body.holes]]
circle = { centre = [0, 0], radius = 2.6 }
side = "inside"
[[body]]
name = "rock"
material = { young = 1000, poisson = 0.3 }
medium = { remote_stress = [-2, -3, 0] }
[[body.holes]]
circle = { centre = [0, 0], radius = 3 }
side = "wall"
[[interface]]
between = ["lining.outside", "rock.wall"]
contact = { friction = { coulomb = "0.3" } }
[method]
refine = "none"
"#;

/// A block with a crack whose faces are loaded.
const FAULT: &str = r#"title = "Fault"
[body]
corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[body.cracks]]
points = [[-0.4, -0.1], [0.4, 0.1]]
side = "fault"
[material]
young = 1000
poisson = 0.3
[sides.fault]
pressure = "1"
[sides.bottom]
displacement = ["0", "0"]
[sides.top]
traction = ["1", "-5"]
[method]
tolerance = 1e-2
"#;

/// A body of cells.
const CELLS: &str = r#"title = "Cells"
[body]
corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["lower", "right", "upper", "left"]
[material]
poisson = 0.3
[material.cells]
size = 0.0625
young = { uniform = [1, 10] }
[grid]
coarse = [8, 4]
fine = [8, 8]
[sides.left]
displacement = ["0", "0"]
[sides.right]
traction = ["0", "-1"]
[method]
refine = "none"
"#;

/// A block of random modulus.
const RANDOM: &str = r#"title = "Random"
[body]
corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["floor", "right", "top", "left"]
[material]
young = "E"
poisson = 0.3
[random.E]
distribution = "lognormal"
mean = 2000.0
deviation = 200.0
[sides.floor]
displacement = ["0", "0"]
[sides.top]
pressure = 20
[method]
refine = "none"
elements = 8
[stochastic]
degree = 2
method = "collocation"
quantities = ["energy"]
"#;

/// An edit of a scene, arguments beside `solve scene.toml`, the status, and parts of what is told.
struct Mistake {
    scene: &'static str,
    edit: (&'static str, &'static str),
    arguments: &'static [&'static str],
    status: i32,
    told: &'static [&'static str],
}

const fn of(
    scene: &'static str,
    from: &'static str,
    to: &'static str,
    status: i32,
    told: &'static [&'static str],
) -> Mistake {
    Mistake { scene, edit: (from, to), arguments: &[], status, told }
}

const fn given(arguments: &'static [&'static str], status: i32, told: &'static [&'static str]) -> Mistake {
    Mistake { scene: BLOCK, edit: ("", ""), arguments, status, told }
}

const LOAD: &str = "traction = [\"0\", \"-1\"]";
const UNIFORM: &str = "{ uniform = [1, 10] }";
const BOX: &str = "corners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"lower\", \"right\", \"upper\", \"left\"]";
const NOTCHED: &str = "corners = [[0, 0], [2, 0], [2, 1], [1.1, 1], [1.1, 0.77], [0, 0.77]]\n\
                       sides = [\"lower\", \"right\", \"upper\", \"step\", \"upper\", \"left\"]";
const LOGNORMAL: &str = "distribution = \"lognormal\"\nmean = 2000.0\ndeviation = 200.0";

const MISTAKES: &[Mistake] = &[
    // numbers and expressions
    of(BLOCK, "poisson = 0.3", "poisson = 0,3", 1, &["help: numbers are written with a decimal point: 0.3"]),
    of(
        BLOCK,
        "young = 200.0",
        "young = \"210 GPa\"",
        1,
        &["numbers have no unit, and GPa is one", "the number alone, 210,"],
    ),
    of(BLOCK, LOAD, "traction = [\"0\", \"-x**2\"]", 1, &["powers are written with ^", "help: write -x^2\n"]),
    of(BLOCK, LOAD, "traction = [\"0\", \"-x²\"]", 1, &["help: write -x^2\n"]),
    of(BLOCK, LOAD, "traction = [\"0\", \"−1\"]", 1, &["a long minus", "help: write -1\n"]),
    of(BLOCK, LOAD, "traction = [\"0\", \"np.sin(np.pi*x)\"]", 1, &["stand alone", "help: write sin(pi*x)\n"]),
    of(BLOCK, LOAD, "traction = [\"0\", \"if(x > 1 and x < 2, -1, 0)\"]", 1, &["and is not known", "(a < x)*(x < b)"]),
    of(BLOCK, LOAD, "traction = [\"0\", \"if(x < 1 || x > 2, -1, 0)\"]", 1, &["|| is not known", "max(x < a, b < x)"]),
    of(BLOCK, LOAD, "traction = [\"0\", \"-1 if x > 1 else 0\"]", 1, &["a choice is a function", "if(y > 0.5, 1, 0)"]),
    of(BLOCK, "F = 0.3", "F = \"0.1*g\"\ng = 3", 1, &["parameters.F uses g", "write g above F"]),
    of(BLOCK, "F = 0.3", "F = \"F + 1\"", 1, &["parameters.F uses F", "does not use itself"]),
    of(
        CELLS,
        UNIFORM,
        "\"young.h5\"",
        1,
        &["a file is no expression", "young = { file = \"young.h5\", dataset = \"/young\" }"],
    ),
    // tables
    of(
        LINING,
        "[[interface]]",
        "[interface]",
        1,
        &["interface is a table", "write [[interface]] with two pairs of brackets"],
    ),
    of(
        LINING,
        "radius = 3 }\nside = \"outside\"\n[[body.holes]]",
        "radius = 3 }\nside = \"outside\"\n[body.holes]",
        1,
        &["write [[body.holes]] with two pairs"],
    ),
    of(
        LINING,
        "remote_stress = [-2, -3, 0] }",
        "remote_stress = [-2, -3, 0] }\ncorners = [[-9, -9], [9, -9], [9, 9]]",
        1,
        &["remove what outlines it, as corners and sides", "for a bounded body remove medium"],
    ),
    of(CELLS, UNIFORM, "{ uniform = [2000, 2500, 3000] }", 1, &["it takes two, the lowest and the highest modulus"]),
    of(
        CELLS,
        UNIFORM,
        "{ file = \"picture.png\", dataset = \"/young\" }",
        1,
        &["picture.png is a picture (PNG or JPEG)", "h5py.File(\"young.h5\", \"w\")[\"/young\"] = "],
    ),
    of(CELLS, UNIFORM, "{ file = \"none.h5\", dataset = \"/young\" }", 1, &["relative to the folder of the scene"]),
    of(CELLS, UNIFORM, "{ file = \"fine.h5\", dataset = \"/young\" }", 1, &["found 64 by 32", "take size = 0.03125"]),
    of(CELLS, BOX, NOTCHED, 1, &["the corner (1.1, 1) is no point", "coarse = [20, 100], fine = [8, 4]"]),
    // what holds and what meets
    of(
        BLOCK,
        "contact = { gap = \"0\", friction = { tresca = \"F\" } }\n[sides.top]\ntraction = [\"0\", \"-1\"]",
        "contact = { gap = \"0\", friction = { coulomb = \"F\" } }\n[sides.left]\ndisplacement = [\"0\", \"free\"]\n[sides.top]\npressure = -1",
        1,
        &["translation along (0, 1)", "pressure = -1", "pull the body off its obstacle", "[\"free\", \"0\"]"],
    ),
    of(
        BLOCK,
        "contact = { gap = \"0\", friction = { tresca = \"F\" } }\n[sides.top]",
        "contact = { gap = \"0\", friction = { coulomb = \"0.2\" } }\n[sides.left]\ntraction = [\"3\", \"0\"]\n[sides.top]",
        1,
        &[
            "translation along (0.980581, 0.196116)",
            "(of a scale of 4.581e0); hold",
            "help: hold this motion, as by displacement = [\"0\", \"free\"]",
        ],
    ),
    of(
        LINING,
        "coulomb = \"0.3\"",
        "coulomb = \"tan(30)\"",
        1,
        &["-6.405331196646276", "tan takes radians", "tan(30*pi/180)"],
    ),
    of(
        LINING,
        "coulomb = \"0.3\"",
        "coulomb = \"30\"",
        0,
        &["warning: a friction coefficient of 30", "tan(30*pi/180)"],
    ),
    of(
        LINING,
        "remote_stress = [-2, -3, 0]",
        "remote_stress = [2, 3, 0]",
        0,
        &["nothing touches side rock.wall: stresses far away are negative in compression"],
    ),
    of(
        LINING,
        "lining.outside",
        "lining.inside",
        1,
        &["do not face each other: body \"lining\" lies between", "sides that meet"],
    ),
    of(
        FAULT,
        "[material]",
        "[[body.cracks]]\npoints = [[-0.1, -0.5], [0.1, 0.5]]\nside = \"joint\"\n[material]",
        1,
        &["the crack meets fault at (0, 0)", "leave a distance between them, or shorten one"],
    ),
    of(
        FAULT,
        "[0.4, 0.1]]",
        "[0.4, 0.1], [0.4, 0.3], [-0.2, -0.3]]",
        1,
        &["the crack meets fault, itself, at (0.1333333, 0.0333333)"],
    ),
    of(
        FAULT,
        "",
        "",
        0,
        &["doubt       reach:", "body 1 and body 2 lie 0.0079", "`contact` in place of loads on its faces"],
    ),
    // random input
    of(RANDOM, "young = \"E\"", "young = 2000", 0, &["warning: no datum uses the random E"]),
    of(RANDOM, "degree = 2", "degree = 0", 1, &["stochastic.degree is 0", "it must be 1 or more"]),
    of(RANDOM, "degree = 2\nmethod = \"collocation\"", "level = 0\nmethod = \"sparse\"", 1, &["stochastic.level is 0"]),
    of(
        RANDOM,
        LOGNORMAL,
        "distribution = \"normal\"\nmean = 2000.0\ndeviation = 600.0",
        1,
        &["Young's modulus is -2220.69", "no outcome may reach that", "distribution = \"lognormal\""],
    ),
    of(
        RANDOM,
        "pressure = 20",
        "pressure = \"20 + rough\"\n[random.rough]\ncovariance = \"exponential\"\ncorrelation = 0.001\non = \"top\"",
        1,
        &["the field rough has 4045 modes, more than the 64 germs", "1000 correlation lengths", "modes = 6"],
    ),
    // the command
    given(
        &["--set", "method.tolerance", "1e-3"],
        2,
        &["--set takes KEY=VALUE as one argument: --set 'method.tolerance=1e-3'"],
    ),
    given(&["--set", "sides.top.traction=[0,", "-20]"], 2, &["single quotes: --set 'sides.top.traction=[0, -20]'"]),
    given(&["--tolerance", "1e-4"], 2, &["tip: keys of the scene are changed by --set method.tolerance=VALUE"]),
    given(&["--csv", "tables"], 2, &["tip: tables come from a result: steklov show RESULT.vtkhdf --csv DIR"]),
    given(&["--plots", "scene.toml"], 1, &["--plots needs a folder, and scene.toml is a file"]),
    given(&["--out", "res.json"], 1, &["name it .vtkhdf, .h5 or .hdf5", "--json > FILE.json"]),
    given(&["--set", "body.corners[2]=[4, 2]"], 1, &["--set 'body.corners.2=[4, 2]'"]),
    given(
        &["--set", "material.young=2e5,material.poisson=0.25"],
        1,
        &["one --set for each key: --set 'material.young=2e5' --set 'material.poisson=0.25'"],
    ),
];

#[test]
fn natural_mistakes_are_told_with_the_true_remedy() {
    let place = Place::new();
    place.write("picture.png", b"\x89PNG\r\n\x1a\n");
    let label = Label { unit: "stress", meaning: "Young's modulus", axes: &["ix", "iy"] };
    let young = faer::Mat::from_fn(64, 32, |_, _| 1.0);
    create_atomically(place.path("fine.h5"), false, |file| save_dense(file, "young", young.as_ref(), &label)).unwrap();
    let mut wrong = String::new();
    for Mistake { scene, edit: (from, to), arguments, status, told } in MISTAKES {
        assert!(from.is_empty() || scene.matches(from).count() == 1, "{from:?} is not once in the scene");
        let text = if from.is_empty() { (*scene).to_owned() } else { scene.replacen(from, to, 1) };
        place.write("scene.toml", text);
        let out: &[&str] = if arguments.contains(&"--out") { &[] } else { &["--out", "result.vtkhdf"] };
        let ran = place.run(["solve", "scene.toml", "--force"].iter().chain(out).chain(*arguments));
        let said = format!("{}{}", ran.out, ran.err);
        let lost: Vec<&&str> = told.iter().filter(|part| !said.contains(**part)).collect();
        if ran.status != *status || !lost.is_empty() {
            wrong += &format!("{to:?} {arguments:?}: status {}, no {lost:?} in\n{said}\n", ran.status);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn a_scene_is_no_result_to_be_shown() {
    let place = Place::new();
    let told = place.run(["show", "block.toml"]).demand(1).err;
    assert!(told.contains("is a scene and no result: steklov solve block.toml makes block.vtkhdf"), "{told}");
    place.write("picture.png", b"\x89PNG\r\n\x1a\n");
    let told = place.run(["show", "picture.png"]).demand(1).err;
    assert!(told.contains("is a picture (PNG or JPEG) and no result"), "{told}");
    let told = place.run(["show", "block.vtkhdf", "--plots", "block.toml"]).demand(1).err;
    assert!(told.contains("--plots needs a folder, and block.toml is a file"), "{told}");
}

/// `plan` answers at once for a field of thousands of modes too.
#[test]
fn a_field_of_too_many_modes_is_refused_before_it_is_looked_at() {
    let place = Place::new();
    let field =
        "pressure = \"20 + rough\"\n[random.rough]\ncovariance = \"exponential\"\ncorrelation = 0.001\non = \"top\"";
    place.write("scene.toml", RANDOM.replace("pressure = 20", field));
    let told = place.run(["plan", "scene.toml"]).demand(1).err;
    assert!(told.contains("4045 modes"), "{told}");
    let told = place.run(["plan", "scene.toml", "--set", "stochastic.method=\"monte-carlo\""]).demand(1).err;
    assert!(told.contains("4045 modes, more than the 2048 germs"), "{told}");
}

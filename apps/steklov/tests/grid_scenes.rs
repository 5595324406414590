//! Heterogeneous bodies: what does not fit the grid is refused with its place, the model is the least that fits, and every fine
//! cell has the modulus that the scene gives it.

use crate::place::Place;
use proptest::prelude::*;
use steklov_document::SceneErrorKind as Kind;
use steklov_document::{Document, SceneError};
use steklov_io::{Label, create_atomically, save_dense, save_vector};
use steklov_problem::{BasisInput, CellModuli, DataErrorKind, Model, Scene, grid_of, moduli};
use steklov_quadrature::unit_uniform;

/// An L of three unit squares with 4 × 4 moduli in its bounding box, 2 × 2 fine cells each.
const L: &str = r#"title = "L"
[body]
corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
sides = ["floor", "right", "step", "inner", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.5, young = { uniform = [2000, 3000], seed = 2014 } }
[sides.floor]
displacement = [0, 0]
[sides.top]
traction = [0, -1]
[grid]
coarse = [4, 4]
fine = [2, 2]
"#;

const CELLS: &str = "cells = { size = 0.5, young = { uniform = [2000, 3000], seed = 2014 } }";

fn parse(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    steklov_document::parse(text, "broken.toml", &overrides)
}

fn sound(text: &str, overrides: &[&str]) -> Scene {
    parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// The same with its texts.
fn document(text: &str, overrides: &[&str]) -> Document {
    let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
    Document::parse(text, "broken.toml", &overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn young(document: &Document) -> Result<Vec<f64>, SceneError> {
    let scene = &document.scene;
    grid_of(scene).and_then(|grid| moduli(scene, &grid)).map_err(|e| document.error(e))
}

/// A mistake: kind, line, the text that is pointed at, part of the message, part of the remedy.
fn check(error: &SceneError, kind: Kind, line: usize, offending: &str, message: &str, remedy: &str) {
    let shown = error.render();
    assert_eq!((error.kind, error.line()), (kind, Some(line)), "{shown}");
    assert!(error.offending().starts_with(offending), "{offending:?} is not {:?}", error.offending());
    assert!(error.message.contains(message), "{message:?} is not in\n{shown}");
    assert!(error.help.contains(remedy), "{remedy:?} is not in\n{shown}");
}

#[test]
fn what_does_not_fit_the_grid_is_refused_at_its_place() {
    let corner = ("[1.0, 1.0]", "[1.0, 1.1]");
    for (edits, kind, line, offending, message, remedy) in [
        (
            &[("[2.0, 1.0], [1.0, 1.0]", "[2.0, 1.1], [1.0, 1.1]")][..],
            Kind::Data(DataErrorKind::Geometry),
            3,
            "[2.0, 1.1]",
            "the corner (2, 1.1) is no point of the coarse grid: the nearest one is (2, 1), the spacing is 0.5 by 0.5",
            "such as to [grid] coarse = [20, 20], fine = [",
        ),
        (
            &[corner],
            Kind::Data(DataErrorKind::Geometry),
            3,
            "[2.0, 1.0]",
            "from (2, 1) to (1, 1.1) is neither horizontal nor vertical",
            "steps along the axes",
        ),
        (
            &[(
                "[sides.floor]",
                "[[body.holes]]\ncorners = [[0.5, 0.5], [0.5, 0.75], [0.75, 0.75], [0.75, 0.5]]\nsides = [\"h\", \"h\", \"h\", \"h\"]\n[sides.floor]",
            )],
            Kind::Data(DataErrorKind::Geometry),
            9,
            "[0.5, 0.75]",
            "the corner (0.5, 0.75) is no point of the coarse grid: the nearest one is (0.5, 1)",
            "coarse = [8, 8], fine = [2, 2]",
        ),
        // the lowest corners of the hole, listed against the traversal of holes, are the first ones that do not fit
        (
            &[(
                "[sides.floor]",
                "[[body.holes]]\ncorners = [[0.5, 0.25], [0.75, 0.25], [0.75, 0.75], [0.5, 0.75]]\nsides = [\"h\", \"h\", \"h\", \"h\"]\n[sides.floor]",
            )],
            Kind::Data(DataErrorKind::Geometry),
            9,
            "[0.5, 0.25]",
            "the corner (0.5, 0.25) is no point of the coarse grid",
            "coarse = [8, 8], fine = [2, 2]",
        ),
        (
            &[("coarse = [4, 4]", "coarse = [1, 1]"), ("fine = [2, 2]", "fine = [5, 8]\n[method]\nmodel = \"fem\"")],
            Kind::Data(DataErrorKind::Geometry),
            3,
            "[1.0, 1.0]",
            "(1, 1) is no point of the fine grid: the nearest one is (1.2, 1), the spacing is 0.4 by 0.25",
            "coarse = [2, 2]",
        ),
        // an edge that lies between two grid points
        (
            &[
                ("[1.0, 2.0], [0.0, 2.0]", "[1.0, 2.0], [0.5, 2.0], [0.5, 1.9999999999], [0.0, 1.9999999999]"),
                ("\"left\"]", "\"left\", \"a\", \"b\"]"),
            ],
            Kind::Data(DataErrorKind::Geometry),
            3,
            "[0.5, 2.0]",
            "the corner (0.5, 2) is no point",
            "[grid]",
        ),
        (
            &[("size = 0.5", "size = 0.3")],
            Kind::Data(DataErrorKind::Value),
            7,
            "0.3",
            "size 0.3 do not divide the bounding box of 2 by 2",
            "take size = 0.3333333333333333",
        ),
        (
            &[("size = 0.5", "size = 3")],
            Kind::Data(DataErrorKind::Value),
            7,
            "3",
            "size 3 do not divide the bounding box of 2 by 2: it has 0.6666666666666666 by",
            "take size = 2",
        ),
        (
            &[("size = 0.5", "size = 1e-300")],
            Kind::Data(DataErrorKind::Value),
            7,
            "1e-300",
            "do not divide the bounding box",
            "take size = ",
        ),
        (
            &[("fine = [2, 2]", "fine = [3, 1]"), ("size = 0.5", "size = 0.25")],
            Kind::Data(DataErrorKind::Value),
            7,
            "0.25",
            "fine cells of 0.16666666666666666 by 0.5 do not divide modulus cells of the size 0.25",
            "take grid.fine = [4, 2]",
        ),
        (
            &[("[grid]\ncoarse = [4, 4]\nfine = [2, 2]\n", "[method]\nmodel = \"fem\"\n")],
            Kind::Data(DataErrorKind::Missing),
            13,
            "\"fem\"",
            "finite elements need a [grid]",
            "[grid] coarse = [2, 2], fine = [2, 2]",
        ),
        (
            &[("[grid]", "[method]\nmultiplier = \"stabilised\"\n[grid]")],
            Kind::Data(DataErrorKind::Unsupported),
            13,
            "\"stabilised\"",
            "biorthogonal multipliers only",
            "needs no stabilisation",
        ),
        (
            &[
                ("{ uniform = [2000, 3000], seed = 2014 }", "\"2000+xi\""),
                (
                    "[grid]",
                    "[random.xi]\ndistribution = \"uniform\"\nlow = 0\nhigh = 1\n[stochastic]\nmethod = \"collocation\"\n[grid]",
                ),
            ],
            Kind::Data(DataErrorKind::Unsupported),
            17,
            "\"collocation\"",
            "each outcome is a body of its own",
            "take method = \"sparse\"",
        ),
        (
            &[("[grid]", "[method]\nmodel = \"msfem-bem\"\n[grid]")],
            Kind::Data(DataErrorKind::Missing),
            13,
            "\"msfem-bem\"",
            "no medium around the body",
            "[exterior]",
        ),
        (
            &[("[grid]", "[exterior]\nyoung = 50\npoisson = 0.3\n[grid]")],
            Kind::Data(DataErrorKind::Conflict),
            8,
            "[sides.floor]",
            "meets the medium",
            "remove it",
        ),
    ] {
        let text = edits.iter().fold(L.to_owned(), |text, (from, to)| {
            assert_eq!(text.matches(from).count(), 1, "{from:?}");
            text.replace(from, to)
        });
        match parse(&text, &[]) {
            Ok(_) => panic!("accepted: {edits:?}"),
            Err(error) => check(&error, kind, line, offending, message, remedy),
        }
    }
}

#[test]
fn the_model_is_the_least_that_fits() {
    let heavy = format!("{}[body_force]\nvalue = [\"0\", \"-y^2\"]\n", L.replace(CELLS, "young = 2000"));
    let [constant, affine] = ["-9.81", "2*x - 3*(y - 1)"].map(|f| heavy.replace("-y^2", f));
    for (text, overrides, model) in [
        (L, &[][..], Model::Msfem),
        (L, &["grid.fine=[1, 1]"], Model::Fem),
        (L, &["method.model=\"fem\""], Model::Fem),
        (L, &["method.model=\"msfem\"", "grid.fine=[1, 1]"], Model::Msfem),
        (&heavy, &[], Model::Msfem),
        (&heavy, &["grid.fine=[1, 1]"], Model::Fem),
        (&constant, &[], Model::Bem),
        (&affine, &[], Model::Bem),
        (&affine, &["method.model=\"fem\""], Model::Fem),
        (&constant, &["method.model=\"msfem\""], Model::Msfem),
        (&constant, &["method.model=\"bem\""], Model::Bem),
    ] {
        assert_eq!(sound(text, overrides).model(), model, "{overrides:?} of\n{text}");
    }
    // a grid that boundary elements do not use needs not fit the body
    assert_eq!(sound(&constant, &["grid.coarse=[3, 3]"]).model(), Model::Bem);
    assert!(parse(&heavy, &["grid.coarse=[3, 3]"]).is_err());
    // the force where the grid asks for it
    assert_eq!(sound(&heavy, &[]).force_at([0.5, 1.5]).unwrap(), [0.0, -2.25]);
    assert_eq!(sound(&affine, &[]).body().force_gradient(), Some([[0.0, 0.0], [2.0, -3.0]]));
    assert_eq!(sound(&heavy, &[]).body().constant_force(), None);
    assert_eq!(sound(&constant, &[]).force_at([0.5, 1.5]).unwrap(), [0.0, -9.81]);
    let infinite = document(&heavy, &["body_force.value=[\"1/x\", 0]"]);
    let infinite = infinite.error(infinite.scene.force_at([0.0, 0.5]).unwrap_err());
    check(
        &infinite,
        Kind::Data(DataErrorKind::Data),
        1,
        "\"1/x\"",
        "the body force is inf at the point (0, 0.5)",
        "keep the values bounded",
    );
}

#[test]
fn keys_of_the_grid_are_read_and_have_defaults() {
    let grid = sound(L, &[]).body().grid.unwrap();
    assert_eq!((grid.coarse, grid.fine, grid.basis, grid.oversample), ([4, 4], [2, 2], BasisInput::Coupled, None));
    for (word, basis) in [
        ("linear", BasisInput::Linear),
        ("coupled", BasisInput::Coupled),
        ("oscillatory", BasisInput::Oscillatory),
        ("oversampled", BasisInput::Oversampled),
        ("periodic", BasisInput::Periodic),
        ("q1", BasisInput::Q1),
    ] {
        let set = format!("grid.basis=\"{word}\"");
        let grid = sound(L, &[&set, "grid.oversample=3"]).body().grid.unwrap();
        assert_eq!((grid.basis, grid.oversample), (basis, Some(3)));
    }
    let scene = sound(L, &["material.cells.young={ uniform = [1, 2] }"]);
    assert!(matches!(scene.body().cells().unwrap().young, CellModuli::Uniform { low: 1.0, high: 2.0, seed: 0 }));
}

/// The bar of 6 × 1 with 192 × 32 moduli in 12 × 2 coarse cells of 16 × 16 fine ones.
const BAR: &str = r#"[body]
corners = [[0, 0], [6, 0], [6, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
cells = { size = 0.03125, young = { uniform = [2000, 3000], seed = 2014 } }
[sides.left]
displacement = [0, 0]
[sides.right]
traction = [0, -1]
[grid]
coarse = [12, 2]
fine = [16, 16]
"#;

/// The numbers of seed 2014 in ../data/multiscale.json: `rng.seed2014_first4`, and `bar.rand.E_first_cells` of the cells (0, 0),
/// (0, 1), (1, 0), (191, 31).
#[test]
fn random_moduli_are_those_of_the_reference_and_stay_when_h_is_halved() {
    let coarse = young(&document(BAR, &[])).unwrap();
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b;
    assert_eq!(coarse.len(), 192 * 32);
    for (cell, u) in [0.7727061408, 0.01060959718, 0.6281408531, 0.07629860571].into_iter().enumerate() {
        assert!(close(coarse[cell], 2000.0 + 1000.0 * u), "{cell}: {}", coarse[cell]);
    }
    let first = [((0, 0), 2772.706141), ((0, 1), 2010.609597), ((1, 0), 2438.198672), ((191, 31), 2359.190074)];
    for ((ix, iy), wanted) in first {
        assert!(close(coarse[ix * 32 + iy], wanted), "({ix}, {iy}): {}", coarse[ix * 32 + iy]);
    }
    // 6144 numbers of mean 1/2 and variance 1/12: four deviations of their mean are 0.015
    let mean = coarse.iter().sum::<f64>() / 6144.0;
    assert!((mean - 2500.0).abs() < 15.0, "{mean}");
    for m in [2, 4] {
        let set = format!("grid.fine=[{0}, {0}]", 16 * m);
        let fine = young(&document(BAR, &[&set])).unwrap();
        assert_eq!(fine.len(), m * m * coarse.len());
        for (cell, value) in fine.iter().enumerate() {
            let (ix, iy) = (cell / (32 * m), cell % (32 * m));
            assert_eq!(value.to_bits(), coarse[ix / m * 32 + iy / m].to_bits(), "{m}: ({ix}, {iy})");
        }
    }
}

#[test]
fn cells_outside_of_the_body_are_numbered_and_not_judged() {
    let scene = sound(L, &[]);
    let grid = grid_of(&scene).unwrap();
    assert_eq!((grid.cells, grid.spacing, grid.body_cells().count()), ([8, 8], [0.25; 2], 48));
    let values = moduli(&scene, &grid).unwrap();
    // fine cells (6, 3) and (3, 6) lie in the modulus cells (3, 1) and (1, 3), the 13th and the 7th; without the upper right
    // square they would be others
    for (ix, iy, i) in [(6, 3, 13), (3, 6, 7), (7, 0, 12), (0, 7, 3)] {
        assert_eq!(values[ix * 8 + iy], 2000.0 + 1000.0 * unit_uniform(2014, i), "({ix}, {iy})");
    }
    // an expression at the centres of modulus cells, bad ones only outside of the body
    let by = |text: &str| young(&document(L, &[&format!("material.cells.young=\"{text}\"")]));
    let values = by("if(min(x, y) > 1, log(-1), 1 + x + 10*y)").unwrap();
    for cell in grid.body_cells() {
        let centre = grid.centre(cell).map(|x| (x / 0.5).floor() * 0.5 + 0.25);
        assert_eq!(values[cell], 1.0 + centre[0] + 10.0 * centre[1]);
    }
    for (text, value) in
        [("1.25 - x", "0"), ("x - 0.3", "-0.04999999999999999"), ("1/(x - 1.25)", "-1"), ("1/0", "inf")]
    {
        let error = by(text).unwrap_err();
        let message = format!("Young's modulus is {value} in the cell with the centre (");
        check(&error, Kind::Data(DataErrorKind::Data), 1, &format!("\"{text}\""), &message, "positive and finite");
        assert!(error.message.ends_with(&format!("): expression {text:?}")), "{}", error.message);
    }
    // one modulus is that of every cell
    let one = document(&L.replace(CELLS, "young = 7"), &["method.model=\"fem\""]);
    assert_eq!(young(&one).unwrap(), vec![7.0; 64]);
}

/// A scene whose body is a square with a hole of any grid cells has exactly the other cells.
#[test]
fn holes_are_left_out() {
    let hole = "[[body.holes]]\ncorners = [[0.5, 0.5], [1.0, 0.5], [1.0, 1.0], [0.5, 1.0]]\nsides = [\"h\", \"h\", \"h\", \"h\"]\n[sides.floor]";
    let text = L.replace("[sides.floor]", hole).replace("[2.0, 1.0], [1.0, 1.0], [1.0, 2.0]", "[2.0, 2.0]");
    let text = text.replace("\"step\", \"inner\", ", "");
    let grid = grid_of(&sound(&text, &[])).unwrap();
    for ix in 0..8 {
        for iy in 0..8 {
            let in_hole = (2..4).contains(&ix) && (2..4).contains(&iy);
            assert_eq!(grid.inside(ix, iy), !in_hole, "({ix}, {iy})");
        }
    }
}

/// The L beside a file of moduli of this shape.
fn with_file(rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) -> (Place, std::path::PathBuf) {
    let place = Place::new();
    let young = Label { unit: "stress", meaning: "Young's modulus", axes: &["ix", "iy"] };
    let list = Label { unit: "stress", meaning: "a list", axes: &["i"] };
    create_atomically(place.path("young.h5"), false, |file| {
        save_dense(file, "young", faer::Mat::from_fn(rows, columns, &value).as_ref(), &young)?;
        save_vector(file, "list", &[1.0, 2.0], &list)
    })
    .unwrap();
    let from = "{ uniform = [2000, 3000], seed = 2014 }";
    place.write("l.toml", L.replace(from, "{ file = \"young.h5\", dataset = \"/young\" }"));
    let path = place.path("l.toml");
    (place, path)
}

#[test]
fn moduli_of_a_file_beside_the_scene_are_indexed_by_column_and_row() {
    let read = |path: &std::path::Path, overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|&s| s.to_owned()).collect();
        young(&Document::read(path, &overrides)?)
    };
    // what lies outside of the body is not judged
    let (_place, path) = with_file(4, 4, |ix, iy| if ix > 1 && iy > 1 { -1.0 } else { (1 + 10 * ix + iy) as f64 });
    let values = read(&path, &[]).unwrap();
    for (ix, iy, wanted) in [(0, 0, 1.0), (7, 3, 32.0), (3, 7, 14.0), (1, 2, 2.0)] {
        assert_eq!(values[ix * 8 + iy], wanted);
    }
    let cells = |key: &str, value: &str| format!("material.cells.young.{key}=\"{value}\"");
    for (set, offending, message, remedy) in [
        (cells("file", "no.h5"), "\"no.h5\"", "no.h5", "relative to the folder of the scene"),
        (cells("file", "l.toml"), "\"l.toml\"", "is no HDF5 file", "relative to the folder of the scene"),
        (cells("dataset", "/yuong"), "\"/yuong\"", "has no /yuong", "h5ls"),
        (cells("dataset", "a/b"), "\"a/b\"", "has no /a/b", "h5ls"),
        (cells("dataset", "/list"), "\"/list\"", "expected 4 by 4 numbers, found 2", "[ix, iy]"),
    ] {
        let error = read(&path, &[&set]).unwrap_err();
        check(&error, Kind::Read, 1, offending, message, remedy);
    }
    for (value, shown) in [(f64::NAN, "NaN"), (0.0, "0"), (-2.0, "-2"), (f64::INFINITY, "inf")] {
        let (_place, path) = with_file(4, 4, |ix, iy| if [ix, iy] == [2, 1] { value } else { 1.0 });
        let message =
            format!("modulus is {shown} in the cell with the centre (1.25, 0.75): entry [2, 1] of /young of young.h5");
        check(
            &read(&path, &[]).unwrap_err(),
            Kind::Data(DataErrorKind::Data),
            7,
            "{ file",
            &message,
            "positive and finite",
        );
    }
    // a bounding box of 2 by 4 is met by 4 × 8 numbers, not by 8 × 4
    let (_place, path) = with_file(8, 4, |_, _| 1.0);
    let long = ["body.corners=[[0, 0], [2, 0], [2, 1], [1, 1], [1, 4], [0, 4]]", "grid.coarse=[4, 8]"];
    let error = read(&path, &long).unwrap_err();
    check(
        &error,
        Kind::Read,
        7,
        "\"/young\"",
        "expected 4 by 8 numbers, found 8 by 4, which is the transposed shape",
        "[ix, iy]",
    );
}

proptest! {
    /// A body of whole cells has those cells, wherever it lies and however large it is; a grid example that is printed fits.
    #[test]
    fn steps_of_whole_cells_are_the_cells_below_them(
        heights in proptest::collection::vec(1..6_usize, 1..6), scale in 1e-6..1e6_f64, shift in -3.0..3.0_f64, fine in 1..4_usize
    ) {
        let (n, top) = (heights.len(), *heights.iter().max().unwrap());
        let point = |i: usize, j: usize| format!("[{:?}, {:?}]", (i as f64 + shift) * scale, j as f64 * scale);
        let mut corners = vec![point(0, 0), point(n, 0)];
        let mut last = 0;
        for (i, &height) in heights.iter().enumerate().rev() {
            if height != last {
                corners.extend((i + 1 < n).then(|| point(i + 1, last)));
                corners.push(point(i + 1, height));
                last = height;
            }
        }
        corners.push(point(0, last));
        let sides = vec!["\"a\""; corners.len()].join(", ");
        let text = format!(
            "[body]\ncorners = [{}]\nsides = [{sides}]\n[material]\nyoung = 1\npoisson = 0.3\n[sides.a]\npressure = 1\n\
             [method]\nmodel = \"msfem\"\n", corners.join(", ")
        );
        let grid = |coarse: [usize; 2], fine: usize| format!("{text}[grid]\ncoarse = {coarse:?}\nfine = [{fine}, {fine}]\n");
        let found = grid_of(&sound(&grid([n, top], fine), &[])).unwrap();
        for ix in 0..n * fine {
            for iy in 0..top * fine {
                prop_assert_eq!(found.inside(ix, iy), iy < heights[ix / fine] * fine);
            }
        }
        let example = parse(&text, &[]).unwrap_err();
        let help = example.help.strip_prefix("add [grid] ").unwrap().replace(", fine", "\nfine");
        sound(&format!("{text}[grid]\n{help}\n"), &[]);
    }
}

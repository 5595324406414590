//! The coupling of a body with the medium around it comes back with the same bits; parts that do not fit are refused.

use crate::common::{check_round_trip, spoiled};
use faer::Mat;
use proptest::prelude::*;
use steklov_bem_operators::Space;
use steklov_coupling::{
    CellIndicators, Coupled, Form, InterfaceIndicators, Interior, Jumps, Medium, Outline, Radiation, Trace, Transfer,
    Transmission,
};
use steklov_elastic::{Material, Plane};
use steklov_io::*;
use steklov_msfem::{Basis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, Loads, Multiscale};

/// A body of 3 × 2 blocks of 2 × 2 cells; some blocks of the upper row may be missing.
fn medium(missing: u8, origin: [f64; 2], spacing: [f64; 2]) -> HeterogeneousBody {
    let inside = |ix: usize, iy: usize| iy < 2 || missing >> (ix / 2) & 1 == 0;
    let grid = Grid::new(origin, spacing, [6, 4], inside).unwrap();
    let young = |c: usize| if inside(c / 4, c % 4) { 1.0 + ((c * c) % 13) as f64 / 7.0 } else { f64::NAN };
    let elasticity = Elasticity::new(0.3, steklov_elastic::Plane::Strain).unwrap();
    HeterogeneousBody::new(grid, (0..24).map(young).collect(), elasticity).unwrap()
}

fn exterior(trace: &Trace, parts: usize, degree: usize) -> Medium {
    Medium::new(trace.mesh(parts, degree).unwrap(), Material::new(2.0, 0.25, Plane::Strain).unwrap(), None).unwrap()
}

fn bits(values: &[f64]) -> Vec<u64> {
    crate::common::bits(values)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// The read data give the same solution, bit by bit, as the written ones.
    #[test]
    fn traces_media_solutions_and_indicators(
        missing in 0_u8..7, x in -1e3_f64..1e3, hx in 1e-3_f64..1e3, ratio in 0.5_f64..2.0,
        parts in 1_usize..3, degree in 1_usize..4, form in 0_usize..3, bounded: bool,
    ) {
        let medium = medium(missing, [x * hx, -0.0], [hx, ratio * hx]);
        let outline = Outline::new(&medium.grid).unwrap();
        let mut loads = Loads::default();
        outline.add_traction_jump(&medium.grid, &mut loads, |_, [n, _]| [n, 0.0]);
        let interior = Interior::fine(&medium, &loads).unwrap();
        let trace = check_round_trip(&interior.trace);
        let mesh = trace.mesh(parts, degree).unwrap();
        prop_assert_eq!(&mesh, &interior.trace.mesh(parts, degree).unwrap());
        let around = exterior(&trace, parts, degree);
        let read = check_round_trip(&around);
        check_round_trip(&Transfer::new(&trace, &mesh, &Space::new(&mesh)).unwrap());
        // elements of other lengths than the parts of the trace: a projection instead of values
        let coarser = steklov_bem_operators::Mesh::uniform(&trace.polygon, 12, degree);
        check_round_trip(&Transfer::new(&trace, &coarser, &Space::new(&coarser)).unwrap());

        let form = [Form::TwoField, Form::ThreeField, Form::Schur][form];
        let radiation = if bounded { Radiation::Bounded } else { Radiation::Decaying };
        let jump = |[x, y]: [f64; 2]| [0.01 * y, hx * (0.3 * x / hx).sin()];
        let solve = |around: &Medium| {
            let problem = Transmission::new(interior.clone(), around).unwrap();
            problem.solve(&around.space.interpolate(jump), form, radiation).unwrap()
        };
        let solved = solve(&around);
        let again = solve(&read);
        prop_assert_eq!(bits(&solved.displacement), bits(&again.displacement));
        prop_assert_eq!(bits(&solved.traction), bits(&again.traction));
        let back = check_round_trip(&solved);
        prop_assert_eq!(around.energy(&solved).to_bits(), read.energy(&back).to_bits());

        let traction = |_: [f64; 2], [n, _]: [f64; 2]| [n, 0.0];
        let jumps = Jumps { displacement: &jump, traction: &traction, halvings: 0 };
        let indicators =
            InterfaceIndicators::new(&around, &medium, &solved.displacement, &solved, form, &jumps).unwrap();
        prop_assert_eq!(indicators.hypersingular.is_some(), form == Form::ThreeField);
        prop_assert_eq!(&check_round_trip(&indicators), &indicators);
        let cells = CellIndicators::new(&medium, &solved.displacement, &|_| [0.0; 2], &|_, _| [None; 2]);
        prop_assert_eq!(&check_round_trip(&cells), &cells);
    }
}

/// Traces that oscillate.
#[test]
fn multiscale_traces() {
    let medium = medium(0b100, [0.0; 2], [0.5, 0.25]);
    let outline = Outline::new(&medium.grid).unwrap();
    for basis in [Basis::Coupled, Basis::Oscillatory] {
        let mesh = CoarseMesh::uniform(&medium.grid, [2, 2]).unwrap();
        let problem = Multiscale::new(&medium, mesh, basis).unwrap();
        let trace = Trace::coarse(&problem, &outline).unwrap();
        check_round_trip(&trace);
        let mesh = trace.mesh(1, 2).unwrap();
        check_round_trip(&Transfer::new(&trace, &mesh, &Space::new(&mesh)).unwrap());
    }
}

const ONE: Label<'static> = Label { unit: "1", meaning: "wrong", axes: &["entry"] };
const TWO: Label<'static> = Label { unit: "1", meaning: "wrong", axes: &["entry", "column"] };

fn vector(name: &str, v: Vec<f64>) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_vector(g, name, &v, &ONE)
}

fn points(v: Vec<[f64; 2]>) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_points(g, "points", &v, &TWO)
}

fn integers(name: &str, v: Vec<usize>) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_integers(g, name, &v, &ONE)
}

/// The unit square in 2 × 2 cells, 8 points.
fn square() -> (Trace, Medium) {
    let grid = Grid::rectangle([1.0, 1.0], [2, 2]).unwrap();
    let trace = Trace::fine(&grid, &Outline::new(&grid).unwrap());
    let around = exterior(&trace, 1, 1);
    (trace, around)
}

#[test]
fn traces_and_transfers_that_do_not_fit_are_refused() {
    let (trace, around) = square();
    let changed = |k: usize, x: [f64; 2]| {
        let mut all = trace.points.clone();
        all[k] = x;
        all
    };
    assert!(spoiled(&trace, "points", points(vec![])).contains("point 0 is not the corner (0, 0)"));
    assert!(spoiled(&trace, "points", points(changed(2, [1.0, 1e-9]))).contains("point 2 (1, 0.000000001)"));
    for x in [f64::NAN, f64::INFINITY, -0.5, 0.0, 1.5] {
        assert!(spoiled(&trace, "points", points(changed(1, [x, 0.0]))).contains("does not follow"), "{x}");
    }
    assert!(spoiled(&trace, "points", points(changed(1, [0.5, 0.1]))).contains("on edge 0"));
    let more = trace.points.iter().copied().chain([[0.0, 0.0]]).collect();
    assert!(spoiled(&trace, "points", points(more)).contains("1 points follow the last edge"));
    let none = trace.points.iter().copied().filter(|x| x.contains(&0.5)).collect();
    assert!(spoiled(&trace, "points", points(none)).contains("not the corner"));
    // a trace with one point less or more is valid, but its values have another size
    let fewer = trace.points.iter().copied().filter(|x| *x != [0.5, 0.0]).collect();
    assert!(spoiled(&trace, "points", points(fewer)).contains("expected a matrix (14, 16)"));
    assert!(spoiled(&trace, "unknowns", integers("unknowns", (0..15).collect())).contains("(16, 15)"));
    let twice = (0..16).map(|k| k / 2 * 2).collect();
    assert!(spoiled(&trace, "unknowns", integers("unknowns", twice)).contains("0 stands there twice"));
    let mut values = trace.values.clone();
    values.data_mut()[3] = f64::NAN;
    assert!(spoiled(&trace, "values", |g| save_sparse(g, "values", &values, &TWO)).contains("entry 3 is NaN"));

    let transfer = Transfer::new(&trace, &around.mesh, &around.space).unwrap();
    let other = || crate::common::sparse(16, 14);
    assert!(spoiled(&transfer, "mass", |g| save_sparse(g, "mass", &other(), &TWO)).contains("(16, 14)"));
    assert!(spoiled(&transfer, "projection", |g| save_sparse(g, "projection", &other(), &TWO)).contains("(16, 16)"));
    let mut infinite = transfer.mass.to_csr();
    infinite.data_mut()[5] = f64::INFINITY;
    assert!(spoiled(&transfer, "mass", |g| save_sparse(g, "mass", &infinite, &TWO)).contains("entry 5 is inf"));
}

/// Replaces a part of a subgroup.
fn inner<'a>(
    group: &'a str,
    name: &'a str,
    replace: impl FnOnce(&Group) -> Result<(), IoError> + 'a,
) -> impl FnOnce(&Group) -> Result<(), IoError> + 'a {
    move |g| {
        let group = open_group(g, group)?;
        group.unlink(name).unwrap();
        replace(&group)
    }
}

/// The error of reading `value` after a change of its group.
fn altered<T: Persist>(value: &T, change: impl FnOnce(&Group) -> Result<(), IoError>) -> IoError {
    let (_folder, file) = crate::common::written(|f| {
        save(f, "value", value)?;
        change(&f.group("value").unwrap())
    });
    load::<T>(&file, "value").map(drop).unwrap_err()
}

#[test]
fn media_that_do_not_fit_are_refused() {
    let (trace, around) = square();
    let other = exterior(&trace, 2, 1);
    let mesh = altered(&around, |g| {
        g.unlink("mesh").unwrap();
        save(g, "mesh", &other.mesh)
    });
    assert!(mesh.to_string().contains("V has 16 rows and W 16, the mesh 32 unknowns"), "{mesh}");
    let unmatched = inner("operators", "V", |g| save_dense(g, "V", Mat::<f64>::identity(14, 14).as_ref(), &TWO));
    let error = altered(&around, unmatched).to_string();
    assert!(error.contains("/value/operators/K") && error.contains("14×16"), "{error}");
    for name in ["V", "K", "W"] {
        let nan = Mat::from_fn(16, 16, |i, j| if (i, j) == (3, 4) { f64::NAN } else { 1.0 });
        let error = altered(&around, inner("operators", name, |g| save_dense(g, name, nan.as_ref(), &TWO))).to_string();
        assert!(error.contains(&format!("/value/operators/{name}")) && error.contains("is NaN"), "{error}");
    }
    let mut mass = around.operators.mass.clone();
    mass.data_mut()[0] = f64::NAN;
    let error = altered(&around, inner("operators", "M", |g| save_sparse(g, "M", &mass, &TWO))).to_string();
    assert!(error.contains("/value/operators/M is invalid") || error.contains("entry 0 is NaN"), "{error}");
    for (name, value) in [("length", f64::NAN), ("length", 0.0), ("diameter", -1.0), ("diameter", f64::INFINITY)] {
        let error = altered(&around, inner("operators", name, vector(name, vec![value]))).to_string();
        assert!(error.contains(&format!("/value/operators/{name}")) && error.contains("is no length"), "{error}");
    }
    for part in ["mesh", "material", "operators"] {
        let error = altered(&around, |g| {
            g.unlink(part).unwrap();
            Ok(())
        });
        assert!(matches!(error, IoError::Missing { .. }) && error.to_string().contains(part), "{error}");
    }
}

#[test]
fn solutions_and_indicators_that_do_not_fit_are_refused() {
    let body = medium(0, [0.0; 2], [1.0; 2]);
    let interior = Interior::fine(&body, &Loads::default()).unwrap();
    let around = exterior(&interior.trace, 1, 1);
    let n = around.space.dofs();
    let problem = Transmission::new(interior, &around).unwrap();
    let solved: Coupled = problem.solve(&vec![0.0; n], Form::Schur, Radiation::Decaying).unwrap();
    let lists = ["displacement", "trace", "exterior_displacement", "traction", "constant", "resultant", "load_scale"];
    for name in lists {
        let length = if name == "load_scale" { 1 } else { 2 };
        let nan = vec![f64::NAN; if lists[..4].contains(&name) { n } else { length }];
        assert!(spoiled(&solved, name, vector(name, nan)).contains("entry 0 is NaN: it must be finite"), "{name}");
        let error = altered(&solved, |g| {
            g.unlink(name).unwrap();
            Ok(())
        });
        assert!(matches!(error, IoError::Missing { .. }) && error.to_string().contains(name), "{error}");
        if name != "displacement" {
            assert!(spoiled(&solved, name, vector(name, vec![1.0; 3])).contains("3"), "{name}");
        }
    }
    assert!(spoiled(&solved, "load_scale", vector("load_scale", vec![-1.0])).contains("-1 is no sum"));

    let indicators = InterfaceIndicators {
        traction: vec![1.0, 2.0],
        displacement: vec![0.0, f64::INFINITY],
        hypersingular: Some(vec![1.0, 2.0]),
        traction_error: vec![1.0, 2.0],
    };
    check_round_trip(&indicators);
    for name in ["traction", "displacement", "hypersingular", "traction_error"] {
        assert!(spoiled(&indicators, name, vector(name, vec![1.0])).contains("where"), "{name}");
        assert!(spoiled(&indicators, name, vector(name, vec![1.0, f64::NAN])).contains("entry 1 is NaN"), "{name}");
        assert!(spoiled(&indicators, name, vector(name, vec![-1e-9, 1.0])).contains("square of an energy"), "{name}");
    }
    let cells = CellIndicators { volume: vec![1.0, 0.0], jump: vec![3.0, 4.0], neumann: vec![0.0, 2.0] };
    assert!(spoiled(&cells, "jump", vector("jump", vec![1.0])).contains("1 entries where 2 are needed"));
    for name in ["volume", "jump"] {
        assert!(spoiled(&cells, name, vector(name, vec![f64::NAN, 1.0])).contains("entry 0 is NaN"), "{name}");
    }
}

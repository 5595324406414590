//! Grids, bodies, coarse meshes, bases and loads come back with the same bits; parts that do not fit are refused.

use crate::common::{check_round_trip, spoiled};
use faer::Mat;
use proptest::prelude::*;
use steklov_elastic::Plane;
use steklov_io::*;
use steklov_msfem::{
    Basis, CoarseCell, CoarseMesh, CoarseSystem, CrossingContrast, Elasticity, Extra, Grid, HeterogeneousBody,
    Indicators, Loads, Multiscale, mark, refine,
};

/// A body of 4 × 3 blocks of 4 × 4 cells, some of which are missing, with rough moduli; NaN outside.
fn medium(missing: u16, origin: f64, spacing: [f64; 2], strain: bool) -> HeterogeneousBody {
    let inside = |ix: usize, iy: usize| missing >> (ix / 4 * 3 + iy / 4) & 1 == 0;
    let grid = Grid::new([origin, -0.0], spacing, [16, 12], inside).unwrap();
    let young = |c: usize| if inside(c / 12, c % 12) { 1.0 + ((c * c) % 13) as f64 / 7.0 } else { f64::NAN };
    let plane = if strain { Plane::Strain } else { Plane::Stress };
    HeterogeneousBody::new(grid, (0..16 * 12).map(young).collect(), Elasticity::new(0.3, plane).unwrap()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn bodies_meshes_and_loads(
        missing in 0_u16..4095, origin in -1e9_f64..1e9, hx in 1e-9_f64..1e9, hy in 1e-3_f64..1e3, strain: bool,
        shares in prop::collection::vec(0.0_f64..1.0, 400), theta in 0.1_f64..0.9, bits in prop::array::uniform8(any::<f64>()),
    ) {
        let medium = medium(missing, origin, [hx, hy], strain);
        prop_assert_eq!(&check_round_trip(&medium.grid), &medium.grid);
        let back = check_round_trip(&medium);
        let u: Vec<f64> = (0..medium.grid.dofs()).map(|i| (i as f64).sin()).collect();
        prop_assert_eq!(back.energy(&u, &u).to_bits(), medium.energy(&u, &u).to_bits());
        let ratios = (0..16 * 12).map(|c| 0.49 * shares[c]).collect();
        let mixed = medium.clone().with_poisson(ratios).unwrap();
        let back = check_round_trip(&mixed);
        prop_assert_eq!(back.poisson(), mixed.poisson());
        prop_assert_eq!(back.energy(&u, &u).to_bits(), mixed.energy(&u, &u).to_bits());
        let mut mesh = CoarseMesh::uniform(&medium.grid, [4, 4]).unwrap();
        for _ in 0..3 {
            prop_assert_eq!(&check_round_trip(&mesh), &mesh);
            let indicators: Vec<f64> = (0..mesh.cells.len()).map(|c| shares[c % shares.len()]).collect();
            mesh = refine(&medium.grid, &mesh, &mark(&indicators, theta)).unwrap();
        }
        let mut loads = Loads::default();
        prop_assert_eq!(&check_round_trip(&loads), &loads);
        for (cell, side) in medium.grid.boundary() {
            loads.add_side(cell, side, [[1.0 / 3.0, -0.0], [cell as f64, 1e-300]]);
        }
        prop_assert_eq!(&check_round_trip(&loads), &loads);
        // in the unit of the cells: a wave that is far shorter is integrated for long
        loads.set_body_force(&medium, |x| [(x[1] / hy).sin(), -1.0]).unwrap();
        prop_assert_eq!(&check_round_trip(&loads), &loads);
        let [a, b, c, d, e, largest, at, share] = bits;
        check_round_trip(&Indicators {
            volume_mean: vec![a, b],
            volume_oscillation: vec![b, c],
            jump_mean: vec![c, f64::NAN],
            jump_oscillation: vec![d, -0.0],
            neumann: vec![e, a],
        });
        check_round_trip(&CrossingContrast { largest, at: [at, -0.0], share });
    }
}

#[test]
fn bases_and_coarse_systems() {
    let medium = medium(0b100, 0.0, [0.5, 0.25], true);
    let mesh = CoarseMesh::uniform(&medium.grid, [4, 2]).unwrap();
    let loads = Loads { boundary: [(0, [1.0; 8])].into(), body: Vec::new() };
    for kind in [Basis::Q1, Basis::Linear, Basis::Coupled, Basis::Oversampled(2), Basis::Periodic] {
        let mut problem = Multiscale::new(&medium, mesh.clone(), kind).unwrap();
        let basis = problem.cell_basis(1).unwrap();
        let back = check_round_trip(&basis);
        assert_eq!((back.values, back.stiffness), (basis.values, basis.stiffness));
        let system = problem.assemble(&loads, &Extra::default(), &mut |_| true).unwrap();
        let back = check_round_trip(&system);
        assert!(back.stiffness == system.stiffness && back.load == system.load);
    }
}

const ONE: Label<'static> = Label { unit: "1", meaning: "wrong", axes: &["entry"] };
const TWO: Label<'static> = Label { unit: "1", meaning: "wrong", axes: &["entry", "column"] };

fn integers(name: &str, v: Vec<usize>) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_integers(g, name, &v, &ONE)
}

fn pairs(name: &str, v: Vec<[usize; 2]>) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_pairs(g, name, &v, &TWO)
}

fn vector(name: &str, v: Vec<f64>) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_vector(g, name, &v, &ONE)
}

fn table(name: &str, n: usize, m: usize) -> impl FnOnce(&Group) -> Result<(), IoError> {
    move |g| save_dense(g, name, Mat::zeros(n, m).as_ref(), &TWO)
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let medium = medium(0b1, 0.0, [0.5, 0.25], false);
    let grid = &medium.grid;
    const LARGE: usize = i64::MAX as usize;
    assert!(spoiled(grid, "cells", pairs("cells", vec![[12, 12]])).contains("192 entries for 12 by 12"));
    assert!(spoiled(grid, "cells", pairs("cells", vec![[LARGE, LARGE]])).contains("/value/inside"));
    assert!(spoiled(grid, "cells", pairs("cells", vec![])).contains("0 rows"));
    assert!(spoiled(grid, "inside", integers("inside", vec![2; 192])).contains("2 is neither 0 nor 1"));
    assert!(spoiled(grid, "inside", integers("inside", vec![0; 192])).contains("none of 16 by 12 cells"));
    let points = |name: &'static str, x: f64| move |g: &Group| save_points(g, name, &[[x, 1.0]], &TWO);
    assert!(spoiled(grid, "spacing", points("spacing", 0.0)).contains("length 0"));
    assert!(spoiled(grid, "spacing", points("spacing", f64::INFINITY)).contains("length inf"));
    assert!(spoiled(grid, "origin", points("origin", f64::NAN)).contains("coordinate NaN"));
    assert!(spoiled(&medium, "young", vector("young", vec![1.0; 191])).contains("191 moduli for 16 by 12"));
    let mut young = vec![1.0; 192];
    young[0] = f64::NAN;
    crate::common::written(|f| {
        save(f, "value", &medium)?;
        let group = f.group("value").unwrap();
        group.unlink("young").unwrap();
        // outside of the body any value is allowed
        save_vector(&group, "young", &young, &ONE)?;
        load::<HeterogeneousBody>(f, "value").map(drop)
    });
    young.swap(0, 191);
    assert!(spoiled(&medium, "young", vector("young", young)).contains("cell (15, 11)"));
    let elasticity = &medium.elasticity;
    assert!(spoiled(elasticity, "poisson", vector("poisson", vec![0.5])).contains("0.5"));
    assert!(spoiled(elasticity, "plane", |g| save_text(g, "plane", "strains", "wrong")).contains("strains"));

    let mesh = CoarseMesh::uniform(grid, [4, 4]).unwrap();
    let first: Vec<[usize; 2]> = mesh.cells.iter().map(|c| c.first).collect();
    let n = first.len();
    let with = |first: [usize; 2]| {
        let mut all: Vec<[usize; 2]> = mesh.cells.iter().map(|c| c.first).collect();
        all[1] = first;
        all
    };
    assert!(spoiled(&mesh, "first", pairs("first", with(first[0]))).contains("overlaps another"));
    assert!(spoiled(&mesh, "first", pairs("first", with([first[0][0] + 3, first[0][1]]))).contains("overlaps another"));
    assert!(
        spoiled(&mesh, "first", pairs("first", with([LARGE, 0]))).contains("of 4 fine cells from 9223372036854775807")
    );
    assert!(spoiled(&mesh, "first", pairs("first", first[1..].to_vec())).contains("/value/size"));
    assert!(spoiled(&mesh, "size", pairs("size", vec![[4, 0]; n])).contains("of 0 fine cells"));
    assert!(spoiled(&mesh, "size", pairs("size", vec![[4, LARGE]; n])).contains("of 9223372036854775807 fine cells"));
    let none = |g: &Group| {
        g.unlink("size").unwrap();
        save_pairs(g, "size", &[], &TWO)?;
        save_pairs(g, "first", &[], &TWO)
    };
    assert!(spoiled(&mesh, "first", none).contains("none of 0 by 0 cells"));

    let basis = Multiscale::new(&medium, mesh, Basis::Coupled).unwrap().cell_basis(0).unwrap();
    assert!(spoiled(&basis, "size", pairs("size", vec![[4, 5]])).contains("60×8"));
    assert!(spoiled(&basis, "size", pairs("size", vec![[LARGE, LARGE]])).contains("/value/size"));
    assert!(spoiled(&basis, "size", pairs("size", vec![[0, 24]])).contains("0 by 24"));
    assert!(spoiled(&basis, "values", table("values", 50, 7)).contains("50×8"));
    assert!(spoiled(&basis, "stiffness", table("stiffness", 7, 8)).contains("8×8"));

    let mut loads = Loads { boundary: [(3, [1.0; 8]), (7, [2.0; 8])].into(), body: Vec::new() };
    assert!(
        spoiled(&loads, "boundary_cells", integers("boundary_cells", vec![7, 7])).contains("cell 7 follows cell 7")
    );
    assert!(spoiled(&loads, "boundary_cells", integers("boundary_cells", vec![3])).contains("1×8"));
    loads.set_body_force(&medium, |_| [0.0, -1.0]).unwrap();
    assert!(spoiled(&loads, "body", table("body", 191, 8)).contains("192×8"));
    assert!(spoiled(&loads, "body_cells", integers("body_cells", vec![LARGE])).contains("/value/body"));

    let stiffness = medium.stiffness();
    let system = CoarseSystem { load: vec![0.0; stiffness.rows()], stiffness };
    assert!(spoiled(&system, "load", vector("load", vec![0.0; 3])).contains("square matrix of 3 rows"));
    assert!(
        spoiled(&system, "stiffness", |g| save_sparse(g, "stiffness", &crate::common::sparse(3, 4), &TWO))
            .contains("(3, 4)")
    );

    let terms = vec![1.0, 2.0];
    let indicators = Indicators {
        volume_mean: terms.clone(),
        volume_oscillation: terms.clone(),
        jump_mean: terms.clone(),
        jump_oscillation: terms.clone(),
        neumann: terms,
    };
    for name in ["volume_oscillation", "jump_mean", "jump_oscillation", "neumann"] {
        assert!(spoiled(&indicators, name, vector(name, vec![1.0])).contains("1 entries where 2"));
    }
}

/// Coarse cells are read without a grid: large cells take no memory, and too many lines are refused.
#[test]
fn a_small_file_asks_for_little_memory() {
    let one = |size: usize| CoarseMesh {
        cells: vec![CoarseCell { first: [5, 7], size: [size, size] }],
        vertices: vec![[5, 7], [5 + size, 7], [5, 7 + size], [5 + size, 7 + size]],
        corners: vec![[0, 1, 3, 2]],
        hanging: Vec::new(),
    };
    let large = one(1 << 31);
    assert_eq!(check_round_trip(&large), large);
    let steps = |n: usize| {
        one(1).cells.into_iter().cycle().take(n).enumerate().map(|(k, mut cell)| {
            cell.first = [k, k];
            cell
        })
    };
    let stairs = |n: usize| {
        let grid = Grid::new([0.0; 2], [1.0; 2], [n, n], |ix, iy| ix == iy).unwrap();
        CoarseMesh::new(&grid, steps(n).collect()).unwrap()
    };
    let fits = stairs(2047);
    assert_eq!(check_round_trip(&fits), fits);
    let (folder, path) = crate::common::place();
    let error = create_atomically(&path, false, |file| save(file, "value", &stairs(2048))).unwrap_err();
    assert!(matches!(error, IoError::Write { .. }) && error.to_string().contains("for 2048 coarse cells"), "{error}");
    drop(folder);
    // a file with as many cells as rectangles is always read
    let grid = Grid::rectangle([1.0, 1.0], [2100, 2000]).unwrap();
    let all = CoarseMesh::uniform(&grid, [1, 1]).unwrap();
    let (_folder, file) = crate::common::written(|file| save(file, "value", &all));
    assert!(load::<CoarseMesh>(&file, "value").unwrap() == all);
    let (first, size): (Vec<[usize; 2]>, Vec<[usize; 2]>) = steps(2048).map(|c| (c.first, c.size)).unzip();
    let many = spoiled(&fits, "first", |g| {
        g.unlink("size").unwrap();
        save_pairs(g, "size", &size, &TWO)?;
        save_pairs(g, "first", &first, &TWO)
    });
    assert!(many.contains("4198401 rectangles for 2048 coarse cells"), "{many}");
}

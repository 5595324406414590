//! Boundary elements that are not those of the trace: finer ones, ones of higher degree, ones coarser than the grid.

use crate::common::{around, dense, difference, energy_error, manufactured, material, outer, problem};
use steklov_bem_operators::Mesh;
use steklov_coupling::{Coupled, CouplingError, Form, Interior, Medium, Outline, Radiation, Transfer, Transmission};
use steklov_msfem::{Grid, Loads, MsfemError};

const SAME: [f64; 2] = [2.0, 0.3];

/// Points around the unit square.
const POINTS: [[f64; 2]; 4] = [[0.9, 0.2], [-0.3, 1.4], [-0.7, -0.8], [5.0, -3.0]];

/// Relative errors of displacement and stress at those points.
fn errors_around(exterior: &Medium, solved: &Coupled) -> [f64; 2] {
    let field = exterior.field(solved);
    let (mut errors, mut scale) = ([0.0f64; 2], [0.0f64; 2]);
    for x in POINTS {
        let ((u, s), found) = (outer(&exterior.material, x), field.at(x));
        for i in 0..3 {
            if i < 2 {
                errors[0] = errors[0].max((found.displacement[i] - u[i]).abs());
                scale[0] = scale[0].max(u[i].abs());
            }
            errors[1] = errors[1].max((found.stress[i] - s[i]).abs());
            scale[1] = scale[1].max(s[i].abs());
        }
    }
    [errors[0] / scale[0], errors[1] / scale[1]]
}

#[test]
fn the_field_around_the_body_converges_by_order_two() {
    let mut before: Option<[f64; 2]> = None;
    for n in [8, 16, 32] {
        let (medium, loads) = manufactured(n, [20.0, 0.25], SAME);
        let interior = Interior::fine(&medium, &loads).unwrap();
        let exterior = around(&interior, 1, 1, SAME);
        let (problem, jump) = problem(interior, &exterior);
        let solved = problem.solve(&jump, Form::Schur, Radiation::Decaying).unwrap();
        let errors = errors_around(&exterior, &solved);
        println!("n = {n}: {errors:?}");
        if let Some(before) = before.replace(errors) {
            (0..2).for_each(|k| assert!(errors[k] < 0.3 * before[k], "{before:?} then {errors:?}"));
        }
    }
    assert!(before.is_some_and(|e| e[0] < 1e-3 && e[1] < 2e-3), "{before:?}");
}

#[test]
fn elements_finer_than_the_trace_and_of_any_degree_leave_the_error_of_the_body() {
    let n = 16;
    let (medium, loads) = manufactured(n, SAME, SAME);
    let interior = Interior::fine(&medium, &loads).unwrap();
    for (parts, degree) in [(2, 1), (3, 1), (1, 2), (2, 3)] {
        let exterior = around(&interior, parts, degree, SAME);
        let (problem, jump) = problem(interior.clone(), &exterior);
        for form in [Form::TwoField, Form::ThreeField] {
            let solved = problem.solve(&jump, form, Radiation::Decaying).unwrap();
            let error = energy_error(&medium, SAME, &solved.displacement);
            println!("{parts} parts of degree {degree} {form:?}: {error:.6}, {:?}", errors_around(&exterior, &solved));
            assert!((0.0485..0.0502).contains(&error), "{error}");
        }
    }
}

#[test]
fn a_few_elements_of_high_degree_serve_a_fine_grid() {
    let n = 32;
    let (medium, loads) = manufactured(n, SAME, SAME);
    let interior = Interior::fine(&medium, &loads).unwrap();
    let polygon = interior.trace.polygon.clone();
    // a break at a third is no point of the trace
    let breaks = vec![vec![1.0 / 3.0]; 4];
    for form in [Form::TwoField, Form::ThreeField, Form::Schur] {
        let errors = [1, 3, 6, 9].map(|p| {
            let mesh = Mesh::from_breaks(&polygon, &breaks, &vec![vec![p; 2]; 4]).unwrap();
            let exterior = Medium::new(mesh, material(SAME), None).unwrap();
            let (problem, jump) = problem(interior.clone(), &exterior);
            let solved = problem.solve(&jump, form, Radiation::Decaying).unwrap();
            energy_error(&medium, SAME, &solved.displacement)
        });
        println!("{form:?} {errors:?}");
        // that of elements on each side of a cell is 0.02486
        assert!(errors[0] > 0.2 && errors[1] < errors[0] && errors[2] < errors[1], "{errors:?}");
        assert!(errors[3] < 0.0253, "{errors:?}");
    }
}

#[test]
fn nested_traces_are_taken_as_they_are_and_others_are_projected() {
    let (medium, loads) = manufactured(6, SAME, SAME);
    let trace = Interior::fine(&medium, &loads).unwrap().trace;
    let polynomial = |[x, y]: [f64; 2]| [2.0 * x - 3.0 * y + 1.0, x + 0.5];
    let v: Vec<f64> = trace.points.iter().flat_map(|&x| polynomial(x)).collect();
    let values = faer::Mat::from_fn(v.len(), 1, |i, _| v[i]);
    let coarse = Mesh::from_breaks(&trace.polygon, &vec![vec![0.4]; 4], &vec![vec![3, 2]; 4]).unwrap();
    for (mesh, nested) in [(trace.mesh(1, 1).unwrap(), true), (trace.mesh(2, 3).unwrap(), true), (coarse, false)] {
        let exterior = Medium::new(mesh, material(SAME), None).unwrap();
        let transfer = Transfer::new(&trace, &exterior.mesh, &exterior.space).unwrap();
        // linear fields in both cases
        let found = dense(&transfer.projection) * &values;
        assert!(difference(found.col_as_slice(0), &exterior.space.interpolate(polynomial)) < 1e-12);
        // B = M Π where nothing is lost, and against continuous tractions else: constants are such
        let mass = dense(&exterior.operators.mass);
        let (b, through) = (dense(&transfer.mass), &mass * dense(&transfer.projection));
        let apart = (&b - &through).norm_max() / b.norm_max();
        assert_eq!(apart < 1e-13, nested, "{apart}");
        let sums = |m: &faer::Mat<f64>| {
            let of = |j: usize| (0..exterior.mesh.len()).map(|e| m[(2 * exterior.space.offset[e], j)]).sum::<f64>();
            (0..m.ncols()).map(of).collect::<Vec<f64>>()
        };
        assert!(difference(&sums(&b), &sums(&through)) < 1e-12);
    }
}

#[test]
fn holes_are_no_part_of_the_outline() {
    let square = |inside: &dyn Fn(usize, usize) -> bool| Grid::new([1.0, 2.0], [0.5, 0.25], [5, 6], inside).unwrap();
    let holed = Outline::new(&square(&|i, j| (i, j) != (2, 3))).unwrap();
    assert_eq!(holed.nodes.len(), 22);
    assert!((holed.polygon.area() - 2.5 * 1.5).abs() < 1e-14);
    let notched = Outline::new(&square(&|i, j| (i, j) != (0, 0))).unwrap();
    assert_eq!(notched.nodes.len(), 22);
    assert_eq!(notched.polygon.edges().len(), 6);
    for (inside, word) in [
        (&(|i: usize, j: usize| (i < 2) == (j < 2)) as &dyn Fn(usize, usize) -> bool, "touches"),
        (&|i: usize, _: usize| i != 2, "parts"),
    ] {
        let refused = Outline::new(&square(inside)).unwrap_err();
        assert!(matches!(&refused, CouplingError::Outline { what } if what.contains(word)), "{refused}");
    }
}

#[test]
fn what_cannot_be_solved_is_refused_with_numbers() {
    let (medium, mut loads) = manufactured(4, SAME, SAME);
    let interior = Interior::fine(&medium, &loads).unwrap();
    let exterior = around(&interior, 1, 1, SAME);
    let (transmission, jump) = problem(interior.clone(), &exterior);
    let solve = |jump: &[f64]| transmission.solve(jump, Form::Schur, Radiation::Decaying).unwrap_err().to_string();
    assert!(solve(&jump[1..]).contains("31 values, and the boundary elements 32"));
    let mut bad = jump.clone();
    bad[3] = f64::NAN;
    assert!(solve(&bad).contains("NaN at (-0.25, -0.5)"));
    // boundary elements of another body: shifted, smaller
    for (origin, h) in [([-0.4, -0.5], 0.25), ([-0.5, -0.5], 0.125)] {
        let other = Grid::new(origin, [h; 2], [4, 4], |_, _| true).unwrap();
        let mesh = Mesh::uniform(&Outline::new(&other).unwrap().polygon, 4, 1);
        let elsewhere = Medium::new(mesh, material(SAME), None).unwrap();
        let refused = Transmission::new(interior.clone(), &elsewhere).unwrap_err();
        assert!(matches!(refused, CouplingError::Boundary { .. }), "{refused}");
    }
    // V loses definiteness on the square of side 2.213, and a little above on few elements
    let mesh = || interior.trace.mesh(1, 1).unwrap();
    assert!(Medium::new(mesh(), material(SAME), Some(1.0 / 2.20)).is_ok());
    let refused = Medium::new(mesh(), material(SAME), Some(1.0 / 2.23)).unwrap_err().to_string();
    assert!(refused.contains("not positive definite"), "{refused}");
    assert!(matches!(interior.trace.mesh(0, 1), Err(CouplingError::Bem(_))));
    assert!(matches!(interior.trace.mesh(1, 0), Err(CouplingError::Bem(_))));
    // a resultant, just on either side of what counts as none
    let scale = transmission.balance.scale;
    for (part, fine) in [(0.9e-6, true), (1.1e-6, false)] {
        loads.add_side(0, 0, [[part * scale, 0.0], [0.0; 2]]);
        let (transmission, jump) = problem(Interior::fine(&medium, &loads).unwrap(), &exterior);
        loads.add_side(0, 0, [[-part * scale, 0.0], [0.0; 2]]);
        let solved = transmission.solve(&jump, Form::Schur, Radiation::Bounded);
        assert_eq!(solved.is_ok(), fine);
        assert!(fine || matches!(solved, Err(CouplingError::Unbalanced { .. })));
    }
    let mut infinite = Loads::default();
    infinite.add_side(0, 0, [[f64::INFINITY, 0.0], [0.0; 2]]);
    let body = Interior::fine(&medium, &infinite).unwrap();
    let refused = Transmission::new(body, &exterior).unwrap_err();
    assert!(matches!(refused, CouplingError::Inconsistent { .. }), "{refused}");
    let stopped = {
        let cells = steklov_msfem::CoarseMesh::uniform(&medium.grid, [2, 2]).unwrap();
        let mut elements = steklov_msfem::Multiscale::new(&medium, cells, steklov_msfem::Basis::Coupled).unwrap();
        Interior::coarse(&mut elements, &loads, &mut |_| false).unwrap_err()
    };
    assert_eq!(stopped, CouplingError::Msfem(MsfemError::Stopped));
}

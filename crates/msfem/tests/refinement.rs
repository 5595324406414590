//! Marked cells, split cells, and what adaptive coarse meshes gain.

use crate::common::{Cantilever, close, strain};
use proptest::prelude::*;
use steklov_elastic::Plane;
use steklov_msfem::{
    Basis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, Loads, MsfemError, mark, nodal_indicators, refine,
};
use steklov_quadrature::unit_uniform;

/// An L-shaped body of side 1 with `cells` × `cells` fine cells less the upper right quarter, clamped on the left, with the
/// traction (0, -1) on the right.
fn l_shape(cells: usize, young: impl Fn(usize) -> f64, elasticity: Elasticity) -> Cantilever {
    let h = 1.0 / cells as f64;
    let grid = Grid::new([0.0; 2], [h; 2], [cells; 2], |i, j| i < cells / 2 || j < cells / 2).unwrap();
    let body = HeterogeneousBody::new(grid, (0..cells * cells).map(young).collect(), elasticity).unwrap();
    let mut loads = Loads::default();
    for (cell, side) in body.grid.boundary() {
        if side == 1 && body.grid.cell(cell)[0] + 1 == cells {
            loads.add_side(cell, side, [[0.0, -h / 2.0]; 2]);
        }
    }
    let load = loads.nodal(&body);
    Cantilever { body, loads, load }
}

/// Unknowns and relative energy error of meshes that follow the nodal indicators.
fn adaptive(problem: &Cantilever, fine: &[f64], start: usize, most: usize) -> Vec<(usize, f64)> {
    let grid = &problem.body.grid;
    let held: Vec<bool> = (0..grid.dofs()).map(|u| grid.lattice(u / 2)[0] == 0).collect();
    let mut mesh = CoarseMesh::uniform(grid, [start; 2]).unwrap();
    let mut steps = Vec::new();
    loop {
        let solved = problem.on_mesh(mesh.clone(), Basis::Coupled, false);
        steps.push((solved.problem.dofs(), problem.errors(&solved, fine)[0]));
        if solved.problem.dofs() > most {
            return steps;
        }
        let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
        let squared = nodal_indicators(&problem.body, &mesh, &problem.load, &u, &held);
        mesh = refine(grid, &mesh, &mark(&squared, 0.5)).unwrap();
    }
}

/// The error at a number of unknowns, between steps on lines in the logarithms.
fn at(steps: &[(usize, f64)], dofs: usize) -> f64 {
    let after = steps.iter().position(|s| s.0 >= dofs).unwrap().max(1);
    let ([(n, e), (m, f)], x) = ([steps[after - 1], steps[after]], dofs as f64);
    let part = (x / n as f64).ln() / (m as f64 / n as f64).ln();
    (e.ln() + part * (f.ln() - e.ln())).exp()
}

#[test]
fn adaptive_cells_beat_uniform_ones_at_a_corner() {
    for (random, gains) in [(false, [0.9, 0.7, 0.5]), (true, [0.9, 0.75, 0.7])] {
        let young = |c: usize| 2000.0 + if random { 1000.0 * unit_uniform(5, c as u64) } else { 0.0 };
        let problem = l_shape(128, young, strain());
        let fine = problem.fine();
        let steps = adaptive(&problem, &fine, 32, 2300);
        let mut uniform = Vec::new();
        for (cells, gain) in [16, 8, 4].into_iter().zip(gains) {
            let solved = problem.multiscale([cells; 2], Basis::Coupled, false);
            let (dofs, error) = (solved.problem.dofs(), problem.errors(&solved, &fine)[0]);
            uniform.push((dofs, error));
            let found = at(&steps, dofs);
            assert!(found < gain * error, "{dofs} unknowns: {found} against {error} of uniform cells");
        }
        if !random {
            // linear elements reach N^(-1/2) where the corner, with r^0.54, does not let equal ones
            let rate = |(n, e): (usize, f64), (m, f): (usize, f64)| (e / f).ln() / (m as f64 / n as f64).ln();
            let (graded, equal) =
                (rate((130, at(&steps, 130)), (1666, at(&steps, 1666))), rate(uniform[0], uniform[2]));
            assert!(graded > 0.5 && equal < 0.4, "rates {graded} and {equal}");
        }
    }
}

#[test]
fn marks_are_counted() {
    let mesh = CoarseMesh::uniform(&Grid::rectangle([1.0; 2], [4; 2]).unwrap(), [2; 2]).unwrap();
    let refused = refine(&Grid::rectangle([1.0; 2], [4; 2]).unwrap(), &mesh, &[true; 3]);
    assert!(matches!(refused, Err(MsfemError::Inconsistent { .. })));
}

#[test]
fn equal_indicators_are_marked_together_and_bad_ones_never() {
    assert_eq!(mark(&[1.0, 4.0, 1.0 + 1e-9, 0.0, f64::NAN], 0.8), [true, true, true, false, false]);
    assert_eq!(mark(&[1.0, 4.0, 1.0], 0.6), [false, true, false]);
    assert_eq!(mark(&[0.0; 3], 0.5), [false; 3]);
    assert_eq!(mark(&[], 0.5), [false; 0]);
    assert_eq!(mark(&[0.1; 7], 1.0), [true; 7]);
}

/// Cells split by the bits of two rounds.
fn two_rounds(grid: &Grid, fine: [usize; 2], bits: [u64; 2]) -> [CoarseMesh; 3] {
    let first = CoarseMesh::uniform(grid, fine).unwrap();
    let marked = |mesh: &CoarseMesh, bits: u64| -> Vec<bool> {
        (0..mesh.cells.len()).map(|c| unit_uniform(bits, c as u64) < 0.3).collect()
    };
    let second = refine(grid, &first, &marked(&first, bits[0])).unwrap();
    let third = refine(grid, &second, &marked(&second, bits[1])).unwrap();
    [first, second, third]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_smallest_set_is_marked(squared in prop::collection::vec(0.0..1.0_f64, 1..60), theta in 0.05..1.0_f64) {
        let marked = mark(&squared, theta);
        let whole: f64 = squared.iter().sum();
        let taken: Vec<f64> = squared.iter().zip(&marked).filter(|(_, m)| **m).map(|(e, _)| *e).collect();
        let smallest = taken.iter().copied().fold(f64::INFINITY, f64::min);
        prop_assert!(taken.iter().sum::<f64>() >= theta * whole * (1.0 - 1e-12));
        prop_assert!(squared.iter().zip(&marked).all(|(e, m)| *m || *e <= smallest));
        // without those equal to the smallest one, too little is left
        let fewer: f64 = taken.iter().filter(|e| **e > smallest * (1.0 + 1e-5)).sum();
        prop_assert!(fewer < theta * whole);
    }

    #[test]
    fn marked_cells_are_split_and_few_vertices_hang(
        fine in prop::array::uniform2(1_usize..9),
        bits in any::<[u64; 2]>(),
    ) {
        let cells = fine.map(|m| 4 * m);
        let grid = Grid::new([0.0; 2], [1.0, 0.5], cells, |i, j| i < 2 * fine[0] || j < 2 * fine[1]).unwrap();
        let meshes = two_rounds(&grid, fine, bits);
        for mesh in &meshes {
            // that the body is filled once is judged by CoarseMesh::new, which made them
            let area: usize = mesh.cells.iter().map(|c| c.size[0] * c.size[1]).sum();
            prop_assert_eq!(area, 12 * fine[0] * fine[1]);
            let mut edges: Vec<_> = mesh.hanging.iter().map(|h| (h.cell, h.side)).collect();
            edges.sort_unstable();
            prop_assert!(edges.windows(2).all(|e| e[0] != e[1]), "two vertices hang on an edge");
        }
        for (k, pair) in meshes.windows(2).enumerate() {
            for (c, cell) in pair[0].cells.iter().enumerate() {
                if unit_uniform(bits[k], c as u64) < 0.3 && cell.size != [1, 1] {
                    prop_assert!(!pair[1].cells.contains(cell));
                }
            }
        }
    }

    #[test]
    fn refined_everywhere_is_uniform_of_half_the_size(
        half in prop::array::uniform2(1_usize..5), count in prop::array::uniform2(1_usize..5),
    ) {
        let fine = [2 * half[0], 2 * half[1]];
        let grid = Grid::rectangle([2.0, 1.0], [fine[0] * count[0], fine[1] * count[1]]).unwrap();
        let mesh = CoarseMesh::uniform(&grid, fine).unwrap();
        let refined = refine(&grid, &mesh, &vec![true; mesh.cells.len()]).unwrap();
        prop_assert_eq!(refined, CoarseMesh::uniform(&grid, half).unwrap());
        // single fine cells stay
        let smallest = CoarseMesh::uniform(&grid, [1; 2]).unwrap();
        prop_assert_eq!(refine(&grid, &smallest, &vec![true; smallest.cells.len()]).unwrap(), smallest);
    }

    #[test]
    fn refined_meshes_conform_and_bilinear_spaces_are_nested(
        fine in prop::array::uniform2(2_usize..7), bits in any::<[u64; 2]>(), plane in any::<bool>(),
    ) {
        let elasticity = Elasticity::new(0.3, if plane { Plane::Strain } else { Plane::Stress }).unwrap();
        let cells = [4 * fine[0], 2 * fine[1]];
        let young = (0..cells[0] * cells[1]).map(|c| 1.0 + 9.0 * unit_uniform(3, c as u64)).collect();
        let mut problem = Cantilever::new([2.0, 1.0], cells, young);
        problem.body.elasticity = elasticity;
        let body = HeterogeneousBody::new(problem.body.grid.clone(), problem.body.young.clone(), elasticity).unwrap();
        problem.body = body;
        let meshes = two_rounds(&problem.body.grid, fine, bits);
        for basis in [Basis::Q1, Basis::Coupled, Basis::Oscillatory] {
            let mut last = 0.0;
            for mesh in &meshes {
                let solved = problem.on_mesh(mesh.clone(), basis, false);
                let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
                // the mean field of cells that do not fit together would have another energy
                close("work is energy", problem.body.energy(&u, &u), solved.compliance, 1e-9);
                if basis == Basis::Q1 {
                    prop_assert!(solved.compliance >= last * (1.0 - 1e-10));
                    last = solved.compliance;
                }
            }
        }
    }
}

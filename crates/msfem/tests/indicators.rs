//! Residual indicators: published effectivities, parts that add up, and what must vanish.

use crate::common::{Cantilever, MESHES, Solved, bar, bar_moduli, close, kind, number, plate, reference, unless_held};
use proptest::prelude::*;
use steklov_elastic::Plane;
use steklov_msfem::{
    Basis, CoarseCell, CoarseMesh, Elasticity, Grid, HeterogeneousBody, Indicators, Loads, nodal_indicators,
};

fn held(problem: &Cantilever) -> Vec<bool> {
    let grid = &problem.body.grid;
    (0..grid.dofs()).map(|u| grid.lattice(u / 2)[0] == 0).collect()
}

/// η of the jump and the nodal variant.
fn estimates(problem: &Cantilever, solved: &Solved<'_>) -> [f64; 2] {
    let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
    let (mesh, held) = (&solved.problem.mesh, held(problem));
    let traction = |_: usize, side: usize| if side == 1 { [0.0, -1.0] } else { [0.0; 2] };
    let jump = Indicators::new(&problem.body, mesh, &[], &u, &unless_held(&problem.body, &held, traction)).squared();
    let nodal = nodal_indicators(&problem.body, mesh, &problem.load, &u, &held);
    [jump, nodal].map(|squared| squared.iter().sum::<f64>().sqrt())
}

#[track_caller]
fn judge(
    what: &str,
    problem: &Cantilever,
    solved: &Solved<'_>,
    fine: &[f64],
    wanted: &serde_json::Value,
    tolerance: f64,
) {
    let error = problem.errors(solved, fine)[0] * problem.body.energy(fine, fine).sqrt();
    let [jump, nodal] = estimates(problem, solved);
    close(&format!("{what} jump"), jump / error, number(&wanted["eff_jump"]), tolerance);
    close(&format!("{what} nodal"), nodal / error, number(&wanted["eff_nodal"]), tolerance);
}

#[test]
fn bars_have_the_published_effectivities() {
    let data = reference("bar");
    let tolerance = number(&data["tol_estimator_rel"]);
    for (random, name, kinds) in [(false, "hom", &["q1", "a", "b"][..]), (true, "rand", &["q1", "a", "b", "c"])] {
        let problem = bar(random, 1);
        let fine = problem.fine();
        for (mesh, cells) in MESHES {
            for word in kinds {
                let wanted = &data[name][format!("{word}_{mesh}")];
                let solved = problem.multiscale([cells; 2], kind(word, cells), false);
                judge(&format!("{name} {word} {mesh}"), &problem, &solved, &fine, wanted, tolerance);
            }
        }
    }
}

#[test]
fn high_contrast_has_the_published_effectivities() {
    let data = reference("high_contrast");
    for (mask, contrast) in ["inside", "crossing"].into_iter().flat_map(|m| [10, 100, 10_000].map(|c| (m, c))) {
        let problem = plate(mask, f64::from(contrast));
        let fine = problem.fine();
        let wanted = &data["estimator"][format!("{mask}_{contrast}")];
        let solved = problem.multiscale([16; 2], Basis::Coupled, false);
        judge(&format!("{mask} {contrast}"), &problem, &solved, &fine, wanted, 1e-6);
    }
}

#[test]
fn contrast_misleads_only_where_it_crosses_edges() {
    let effectivities = |mask: &str, contrast: f64| {
        let problem = plate(mask, contrast);
        let fine = problem.fine();
        let solved = problem.multiscale([16; 2], Basis::Coupled, false);
        let error = problem.errors(&solved, &fine)[0] * problem.body.energy(&fine, &fine).sqrt();
        estimates(&problem, &solved).map(|estimate| estimate / error)
    };
    for power in 1..=6 {
        let [jump, nodal] = effectivities("inside", 10.0_f64.powi(power));
        assert!((1.0..2.0).contains(&jump) && (1.5..3.0).contains(&nodal), "contrast 1e{power}: {jump}, {nodal}");
    }
    // where stiff parts cross, the field is nearly rigid: its residual is the load, whatever the error
    let crossing: Vec<[f64; 2]> = (1..=6).map(|power| effectivities("crossing", 10.0_f64.powi(power))).collect();
    assert!(crossing.windows(2).all(|c| c[1][0] < c[0][0] && c[1][1] < c[0][1]), "{crossing:?}");
    assert!(crossing[0].iter().all(|e| *e > 1.0) && crossing[2].iter().all(|e| *e < 0.5), "{crossing:?}");
    assert!(crossing[5].iter().all(|e| *e < 0.1), "{crossing:?}");
}

#[test]
fn the_fine_solution_has_no_nodal_residual() {
    let problem = Cantilever::with_weight([6.0, 1.0], [192, 32], bar_moduli(false, 1));
    let (fine, held) = (problem.fine(), held(&problem));
    let mesh = CoarseMesh::uniform(&problem.body.grid, [8; 2]).unwrap();
    let sum = |u: &[f64]| nodal_indicators(&problem.body, &mesh, &problem.load, u, &held).iter().sum::<f64>();
    // the residual of nothing is the load: h² at nodes inside, a half and a quarter of it on sides and at corners
    let squares = 191.0 * 31.0 + (2.0 * 191.0 + 31.0) / 4.0 + 2.0 / 16.0;
    let load = 8.0 * squares / 1024.0_f64.powi(2) / 2000.0;
    close("the load", sum(&vec![0.0; fine.len()]), load, 1e-12);
    assert!(sum(&fine) < 1e-12 * load);
}

#[test]
fn bubbles_leave_no_residual_inside() {
    let problem = Cantilever::with_weight([6.0, 1.0], [192, 32], bar_moduli(true, 1));
    let solve = |bubbles| {
        let solved = problem.multiscale([16; 2], Basis::Coupled, bubbles);
        let u = solved.problem.downscale(&solved.coarse, &problem.loads, &solved.extra, &mut |_| true).unwrap();
        let forces = problem.body.forces(&u);
        let inside = |n: &usize| problem.body.grid.lattice(*n).iter().all(|i| i % 16 != 0);
        let nodes: Vec<usize> = (0..problem.body.grid.nodes()).filter(inside).collect();
        nodes.iter().map(|n| (problem.load[2 * n + 1] - forces[2 * n + 1]).abs()).fold(0.0, f64::max)
    };
    let cell = 1.0 / 1024.0;
    close("without bubbles each node keeps its load", solve(false), cell, 1e-6);
    assert!(solve(true) < 1e-6 * cell);
}

/// Quarters of those of the cells of 4 × 4 whose bit is set.
fn mixed(grid: &Grid, split: u64) -> CoarseMesh {
    let cells = CoarseMesh::uniform(grid, [4; 2]).unwrap().cells;
    let parts = |(k, c): (usize, CoarseCell)| -> Vec<CoarseCell> {
        let [i, j] = c.first;
        let quarter = |first| CoarseCell { first, size: [2; 2] };
        if split >> k & 1 == 1 {
            [[i, j], [i + 2, j], [i, j + 2], [i + 2, j + 2]].map(quarter).to_vec()
        } else {
            vec![c]
        }
    };
    CoarseMesh::new(grid, cells.into_iter().enumerate().flat_map(parts).collect()).unwrap()
}

/// An L-shaped body of 16 × 8 cells with some moduli.
fn l_shape(moduli: &[f64]) -> HeterogeneousBody {
    let grid = Grid::new([0.0; 2], [0.125, 0.25], [16, 8], |i, j| i < 8 || j < 4).unwrap();
    let young = (0..128).map(|c| moduli[c % moduli.len()]).collect();
    HeterogeneousBody::new(grid, young, Elasticity::new(0.3, Plane::Stress).unwrap()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn homogeneous_strain_has_no_residual_but_the_missing_traction(
        gradient in prop::array::uniform4(-1.0..1.0_f64),
        split in any::<u64>(),
    ) {
        let body = l_shape(&[3.0]);
        let grid = &body.grid;
        let mesh = mixed(grid, split);
        let [a, b, c, d] = gradient;
        let u: Vec<f64> = (0..grid.nodes()).flat_map(|n| {
            let [x, y] = grid.point(n);
            [a * x + b * y, c * x + d * y]
        }).collect();
        let [xx, yy, xy] = body.elasticity.unit_stress([a, d, b + c]).map(|s| 3.0 * s);
        let exact = |_: usize, side: usize| [[-xy, -yy], [xx, xy], [xy, yy], [-xx, -xy]][side];
        let free = vec![false; grid.dofs()];
        let right = Indicators::new(&body, &mesh, &[], &u, &unless_held(&body, &free, exact)).squared();
        prop_assert!(right.iter().sum::<f64>() < 1e-24);
        // twice the traction leaves the traction itself
        let twice = |cell: usize, side: usize| exact(cell, side).map(|t| 2.0 * t);
        let terms = Indicators::new(&body, &mesh, &[], &u, &unless_held(&body, &free, twice));
        let mut wanted = vec![0.0; mesh.cells.len()];
        for (fine, side) in grid.boundary() {
            let coarse = (0..wanted.len()).find(|&c| mesh.cells[c].fine_cells(grid).any(|f| f == fine)).unwrap();
            let h = grid.spacing[side % 2];
            let t = exact(fine, side);
            wanted[coarse] += h * mesh.cells[coarse].size[side % 2] as f64 * h * (t[0] * t[0] + t[1] * t[1]) / 3.0;
        }
        for (got, wanted) in terms.neumann.iter().zip(&wanted) {
            prop_assert!((got - wanted).abs() < 1e-12 * (1.0 + wanted));
        }
        // held components count nothing
        let all = vec![true; grid.dofs()];
        prop_assert!(Indicators::new(&body, &mesh, &[], &u, &unless_held(&body, &all, twice)).squared().iter().sum::<f64>() < 1e-24);
    }

    #[test]
    fn means_and_oscillations_of_a_linear_force_are_known(
        slope in -3.0..3.0_f64, constant in -3.0..3.0_f64, side in 0.2..5.0_f64,
    ) {
        // f = (c + s x, 0) on a cell of side H with E = 2: H² ∫ |f̄|²/E = H⁴ (c + s H/2)²/2, H² ∫ |f - f̄|²/E = s² H⁶/24
        let body = HeterogeneousBody::new(
            Grid::rectangle([side; 2], [4; 2]).unwrap(), vec![2.0; 16], Elasticity::new(0.3, Plane::Strain).unwrap(),
        ).unwrap();
        let mesh = CoarseMesh::uniform(&body.grid, [4; 2]).unwrap();
        let mut loads = Loads::default();
        loads.set_body_force(&body, |x| [constant + slope * x[0], 0.0]).unwrap();
        let u = vec![0.0; body.grid.dofs()];
        let terms = Indicators::new(&body, &mesh, &loads.body, &u, &|_, _| [Some(0.0); 2]);
        let scale = side.powi(4) * (1.0 + side).powi(2);
        let mean = side.powi(4) * (constant + slope * side / 2.0).powi(2) / 2.0;
        prop_assert!((terms.volume_mean[0] - mean).abs() < 1e-12 * scale);
        prop_assert!((terms.volume_oscillation[0] - slope * slope * side.powi(6) / 24.0).abs() < 1e-12 * scale);
    }

    #[test]
    fn jumps_of_a_kink_are_known_and_shared(split in any::<u64>(), moduli in prop::array::uniform2(1.0..9.0_f64)) {
        // u = (|x - 1|, 0): σ_xx jumps by c (E⁻ + E⁺) on the line x = 1 of length 1, σ_xy = 0; E is one number on each side
        let body = l_shape(&[1.0]);
        let grid = body.grid.clone();
        let young = (0..128).map(|c| moduli[usize::from(c / 8 >= 8)]).collect();
        let body = HeterogeneousBody::new(grid, young, body.elasticity).unwrap();
        let grid = &body.grid;
        let mesh = mixed(grid, split);
        let u: Vec<f64> = (0..grid.nodes()).flat_map(|n| [(grid.point(n)[0] - 1.0).abs(), 0.0]).collect();
        let terms = Indicators::new(&body, &mesh, &[], &u, &|_, _| [None; 2]);
        let [c, _, _] = body.elasticity.unit_stress([1.0, 0.0, 0.0]);
        let half = c * (moduli[0] + moduli[1]) / 2.0;
        // edges of length 1, or two of 1/2 where either neighbour is split
        let at = |i: usize| mesh.cells.iter().filter(|cell| cell.first[0] + cell.size[0] == i || cell.first[0] == i)
            .any(|cell| cell.first[1] < 4 && cell.size[1] == 2);
        let extent = if at(8) { 0.5 } else { 1.0 };
        let wanted = extent * half * half * 2.0 / (moduli[0] + moduli[1]);
        let vertical: f64 = terms.jump_mean.iter().sum();
        // σ_yy jumps on no edge, as u does not depend on y and E not on y either
        prop_assert!((vertical - wanted).abs() < 1e-12 * wanted);
        prop_assert!(terms.jump_oscillation.iter().sum::<f64>() < 1e-12 * wanted);
        for (term, cell) in terms.jump_mean.iter().zip(&mesh.cells) {
            let touches = cell.first[1] < 4 && (cell.first[0] == 8 || cell.first[0] + cell.size[0] == 8);
            prop_assert_eq!(touches, *term > 1e-9 * wanted);
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits(split in any::<u64>(), seed in any::<u64>()) {
        let body = l_shape(&[1.0, 7.0, 3.0, 40.0, 0.2]);
        let grid = &body.grid;
        let mesh = mixed(grid, split);
        let number = |i: usize| steklov_quadrature::unit_uniform(seed, i as u64) - 0.5;
        let u: Vec<f64> = (0..grid.dofs()).map(number).collect();
        let load: Vec<f64> = (0..grid.dofs()).map(|i| number(1000 + i)).collect();
        let held = vec![false; u.len()];
        let all = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (
                Indicators::new(&body, &mesh, &[], &u, &unless_held(&body, &held, |_, _| [1.0, 2.0])),
                nodal_indicators(&body, &mesh, &load, &u, &held),
            ))
        };
        prop_assert_eq!(all(1), all(3));
    }
}

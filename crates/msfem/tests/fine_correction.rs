//! The correction of a multiscale field leads to the solution on the fine grid.

use steklov_elastic::Plane;
use steklov_msfem::{Elasticity, Elimination, Grid, HeterogeneousBody, fine_correction};
use steklov_quadrature::unit_uniform;

/// A block of random cells, held on its left side in x and at one node in y, with random forces; what is held, and the solution.
fn solved() -> (HeterogeneousBody, Vec<f64>, Vec<bool>, Vec<f64>) {
    let grid = Grid::new([0.0; 2], [0.25, 0.2], [8, 6], |i, j| i < 6 || j < 4).expect("a grid");
    let young = (0..48).map(|c| 10.0_f64.powf(2.0 * unit_uniform(3, c))).collect();
    let body =
        HeterogeneousBody::new(grid, young, Elasticity::new(0.3, Plane::Strain).expect("a ratio")).expect("a body");
    let dofs = body.grid.dofs();
    let load: Vec<f64> = (0..dofs as u64).map(|i| unit_uniform(3, 100 + i) - 0.5).collect();
    let mut held = vec![false; dofs];
    for j in 0..=6 {
        held[2 * body.grid.node(0, j).expect("a node")] = true;
    }
    held[2 * body.grid.node(0, 0).expect("a node") + 1] = true;
    let fixed: Vec<usize> = (0..dofs).filter(|&i| held[i]).collect();
    let elimination = Elimination::new(body.stiffness(), &body.elimination_order(), &[], &fixed).expect("a factor");
    let u = elimination.expand(&elimination.reduce(&load, &vec![0.0; fixed.len()]), &[]);
    (body, load, held, u)
}

#[test]
fn the_whole_residual_gives_the_solution_and_a_looser_one_less_energy() {
    let (body, load, held, u) = solved();
    let c = fine_correction(&body, &load, &held, &[], 0.0);
    let size = u.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let worst = c.iter().zip(&u).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(worst < 1e-9 * size, "{worst:e} of {size:e}");
    let exact = body.energy(&u, &u);
    for enough in [1e-1, 1e-2, 1e-3] {
        let c = fine_correction(&body, &load, &held, &[], enough);
        let rest: Vec<f64> = c.iter().zip(&u).map(|(a, b)| a - b).collect();
        let missing = body.energy(&rest, &rest) / exact;
        assert!(missing > 1e-12 && missing < 10.0 * enough, "{enough}: {missing:e}");
        assert!(c.iter().zip(&held).all(|(c, held)| !held || *c == 0.0));
    }
}

/// A body that springs on its nodes alone hold: (K + d) c = r.
#[test]
fn what_resists_unknowns_is_on_the_diagonal() {
    let (body, load, held, _) = solved();
    let resist: Vec<f64> = (0..load.len() as u64).map(|i| 3.0 * unit_uniform(5, i)).collect();
    let c = fine_correction(&body, &load, &vec![false; held.len()], &resist, 0.0);
    let left = |i: usize, force: f64| (force + resist[i] * c[i] - load[i]).abs();
    let worst = body.forces(&c).into_iter().enumerate().fold(0.0, |m: f64, (i, force)| m.max(left(i, force)));
    assert!(worst < 1e-9, "{worst:e}");
    assert!(c.iter().any(|c| c.abs() > 1e-3));
}

#[test]
fn several_loads_have_the_fields_of_each() {
    let (body, load, held, u) = solved();
    let fixed: Vec<usize> = (0..u.len()).filter(|&i| held[i]).collect();
    let elimination = Elimination::new(body.stiffness(), &body.elimination_order(), &[], &fixed).expect("a factor");
    let moved: Vec<f64> = (0..fixed.len()).map(|i| i as f64).collect();
    let other = elimination.expand(&elimination.reduce(&load, &moved), &[]);
    let fields = elimination.fields(&[load.clone(), load], &[vec![0.0; fixed.len()], moved]);
    for (field, exact) in fields.iter().zip([u, other]) {
        let size = exact.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let worst = field.iter().zip(&exact).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(worst < 1e-12 * size, "{worst:e} of {size:e}");
    }
}

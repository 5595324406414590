//! Cells that differ in Poisson's ratio.

use proptest::prelude::*;
use steklov_elastic::Plane;
use steklov_msfem::{Basis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, MsfemError, Multiscale};
use steklov_quadrature::unit_uniform;

fn body(seed: u64, nu: f64, plane: Plane) -> HeterogeneousBody {
    let grid = Grid::new([0.0; 2], [0.5, 0.3], [4, 4], |i, j| i < 3 || j < 2).unwrap();
    let young = (0..16).map(|c| 1.0 + unit_uniform(seed, c)).collect();
    HeterogeneousBody::new(grid, young, Elasticity::new(nu, plane).unwrap()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Equal ratios are one ratio; of different ones K is symmetric, rigid motions have no forces, and a field of constant strain
    /// has in each cell the energy and the stress of that cell's own material.
    #[test]
    fn each_cell_has_its_own_material(seed in any::<u64>(), nu in -0.4..0.49_f64, stress: bool, g in prop::array::uniform4(-1.0..1.0_f64)) {
        let plane = if stress { Plane::Stress } else { Plane::Strain };
        let one = body(seed, nu, plane);
        let equal = body(seed, 0.1, plane).with_poisson(vec![nu; 16]).unwrap();
        let n = one.grid.dofs();
        let u: Vec<f64> = (0..n).map(|i| unit_uniform(seed, 100 + i as u64) - 0.5).collect();
        let size = one.energy(&u, &u);
        prop_assert!((equal.energy(&u, &u) - size).abs() < 1e-13 * size);
        for (a, b) in equal.forces(&u).iter().zip(one.forces(&u)) {
            prop_assert!((a - b).abs() < 1e-13 * (size + 1.0));
        }

        let ratios: Vec<f64> = (0..16).map(|c| -0.4 + 0.88 * unit_uniform(seed, 500 + c)).collect();
        let mixed = body(seed, 0.1, plane).with_poisson(ratios.clone()).unwrap();
        let k = mixed.stiffness();
        let scale = k.data().iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for (value, (i, j)) in k.iter() {
            prop_assert!((value - k.get(j, i).copied().unwrap_or(0.0)).abs() < 1e-13 * scale);
        }
        let field = |f: &dyn Fn([f64; 2]) -> [f64; 2]| -> Vec<f64> {
            (0..mixed.grid.nodes()).flat_map(|node| f(mixed.grid.point(node))).collect()
        };
        for rigid in [field(&|_| [1.0, 0.0]), field(&|_| [0.0, 1.0]), field(&|[x, y]| [-y, x])] {
            prop_assert!(mixed.forces(&rigid).iter().all(|f| f.abs() < 1e-12 * scale));
        }
        let strained = field(&|[x, y]| [g[0] * x + g[1] * y, g[2] * x + g[3] * y]);
        let strain = [g[0], g[3], g[1] + g[2]];
        let stresses = mixed.stresses(&strained);
        let mut energy = 0.0;
        for cell in mixed.grid.body_cells() {
            let own = Elasticity::new(ratios[cell], plane).unwrap().unit_stress(strain).map(|s| mixed.young[cell] * s);
            for (a, b) in own.iter().zip(stresses[cell]) {
                prop_assert!((a - b).abs() < 1e-12 * scale);
            }
            energy += 0.15 * own.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>();
        }
        prop_assert!((mixed.energy(&strained, &strained) - energy).abs() < 1e-12 * scale);
    }
}

#[test]
fn ratios_that_fit_no_body_are_refused() {
    let plane = Plane::Strain;
    assert!(matches!(body(1, 0.3, plane).with_poisson(vec![0.3; 15]), Err(MsfemError::Inconsistent { .. })));
    let mut ratios = vec![0.3; 16];
    ratios[15] = 0.5;
    // the last cell is not in the body
    assert!(body(1, 0.3, plane).with_poisson(ratios.clone()).is_ok());
    ratios[0] = 0.5;
    assert!(matches!(body(1, 0.3, plane).with_poisson(ratios), Err(MsfemError::Poisson { .. })));
}

/// 6 by 6 cells with moduli of their own.
fn square(seed: u64) -> HeterogeneousBody {
    let grid = Grid::rectangle([1.2, 0.9], [6, 6]).unwrap();
    let young = (0..36).map(|c| 1.0 + unit_uniform(seed, c)).collect();
    HeterogeneousBody::new(grid, young, Elasticity::new(0.3, Plane::Strain).unwrap()).unwrap()
}

const BASES: [Basis; 6] =
    [Basis::Q1, Basis::Linear, Basis::Coupled, Basis::Oscillatory, Basis::Oversampled(1), Basis::Periodic];

#[test]
fn equal_ratios_have_the_bases_of_one_ratio() {
    let (one, equal) = (square(3), square(3).with_poisson(vec![0.3; 36]).unwrap());
    for basis in BASES {
        let [a, b] = [&one, &equal].map(|body| {
            let mesh = CoarseMesh::uniform(&body.grid, [3, 3]).unwrap();
            Multiscale::new(body, mesh, basis).unwrap()
        });
        assert_eq!(a.patterns(), b.patterns());
        for cell in 0..4 {
            let (a, b) = (a.cell_basis(cell).unwrap(), b.cell_basis(cell).unwrap());
            for (a, b) in a.values.iter().flatten().zip(b.values.iter().flatten()) {
                assert!((a - b).abs() < 1e-13, "{basis:?}: {a} and {b}");
            }
            for (a, b) in a.stiffness.iter().flatten().zip(b.stiffness.iter().flatten()) {
                assert!((a - b).abs() < 1e-13, "{basis:?}: {a} and {b}");
            }
        }
    }
}

/// Inside of a coarse cell the fields of its basis are in equilibrium with each fine cell's own material, and their energy is the
/// coarse stiffness; rigid motions have none.
#[test]
fn bases_are_in_equilibrium_with_the_material_of_each_cell() {
    let ratios: Vec<f64> = (0..36).map(|c| -0.4 + 0.88 * unit_uniform(8, c)).collect();
    let body = square(5).with_poisson(ratios).unwrap();
    let scale = 2.0 / (1.0 - 2.0 * 0.48);
    for basis in BASES {
        let problem = Multiscale::new(&body, CoarseMesh::uniform(&body.grid, [6, 6]).unwrap(), basis).unwrap();
        let own = problem.cell_basis(0).unwrap();
        // the only coarse cell: nodes of its basis run along x first
        let at = |node: usize| {
            let [i, j] = body.grid.lattice(node);
            j * 7 + i
        };
        let field = |c: usize| -> Vec<f64> {
            (0..body.grid.dofs()).map(|dof| own.values[2 * at(dof / 2) + dof % 2][c]).collect()
        };
        let fields: Vec<Vec<f64>> = (0..8).map(field).collect();
        for (a, u) in fields.iter().enumerate() {
            for (b, v) in fields.iter().enumerate() {
                assert!((body.energy(u, v) - own.stiffness[a][b]).abs() < 1e-12 * scale, "{basis:?}");
            }
            if matches!(basis, Basis::Q1 | Basis::Linear) {
                continue;
            }
            let forces = body.forces(u);
            let inside = |node: &usize| body.grid.lattice(*node).iter().all(|i| (1..6).contains(i));
            let largest = (0..body.grid.nodes())
                .filter(inside)
                .fold(0.0f64, |m, n| m.max(forces[2 * n].abs()).max(forces[2 * n + 1].abs()));
            assert!(largest < 1e-12 * scale, "{basis:?}: {largest}");
        }
        let corners = [[0.0, 0.0], [1.2, 0.0], [1.2, 0.9], [0.0, 0.9]];
        let rotation: Vec<f64> = corners.iter().flat_map(|[x, y]| [-y, *x]).collect();
        for row in own.stiffness {
            let force: f64 = row.iter().zip(&rotation).map(|(k, u)| k * u).sum();
            assert!(force.abs() < 1e-12 * scale, "{basis:?}: {force}");
        }
    }
}

/// Cells that differ in ν alone have bases of their own, and equal pairs of E up to a factor and ν share one.
#[test]
fn patterns_see_the_ratio() {
    let grid = Grid::rectangle([1.0; 2], [4, 4]).unwrap();
    let body = |young: &dyn Fn(usize) -> f64, ratio: &dyn Fn(usize) -> f64| {
        let material = Elasticity::new(0.3, Plane::Strain).unwrap();
        let body = HeterogeneousBody::new(grid.clone(), (0..16).map(young).collect(), material).unwrap();
        body.with_poisson((0..16).map(ratio).collect()).unwrap()
    };
    let patterns = |body: &HeterogeneousBody| {
        let mesh = CoarseMesh::uniform(&body.grid, [2, 2]).unwrap();
        Multiscale::new(body, mesh, Basis::Coupled).unwrap().patterns()
    };
    // columns of cells: c / 4 is the place along x
    assert_eq!(patterns(&body(&|_| 1.0, &|_| 0.2)), 1);
    assert_eq!(patterns(&body(&|c| if c < 8 { 1.0 } else { 7.0 }, &|_| 0.2)), 1);
    assert_eq!(patterns(&body(&|_| 1.0, &|c| if c < 8 { 0.2 } else { 0.4 })), 2);
    assert_eq!(patterns(&body(&|_| 1.0, &|c| if c / 4 % 2 == 0 { 0.2 } else { 0.4 })), 1);
}

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
    let grid = Grid::new([0.0; 2], [0.25; 2], [4, 4], |_, _| true).unwrap();
    let whole = HeterogeneousBody::new(grid, vec![1.0; 16], Elasticity::new(0.3, plane).unwrap()).unwrap();
    let whole = whole.with_poisson(vec![0.2; 16]).unwrap();
    let mesh = CoarseMesh::uniform(&whole.grid, [2, 2]).unwrap();
    assert!(matches!(Multiscale::new(&whole, mesh, Basis::Coupled), Err(MsfemError::Inconsistent { .. })));
}

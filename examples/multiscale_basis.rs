//! The multiscale basis of one coarse cell, stored in HDF5: functions Φ_(p,k) of the corners p and directions k, columns of R, which solve
//! div σ(Φ) = 0 on the fine cells and are given on the edges. Then
//!
//! Σ_p Φ_(p,k) = e_k (partition of unity),   K^H = Rᵀ K R with the stiffness K of the fine cells (Zhang, Fu and Wu,
//! Int. J. Multiscale Comput. Eng. 8, 2010), and K^H 1 = 0.

use std::error::Error;

use steklov_elastic::Plane;
use steklov_io::{create_atomically, load, open, save};
use steklov_msfem::{Basis, CellBasis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, Multiscale};

/// Fine cells along each side.
const SIDE: usize = 12;

fn main() -> Result<(), Box<dyn Error>> {
    // a stiff square in the middle of a soft cell
    let grid = Grid::rectangle([1.0, 1.0], [SIDE; 2])?;
    let stiff = |k: usize| (4..8).contains(&k);
    let young = (0..SIDE * SIDE).map(|c| if stiff(c / SIDE) && stiff(c % SIDE) { 50.0 } else { 1.0 }).collect();
    let body = HeterogeneousBody::new(grid, young, Elasticity::new(0.3, Plane::Strain)?)?;
    let coarse = Multiscale::new(&body, CoarseMesh::uniform(&body.grid, [SIDE; 2])?, Basis::Oscillatory)?;
    let basis = coarse.cell_basis(0)?;

    let folder = tempfile::tempdir()?;
    let path = folder.path().join("basis.h5");
    create_atomically(&path, false, |file| save(file, "basis", &basis))?;
    let file = open(&path)?;
    let stored: CellBasis = load(&file, "basis")?;
    assert!(stored.values == basis.values && stored.stiffness == basis.stiffness);

    let unity = |row: usize, k: usize| (0..4).map(|p| stored.values[row][2 * p + k]).sum::<f64>();
    let off = |row: usize, k: usize| (unity(row, k) - if row % 2 == k { 1.0 } else { 0.0 }).abs();
    let partition = (0..stored.values.len()).flat_map(|row| [off(row, 0), off(row, 1)]).fold(0.0, f64::max);

    let mut product = [[0.0; 8]; 8];
    for (k, (i, j)) in body.stiffness().iter() {
        for (a, b) in (0..64).map(|e| (e / 8, e % 8)) {
            product[a][b] += stored.values[i][a] * k * stored.values[j][b];
        }
    }
    let scale = (0..8).map(|a| product[a][a]).fold(0.0, f64::max);
    let entries = (0..64).map(|e| (e / 8, e % 8));
    let difference = entries.map(|(a, b)| (product[a][b] - stored.stiffness[a][b]).abs()).fold(0.0, f64::max) / scale;
    println!("partition of unity {partition:.1e}, Rᵀ K R - K^H {difference:.1e} of the largest entry {scale:.4}");
    assert!(partition < 1e-12 && difference < 1e-12);
    for (a, k) in (0..16).map(|e| (e / 2, e % 2)) {
        assert!((0..4).map(|p| stored.stiffness[a][2 * p + k]).sum::<f64>().abs() < 1e-12 * scale);
    }
    Ok(())
}

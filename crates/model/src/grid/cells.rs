//! The cells of a scene and the basis on them.

use steklov_msfem::{Basis, Elasticity, Grid, HeterogeneousBody};
use steklov_problem::{BasisInput, Scene, grid_of, moduli, poisson_ratios};

use super::layout::GridLayout;
use crate::error::SolveError;

/// Cells, moduli and material of a scene on the grid of its layout.
pub(crate) fn body(scene: &Scene, layout: &GridLayout) -> Result<HeterogeneousBody, SolveError> {
    let coarse = grid_of(scene)?;
    let parts = layout.parts;
    let cells = coarse.cells.map(|n| n * parts);
    let spacing = coarse.spacing.map(|h| h / parts as f64);
    let grid = Grid::new(coarse.origin, spacing, cells, |ix, iy| coarse.inside(ix / parts, iy / parts))?;
    let young = moduli(scene, &grid)?;
    let poisson = poisson_ratios(scene, &grid)?;
    let material = scene.body().material();
    let body = HeterogeneousBody::new(grid, young, Elasticity::new(material.poisson, material.plane)?)?;
    Ok(match poisson {
        Some(poisson) => body.with_poisson(poisson)?,
        None => body,
    })
}

/// The basis that a scene asks for.
pub(crate) fn basis(scene: &Scene) -> Basis {
    let Some(grid) = &scene.body().grid else { return Basis::Coupled };
    match grid.basis {
        BasisInput::Linear => Basis::Linear,
        BasisInput::Coupled => Basis::Coupled,
        BasisInput::Oscillatory => Basis::Oscillatory,
        BasisInput::Oversampled => Basis::Oversampled(grid.oversample.unwrap_or(grid.fine[0].max(grid.fine[1]))),
        BasisInput::Periodic => Basis::Periodic,
        BasisInput::Q1 => Basis::Q1,
    }
}

//! The grid of a heterogeneous body and its moduli, as they are given.

use std::sync::Arc;

use steklov_elastic::Material;
use steklov_expression::Expression;

/// Most cells of a grid, over the whole bounding box.
pub const MOST_CELLS: usize = 1 << 26;

/// What the multiscale basis of a coarse cell does on its boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BasisInput {
    /// One component linear, the other one free and then dropped.
    Linear,
    /// One component linear, the other one zero; both kept.
    Coupled,
    /// As coupled, the component along an edge following the moduli there.
    Oscillatory,
    /// The coupled one of an enlarged cell, restricted.
    Oversampled,
    /// Bilinear and a periodic fluctuation.
    Periodic,
    /// Bilinear: no multiscale basis.
    Q1,
}

/// `[grid]`: rectangles over the bounding box of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridInput {
    /// Coarse cells along x and y.
    pub coarse: [usize; 2],
    /// Fine cells in each coarse cell along x and y.
    pub fine: [usize; 2],
    /// Basis of the coarse cells.
    pub basis: BasisInput,
    /// Fine cells by which an oversampled cell is enlarged on each side; `None`: as many as a coarse cell has.
    pub oversample: Option<usize>,
}

impl GridInput {
    /// Fine cells along x and y; 2²⁶ of them at most.
    pub fn cells(&self) -> [usize; 2] {
        [0, 1].map(|k| self.coarse[k] * self.fine[k])
    }
}

/// Young's modulus (stress) of the modulus cells.
#[derive(Debug, Clone)]
pub enum CellModuli {
    /// low + (high - low) u_i, where u_i is number i of the seed's uniform random numbers and i = ix·NY + iy.
    Uniform {
        /// Smallest modulus.
        low: f64,
        /// Largest modulus.
        high: f64,
        /// Seed.
        seed: u64,
    },
    /// NX × NY numbers.
    Table {
        /// The numbers, entry [ix, iy] at ix·NY + iy.
        values: Arc<[f64]>,
        /// Where they come from, for messages.
        source: String,
    },
    /// An expression of x and y, which holds at the centre of each modulus cell.
    Expression(Expression),
}

impl CellModuli {
    /// The one modulus of all cells, if the text of the scene gives it.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Uniform { low, high, .. } => (low == high).then_some(*low),
            Self::Table { .. } => None,
            Self::Expression(young) => young.constant(),
        }
    }
}

/// `[material.cells]`: NX × NY squares over the bounding box, counted from its lower left corner, with a modulus each.
#[derive(Debug, Clone)]
pub struct Cells {
    /// Side of a modulus cell (length).
    pub size: f64,
    /// Their moduli.
    pub young: CellModuli,
    /// The material of modulus 1 with the same Poisson's ratio in the same plane.
    pub of_unit_modulus: Material,
}

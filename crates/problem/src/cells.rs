//! The grid of a heterogeneous body and its moduli, as they are given.

use std::sync::Arc;

use steklov_bem_operators::Polygon;
use steklov_elastic::Material;
use steklov_elastic::plane::minus;
use steklov_expression::Expression;

/// Most cells of a grid, over the whole bounding box.
pub const MOST_CELLS: usize = 1 << 26;

/// The multiscale basis of a coarse cell on its boundary.
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

/// Every basis and its word.
pub const BASES: [(&str, BasisInput); 6] = [
    ("linear", BasisInput::Linear),
    ("coupled", BasisInput::Coupled),
    ("oscillatory", BasisInput::Oscillatory),
    ("oversampled", BasisInput::Oversampled),
    ("periodic", BasisInput::Periodic),
    ("q1", BasisInput::Q1),
];

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

    /// Whether there are cells, 2²⁶ at most.
    ///
    /// # Errors
    /// The number that is wrong by its key, what is wrong, and what to do.
    pub fn check(&self) -> Result<(), (&'static str, String, String)> {
        let count = |counts: [usize; 2]| counts[0] as f64 * counts[1] as f64;
        let total = count(self.coarse) * count(self.fine);
        let ([m, n], [k, l]) = (self.coarse, self.fine);
        let fewer = format!("take fewer cells: {MOST_CELLS} at most");
        if !(1.0..=MOST_CELLS as f64).contains(&total) {
            let key = if (1.0..=MOST_CELLS as f64).contains(&count(self.coarse)) { "fine" } else { "coarse" };
            let message = format!("the grid has {m} by {n} coarse cells of {k} by {l} fine ones, {total} in all");
            let help = if total < 1.0 { "give each number as 1 or more".into() } else { fewer };
            return Err((key, message, help));
        }
        match self.oversample {
            Some(cells) if cells > MOST_CELLS => {
                let message = format!("a coarse cell is to be enlarged by {cells} fine cells on each side");
                Err(("oversample", message, fewer))
            }
            _ => Ok(()),
        }
    }
}

/// How the table of a file lies in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableOrder {
    /// Entry [ix, iy], y upwards.
    Xy,
    /// Entry [iy, ix], y upwards.
    Yx,
    /// Entry [row, column], rows from the top, as in an image.
    Rows,
}

impl TableOrder {
    /// Shape of the table of NX × NY cells.
    pub fn shape(self, [nx, ny]: [usize; 2]) -> [usize; 2] {
        if self == Self::Xy { [nx, ny] } else { [ny, nx] }
    }

    /// The entry of cell ix, iy of NX × NY.
    pub fn entry(self, [ix, iy]: [usize; 2], [_, ny]: [usize; 2]) -> [usize; 2] {
        match self {
            Self::Xy => [ix, iy],
            Self::Yx => [iy, ix],
            Self::Rows => [ny - 1 - iy, ix],
        }
    }

    /// The meaning of the indices.
    pub fn words(self) -> &'static str {
        match self {
            Self::Xy => "first index along x, second one along y upwards",
            Self::Yx => "first index along y upwards, second one along x",
            Self::Rows => "rows along y from the top, columns along x, as in an image",
        }
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
        /// The numbers, that of cell ix, iy at ix·NY + iy.
        values: Arc<[f64]>,
        /// How they lie in the file.
        order: TableOrder,
        /// Where they come from, for messages.
        source: String,
    },
    /// An expression of x and y, which holds at the centre of each modulus cell.
    Expression(Expression),
}

impl CellModuli {
    /// The one modulus of all cells, if they do not differ.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Uniform { low, high, .. } => (low == high).then_some(*low),
            Self::Table { values, .. } => values.first().copied().filter(|first| values.iter().all(|v| v == first)),
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
    /// Their Poisson's ratios; none where all have that of the material.
    pub poisson: Option<CellModuli>,
    /// The material of modulus 1 with the same Poisson's ratio, about their mean if they differ, in the same plane.
    pub of_unit_modulus: Material,
}

impl Cells {
    /// Young's modulus and Poisson's ratio, where they are expressions.
    pub fn expressions(&self) -> impl Iterator<Item = &Expression> {
        std::iter::once(&self.young).chain(&self.poisson).filter_map(|of_cells| match of_cells {
            CellModuli::Expression(value) => Some(value),
            _ => None,
        })
    }

    /// The material of all cells, if they do not differ in it.
    pub fn uniform(&self) -> Option<Material> {
        let Material { poisson, plane, .. } = self.of_unit_modulus;
        let poisson = self.poisson.as_ref().map_or(Some(poisson), CellModuli::constant)?;
        Material::new(self.young.constant()?, poisson, plane).ok()
    }
}

/// Lower left corner and sides of the bounding box.
pub fn bounding_box(polygon: &Polygon) -> ([f64; 2], [f64; 2]) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for edge in polygon.edges() {
        for k in 0..2 {
            low[k] = low[k].min(edge.start[k]);
            high[k] = high[k].max(edge.start[k]);
        }
    }
    (low, minus(high, low))
}

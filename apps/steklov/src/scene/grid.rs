//! `[grid]` and `[material.cells]`: the grid of a heterogeneous body and its moduli.

use steklov_expression::Expression;

use super::error::{Problem, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::tree::Value;

/// Most cells of a grid, over the whole bounding box.
pub(crate) const MOST_CELLS: usize = 1 << 26;

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
    /// A dataset of NX × NY numbers.
    File {
        /// The HDF5 file, relative to the folder of the scene.
        path: String,
        /// Path of the dataset in it.
        dataset: String,
    },
    /// An expression of x and y, which holds at the centre of each modulus cell.
    Expression(Expression),
}

impl CellModuli {
    /// The one modulus of all cells, if the text of the scene gives it.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Uniform { low, high, .. } => (low == high).then_some(*low),
            Self::File { .. } => None,
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
}

pub(super) fn grid(field: &Field<'_>) -> Result<GridInput, Problem> {
    let fields = Fields::new(field, &keys::GRID)?;
    let counts = |key: &str| {
        let [x, y] = fields.require(key, &format!("{key} = [cells along x, cells along y]"))?.pair()?;
        Ok([x.whole(1, MOST_CELLS)?, y.whole(1, MOST_CELLS)?])
    };
    let (coarse, fine) = (counts("coarse")?, counts("fine")?);
    let count = |counts: [usize; 2]| counts[0] as f64 * counts[1] as f64;
    let total = count(coarse) * count(fine);
    if total > MOST_CELLS as f64 {
        let name = if count(coarse) > MOST_CELLS as f64 { "coarse" } else { "fine" };
        let message = format!(
            "the grid has {} by {} coarse cells of {} by {} fine ones, {total} in all",
            coarse[0], coarse[1], fine[0], fine[1]
        );
        let field = fields.require(name, "the numbers of cells")?;
        return Err(field.problem(message, format!("take fewer cells: {MOST_CELLS} at most")));
    }
    let words = [
        ("linear", BasisInput::Linear),
        ("coupled", BasisInput::Coupled),
        ("oscillatory", BasisInput::Oscillatory),
        ("oversampled", BasisInput::Oversampled),
        ("periodic", BasisInput::Periodic),
        ("q1", BasisInput::Q1),
    ];
    let basis = fields.get("basis").map_or(Ok(BasisInput::Coupled), |basis| basis.choice(&words))?;
    let oversample = fields.get("oversample").map(|cells| cells.whole(0, MOST_CELLS)).transpose()?;
    Ok(GridInput { coarse, fine, basis, oversample })
}

pub(super) fn cells(field: &Field<'_>, context: &Context<'_>) -> Result<Cells, Problem> {
    let fields = Fields::new(field, &keys::CELLS)?;
    let size = fields.require("size", "size = the edge length of a cell")?;
    let size = size.number_where(|v| v > 0.0 && v.is_finite(), "a positive length")?;
    let young = fields.require("young", "young = { uniform = [low, high], seed = 1 }")?;
    let young = match young.item.value {
        Value::Table(_) => table(&young)?,
        _ => CellModuli::Expression(young.expression_inside(context)?),
    };
    Ok(Cells { size, young })
}

/// Moduli that are random numbers or come from a file.
fn table(young: &Field<'_>) -> Result<CellModuli, Problem> {
    let table = Fields::new(young, &["uniform", "seed", "file", "dataset"])?;
    let beside = |key: &str, of: &str| match table.get(key) {
        Some(field) => {
            let message = format!("{} stands without {of}", field.name);
            Err(Problem::new(Kind::Conflict, field.item.place, message, format!("remove it, or add {of}")))
        }
        None => Ok(()),
    };
    match (table.get("uniform"), table.get("file")) {
        (Some(uniform), None) => {
            beside("dataset", "file")?;
            let [low, high] = uniform.point()?;
            if !(low > 0.0 && low <= high && high.is_finite()) {
                let message = format!("{} is [{low}, {high}]", uniform.name);
                return Err(uniform.problem(message, "both must be positive moduli, the lower one first"));
            }
            let seed = table.get("seed").map_or(Ok(0), |seed| seed.whole(0, i64::MAX as usize))? as u64;
            Ok(CellModuli::Uniform { low, high, seed })
        }
        (None, Some(file)) => {
            beside("seed", "uniform")?;
            let path = file.text()?.to_owned();
            let dataset = table.require("dataset", "dataset = \"/young\"")?.text()?.to_owned();
            Ok(CellModuli::File { path, dataset })
        }
        (Some(_), Some(file)) => {
            let message = format!("{} has both uniform and file", young.name);
            Err(Problem::new(Kind::Conflict, file.item.place, message, "keep one of the two"))
        }
        (None, None) => {
            let message = format!("{} has neither uniform nor file", young.name);
            let help = "write { uniform = [low, high], seed = 1 } or { file = \"young.h5\", dataset = \"/young\" }";
            Err(Problem::new(Kind::MissingKey, young.item.place, message, help))
        }
    }
}

//! Boxes of germs with polynomial degrees.

use crate::variable::EMPTY;
use crate::{CellBasis, Nodes, StochasticError, Variable};

/// Most cells of a mesh, and most nodes of a cell.
pub(crate) const MOST: usize = 1_000_000;

/// The germs of independent variables divided into boxes, on each of which answers are polynomials; they jump between
/// boxes.
///
/// Source: Babuška, Tempone and Zouraris (2004); Issaoui (2014), section 4.2.
#[derive(Debug, Clone, PartialEq)]
pub struct StochasticMesh {
    /// One for each direction.
    pub variables: Vec<Variable>,
    /// Boxes that share no inner point and fill the support.
    pub cells: Vec<StochasticCell>,
}

/// A box of germs.
#[derive(Debug, Clone, PartialEq)]
pub struct StochasticCell {
    /// Ends [a, b] in each direction (germs); infinite at the ends of an unbounded germ.
    pub bounds: Vec<[f64; 2]>,
    /// Polynomial degree in each direction.
    pub degree: Vec<usize>,
}

impl StochasticMesh {
    /// The mesh with `elements` intervals of equal probability (equal widths for uniform variables) in each direction, and
    /// this degree.
    ///
    /// The last direction runs fastest. No variable gives one cell, the point.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] unless there are as many `elements` and degrees as variables;
    /// [`StochasticError::Number`] for no element in a direction, more than a million cells, or cells so narrow that
    /// their ends are the same number.
    pub fn uniform(variables: Vec<Variable>, elements: &[usize], degree: &[usize]) -> Result<Self, StochasticError> {
        if elements.len() != variables.len() || degree.len() != variables.len() {
            return Err(StochasticError::Inconsistent {
                what: format!(
                    "{} variables with {} numbers of elements and {} degrees: each variable needs both",
                    variables.len(),
                    elements.len(),
                    degree.len()
                ),
            });
        }
        let count = elements.iter().map(|&n| n as f64).product::<f64>();
        if !(1.0..=MOST as f64).contains(&count) {
            return Err(StochasticError::Number {
                what: "the number of cells of a stochastic mesh".into(),
                value: count,
                wanted: "from 1 to 1e6",
            });
        }
        let mut cells = vec![StochasticCell { bounds: vec![], degree: degree.to_vec() }];
        for (variable, &n) in variables.iter().zip(elements) {
            let ends: Vec<f64> = (0..=n).map(|k| variable.quantile(k as f64 / n as f64)).collect();
            if let Some(k) = (0..n).find(|&k| ends[k] >= ends[k + 1]) {
                return Err(StochasticError::NoProbability { interval: [ends[k], ends[k + 1]], probability: 0.0 });
            }
            let extended = |cell: &StochasticCell, k: usize| {
                let mut cell = cell.clone();
                cell.bounds.push([ends[k], ends[k + 1]]);
                cell
            };
            cells = cells.iter().flat_map(|cell| (0..n).map(|k| extended(cell, k)).collect::<Vec<_>>()).collect();
        }
        Ok(Self { variables, cells })
    }

    /// Splits a cell at a germ; the lower part keeps the index, the upper one becomes the last cell, whose index is given
    /// back. Both have the degrees of the cell.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for a cell or direction that is not there; [`StochasticError::Number`] unless the
    /// germ is inside the cell; [`StochasticError::NoProbability`] if a part would have less than 1e-300.
    pub fn split(&mut self, cell: usize, direction: usize, at: f64) -> Result<usize, StochasticError> {
        self.check(cell, direction)?;
        let [a, b] = self.cells[cell].bounds[direction];
        if !(a < at && at < b) {
            return Err(StochasticError::Number {
                what: format!("the germ that splits cell {cell} with [{a}, {b}] in direction {direction}"),
                value: at,
                wanted: "inside the cell",
            });
        }
        for interval in [[a, at], [at, b]] {
            let probability = self.variables[direction].probability(interval);
            if probability < EMPTY {
                return Err(StochasticError::NoProbability { interval, probability });
            }
        }
        let mut upper = self.cells[cell].clone();
        upper.bounds[direction] = [at, b];
        self.cells[cell].bounds[direction] = [a, at];
        self.cells.push(upper);
        Ok(self.cells.len() - 1)
    }

    /// Raises the degree of a cell in a direction by one.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for a cell or direction that is not there.
    pub fn raise(&mut self, cell: usize, direction: usize) -> Result<(), StochasticError> {
        self.check(cell, direction)?;
        self.cells[cell].degree[direction] += 1;
        Ok(())
    }

    /// Probability of a cell.
    ///
    /// # Panics
    /// If the cell is not there.
    pub fn probability(&self, cell: usize) -> f64 {
        let bounds = &self.cells[cell].bounds;
        self.variables.iter().zip(bounds).map(|(v, &interval)| v.probability(interval)).product()
    }

    /// Ends of a cell in each direction; in place of an infinite end the germ beyond which the part `rare` of its probability
    /// lies.
    ///
    /// # Panics
    /// If the cell is not there.
    pub fn ends(&self, cell: usize, rare: f64) -> Vec<[f64; 2]> {
        let of = |(variable, &[a, b]): (&Variable, &[f64; 2])| {
            let below = variable.probability([variable.germ_support()[0], a]);
            let inside = variable.probability([a, b]);
            let end = |bound: f64, part: f64| {
                if bound.is_finite() { bound } else { variable.quantile(below + part * inside) }
            };
            [end(a, rare), end(b, 1.0 - rare)]
        };
        self.variables.iter().zip(&self.cells[cell].bounds).map(of).collect()
    }

    /// The cell with a germ; the first one for a germ on a common face, none for one outside of the support.
    pub fn locate(&self, germ: &[f64]) -> Option<usize> {
        let inside = |cell: &StochasticCell| cell.bounds.iter().zip(germ).all(|(&[a, b], x)| (a..=b).contains(x));
        self.cells.iter().position(inside)
    }

    /// Basis of a cell.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for a cell that is not there; those of [`CellBasis::new`].
    pub fn basis(&self, cell: usize, nodes: Nodes) -> Result<CellBasis, StochasticError> {
        match self.cells.get(cell) {
            Some(cell) => CellBasis::new(&self.variables, cell, nodes),
            None => Err(self.missing(cell, 0)),
        }
    }

    fn check(&self, cell: usize, direction: usize) -> Result<(), StochasticError> {
        let there = cell < self.cells.len() && direction < self.variables.len();
        if there { Ok(()) } else { Err(self.missing(cell, direction)) }
    }

    fn missing(&self, cell: usize, direction: usize) -> StochasticError {
        let (cells, directions) = (self.cells.len(), self.variables.len());
        let what = format!("cell {cell}, direction {direction} of a mesh of {cells} cells and {directions} directions");
        StochasticError::Inconsistent { what }
    }
}

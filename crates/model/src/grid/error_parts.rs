//! The estimated error of a grid's solution by its parts, and when it is not to be trusted.

use steklov_coupling::InterfaceIndicators;
use steklov_msfem::{CrossingContrast, Indicators};
use steklov_problem::Indicator;

use crate::doubt::Doubt;
use crate::estimators::{Estimator, Estimators, IN_CELLS, IN_COARSE_CELLS, ON_INTERFACE};

/// Contrast from which the estimate is less than the error: along coarse edges, whose traces fail; inside coarse cells whose
/// functions do not know the moduli; between pairs of opposite cells at a node, for that of the fine grid.
pub const FAILING: f64 = 1e2;

/// The estimated error: that of the coarse cells against bilinear elements on all fine ones, and that of these against the
/// exact solution.
#[derive(Debug, Clone, PartialEq)]
pub struct GridEstimate {
    /// η² of each coarse cell (force times length per thickness); empty without coarse cells.
    pub indicators: Vec<f64>,
    /// Residuals of coarse cells, of the edges between them and of tractions, if they are requested and known: the indicators
    /// are their sums, or nodal residuals.
    pub residual: Option<Indicators>,
    /// Sums of the residuals of the fine cells of a body in a medium without coarse cells, against the exact solution: volume,
    /// jumps, tractions; None if they are not requested.
    pub in_cells: Option<[f64; 3]>,
    /// Their sum: the squared multiscale error.
    pub multiscale: f64,
    /// The squared error of the fine grid.
    pub fine_grid: f64,
    /// The residuals of the equations where body and medium meet, boundary element by boundary element; None without a medium.
    pub interface: Option<InterfaceIndicators>,
    /// Energy of the part of the jump of the displacement that the nodes of each boundary element miss.
    pub jump: Vec<f64>,
    /// The squared error of the medium: the sum of [`Self::of_elements`].
    pub medium: f64,
    /// (multiscale + fine grid + medium)^½, energy norm.
    pub error: f64,
    /// Error over (2 strain energy)^½.
    pub relative: f64,
    /// How the moduli vary along coarse edges.
    pub crossing: Option<CrossingContrast>,
    /// Largest ratio of moduli in a coarse cell whose functions do not know them (basis q1); 1 otherwise.
    pub inside: f64,
    /// Largest ratio of moduli between the pairs of opposite cells that meet at a fine node, as on a checkerboard.
    pub crossed: f64,
}

impl GridEstimate {
    /// The residual estimators, each where it applies.
    pub fn estimators(&self) -> Estimators {
        // with the same scale as the estimate
        let scale = if self.relative > 0.0 { self.error / self.relative } else { 0.0 };
        let sum = |terms: &[f64]| terms.iter().sum::<f64>();
        let mut parts: Vec<(&str, f64)> = Vec::new();
        if let Some(terms) = &self.residual {
            parts.extend(IN_COARSE_CELLS.into_iter().zip(terms.parts()).map(|((name, _), part)| (name, sum(part))));
        }
        parts.extend(self.in_cells.iter().flat_map(|sums| IN_CELLS.into_iter().zip(*sums)));
        if parts.is_empty() {
            return Estimators::default();
        }
        let Some(interface) = &self.interface else {
            return Estimators { multiscale: Some(Estimator::new(parts, scale)), ..Estimators::default() };
        };
        let on_interface = [sum(&interface.traction), sum(&interface.displacement), sum(&self.jump)];
        parts.extend(ON_INTERFACE.into_iter().zip(on_interface));
        Estimators { coupling: Some(Estimator::new(parts, scale)), ..Estimators::default() }
    }

    /// η² of each boundary element (force times length per thickness): the error of its traction, or its residuals.
    pub fn of_elements(&self, indicator: Indicator) -> Vec<f64> {
        of_elements(self.interface.as_ref(), &self.jump, indicator)
    }

    /// Why it is not to be trusted.
    pub fn doubts(&self) -> Vec<Doubt> {
        let along_edges = self.crossing.map_or(1.0, |c| c.largest);
        if self.crossed.max(self.inside).max(along_edges) >= FAILING { vec![Doubt::Contrast] } else { Vec::new() }
    }
}

pub(super) fn of_elements(interface: Option<&InterfaceIndicators>, jump: &[f64], indicator: Indicator) -> Vec<f64> {
    let Some(interface) = interface else { return Vec::new() };
    let mut squared = match indicator {
        Indicator::Bubble => interface.traction_error.clone(),
        Indicator::Residual => interface.squared(),
    };
    squared.iter_mut().zip(jump).for_each(|(eta, jump)| *eta += jump);
    squared
}

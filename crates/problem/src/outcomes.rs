//! Looks at outcomes of the random input before anything is solved.

use steklov_stochastic::{CellBasis, Nodes, StochasticCell, StochasticError, Variable, smolyak};

use super::{DataError, Sampling, Scene, Stochastic, grid_of, moduli, poisson_ratios};

/// Outcomes beyond this probability at either end of a germ without bounds are not examined.
const RARE: f64 = 1e-12;
/// Most germs of which all combinations of ends are tried: with all data, and the modulus alone.
const DATA: usize = 5;
const CORNERS: usize = 8;
/// Most germs that are tried one by one: later modes of a field move less.
const SINGLE: usize = 24;

impl Scene {
    /// Looks at outcomes at the ends of the germs: each of the first 24 alone and all combinations of up to 5 with all data, the
    /// modulus at all combinations of up to 8.
    ///
    /// # Errors
    /// Those of [`Scene::outcome`] and [`Scene::check_data`].
    pub(super) fn check_outcomes(&self) -> Result<(), DataError> {
        let Some(random) = &self.random else { return Ok(()) };
        let nominal = random.nominal();
        let on_grid = self.uses(random).young && self.body().cells().is_some();
        let grid = on_grid.then(|| grid_of(self)).transpose()?;
        let named = |germs: &[f64], error: DataError| DataError {
            message: format!("for {}: {}", random.outcome_name(germs), error.message),
            ..error
        };
        let check = |germs: &[f64]| {
            let outcome = self.outcome(germs)?;
            if let Some(grid) = &grid {
                moduli(&outcome, grid).map_err(|e| named(germs, e))?;
                poisson_ratios(&outcome, grid).map_err(|e| named(germs, e))?;
            }
            outcome.check_data().and_then(|()| outcome.check_jumps()).map_err(|e| named(germs, e))
        };
        let ends: Vec<[f64; 2]> = random.germs.iter().map(|g| ends(&g.variable, &random.stochastic)).collect();
        for d in 0..ends.len().min(SINGLE) {
            for end in ends[d] {
                let mut germs = nominal.clone();
                germs[d] = end;
                check(&germs)?;
            }
        }
        let all_data = ends.len() <= DATA;
        if all_data || self.uses(random).young && ends.len() <= CORNERS {
            for corner in 0..1usize << ends.len() {
                let germs: Vec<f64> = ends.iter().enumerate().map(|(d, e)| e[corner >> d & 1]).collect();
                match all_data {
                    true => check(&germs)?,
                    false => drop(self.outcome(&germs)?),
                }
            }
        }
        Ok(())
    }
}

/// The ends of a germ: its bounds, else its rare values or the outermost points of the method's rule, whichever is farther out.
fn ends(variable: &Variable, settings: &Stochastic) -> [f64; 2] {
    let [low, high] = variable.germ_support();
    let end = |bound: f64, p: f64| if bound.is_finite() { bound } else { variable.quantile(p) };
    // a rule that cannot be made is refused, with its numbers, where it is used
    let points = outermost(variable, settings).unwrap_or_default();
    points.iter().fold([end(low, RARE), end(high, 1.0 - RARE)], |[a, b], &p| [a.min(p), b.max(p)])
}

/// Points of the outer cells in a germ, or of its finest rule in the sparse grid.
fn outermost(variable: &Variable, settings: &Stochastic) -> Result<Vec<f64>, StochasticError> {
    let variables = std::slice::from_ref(variable);
    let first = |points: Vec<Vec<f64>>| points.into_iter().map(|p| p[0]);
    match settings.method {
        Sampling::MonteCarlo | Sampling::Multilevel => Ok(Vec::new()),
        // of the lowest level: higher ones are chosen by what they cost
        Sampling::Corrected => Ok(first(smolyak(variables, 1)?.points).collect()),
        Sampling::Sparse => Ok(first(smolyak(variables, settings.level)?.points).collect()),
        Sampling::Galerkin | Sampling::Collocation => {
            let n = settings.elements as f64;
            let mut points = Vec::new();
            for [a, b] in [[0.0, 1.0 / n], [1.0 - 1.0 / n, 1.0]] {
                let bounds = vec![[variable.quantile(a), variable.quantile(b)]];
                let cell = StochasticCell { bounds, degree: vec![settings.degree] };
                points.extend(first(CellBasis::new(variables, &cell, Nodes::Gauss)?.points));
            }
            Ok(points)
        }
    }
}

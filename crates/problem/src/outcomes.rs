//! Looks at outcomes of the random input before anything is solved.

use steklov_expression::Value;
use steklov_msfem::Grid;
use steklov_stochastic::{CellBasis, Nodes, StochasticCell, StochasticError, Variable, smolyak};

use super::{
    CellModuli, Cells, DataError, DataErrorKind, Random, Sampling, Scene, Stochastic, bounding_box, grid_of, moduli,
    poisson_ratios,
};

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
        if let Some(grid) = &grid {
            self.check_fields_in_cells(random, grid, &ends)?;
        }
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

impl Scene {
    /// Looks at the materials of all cells where a field takes its ends in them: g = Σ a_m ξ_m is beyond √(2 ln 1/p) σ with a
    /// probability below p, and never beyond Σ |a_m| max |ξ_m|. Other names are nominal, variables at all combinations of up to 5.
    ///
    /// # Errors
    /// A modulus or a ratio that is impossible, with its place and the value of the field.
    fn check_fields_in_cells(&self, random: &Random, grid: &Grid, ends: &[[f64; 2]]) -> Result<(), DataError> {
        let Some(Cells { size, young, poisson, .. }) = self.body().cells() else { return Ok(()) };
        let ratio = poisson.as_ref().map(|poisson| (poisson, "Poisson's ratio", [-1.0, 0.5], "poisson"));
        let of_cells = std::iter::once((young, "Young's modulus", [0.0, f64::INFINITY], "young")).chain(ratio);
        let variables: Vec<usize> = random.names.iter().filter_map(|name| name.variable()).collect();
        let variables = if variables.len() <= DATA { &variables[..] } else { &[] };
        // the middles of modulus cells, in which expressions hold
        let (corner, _) = bounding_box(&self.problem.outline);
        let middle = |cell: usize| {
            let x = grid.centre(cell);
            [0, 1].map(|k| corner[k] + size * (((x[k] - corner[k]) / size).floor() + 0.5))
        };
        for (value, what, [low, high], key) in of_cells {
            let CellModuli::Expression(value) = value else { continue };
            let corners = (0..1usize << variables.len()).flat_map(|corner| random.fields().map(move |of| (corner, of)));
            for (corner, (field, first)) in corners.filter(|(_, (field, _))| value.uses(&field.name)) {
                let mut germs = random.nominal();
                variables.iter().enumerate().for_each(|(k, &germ)| germs[germ] = ends[germ][corner >> k & 1]);
                let (mut values, own) = (random.values(&germs), &ends[first..first + field.expansion.len()]);
                let extremes = grid.body_cells().flat_map(|cell| {
                    let at = middle(cell);
                    reach(&field.expansion.modes(field.support.coordinates(at)), own).map(|of_field| (at, of_field))
                });
                for ([x, y], of_field) in extremes {
                    values.insert(field.name.clone(), Value::Constant(of_field));
                    let found = value.with_values(&values).eval(x, y, 0.0);
                    if found > low && found < high {
                        continue;
                    }
                    let (name, text) = (&field.name, value.text());
                    let message = format!(
                        "{what} is {found} at the point ({x}, {y}) where {name} is {of_field}, as it may be: {text:?}"
                    );
                    let help = "take exp(s*g), which is positive, a smaller deviation, or fewer modes";
                    return Err(DataError::at(DataErrorKind::Data, &[vec!["material", "cells", key]], message, help));
                }
            }
        }
        Ok(())
    }
}

/// The ends of Σ a_m ξ_m in a cell for germs between their ends: those of all, or beyond which the sum is too rare.
fn reach(modes: &[f64], ends: &[[f64; 2]]) -> [f64; 2] {
    let deviation = modes.iter().map(|a| a * a).sum::<f64>().sqrt();
    let rare = (-2.0 * RARE.ln()).sqrt() * deviation;
    let most = modes.iter().zip(ends).map(|(a, [low, high])| a.abs() * low.abs().max(high.abs())).sum::<f64>();
    let most = most.min(rare);
    [-most, most]
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

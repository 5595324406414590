//! The model that a scene needs, and whether the scene fits the model that it asks for.

use steklov_expression::Expression;

use super::grid_fit::{check_edges, fitting_grid, without_grid, without_medium_around};
use super::{
    BasisInput, DataError, DataErrorKind as Kind, GridInput, Indicator, Model, Multiplier, Random, Sampling, Scene,
    check_body, check_modulus_cells, grid_of, poisson_ratios,
};

impl Scene {
    /// The model that is used, never [`Model::Auto`]: boundary elements unless the material differs from place to place, or the
    /// body force otherwise than as a + b x + c y; then multiscale finite elements, or finite elements where a coarse cell is one fine cell; with boundary
    /// elements around them where there is a medium. Families of grids, and Galerkin in all germs, are finite elements.
    pub fn model(&self) -> Model {
        let of_fine_cells =
            |random: &Random| matches!(random.stochastic.method, Sampling::Multilevel | Sampling::Galerkin);
        let of_fine_cells = self.random.as_ref().is_some_and(of_fine_cells);
        let one_fine_cell = of_fine_cells || self.body().grid.is_some_and(|grid| grid.fine == [1, 1]);
        match (self.method.model, self.problem.medium().is_some()) {
            (Model::Auto, _) if !self.varies() => Model::Bem,
            (Model::Auto, false) if one_fine_cell => Model::Fem,
            (Model::Auto, true) if one_fine_cell => Model::FemBem,
            (Model::Auto, false) => Model::Msfem,
            (Model::Auto, true) => Model::MsfemBem,
            (asked, _) => asked,
        }
    }

    /// Whether the body is on a grid.
    pub fn is_on_grid(&self) -> bool {
        self.model() != Model::Bem
    }

    /// Whether its unknowns are those of coarse cells.
    pub fn is_multiscale(&self) -> bool {
        matches!(self.model(), Model::Msfem | Model::MsfemBem)
    }

    /// Whether boundary elements cannot answer the scene.
    fn varies(&self) -> bool {
        let in_medium = self.problem.tie().is_some();
        let varies = !self.problem.has_several_bodies() && self.body().force_gradient().is_none();
        let force = self.body().force.is_some() && (in_medium || varies);
        let holes = in_medium && self.problem.outline.loops().len() > 1;
        self.body().cells().is_some() || force || holes
    }

    /// The body force (force/area) at a point; zero without one.
    ///
    /// # Errors
    /// A value that is not finite: names point and expression.
    pub fn force_at(&self, [x, y]: [f64; 2]) -> Result<[f64; 2], DataError> {
        let Some(force) = &self.body().force else { return Ok([0.0; 2]) };
        let value = force.each_ref().map(|f| f.eval(x, y, 0.0));
        match value.iter().position(|v| !v.is_finite()) {
            None => Ok(value),
            Some(k) => {
                let message = format!("the body force is {} at the point ({x}, {y})", value[k]);
                Err(DataError::of_values(&force[k], &message))
            }
        }
    }

    /// Whether the scene has what its model needs, and nothing that the model cannot treat.
    pub(super) fn check_model(&self) -> Result<(), DataError> {
        self.check_exterior()?;
        match (self.is_on_grid(), &self.body().grid) {
            (false, _) => self.check_uniform(),
            (true, Some(grid)) => {
                let wrong = |(key, message, help)| DataError::at(Kind::Value, &[vec!["grid", key]], message, help);
                grid.check().map_err(wrong)?;
                self.check_grid(grid)
            }
            (true, None) => Err(self.grid_error()),
        }
    }

    /// Boundary elements: one material, and a force that is affine in the place.
    fn check_uniform(&self) -> Result<(), DataError> {
        if self.body().cells().is_some() {
            let message = "boundary elements need one material, and [material.cells] has one for each cell".to_owned();
            let help = "use model = \"auto\" with a [grid], or give one Young's modulus as material.young";
            return Err(DataError::at(Kind::Conflict, &[vec!["method", "model"]], message, help));
        }
        let help = match self.problem.has_several_bodies() {
            true => "give a force a + b*x + c*y: among several bodies none is on a grid",
            false => "give a force a + b*x + c*y, or use model = \"auto\" with a [grid]",
        };
        self.force_that_varies(help).map_or(Ok(()), Err)?;
        self.problem.bodies.iter().flat_map(|body| &body.force).try_for_each(check_coefficients)
    }

    /// What is wrong with a force that depends on the place otherwise than as an affine function.
    fn force_that_varies(&self, help: &str) -> Option<DataError> {
        let mut forces = self.problem.bodies.iter().filter_map(|body| body.force.as_ref());
        let varies = |f: &Expression| f.affine_in_place().is_none();
        let (k, force) = forces.find_map(|force| force.iter().enumerate().find(|(_, f)| varies(f)))?;
        let text = force.text();
        let message = format!(
            "body_force.value[{k}] depends on the place, and not as a + b*x + c*y: {text:?}; with boundary elements it cannot"
        );
        Some(DataError::at(Kind::Value, &[vec!["body_force", "value", &k.to_string()]], message, help))
    }

    /// A grid is needed, and there is none.
    pub(crate) fn grid_error(&self) -> DataError {
        let grid = check_edges(self).ok().and_then(|()| fitting_grid(self));
        let fits = grid.is_some();
        let add = grid.map_or_else(|| without_grid(self), |grid| format!("add {grid}"));
        let asked = self.method.model != Model::Auto;
        if self.body().cells().is_none() && !asked {
            let help = if fits { format!("give a force a + b*x + c*y, or {add}") } else { add.clone() };
            if let Some(error) = self.force_that_varies(&help) {
                return error;
            }
        }
        let (message, key) = match (asked, self.body().cells()) {
            (true, _) => ("finite elements need a [grid]", vec!["method", "model"]),
            (false, Some(_)) => ("a material that differs from cell to cell needs a [grid]", vec!["material", "cells"]),
            (false, None) => ("a body with a force or holes in it, in a medium, needs a [grid]", vec!["body"]),
        };
        let no_grid = if fits { "" } else { ", and no grid has its outline" };
        let help = if fits && key == ["body"] { format!("{}; or {add}", without_medium_around(self)) } else { add };
        DataError::at(Kind::Missing, &[key], format!("{message}{no_grid}"), help)
    }

    /// The refusal of multilevel Monte Carlo without a family of grids.
    pub fn no_family_of_grids(&self) -> DataError {
        let message = "multilevel Monte Carlo needs a family of grids".to_owned();
        let help = "give a [grid] and method.model = \"fem\", or take method = \"monte-carlo\"";
        DataError::at(Kind::Unsupported, &[vec!["stochastic", "method"], vec!["random"]], message, help)
    }

    /// Random input on a grid: the methods that solve outcome by outcome, and Galerkin where all of them have one system.
    fn check_random_on_grid(&self) -> Result<(), DataError> {
        let Some(random) = &self.random else { return Ok(()) };
        match random.stochastic.method {
            Sampling::Multilevel if self.model() != Model::Fem => Err(self.no_family_of_grids()),
            Sampling::Galerkin => self.check_affine(random),
            Sampling::Collocation => {
                let message =
                    "on a grid each outcome is a body of its own, which a mesh of the germs would couple".to_owned();
                let help = "take method = \"sparse\" for smooth answers of few germs, or \"monte-carlo\"";
                let keys = [vec!["stochastic", "method"], vec!["random"]];
                Err(DataError::at(Kind::Unsupported, &keys, message, help))
            }
            _ => Ok(()),
        }
    }

    /// Finite elements: what they cannot treat, and whether body and modulus cells fit the grid.
    fn check_grid(&self, grid: &GridInput) -> Result<(), DataError> {
        self.check_random_on_grid()?;
        if self.method.multiplier == Multiplier::Stabilised {
            let message = "finite elements have biorthogonal multipliers only".to_owned();
            let help = "leave method.multiplier at \"biorthogonal\": it needs no stabilisation";
            return Err(DataError::at(Kind::Unsupported, &[vec!["method", "multiplier"]], message, help));
        }
        let harmonic = !matches!(grid.basis, BasisInput::Q1 | BasisInput::Linear);
        if self.is_multiscale() && self.method.indicator == Indicator::Residual && !harmonic {
            let message =
                "residual indicators need a basis that solves the equations inside of coarse cells".to_owned();
            let help = "leave method.indicator at \"bubble\", or take the basis \"coupled\" or \"oscillatory\"";
            return Err(DataError::at(Kind::Unsupported, &[vec!["method", "indicator"]], message, help));
        }
        match self.is_multiscale() {
            false => check_body(self, grid.cells(), "fine")?,
            true => check_body(self, grid.coarse, "coarse")?,
        }
        let Some(cells) = self.body().cells() else { return self.check_positive() };
        check_modulus_cells(self, cells, grid.cells())?;
        poisson_ratios(self, &grid_of(self)?)?;
        self.check_positive()
    }

    /// Moduli that are affine in the germs, positive whatever their values.
    fn check_positive(&self) -> Result<(), DataError> {
        match self.random.as_ref().filter(|random| self.is_of_all_outcomes(random)) {
            Some(random) => self.affine_moduli(random, &grid_of(self)?).map(drop),
            None => Ok(()),
        }
    }
}

/// Checks that the numbers of a force that is affine in the place are finite.
///
/// # Errors
/// The first one that is not.
pub(super) fn check_coefficients(force: &[Expression; 2]) -> Result<(), DataError> {
    for (k, expression) in force.iter().enumerate() {
        let coefficients = expression.affine_in_place().unwrap_or_default();
        if let Some(number) = coefficients.into_iter().find(|v| !v.is_finite()) {
            let what = if expression.constant().is_some() { "is" } else { "has the coefficient" };
            let message = format!("body_force.value[{k}] {what} {number}: {:?}", expression.text());
            return Err(DataError::new(Kind::Value, expression.place, message, "it must be finite"));
        }
    }
    Ok(())
}

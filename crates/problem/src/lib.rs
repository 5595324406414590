//! Problems as plain data: a body or a hole, what holds, loads or touches it, and how it is to be solved. No document and no file.
//!
//! ```text
//! Scene: Problem (bodies, interfaces between them), random input, method
//!   check ─► DataError (what, remedy, keys)        outcome(germs) ─► Scene without random input
//! ```
//!
//! ```
//! use steklov_problem::steklov_bem_operators::{Loop, Polygon};
//! use steklov_problem::steklov_elastic::{Material, Plane};
//! use steklov_problem::steklov_expression::Expression;
//! use steklov_problem::{Condition, Model, Scene};
//!
//! let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
//! let mut scene = Scene::new(Polygon::new(Loop::straight(corners, sides), vec![])?, Material::new(200.0, 0.3, Plane::Strain)?);
//! scene.problem.sides[0].condition = Condition::held();
//! scene.problem.sides[2].condition = Condition::Pressure(Expression::parse("1 + x", &Default::default())?);
//! scene.check()?;
//! assert_eq!(scene.model(), Model::Bem);
//!
//! scene.problem.sides[2].condition = Condition::Pressure(Expression::parse("1/(x - 1)", &Default::default())?);
//! let error = scene.check().unwrap_err();
//! assert!(error.message.starts_with("the pressure of side \"top\" is inf at the point (1, 1)"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod affine;
mod cells;
mod coarsened;
mod check;
mod cracks;
mod error;
mod facing;
mod facing_check;
mod far_field;
mod facets;
mod grid_fit;
mod join;
mod medium;
mod method;
mod model;
mod moduli;
mod outcome;
mod outcomes;
mod probe;
mod problem;
mod quantities;
mod random;
mod random_check;
mod separate;
mod sides;
mod signals;
mod spans;
mod springs;
mod supports;
mod units;

// the crates whose types appear in the interface
pub use {
    steklov_bem_operators, steklov_contact, steklov_coupling, steklov_elastic, steklov_expression, steklov_msfem,
    steklov_stochastic,
};

use std::collections::BTreeMap;

use steklov_bem_operators::Polygon;
use steklov_elastic::Material;

pub use affine::AffineModuli;
pub use cells::{BASES, BasisInput, CellModuli, Cells, GridInput, MOST_CELLS, TableOrder, bounding_box};
pub use check::STIFFNESS;
pub use cracks::{Crack, CrackError, cut_by_cracks};
pub use error::{About, DataError, DataErrorKind};
pub use facets::{Drawn, Facets, facets};
pub use facing::Seen;
pub use far_field::FarField;
pub use grid_fit::{check_body, grid_of};
pub use medium::Surroundings;
pub use method::{
    CUTTINGS, Cutting, Expectation, INDICATORS, Indicator, MODELS, MULTIPLIER_MESHES, MULTIPLIERS, Method, Model,
    Multiplier, REFINES, Refine, SOLVERS, Solver,
};
pub use moduli::{check_modulus_cells, field_cells, moduli, modulus_cells, poisson_ratios};
pub use probe::{MOST_POINTS, ProbeLine, Spot};
pub use problem::{Body, Faces, Interface, Law, Other, Place, Problem, Substance};
pub use quantities::{NamedQuantity, QuantityKind, Surfaces};
pub use random::{Germ, Random, RandomConstants, RandomName, Sampling, Stochastic};
pub use random_check::Uses;
pub use sides::{Condition, Contact, Friction, Side, Springs, Tie};
pub use signals::Signal;
pub use spans::Span;
pub use units::Units;

/// A problem that has passed all checks. Any consistent units; everything is per unit thickness.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Title.
    pub title: String,
    /// Names of its units.
    pub units: Units,
    /// Bodies and the laws between them.
    pub problem: Problem,
    /// Names in expressions that have one value.
    pub parameters: BTreeMap<String, f64>,
    /// Points of the body, of its boundary or of the medium around it at which results are wanted.
    pub probe: Vec<[f64; 2]>,
    /// Lines at whose points results are wanted.
    pub probe_lines: Vec<ProbeLine>,
    /// Sides along which results are wanted.
    pub probe_sides: Vec<usize>,
    /// Numbers that are wanted, by names.
    pub quantities: Vec<NamedQuantity>,
    /// How to solve.
    pub method: Method,
    /// What the result must be.
    pub expect: Vec<Expectation>,
    /// Random input, if any datum uses it; the other fields are then those of its nominal outcome.
    pub random: Option<Random>,
    /// Parameters and random names that no datum uses.
    pub unused: Vec<String>,
}

impl Scene {
    /// Smallest number of elements of the first mesh. On curves the degrees that follow do more than elements: with refinement
    /// by degrees, an outline with curves has as few as it can.
    pub fn first_elements(&self) -> usize {
        let outline = &self.problem.outline;
        if self.has_few_first_elements() {
            4 * outline.loops().len()
        } else {
            self.method.elements() * outline.bodies().len()
        }
    }

    /// Whether the first mesh has as few elements as it can.
    pub fn has_few_first_elements(&self) -> bool {
        self.method.elements.is_none() && self.method.refine == Refine::Hp && self.problem.outline.is_curved()
    }

    /// A body of one material whose sides are all free, to which the rest is then given.
    pub fn new(outline: Polygon, material: Material) -> Self {
        Self::of(Problem::new(outline, Substance::Homogeneous(material)))
    }

    /// A problem to be solved by the default method.
    pub fn of(problem: Problem) -> Self {
        Self {
            title: String::new(),
            units: Units::default(),
            problem,
            parameters: BTreeMap::new(),
            probe: Vec::new(),
            probe_lines: Vec::new(),
            probe_sides: Vec::new(),
            quantities: Vec::new(),
            method: Method::default(),
            expect: Vec::new(),
            random: None,
            unused: Vec::new(),
        }
    }

    /// The body that is solved.
    pub fn body(&self) -> &Body {
        &self.problem.bodies[0]
    }

    /// The body that is solved.
    pub fn body_mut(&mut self) -> &mut Body {
        &mut self.problem.bodies[0]
    }

    /// The contact of a side of the body that is solved.
    pub fn contact(&self, side: usize) -> Option<&Contact> {
        self.problem.contact(side)
    }

    /// The sides of the body that is solved that are in contact, rising.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, &Contact)> {
        (0..self.problem.sides.len()).filter_map(|side| Some((side, self.contact(side)?)))
    }

    /// Whether the problem can be solved: data along all sides and for outcomes at the ends of the germs, what the model needs,
    /// and nothing that it cannot treat.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), DataError> {
        self.check_beside_springs()?;
        self.problem.check_bodies()?;
        self.check_joints()?;
        self.check_random()?;
        self.check_probes()?;
        self.check_quantities()?;
        self.check_data()?;
        self.check_jumps()?;
        self.check_stiffness()?;
        self.check_model()?;
        if self.random.is_some() && self.method.multiplier == Multiplier::Stabilised {
            let message = "random input has biorthogonal multipliers only";
            let help = "leave method.multiplier at \"biorthogonal\": it needs no stabilisation";
            return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["method", "multiplier"]], message, help));
        }
        self.check_outcomes()
    }

    /// Lines and sides at which results are wanted.
    fn check_probes(&self) -> Result<(), DataError> {
        let refuse = |key: &str, (message, help): (String, String)| {
            DataError::at(DataErrorKind::Value, &[vec!["probe", key]], message, help)
        };
        self.probe_lines.iter().try_for_each(|line| line.check(&self.problem).map_err(|e| refuse("lines", e)))?;
        let count = self.problem.sides.len();
        match self.probe_sides.iter().find(|&&side| side >= count) {
            Some(side) => {
                let message = format!("there is no side {side}: the problem has {count}");
                Err(refuse("sides", (message, "sides are numbered from 0".to_owned())))
            }
            None => Ok(()),
        }
    }

    /// Refuses what cannot be solved with several bodies.
    fn check_joints(&self) -> Result<(), DataError> {
        if !self.problem.has_several_bodies() {
            return Ok(());
        }
        let refuse = |key: &str, message: &str, help: &str| {
            Err(DataError::at(DataErrorKind::Unsupported, &[vec!["method", key]], message.to_owned(), help))
        };
        if self.method.multiplier == Multiplier::Stabilised {
            return refuse(
                "multiplier",
                "several bodies have biorthogonal multipliers only",
                "leave it at \"biorthogonal\"",
            );
        }
        if self.method.indicator == Indicator::Residual {
            return refuse("indicator", "several bodies have no residual indicator", "leave it at \"bubble\"");
        }
        if !matches!(self.method.model, Model::Auto | Model::Bem) {
            return refuse("model", "several bodies are solved by boundary elements", "leave it at \"auto\"");
        }
        Ok(())
    }

    /// The error of a path that leads to no number of the result.
    pub fn quantity_error(&self, path: &str) -> DataError {
        let message = format!("the quantity {path:?} is not a number of the result");
        let help = "take paths of the JSON object: energy, contact.force.y, contact.max_pressure, reactions.SIDE.x, probe.0.displacement.y";
        DataError::at(DataErrorKind::Value, &[vec!["stochastic", "quantities"]], message, help)
    }
}

//! Problems as plain data: a body or a hole, what holds, loads or touches it, and how it is to be solved. No document and no file.
//!
//! ```text
//! Scene: polygon, material or cells, medium, sides, body force, random input, method
//!   check ─► DataError (what, remedy, keys)        outcome(germs) ─► Scene without random input
//! ```
//!
//! ```
//! use steklov_bem_operators::{Loop, Polygon};
//! use steklov_elastic::{Material, Plane};
//! use steklov_expression::Expression;
//! use steklov_problem::{Condition, Model, Scene};
//!
//! let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
//! let sides = ["floor", "right", "top", "left"].map(str::to_owned).to_vec();
//! let mut scene = Scene::new(Polygon::new(Loop { corners, sides }, vec![])?, Material::new(200.0, 0.3, Plane::Strain)?);
//! scene.sides[0].condition = Condition::held();
//! scene.sides[2].condition = Condition::Pressure(Expression::parse("1 + x", &Default::default())?);
//! scene.check()?;
//! assert_eq!(scene.model(), Model::Bem);
//!
//! scene.sides[2].condition = Condition::Pressure(Expression::parse("1/(x - 1)", &Default::default())?);
//! let error = scene.check().unwrap_err();
//! assert!(error.message.starts_with("the pressure of side \"top\" is inf at the point (1, 1)"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cells;
mod check;
mod error;
mod grid_fit;
mod medium;
mod method;
mod model;
mod moduli;
mod outcome;
mod outcomes;
mod random;
mod sides;
mod signals;
mod source;

use std::collections::BTreeMap;

use steklov_bem_operators::Polygon;
use steklov_elastic::Material;
use steklov_expression::Expression;

pub use cells::{BasisInput, CellModuli, Cells, GridInput, MOST_CELLS};
pub use check::data as side_data;
pub use error::{About, DataError, DataErrorKind};
pub use grid_fit::{bounding_box, check_body, grid_of};
pub use medium::MediumInput;
pub use method::{Expectation, Indicator, MODELS, MULTIPLIER_MESHES, Method, Model, Multiplier, Refine, Solver};
pub use moduli::{check_modulus_cells, moduli, modulus_cells};
pub use random::{Germ, Random, RandomConstants, RandomName, Sampling, Stochastic, Uses};
pub use sides::{Condition, Friction, Side};
pub use signals::Signal;
pub use source::Source;

/// A problem that has passed all checks. Any consistent units; everything is per unit thickness.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Title.
    pub title: String,
    /// The body; the plane outside of a hole where [`Scene::exterior`] has no body in it.
    pub polygon: Polygon,
    /// Its material; with [`Scene::cells`] these give Young's modulus, and that of the material has no meaning. That of the
    /// medium around a hole.
    pub material: Material,
    /// Young's modulus cell by cell.
    pub cells: Option<Cells>,
    /// The grid over the body.
    pub grid: Option<GridInput>,
    /// The unbounded medium around the body.
    pub exterior: Option<MediumInput>,
    /// Names in expressions that have one value.
    pub parameters: BTreeMap<String, f64>,
    /// The sides in the order of [`Polygon::side_names`]; at least one is loaded, held or in contact.
    pub sides: Vec<Side>,
    /// Force per area; constant with boundary elements.
    pub body_force: Option<[Expression; 2]>,
    /// Points of the body, of its boundary or of the medium around it at which results are wanted.
    pub probe: Vec<[f64; 2]>,
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
    /// A body of one material whose sides are all free, to which the rest is then given.
    pub fn new(polygon: Polygon, material: Material) -> Self {
        let free = |name: &String| Side { name: name.clone(), condition: Condition::Free };
        Self {
            title: String::new(),
            sides: polygon.side_names().iter().map(free).collect(),
            polygon,
            material,
            cells: None,
            grid: None,
            exterior: None,
            parameters: BTreeMap::new(),
            body_force: None,
            probe: Vec::new(),
            method: Method::default(),
            expect: Vec::new(),
            random: None,
            unused: Vec::new(),
        }
    }

    /// The side of a name.
    pub fn side_mut(&mut self, name: &str) -> Option<&mut Side> {
        self.sides.iter_mut().find(|side| side.name == name)
    }

    /// Whether the problem can be solved: data along all sides and for outcomes at the ends of the germs, what the model needs,
    /// and nothing that it cannot treat.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), DataError> {
        self.check_data()?;
        self.check_jumps()?;
        self.check_model()?;
        if self.random.is_some() && self.method.multiplier == Multiplier::Stabilised {
            let message = "random input has biorthogonal multipliers only";
            let help = "leave method.multiplier at \"biorthogonal\": it needs no stabilisation";
            return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["method", "multiplier"]], message, help));
        }
        self.check_outcomes()
    }

    /// The refusal of a path that is no number of the result.
    pub fn quantity_error(&self, path: &str) -> DataError {
        let message = format!("the quantity {path:?} is not a number of the result");
        let help = "take paths of the JSON object: energy, contact.force.y, contact.max_pressure, reactions.SIDE.x, probe.0.displacement.y";
        DataError::at(DataErrorKind::Value, &[vec!["stochastic", "quantities"]], message, help)
    }
}

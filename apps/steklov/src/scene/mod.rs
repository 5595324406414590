//! Scenes: what a user asks for, read from TOML, checked, and refused with file, line and remedy where it is wrong.
//!
//! ```text
//! text + overrides ─► tree of values with places ─► typed fields ─► Scene ─► data looked at along the sides
//! ```
//! Every key is read by hand, so that a wrong one can be answered with the nearest valid one.

mod error;
mod tree;
mod keys;
mod fields;
mod body;
mod sides;
mod method;
mod random;
mod germ_data;
mod outcomes;
mod grid;
mod exterior;
mod check;
mod model;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use steklov_bem_operators::Polygon;
use steklov_elastic::Material;
use steklov_expression::{Expression, Place};

pub use error::{SceneError, SceneErrorKind, Source};
pub use exterior::MediumInput;
pub(crate) use germ_data::Signal;
pub(crate) use grid::MOST_CELLS;
pub use grid::{BasisInput, CellModuli, Cells, GridInput};
pub(crate) use method::MULTIPLIER_MESHES;
pub use method::{Expectation, Indicator, Method, Model, Multiplier, Refine, Solver};
pub use random::{Germ, Random, RandomName, Sampling, Stochastic, Uses};
pub use sides::{Condition, Friction, Side};

use body::Parameters;
use error::{Problem, SceneErrorKind as Kind};
use fields::{Context, Field, Fields};
use tree::Item;

/// The commented scene that `steklov new` prints.
pub const TEMPLATE: &str = include_str!("template.toml");

/// A scene that has passed all checks. Any consistent units; everything is per unit thickness.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Title; the name of the file if the scene has none.
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
    /// Names and values of `[parameters]`.
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
    /// Names of `[parameters]` and `[random]` that no datum uses.
    pub unused: Vec<String>,
    /// The texts from which the scene was read.
    pub source: Source,
}

impl Scene {
    /// Reads the scene in the file `path` and applies overrides `KEY=VALUE`.
    ///
    /// # Errors
    /// [`SceneErrorKind::Read`] if the file cannot be read; else those of [`Scene::parse`].
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| {
            SceneError::unreadable(&name, e, "check the path; `steklov new` prints a scene to start from")
        })?;
        let text = String::from_utf8(bytes).map_err(|e| {
            SceneError::unreadable(&name, e.utf8_error(), "a scene is TOML text in UTF-8; is this another file?")
        })?;
        Self::parse(&text, &name, overrides)
    }

    /// Reads the scene in `text`; `name` is that of its file, for messages.
    ///
    /// # Errors
    /// Whatever is wrong with it.
    pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let source = Source { name: name.to_owned(), text: text.to_owned(), overrides: overrides.to_vec() };
        let root = tree::build(&source).map_err(|p| source.error(p))?;
        let scene = scene(&root, &source, None).map_err(|p| source.error(p))?;
        scene.check_overrides(&root)?;
        scene.check_data()?;
        scene.check_jumps()?;
        scene.check_model()?;
        if scene.random.is_some() && scene.method.multiplier == Multiplier::Stabilised {
            let message = "random input has biorthogonal multipliers only".to_owned();
            let help = "leave method.multiplier at \"biorthogonal\": it needs no stabilisation";
            return Err(scene.error_at(Kind::Unsupported, &[vec!["method", "multiplier"]], message, help));
        }
        scene.check_outcomes()?;
        Ok(scene)
    }
}

impl Scene {
    /// The outcome of the random input for these germs; the scene itself if it has none.
    ///
    /// # Errors
    /// A value that is impossible, such as a modulus that is not positive.
    pub fn outcome(&self, germs: &[f64]) -> Result<Self, SceneError> {
        let Some(random) = &self.random else { return Ok(self.clone()) };
        let outcome = scene(&random.root, &self.source, Some((random, germs)));
        outcome.map_err(|mut problem| {
            problem.message = format!("for {}: {}", random.outcome_name(germs), problem.message);
            self.source.error(problem)
        })
    }

    /// The key in which the scene of other overrides of this text differs, its goal apart: the tolerance and the limits.
    pub(crate) fn differing_key(&self, overrides: &[String]) -> Option<String> {
        let other = Source { overrides: overrides.to_vec(), ..self.source.clone() };
        let tree = |source: &Source| {
            let mut root = tree::build(source).ok()?;
            root.remove("method", &["tolerance", "max_dofs", "max_steps"]);
            Some(root)
        };
        match (tree(&self.source), tree(&other)) {
            (Some(a), Some(b)) => a.difference(&b),
            _ => Some(String::new()),
        }
    }

    /// The refusal of a path that is no number of the result.
    pub(crate) fn quantity_error(&self, path: &str) -> SceneError {
        let message = format!("the quantity {path:?} is not a number of the result");
        let help = "take paths of the JSON object: energy, contact.force.y, contact.max_pressure, reactions.SIDE.x, probe.0.displacement.y";
        self.error_at(Kind::Value, &[vec!["stochastic", "quantities"]], message, help)
    }

    /// An error about an expression of the scene, at its place.
    pub(crate) fn data_error(&self, expression: &Expression, message: &str) -> SceneError {
        let message = format!("{message}: expression {:?}", expression.text());
        let help = "write jumps and kinks with abs, sign, min, max or if, and keep the values bounded";
        self.source.error(Problem::new(Kind::Data, expression.place, message, help))
    }

    /// An error at the value of the first of these keys that the scene has, or at its first line.
    pub(crate) fn error_at(&self, kind: Kind, keys: &[Vec<&str>], message: String, help: &str) -> SceneError {
        let place = tree::build(&self.source)
            .map_or(Place::default(), |root| keys.iter().find_map(|key| root.at(key)).unwrap_or(&root).place);
        self.source.error(Problem::new(kind, place, message, help))
    }
}

/// The nominal scene, or one outcome of its random input.
fn scene(root: &Item, source: &Source, outcome: Option<(&Random, &[f64])>) -> Result<Scene, Problem> {
    let fields = Fields::new(&Field { name: String::new(), item: root }, &keys::SCENE)?;
    let title = fields.get("title").map_or(Ok(source.name.as_str()), |t| t.text())?.to_owned();
    let Parameters { values: parameters, uses: parameter_uses } =
        fields.get("parameters").map_or_else(|| Ok(Parameters::default()), |p| body::parameters(&p, source))?;
    let cavity = fields.get("material").is_none() && fields.get("exterior").is_some();
    let polygon = body::body(&fields.require("body", "a table [body] with corners and sides")?, cavity)?;
    let mut context = Context::new(source, parameters.clone());
    let declared = match fields.get("random") {
        Some(field) => random::random(&field, &polygon, &mut context)?,
        None => Vec::new(),
    };
    if let Some((random, germs)) = outcome {
        let (constants, outcomes) = random.values(germs);
        context.constants.extend(constants);
        context.fields.extend(outcomes);
    }
    let stochastic = fields.get("stochastic").map_or_else(|| Ok(Stochastic::default()), |f| random::stochastic(&f))?;
    context.used.take();
    let body = match cavity {
        true => None,
        false => {
            let field = fields.require("material", "a table [material] with young and poisson")?;
            random::check_poisson(&field, &declared, &context)?;
            Some(material(&field, &context)?)
        }
    };
    let plane = body.as_ref().map(|(material, _)| material.plane);
    let exterior = fields.get("exterior").map(|field| {
        random::check_poisson(&field, &declared, &context)?;
        exterior::exterior(&field, plane, &context)
    });
    let mut exterior = exterior.transpose()?;
    let (material, cells) = match (body, &exterior) {
        (Some(body), _) => body,
        (None, Some(exterior)) => (exterior.material, None),
        (None, None) => unreachable!("a hole has a medium around it"),
    };
    let in_material = context.used.borrow().clone();
    let grid = fields.get("grid").map(|field| grid::grid(&field)).transpose()?;
    let sides = sides::sides(fields.get("sides").as_ref(), &polygon, &context)?;
    let in_sides = context.used.take();
    let holds = |side: &Side| matches!(side.condition, Condition::Displacement { .. } | Condition::Contact { .. });
    if let Some(exterior) = exterior.as_mut().filter(|_| cavity && sides.iter().any(holds)) {
        exterior.bounded_by_supports();
    }
    let body_force = fields.get("body_force").map(|f| body::body_force(&f, &context)).transpose()?;
    let probe = fields
        .get("probe")
        .map_or_else(|| Ok(Vec::new()), |p| body::probe(&p, &polygon, exterior.is_some() && !cavity))?;
    let method = method::method(fields.get("method"))?;
    let mut expect = Vec::new();
    if let Some(field) = fields.get("expect") {
        method::expect(&field, "", &mut expect)?;
    }
    let by_medium = exterior.as_ref().is_some_and(|e| e.is_loaded());
    let by_force = body_force.is_some() && exterior.is_some() && !cavity;
    if sides.iter().all(|side| matches!(side.condition, Condition::Free)) && !by_medium && !by_force {
        let place = fields.get("sides").map_or(fields.place, |f| f.item.place);
        let names = polygon.side_names().join(", ");
        let sides = format!("[sides.NAME] with contact, displacement, traction or pressure; the sides are {names}");
        let help = match exterior {
            None => format!("add a table {sides}"),
            Some(_) if cavity => format!("add exterior.remote_stress, or a table {sides}"),
            Some(_) => "add exterior.remote_stress, displacement_jump or traction_jump, or a [body_force]".to_owned(),
        };
        return Err(Problem::new(Kind::MissingKey, place, "nothing loads, holds or touches the body", help));
    }
    let mut unused = Vec::new();
    let random = match outcome {
        Some(_) => None,
        None => {
            let in_body_force = context.used.take();
            random::check_fields(&sides, &declared)?;
            let used = |name: &str| [&in_material, &in_sides, &in_body_force].iter().any(|u| u.contains(name));
            let is_random = |name: &String| declared.iter().any(|(n, _)| n == name);
            let uses = random::uses(&sides, &is_random, in_material.iter().any(is_random), &in_body_force);
            unused.extend(declared.iter().map(|(name, _)| name.clone()).filter(|name| !used(name)));
            unused.extend(unused_parameters(&parameter_uses, &used));
            let (names, germs) = random::used(declared, &used)?;
            let random = Random { names, germs, stochastic, uses, cuts: Vec::new(), root: Arc::new(root.clone()) };
            (!random.names.is_empty()).then_some(random)
        }
    };
    let source = source.clone();
    let mut scene = Scene {
        title,
        polygon,
        material,
        cells,
        grid,
        exterior,
        parameters,
        sides,
        body_force,
        probe,
        method,
        expect,
        random,
        unused,
        source,
    };
    let cuts = scene.random.as_ref().map(|random| scene.cuts(random));
    if let (Some(random), Some(cuts)) = (&mut scene.random, cuts) {
        random.cuts = cuts;
    }
    Ok(scene)
}

/// The parameters that neither data nor used parameters use.
fn unused_parameters<'a>(
    parameters: &'a [(String, Vec<String>)],
    used: &dyn Fn(&str) -> bool,
) -> impl Iterator<Item = String> + use<'a> {
    // an expression has the names above it only, so that the last ones are decided first
    let mut reached: Vec<&str> = Vec::new();
    let mut unused = Vec::new();
    for (name, uses) in parameters.iter().rev() {
        if used(name) || reached.contains(&name.as_str()) {
            reached.extend(uses.iter().map(String::as_str));
        } else {
            unused.push(name.clone());
        }
    }
    unused.into_iter().rev()
}

/// `[material]`; with `cells` these give Young's modulus.
fn material(field: &Field<'_>, context: &Context<'_>) -> Result<(Material, Option<Cells>), Problem> {
    let fields = Fields::new(field, &keys::MATERIAL)?;
    match (fields.get("cells"), fields.get("young")) {
        (Some(cells), Some(young)) => Err(Problem::new(
            Kind::Conflict,
            young.item.place,
            format!("{} stands beside {}", young.name, cells.name),
            "the cells give Young's modulus: remove one of the two",
        )),
        (Some(cells), None) => {
            let cells = grid::cells(&cells, context)?;
            Ok((body::material(&fields, context, 1.0)?, Some(cells)))
        }
        (None, _) => {
            let young = fields.require("young", "young = 200.0, in the scene's unit of stress")?.constant(context)?;
            Ok((body::material(&fields, context, young)?, None))
        }
    }
}

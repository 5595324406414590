//! Scenes: the problems of users, read from TOML and checked. A wrong scene is refused with file, line and remedy.
//!
//! ```text
//! text + overrides ─► tree of values with places ─► typed fields ─► Scene ─► checked ─► Document
//! ```
//! Every key is read by hand, so that the error of a wrong key can name the nearest valid one.
//!
//! ```
//! let text = "body.corners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nbody.sides = [\"floor\", \"right\", \"top\", \"left\"]\n\
//!             material = { young = 200.0, poisson = 0.3 }\nsides.top.pressure = 1\n\
//!             sides.floor.displacement = [0, 0]\n";
//! let scene = steklov_document::parse(text, "block.toml", &["method.tolerance=1e-5".to_owned()])?;
//! assert_eq!((scene.body().material().young, scene.method.tolerance()), (200.0, 1e-5));
//!
//! let error = steklov_document::parse(&text.replace("young", "yuong"), "block.toml", &[]).unwrap_err();
//! assert_eq!((error.line(), error.help.as_str()), (Some(3), "did you mean young?"));
//! # Ok::<(), steklov_document::SceneError>(())
//! ```

// the crates whose types are in the interface
pub use steklov_problem;

mod error;
mod tree;
mod form;
mod keys;
mod dimensions;
mod help;
mod schema;
mod reference;
mod fields;
mod bodies;
mod body;
mod cracks;
mod curves;
mod sides;
mod method;
mod probe;
mod profiles;
mod quantities;
mod random;
mod random_field;
mod grid;
mod image;
#[cfg(feature = "hdf5")]
mod table_file;
#[cfg(not(feature = "hdf5"))]
#[path = "no_table_file.rs"]
mod table_file;
mod exterior;
mod units;
mod foreign;
mod source;
mod stochastic;

use std::collections::BTreeSet;
use std::path::Path;

use steklov_bem_operators::{Polygon, PolygonError};
use steklov_elastic::Material;
use steklov_expression::Expression;
use steklov_problem::{
    Body, DataError, DataErrorKind, FarField, GridInput, Law, Model, Problem, Random, RandomConstants, Scene,
    Stochastic, Substance, Tie, Units,
};

use error::{ReadError, SceneErrorKind as Kind, located};
pub use error::{SceneError, SceneErrorKind};
pub use foreign::{HDF5, foreign};
pub use help::full_key;
pub use reference::reference;
pub use schema::schema;
pub use source::Source;

use body::Parameters;
use cracks::Cracks;
use fields::{Context, Field, Fields};
use sides::Given;
use stochastic::Asked;
use tree::{Item, suggestion};

/// The commented scene with every key that `steklov new` prints.
pub const TEMPLATE: &str = include_str!("templates/contact.toml");

/// Commented scenes to start from, by the kind of problem.
pub const TEMPLATES: [(&str, &str); 6] = [
    ("contact", TEMPLATE),
    ("bodies", include_str!("templates/bodies.toml")),
    ("crack", include_str!("templates/crack.toml")),
    ("random", include_str!("templates/random.toml")),
    ("grid", include_str!("templates/grid.toml")),
    ("medium", include_str!("templates/medium.toml")),
];

/// The entry for the table `[stochastic]` without `[random]` in the list of unused names.
pub const STOCHASTIC: &str = "[stochastic]";

/// A scene with the texts from which it was read.
#[derive(Debug, Clone)]
pub struct Document {
    /// The scene that the texts describe.
    pub scene: Scene,
    /// The texts.
    pub source: Source,
}

impl Document {
    /// Reads the scene in the file `path` and applies overrides `KEY=VALUE`.
    ///
    /// # Errors
    /// [`Kind::Read`] if the file cannot be read; else as [`Document::parse`].
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| {
            SceneError::unreadable(&name, e, "check the path; `steklov new` prints a scene to start from")
        })?;
        if let Some((what, help)) = foreign(&bytes) {
            return Err(SceneError::unreadable(&name, format_args!("it is {what}, not a scene"), help));
        }
        let text = String::from_utf8(bytes).map_err(|e| {
            SceneError::unreadable(&name, e.utf8_error(), "a scene is TOML text in UTF-8; is this another file?")
        })?;
        Self::parse(&text, &name, overrides)
    }

    /// Reads the scene in `text`; `name` is the name of its file, for messages.
    ///
    /// # Errors
    /// The first error in the scene.
    pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let (name, text, overrides) = (name.to_owned(), text.to_owned(), overrides.to_vec());
        let source = Source { name, text, overrides, settings: Vec::new() };
        match checked(&source) {
            Ok(scene) => Ok(Self { scene, source }),
            Err(error) => Err(located(&source, error)),
        }
    }

    /// Whether an override takes precedence over a setting `KEY=VALUE`: it sets KEY itself or a table that contains
    /// KEY.
    pub fn overrides(&self, setting: &str) -> bool {
        self.source.overrides.iter().any(|text| tree::decides(text, setting))
    }

    /// An error of the data, at its place in the texts.
    pub fn error(&self, error: DataError) -> SceneError {
        located(&self.source, error)
    }

    /// The first key in which the scene with other overrides differs from this one; `method.tolerance`, `max_dofs` and
    /// `max_steps` are ignored.
    pub fn differing_key(&self, overrides: &[String]) -> Option<String> {
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
}

/// The scene in a text; `name` is the name of its file, for messages.
///
/// # Errors
/// As [`Document::parse`].
pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Scene, SceneError> {
    Document::parse(text, name, overrides).map(|document| document.scene)
}

/// The scene in a file.
///
/// # Errors
/// As [`Document::read`].
pub fn read(path: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
    Document::read(path, overrides).map(|document| document.scene)
}

/// The scene of a document, checked.
fn checked(source: &Source) -> Result<Scene, ReadError> {
    let mut root = tree::build(source)?;
    let parameters = match root.at(&["parameters"]) {
        Some(item) => body::parameters(&Field { name: "parameters".to_owned(), item }, source)?,
        None => Parameters::default(),
    };
    let context = Context::new(source, parameters.values.clone());
    dimensions::evaluate(&mut root, &context)?;
    let scene = scene(&root, source, parameters, &context.used.take())?;
    help::check_overrides(&scene, &root)?;
    scene.check()?;
    Ok(scene)
}

/// The nominal scene of a tree without expressions of dimensions; these used the parameters `in_dimensions`.
fn scene(
    root: &Item,
    source: &Source,
    parameters: Parameters,
    in_dimensions: &BTreeSet<String>,
) -> Result<Scene, ReadError> {
    let fields = Fields::new(&Field { name: String::new(), item: root }, &keys::SCENE)?;
    let title = fields.get("title").map_or(Ok(source.name.as_str()), |t| t.text())?.to_owned();
    let units = fields.get("units").map_or_else(|| Ok(Units::default()), |f| units::units(&f))?;
    let Parameters { values: parameters, uses: parameter_uses } = parameters;
    let of_body = fields.require("body", "a table [body] with corners and sides")?;
    let mut context = Context::new(source, parameters.clone());
    if let Some(field) = fields.get("profiles") {
        context.profiles = profiles::profiles(&field, &context)?;
    }
    let of_outcomes = fields.get("stochastic");
    let asked = Asked::read(of_outcomes.as_ref())?;
    let cavity = fields.get("material").is_none() && fields.get("exterior").is_some();
    let Read { problem, declared, constants, in_material } = match bodies::are_several(&of_body) {
        true => bodies::problem(&fields, &mut context)?,
        false => one_body(&fields, &of_body, cavity, &mut context)?,
    };
    let in_sides = context.used.take();
    let method = method::method(fields.get("method"))?;
    let forces = problem.bodies.iter().flat_map(|body| &body.force).flatten();
    let in_body_force: BTreeSet<String> = forces.flat_map(|f| f.names().iter().cloned()).collect();
    let used = |name: &str| [in_dimensions, &in_material, &in_sides, &in_body_force].iter().any(|u| u.contains(name));
    // boundary elements have the medium around a body with holes or a force as a body of its own, and with random input
    let is_random = declared.iter().any(|(name, _)| used(name));
    let separate = matches!(method.model, Model::Auto | Model::Bem)
        && if is_random { problem.takes_separate_medium() } else { problem.needs_separate_medium() };
    let problem = if separate { problem.with_separate_medium()? } else { problem };
    let around = problem.tie().is_some();
    let probe::Probes { points: probe, lines: probe_lines, sides: probe_sides } =
        fields.get("probe").map_or_else(|| Ok(Default::default()), |p| probe::probe(&p, &problem))?;
    let quantities = fields
        .get("quantities")
        .map_or_else(|| Ok(Vec::new()), |q| quantities::quantities(&q, &problem, (&context, &declared)))?;
    let in_weights = context.used.take();
    let mut expect = Vec::new();
    if let Some(field) = fields.get("expect") {
        method::expect(&field, "", &mut expect)?;
    }
    // a constant force alone has a resultant, one that differs from place to place may be balanced
    let first = &problem.bodies[0];
    let of_first = first.force.is_some() && (around || first.constant_force().is_none());
    let by_force = of_first || problem.has_several_bodies() && has_force(&problem);
    if !by_force {
        something_acts(&fields, &problem)?;
    }
    random::check_fields(&problem, &declared)?;
    let mut unused: Vec<String> = declared.iter().map(|(name, _)| name.clone()).filter(|name| !used(name)).collect();
    let told = |name: &str| used(name) || in_weights.contains(name);
    unused.extend(context.profiles.keys().filter(|name| !told(name)).cloned());
    unused.extend(unused_parameters(&parameter_uses, &told));
    if declared.is_empty() && fields.get("stochastic").is_some() {
        unused.push(STOCHASTIC.to_owned());
    }
    let (names, germs) = random::used(declared, asked.is_product(), &problem, &used)?;
    let random = Random { names, germs, stochastic: Stochastic::default(), constants };
    let random = (!random.names.is_empty()).then_some(random);
    let mut scene = Scene {
        title,
        units,
        problem,
        parameters,
        probe,
        probe_lines,
        probe_sides,
        quantities,
        method,
        expect,
        random,
        unused,
    };
    if let Some(stochastic) = asked.chosen(&scene)
        && let Some(random) = &mut scene.random
    {
        random.stochastic = stochastic;
    }
    Ok(scene)
}

/// The problem of a scene with its random inputs.
struct Read {
    problem: Problem,
    /// The random inputs and their names.
    declared: Vec<(String, random::Declared)>,
    /// The numbers that use them.
    constants: RandomConstants,
    /// The names that materials use.
    in_material: BTreeSet<String>,
}

/// The problem of one body, or of a hole.
fn one_body(
    fields: &Fields<'_>,
    of_body: &Field<'_>,
    cavity: bool,
    context: &mut Context<'_>,
) -> Result<Read, ReadError> {
    let of_outline = Fields::new(of_body, &keys::BODY)?;
    let outline = body::body(&of_outline, cavity)?;
    if let Some(field) = of_outline.get("cracks") {
        for key in ["exterior", "grid"] {
            if let Some(other) = fields.get(key) {
                let message = format!("{} and {} cannot be solved together", field.name, other.name);
                return Err(ReadError::new(
                    DataErrorKind::Unsupported,
                    field.item.place,
                    message,
                    "leave one of them out",
                ));
            }
        }
        return cracked(fields, &of_outline, outline, context);
    }
    if let Some(field) = fields.get("interface") {
        let help = "write each body as a table [[body]] with a name";
        return Err(ReadError::new(
            DataErrorKind::Conflict,
            field.item.place,
            "an interface needs several bodies, or a crack",
            help,
        ));
    }
    let declared = match fields.get("random") {
        Some(field) => random::random(&field, &outline, context)?,
        None => Vec::new(),
    };
    context.used.take();
    let body = match cavity {
        true => None,
        false => {
            let field = fields.require("material", "a table [material] with young and poisson")?;
            random::check_poisson(&field, &declared, context)?;
            Some(substance(&field, &outline, &declared, context)?)
        }
    };
    let plane = body.as_ref().map(|substance| match substance {
        Substance::Homogeneous(material) => material.plane,
        Substance::Cells(cells) => cells.of_unit_modulus.plane,
    });
    let exterior = fields.get("exterior").map(|field| {
        random::check_poisson(&field, &declared, context)?;
        exterior::exterior(&field, plane, context)
    });
    let exterior = exterior.transpose()?;
    let in_material = context.used.borrow().clone();
    let grid = fields.get("grid").map(|field| grid::grid(&field)).transpose()?;
    let sides = sides::sides(fields.get("sides").as_ref(), &outline, context)?;
    let in_sides = context.used.take();
    let force = fields.get("body_force").map(|f| body::body_force(&f, context)).transpose()?;
    // names that the force alone uses do not count as used by sides
    context.used.replace(in_sides);
    let problem = problem(Parts { outline, substance: body, grid, sides, force, exterior })?;
    let constants = random::constants(fields, cavity, &declared, context)?;
    Ok(Read { problem, declared, constants, in_material })
}

/// The problem of one body with cracks.
fn cracked(
    fields: &Fields<'_>,
    of_body: &Fields<'_>,
    outline: Polygon,
    context: &mut Context<'_>,
) -> Result<Read, ReadError> {
    let declared = match fields.get("random") {
        Some(field) => random::random(&field, &outline, context)?,
        None => Vec::new(),
    };
    context.used.take();
    let field = fields.require("material", "a table [material] with young and poisson")?;
    random::check_poisson(&field, &declared, context)?;
    let constants = random::constants(fields, false, &declared, context)?;
    let substance = substance(&field, &outline, &declared, context)?;
    if let Substance::Cells(_) = substance {
        return Err(field.problem("a body of cells cannot have cracks".to_owned(), "give one Young's modulus"));
    }
    let in_material = context.used.take();
    let force = fields.get("body_force").map(|f| body::body_force(&f, context)).transpose()?;
    context.used.take();
    let mut cracks = Cracks::default();
    let whole = outline.clone();
    let outline = cracks.cut(of_body, "", outline)?;
    let own = Body { force, ..Body::new("body", substance) };
    let count = outline.bodies().len();
    let young = constants.young.get(&0).map(|young| (0..count).map(|piece| (piece, young.clone())));
    let constants = RandomConstants { young: young.into_iter().flatten().collect(), ..RandomConstants::default() };
    let mut problem = Problem::of_bodies(outline, bodies::pieces(&own, count));
    if let Some(field) = fields.get("sides") {
        for (name, place, table) in Fields::open(&field)?.all() {
            if cracks.load(name, &table, &mut problem, context)? {
                continue;
            }
            let names = whole.side_names();
            let Some(index) = names.iter().position(|side| side == name) else {
                let help = suggestion(name, names.iter().map(String::as_str));
                return Err(ReadError::new(Kind::UnknownKey, place, format!("the body has no side {name:?}"), help));
            };
            sides::given(&table, context)?.to(&mut problem, index);
        }
    }
    if let Some(field) = fields.get("interface") {
        for table in field.list()? {
            if !cracks.interface(&table, context)? {
                let help = "write on = \"CRACK\", or each body as a table [[body]] with a name";
                return Err(table.problem("there are no two bodies for an interface between sides".to_owned(), help));
            }
        }
    }
    cracks.join(&mut problem);
    Ok(Read { problem, declared, constants, in_material })
}

/// The parts of the problem from its tables.
struct Parts {
    outline: Polygon,
    /// Material of the body; None for a hole.
    substance: Option<Substance>,
    grid: Option<GridInput>,
    sides: Vec<Given>,
    force: Option<[Expression; 2]>,
    exterior: Option<(Material, FarField, Tie)>,
}

/// The bodies and interfaces of a scene.
fn problem(parts: Parts) -> Result<Problem, ReadError> {
    let Parts { outline, substance, grid, sides, force, exterior } = parts;
    let mut problem = match (substance, &exterior) {
        (Some(substance), _) => Problem::new(outline, substance),
        (None, Some((material, far, _))) => {
            let mut problem = Problem::new(outline, Substance::Homogeneous(*material));
            problem.bodies[0].far = Some(far.clone());
            problem
        }
        (None, None) => unreachable!("a hole has a medium around it"),
    };
    let body = &mut problem.bodies[0];
    let cavity = body.far.is_some();
    *body = Body { grid, force, ..body.clone() };
    for (side, given) in sides.into_iter().enumerate() {
        given.to(&mut problem, side);
    }
    if let Some((material, far, tie)) = exterior.filter(|_| !cavity) {
        let refuse = |e: PolygonError| {
            let help = "a medium surrounds a body whose outer loop is the outline of a hole";
            DataError::at(DataErrorKind::Geometry, &[vec!["body", "corners"]], e.to_string(), help)
        };
        problem.surround(material, far, tie).map_err(refuse)?;
    }
    Ok(problem)
}

fn has_force(problem: &Problem) -> bool {
    problem.bodies.iter().any(|body| body.force.is_some())
}

/// Checks that a side or the medium loads, holds or touches the body.
fn something_acts(fields: &Fields<'_>, problem: &Problem) -> Result<(), ReadError> {
    let body = &problem.bodies[0];
    let by_side =
        (0..problem.sides.len()).any(|side| !problem.sides[side].is_free() || problem.contact(side).is_some());
    let medium = problem.bodies.iter().find_map(|body| body.far.as_ref());
    let mut ties = problem.interfaces().iter().filter_map(|interface| match &interface.law {
        Law::Tied(tie) => Some(tie),
        Law::Contact(_) => None,
    });
    if by_side || medium.is_some_and(FarField::is_loaded) || ties.any(Tie::is_loaded) {
        return Ok(());
    }
    let place = fields.get("sides").map_or(fields.place, |f| f.item.place);
    let names = problem.outline.side_names().join(", ");
    let sides = format!("[sides.NAME] with contact, displacement, traction or pressure; the sides are {names}");
    let help = match medium {
        None => format!("add a table {sides}"),
        Some(_) if body.far.is_some() => format!("add exterior.remote_stress, or a table {sides}"),
        Some(_) => "add exterior.remote_stress, displacement_jump or traction_jump, or a [body_force]".to_owned(),
    };
    Err(ReadError::new(Kind::MissingKey, place, "nothing loads, holds or touches the body", help))
}

/// The parameters that neither data nor used parameters use.
fn unused_parameters<'a>(
    parameters: &'a [(String, Vec<String>)],
    used: &dyn Fn(&str) -> bool,
) -> impl Iterator<Item = String> + use<'a> {
    // an expression may use only names above it, so the last ones are decided first
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

/// `[material]`; with `cells` the cells give Young's modulus, and one material where they do not differ.
fn substance(
    field: &Field<'_>,
    outline: &Polygon,
    declared: &[(String, random::Declared)],
    context: &Context<'_>,
) -> Result<Substance, ReadError> {
    let fields = Fields::new(field, &keys::MATERIAL)?;
    match (fields.get("cells"), fields.get("young")) {
        (Some(cells), Some(young)) => Err(ReadError::new(
            DataErrorKind::Conflict,
            young.item.place,
            format!("{} stands beside {}", young.name, cells.name),
            "the cells give Young's modulus: remove one of the two",
        )),
        (Some(cells), None) => {
            let of_unit_modulus = |ratio: Option<f64>| body::material_with(&fields, context, 1.0, ratio);
            let cells = grid::cells(&cells, outline, of_unit_modulus, context)?;
            let is_random = cells.expressions().any(|e| declared.iter().any(|(name, _)| e.uses(name)));
            let uniform = cells.uniform().filter(|_| !is_random);
            Ok(uniform.map_or(Substance::Cells(cells), Substance::Homogeneous))
        }
        (None, _) => {
            let young = fields.require("young", "young = 200.0, in the scene's unit of stress")?.constant(context)?;
            Ok(Substance::Homogeneous(body::material(&fields, context, young)?))
        }
    }
}

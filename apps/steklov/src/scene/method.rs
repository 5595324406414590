//! `[method]` and `[expect]`.

use steklov_contact::{MultiplierDegree, MultiplierMesh};

use super::error::{Problem, SceneErrorKind as Kind};
use super::fields::{Field, Fields};
use super::keys;
use super::tree::Value;

/// Discretisation that is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// The least one that the scene needs.
    Auto,
    /// Boundary elements.
    Bem,
    /// Finite elements on a grid.
    Fem,
    /// Multiscale finite elements.
    Msfem,
    /// Finite elements, boundary elements around them.
    FemBem,
    /// Multiscale finite elements, boundary elements around them.
    MsfemBem,
}

impl Model {
    /// The word of the scene file.
    pub fn word(self) -> &'static str {
        MODELS.iter().find(|(_, model)| *model == self).map_or("", |(word, _)| word)
    }
}

/// How the mesh is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refine {
    /// Adaptive in h and p.
    Hp,
    /// Adaptive in h and p by the decay of Legendre coefficients.
    HpDecay,
    /// Adaptive in h.
    H,
    /// All elements halved.
    UniformH,
    /// All degrees raised.
    UniformP,
    /// One mesh.
    None,
}

/// Error indicator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Indicator {
    /// Hierarchical bubbles.
    Bubble,
    /// Residuals.
    Residual,
}

/// Multiplier space of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Multiplier {
    /// Dual basis.
    Biorthogonal,
    /// Stabilised mixed form.
    Stabilised,
}

/// Solver of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// Interior point, polished by active sets.
    Auto,
    /// Semi-smooth Newton.
    Newton,
    /// Active set.
    ActiveSet,
    /// Uzawa.
    Uzawa,
}

/// Everything of `[method]`, defaults filled in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// Discretisation.
    pub model: Model,
    /// Wanted relative error in the energy norm, in (0, 1).
    pub tolerance: f64,
    /// Refinement.
    pub refine: Refine,
    /// Elements of the first mesh, at least 1.
    pub elements: usize,
    /// Whether the scene gives them.
    pub elements_given: bool,
    /// Degree of the first mesh, 1 to 64.
    pub degree: usize,
    /// Largest number of displacement unknowns.
    pub max_dofs: usize,
    /// Whether the scene gives it.
    pub max_dofs_given: bool,
    /// Bytes that the matrices of a mesh may take; no limit if None.
    pub memory: Option<u64>,
    /// Largest number of adaptive steps.
    pub max_steps: usize,
    /// Indicator of the error.
    pub indicator: Indicator,
    /// Dörfler's θ in (0, 1]; `None` is auto.
    pub marking: Option<f64>,
    /// δ in (0, 1] of the h-or-p decision.
    pub smoothness: f64,
    /// Multiplier space.
    pub multiplier: Multiplier,
    /// γ₀ > 0 (1/stress) of the stabilisation; `None` is auto.
    pub gamma: Option<f64>,
    /// Mesh of stabilised multipliers.
    pub multiplier_mesh: MultiplierMesh,
    /// Degree of stabilised multipliers.
    pub multiplier_degree: MultiplierDegree,
    /// Solver of contact.
    pub solver: Solver,
}

pub(crate) const MULTIPLIER_MESHES: [(&str, MultiplierMesh); 4] = [
    ("same", MultiplierMesh::Same),
    ("coarser", MultiplierMesh::Coarser(2)),
    ("finer", MultiplierMesh::Finer(2)),
    ("shifted", MultiplierMesh::Shifted),
];

impl Default for Method {
    fn default() -> Self {
        Self {
            model: Model::Auto,
            tolerance: 1e-3,
            refine: Refine::Hp,
            elements: 16,
            elements_given: false,
            degree: 1,
            max_dofs: 20_000,
            max_dofs_given: false,
            memory: None,
            max_steps: 60,
            indicator: Indicator::Bubble,
            marking: None,
            smoothness: 0.6,
            multiplier: Multiplier::Biorthogonal,
            gamma: None,
            multiplier_mesh: MultiplierMesh::Same,
            multiplier_degree: MultiplierDegree::Relative(0),
            solver: Solver::Auto,
        }
    }
}

/// A number that a result must have.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// Path in the JSON object, its keys joined by points: `contact.force.y`.
    pub path: String,
    /// The number.
    pub value: f64,
    /// How far the result may be from it.
    pub tol: f64,
    /// Where the number comes from.
    pub source: String,
}

pub(super) fn method(field: Option<Field<'_>>) -> Result<Method, Problem> {
    let mut method = Method::default();
    let Some(field) = field else { return Ok(method) };
    let fields = Fields::new(&field, &keys::METHOD)?;
    for (key, _, field) in fields.all() {
        match key {
            "model" => method.model = field.choice(&MODELS)?,
            "tolerance" => method.tolerance = field.number_where(|v| v > 0.0 && v < 1.0, "above 0 and below 1")?,
            "refine" => method.refine = field.choice(&REFINES)?,
            "elements" => (method.elements, method.elements_given) = (field.whole(1, 1_000_000)?, true),
            "degree" => method.degree = field.whole(1, 64)?,
            "max_dofs" => (method.max_dofs, method.max_dofs_given) = (field.whole(1, 100_000_000)?, true),
            "max_steps" => method.max_steps = field.whole(1, 1_000_000)?,
            "indicator" => {
                method.indicator = field.choice(&[("bubble", Indicator::Bubble), ("residual", Indicator::Residual)])?;
            }
            "marking" => {
                method.marking = auto(&field, |v| v > 0.0 && v <= 1.0, "\"auto\", or a number above 0 and at most 1")?
            }
            "smoothness" => method.smoothness = field.number_where(|v| v > 0.0 && v <= 1.0, "above 0 and at most 1")?,
            "multiplier" => {
                let words = [("biorthogonal", Multiplier::Biorthogonal), ("stabilised", Multiplier::Stabilised)];
                method.multiplier = field.choice(&words)?;
            }
            "gamma" => method.gamma = auto(&field, |v| v > 0.0 && v.is_finite(), "\"auto\", or a number above 0")?,
            "multiplier_mesh" => method.multiplier_mesh = field.choice(&MULTIPLIER_MESHES)?,
            "multiplier_degree" => {
                method.multiplier_degree = match &field.item.value {
                    Value::Text(_) => field.choice(&[
                        ("auto", MultiplierDegree::Relative(0)),
                        ("continuous", MultiplierDegree::ContinuousLinear),
                    ])?,
                    _ => MultiplierDegree::Fixed(field.whole(0, 64)?),
                };
            }
            _ => method.solver = field.choice(&SOLVERS)?,
        }
    }
    // defaults that are written out do no harm
    let default = Method::default();
    let changed = [
        ("gamma", method.gamma != default.gamma),
        ("multiplier_mesh", method.multiplier_mesh != default.multiplier_mesh),
        ("multiplier_degree", method.multiplier_degree != default.multiplier_degree),
    ];
    match fields.all().find(|(key, ..)| changed.contains(&(key, true))) {
        Some((_, place, field)) if method.multiplier == Multiplier::Biorthogonal => Err(Problem::new(
            Kind::Value,
            place,
            format!("{} has no effect with biorthogonal multipliers", field.name),
            "set method.multiplier = \"stabilised\", or remove it",
        )),
        _ => Ok(method),
    }
}

const MODELS: [(&str, Model); 6] = [
    ("auto", Model::Auto),
    ("bem", Model::Bem),
    ("fem", Model::Fem),
    ("msfem", Model::Msfem),
    ("fem-bem", Model::FemBem),
    ("msfem-bem", Model::MsfemBem),
];
const REFINES: [(&str, Refine); 6] = [
    ("hp", Refine::Hp),
    ("hp-decay", Refine::HpDecay),
    ("h", Refine::H),
    ("uniform-h", Refine::UniformH),
    ("uniform-p", Refine::UniformP),
    ("none", Refine::None),
];
const SOLVERS: [(&str, Solver); 4] =
    [("auto", Solver::Auto), ("newton", Solver::Newton), ("active-set", Solver::ActiveSet), ("uzawa", Solver::Uzawa)];

/// A number, or `None` for the word "auto".
fn auto(field: &Field<'_>, test: impl Fn(f64) -> bool, wanted: &str) -> Result<Option<f64>, Problem> {
    match &field.item.value {
        Value::Text(text) if text == "auto" => Ok(None),
        Value::Text(text) => Err(field.problem(format!("{} is {text:?}", field.name), format!("it must be {wanted}"))),
        _ => field.number_where(test, wanted).map(Some),
    }
}

/// The entries of `[expect]`, as quoted or as nested keys.
pub(super) fn expect(field: &Field<'_>, path: &str, list: &mut Vec<Expectation>) -> Result<(), Problem> {
    for (key, _, entry) in Fields::open(field)?.all() {
        let path = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        let leaf = match &entry.item.value {
            Value::Table(entries) => {
                entries.is_empty() || entries.iter().any(|e| !matches!(e.item.value, Value::Table(_)))
            }
            _ => true,
        };
        if !leaf {
            expect(&entry, &path, list)?;
            continue;
        }
        let fields = Fields::new(&entry, &["value", "tol", "source"])?;
        let value = fields.require("value", "value = the number to expect")?.number_where(f64::is_finite, "finite")?;
        let tol = fields.require("tol", "tol = how far the result may be off, such as 1e-6")?;
        let tol = tol.number_where(|v| v >= 0.0 && v.is_finite(), "finite and not negative")?;
        let source = fields.get("source").map_or(Ok(""), |s| s.text())?.to_owned();
        list.push(Expectation { path, value, tol, source });
    }
    Ok(())
}

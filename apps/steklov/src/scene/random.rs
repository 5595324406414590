//! `[random]` and `[stochastic]`: variables, fields, and how to solve for all of their values.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use steklov_bem_operators::Polygon;
use steklov_expression::Place;
use steklov_expression::{FieldValue, RandomField, Support};
use steklov_stochastic::{Covariance, Distribution, Kernel, StochasticError, Truncation, Variable};

use super::body::check_name;
use super::check::data;
use super::error::{Problem, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::sides::Side;
use super::tree::{Item, Value, suggestion};

/// Random input that a scene uses, and how it is treated.
#[derive(Debug, Clone)]
pub struct Random {
    /// The names, in the order of the scene.
    pub names: Vec<RandomName>,
    /// The independent germs of all of them: the directions of the stochastic problem.
    pub germs: Vec<Germ>,
    /// How to solve.
    pub stochastic: Stochastic,
    /// Which data use random names.
    pub uses: Uses,
    /// For each germ where data have kinks or jumps, whatever the others: stochastic elements end there.
    pub cuts: Vec<Vec<f64>>,
    /// The scene as a tree, from which outcomes are read.
    pub(super) root: Arc<Item>,
}

/// A direction of the stochastic problem.
#[derive(Debug, Clone)]
pub struct Germ {
    /// `xi`, or `rough 3` for the third mode of a field.
    pub label: String,
    /// Its law.
    pub variable: Variable,
}

/// A name in expressions.
#[derive(Debug, Clone)]
pub enum RandomName {
    /// A variable.
    Variable {
        /// The name.
        name: String,
        /// Its germ.
        germ: usize,
    },
    /// A field.
    Field {
        /// The field.
        field: Arc<RandomField>,
        /// Its first germ; there is one a mode.
        first: usize,
    },
}

/// Which data of a scene use random names.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Uses {
    /// Young's modulus.
    pub young: bool,
    /// Tractions, pressures, body force.
    pub loads: bool,
    /// Gaps and friction.
    pub contact: bool,
    /// Prescribed displacements.
    pub held: bool,
}

/// Points at which the problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Galerkin in tensor products of polynomials on a stochastic mesh.
    Galerkin,
    /// Collocation at the same points.
    Collocation,
    /// Smolyak's sparse grid.
    Sparse,
    /// Independent samples.
    MonteCarlo,
}

/// `[stochastic]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Stochastic {
    /// Method.
    pub method: Sampling,
    /// Degree in each germ.
    pub degree: usize,
    /// Stochastic elements in each germ.
    pub elements: usize,
    /// Level of the sparse grid.
    pub level: usize,
    /// Whether the stochastic mesh is refined until `tolerance`.
    pub refine: bool,
    /// What the truncation in the germs may add to the relative error in the energy norm.
    pub tolerance: f64,
    /// Most stochastic nodes.
    pub max_nodes: usize,
    /// Samples of Monte Carlo, and of the surrogate for quantiles.
    pub samples: usize,
    /// Seed of the samples.
    pub seed: u64,
    /// Probabilities of the quantiles.
    pub quantiles: Vec<f64>,
    /// Paths of the JSON object.
    pub quantities: Option<Vec<String>>,
}

impl Default for Stochastic {
    fn default() -> Self {
        Self {
            method: Sampling::Galerkin,
            degree: 3,
            elements: 1,
            level: 2,
            refine: false,
            tolerance: 1e-4,
            max_nodes: 10_000,
            samples: 10_000,
            seed: 1,
            quantiles: vec![0.05, 0.5, 0.95],
            quantities: None,
        }
    }
}

impl RandomName {
    /// The name.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Variable { name, .. } => name,
            Self::Field { field, .. } => &field.name,
        }
    }
}

impl Random {
    /// Values of the names for these germs.
    pub(super) fn values(&self, germs: &[f64]) -> (BTreeMap<String, f64>, BTreeMap<String, Arc<FieldValue>>) {
        let (mut constants, mut fields) = (BTreeMap::new(), BTreeMap::new());
        for name in &self.names {
            match name {
                RandomName::Variable { name, germ } => {
                    constants.insert(name.clone(), self.germs[*germ].variable.value(germs[*germ]));
                }
                RandomName::Field { field, first } => {
                    let germs = germs[*first..first + field.expansion.len()].to_vec();
                    fields.insert(field.name.clone(), Arc::new(FieldValue::new(field.clone(), germs)));
                }
            }
        }
        (constants, fields)
    }

    /// An outcome in words: the values of the names, the germs of fields.
    pub(crate) fn outcome_name(&self, germs: &[f64]) -> String {
        let value = |(g, xi): (&Germ, &f64)| format!("{} = {}", g.label, g.variable.value(*xi));
        let first: Vec<String> = self.germs.iter().zip(germs).take(NAMED).map(value).collect();
        let more = if germs.len() > NAMED { ", .." } else { "" };
        format!("{}{more}", first.join(", "))
    }

    /// The fields, each with its first germ.
    pub fn fields(&self) -> impl Iterator<Item = (&Arc<RandomField>, usize)> {
        self.names.iter().filter_map(|name| match name {
            RandomName::Field { field, first } => Some((field, *first)),
            RandomName::Variable { .. } => None,
        })
    }

    /// The germs of the nominal outcome: means of the variables, fields 0.
    pub fn nominal(&self) -> Vec<f64> {
        self.germs
            .iter()
            .map(|g| {
                let [low, high] = g.variable.germ_support();
                match g.variable.distribution() {
                    Distribution::Lognormal { .. } => g.variable.mean().ln().clamp(low, high),
                    _ => g.variable.mean(),
                }
            })
            .collect()
    }
}

/// Germs that messages name.
const NAMED: usize = 12;

/// A random input as it stands in the scene.
pub(super) enum Declared {
    Variable(Variable),
    Field { covariance: Covariance, truncation: Truncation, support: Support, uniform: bool, place: Place },
}

/// Reads `[random]`; its names become constants and fields of expressions, each with its nominal value.
pub(super) fn random(
    field: &Field<'_>,
    polygon: &Polygon,
    context: &mut Context<'_>,
) -> Result<Vec<(String, Declared)>, Problem> {
    let mut names = Vec::new();
    for (name, place, table) in Fields::open(field)?.all() {
        check_name(name, place)?;
        if context.constants.contains_key(name) {
            let message = format!("{name} is a parameter as well as a random input");
            return Err(Problem::new(Kind::Conflict, place, message, "rename one of the two"));
        }
        let declared = if Fields::open(&table)?.get("covariance").is_some() {
            context.fields.insert(name.to_owned(), Arc::default());
            rough(&table, polygon)?
        } else {
            let variable = variable(&table)?;
            context.constants.insert(name.to_owned(), variable.mean());
            Declared::Variable(variable)
        };
        names.push((name.to_owned(), declared));
    }
    Ok(names)
}

/// The names that are used, with their germs; the expansions of fields are computed here.
pub(super) fn used(
    declared: Vec<(String, Declared)>,
    uses: &dyn Fn(&str) -> bool,
) -> Result<(Vec<RandomName>, Vec<Germ>), Problem> {
    let (mut names, mut germs) = (Vec::new(), Vec::new());
    for (name, declared) in declared.into_iter().filter(|(name, _)| uses(name)) {
        match declared {
            Declared::Variable(variable) => {
                names.push(RandomName::Variable { name: name.clone(), germ: germs.len() });
                germs.push(Germ { label: name, variable });
            }
            Declared::Field { covariance, truncation, support, uniform, place } => {
                let refused = |e: StochasticError| {
                    Problem::new(Kind::Value, place, format!("the field {name}: {e}"), "change the field")
                };
                let expansion = support.expansion(&covariance, truncation).map_err(refused)?;
                let bound = 3.0f64.sqrt();
                let law = if uniform { Variable::uniform(-bound, bound) } else { Variable::normal(0.0, 1.0) };
                let law = law.map_err(refused)?;
                let first = germs.len();
                for m in 0..expansion.len() {
                    germs.push(Germ { label: format!("{name} {}", m + 1), variable: law.clone() });
                }
                let field = Arc::new(RandomField { name, expansion, support });
                names.push(RandomName::Field { field, first });
            }
        }
    }
    Ok((names, germs))
}

/// A field on a side has no value on the others.
pub(super) fn check_fields(sides: &[Side], declared: &[(String, Declared)]) -> Result<(), Problem> {
    for side in sides {
        for (what, expression) in data(side) {
            for (name, declared) in declared.iter().filter(|(name, _)| expression.uses(name)) {
                if let Declared::Field { support: Support::Side { name: on, .. }, .. } = declared
                    && *on != side.name
                {
                    let message = format!("the {what} of side {:?} uses the field {name} of side {on:?}", side.name);
                    let help = format!("declare a field on {:?}, or on = \"body\"", side.name);
                    return Err(Problem::new(Kind::Conflict, expression.place, message, help));
                }
            }
        }
    }
    Ok(())
}

/// Poisson's ratio is the same for all outcomes: every ratio has boundary operators of its own.
pub(super) fn check_poisson(
    material: &Field<'_>,
    declared: &[(String, Declared)],
    context: &Context<'_>,
) -> Result<(), Problem> {
    let Some(poisson) = Fields::open(material)?.get("poisson") else { return Ok(()) };
    let expression = poisson.expression(context)?;
    match declared.iter().find(|(name, _)| expression.uses(name)) {
        Some((name, _)) => Err(Problem::new(
            Kind::Unsupported,
            poisson.item.place,
            format!("{} depends on the random {name}", poisson.name),
            "every ratio has boundary operators of its own, so that no factorisation would serve two outcomes: give a number, \
             and study a few of them with --set",
        )),
        None => Ok(()),
    }
}

/// Which data use a random name.
pub(super) fn uses(
    sides: &[Side],
    is_random: &dyn Fn(&String) -> bool,
    young: bool,
    in_body_force: &BTreeSet<String>,
) -> Uses {
    let mut uses = Uses { young, loads: in_body_force.iter().any(is_random), ..Uses::default() };
    for side in sides {
        for (what, expression) in data(side) {
            if expression.names().iter().any(is_random) {
                match what {
                    "traction" | "pressure" => uses.loads = true,
                    "displacement" => uses.held = true,
                    _ => uses.contact = true,
                }
            }
        }
    }
    uses
}

#[derive(Clone, Copy)]
enum Law {
    Uniform,
    Normal,
    Lognormal,
    Beta,
}

fn variable(field: &Field<'_>) -> Result<Variable, Problem> {
    let words =
        [("uniform", Law::Uniform), ("normal", Law::Normal), ("lognormal", Law::Lognormal), ("beta", Law::Beta)];
    const EXAMPLE: &str = "distribution = \"uniform\", or covariance = \"exponential\" for a field";
    let law = Fields::open(field)?.require("distribution", EXAMPLE)?.choice(&words)?;
    let keys: &[&str] = match law {
        Law::Uniform => &["distribution", "low", "high"],
        Law::Normal | Law::Lognormal => &["distribution", "mean", "deviation", "low", "high"],
        Law::Beta => &["distribution", "alpha", "beta", "low", "high"],
    };
    let fields = Fields::new(field, keys)?;
    let finite = |key: &str| fields.require(key, &format!("{key} = a number"))?.number_where(f64::is_finite, "finite");
    let positive = |key: &str| {
        let number = fields.require(key, &format!("{key} = a positive number"))?;
        number.number_where(|v| v > 0.0 && v.is_finite(), "positive and finite")
    };
    let needed = matches!(law, Law::Uniform | Law::Beta);
    let end = |key: &str, default: f64| {
        if needed || fields.get(key).is_some() { finite(key) } else { Ok(default) }
    };
    let distribution = match law {
        Law::Uniform => Distribution::Uniform,
        Law::Normal => Distribution::Normal { mean: finite("mean")?, deviation: positive("deviation")? },
        Law::Lognormal => Distribution::Lognormal { mean: positive("mean")?, deviation: positive("deviation")? },
        Law::Beta => Distribution::Beta { alpha: positive("alpha")?, beta: positive("beta")? },
    };
    let least = if matches!(law, Law::Lognormal) { 0.0 } else { f64::NEG_INFINITY };
    let (low, high) = (end("low", least)?, end("high", f64::INFINITY)?);
    if low >= high {
        let high_field = fields.require("high", "high = a number")?;
        let message = format!("{} is not above low = {low}", high_field.name);
        return Err(high_field.problem(message, "make low smaller than high"));
    }
    Variable::new(distribution, low, high).map_err(|e| field.problem(e.to_string(), "change the law of the variable"))
}

/// A random field.
fn rough(field: &Field<'_>, polygon: &Polygon) -> Result<Declared, Problem> {
    let fields = Fields::new(field, &["covariance", "correlation", "on", "captured", "modes", "variables"])?;
    let kernels =
        [("exponential", Kernel::Exponential), ("gaussian", Kernel::Gaussian), ("matern32", Kernel::Matern32)];
    let kernel = fields.require("covariance", "covariance = \"exponential\"")?.choice(&kernels)?;
    let correlation = fields.require("correlation", "correlation = a length")?;
    let length =
        |field: &Field<'_>| field.number_where(|v| v > 0.0 && v.is_finite(), "a positive length, or one for each axis");
    let correlation = match correlation.item.value {
        Value::Array(_) => {
            let [x, y] = correlation.pair()?;
            [length(&x)?, length(&y)?]
        }
        _ => [length(&correlation)?; 2],
    };
    let on = fields.require("on", "on = the name of a side, or \"body\"")?;
    let names = polygon.side_names().iter().map(String::as_str).chain(["body"]);
    let word = on.text()?;
    if !names.clone().any(|name| name == word) {
        let message = format!("the body has no side {word:?}");
        return Err(Problem::new(Kind::UnknownKey, on.item.place, message, suggestion(word, names)));
    }
    let truncation = match (fields.get("captured"), fields.get("modes")) {
        (Some(_), Some(modes)) => {
            let message = format!("{} stands beside captured", modes.name);
            return Err(Problem::new(Kind::Conflict, modes.item.place, message, "keep captured or modes, not both"));
        }
        (None, Some(modes)) => Truncation::Modes(modes.whole(1, 10_000)?),
        (Some(captured), None) => {
            Truncation::Captured(captured.number_where(|v| v > 0.0 && v < 1.0, "above 0 and below 1")?)
        }
        (None, None) => Truncation::Captured(0.95),
    };
    let uniform = match fields.get("variables") {
        Some(variables) => variables.choice(&[("uniform", true), ("normal", false)])?,
        None => true,
    };
    let support = if word == "body" {
        Support::body(polygon)
    } else {
        Support::side(polygon, word).map_err(|why| {
            let help = "name its connected parts as sides of their own and give each a field, or take on = \"body\"";
            on.problem(
                format!("{} = {word:?}: the side {why}; a field needs one chain of edges with two ends", on.name),
                help,
            )
        })?
    };
    let covariance = Covariance { kernel, correlation };
    Ok(Declared::Field { covariance, truncation, support, uniform, place: field.item.place })
}

pub(super) fn stochastic(field: &Field<'_>) -> Result<Stochastic, Problem> {
    let mut read = Stochastic::default();
    let methods = [
        ("galerkin", Sampling::Galerkin),
        ("collocation", Sampling::Collocation),
        ("sparse", Sampling::Sparse),
        ("monte-carlo", Sampling::MonteCarlo),
    ];
    for (key, _, field) in Fields::new(field, &keys::STOCHASTIC)?.all() {
        match key {
            "method" => read.method = field.choice(&methods)?,
            "degree" => read.degree = field.whole(0, 64)?,
            "elements" => read.elements = field.whole(1, 1_000_000)?,
            "level" => read.level = field.whole(0, 12)?,
            "refine" => read.refine = field.choice(&[("none", false), ("adaptive", true)])?,
            "tolerance" => read.tolerance = field.number_where(|v| v > 0.0 && v < 1.0, "above 0 and below 1")?,
            "max_nodes" => read.max_nodes = field.whole(1, 10_000_000)?,
            "samples" => read.samples = field.whole(2, 10_000_000)?,
            "seed" => read.seed = field.whole(0, i64::MAX as usize)? as u64,
            "quantiles" => {
                let numbers = field.list()?;
                let number = |q: &Field<'_>| q.number_where(|v| v > 0.0 && v < 1.0, "above 0 and below 1");
                read.quantiles = numbers.iter().map(number).collect::<Result<_, _>>()?;
            }
            _ => {
                let paths = field.list()?;
                let text = |q: &Field<'_>| q.text().map(str::to_owned);
                read.quantities = Some(paths.iter().map(text).collect::<Result<_, _>>()?);
            }
        }
    }
    Ok(read)
}

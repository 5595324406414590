//! `[random]`: variables and fields.

use std::sync::Arc;

use steklov_bem_operators::Polygon;
use steklov_expression::{Expression, Support};
use steklov_problem::{DataErrorKind, Germ, Problem, RandomConstants, RandomName};
use steklov_stochastic::{Distribution, Variable};

use super::body::check_name;
use super::error::ReadError;
use super::fields::{Context, Field, Fields};
use super::keys;
use super::profiles;
use super::random_field::DeclaredField;

pub(super) const UNIFORM: &str = "uniform";
pub(super) const NORMAL: &str = "normal";
pub(super) const LOGNORMAL: &str = "lognormal";
pub(super) const BETA: &str = "beta";
/// Every law of a variable and its word.
const LAWS: [(&str, Law); 4] =
    [(UNIFORM, Law::Uniform), (NORMAL, Law::Normal), (LOGNORMAL, Law::Lognormal), (BETA, Law::Beta)];
/// A random input as declared in the scene.
pub(super) enum Declared {
    Variable(Variable),
    Field(DeclaredField),
}

impl Declared {
    /// The side that a field lives on.
    fn side(&self) -> Option<&String> {
        match self {
            Self::Field(DeclaredField { support: Support::Side { name, .. }, .. }) => Some(name),
            _ => None,
        }
    }
}

/// Reads `[random]`; its names become constants and fields of expressions, each with its nominal value.
pub(super) fn random(
    field: &Field<'_>,
    polygon: &Polygon,
    context: &mut Context<'_>,
) -> Result<Vec<(String, Declared)>, ReadError> {
    let mut names = Vec::new();
    for (name, place, table) in Fields::open(field)?.all() {
        check_name(name, place)?;
        if context.constants.contains_key(name) {
            let message = format!("{name} is a parameter as well as a random input");
            return Err(ReadError::new(DataErrorKind::Conflict, place, message, "rename one of the two"));
        }
        if context.profiles.contains_key(name) {
            return Err(profiles::twice(name, "random input", place));
        }
        let declared = if Fields::open(&table)?.get("covariance").is_some() {
            context.fields.insert(name.to_owned(), Arc::default());
            Declared::Field(DeclaredField::read(&table, polygon)?)
        } else {
            let variable = variable(&table)?;
            context.constants.insert(name.to_owned(), variable.mean());
            Declared::Variable(variable)
        };
        names.push((name.to_owned(), declared));
    }
    Ok(names)
}

/// Largest number of germs of a scene with fields for a product of rules: two points per germ are 2^64 points.
const RULE: usize = 64;
/// Largest number of germs of a scene with fields for samples and sparse grids in a bearable time.
const DRAWN: usize = 2048;
/// The names that are used, with their germs; the expansions of fields are computed here. `product`: the rule is a product of
/// rules of the germs.
pub(super) fn used(
    declared: Vec<(String, Declared)>,
    product: bool,
    problem: &Problem,
    uses: &dyn Fn(&str) -> bool,
) -> Result<(Vec<RandomName>, Vec<Germ>), ReadError> {
    let (mut names, mut germs) = (Vec::new(), Vec::new());
    for (name, declared) in declared.into_iter().filter(|(name, _)| uses(name)) {
        match declared {
            Declared::Variable(variable) => {
                names.push(RandomName::Variable { name: name.clone(), germ: germs.len() });
                germs.push(Germ { label: name, variable });
            }
            Declared::Field(declared) => {
                let (field, law) = declared.expanded(name, problem)?;
                let (first, modes) = (germs.len(), field.expansion.len());
                let most = if product { RULE } else { DRAWN };
                if first + modes > most {
                    return Err(declared.too_many(&field, most, DRAWN));
                }
                let label = |m: usize| match field.expansion.is_drawn() {
                    true => field.name.clone(),
                    false => format!("{} {}", field.name, m + 1),
                };
                germs.extend((0..modes).map(|m| Germ { label: label(m), variable: law.clone() }));
                names.push(RandomName::Field { field: Arc::new(field), first });
            }
        }
    }
    Ok((names, germs))
}

/// Refuses a field of one side in the data of another, where it has no value.
pub(super) fn check_fields(problem: &Problem, declared: &[(String, Declared)]) -> Result<(), ReadError> {
    for expression in problem.bodies[0].cell_expressions() {
        for (name, declared) in declared.iter().filter(|(name, _)| expression.uses(name)) {
            if let Some(on) = declared.side() {
                let message = format!("the cells use the field {name} of side {on:?}");
                let help = "declare it with on = \"body\"";
                return Err(ReadError::new(DataErrorKind::Conflict, expression.place, message, help));
            }
        }
    }
    let of_side = |index: usize| problem.side_data(index).into_iter().map(move |(what, e)| (index, what, e));
    let of_sides = (0..problem.sides.len()).flat_map(of_side);
    for (side, what, expression) in of_sides.chain(problem.jumps_of_ties()) {
        let side = &problem.sides[side].name;
        for (name, declared) in declared.iter().filter(|(name, _)| expression.uses(name)) {
            if let Some(on) = declared.side().filter(|&on| on != side) {
                let message = format!("the {what} of side {side:?} uses the field {name} of side {on:?}");
                let help = format!("declare a field on {side:?}, or on = \"body\"");
                return Err(ReadError::new(DataErrorKind::Conflict, expression.place, message, help));
            }
        }
    }
    Ok(())
}

/// Refuses a random Poisson's ratio: every ratio would need boundary operators of its own.
pub(super) fn check_poisson(
    material: &Field<'_>,
    declared: &[(String, Declared)],
    context: &Context<'_>,
) -> Result<(), ReadError> {
    let Some(poisson) = Fields::open(material)?.get("poisson") else { return Ok(()) };
    let expression = poisson.expression(context)?;
    match declared.iter().find(|(name, _)| expression.uses(name)) {
        Some((name, _)) => Err(ReadError::new(
            DataErrorKind::Unsupported,
            poisson.item.place,
            format!("{} depends on the random {name}", poisson.name),
            "every ratio has boundary operators of its own, so that no factorisation would serve two outcomes: give a number, \
             and study a few of them with --set",
        )),
        None => Ok(()),
    }
}

/// The number of a key, if it uses random names.
pub(super) fn varying(
    table: &Fields<'_>,
    key: &str,
    declared: &[(String, Declared)],
    context: &Context<'_>,
) -> Result<Option<Expression>, ReadError> {
    let expression = table.get(key).map(|field| field.expression(context)).transpose()?;
    Ok(expression.filter(|expression| varies(expression, declared)))
}

/// The entries of a remote stress, if one of them uses random names.
pub(super) fn varying_stress(
    medium: &Fields<'_>,
    declared: &[(String, Declared)],
    context: &Context<'_>,
) -> Result<Option<[Expression; 3]>, ReadError> {
    let Some(stress) = medium.get("remote_stress") else { return Ok(None) };
    let entries: Vec<Expression> =
        stress.list()?.iter().map(|entry| entry.expression(context)).collect::<Result<_, _>>()?;
    let entries = <[Expression; 3]>::try_from(entries).ok();
    Ok(entries.filter(|stress| stress.iter().any(|entry| varies(entry, declared))))
}

fn varies(expression: &Expression, declared: &[(String, Declared)]) -> bool {
    declared.iter().any(|(name, _)| expression.uses(name))
}

/// The numbers of a scene of one body that use random names; with `cavity` its modulus is the medium's, else a medium is body 1.
pub(super) fn constants(
    scene: &Fields<'_>,
    cavity: bool,
    declared: &[(String, Declared)],
    context: &Context<'_>,
) -> Result<RandomConstants, ReadError> {
    let table = |key: &str| scene.get(key).map(|field| Fields::open(&field)).transpose();
    let mut constants = RandomConstants::default();
    if let Some(of_modulus) = table(if cavity { "exterior" } else { "material" })? {
        constants.young.extend(varying(&of_modulus, "young", declared, context)?.map(|young| (0, young)));
    }
    if let Some(exterior) = table("exterior")? {
        if !cavity {
            constants.young.extend(varying(&exterior, "young", declared, context)?.map(|young| (1, young)));
        }
        constants.remote_stress = varying_stress(&exterior, declared, context)?;
    }
    Ok(constants)
}

#[derive(Clone, Copy)]
enum Law {
    Uniform,
    Normal,
    Lognormal,
    Beta,
}

fn variable(field: &Field<'_>) -> Result<Variable, ReadError> {
    const EXAMPLE: &str = "distribution = \"uniform\", or covariance = \"exponential\" for a field";
    let law = Fields::open(field)?.require("distribution", EXAMPLE)?.choice(&LAWS)?;
    let table = match law {
        Law::Uniform => &keys::VARIABLE_UNIFORM,
        Law::Normal => &keys::VARIABLE_NORMAL,
        Law::Lognormal => &keys::VARIABLE_LOGNORMAL,
        Law::Beta => &keys::VARIABLE_BETA,
    };
    let fields = Fields::new(field, table)?;
    let finite = |key: &str| fields.require(key, &format!("{key} = a number"))?.number_in(&keys::FINITE);
    let positive = |key: &str| {
        let number = fields.require(key, &format!("{key} = a positive number"))?;
        number.number_in(&keys::POSITIVE)
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

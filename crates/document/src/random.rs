//! `[random]`: variables and fields.

use std::sync::Arc;

use steklov_bem_operators::Polygon;
use steklov_expression::{Expression, Place, RandomField, Support};
use steklov_problem::{Cells, DataErrorKind, Germ, Problem, RandomConstants, RandomName, Side, field_cells};
use steklov_stochastic::{
    CellKarhunenLoeve, Covariance, Distribution, Field as Expansion, FieldCells, Kernel, StochasticError, Truncation,
    Variable,
};

use super::body::check_name;
use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::method::AUTO;
use super::tree::{Value, suggestion};

pub(super) const UNIFORM: &str = "uniform";
pub(super) const NORMAL: &str = "normal";
pub(super) const LOGNORMAL: &str = "lognormal";
pub(super) const BETA: &str = "beta";
/// Every law of a variable and its word.
const LAWS: [(&str, Law); 4] =
    [(UNIFORM, Law::Uniform), (NORMAL, Law::Normal), (LOGNORMAL, Law::Lognormal), (BETA, Law::Beta)];
/// Every covariance of a field and its word.
pub(super) const KERNELS: [(&str, Kernel); 3] =
    [("exponential", Kernel::Exponential), ("gaussian", Kernel::Gaussian), ("matern32", Kernel::Matern32)];
/// Whether the modes of a field are uniform, by the word of their law.
pub(super) const VARIABLES: [(&str, bool); 2] = [(UNIFORM, true), (NORMAL, false)];
/// Share of the variance of a field that is kept.
pub(super) const CAPTURED: f64 = 0.95;
/// A random input as declared in the scene.
pub(super) enum Declared {
    Variable(Variable),
    Field {
        covariance: Covariance,
        /// None: as many modes as there are.
        truncation: Option<Truncation>,
        support: Support,
        uniform: bool,
        place: Place,
    },
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

/// Largest number of germs of a scene with fields for a product of rules: two points per germ are 2^64 points.
const RULE: usize = 64;
/// Largest number of germs of a scene with fields for samples and sparse grids in a bearable time.
const DRAWN: usize = 2048;
/// Modes of a field that takes as many as there are.
const MANY_MODES: usize = 400;
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
            Declared::Field { covariance, truncation, support, uniform, place } => {
                let refused = |e: StochasticError| {
                    ReadError::new(DataErrorKind::Value, place, format!("the field {name}: {e}"), "change the field")
                };
                let expansion = match (cells_of(problem, &name)?, truncation) {
                    (Some(cells), Some(truncation)) => {
                        CellKarhunenLoeve::new(&covariance, cells, truncation).map(Into::into)
                    }
                    (Some(cells), None) => most_modes(&covariance, &cells).map(Into::into),
                    (None, Some(truncation)) => support.expansion(&covariance, truncation),
                    (None, None) => {
                        let message =
                            format!("the field {name} has modes = {AUTO:?}, and does not make the moduli of cells");
                        let help = "give a number of modes, or captured";
                        return Err(ReadError::new(DataErrorKind::Value, place, message, help));
                    }
                };
                let expansion: Expansion = expansion.map_err(refused)?;
                let bound = 3.0f64.sqrt();
                let law = if uniform { Variable::uniform(-bound, bound) } else { Variable::normal(0.0, 1.0) };
                let law = law.map_err(refused)?;
                let first = germs.len();
                let (modes, most) = (expansion.len(), if product { RULE } else { DRAWN });
                if first + modes > most {
                    let [a, b] = covariance.correlation;
                    let parts = expansion.sides().into_iter().zip([a, b]).map(|(side, length)| side / length);
                    let longest = parts.fold(0.0, f64::max);
                    let message = format!(
                        "the field {name} has {modes} modes, more than the {most} germs that this stochastic.method can take; its \
                         support is {longest} correlation lengths long"
                    );
                    let help = format!(
                        "take a longer correlation, modes = 6, or a smaller captured{}",
                        if most < DRAWN {
                            format!("; method = \"monte-carlo\" takes up to {DRAWN}")
                        } else {
                            String::new()
                        }
                    );
                    return Err(ReadError::new(DataErrorKind::Value, place, message, help));
                }
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

/// The modes of a field of cells, as many as there are up to [`MANY_MODES`].
///
/// # Errors
/// Those of [`CellKarhunenLoeve::new`].
fn most_modes(covariance: &Covariance, cells: &FieldCells) -> Result<CellKarhunenLoeve, StochasticError> {
    let mut wanted = MANY_MODES;
    loop {
        match CellKarhunenLoeve::new(covariance, cells.clone(), Truncation::Modes(wanted)) {
            Err(StochasticError::Modes { available, .. }) if (1..wanted).contains(&available) => wanted = available,
            Err(StochasticError::Unconverged { .. }) if wanted > 1 => wanted /= 2,
            found => return found,
        }
    }
}

/// The modulus cells of which a field is the means: where it makes their moduli. `None` for other fields, and for cells that do
/// not fit the grid, which is refused later.
///
/// # Errors
/// A field that is elsewhere too, where it would have other values.
fn cells_of(problem: &Problem, name: &str) -> Result<Option<FieldCells>, ReadError> {
    let body = &problem.bodies[0];
    let Some(Cells { size, .. }) = body.cells() else { return Ok(None) };
    if !body.cell_expressions().any(|e| e.uses(name)) {
        return Ok(None);
    }
    let force = body.force.iter().flatten().map(|e| ("body force".to_owned(), e));
    let of_side = |(index, side): (usize, &Side)| {
        let data = problem.side_data(index).into_iter();
        let named = data.map(|(what, e)| (format!("{what} of side {:?}", side.name), e));
        named.collect::<Vec<_>>()
    };
    let sides = problem.sides.iter().enumerate().flat_map(of_side);
    if let Some((what, expression)) = force.chain(sides).find(|(_, e)| e.uses(name)) {
        let message = format!("the {what} uses the field {name}, whose values are means over the modulus cells");
        let help = "declare a second field for it";
        return Err(ReadError::new(DataErrorKind::Conflict, expression.place, message, help));
    }
    Ok(body.grid.as_ref().and_then(|grid| field_cells(&problem.outline, grid, *size)))
}

/// Refuses a field of one side in the data of another, where it has no value.
pub(super) fn check_fields(problem: &Problem, declared: &[(String, Declared)]) -> Result<(), ReadError> {
    for expression in problem.bodies[0].cell_expressions() {
        for (name, declared) in declared.iter().filter(|(name, _)| expression.uses(name)) {
            if let Declared::Field { support: Support::Side { name: on, .. }, .. } = declared {
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
            if let Declared::Field { support: Support::Side { name: on, .. }, .. } = declared
                && on != side
            {
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

/// The numbers of a scene of one body that use random names; with `cavity` its modulus is the medium's.
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

/// A random field.
fn rough(field: &Field<'_>, polygon: &Polygon) -> Result<Declared, ReadError> {
    let fields = Fields::new(field, &keys::FIELD)?;
    let kernel = fields.require("covariance", "covariance = \"exponential\"")?.choice(&KERNELS)?;
    let correlation = fields.require("correlation", "correlation = a length")?;
    let length = |field: &Field<'_>| field.number_in(&keys::LENGTHS);
    let correlation = match correlation.item.value {
        Value::Array(_) => {
            let [x, y] = correlation.components()?;
            [length(&x)?, length(&y)?]
        }
        _ => [length(&correlation)?; 2],
    };
    let on = fields.require("on", "on = the name of a side, or \"body\"")?;
    let names = polygon.side_names().iter().map(String::as_str).chain(["body"]);
    let word = on.text()?;
    if !names.clone().any(|name| name == word) {
        let message = format!("the body has no side {word:?}");
        return Err(ReadError::new(Kind::UnknownKey, on.item.place, message, suggestion(word, names)));
    }
    let truncation = match (fields.get("captured"), fields.get("modes")) {
        (Some(_), Some(modes)) => {
            let message = format!("{} stands beside captured", modes.name);
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                modes.item.place,
                message,
                "keep captured or modes, not both",
            ));
        }
        (None, Some(modes)) if matches!(&modes.item.value, Value::Text(text) if text == AUTO) => None,
        (None, Some(modes)) => Some(Truncation::Modes(modes.whole(keys::MODES)?)),
        (Some(captured), None) => Some(Truncation::Captured(captured.number_in(&keys::FRACTION)?)),
        (None, None) => Some(Truncation::Captured(CAPTURED)),
    };
    let uniform = match fields.get("variables") {
        Some(variables) => variables.choice(&VARIABLES)?,
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

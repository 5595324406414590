//! `[sides.NAME]`: support, load or contact of each side.

use steklov_bem_operators::Polygon;
use steklov_expression::Expression;
use steklov_problem::{Condition, Contact, DataErrorKind, Friction, Problem, Springs};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::tree::{Value, suggestion};

/// The data of a side in a table.
#[derive(Default)]
pub(super) struct Given {
    pub(super) condition: Condition,
    pub(super) contact: Option<Contact>,
    pub(super) springs: Option<Springs>,
}

impl Given {
    /// Gives the data to a side of a problem.
    pub(super) fn to(self, problem: &mut Problem, side: usize) {
        if let Some(contact) = self.contact {
            problem.touch(side, contact);
        }
        (problem.sides[side].condition, problem.sides[side].springs) = (self.condition, self.springs);
    }
}

/// The data of all sides, in the order of [`Polygon::side_names`].
pub(super) fn sides(
    field: Option<&Field<'_>>,
    polygon: &Polygon,
    context: &Context<'_>,
) -> Result<Vec<Given>, ReadError> {
    let names = polygon.side_names();
    let mut sides: Vec<Given> = names.iter().map(|_| Given::default()).collect();
    let Some(field) = field else { return Ok(sides) };
    for (key, place, table) in Fields::open(field)?.all() {
        let Some(index) = names.iter().position(|name| name == key) else {
            let message = format!("the body has no side {key:?}");
            let help = suggestion(key, names.iter().map(String::as_str));
            return Err(ReadError::new(Kind::UnknownKey, place, message, help));
        };
        sides[index] = given(&table, context)?;
    }
    Ok(sides)
}

/// The data of a side in a table.
pub(super) fn given(field: &Field<'_>, context: &Context<'_>) -> Result<Given, ReadError> {
    let fields = Fields::new(field, &keys::SIDE)?;
    let springs = fields.get("springs").map(|field| springs(&field, context)).transpose()?;
    let beside = keys::SIDE.known().filter(|key| *key != "springs");
    let given: Vec<(&str, Field<'_>)> = beside.filter_map(|key| Some((key, fields.get(key)?))).collect();
    let contact = match &given[..] {
        [("contact", contact)] => Some(self::contact(contact, context)?),
        _ => None,
    };
    let condition = match &given[..] {
        [] | [("contact", _)] => Condition::Free,
        [("pressure", pressure)] => Condition::Pressure(pressure.expression(context)?),
        [("traction", traction)] => Condition::Traction(traction.expressions(context)?),
        [(_, values)] => displacement(values, None, context)?,
        [("displacement", values), ("traction", traction)] => displacement(values, Some(traction), context)?,
        [(first, _), .., (second, other)] => {
            let message = format!("{} has both {first} and {second}; a side has one condition", field.name);
            let help = format!(
                "remove {first} or {second}; only a displacement with a \"free\" component may have a traction beside it"
            );
            return Err(ReadError::new(DataErrorKind::Conflict, other.item.place, message, help));
        }
    };
    Ok(Given { condition, contact, springs })
}

/// `springs`: one stiffness, those along x and y, or those along normal and tangent.
fn springs(field: &Field<'_>, context: &Context<'_>) -> Result<Springs, ReadError> {
    match &field.item.value {
        Value::Array(_) => Ok(Springs::Axes(field.expressions(context)?)),
        Value::Table(_) => {
            let fields = Fields::new(field, &keys::SPRINGS)?;
            let stiffness = |key: &str| match fields.get(key) {
                Some(stiffness) => stiffness.expression(context),
                None => Ok(Expression::number(0.0)),
            };
            let [normal, tangential] = ["normal", "tangential"].map(stiffness);
            Ok(Springs::Normal { normal: normal?, tangential: tangential? })
        }
        Value::Text(_) | Value::Integer(_) | Value::Float(_) => Ok(Springs::both(field.expression(context)?)),
        _ => {
            let forms =
                "a stiffness: \"10\", [\"10\", \"0\"] along x and y, or { normal = \"10\", tangential = \"0\" }";
            Err(field.wrong_type(forms))
        }
    }
}

fn displacement(
    field: &Field<'_>,
    traction: Option<&Field<'_>>,
    context: &Context<'_>,
) -> Result<Condition, ReadError> {
    let mut values = [None, None];
    for (value, component) in values.iter_mut().zip(field.components()?) {
        let free = matches!(&component.item.value, Value::Text(text) if text.trim() == "free");
        *value = if free { None } else { Some(component.expression(context)?) };
    }
    let Some(loaded) = traction else {
        return Ok(if values.iter().all(Option::is_none) {
            Condition::Free
        } else {
            Condition::Displacement { values, traction: None }
        });
    };
    let traction = loaded.expressions(context)?;
    if values.iter().all(Option::is_none) {
        return Ok(Condition::Traction(traction));
    }
    if values.iter().all(Option::is_some) {
        return Err(ReadError::new(
            DataErrorKind::Conflict,
            loaded.item.place,
            format!("{} stands beside a displacement that holds both components", loaded.name),
            "remove the traction, or make a component of the displacement \"free\"",
        ));
    }
    for ((value, force), component) in values.iter().zip(&traction).zip(loaded.components()?) {
        if value.is_some() && force.constant() != Some(0.0) {
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                component.item.place,
                format!("{} is {:?}, but the displacement holds this component", component.name, force.text()),
                "write \"0\" for the held component: its traction is the reaction, which is computed",
            ));
        }
    }
    Ok(Condition::Displacement { values, traction: Some(traction) })
}

/// A table `contact`.
pub(super) fn contact(field: &Field<'_>, context: &Context<'_>) -> Result<Contact, ReadError> {
    let fields = Fields::new(field, &keys::CONTACT)?;
    let gap = match fields.get("gap") {
        Some(gap) => gap.expression(context)?,
        None => Expression::number(0.0),
    };
    let Some(law) = fields.get("friction") else { return Ok(Contact { gap, friction: Friction::None }) };
    if !matches!(law.item.value, Value::Table(_)) {
        return Err(law.wrong_type("a law: { tresca = \"0.3\" } or { coulomb = \"0.2\" }"));
    }
    let laws = Fields::new(&law, &keys::FRICTION)?;
    let friction = match (laws.get("tresca"), laws.get("coulomb")) {
        (Some(bound), None) => Friction::Tresca(bound.expression(context)?),
        (None, Some(coefficient)) => Friction::Coulomb(coefficient.expression(context)?),
        (Some(_), Some(second)) => {
            let message = format!("{} has two laws of friction", field.name);
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                second.item.place,
                message,
                "keep tresca or coulomb, not both",
            ));
        }
        (None, None) => {
            let message = format!("{} names no law", law.name);
            let help = "write { tresca = \"0.3\" } or { coulomb = \"0.2\" }, or leave friction out";
            return Err(ReadError::new(Kind::MissingKey, law.item.place, message, help));
        }
    };
    Ok(Contact { gap, friction })
}

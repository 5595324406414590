//! `[sides.NAME]`: what holds, loads or touches each side.

use steklov_bem_operators::Polygon;
use steklov_expression::Expression;
use steklov_problem::{Condition, Contact, DataErrorKind, Friction, Side};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::tree::{Value, suggestion};

/// What a table says of a side.
pub(super) enum Given {
    Condition(Condition),
    Contact(Contact),
}

/// The sides in the order of [`Polygon::side_names`], and the contacts of some of them.
pub(super) fn sides(
    field: Option<&Field<'_>>,
    polygon: &Polygon,
    context: &Context<'_>,
) -> Result<(Vec<Side>, Vec<Option<Contact>>), ReadError> {
    let names = polygon.side_names();
    let mut sides: Vec<Side> =
        names.iter().map(|name| Side { name: name.clone(), condition: Condition::Free }).collect();
    let mut contacts: Vec<Option<Contact>> = vec![None; names.len()];
    let Some(field) = field else { return Ok((sides, contacts)) };
    for (key, place, table) in Fields::open(field)?.all() {
        let Some(index) = names.iter().position(|name| name == key) else {
            let message = format!("the body has no side {key:?}");
            let help = suggestion(key, names.iter().map(String::as_str));
            return Err(ReadError::new(Kind::UnknownKey, place, message, help));
        };
        match given(&table, context)? {
            Given::Condition(condition) => sides[index].condition = condition,
            Given::Contact(contact) => contacts[index] = Some(contact),
        }
    }
    Ok((sides, contacts))
}

/// What a table says of a side.
pub(super) fn given(field: &Field<'_>, context: &Context<'_>) -> Result<Given, ReadError> {
    let fields = Fields::new(field, &keys::SIDE)?;
    let given: Vec<(&str, Field<'_>)> = keys::SIDE.iter().filter_map(|&key| Some((key, fields.get(key)?))).collect();
    Ok(Given::Condition(match &given[..] {
        [] => Condition::Free,
        [("contact", contact)] => return Ok(Given::Contact(self::contact(contact, context)?)),
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
    }))
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

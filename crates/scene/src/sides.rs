//! `[sides.NAME]`: what holds, loads or touches each side.

use steklov_bem_operators::Polygon;
use steklov_expression::Expression;
use steklov_problem::{Condition, DataError, DataErrorKind as Kind, Friction, Side};

use super::fields::{Context, Field, Fields};
use super::keys;
use super::tree::{Value, suggestion};

/// The sides in the order of [`Polygon::side_names`].
pub(super) fn sides(
    field: Option<&Field<'_>>,
    polygon: &Polygon,
    context: &Context<'_>,
) -> Result<Vec<Side>, DataError> {
    let names = polygon.side_names();
    let mut sides: Vec<Side> =
        names.iter().map(|name| Side { name: name.clone(), condition: Condition::Free }).collect();
    let Some(field) = field else { return Ok(sides) };
    for (key, place, table) in Fields::open(field)?.all() {
        let Some(side) = sides.iter_mut().find(|side| side.name == key) else {
            let message = format!("the body has no side {key:?}");
            let help = suggestion(key, names.iter().map(String::as_str));
            return Err(DataError::new(Kind::UnknownKey, place, message, help));
        };
        side.condition = condition(&table, context)?;
    }
    Ok(sides)
}

fn condition(field: &Field<'_>, context: &Context<'_>) -> Result<Condition, DataError> {
    let fields = Fields::new(field, &keys::SIDE)?;
    let given: Vec<(&str, Field<'_>)> = keys::SIDE.iter().filter_map(|&key| Some((key, fields.get(key)?))).collect();
    match &given[..] {
        [] => Ok(Condition::Free),
        [("contact", contact)] => self::contact(contact, context),
        [("pressure", pressure)] => Ok(Condition::Pressure(pressure.expression(context)?)),
        [("traction", traction)] => Ok(Condition::Traction(traction.expressions(context)?)),
        [(_, values)] => displacement(values, None, context),
        [("displacement", values), ("traction", traction)] => displacement(values, Some(traction), context),
        [(first, _), .., (second, other)] => Err(DataError::new(
            Kind::Conflict,
            other.item.place,
            format!("{} has both {first} and {second}; a side has one condition", field.name),
            format!(
                "remove {first} or {second}; only a displacement with a \"free\" component may have a traction beside it"
            ),
        )),
    }
}

fn displacement(
    field: &Field<'_>,
    traction: Option<&Field<'_>>,
    context: &Context<'_>,
) -> Result<Condition, DataError> {
    let mut values = [None, None];
    for (value, component) in values.iter_mut().zip(field.pair()?) {
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
        return Err(DataError::new(
            Kind::Conflict,
            loaded.item.place,
            format!("{} stands beside a displacement that holds both components", loaded.name),
            "remove the traction, or make a component of the displacement \"free\"",
        ));
    }
    for ((value, force), component) in values.iter().zip(&traction).zip(loaded.pair()?) {
        if value.is_some() && force.constant() != Some(0.0) {
            return Err(DataError::new(
                Kind::Conflict,
                component.item.place,
                format!("{} is {:?}, but the displacement holds this component", component.name, force.text()),
                "write \"0\" for the held component: its traction is the reaction, which is computed",
            ));
        }
    }
    Ok(Condition::Displacement { values, traction: Some(traction) })
}

fn contact(field: &Field<'_>, context: &Context<'_>) -> Result<Condition, DataError> {
    let fields = Fields::new(field, &keys::CONTACT)?;
    let gap = match fields.get("gap") {
        Some(gap) => gap.expression(context)?,
        None => Expression::number(0.0),
    };
    let Some(law) = fields.get("friction") else { return Ok(Condition::Contact { gap, friction: Friction::None }) };
    if !matches!(law.item.value, Value::Table(_)) {
        return Err(law.wrong_type("a law: { tresca = \"0.3\" } or { coulomb = \"0.2\" }"));
    }
    let laws = Fields::new(&law, &keys::FRICTION)?;
    let friction = match (laws.get("tresca"), laws.get("coulomb")) {
        (Some(bound), None) => Friction::Tresca(bound.expression(context)?),
        (None, Some(coefficient)) => Friction::Coulomb(coefficient.expression(context)?),
        (Some(_), Some(second)) => {
            let message = format!("{} has two laws of friction", field.name);
            return Err(DataError::new(Kind::Conflict, second.item.place, message, "keep tresca or coulomb, not both"));
        }
        (None, None) => {
            let message = format!("{} names no law", law.name);
            let help = "write { tresca = \"0.3\" } or { coulomb = \"0.2\" }, or leave friction out";
            return Err(DataError::new(Kind::MissingKey, law.item.place, message, help));
        }
    };
    Ok(Condition::Contact { gap, friction })
}

//! `[sides.NAME]`: what holds, loads or touches each side.

use steklov_bem_operators::Polygon;
use steklov_expression::Expression;

use super::error::{Problem, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::tree::{Value, suggestion};

/// Condition on a side; n points out of the body.
#[derive(Debug, Clone)]
pub enum Condition {
    /// No traction.
    Free,
    /// Traction t = (t_x, t_y) (stress).
    Traction([Expression; 2]),
    /// Pressure q (stress): t = -q n.
    Pressure(Expression),
    /// Prescribed displacement (length) of the components that are held, at least one.
    Displacement {
        /// Value of each component; `None` where it is free.
        values: [Option<Expression>; 2],
        /// Traction (stress) on the free component; the held one is 0.
        traction: Option<[Expression; 2]>,
    },
    /// Contact with a rigid obstacle.
    Contact {
        /// Distance to the obstacle along n from the undeformed point (length); negative is an overlap.
        gap: Expression,
        /// Law of friction.
        friction: Friction,
    },
}

/// Law of friction of a contact side.
#[derive(Debug, Clone)]
pub enum Friction {
    /// Frictionless.
    None,
    /// Tresca: |λ_t| ≤ F with a given bound F ≥ 0 (stress).
    Tresca(Expression),
    /// Coulomb: |λ_t| ≤ μ λ_n with a given coefficient μ ≥ 0.
    Coulomb(Expression),
}

impl Friction {
    /// The bound of Tresca's law.
    pub fn bound(&self) -> Option<&Expression> {
        if let Self::Tresca(bound) = self { Some(bound) } else { None }
    }

    /// The coefficient of Coulomb's law.
    pub fn coefficient(&self) -> Option<&Expression> {
        if let Self::Coulomb(coefficient) = self { Some(coefficient) } else { None }
    }
}

/// A side of the body: all edges of one name.
#[derive(Debug, Clone)]
pub struct Side {
    /// Its name.
    pub name: String,
    /// What acts on it.
    pub condition: Condition,
}

impl Side {
    /// Whether it holds a component of the displacement.
    pub(crate) fn holds(&self, component: usize) -> bool {
        matches!(&self.condition, Condition::Displacement { values, .. } if values[component].is_some())
    }
}

/// The sides in the order of [`Polygon::side_names`].
pub(super) fn sides(field: Option<&Field<'_>>, polygon: &Polygon, context: &Context<'_>) -> Result<Vec<Side>, Problem> {
    let names = polygon.side_names();
    let mut sides: Vec<Side> =
        names.iter().map(|name| Side { name: name.clone(), condition: Condition::Free }).collect();
    let Some(field) = field else { return Ok(sides) };
    for (key, place, table) in Fields::open(field)?.all() {
        let Some(side) = sides.iter_mut().find(|side| side.name == key) else {
            let message = format!("the body has no side {key:?}");
            let help = suggestion(key, names.iter().map(String::as_str));
            return Err(Problem::new(Kind::UnknownKey, place, message, help));
        };
        side.condition = condition(&table, context)?;
    }
    Ok(sides)
}

fn condition(field: &Field<'_>, context: &Context<'_>) -> Result<Condition, Problem> {
    let fields = Fields::new(field, &keys::SIDE)?;
    let given: Vec<(&str, Field<'_>)> = keys::SIDE.iter().filter_map(|&key| Some((key, fields.get(key)?))).collect();
    match &given[..] {
        [] => Ok(Condition::Free),
        [("contact", contact)] => self::contact(contact, context),
        [("pressure", pressure)] => Ok(Condition::Pressure(pressure.expression(context)?)),
        [("traction", traction)] => Ok(Condition::Traction(traction.expressions(context)?)),
        [(_, values)] => displacement(values, None, context),
        [("displacement", values), ("traction", traction)] => displacement(values, Some(traction), context),
        [(first, _), .., (second, other)] => Err(Problem::new(
            Kind::Conflict,
            other.item.place,
            format!("{} has both {first} and {second}; a side has one condition", field.name),
            format!(
                "remove {first} or {second}; only a displacement with a \"free\" component may have a traction beside it"
            ),
        )),
    }
}

fn displacement(field: &Field<'_>, traction: Option<&Field<'_>>, context: &Context<'_>) -> Result<Condition, Problem> {
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
        return Err(Problem::new(
            Kind::Conflict,
            loaded.item.place,
            format!("{} stands beside a displacement that holds both components", loaded.name),
            "remove the traction, or make a component of the displacement \"free\"",
        ));
    }
    for ((value, force), component) in values.iter().zip(&traction).zip(loaded.pair()?) {
        if value.is_some() && force.constant() != Some(0.0) {
            return Err(Problem::new(
                Kind::Conflict,
                component.item.place,
                format!("{} is {:?}, but the displacement holds this component", component.name, force.text()),
                "write \"0\" for the held component: its traction is the reaction, which is computed",
            ));
        }
    }
    Ok(Condition::Displacement { values, traction: Some(traction) })
}

fn contact(field: &Field<'_>, context: &Context<'_>) -> Result<Condition, Problem> {
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
            return Err(Problem::new(Kind::Conflict, second.item.place, message, "keep tresca or coulomb, not both"));
        }
        (None, None) => {
            let message = format!("{} names no law", law.name);
            let help = "write { tresca = \"0.3\" } or { coulomb = \"0.2\" }, or leave friction out";
            return Err(Problem::new(Kind::MissingKey, law.item.place, message, help));
        }
    };
    Ok(Condition::Contact { gap, friction })
}

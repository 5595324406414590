//! `[quantities]`: numbers that are wanted, by names.

use steklov_problem::steklov_expression::{Expression, is_name};
use steklov_problem::{DataErrorKind, NamedQuantity, Problem, QuantityKind};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::probe::side;
use super::random::Declared;

/// The keys of which a quantity has one.
const KINDS: [&str; 5] = ["pressure_at", "mean_displacement", "moment", "weighted_force", "opening_at"];
/// Keys that stand beside one of these.
const BESIDE: [(&str, &str); 2] = [("about", "moment"), ("weight", "weighted_force")];

/// Reads the table.
pub(super) fn quantities(
    field: &Field<'_>,
    problem: &Problem,
    (context, declared): (&Context<'_>, &[(String, Declared)]),
) -> Result<Vec<NamedQuantity>, ReadError> {
    let mut list = Vec::new();
    for (name, place, table) in Fields::open(field)?.all() {
        if !is_name(name) {
            let help = "use letters, digits and _, a letter first";
            return Err(ReadError::new(
                DataErrorKind::Value,
                place,
                format!("the name {name:?} is none of a quantity"),
                help,
            ));
        }
        list.push(NamedQuantity { name: name.to_owned(), kind: kind(&table, problem, (context, declared))? });
    }
    Ok(list)
}

fn kind(
    table: &Field<'_>,
    problem: &Problem,
    (context, declared): (&Context<'_>, &[(String, Declared)]),
) -> Result<QuantityKind, ReadError> {
    let fields = Fields::new(table, &keys::QUANTITY)?;
    let given: Vec<Field<'_>> = KINDS.iter().filter_map(|key| fields.get(key)).collect();
    let [field] = &given[..] else {
        let (sort, message) = match given.get(1) {
            None => (Kind::MissingKey, format!("{} does not say what it is", table.name)),
            Some(second) => {
                (DataErrorKind::Conflict.into(), format!("{} stands beside {}", second.name, given[0].name))
            }
        };
        let help = "a quantity has one of pressure_at = [x, y], mean_displacement = \"SIDE\", moment = \"SIDE\" with about = [x, y], \
                    weighted_force = \"SIDE\" with weight = [\"…\", \"…\"], opening_at = [x, y]";
        return Err(ReadError::new(sort, given.get(1).map_or(fields.place, |second| second.item.place), message, help));
    };
    for (key, of) in BESIDE {
        if let Some(beside) = fields.get(key).filter(|_| fields.get(of).is_none()) {
            let message = format!("{} stands without {of}", beside.name);
            return Err(ReadError::new(DataErrorKind::Conflict, beside.item.place, message, "remove it"));
        }
    }
    Ok(match field.name.rsplit('.').next() {
        Some("pressure_at") => QuantityKind::PressureAt(field.point()?),
        Some("opening_at") => QuantityKind::OpeningAt(field.point()?),
        Some("moment") => QuantityKind::Moment {
            side: side(field, problem)?,
            about: fields.require("about", "about = [x, y]")?.point()?,
        },
        Some("weighted_force") => QuantityKind::WeightedForce {
            side: side(field, problem)?,
            weight: weight(&fields.require("weight", "weight = [\"1\", \"0\"]")?, (context, declared))?,
        },
        _ => QuantityKind::MeanDisplacement(side(field, problem)?),
    })
}

/// Two expressions of x and y.
fn weight(
    field: &Field<'_>,
    (context, declared): (&Context<'_>, &[(String, Declared)]),
) -> Result<[Expression; 2], ReadError> {
    let one = |component: &Field<'_>| {
        let expression = component.expression_inside(context)?;
        match expression.names().iter().find(|name| declared.iter().any(|(random, _)| random == *name)) {
            Some(name) => {
                let message = format!("{} uses the random {name}", component.name);
                Err(ReadError::new(DataErrorKind::Value, component.item.place, message, "write it of x and y alone"))
            }
            None => Ok(expression),
        }
    };
    let [x, y] = field.components()?;
    Ok([one(&x)?, one(&y)?])
}

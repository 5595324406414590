//! `[quantities]`: numbers that are wanted, by names.

use steklov_problem::steklov_expression::is_name;
use steklov_problem::{DataErrorKind, NamedQuantity, Problem, QuantityKind};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Field, Fields};
use super::keys;
use super::probe::side;

/// The keys of which a quantity has one.
const KINDS: [&str; 4] = ["pressure_at", "mean_displacement", "moment", "opening_at"];

/// Reads the table.
pub(super) fn quantities(field: &Field<'_>, problem: &Problem) -> Result<Vec<NamedQuantity>, ReadError> {
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
        list.push(NamedQuantity { name: name.to_owned(), kind: kind(&table, problem)? });
    }
    Ok(list)
}

fn kind(table: &Field<'_>, problem: &Problem) -> Result<QuantityKind, ReadError> {
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
                    opening_at = [x, y]";
        return Err(ReadError::new(sort, given.get(1).map_or(fields.place, |second| second.item.place), message, help));
    };
    let is_moment = fields.get("moment").is_some();
    if let Some(about) = fields.get("about").filter(|_| !is_moment) {
        let message = format!("{} stands without moment", about.name);
        return Err(ReadError::new(DataErrorKind::Conflict, about.item.place, message, "remove it"));
    }
    Ok(match field.name.rsplit('.').next() {
        Some("pressure_at") => QuantityKind::PressureAt(field.point()?),
        Some("opening_at") => QuantityKind::OpeningAt(field.point()?),
        Some("moment") => QuantityKind::Moment {
            side: side(field, problem)?,
            about: fields.require("about", "about = [x, y]")?.point()?,
        },
        _ => QuantityKind::MeanDisplacement(side(field, problem)?),
    })
}

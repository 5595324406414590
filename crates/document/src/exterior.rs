//! `[exterior]`: the unbounded medium around the body, or around the hole that the corners of `[body]` outline.

use steklov_coupling::Radiation;
use steklov_elastic::{Material, Plane};
use steklov_problem::{DataErrorKind, FarField, Tie};

use super::body::material;
use super::error::ReadError;
use super::fields::{Context, Field, Fields};
use super::keys;

/// The behaviour of the displacement far away, and its word.
pub(super) const RADIATIONS: [(&str, Radiation); 2] =
    [("decaying", Radiation::Decaying), ("bounded", Radiation::Bounded)];

/// Reads `[exterior]`, the medium and how a body is tied to it; `body`: the plane assumption of the body's material,
/// None for a hole in the medium.
pub(super) fn exterior(
    field: &Field<'_>,
    body: Option<Plane>,
    context: &Context<'_>,
) -> Result<(Material, FarField, Tie), ReadError> {
    let jumps = ["displacement_jump", "traction_jump", "stress_jump"];
    let [displacement, traction, stress] = jumps;
    let fields = Fields::new(field, &keys::EXTERIOR)?;
    let young = fields.require("young", "young = a positive number")?.constant(context)?;
    let mut material = material(&fields, context, young)?;
    match (fields.get("plane"), body) {
        (Some(plane), Some(body)) if material.plane != body => {
            let message = format!("{} is not that of the body", plane.name);
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                plane.item.place,
                message,
                "remove it: material.plane counts",
            ));
        }
        (_, Some(body)) => material.plane = body,
        (_, None) => {}
    }
    if let (Some(jump), None) = (jumps.iter().find_map(|jump| fields.get(jump)), body) {
        let message = format!("{} needs a body that the medium meets, and there is no [material] of one", jump.name);
        let help = "load the sides of the hole by [sides], or give the body a [material]";
        return Err(ReadError::new(DataErrorKind::Conflict, jump.item.place, message, help));
    }
    let pair = |key: &str| fields.get(key).map(|jump| jump.expressions(context)).transpose();
    let stress_jump = match fields.get(stress) {
        Some(jump) => {
            let [xx, yy, xy] = tensor(&jump)?;
            Some([xx.expression(context)?, yy.expression(context)?, xy.expression(context)?])
        }
        None => None,
    };
    let (displacement_jump, traction_jump) = (pair(displacement)?, pair(traction)?);
    Ok((material, far_field(&fields, context)?, Tie { displacement_jump, traction_jump, stress_jump }))
}

/// `remote_stress` and `at_infinity` of a medium.
pub(super) fn far_field(fields: &Fields<'_>, context: &Context<'_>) -> Result<FarField, ReadError> {
    let mut named = false;
    let remote_stress = match fields.get("remote_stress") {
        Some(remote) => {
            let [xx, yy, xy] = tensor(&remote)?;
            named = [&xx, &yy, &xy].into_iter().any(|entry| match entry.expression(context) {
                Ok(expression) => !expression.names().is_empty(),
                Err(_) => false,
            });
            let value = [xx.constant(context)?, yy.constant(context)?, xy.constant(context)?];
            if value.iter().any(|s| !s.is_finite()) {
                return Err(remote.problem(format!("{} is {value:?}", remote.name), "it must be finite"));
            }
            value
        }
        None => [0.0; 3],
    };
    let at_infinity = fields.get("at_infinity").map(|word| word.choice(&RADIATIONS)).transpose()?;
    Ok(FarField { remote_stress, at_infinity, named })
}

/// The three entries xx, yy, xy of a symmetric tensor.
fn tensor<'a>(field: &Field<'a>) -> Result<[Field<'a>; 3], ReadError> {
    let list = field.list()?;
    let count = list.len();
    let wrong = |_| field.problem(format!("{} has {count} entries", field.name), "it takes three: xx, yy and xy");
    list.try_into().map_err(wrong)
}

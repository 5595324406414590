//! `[grid]`, `[material.cells]` and `[exterior]`: read and checked, though no model of this version uses them.

use super::body::material;
use super::error::{Problem, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::tree::Value;

pub(super) fn grid(field: &Field<'_>) -> Result<(), Problem> {
    let fields = Fields::new(field, &["coarse", "fine", "basis", "oversample"])?;
    for key in ["coarse", "fine"] {
        for count in fields.require(key, &format!("{key} = [cells along x, cells along y]"))?.pair()? {
            count.whole(1, 1_000_000)?;
        }
    }
    if let Some(basis) = fields.get("basis") {
        let words = ["linear", "coupled", "oscillatory", "oversampled", "periodic", "q1"];
        basis.choice(&words.map(|word| (word, ())))?;
    }
    if let Some(cells) = fields.get("oversample") {
        cells.whole(0, 1_000_000)?;
    }
    Ok(())
}

pub(super) fn cells(field: &Field<'_>, context: &Context<'_>) -> Result<(), Problem> {
    let fields = Fields::new(field, &["size", "young"])?;
    let size = fields.require("size", "size = the edge length of a cell")?;
    size.number_where(|v| v > 0.0 && v.is_finite(), "a positive length")?;
    let young = fields.require("young", "young = { uniform = [low, high], seed = 1 }")?;
    if !matches!(young.item.value, Value::Table(_)) {
        return young.expression(context).map(drop);
    }
    let table = Fields::new(&young, &["uniform", "seed", "file", "dataset"])?;
    match (table.get("uniform"), table.get("file")) {
        (Some(uniform), None) => {
            let [low, high] = uniform.point()?;
            if !(low > 0.0 && low <= high && high.is_finite()) {
                let message = format!("{} is [{low}, {high}]", uniform.name);
                return Err(uniform.problem(message, "both must be positive moduli, the lower one first"));
            }
            table.get("seed").map_or(Ok(0), |seed| seed.whole(0, i64::MAX as usize)).map(drop)
        }
        (None, Some(file)) => {
            file.text()?;
            table.require("dataset", "dataset = \"/young\"")?.text().map(drop)
        }
        (Some(_), Some(file)) => {
            let message = format!("{} has both uniform and file", young.name);
            Err(Problem::new(Kind::Conflict, file.item.place, message, "keep one of the two"))
        }
        (None, None) => {
            let message = format!("{} has neither uniform nor file", young.name);
            let help = "write { uniform = [low, high], seed = 1 } or { file = \"young.h5\", dataset = \"/young\" }";
            Err(Problem::new(Kind::MissingKey, young.item.place, message, help))
        }
    }
}

pub(super) fn exterior(field: &Field<'_>, context: &Context<'_>) -> Result<(), Problem> {
    let fields = Fields::new(field, &["young", "poisson", "displacement_jump", "traction_jump"])?;
    let young = fields.require("young", "young = a positive number")?.constant(context)?;
    material(&fields, context, young)?;
    for key in ["displacement_jump", "traction_jump"] {
        if let Some(jump) = fields.get(key) {
            jump.expressions(context)?;
        }
    }
    Ok(())
}

//! `[grid]` and `[material.cells]`: the grid of a heterogeneous body and its moduli.

use steklov_bem_operators::Polygon;
use steklov_elastic::Material;
use steklov_problem::{
    BASES, BasisInput, CellModuli, Cells, DataErrorKind, GridInput, TableOrder, bounding_box, modulus_cells,
};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::form::{Range, Table};
use super::image::from_image;
use super::keys;
use super::source::Source;
use super::table_file::from_file;
use super::tree::Value;

/// The orders of a table that a scene may name, and their words.
pub(super) const ORDERS: [(&str, TableOrder); 2] = [("xy", TableOrder::Xy), ("rows", TableOrder::Rows)];

pub(super) fn grid(field: &Field<'_>) -> Result<GridInput, ReadError> {
    let fields = Fields::new(field, &keys::GRID)?;
    let counts = |key: &str| -> Result<[usize; 2], ReadError> {
        let [x, y] = fields.require(key, &format!("{key} = [cells along x, cells along y]"))?.components()?;
        Ok([x.whole(keys::CELL_COUNT)?, y.whole(keys::CELL_COUNT)?])
    };
    let (coarse, fine) = (counts("coarse")?, counts("fine")?);
    let basis = fields.get("basis").map_or(Ok(BasisInput::Coupled), |basis| basis.choice(&BASES))?;
    let oversample = fields.get("oversample").map(|cells| cells.whole(keys::OVERSAMPLE)).transpose()?;
    let grid = GridInput { coarse, fine, basis, oversample };
    if let Err((key, message, help)) = grid.check() {
        return Err(fields.require(key, "the numbers of cells")?.problem(message, help));
    }
    Ok(grid)
}

/// Reads `[material.cells]`; `of_unit_modulus` gives the material for modulus 1.
pub(super) fn cells(
    field: &Field<'_>,
    polygon: &Polygon,
    of_unit_modulus: impl FnOnce(Option<f64>) -> Result<Material, ReadError>,
    context: &Context<'_>,
) -> Result<Cells, ReadError> {
    let fields = Fields::new(field, &keys::CELLS)?;
    let size = fields.require("size", "size = the edge length of a cell")?;
    let size = size.number_in(&keys::LENGTH)?;
    let young = fields.require("young", "young = { uniform = [low, high], seed = 1 }")?;
    let values = |field: &Field<'_>, entries: &'static Table| match field.item.value {
        Value::Table(_) => table(field, entries, modulus_cells(polygon, size), size, context.source),
        _ => Ok(CellModuli::Expression(field.expression_inside(context)?)),
    };
    let poisson = fields.get("poisson").map(|field| values(&field, &keys::RATIOS)).transpose()?;
    let of_unit_modulus = of_unit_modulus(poisson.as_ref().map(|ratios| about(ratios, polygon)))?;
    Ok(Cells { size, young: values(&young, &keys::MODULI)?, poisson, of_unit_modulus })
}

/// About the mean of the ratios of cells: that of their ends, of a table, or of an expression at points of the bounding box.
fn about(ratios: &CellModuli, polygon: &Polygon) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let mean = match ratios {
        CellModuli::Uniform { low, high, .. } => 0.5 * (low + high),
        CellModuli::Table { values, .. } => mean(values),
        CellModuli::Expression(ratio) => {
            let (low, size) = bounding_box(polygon);
            let at = |k: usize| {
                let place = [k % PLACES, k / PLACES].map(|i| (i as f64 + 0.5) / PLACES as f64);
                ratio.eval(low[0] + place[0] * size[0], low[1] + place[1] * size[1], 0.0)
            };
            mean(&(0..PLACES * PLACES).map(at).collect::<Vec<f64>>())
        }
    };
    // what is wrong in a cell is told of that cell
    if mean > -1.0 && mean < 0.5 { mean } else { 0.0 }
}

/// Points along each side at which a ratio is averaged.
const PLACES: usize = 16;

/// Moduli that are random numbers or come from a file; `cells`: the numbers of cells of this size along x and y, if
/// they fit the body.
fn table(
    young: &Field<'_>,
    entries: &'static Table,
    cells: Option<[usize; 2]>,
    size: f64,
    source: &Source,
) -> Result<CellModuli, ReadError> {
    let table = Fields::new(young, entries)?;
    let beside = |key: &str, of: &str| match table.get(key) {
        Some(field) => {
            let message = format!("{} stands without {of}", field.name);
            Err(ReadError::new(DataErrorKind::Conflict, field.item.place, message, format!("remove it, or add {of}")))
        }
        None => Ok(()),
    };
    if let Some(image) = table.get("image") {
        let range = if std::ptr::eq(entries, &raw const keys::RATIOS) { &keys::RATIO } else { &keys::POSITIVE };
        return of_image(&image, (&table, range), (cells, size), source);
    }
    beside("low", "image")?;
    beside("high", "image")?;
    match (table.get("uniform"), table.get("file")) {
        (Some(uniform), None) => {
            beside("dataset", "file")?;
            beside("order", "file")?;
            let is_ratio = std::ptr::eq(entries, &raw const keys::RATIOS);
            let what = if is_ratio { "the lowest and the highest ratio" } else { "the lowest and the highest modulus" };
            let [low, high] = uniform.pair(what)?;
            let (low, high) = (low.number()?, high.number()?);
            let (fits, help) = match is_ratio {
                true => (low > -1.0 && high < 0.5, "both must be above -1 and below 0.5, the lower one first"),
                false => (low > 0.0 && high.is_finite(), "both must be positive moduli, the lower one first"),
            };
            if !(fits && low <= high) {
                return Err(uniform.problem(format!("{} is [{low}, {high}]", uniform.name), help));
            }
            let seed = table.get("seed").map_or(Ok(0), |seed| seed.whole(keys::NATURAL))? as u64;
            Ok(CellModuli::Uniform { low, high, seed })
        }
        (None, Some(file)) => {
            beside("seed", "uniform")?;
            let dataset = table.require("dataset", "dataset = \"/young\"")?;
            from_file((&file, &dataset, table.get("order")), (cells, size), source)
        }
        (Some(_), Some(file)) => {
            let message = format!("{} has both uniform and file", young.name);
            Err(ReadError::new(DataErrorKind::Conflict, file.item.place, message, "keep one of the two"))
        }
        (None, None) => {
            let message = format!("{} has none of uniform, file and image", young.name);
            let help = "write { uniform = [low, high], seed = 1 }, { file = \"young.h5\", dataset = \"/young\" } or \
                        { image = \"young.png\", low = 1, high = 10 }";
            Err(ReadError::new(Kind::MissingKey, young.item.place, message, help))
        }
    }
}

/// The numbers of an image, beside which nothing else may stand.
fn of_image(
    image: &Field<'_>,
    (table, range): (&Fields<'_>, &Range),
    (cells, size): (Option<[usize; 2]>, f64),
    source: &Source,
) -> Result<CellModuli, ReadError> {
    for key in ["uniform", "seed", "file", "dataset", "order"] {
        if let Some(other) = table.get(key) {
            let message = format!("{} stands beside {}", other.name, image.name);
            return Err(ReadError::new(DataErrorKind::Conflict, other.item.place, message, "keep one of the two"));
        }
    }
    let ends = ["low", "high"].map(|key| {
        let field =
            table.require(key, &format!("{key} = the number of {}", if key == "low" { "black" } else { "white" }))?;
        field.number_in(range)
    });
    let [low, high] = ends;
    from_image(image, [low?, high?], (cells, size), source)
}

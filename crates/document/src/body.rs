//! `[body]`, `[material]`, `[parameters]`, `[body_force]`.

use std::collections::BTreeMap;

use steklov_bem_operators::{Loop, Polygon, PolygonError};
use steklov_elastic::{Material, MaterialError, Plane};
use steklov_expression::{Expression, is_name, is_reserved};
use steklov_problem::{About, DataErrorKind};

use super::curves;
use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Context, Field, Fields};
use super::keys;
use super::source::Source;

/// Every plane assumption and its word.
pub(super) const PLANES: [(&str, Plane); 2] = [("strain", Plane::Strain), ("stress", Plane::Stress)];

/// `[parameters]`.
#[derive(Default)]
pub(super) struct Parameters {
    /// The names and their values.
    pub(super) values: BTreeMap<String, f64>,
    /// The names in their order, each with the names above it that it uses.
    pub(super) uses: Vec<(String, Vec<String>)>,
}

/// Names and values of `[parameters]`: numbers, or expressions of the ones above.
pub(super) fn parameters(field: &Field<'_>, source: &Source) -> Result<Parameters, ReadError> {
    let mut context = Context::new(source, BTreeMap::new());
    let mut uses = Vec::new();
    for (key, place, value) in Fields::open(field)?.all() {
        check_name(key, place)?;
        let number = value.constant(&context).map_err(|error| used_before(error, key, field, source))?;
        if !number.is_finite() {
            return Err(value.problem(format!("the parameter {key} is {number}"), "it must be finite"));
        }
        context.constants.insert(key.to_owned(), number);
        uses.push((key.to_owned(), context.used.take().into_iter().collect()));
    }
    Ok(Parameters { values: context.constants, uses })
}

/// The error of a parameter that uses a name, with help if the name is defined below it.
fn used_before(error: ReadError, key: &str, all: &Field<'_>, source: &Source) -> ReadError {
    let About::Text(place) = error.about else { return error };
    let name = &source.part(place.source)[place.start..place.end];
    if error.kind != Kind::Expression || all.item.at(&[name]).is_none() {
        return error;
    }
    let help = if name == key {
        "give it a value that does not use itself".to_owned()
    } else {
        format!("write {name} above {key}; if it uses {key} itself, give one of the two a number")
    };
    let message = format!("parameters.{key} uses {name}, and parameters know only those above them");
    ReadError { message, help, ..error }
}

/// Checks that a new name has no meaning of its own in expressions.
pub(super) fn check_name(name: &str, place: steklov_expression::Place) -> Result<(), ReadError> {
    if is_reserved(name) {
        let message = format!("the name {name:?} has a meaning of its own in expressions");
        return Err(ReadError::new(
            DataErrorKind::Conflict,
            place,
            message,
            format!("choose another name, such as {name}0"),
        ));
    }
    if !is_name(name) {
        let message = format!("the name {name:?} cannot be written in an expression");
        return Err(ReadError::new(DataErrorKind::Value, place, message, "use letters, digits and _, a letter first"));
    }
    Ok(())
}

/// Corners and sides of a loop as listed, for messages; for a circle or an ellipse the table itself.
struct Listed<'a> {
    corners: Field<'a>,
    sides: Field<'a>,
    /// The listed corner that each one comes from.
    origin: Vec<usize>,
}

fn read_loop<'a>(fields: &Fields<'a>) -> Result<(Loop, Listed<'a>), ReadError> {
    if let Some(whole) = curves::whole_loop(fields)? {
        let field = || fields.get("circle").or(fields.get("ellipse"));
        let (Some(corners), Some(sides)) = (field(), field()) else { unreachable!("it was read") };
        let origin = (0..whole.corners.len()).collect();
        return Ok((whole, Listed { corners, sides, origin }));
    }
    let corners = fields.require("corners", "corners = [[x, y], ...]")?;
    let sides = fields.require("sides", "sides = [\"name\", ...], one name for each edge")?;
    let mut listed = Loop::straight(
        corners.list()?.iter().map(Field::point).collect::<Result<_, _>>()?,
        sides.list()?.iter().map(|s| s.text().map(str::to_owned)).collect::<Result<_, _>>()?,
    );
    // errors of the lists themselves are reported when the loop is checked
    let count = listed.corners.len();
    let whole = listed.sides.len() == count && count >= 2 && listed.corners.iter().flatten().all(|c| c.is_finite());
    if !whole {
        return Ok((listed, Listed { corners, sides, origin: (0..count).collect() }));
    }
    listed.paths = curves::paths(fields, &listed)?;
    let (listed, origin) = curves::fillet(fields, listed)?;
    Ok((listed, Listed { corners, sides, origin }))
}

/// The unbounded plane without the holes of a body.
pub(super) fn medium(fields: &Fields<'_>) -> Result<Polygon, ReadError> {
    let outer = ["corners", "sides", "arcs", "curves", "fillet", "circle", "ellipse", "side"];
    if let Some(field) = outer.into_iter().find_map(|key| fields.get(key)) {
        let message = format!("{} outlines a body, and a medium is the whole plane but for its holes", field.name);
        let help = "remove what outlines it, as corners and sides: the plane is not cut off far away; a loop that bounds a hole \
                    belongs in [[body.holes]] below the [[body]] of the medium; for a bounded body remove medium";
        return Err(ReadError::new(DataErrorKind::Conflict, field.item.place, message, help));
    }
    let holes = fields.require("holes", "[[body.holes]] with corners and sides: where the medium meets something")?;
    if holes.list()?.is_empty() {
        let message = format!("{} lists no hole, and the medium meets nothing", holes.name);
        return Err(holes.problem(message, "write a table [[body.holes]] with corners and sides for each"));
    }
    loops_of(fields, Vec::new(), true)
}

/// The polygon of the fields of `[body]`; `cavity`: its loops are holes in the unbounded plane.
pub(super) fn body(fields: &Fields<'_>, cavity: bool) -> Result<Polygon, ReadError> {
    loops_of(fields, vec![read_loop(fields)?], cavity)
}

/// The polygon of the given loops and the loops of `holes`.
fn loops_of<'a>(fields: &Fields<'a>, first: Vec<(Loop, Listed<'a>)>, cavity: bool) -> Result<Polygon, ReadError> {
    let (mut loops, mut listed): (Vec<Loop>, Vec<Listed<'a>>) = first.into_iter().unzip();
    if let Some(list) = fields.get("holes") {
        for hole in list.list()? {
            let (corners, names) = read_loop(&Fields::new(&hole, &keys::LOOP)?)?;
            loops.push(corners);
            listed.push(names);
        }
    }
    if cavity {
        return Polygon::outside(loops).map_err(|e| geometry(e, &listed, 1));
    }
    Polygon::new(loops.remove(0), loops).map_err(|e| geometry(e, &listed, 0))
}

/// A geometrical error at its place, with its remedy; `first` is the number of the first listed loop in the error.
fn geometry(error: PolygonError, listed: &[Listed<'_>], first: usize) -> ReadError {
    let corners = |l: usize| listed[l - first].corners.item.place;
    let corner = |l: usize, k: usize| {
        let Listed { corners, origin, .. } = &listed[l - first];
        let k = origin.get(k).copied().unwrap_or(k);
        corners.list().ok().and_then(|list| list.get(k).map(|c| c.item.place)).unwrap_or(corners.item.place)
    };
    let names = |l: usize| &listed[l - first].sides;
    let side = |l: usize, k: usize| {
        let k = listed[l - first].origin.get(k).copied().unwrap_or(k);
        names(l).list().ok().and_then(|list| list.get(k).map(|name| name.item.place)).unwrap_or(names(l).item.place)
    };
    let (place, help) = match &error {
        PolygonError::TooFewCorners { loop_index, .. } => (corners(*loop_index), "list at least three corners"),
        PolygonError::SideCount { loop_index, .. } => {
            (names(*loop_index).item.place, "side k runs from corner k to the next; the last one closes the loop")
        }
        PolygonError::EmptySide { loop_index, edge } => (side(*loop_index, *edge), "give every side a name"),
        PolygonError::NotFinite { loop_index, corner: k, .. } => (corner(*loop_index, *k), "write finite coordinates"),
        PolygonError::ZeroEdge { edge, .. } => {
            (corner(edge.loop_index, edge.corner), "remove one of the two corners, and its side")
        }
        PolygonError::FarFromOrigin { .. } => (corners(first), "move the origin of the coordinates to the body"),
        PolygonError::ZeroArea { loop_index, .. } => (corners(*loop_index), "move a corner off the line"),
        PolygonError::Clockwise { .. } => (
            corners(0),
            "reverse the corners; the sides then go in reverse too, each still running from its corner to the next",
        ),
        PolygonError::Spike { loop_index, corner: k, .. } => {
            (corner(*loop_index, *k), "give the spike a width, or remove its tip")
        }
        PolygonError::Touching { loop_index, corner: k, .. } => {
            (corner(*loop_index, *k), "move the corner away from the edge; each edge may meet only its two neighbours")
        }
        PolygonError::NoCurve { edge, .. } | PolygonError::OwnCrossing { edge, .. } => {
            (corner(edge.loop_index, edge.corner), "correct the curve of this edge")
        }
        PolygonError::Crossing { first, second, .. } if first.loop_index != second.loop_index => {
            (corner(second.loop_index, second.corner), "move the hole away from the edge, or make it smaller")
        }
        PolygonError::Crossing { second, .. } => (
            corner(second.loop_index, second.corner),
            "list the corners in the order in which the boundary visits them",
        ),
        PolygonError::HoleOutside { loop_index, .. } => {
            (corners(*loop_index), "move the hole into the body, or remove it")
        }
        PolygonError::HoleInHole { loop_index, .. } => {
            (corners(*loop_index), "remove the inner one: it is empty already")
        }
        _ => (corners(first), "correct the corners"),
    };
    ReadError::new(DataErrorKind::Geometry, place, error.to_string(), help)
}

/// Young's modulus, Poisson's ratio and the plane assumption of a table.
pub(super) fn material(fields: &Fields<'_>, context: &Context<'_>, young: f64) -> Result<Material, ReadError> {
    material_with(fields, context, young, None)
}

/// The same where cells have Poisson's ratios of their own, of this mean.
pub(super) fn material_with(
    fields: &Fields<'_>,
    context: &Context<'_>,
    young: f64,
    of_cells: Option<f64>,
) -> Result<Material, ReadError> {
    let plane = match fields.get("plane") {
        Some(plane) => plane.choice(&PLANES)?,
        None => Plane::Strain,
    };
    let poisson = match (of_cells, fields.get("poisson")) {
        (Some(ratio), None) => {
            let refused = |e: MaterialError| {
                let place = fields.require("cells", "cells = { .. }").map(|field| field.item.place).unwrap_or_default();
                ReadError::new(DataErrorKind::Value, place, e.to_string(), "give ratios above -1 and below 0.5")
            };
            return Material::new(young, ratio, plane).map_err(refused);
        }
        (Some(_), Some(poisson)) => {
            let message = format!("{} stands beside material.cells.poisson", poisson.name);
            let help = "the cells give Poisson's ratio: remove one of the two";
            return Err(ReadError::new(DataErrorKind::Conflict, poisson.item.place, message, help));
        }
        (None, _) => fields.require("poisson", "poisson = 0.3")?,
    };
    Material::new(young, poisson.constant(context)?, plane).map_err(|e| match e {
        MaterialError::Young { .. } => {
            let field = fields.get("young").unwrap_or(Field { name: String::new(), item: poisson.item });
            field.problem(e.to_string(), "give a positive number in the scene's unit of stress")
        }
        _ => poisson.problem(e.to_string(), "give a number above -1 and below 0.5, such as 0.3 for steel"),
    })
}

/// `[body_force]`.
pub(super) fn body_force(field: &Field<'_>, context: &Context<'_>) -> Result<[Expression; 2], ReadError> {
    let value = Fields::new(field, &keys::BODY_FORCE)?.require("value", "value = [\"0\", \"-9.81\"]")?;
    force(&value, context)
}

/// The two components of a force per area.
pub(super) fn force(value: &Field<'_>, context: &Context<'_>) -> Result<[Expression; 2], ReadError> {
    let [x, y] = value.components()?;
    let expressions = [x.expression_inside(context)?, y.expression_inside(context)?];
    for (expression, field) in expressions.iter().zip([x, y]) {
        if let Some(number) = expression.constant().filter(|v| !v.is_finite()) {
            let message = format!("{} is {number}: {:?}", field.name, expression.text());
            return Err(field.problem(message, "it must be finite"));
        }
    }
    Ok(expressions)
}

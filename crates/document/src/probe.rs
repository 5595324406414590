//! `[probe]`: points, lines and sides at which results are wanted.

use steklov_bem_operators::{Location, Polygon};
use steklov_problem::{DataErrorKind, ProbeLine, Problem};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::{Field, Fields};
use super::keys;
use super::tree::suggestion;

/// Default number of points of a line.
pub(super) const POINTS: usize = 101;

/// The points, lines and sides of the table.
#[derive(Default)]
pub(super) struct Probes {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) lines: Vec<ProbeLine>,
    pub(super) sides: Vec<usize>,
}

/// Reads the table.
pub(super) fn probe(field: &Field<'_>, problem: &Problem) -> Result<Probes, ReadError> {
    let fields = Fields::new(field, &keys::PROBE)?;
    let (lines, sides) = (fields.get("lines"), fields.get("sides"));
    let of_points = match fields.get("points") {
        None if lines.is_some() || sides.is_some() => None,
        _ => Some(fields.require("points", "points = [[x, y], ...]")?),
    };
    Ok(Probes {
        points: of_points.map_or(Ok(Vec::new()), |f| points(&f, &problem.outline, problem.tie().is_some()))?,
        lines: lines.map_or(Ok(Vec::new()), |f| f.list()?.iter().map(|line| self::line(line, problem)).collect())?,
        sides: sides.map_or(Ok(Vec::new()), |f| self::sides(&f, problem))?,
    })
}

/// Points of the body or of its boundary; `around`: also of the plane around it.
fn points(points: &Field<'_>, polygon: &Polygon, around: bool) -> Result<Vec<[f64; 2]>, ReadError> {
    let mut list = Vec::new();
    for field in points.list()? {
        let [x, y] = field.point()?;
        if polygon.contains([x, y]) == Location::Outside && !(around && polygon.is_around([x, y])) {
            let message =
                format!("the probe point ({x}, {y}) is not in the body{}", if around { " or around it" } else { "" });
            return Err(field.problem(message, "move it into the body or onto its boundary, or remove it"));
        }
        list.push([x, y]);
    }
    Ok(list)
}

fn line(field: &Field<'_>, problem: &Problem) -> Result<ProbeLine, ReadError> {
    let fields = Fields::new(field, &keys::PROBE_LINE)?;
    let end = |key: &str| fields.require(key, &format!("{key} = [x, y]"))?.point();
    let points = fields.get("points").map_or(Ok(POINTS), |f| f.whole(keys::LINE_POINTS))?;
    let line = ProbeLine { from: end("from")?, to: end("to")?, points };
    line.check(problem).map_err(|(message, help)| field.problem(message, help))?;
    Ok(line)
}

fn sides(field: &Field<'_>, problem: &Problem) -> Result<Vec<usize>, ReadError> {
    let mut list = Vec::new();
    for field in field.list()? {
        let (name, side) = (field.text()?, side(&field, problem)?);
        if list.contains(&side) {
            let message = format!("the side {name:?} is named twice");
            return Err(ReadError::new(DataErrorKind::Conflict, field.item.place, message, "name it once"));
        }
        list.push(side);
    }
    Ok(list)
}

/// The number of the side that is named.
pub(super) fn side(field: &Field<'_>, problem: &Problem) -> Result<usize, ReadError> {
    let name = field.text()?;
    problem.side(name).ok_or_else(|| {
        let names = problem.sides.iter().map(|side| side.name.as_str());
        let message = format!("there is no side {name:?}");
        ReadError::new(Kind::UnknownKey, field.item.place, message, suggestion(name, names))
    })
}

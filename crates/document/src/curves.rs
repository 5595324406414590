//! Curved edges of a loop: `arcs`, `curves`, `fillet`, and whole loops by `circle` and `ellipse`.

use std::f64::consts::{PI, TAU};

use steklov_bem_operators::{Loop, Path};
use steklov_elastic::plane::{self, angle, cross, distance, minus, norm};
use steklov_problem::DataErrorKind;

use super::error::ReadError;
use super::fields::{Field, Fields};
use super::form::Table;
use super::keys;
use super::tree::Value;

/// Smallest number of elements on a circle or an ellipse.
const QUARTERS: usize = 4;
/// A corner may be off its circle or ellipse by this part of the radius.
const ON_CURVE: f64 = 1e-9;
/// An arc with a smaller bulge is a line.
const FLAT: f64 = 1e-9;

/// The loop of `circle` or `ellipse` with its `side`, if there is one.
pub(super) fn whole_loop(fields: &Fields<'_>) -> Result<Option<Loop>, ReadError> {
    let (circle, ellipse) = (fields.get("circle"), fields.get("ellipse"));
    let Some(field) = circle.as_ref().or(ellipse.as_ref()) else { return Ok(None) };
    for key in ["corners", "sides", "arcs", "curves", "fillet"] {
        if let Some(other) = fields.get(key) {
            let message = format!("{} is given beside {}", other.name, field.name);
            return Err(ReadError::new(
                DataErrorKind::Conflict,
                other.item.place,
                message,
                "a loop has corners or is a circle or an ellipse",
            ));
        }
    }
    if circle.is_some() && ellipse.is_some() {
        return Err(field.problem("a circle and an ellipse are given for one loop", "remove one of them"));
    }
    let side = fields.require("side", "side = \"name\", the name of the whole loop")?.text()?.to_owned();
    let of = Fields::new(field, if circle.is_some() { &keys::CIRCLE } else { &keys::ELLIPSE })?;
    let centre = of.require("centre", "centre = [x, y]")?.point()?;
    if circle.is_some() {
        let radius = positive(&of.require("radius", "radius = 1.0")?)?;
        return Ok(Some(Loop::circle(centre, radius, QUARTERS, &side)));
    }
    let radii = half_axes(&of.require("radii", "radii = [a, b]")?)?;
    let angle = of.get("angle").map_or(Ok(0.0), |angle| finite(&angle))?.to_radians();
    Ok(Some(Loop::ellipse(centre, radii, angle, QUARTERS, &side)))
}

fn finite(field: &Field<'_>) -> Result<f64, ReadError> {
    field.number_in(&keys::FINITE)
}

fn positive(field: &Field<'_>) -> Result<f64, ReadError> {
    field.number_in(&keys::POSITIVE)
}

fn half_axes(field: &Field<'_>) -> Result<[f64; 2], ReadError> {
    let radii = field.point()?;
    match radii.iter().all(|r| *r > 0.0 && r.is_finite()) {
        true => Ok(radii),
        false => {
            Err(field.problem(format!("the half axes are {} and {}", radii[0], radii[1]), "both must be positive"))
        }
    }
}

/// The paths of `arcs` and `curves` of a loop with these corners and sides, counter-clockwise or not.
pub(super) fn paths(fields: &Fields<'_>, listed: &Loop) -> Result<Vec<Path>, ReadError> {
    let mut paths = vec![Path::Line; listed.corners.len()];
    let mut given = vec![false; paths.len()];
    let corners = &listed.corners;
    let area: f64 =
        (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()])).map(|(a, b)| cross(a, b)).sum();
    for key in ["arcs", "curves"] {
        let Some(field) = fields.get(key) else { continue };
        let table = if key == "arcs" { &keys::ARC } else { &keys::CURVE };
        for (edge, entry) in entries(&field, table, listed)? {
            let of = Fields::new(&entry, table)?;
            if std::mem::replace(&mut given[edge], true) {
                let message = format!("edge {edge} is given two curves");
                return Err(entry.problem(message, "remove one of them"));
            }
            let ends = [corners[edge], corners[(edge + 1) % corners.len()]];
            paths[edge] = match key {
                "arcs" => arc(&entry, &of, ends, area)?,
                _ => cubic(&of)?,
            };
        }
    }
    Ok(if given.contains(&true) { paths } else { Vec::new() })
}

/// Edges and their tables: by the name of a side or the number of an edge, or a list with `edge`.
fn entries<'a>(field: &Field<'a>, table: &'static Table, listed: &Loop) -> Result<Vec<(usize, Field<'a>)>, ReadError> {
    let count = listed.corners.len();
    let numbered = |number: usize, at: &Field<'_>| match number < count {
        true => Ok(number),
        false => Err(at.problem(format!("there is no edge {number}"), format!("the edges are 0 to {}", count - 1))),
    };
    if let Value::Array(_) = field.item.value {
        let entry = |entry: Field<'a>| {
            let of = Fields::new(&entry, table)?;
            let edge = of.require("edge", "edge = 0, the number of the edge")?;
            Ok((numbered(edge.whole(keys::NATURAL)?, &edge)?, entry))
        };
        return field.list()?.into_iter().map(entry).collect();
    }
    let mut found = Vec::new();
    for (key, place, entry) in Fields::open(field)?.all() {
        let named: Vec<usize> = (0..count).filter(|&k| listed.sides.get(k).is_some_and(|s| s == key)).collect();
        let edge = match (named.as_slice(), key.parse::<usize>()) {
            ([edge], _) => *edge,
            ([], Ok(number)) => numbered(number, &entry)?,
            ([], Err(_)) => {
                let message = format!("{} names no side of this loop", entry.name);
                let help = format!("the sides are {}", listed.sides.join(", "));
                return Err(ReadError::new(DataErrorKind::Value, place, message, help));
            }
            (several, _) => {
                let message = format!("the side {key:?} has {} edges", several.len());
                let help = format!(
                    "name the edge by its number: {}",
                    several.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
                );
                return Err(ReadError::new(DataErrorKind::Value, place, message, help));
            }
        };
        found.push((edge, entry));
    }
    Ok(found)
}

/// The arc of a table between two corners of a loop with this signed area; of two half circles, the one that bulges out
/// of the loop.
fn arc(entry: &Field<'_>, of: &Fields<'_>, [a, b]: [[f64; 2]; 2], area: f64) -> Result<Path, ReadError> {
    let large = of.get("large").map_or(Ok(false), |f| f.flag())?;
    let given: Vec<&str> =
        ["bulge", "centre", "radius", "through"].into_iter().filter(|k| of.get(k).is_some()).collect();
    let [which] = given[..] else {
        let message =
            format!("{} has {}", entry.name, if given.is_empty() { "no shape".into() } else { given.join(" and ") });
        return Err(entry.problem(message, "give one of bulge, centre, radius and through"));
    };
    let field = of.require(which, "bulge = 1.0")?;
    let chord = distance(a, b);
    let opening = match which {
        "bulge" => 4.0 * finite(&field)?.atan(),
        "through" => opening_through(&field, a, b)?,
        "radius" => {
            let radius = field.number_where(
                |r| r != 0.0 && r.is_finite(),
                "finite and not 0: positive counter-clockwise, negative clockwise",
            )?;
            if radius.abs() < chord / 2.0 {
                let message = format!("the radius {radius} is less than half the chord of its edge, {}", chord / 2.0);
                return Err(field.problem(message, "take a larger radius, or move the corners together"));
            }
            let small = 2.0 * (chord / 2.0 / radius.abs()).min(1.0).asin();
            radius.signum() * if large { TAU - small } else { small }
        }
        _ => {
            if let Some(radii) = of.get("radii") {
                return elliptic(of, &field, &radii, [a, b], area, large);
            }
            let c = field.point()?;
            let (ra, rb) = (distance(a, c), distance(b, c));
            if !((ra - rb).abs() <= ON_CURVE * ra.max(rb) && ra > 0.0) {
                let message = format!(
                    "the centre ({}, {}) is {ra} from one corner of the edge and {rb} from the other",
                    c[0], c[1]
                );
                return Err(field.problem(message, "both must be the radius: move the centre or a corner"));
            }
            about(angle(minus(a, c), minus(b, c)), area, large)
        }
    };
    Ok(if (opening / 4.0).tan().abs() < FLAT { Path::Line } else { Path::Arc { opening } })
}

/// The angle from one direction to another, or its complement if `large`; a half turn goes out of the loop.
fn about(angle: f64, area: f64, large: bool) -> f64 {
    if angle.abs() > PI - 1e-9 {
        return PI.copysign(area);
    }
    if large { angle - TAU.copysign(angle) } else { angle }
}

/// The angle of an arc through a point: the inscribed angle is half of the angle of the rest of the circle.
fn opening_through(field: &Field<'_>, a: [f64; 2], b: [f64; 2]) -> Result<f64, ReadError> {
    let p = field.point()?;
    let angle = angle(minus(a, p), minus(b, p));
    if !angle.is_finite() || distance(a, p).min(distance(b, p)) <= ON_CURVE * distance(a, b) || angle.abs() < 1e-9 {
        let message =
            format!("no arc goes through ({}, {}): it is a corner of the edge, or on its line beyond them", p[0], p[1]);
        return Err(field.problem(message, "give a point between the corners, beside the chord"));
    }
    // p to the right of the chord: counter-clockwise
    Ok(2.0 * (PI - angle.abs()).copysign(-angle))
}

fn elliptic(
    of: &Fields<'_>,
    centre: &Field<'_>,
    radii: &Field<'_>,
    [a, b]: [[f64; 2]; 2],
    area: f64,
    large: bool,
) -> Result<Path, ReadError> {
    let (c, [p, q]) = (centre.point()?, half_axes(radii)?);
    let angle = of.get("angle").map_or(Ok(0.0), |angle| finite(&angle))?.to_radians();
    let (sin, cos) = angle.sin_cos();
    // in units of the half axes
    let circle = |x: [f64; 2]| {
        let r = minus(x, c);
        [(cos * r[0] + sin * r[1]) / p, (cos * r[1] - sin * r[0]) / q]
    };
    let [u, v] = [circle(a), circle(b)];
    for (x, u) in [(a, u), (b, v)] {
        let size = norm(u);
        if size.is_nan() || (size - 1.0).abs() > ON_CURVE {
            let message =
                format!("the corner ({}, {}) is not on the ellipse: {size} of the way from its centre", x[0], x[1]);
            return Err(radii.problem(message, "both corners must lie on it: correct radii, centre or angle"));
        }
    }
    let opening = about(plane::angle(u, v), area, large);
    Ok(Path::Ellipse { radii: [p, q], angle, start: u[1].atan2(u[0]), opening })
}

fn cubic(of: &Fields<'_>) -> Result<Path, ReadError> {
    let field = of.require("control", "control = [[x, y], [x, y]]")?;
    let [first, second] = field.pair("one for each control point")?;
    Ok(Path::Cubic { control: [first.point()?, second.point()?] })
}

/// Rounds corners by arcs tangent to both edges: `fillet = { CORNER = radius }`. Returns for each new corner the number
/// of the listed corner from which it comes.
pub(super) fn fillet(fields: &Fields<'_>, listed: Loop) -> Result<(Loop, Vec<usize>), ReadError> {
    let count = listed.corners.len();
    let Some(field) = fields.get("fillet") else { return Ok((listed, (0..count).collect())) };
    let mut radius: Vec<Option<(f64, Field<'_>)>> = (0..count).map(|_| None).collect();
    for (key, place, value) in Fields::open(&field)?.all() {
        let Some(corner) = key.parse::<usize>().ok().filter(|k| *k < count) else {
            let message = format!("{} names no corner", value.name);
            return Err(ReadError::new(
                DataErrorKind::Value,
                place,
                message,
                format!("the corners are 0 to {}", count - 1),
            ));
        };
        let path = |k: usize| listed.path(k % count);
        if path(corner) != Path::Line || path(corner + count - 1) != Path::Line {
            let message = format!("an edge at corner {corner} is curved");
            return Err(value.problem(message, "a fillet joins two straight edges: write the arc with `arcs`"));
        }
        radius[corner] = Some((positive(&value)?, value));
    }
    // the length cut off both edges, and the angle by which the boundary turns
    let cut = |k: usize| -> (f64, f64) {
        let at = |k: usize| listed.corners[k % count];
        let (a, b, c) = (at(k + count - 1), at(k), at(k + 1));
        let turn = angle(minus(b, a), minus(c, b));
        (radius[k].as_ref().map_or(0.0, |(r, _)| r * (turn / 2.0).tan().abs()), turn)
    };
    let cuts: Vec<(f64, f64)> = (0..count).map(cut).collect();
    for (k, radius) in radius.iter().enumerate() {
        let Some((radius, value)) = radius else { continue };
        for (edge, other) in [(k, (k + 1) % count), ((k + count - 1) % count, (k + count - 1) % count)] {
            let length = distance(listed.corners[edge], listed.corners[(edge + 1) % count]);
            let needed = cuts[k].0 + cuts[other].0;
            if needed.is_nan() || needed >= length * (1.0 - 1e-9) {
                let message = format!(
                    "the fillet of radius {radius} at corner {k} needs {needed} of edge {edge}, which is {length} long"
                );
                return Err(value.problem(message, "take a smaller radius"));
            }
        }
        if cuts[k].1.abs() < 1e-6 {
            return Err(value.problem(format!("the boundary does not turn at corner {k}"), "there is nothing to round"));
        }
    }
    let (mut rounded, mut origin) = (Loop { corners: vec![], sides: vec![], paths: vec![] }, Vec::new());
    for k in 0..count {
        let mut push = |corner: [f64; 2], side: String, path: Path| {
            rounded.corners.push(corner);
            rounded.sides.push(side);
            rounded.paths.push(path);
            origin.push(k);
        };
        let side = listed.sides[k].clone();
        let (b, before, behind) =
            (listed.corners[k], listed.corners[(k + count - 1) % count], listed.corners[(k + 1) % count]);
        let (length, turn) = cuts[k];
        if radius[k].is_none() {
            push(b, side, listed.path(k));
            continue;
        }
        let towards = |x: [f64; 2]| {
            let d = distance(b, x);
            [b[0] + (x[0] - b[0]) * length / d, b[1] + (x[1] - b[1]) * length / d]
        };
        let previous = &listed.sides[(k + count - 1) % count];
        let own = if *previous == side { side.clone() } else { format!("fillet-{k}") };
        push(towards(before), own, Path::Arc { opening: turn });
        push(towards(behind), side, Path::Line);
    }
    Ok((rounded, origin))
}

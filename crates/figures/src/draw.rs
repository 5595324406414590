//! The pictures and tables of a stored result.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use steklov_elastic::plane::{cross, distance, dot, minus, norm};
use steklov_fields::body_part;
use steklov_io::vtkhdf::Field;
use steklov_model::solve::contact_rows::ContactRow;
use steklov_picture::{Body, ContactSide, Obstacle, Picture, PictureError, body, contact, in_unit, replace, write};
use steklov_problem::Units;
use steklov_result::record::Record;

use crate::grid;
use crate::probe;
use crate::stochastic;
use crate::view::{Scalar, Unit, View};

/// Draws the deformed body, each contact side, the probes along lines and sides, and the pictures of a grid or of
/// random input into a folder, and writes the tables of lines and sides; returns the files.
///
/// # Errors
/// When a file cannot be drawn or written.
pub fn pictures(stored: &Record, view: &View, folder: &Path, name: &str) -> Result<Vec<PathBuf>, PictureError> {
    let mut files = Vec::new();
    for (part, picture) in drawn(stored, view)? {
        files.extend(write(folder, &format!("{name}-{part}"), &picture)?);
    }
    for (table, text) in probe::tables(stored) {
        let saved = save_table(folder, &format!("{name}-{table}"), &text);
        files.push(saved.map_err(|source| PictureError::Write { path: folder.to_owned(), source })?);
    }
    Ok(files)
}

/// Writes a table into an existing folder.
fn save_table(folder: &Path, name: &str, text: &str) -> std::io::Result<PathBuf> {
    let path = folder.join(format!("{name}.csv"));
    replace(folder, &path, text.as_bytes())?;
    Ok(path)
}

/// The same pictures with the parts of their names: `body`, `medium`, `contact-SIDE`, `probe-line-K`,
/// `probe-side-SIDE`, and the names of pictures of a grid and of random input.
///
/// # Errors
/// When one cannot be drawn.
pub fn drawn(stored: &Record, view: &View) -> Result<Vec<(String, Picture)>, PictureError> {
    let mut all = vec![("body".to_owned(), body_picture(stored, view)?)];
    all.extend(grid::medium(stored, view)?.map(|picture| ("medium".to_owned(), picture)));
    let (title, sides) = (&stored.summary.title, &stored.mesh.side_names);
    let of_sides = contact_drawn(title, &stored.summary.units, sides, &stored.contact)?;
    all.extend(of_sides.into_iter().map(|(side, picture)| (format!("contact-{side}"), picture)));
    all.extend(probe::pictures(stored)?);
    let others = grid::pictures(stored, view)?.into_iter().chain(stochastic::pictures(stored, view)?);
    all.extend(others);
    Ok(all)
}

/// Draws each contact side, into files that begin with `name`.
///
/// # Errors
/// When a picture cannot be drawn or written.
pub fn contact_pictures(
    title: &str,
    units: &Units,
    side_names: &[String],
    rows: &[ContactRow],
    folder: &Path,
    name: &str,
) -> Result<Vec<PathBuf>, PictureError> {
    let mut files = Vec::new();
    for (side, picture) in contact_drawn(title, units, side_names, rows)? {
        files.extend(write(folder, &format!("{name}-{side}"), &picture)?);
    }
    Ok(files)
}

/// Pictures of contact sides with the parts of their file names.
fn contact_drawn(
    title: &str,
    units: &Units,
    side_names: &[String],
    rows: &[ContactRow],
) -> Result<Vec<(String, Picture)>, PictureError> {
    let mut all = Vec::new();
    for (side, side_name) in side_names.iter().enumerate() {
        let rows: Vec<&ContactRow> = rows.iter().filter(|r| r.side == side).collect();
        if !rows.is_empty() {
            all.push((side_file(side_names, side), contact_picture(title, units, side_name, &rows)?));
        }
    }
    Ok(all)
}

/// The name of a side as a part of a file name, different for each side.
pub fn side_file(side_names: &[impl AsRef<str>], side: usize) -> String {
    let part = file_name(side_names[side].as_ref());
    if side_names[..side].iter().any(|other| file_name(other.as_ref()) == part) {
        format!("{part}-{side}")
    } else {
        part
    }
}

/// A name as a part of a file name.
pub(crate) fn file_name(side: &str) -> String {
    side.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

fn body_picture(stored: &Record, view: &View) -> Result<Picture, PictureError> {
    let fields = &stored.grid;
    let field = |name: &str| fields.point_data.iter().find(|f| f.name == name);
    let planar = |f: &Field| -> Vec<[f64; 2]> { f.values.chunks(f.components.max(1)).map(|v| [v[0], v[1]]).collect() };
    let n = fields.points.len();
    let displacement = field("displacement").filter(|f| f.components == 3).map_or(vec![[0.0; 2]; n], planar);
    let [lines, gaps] = obstacles(stored);
    let obstacles: Vec<Obstacle<'_>> = lines.iter().zip(&gaps).map(|(points, gap)| Obstacle { points, gap }).collect();
    let (title, obstacles) = (stored.summary.title.as_str(), obstacles.as_slice());
    let largest = largest_displacement(stored);
    let most = stored.largest_factor();
    let infinite = infinite(stored, view.scalar);
    let (label, noun) = (view.scalar.label(), view.scalar.noun());
    let units = units(stored, view.scalar);
    if let Some(record) = &stored.on_grid {
        let deformed = grid::deformed(stored, record, &displacement, view.scalar);
        return body(&Body {
            title,
            points: &deformed.points,
            displacement: &deformed.displacement,
            largest,
            triangles: &deformed.triangles,
            values: &deformed.values,
            infinite,
            label,
            noun,
            colours: view.colours(),
            outline: &deformed.outline,
            obstacles,
            window: view.window,
            most,
            enlarge: view.enlarge,
            units,
        });
    }
    let stress = field("stress").filter(|f| f.components == 3);
    let stress = stress.map_or(vec![[f64::NAN; 3]; n], |f| f.values.as_chunks().0.to_vec());
    let von_mises = field("von_mises").map_or(vec![f64::NAN; n], |f| f.values.clone());
    let (count, triangles) = body_part(fields);
    let value = |i: usize| view.scalar.of(displacement[i], stress[i], von_mises[i]);
    let values: Vec<f64> = (0..count).map(value).collect();
    body(&Body {
        title,
        points: &fields.points[..count],
        displacement: &displacement[..count],
        largest,
        triangles,
        values: &values,
        infinite,
        label,
        noun,
        colours: view.colours(),
        outline: &fields.lines,
        obstacles,
        window: view.window,
        most,
        enlarge: view.enlarge,
        units,
    })
}

/// The points at which a scalar is infinite.
pub(crate) fn infinite(stored: &Record, scalar: Scalar) -> &[[f64; 2]] {
    match scalar.unit() {
        Unit::Length => &[],
        Unit::Stress => &stored.summary.infinite_stress,
    }
}

/// The names of the units of lengths and of a scalar.
pub(crate) fn units(stored: &Record, scalar: Scalar) -> [Option<&str>; 2] {
    let Units { length, stress } = &stored.summary.units;
    let of_scalar = match scalar.unit() {
        Unit::Length => length,
        Unit::Stress => stress,
    };
    [length, of_scalar].map(|name| name.as_deref())
}

/// Points x of contact sides and gap vectors g n, one list of each for each stretch: a rigid obstacle is the line
/// through x + g n. Other bodies are no obstacles.
pub fn obstacles(stored: &Record) -> [Lines; 2] {
    let joined: Vec<&String> = stored.summary.interfaces.iter().flat_map(|i| &i.sides[0]).collect();
    let is_wall = |row: &&ContactRow| !joined.contains(&&stored.mesh.side_names[row.side]);
    let of_walls: Vec<ContactRow> = stored.contact.iter().filter(is_wall).copied().collect();
    walls(&of_walls)
}

/// The largest displacement of the nodes, which are denser than the drawn points where it matters.
pub(crate) fn largest_displacement(stored: &Record) -> f64 {
    stored.displacement.iter().map(|u| norm(*u)).fold(0.0, f64::max)
}

/// A list of points or vectors for each of some lines.
type Lines = Vec<Vec<[f64; 2]>>;

/// Points and gap vectors of the obstacles, one list for each stretch of contact side.
pub(crate) fn walls(rows: &[ContactRow]) -> [Lines; 2] {
    let stretches = stretches(rows);
    let on_stretches = |f: fn(&ContactRow) -> [f64; 2]| -> Vec<Vec<[f64; 2]>> {
        stretches.iter().map(|rows| rows.iter().map(f).collect()).collect()
    };
    [on_stretches(|r| r.point), on_stretches(|r| r.normal.map(|n| r.gap * n))]
}

/// The contact table cut where the side or the normal changes.
fn stretches(rows: &[ContactRow]) -> Vec<Vec<ContactRow>> {
    let mut stretches: Vec<Vec<ContactRow>> = Vec::new();
    for row in rows {
        let continues = stretches.last().and_then(|s| s.last()).is_some_and(|last| {
            let along = minus(row.point, last.point);
            let ahead = cross(last.normal, along);
            // equal up to rounding in the elements of an oblique side
            let turn = distance(last.normal, row.normal);
            turn < 1e-9 && last.side == row.side && ahead > 0.0
        });
        match stretches.last_mut() {
            Some(last) if continues => last.push(*row),
            _ => stretches.push(vec![*row]),
        }
    }
    stretches
}

/// The axis label and the positions of a side: x or y for a straight horizontal or vertical side, else its arc length.
pub fn positions(side: &str, rows: &[&ContactRow]) -> (String, Vec<f64>) {
    let same =
        |i: usize| rows.iter().all(|r| (r.point[i] - rows[0].point[i]).abs() < 1e-12 * r.point[i].abs().max(1.0));
    if same(1) {
        ("x".into(), rows.iter().map(|r| r.point[0]).collect())
    } else if same(0) {
        ("y".into(), rows.iter().map(|r| r.point[1]).collect())
    } else {
        let mut length = 0.0;
        let mut last = rows[0].point;
        let arc = rows.iter().map(|r| {
            length += distance(r.point, last);
            last = r.point;
            length
        });
        (format!("arc length along {side}"), arc.collect())
    }
}

/// If a closed side touches where its arc length begins, the part behind the middle of the longest open stretch gets
/// negative arc lengths, so that the contact is in one piece.
fn unroll(rows: &[&ContactRow], position: &mut [f64]) {
    let n = rows.len();
    let steps = rows.windows(2).map(|w| distance(w[0].point, w[1].point));
    let closing = distance(rows[n - 1].point, rows[0].point);
    let touches = |i: usize| rows[i % n].pressure > 0.0;
    // the ends meet, and normals turn around
    let turns = rows.iter().any(|r| dot(r.normal, rows[0].normal) < 0.0);
    let is_closed = turns && closing <= 2.0 * steps.fold(0.0, f64::max);
    if !is_closed || !(touches(0) || touches(n - 1)) {
        return;
    }
    // no open stretch crosses the end
    let mut longest = (0, 0);
    let mut start = 0;
    for i in 0..n {
        if touches(i) {
            start = i + 1;
        } else if i + 1 - start > longest.1 {
            longest = (start, i + 1 - start);
        }
    }
    let total = position[n - 1] + closing;
    if longest.1 > 0 {
        position[longest.0 + longest.1 / 2..].iter_mut().for_each(|s| *s -= total);
    }
}

fn contact_picture(title: &str, units: &Units, side: &str, rows: &[&ContactRow]) -> Result<Picture, PictureError> {
    let (label, mut position) = positions(side, rows);
    unroll(rows, &mut position);
    let breaks = breaks(rows, &position);
    let collect = |f: fn(&ContactRow) -> f64| {
        rows.iter().map(|r| f(r)).chain(breaks.iter().map(|_| f64::NAN)).collect::<Vec<f64>>()
    };
    position.extend(&breaks);
    let bound = if rows.iter().any(|r| r.bound > 0.0) { collect(|r| r.bound) } else { Vec::new() };
    contact(&ContactSide {
        title: &format!("{title}: contact on {side}"),
        x_label: &in_unit(&label, units.length.as_deref()),
        stress: units.stress.as_deref(),
        position: &position,
        pressure: &collect(|r| r.pressure),
        shear: &collect(|r| r.shear),
        bound: &bound,
    })
}

/// If the distance of two neighbours exceeds their weights times this, the side faces nothing between them.
const APART: f64 = 3.0;

/// Positions at which a side faces nothing, between stretches that face other bodies.
fn breaks(rows: &[&ContactRow], position: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&i, &j| position[i].total_cmp(&position[j]));
    let between = |pair: &[usize]| {
        let [a, b] = [pair[0], pair[1]];
        let apart = position[b] - position[a] > APART * (rows[a].weight + rows[b].weight);
        apart.then_some((position[a] + position[b]) / 2.0)
    };
    order.windows(2).filter_map(between).collect()
}

/// Writes the tables of a result as CSV files into a folder; returns them.
///
/// # Errors
/// When a file cannot be written.
pub fn tables(stored: &Record, folder: &Path, name: &str) -> std::io::Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)?;
    let mut files = Vec::new();
    let mut save = |table: &str, text: String| -> std::io::Result<()> {
        files.push(save_table(folder, &format!("{name}-{table}"), &text)?);
        Ok(())
    };
    save("displacement", pairs("x,y,ux,uy", &stored.points, &stored.displacement))?;
    save("traction", pairs("x,y,tx,ty", &stored.traction_points, &tractions(stored)))?;
    if !stored.contact.is_empty() {
        let mut text = String::from("side,x,y,gap,u_n,u_t,pressure,shear,bound,weight,status\n");
        for r in &stored.contact {
            let side = stored.mesh.side_names[r.side].replace('"', "\"\"");
            let [x, y] = r.point;
            let numbers =
                [x, y, r.gap, r.normal_displacement, r.tangential_displacement, r.pressure, r.shear, r.bound, r.weight];
            let _ = write!(text, "\"{side}\"");
            for v in numbers {
                let _ = write!(text, ",{v:?}");
            }
            let _ = writeln!(text, ",{}", r.status);
        }
        save("contact", text)?;
    }
    for (table, text) in probe::tables(stored) {
        save(&table, text)?;
    }
    for (table, text) in grid::tables(stored).into_iter().chain(stochastic::tables(stored)) {
        save(table, text)?;
    }
    Ok(files)
}

/// Tractions on the boundary: the prescribed ones if there are any, because the polynomials of the solution may be far
/// from them beside a held side.
fn tractions(stored: &Record) -> Vec<[f64; 2]> {
    let told = |(given, t): (&[f64; 2], &[f64; 2])| [0, 1].map(|i| if given[i].is_nan() { t[i] } else { given[i] });
    stored.prescribed.iter().zip(&stored.traction).map(told).collect()
}

fn pairs(head: &str, points: &[[f64; 2]], values: &[[f64; 2]]) -> String {
    let mut text = format!("{head}\n");
    for (x, u) in points.iter().zip(values) {
        let _ = writeln!(text, "{:?},{:?},{:?},{:?}", x[0], x[1], u[0], u[1]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of a circle of radius 1, beginning at the angle 0; a node touches if `touches` holds for its angle.
    fn circle(touches: impl Fn(f64) -> bool) -> Vec<ContactRow> {
        let angles = (0..72).map(|k| f64::from(k) * std::f64::consts::TAU / 72.0);
        let row = |angle: f64| ContactRow {
            point: [angle.cos(), angle.sin()],
            normal: [angle.cos(), angle.sin()],
            gap: 0.0,
            normal_displacement: 0.0,
            tangential_displacement: 0.0,
            pressure: if touches(angle) { 1.0 } else { 0.0 },
            shear: 0.0,
            bound: 0.0,
            weight: 0.0,
            status: 0,
            side: 0,
        };
        angles.map(row).collect()
    }

    /// Length of the shortest interval of positions that contains all touching nodes.
    fn extent(rows: &[ContactRow]) -> f64 {
        let rows: Vec<&ContactRow> = rows.iter().collect();
        let (_, mut position) = positions("rim", &rows);
        unroll(&rows, &mut position);
        let touching = || position.iter().zip(&rows).filter(|(_, r)| r.pressure > 0.0).map(|(s, _)| *s);
        touching().fold(f64::NEG_INFINITY, f64::max) - touching().fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_contact_over_the_begin_of_a_closed_side_is_in_one_piece() {
        let over = extent(&circle(|angle| !(0.51..5.8).contains(&angle)));
        assert!((over - 0.95).abs() < 0.1, "{over}");
        let away = extent(&circle(|angle| (1.0..2.0).contains(&angle)));
        assert!((away - 0.95).abs() < 0.1, "{away}");
        // a half circle is not closed
        let half: Vec<ContactRow> = circle(|angle| !(0.5..2.6).contains(&angle)).into_iter().take(37).collect();
        assert!(extent(&half) > 3.0);
    }
}

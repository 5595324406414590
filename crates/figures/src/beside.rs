//! Curves of two results in the same panels.

use steklov_model::solve::contact_rows::ContactRow;
use steklov_model::summary::{LinePoint, LineProbe};
use steklov_picture::{Ends, Layer, Panel, Picture, PictureError, Shape, in_unit, panels};
use steklov_result::record::Record;

use crate::draw::{positions, side_file};

/// Pictures of two results beside each other, with the parts of their file names: pressure and shear along each side that is in contact
/// in both, and von Mises stress and displacement along each line that both have.
///
/// # Errors
/// When one cannot be drawn.
pub fn beside(first: &Record, second: &Record, names: [&str; 2]) -> Result<Vec<(String, Picture)>, PictureError> {
    let mut all = Vec::new();
    let sides = &first.mesh.side_names;
    for (side, name) in sides.iter().enumerate() {
        let Some(other) = second.mesh.side_names.iter().position(|own| own == name) else { continue };
        let rows = [rows(first, side), rows(second, other)];
        if rows.iter().all(|rows| !rows.is_empty()) {
            let title = format!("{name}: {} and {}", names[0], names[1]);
            all.push((
                format!("contact-{}", side_file(sides, side)),
                panels(&title, &contact(first, name, &rows, names))?,
            ));
        }
    }
    let lines = first.summary.probe_lines.iter().enumerate();
    for (k, line) in lines {
        if let Some(other) = second.summary.probe_lines.iter().find(|own| [own.from, own.to] == [line.from, line.to]) {
            let ([a, b], [c, d]) = (line.from, line.to);
            let title = format!("({a}, {b}) to ({c}, {d}): {} and {}", names[0], names[1]);
            all.push((format!("probe-line-{k}"), panels(&title, &along(first, [line, other], names))?));
        }
    }
    Ok(all)
}

fn rows(record: &Record, side: usize) -> Vec<&ContactRow> {
    record.contact.iter().filter(|row| row.side == side).collect()
}

/// A panel with a curve of each result.
fn panel(x: &str, y: String, curves: [Vec<[f64; 2]>; 2], names: [&str; 2]) -> Panel {
    let layer = |(k, curve): (usize, Vec<[f64; 2]>)| Layer { name: names[k].to_owned(), shape: Shape::Curve(curve, k) };
    let layers = curves.into_iter().enumerate().map(layer).collect();
    Panel { x: x.to_owned(), y, ends: Ends::Zero, layers }
}

fn contact(record: &Record, side: &str, rows: &[Vec<&ContactRow>; 2], names: [&str; 2]) -> Vec<Panel> {
    let units = &record.summary.units;
    let places = [0, 1].map(|k| positions(side, &rows[k]));
    let x = in_unit(&places[0].0, units.length.as_deref());
    let curves = |value: fn(&ContactRow) -> f64| {
        [0, 1].map(|k| places[k].1.iter().zip(&rows[k]).map(|(x, row)| [*x, value(row)]).collect::<Vec<_>>())
    };
    let pressure = panel(&x, in_unit("pressure", units.stress.as_deref()), curves(|row| row.pressure), names);
    let has_shear = rows.iter().flatten().any(|row| row.shear != 0.0);
    let shear = || panel(&x, in_unit("shear", units.stress.as_deref()), curves(|row| row.shear), names);
    std::iter::once(pressure).chain(has_shear.then(shear)).collect()
}

fn along(record: &Record, lines: [&LineProbe; 2], names: [&str; 2]) -> Vec<Panel> {
    let units = &record.summary.units;
    let x = in_unit("distance from the first point", units.length.as_deref());
    let curves = |value: fn(&LinePoint) -> f64| {
        lines.map(|line| line.points.iter().map(|p| [p.s, value(p)]).collect::<Vec<_>>())
    };
    vec![
        panel(&x, in_unit("von Mises stress", units.stress.as_deref()), curves(|p| p.von_mises), names),
        panel(&x, in_unit("displacement ux", units.length.as_deref()), curves(|p| p.displacement[0]), names),
        panel(&x, in_unit("displacement uy", units.length.as_deref()), curves(|p| p.displacement[1]), names),
    ]
}

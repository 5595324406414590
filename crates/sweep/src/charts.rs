//! Charts of the quantities of a sweep over its first numeric key.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::Value;
use steklov_picture::{Ends, Layer, Panel, Shape, panels, write};

use crate::sweep::plain;
use crate::{Quantities, Sweep, SweepError};

/// Quantities that are drawn, by the beginnings of their paths; the others are measures of the work and its checks.
const DRAWN: [&str; 13] = [
    "energy",
    "contact.",
    "interfaces.",
    "reactions.",
    "probe.",
    "pressure.",
    "mean_displacement.",
    "moment.",
    "weighted_force.",
    "opening.",
    "stochastic.",
    "friction_work",
    "estimate_relative",
];

/// Most panels of a picture, and lines of a panel.
const PANELS: usize = 6;
const LINES: usize = 8;

/// Draws every quantity that differs from point to point over the first varied key that has numbers, with a line for each combination
/// of the others, of which the title tells if not all are drawn; the band around J is how far its exact value may be. Returns the files; none if no key has two numbers.
///
/// # Errors
/// [`SweepError::Picture`].
pub fn charts(sweep: &Sweep, folder: &Path, name: &str) -> Result<Vec<PathBuf>, SweepError> {
    let points = &sweep.points;
    let is_axis = |key: &usize| {
        let mut numbers = (0..points.len()).map(|point| points.number(point, *key));
        let first = numbers.next().unwrap_or(f64::NAN);
        first.is_finite() && numbers.any(|v| v.is_finite() && v != first)
    };
    let Some(key) = (0..points.keys().len()).find(is_axis) else { return Ok(Vec::new()) };
    let all = lines(sweep, key);
    let lines = &all[..all.len().min(LINES)];
    let title = match all.len() > LINES {
        true => format!("{}: the first {LINES} of {} lines", sweep.title, all.len()),
        false => sweep.title.clone(),
    };
    let (objects, quantities) = (sweep.objects(), sweep.quantities());
    let mut groups: BTreeMap<&str, Vec<Panel>> = BTreeMap::new();
    for path in quantities.paths.iter().filter(|path| DRAWN.iter().any(|of| path.starts_with(of))) {
        let Some(column) = quantities.column(path) else { continue };
        let is_energy = path == "energy";
        if !differs(&quantities, path) || !is_energy && path.starts_with("energy") {
            continue;
        }
        let mut layers = Vec::new();
        for (number, (label, line)) in lines.iter().enumerate() {
            let at = |point: &usize| points.number(*point, key);
            if is_energy {
                let bar = |point: &usize| bar(objects[*point].as_ref()?).map(|[low, high]| [at(point), low, high]);
                let name = if number == 0 { "J, exact" } else { "" };
                layers.push(Layer {
                    name: name.to_owned(),
                    shape: Shape::Between(line.iter().filter_map(bar).collect()),
                });
            }
            let curve = line.iter().map(|point| [at(point), column[*point]]).collect();
            layers.push(Layer { name: label.clone(), shape: Shape::Curve(curve, number) });
        }
        let panel = Panel { x: points.keys()[key].clone(), y: path.clone(), ends: Ends::Values, layers };
        groups.entry(path.split('.').next().unwrap_or(path)).or_default().push(panel);
    }
    let mut files = Vec::new();
    for (group, list) in groups {
        let count = list.len().div_ceil(PANELS);
        for (k, some) in list.chunks(PANELS).enumerate() {
            let suffix = if count > 1 { format!("-{}", k + 1) } else { String::new() };
            let picture = panels(&title, some)?;
            files.extend(write(folder, &format!("{name}-{group}{suffix}"), &picture)?);
        }
    }
    Ok(files)
}

/// What differs by less than this part of the size of a vector is rounding.
const ROUNDING: f64 = 1e-9;

/// Whether a quantity differs from point to point by more than rounding; of components, by that of the largest one.
fn differs(quantities: &Quantities, path: &str) -> bool {
    let known = |path: &str| quantities.column(path).unwrap_or_default().into_iter().filter(|v| v.is_finite());
    let component = ["x", "y", "xx", "yy", "xy"];
    let parent = path.rsplit_once('.').filter(|(_, last)| component.contains(last)).map(|(parent, _)| parent);
    let parts = component.map(|last| parent.map_or(path.to_owned(), |parent| format!("{parent}.{last}")));
    let size = parts.iter().flat_map(|path| known(path)).fold(0.0, |size: f64, v| size.max(v.abs()));
    let [low, high] = known(path).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
    high - low > ROUNDING * size
}

/// Where the exact J lies.
fn bar(object: &Value) -> Option<[f64; 2]> {
    let (centre, radius) = (object["energy_extrapolated"].as_f64()?, object["energy_uncertainty"].as_f64()?);
    Some([centre - radius, centre + radius])
}

/// The points in the order of a key, a list for each combination of the values of the others, under their names.
fn lines(sweep: &Sweep, key: usize) -> Vec<(String, Vec<usize>)> {
    let points = &sweep.points;
    let mut lines: Vec<(String, Vec<usize>)> = Vec::new();
    for point in (0..points.len()).filter(|point| points.number(*point, key).is_finite()) {
        let other = |k: &usize| *k != key;
        let name = |k: usize| {
            format!("{} = {}", points.keys()[k].rsplit('.').next().unwrap_or_default(), plain(points.value(point, k)))
        };
        let label = (0..points.keys().len()).filter(other).map(name).collect::<Vec<_>>().join(", ");
        match lines.iter_mut().find(|(own, _)| *own == label) {
            Some((_, line)) => line.push(point),
            None => lines.push((label, vec![point])),
        }
    }
    for (_, line) in &mut lines {
        line.sort_by(|a, b| points.number(*a, key).total_cmp(&points.number(*b, key)));
    }
    lines
}

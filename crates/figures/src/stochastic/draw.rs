//! Pictures of the statistics: the spread of the body, contact, densities, effects of germs, the stochastic mesh.

use steklov_bem_operators::Space;
use steklov_model::solve::contact_rows::ContactRow;
use steklov_model::stochastic::{Level, Quantity, StochasticResult};
use steklov_picture::{
    BarGroup, DegreeBox, Ends, Layer, Obstacle, Panel, Picture, PictureError, Shape, Spread, SpreadLoop, bars, boxes,
    in_unit, panels, short, spread,
};
use steklov_result::record::Record;

use super::draw_fields;
use super::tables::{is_constant, percent};
use crate::draw::{positions, walls};
use crate::view::View;

/// Largest number of panels in one picture.
const PANELS: usize = 6;
/// Largest number of germs with bars: the germs with the greatest effects.
const GERMS: usize = 12;
/// Largest number of cells of a stochastic mesh that is drawn, and of its drawn points.
const CELLS: usize = 4_000;
/// Most quantities whose variances are drawn over the levels.
const MOST_CURVES: usize = 6;

/// The pictures of a result with random input, with the ends of their names; none without random input. The spread of
/// the body is drawn in the window and at the factor of the view.
///
/// # Errors
/// When a picture cannot be drawn.
pub fn pictures(stored: &Record, view: &View) -> Result<Vec<(String, Picture)>, PictureError> {
    let Some(result) = &stored.stochastic else { return Ok(Vec::new()) };
    let title = &stored.summary.title;
    let mut pictures = Vec::new();
    // a family of grids has no fields
    if result.levels.is_empty() {
        pictures.push(("band".to_owned(), band(stored, result, view)?));
    }
    let mut add = |part: &str, what: &str, all: &[Panel]| -> Result<(), PictureError> {
        for (k, some) in all.chunks(PANELS).enumerate() {
            let name = if k == 0 { part.to_owned() } else { format!("{part}-{}", k + 1) };
            pictures.push((name, panels(&format!("{title}: {what}"), some)?));
        }
        Ok(())
    };
    if !result.levels.is_empty() {
        add("levels", "levels of grids", &levels(result))?;
    }
    let (probability, pressure) = contact(stored, result);
    add("probability", "probability of contact", &probability)?;
    add("pressure", "pressure of all outcomes", &pressure)?;
    let densities: Vec<Panel> =
        result.quantities.iter().filter_map(|q| density(stored, q, &result.probabilities)).collect();
    add("density", "densities of the quantities", &densities)?;
    let cells = result.cells.as_ref().zip(result.quantities.first());
    if let Some((cells, first)) = cells.filter(|_| result.labels.len() == 1) {
        let ends = cells.low.iter().chain(&cells.high).map(|c| c[0]).filter(|v| v.is_finite()).collect();
        let all = [over_germ(&result.labels[0], first, &result.points, ends)];
        add("stochastic-mesh", "stochastic mesh", &all)?;
    }
    if let [x, y] = &result.labels[..] {
        let drawn = mesh(result);
        if !drawn.is_empty() {
            let points: Vec<[f64; 2]> = result.points.iter().take(CELLS).map(|p| [p[0], p[1]]).collect();
            let picture = boxes(&format!("{title}: stochastic mesh"), [x.as_str(), y.as_str()], &drawn, &points)?;
            pictures.push(("stochastic-mesh".to_owned(), picture));
        }
    }
    if let Some(picture) = effects(title, result)? {
        pictures.push(("effects".to_owned(), picture));
    }
    pictures.extend(draw_fields::pictures(stored, result)?);
    Ok(pictures)
}

fn band(stored: &Record, result: &StochasticResult, view: &View) -> Result<Picture, PictureError> {
    let space = Space::new(&stored.mesh);
    let (mean, variance) = (&result.displacement.mean, &result.displacement.variance);
    let mut seen = vec![false; stored.mesh.len()];
    let mut loops = Vec::new();
    for first in 0..stored.mesh.len() {
        let mut nodes = Vec::new();
        let mut e = first;
        while !std::mem::replace(&mut seen[e], true) {
            nodes.extend(space.offset[e]..space.offset[e + 1]);
            e = stored.mesh.next[e];
        }
        if !nodes.is_empty() {
            loops.push(SpreadLoop {
                points: nodes.iter().map(|&i| stored.points[i]).collect(),
                mean: nodes.iter().map(|&i| [mean[2 * i], mean[2 * i + 1]]).collect(),
                covariance: nodes
                    .iter()
                    .map(|&i| [variance[2 * i], variance[2 * i + 1], covariance(result, i)])
                    .collect(),
            });
        }
    }
    let [lines, gaps] = walls(&stored.contact);
    let obstacles: Vec<Obstacle<'_>> = lines.iter().zip(&gaps).map(|(points, gap)| Obstacle { points, gap }).collect();
    spread(&Spread {
        title: &format!("{}: mean and spread", stored.summary.title),
        loops: &loops,
        obstacles: &obstacles,
        window: view.window,
        enlarge: view.enlarge,
        unit: stored.summary.units.length.as_deref(),
    })
}

/// Covariance of u_x and u_y of a node; zero if the displacements of the points are not kept.
fn covariance(result: &StochasticResult, node: usize) -> f64 {
    let (x, y) = (2 * node, 2 * node + 1);
    let mean = &result.displacement.mean;
    let product = |(w, u): (&f64, &Vec<f64>)| w * (u[x] - mean[x]) * (u[y] - mean[y]);
    let sum: f64 = result.weights.iter().zip(&result.displacements).map(product).sum();
    // a sparse grid has negative weights
    let bound = (result.displacement.variance[x] * result.displacement.variance[y]).max(0.0).sqrt();
    sum.clamp(-bound, bound)
}

/// Panels of multilevel Monte Carlo: of each level the variances of the differences, as parts of those of the values, and the
/// outcomes.
fn levels(result: &StochasticResult) -> Vec<Panel> {
    let over = |value: &dyn Fn(&Level) -> f64| -> Vec<[f64; 2]> {
        result.levels.iter().enumerate().map(|(l, level)| [(l + 1) as f64, value(level)]).collect()
    };
    let varying = result.quantities.iter().enumerate().filter(|(_, q)| q.variance > 0.0);
    let variance = |(color, (k, q)): (usize, (usize, &Quantity))| Layer {
        name: q.name.clone(),
        shape: Shape::Curve(over(&|level| level.variances[k] / q.variance), color),
    };
    let grids: Vec<String> = result.levels.iter().map(|l| format!("{} × {}", l.cells[0], l.cells[1])).collect();
    let x = format!("level: {} cells", grids.join(", "));
    let outcomes = Shape::Curve(over(&|level| level.outcomes as f64), 0);
    let panel = |y: &str, layers| Panel { x: x.clone(), y: y.to_owned(), ends: Ends::Log, layers };
    vec![
        panel("part of the variance", varying.enumerate().take(MOST_CURVES).map(variance).collect()),
        panel("outcomes", vec![Layer { name: "outcomes of each level".to_owned(), shape: outcomes }]),
    ]
}

/// Panels of each contact side: the probability of contact, and the pressure.
fn contact(stored: &Record, result: &StochasticResult) -> (Vec<Panel>, Vec<Panel>) {
    let (mut probability, mut pressure) = (Vec::new(), Vec::new());
    let units = &stored.summary.units;
    if !result.levels.is_empty() {
        return (probability, pressure);
    }
    for (side, name) in stored.mesh.side_names.iter().enumerate() {
        let rows: Vec<(usize, &ContactRow)> = stored.contact.iter().enumerate().filter(|r| r.1.side == side).collect();
        if rows.is_empty() {
            continue;
        }
        let (label, position) = positions(name, &rows.iter().map(|r| r.1).collect::<Vec<_>>());
        let mut order: Vec<(f64, usize)> = position.into_iter().zip(rows.iter().map(|r| r.0)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let curve = |value: &dyn Fn(usize) -> f64| order.iter().map(|&(x, i)| [x, value(i)]).collect::<Vec<_>>();
        let x = if label.starts_with("arc") { label } else { format!("{label} on {name}") };
        let x = in_unit(&x, units.length.as_deref());
        let layer = |name: &str, shape: Shape| Layer { name: name.to_owned(), shape };
        let mut known = curve(&|i| result.probability[i]);
        known.retain(|p| p[1].is_finite());
        if !known.is_empty() {
            probability.push(Panel {
                x: x.clone(),
                y: "probability".to_owned(),
                ends: Ends::Unit,
                layers: vec![layer("probability of contact", Shape::Curve(known, 0))],
            });
        }
        let moments = &result.pressure;
        let two = |i: usize| 2.0 * moments.variance[i].max(0.0).sqrt();
        let between = order.iter().map(|&(x, i)| {
            let mean = moments.mean[i];
            [x, (mean - two(i)).max(0.0), (mean + two(i)).max(0.0)]
        });
        pressure.push(Panel {
            x,
            y: in_unit("pressure", units.stress.as_deref()),
            ends: Ends::Zero,
            layers: vec![
                layer("mean ± 2 deviations, cut at 0", Shape::Between(between.collect())),
                layer("mean", Shape::Curve(curve(&|i| moments.mean[i]), 0)),
                layer("pressure of the mean input", Shape::Curve(curve(&|i| stored.contact[i].pressure), 1)),
            ],
        });
    }
    (probability, pressure)
}

/// Density of a quantity with its mean and its quantiles, or its value if the spread is only rounding; none for a
/// sparse grid.
fn density(stored: &Record, quantity: &Quantity, probabilities: &[f64]) -> Option<Panel> {
    if is_constant(stored, quantity) {
        let name = format!("constant {}", short(quantity.mean, 4));
        let layers = vec![Layer { name, shape: Shape::Across(vec![quantity.mean], 0) }];
        return Some(Panel { x: quantity.name.clone(), y: "density".to_owned(), ends: Ends::Zero, layers });
    }
    let density = quantity.density.as_ref()?;
    let bars = density.edges.windows(2).zip(&density.density).map(|(e, d)| [e[0], e[1], *d]).collect();
    let mut layers = vec![
        Layer { name: "density".to_owned(), shape: Shape::Bars(bars) },
        Layer { name: format!("mean {}", short(quantity.mean, 4)), shape: Shape::Across(vec![quantity.mean], 0) },
    ];
    if let Some(quantiles) = &quantity.quantiles {
        let parts: Vec<String> = probabilities.iter().map(|p| format!("{} %", percent(*p))).collect();
        let name = format!("quantiles {}", parts.join(", "));
        layers.push(Layer { name, shape: Shape::Across(quantiles.clone(), 1) });
    }
    Some(Panel { x: quantity.name.clone(), y: "density".to_owned(), ends: Ends::Zero, layers })
}

/// A quantity over the only germ, with the ends of the cells.
fn over_germ(label: &str, quantity: &Quantity, points: &[Vec<f64>], ends: Vec<f64>) -> Panel {
    let mut values: Vec<[f64; 2]> = points.iter().zip(&quantity.values).map(|(p, v)| [p[0], *v]).collect();
    values.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Panel {
        x: label.to_owned(),
        y: quantity.name.clone(),
        ends: Ends::Values,
        layers: vec![
            Layer { name: "ends of cells".to_owned(), shape: Shape::Across(ends, 1) },
            Layer { name: "value at the points".to_owned(), shape: Shape::Points(values, 0) },
        ],
    }
}

/// The cells of two germs; cells of unbounded germs end a little beyond the points.
fn mesh(result: &StochasticResult) -> Vec<DegreeBox> {
    let Some(cells) = result.cells.as_ref().filter(|c| c.low.len() <= CELLS) else { return Vec::new() };
    let range = |d: usize| {
        let values = result.points.iter().map(|p| p[d]);
        let ends = cells.low.iter().chain(&cells.high).map(|c| c[d]).filter(|v| v.is_finite());
        let start = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = values.chain(ends).fold(start, |[l, h], v| [l.min(v), h.max(v)]);
        let margin = 0.05 * (high - low);
        [low - margin, high + margin]
    };
    let ranges = [range(0), range(1)];
    let inside = |d: usize, v: f64| if v.is_finite() { v } else { v.clamp(ranges[d][0], ranges[d][1]) };
    let corner = |c: &[f64]| [inside(0, c[0]), inside(1, c[1])];
    let ends = cells.low.iter().zip(&cells.high);
    ends.zip(&cells.degree)
        .map(|((low, high), degree)| DegreeBox { corners: [corner(low), corner(high)], degree: [degree[0], degree[1]] })
        .collect()
}

/// Total effects of the germs on each quantity; none with a single germ or without effects.
fn effects(title: &str, result: &StochasticResult) -> Result<Option<Picture>, PictureError> {
    let with: Vec<(&Quantity, &Vec<f64>)> =
        result.quantities.iter().filter_map(|q| Some((q, q.effects.as_ref()?))).collect();
    if result.labels.len() < 2 || with.is_empty() {
        return Ok(None);
    }
    let greatest = |d: usize| with.iter().map(|(_, e)| e[d]).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..result.labels.len()).collect();
    order.sort_by(|a, b| greatest(*b).total_cmp(&greatest(*a)));
    let mut title = format!("{title}: which germs matter");
    if let Some(next) = order.get(GERMS) {
        title += &format!(" ({} more have effects of at most {:.1e})", order.len() - GERMS, greatest(*next));
        order.truncate(GERMS);
    }
    order.sort_unstable();
    let rows: Vec<String> = order.iter().map(|&d| result.labels[d].clone()).collect();
    let groups: Vec<BarGroup> = with
        .iter()
        .take(2 * PANELS)
        .map(|(q, effects)| BarGroup { caption: q.name.clone(), values: order.iter().map(|&d| effects[d]).collect() })
        .collect();
    Ok(Some(bars(&title, "total effect, share of the variance", &rows, &groups)?))
}

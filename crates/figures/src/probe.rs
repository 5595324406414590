//! Charts and tables of results along lines and sides.

use std::fmt::Write as _;

use steklov_model::summary::{LinePoint, LineProbe, SidePoint, SideProbe};
use steklov_picture::{Ends, Layer, Panel, Picture, PictureError, Shape, in_unit, panels};
use steklov_problem::Units;
use steklov_result::record::Record;

use crate::draw::side_file;

/// A curve: its name, and its value at a point.
type Curve<T> = (&'static str, fn(&T) -> f64);

/// Part of the length around a point of infinite stress on which no stress is drawn, because all other values would
/// look like zero beside it.
const NEAR: f64 = 0.01;

/// A point of a line or side.
trait Along {
    /// Length up to the point.
    fn s(&self) -> f64;
    /// Whether stresses are infinite at the point.
    fn is_unbounded(&self) -> bool;
    /// Whether curves continue to the next point.
    fn joins(&self, next: &Self) -> bool;
}

impl Along for LinePoint {
    fn s(&self) -> f64 {
        self.s
    }

    fn is_unbounded(&self) -> bool {
        self.stress_unbounded
    }

    fn joins(&self, next: &Self) -> bool {
        self.body == next.body
    }
}

impl Along for SidePoint {
    fn s(&self) -> f64 {
        self.s
    }

    fn is_unbounded(&self) -> bool {
        self.stress_unbounded
    }

    fn joins(&self, next: &Self) -> bool {
        self.piece == next.piece
    }
}

const ALONG_LINE: [&[Curve<LinePoint>]; 2] = [
    &[("von Mises", |p| p.von_mises), ("σxx", |p| p.stress[0]), ("σyy", |p| p.stress[1]), ("σxy", |p| p.stress[2])],
    &[("ux", |p| p.displacement[0]), ("uy", |p| p.displacement[1])],
];
const ALONG_SIDE: [&[Curve<SidePoint>]; 2] = [
    &[
        ("von Mises", |p| p.von_mises),
        ("hoop, along the side", |p| p.hoop_stress),
        ("normal traction", |p| p.normal_traction),
        ("tangential traction", |p| p.tangential_traction),
    ],
    &[("normal", |p| p.normal_displacement), ("tangential", |p| p.tangential_displacement)],
];

/// A chart of each line and side that the scene names: `probe-line-1`, `probe-side-NAME`.
///
/// # Errors
/// A chart that cannot be drawn.
pub(crate) fn pictures(stored: &Record) -> Result<Vec<(String, Picture)>, PictureError> {
    let (title, units) = (&stored.summary.title, &stored.summary.units);
    let mut all = Vec::new();
    for (k, line) in (1..).zip(&stored.summary.probe_lines) {
        let ([x, y], [u, v]) = (line.from, line.to);
        let x_label = format!("distance from ({x}, {y})");
        let title = format!("{title}: line {k} from ({x}, {y}) to ({u}, {v})");
        all.push((format!("probe-line-{k}"), chart(title, &line.points, ALONG_LINE, &x_label, units)?));
    }
    for (name, side) in of_sides(stored) {
        let x_label = format!("arc length along {}", side.side);
        let title = format!("{title}: along {}", side.side);
        all.push((name, chart(title, &side.points, ALONG_SIDE, &x_label, units)?));
    }
    Ok(all)
}

/// The sides, each with the part of the name of its files.
fn of_sides(stored: &Record) -> impl Iterator<Item = (String, &SideProbe)> {
    let sides = &stored.summary.probe_sides;
    let names: Vec<&str> = sides.iter().map(|side| side.side.as_str()).collect();
    let named = move |(k, side)| (format!("probe-side-{}", side_file(&names, k)), side);
    sides.iter().enumerate().map(named)
}

/// A panel of stresses and one of displacements over s.
fn chart<T: Along>(
    mut title: String,
    points: &[T],
    [stresses, displacements]: [&[Curve<T>]; 2],
    x_label: &str,
    units: &Units,
) -> Result<Picture, PictureError> {
    let infinite: Vec<f64> = points.iter().filter(|p| p.is_unbounded()).map(Along::s).collect();
    let near = NEAR * points.last().map_or(0.0, Along::s);
    let is_near = |s: f64| infinite.iter().any(|at| (s - at).abs() < near);
    if !infinite.is_empty() {
        title += ", stresses without 1 % of the length about points where they are infinite";
    }
    let panel = |name: &str, unit: &Option<String>, curves: &[Curve<T>], is_left_out: &dyn Fn(f64) -> bool| {
        let line = |value: fn(&T) -> f64| {
            let mut line = Vec::new();
            for (k, point) in points.iter().enumerate() {
                if k > 0 && !points[k - 1].joins(point) {
                    line.push([point.s(), f64::NAN]);
                }
                line.push([point.s(), if is_left_out(point.s()) { f64::NAN } else { value(point) }]);
            }
            line
        };
        let curves = curves.iter().enumerate();
        Panel {
            x: in_unit(x_label, units.length.as_deref()),
            y: in_unit(name, unit.as_deref()),
            ends: Ends::Zero,
            layers: curves
                .map(|(k, (name, value))| Layer { name: (*name).to_owned(), shape: Shape::Curve(line(*value), k) })
                .collect(),
        }
    };
    let of_stresses = panel("stress", &units.stress, stresses, &is_near);
    panels(&title, &[of_stresses, panel("displacement", &units.length, displacements, &|_| false)])
}

/// A table of each line and side that the scene names, with the same parts of names as in [`pictures`]; cells without a
/// number are empty.
pub(crate) fn tables(stored: &Record) -> Vec<(String, String)> {
    let lines = (1..).zip(&stored.summary.probe_lines).map(|(k, line)| (format!("probe-line-{k}"), line_table(line)));
    lines.chain(of_sides(stored).map(|(name, side)| (name, side_table(side)))).collect()
}

fn line_table(line: &LineProbe) -> String {
    let has_names = line.points.iter().any(|p| p.body.is_some());
    let mut text =
        format!("{}s,x,y,ux,uy,sigma_xx,sigma_yy,sigma_xy,von_mises\n", if has_names { "body," } else { "" });
    for p in &line.points {
        if has_names {
            let _ = write!(text, "{},", p.body.as_deref().map_or_else(String::new, quoted));
        }
        let ([x, y], [u, v], [xx, yy, xy]) = (p.point, p.displacement, p.stress);
        row(&mut text, &[p.s, x, y, u, v, xx, yy, xy, p.von_mises]);
    }
    text
}

fn side_table(side: &SideProbe) -> String {
    let mut text = String::from(
        "side,piece,s,x,y,nx,ny,ux,uy,u_n,u_t,traction_n,traction_t,hoop,sigma_xx,sigma_yy,sigma_xy,von_mises\n",
    );
    for p in &side.points {
        let _ = write!(text, "{},{},", quoted(&side.side), p.piece);
        let ([x, y], [nx, ny], [u, v], [xx, yy, xy]) = (p.point, p.normal, p.displacement, p.stress);
        let displacements = [p.normal_displacement, p.tangential_displacement];
        let tractions = [p.normal_traction, p.tangential_traction];
        let all =
            [&[p.s, x, y, nx, ny, u, v], &displacements[..], &tractions, &[p.hoop_stress, xx, yy, xy, p.von_mises]];
        row(&mut text, &all.concat());
    }
    text
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

fn row(text: &mut String, values: &[f64]) {
    let cell = |value: &f64| if value.is_finite() { format!("{value:?}") } else { String::new() };
    let _ = writeln!(text, "{}", values.iter().map(cell).collect::<Vec<_>>().join(","));
}

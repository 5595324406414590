//! Charts of several runs in one figure.

use serde_json::Value;
use steklov_picture::{Axis, Band, Chart, Curve, Guide, Picture, Scale, Series, chart};

use crate::figure::number;

/// A line: its name, and the points of each quantity.
pub(crate) struct Line {
    pub name: String,
    pub curves: Vec<Vec<[f64; 2]>>,
}

/// The content of a chart.
pub(crate) struct Drawing<'a> {
    pub title: &'a str,
    pub x: (&'a str, Scale),
    pub y: (&'a str, Scale),
    pub quantities: &'a [&'a str],
    pub lines: Vec<Line>,
    pub guides: &'a [Guide<'a>],
    pub band: Option<Band<'a>>,
}

impl Drawing<'_> {
    pub(crate) fn draw(&self) -> Result<Picture, String> {
        let curves: Vec<Vec<Curve<'_>>> = self
            .lines
            .iter()
            .map(|line| line.curves.iter().map(|points| Curve { points, flagged: &[] }).collect())
            .collect();
        let series: Vec<Series<'_>> =
            self.lines.iter().zip(&curves).map(|(line, curves)| Series { name: &line.name, curves }).collect();
        let axis = |(label, scale)| Axis { label, scale };
        chart(&Chart {
            title: self.title,
            x: axis(self.x),
            y: axis(self.y),
            quantities: self.quantities,
            series: &series,
            flag: "",
            guides: self.guides,
            band: self.band,
        })
        .map_err(|e| e.to_string())
    }
}

/// A quantity over another one, for those objects of a list in which both are known.
pub(crate) fn points(objects: &[Value], x: &str, y: &str) -> Vec<[f64; 2]> {
    let all = objects.iter().map(|object| [number(object, x), number(object, y)]);
    all.filter(|point| point.iter().all(|v| v.is_finite())).collect()
}

/// The value of a quantity at the point nearest to x.
pub(crate) fn at(points: &[[f64; 2]], x: f64) -> f64 {
    let nearest = points.iter().min_by(|a, b| (a[0] - x).abs().total_cmp(&(b[0] - x).abs()));
    nearest.map_or(f64::NAN, |point| point[1])
}

/// The slope of ln y over ln x by least squares.
pub(crate) fn slope(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let n = logs.len() as f64;
    let mean = [0, 1].map(|k| logs.iter().map(|p| p[k]).sum::<f64>() / n);
    let sum = |f: &dyn Fn(&[f64; 2]) -> f64| logs.iter().map(f).sum::<f64>();
    sum(&|p| (p[0] - mean[0]) * (p[1] - mean[1])) / sum(&|p| (p[0] - mean[0]).powi(2))
}

/// The smallest and the largest finite value.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

//! `/solution/probe`: results at points, along lines and along sides.

use steklov_io::{
    Group, IoError, create_group, label, save_dense, save_integers, save_points, save_texts, save_vector,
};
use steklov_model::summary::{LinePoint, LineProbe, Probe, SidePoint, SideProbe, Summary};

use crate::store::unused_name;

const POINT: &[&str] = &["point", "component"];
const STRESS: &str = "sigma_xx, sigma_yy, sigma_xy; NaN where they are infinite";

/// A column of numbers: name, unit, meaning, value.
type Column<T> = (&'static str, &'static str, &'static str, fn(&T) -> f64);

const ALONG_SIDE: [Column<SidePoint>; 7] = [
    ("s", "length", "length of the side up to the point, the body to the left", |p| p.s),
    ("normal_displacement", "length", "u.n", |p| p.normal_displacement),
    ("tangential_displacement", "length", "u.t, t the normal turned by +90 degrees", |p| p.tangential_displacement),
    ("normal_traction", "stress", "n.sigma n, negative in compression", |p| p.normal_traction),
    ("tangential_traction", "stress", "t.sigma n", |p| p.tangential_traction),
    ("hoop_stress", "stress", "t.sigma t", |p| p.hoop_stress),
    ("von_mises", "stress", "von Mises stress", |p| p.von_mises),
];

/// Writes the probes of a scene; nothing if it has none.
pub(crate) fn save(at: &Group, summary: &Summary) -> Result<(), IoError> {
    let Summary { probe, probe_lines, probe_sides, .. } = summary;
    if probe.is_empty() && probe_lines.is_empty() && probe_sides.is_empty() {
        return Ok(());
    }
    let at = create_group(at, "probe")?;
    if !probe.is_empty() {
        save_at_points(&at, probe)?;
    }
    if !probe_lines.is_empty() {
        let lines = create_group(&at, "lines")?;
        for (k, line) in (1..).zip(probe_lines) {
            save_line(&create_group(&lines, &k.to_string())?, line)?;
        }
    }
    if !probe_sides.is_empty() {
        let sides = create_group(&at, "sides")?;
        for side in probe_sides {
            save_side(&create_group(&sides, &unused_name(&sides, &side.side))?, side)?;
        }
    }
    Ok(())
}

fn save_at_points(at: &Group, probes: &[Probe]) -> Result<(), IoError> {
    let collect = |f: fn(&Probe) -> [f64; 2]| probes.iter().map(f).collect::<Vec<_>>();
    save_points(at, "points", &collect(|p| p.point), &label("length", "probe points", POINT))?;
    save_points(at, "displacement", &collect(|p| p.displacement), &label("length", "displacement", POINT))?;
    save_stress(at, probes.len(), |i| probes[i].stress, STRESS)
}

fn save_line(at: &Group, line: &LineProbe) -> Result<(), IoError> {
    let points = &line.points;
    let collect = |f: fn(&LinePoint) -> [f64; 2]| points.iter().map(f).collect::<Vec<_>>();
    let along = |f: fn(&LinePoint) -> f64| points.iter().map(f).collect::<Vec<_>>();
    let distance = label("length", "distance from the first point", &["point"]);
    save_vector(at, "s", &along(|p| p.s), &distance)?;
    save_points(at, "points", &collect(|p| p.point), &label("length", "points of the line", POINT))?;
    let displacement = label("length", "displacement; NaN where no body is", POINT);
    save_points(at, "displacement", &collect(|p| p.displacement), &displacement)?;
    let meaning = "sigma_xx, sigma_yy, sigma_xy; NaN where no body is, or where they are infinite";
    save_stress(at, points.len(), |i| points[i].stress, meaning)?;
    save_vector(at, "von_mises", &along(|p| p.von_mises), &label("stress", "von Mises stress", &["point"]))?;
    if points.iter().all(|p| p.body.is_none()) {
        return Ok(());
    }
    let bodies: Vec<String> = points.iter().map(|p| p.body.clone().unwrap_or_default()).collect();
    save_texts(at, "body", &bodies, "the body of each point, none where no body is", "point")
}

fn save_side(at: &Group, side: &SideProbe) -> Result<(), IoError> {
    let points = &side.points;
    let collect = |f: fn(&SidePoint) -> [f64; 2]| points.iter().map(f).collect::<Vec<_>>();
    save_points(at, "points", &collect(|p| p.point), &label("length", "points of the side", POINT))?;
    save_points(at, "normal", &collect(|p| p.normal), &label("1", "normal out of the body", POINT))?;
    save_points(at, "displacement", &collect(|p| p.displacement), &label("length", "displacement", POINT))?;
    save_stress(at, points.len(), |i| points[i].stress, STRESS)?;
    for (name, unit, meaning, value) in ALONG_SIDE {
        let values: Vec<f64> = points.iter().map(value).collect();
        save_vector(at, name, &values, &label(unit, meaning, &["point"]))?;
    }
    let piece: Vec<usize> = points.iter().map(|p| p.piece).collect();
    save_integers(at, "piece", &piece, &label("1", "piece of the side; pieces do not join each other", &["point"]))
}

fn save_stress(at: &Group, count: usize, of: impl Fn(usize) -> [f64; 3], meaning: &str) -> Result<(), IoError> {
    let stress = faer::Mat::from_fn(count, 3, |i, j| of(i)[j]);
    save_dense(at, "stress", stress.as_ref(), &label("stress", meaning, POINT))
}

//! Lines at whose points results are wanted, and what lies at a point.

use steklov_bem_operators::Location;
use steklov_elastic::plane::distance;

use super::Problem;

/// Points of a line at most.
pub const MOST_POINTS: usize = 10_000;

/// Points at equal distances from one point to another, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeLine {
    /// The first point.
    pub from: [f64; 2],
    /// The last one.
    pub to: [f64; 2],
    /// How many points there are, 2 to [`MOST_POINTS`].
    pub points: usize,
}

/// What lies at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// The body, a number of [`Problem::bodies`].
    pub body: usize,
    /// The edge and its parameter, of a point on the boundary of the body.
    pub on: Option<(usize, f64)>,
}

impl ProbeLine {
    /// The points, each with its distance from the first one.
    pub fn places(&self) -> Vec<(f64, [f64; 2])> {
        let Self { from, to, points } = *self;
        let last = points.saturating_sub(1);
        let part = |whole: f64, k: usize| whole * k as f64 / last.max(1) as f64;
        let place = |k: usize| {
            let x = if k == last { to } else { [0, 1].map(|i| from[i] + part(to[i] - from[i], k)) };
            (part(distance(from, to), k), x)
        };
        (0..points).map(place).collect()
    }

    /// Whether the line has a length, a number of points, and one of them at least in a body.
    ///
    /// # Errors
    /// What is wrong, and what to do.
    pub fn check(&self, problem: &Problem) -> Result<(), (String, String)> {
        let Self { from, to, points } = *self;
        let refuse = |message: String, help: &str| Err((message, help.to_owned()));
        if !from.iter().chain(&to).all(|c| c.is_finite()) || !distance(from, to).is_finite() {
            let message = format!("the line runs from ({}, {}) to ({}, {})", from[0], from[1], to[0], to[1]);
            return refuse(message, "write finite coordinates");
        }
        if distance(from, to) <= problem.outline.tolerance() {
            let message = format!("the line from ({}, {}) has no length", from[0], from[1]);
            return refuse(message, "move one of its ends, or name the point in probe.points");
        }
        if !(2..=MOST_POINTS).contains(&points) {
            let message = format!("the line has {points} points");
            return Err((message, format!("it must be a whole number from 2 to {MOST_POINTS}")));
        }
        if !self.places().iter().any(|(_, x)| problem.spot(*x).is_some()) {
            let ([x, y], [u, v]) = (from, to);
            let message = format!("none of the {points} points of the line from ({x}, {y}) to ({u}, {v}) is in a body");
            return refuse(message, "move it into a body, give it more points, or remove it");
        }
        Ok(())
    }
}

impl Problem {
    /// What lies at a point: of bodies that meet there the first one, the medium around the first body where no body is; `None` in
    /// holes and gaps, and beside bounded bodies.
    pub fn spot(&self, x: [f64; 2]) -> Option<Spot> {
        let count = self.outline.bodies().len();
        let of_body = |body: usize| match self.outline.location_in(body, x) {
            Location::Boundary { edge, s } => Some(Spot { body, on: Some((edge, s)) }),
            Location::Inside => Some(Spot { body, on: None }),
            Location::Outside => None,
        };
        let around = || (self.tie().is_some() && self.outline.is_around(x)).then_some(Spot { body: count, on: None });
        (0..count).find_map(of_body).or_else(around)
    }
}

//! Checks the data of every side along its edges before anything is solved.

use steklov_bem_operators::Edge;
use steklov_expression::{Expression, OnEdge, Track};

use super::{Condition, DataError, DataErrorKind as Kind, Problem, Scene, Side, Springs};

/// Number of equal steps along an edge at which data are examined.
const STEPS: usize = 256;
/// Differences across a jump are this part of those ten times as far away, or more; across (s - a)^p they are 10^-p of them.
const JUMPING: f64 = 0.99;
/// Largest gap, in diameters of the body: beyond it the displacements are lost in the rounding errors of the gap.
const GAP: f64 = 1e12;

/// The name of the stiffness of springs.
pub const STIFFNESS: &str = "stiffness of springs";

/// What to do about values that are not finite.
const NOT_FINITE: &str =
    "change the expression so that it is finite everywhere on the side; if(cond, a, b) takes only the branch it needs";

/// A number as text; very large and very small ones with an exponent.
fn short(value: f64) -> String {
    let plain = value == 0.0 || (1e-6..1e9).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

impl Problem {
    /// The expressions of a side of the first body and their names: of its condition, or of its contact.
    pub fn side_data(&self, side: usize) -> Vec<(&'static str, &Expression)> {
        match self.contact(side) {
            Some(contact) => contact.data(),
            None => data(&self.sides[side]),
        }
    }
}

impl Scene {
    /// Looks at every expression of every side in 257 points of each of its edges, at its kinks and beside them, and over the
    /// stretches between them.
    ///
    /// # Errors
    /// A value that is not finite, a negative bound or coefficient of friction, a displacement that jumps: names side,
    /// point and expression.
    pub fn check_data(&self) -> Result<(), DataError> {
        for (index, side) in self.problem.sides.iter().enumerate() {
            for (what, expression) in self.problem.side_data(index) {
                for edge in self.problem.outline.edges().iter().filter(|edge| edge.side == index) {
                    self.check_along(edge, &side.name, what, expression)?;
                }
            }
        }
        Ok(())
    }

    /// Looks at an expression along an edge; its largest absolute value there.
    pub(super) fn check_along(
        &self,
        edge: &Edge,
        side: &str,
        what: &str,
        expression: &Expression,
    ) -> Result<f64, DataError> {
        let path = |s: f64| OnEdge::new(edge, expression).at(s);
        let steps = (0..=STEPS).map(|k| k as f64 / STEPS as f64);
        let along = expression.along(edge);
        let beside = along.kinks.iter().copied().flat_map(|s| [(s - 1e-9).max(0.0), s, (s + 1e-9).min(1.0)]);
        let mut largest: f64 = 0.0;
        for at in steps.chain(beside).map(path) {
            largest = largest.max(self.check_value(side, what, expression, at)?.abs());
        }
        let least = if is_positive(what) { 0.0 } else { f64::NEG_INFINITY };
        if let Some(s) = expression.impossible(edge, least) {
            self.check_value(side, what, expression, path(s))?;
        }
        if what.starts_with("displacement") {
            self.check_continuous(side, expression, largest, edge)?;
        }
        Ok(largest)
    }

    /// A displacement does not jump at its kinks: that would need infinite energy. `largest` is its size.
    fn check_continuous(
        &self,
        side: &str,
        expression: &Expression,
        largest: f64,
        edge: &Edge,
    ) -> Result<(), DataError> {
        let path = |s: f64| OnEdge::new(edge, expression).at(s);
        let value = |s: f64| {
            let (x, y, s) = path(s.clamp(0.0, 1.0));
            expression.eval(x, y, s)
        };
        for t in expression.kinks(OnEdge::two_sided(edge, expression)) {
            let s = (1.0 + t) / 2.0;
            let (before, after) = (value(s - 1e-9), value(s + 1e-9));
            let farther = value(s + 1e-8) - value(s - 1e-8);
            // a power of the distance shrinks with it, if slowly
            if (after - before).abs() > (1e-2 * largest).max(JUMPING * farther.abs()) {
                let (x, y, _) = path(s);
                let message = format!(
                    "the displacement of side {side:?} jumps from {} to {} at the point ({x}, {y}), s = {s}: expression {:?}",
                    short(before),
                    short(after),
                    expression.text()
                );
                let help = "the body does not tear: prescribe a continuous displacement, or use two sides with a free one between them";
                return Err(DataError::new(Kind::Data, expression.place, message, help));
            }
        }
        Ok(())
    }

    /// The value of a side's datum at (x, y, s), if it is possible. `what` names the datum: "traction", "gap",
    /// "friction bound", "friction coefficient", "displacement", "pressure", "stiffness of springs".
    ///
    /// # Errors
    /// A value that is not finite, a negative bound or coefficient of friction or stiffness: names side, point and expression.
    pub fn check_value(
        &self,
        side: &str,
        what: &str,
        expression: &Expression,
        at: (f64, f64, f64),
    ) -> Result<f64, DataError> {
        let (x, y, s) = at;
        let value = expression.eval(x, y, s);
        let negative = value < 0.0 && is_positive(what);
        let huge = what == "gap" && value.abs() > GAP * self.problem.outline.diameter();
        if value.is_finite() && !negative && !huge {
            return Ok(value);
        }
        let message = format!(
            "the {what} of side {side:?} is {} at the point ({x}, {y}), s = {s}: expression {:?}",
            short(value),
            expression.text()
        );
        let beyond = expression.beyond(x, y, s).filter(|_| !value.is_finite()).map(|(name, position, [first, last])| {
            format!(
                "the profile {name} reaches from {first} to {last}, and here it is asked at {position}: add knots, or keep its \
                 argument between them with min and max"
            )
        });
        let help = match what {
            _ if beyond.is_some() => beyond.as_deref().unwrap_or_default(),
            "gap" if value.is_finite() => &format!(
                "it is too large for a body of diameter {}: more than {GAP:e} times that; for a side that nothing can touch \
                 leave the contact out",
                short(self.problem.outline.diameter())
            ),
            "gap" => {
                "a gap is a finite distance at every point; for a side that nothing can touch leave the contact out"
            }
            _ if negative && expression.constant().is_some() && expression.text().contains("tan(") => {
                "friction cannot be negative: tan takes radians, write an angle in degrees as tan(30*pi/180)"
            }
            STIFFNESS if negative => {
                "springs pull back: their stiffness cannot be negative, write max(0, ...), or correct the expression"
            }
            _ if negative => "friction cannot be negative: write max(0, ...), or correct the expression",
            _ => NOT_FINITE,
        };
        Err(DataError::new(Kind::Data, expression.place, message, help))
    }
}

/// Whether a datum is 0 or more.
fn is_positive(what: &str) -> bool {
    what.starts_with("friction") || what == STIFFNESS
}

/// The expressions of a side and their names.
fn data(side: &Side) -> Vec<(&'static str, &Expression)> {
    let mut data = match &side.condition {
        Condition::Free => Vec::new(),
        Condition::Traction(traction) => traction.iter().map(|t| ("traction", t)).collect(),
        Condition::Pressure(pressure) => vec![("pressure", pressure)],
        Condition::Displacement { values, traction } => {
            let values = values.iter().flatten().map(|u| ("displacement", u));
            values.chain(traction.iter().flatten().map(|t| ("traction", t))).collect()
        }
    };
    data.extend(side.springs.iter().flat_map(Springs::stiffnesses).map(|k| (STIFFNESS, k)));
    data
}

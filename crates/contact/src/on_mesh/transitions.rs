//! Where contact ends, where stick ends, where slip turns: read off the states of the nodes, then fitted.

use faer::Mat;
use steklov_algebra::least_squares;

use crate::solvers::frozen::{Frozen, Sets};
use crate::{Condition, ContactError, ContactLine, Problem, Solution};

/// Kind of a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TipKind {
    /// From closed to open.
    ContactEnd,
    /// From stick to slip.
    StickEnd,
    /// From slip along t to slip along -t, with no stick between or a single node of it.
    SlipReversal,
}

/// A change of state between neighbouring conditions of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// Edge parameters between which it lies.
    pub bracket: [f64; 2],
    /// What changes.
    pub kind: TipKind,
    /// 1 if the regular side (open, slipping) has the larger edge parameter, -1 if the smaller one, 0 for a reversal.
    pub regular: i8,
    /// The point of the line at the lower end of the bracket.
    pub point: usize,
}

/// The transitions along a line, rising.
pub fn transitions(line: &ContactLine, sets: &Sets) -> Vec<Transition> {
    let closed = |i: usize| sets.closed(line.points[i].index);
    let slip = |i: usize| sets.slip(line.points[i].index);
    let s = |i: usize| line.points[i].s;
    let count = line.points.len();
    let mut found = Vec::new();
    for i in 1..count {
        if closed(i - 1) != closed(i) {
            let regular = if closed(i) { -1 } else { 1 };
            let kind = TipKind::ContactEnd;
            found.push(Transition { bracket: [s(i - 1), s(i)], kind, regular, point: i - 1 });
        }
    }
    let mut i = 0;
    while i + 1 < count {
        if let (Some(a), Some(b)) = (slip(i), slip(i + 1))
            && a != b
        {
            let new = |last: usize, kind, regular| Transition { bracket: [s(i), s(last)], kind, regular, point: i };
            if a * b < 0 {
                found.push(new(i + 1, TipKind::SlipReversal, 0));
            } else if b == 0 && i + 2 < count && slip(i + 2).is_some_and(|c| a * c < 0) {
                found.push(new(i + 2, TipKind::SlipReversal, 0));
                i += 1;
            } else {
                found.push(new(i + 1, TipKind::StickEnd, if a == 0 { 1 } else { -1 }));
            }
        }
        i += 1;
    }
    found.sort_by(|a, b| a.bracket[0].total_cmp(&b.bracket[0]));
    found
}

/// The condition of a point of a line.
fn condition<'a>(problem: &'a Problem, line: &ContactLine, i: usize) -> &'a Condition {
    &problem.nodes[line.points[i].node].conditions[line.points[i].condition]
}

/// A first guess of the edge parameter of a transition from nodal values.
///
/// λ_n and F - |λ_t| vanish like the square root of the distance from the closed, the sticking side: the zero of the line
/// through the squares of the last two values there, within the middle 70 % of the bracket. A reversal is where u_t,
/// linear in between, vanishes.
pub fn first_guess(line: &ContactLine, transition: &Transition, problem: &Problem, solution: &Solution) -> f64 {
    let [low, high] = transition.bracket;
    nodal_guess(line, transition, problem, solution).unwrap_or((low + high) / 2.0)
}

/// [`first_guess`], none if the nodal values do not locate it.
pub(crate) fn nodal_guess(
    line: &ContactLine,
    transition: &Transition,
    problem: &Problem,
    solution: &Solution,
) -> Option<f64> {
    let [low, high] = transition.bracket;
    let i = transition.point;
    let s = |i: usize| line.points[i].s;
    if transition.kind == TipKind::SlipReversal {
        if s(i + 1) < high {
            return Some(s(i + 1)); // the one node that sticks
        }
        let slip = |i: usize| {
            let node = &problem.nodes[line.points[i].node];
            condition(problem, line, i).slip(node.pick(&solution.displacement)).abs()
        };
        let (a, b) = (slip(i), slip(i + 1));
        return (a + b > 0.0).then(|| low + (high - low) * a / (a + b));
    }
    let value = |i: usize| {
        let [pressure, shear] = solution.multipliers[line.points[i].index];
        if transition.kind == TipKind::ContactEnd {
            pressure
        } else {
            condition(problem, line, i).limit(pressure) - shear.abs()
        }
    };
    let (last, before) = if transition.regular > 0 { (i, i.checked_sub(1)) } else { (i + 1, Some(i + 2)) };
    let before = before.filter(|&j| j < line.points.len());
    let j = before?;
    let (a, b) = (value(last).powi(2), value(j).powi(2));
    let zero = (b > a && value(last) > 0.0).then(|| s(last) + (s(last) - s(j)) * a / (b - a));
    let margin = 0.15 * (high - low);
    zero.map(|zero| zero.clamp(low + margin, high - margin))
}

/// Where a fitted transition lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipFit {
    /// Edge parameter of the transition less that of its vertex.
    pub shift: f64,
    /// B of w ~ B d^(3/2), d in edge parameters (length).
    pub curvature: f64,
}

/// A vertex at a contact or stick end that is to be fitted.
#[derive(Debug, Clone)]
pub struct TipVertex<'a> {
    /// The line on which it lies.
    pub line: &'a ContactLine,
    /// What ends there.
    pub kind: TipKind,
    /// 1 if the regular side (open, slipping) has the larger edge parameter, -1 if the smaller one.
    pub regular: i8,
    /// Edge parameter.
    pub s: f64,
    /// The other singular points of the edge, its ends included.
    pub singular: Vec<f64>,
    /// Whether valleys of the obstacle are among them: the nodes up to these are few, and all count.
    pub among_valleys: bool,
}

impl TipVertex<'_> {
    /// Distance from the vertex towards the regular side.
    fn distance(&self, s: f64) -> f64 {
        (s - self.s) * f64::from(self.regular)
    }

    /// Distances of the nearest singular points on the regular side and on the other one.
    fn nearest(&self) -> [f64; 2] {
        [1.0, -1.0].map(|sign| {
            let distances = self.singular.iter().map(|&x| sign * self.distance(x));
            distances.filter(|&d| d > 1e-12).fold(f64::INFINITY, f64::min)
        })
    }

    /// Changes the sets so that the transition is at the vertex; the direction of slip beyond it.
    fn freeze(&self, sets: &mut Sets) -> i8 {
        let [next, previous] = self.nearest();
        let near = |d: f64| if d > 1e-12 { d < 0.6 * next } else { d > -0.6 * previous };
        let points: Vec<(f64, usize)> =
            self.line.points.iter().map(|p| (self.distance(p.s), p.index)).filter(|p| near(p.0)).collect();
        let slips: i32 = points.iter().filter(|p| p.0 > 1e-12).map(|p| i32::from(sets.slip(p.1).unwrap_or(0))).sum();
        let turn = if slips < 0 { -1 } else { 1 };
        for (d, index) in points {
            let on_regular = d > 1e-12;
            match self.kind {
                TipKind::ContactEnd => sets.set_closed(index, !on_regular),
                _ if on_regular => sets.set_slip(index, turn),
                _ => sets.set_slip(index, 0),
            }
        }
        turn
    }

    /// The fit of the displacement v of sets that have the transition at the vertex.
    fn fit(&self, turn: i8, v: &[f64], problem: &Problem) -> Option<TipFit> {
        let [next, previous] = self.nearest();
        let within = |reach: f64| -> Vec<(f64, f64)> {
            let points = (0..self.line.points.len()).filter(|&i| {
                let d = self.distance(self.line.points[i].s);
                d > 1e-12 && d < reach
            });
            points
                .map(|i| {
                    let (c, w) = (condition(problem, self.line, i), problem.nodes[self.line.points[i].node].pick(v));
                    // either is negative beyond a vertex that lies on the closed, the sticking side
                    let contact = self.kind == TipKind::ContactEnd;
                    let value = if contact { c.opening(w) } else { f64::from(turn) * c.slip(w) };
                    (self.distance(self.line.points[i].s), value)
                })
                .collect()
        };
        // the expansion holds up to the nearest singular point on either side
        let mut points = within(0.5 * next.min(previous));
        if points.len() < 3 {
            points = within(0.5 * next);
        }
        let far = points.len() < 3;
        if far {
            points = within(if self.among_valleys { 1.0 + 1e-9 } else { 0.99 } * next);
        }
        if points.len() < 2 {
            return None;
        }
        let [a, b] = square_root_fit(&points);
        if !(b > 0.0 && a.is_finite()) {
            return None;
        }
        let shift = -a / (1.5 * b);
        let limited = shift.clamp(-0.4 * previous, 0.4 * next);
        if self.among_valleys && far && shift != limited {
            return None;
        }
        let shift = limited;
        Some(TipFit { shift: shift * f64::from(self.regular), curvature: b })
    }
}

/// The shifts of transitions from their vertices, to first order.
///
/// With the sets changed so that all transitions are at their vertices, the gap w = g - u_n (contact) or the slip w = ±u_t
/// (stick, in the direction of most nodes there) on the regular side of each is A d^(1/2) + B d^(3/2) + C d^(5/2) + .., while
/// w ~ B (d - δ)^(3/2) with the transition in its place: the regular side begins at δ = -A/(1.5 B). The sets are changed
/// up to 0.6 of the distance to the singular points next to a vertex, the fit is on the nodes up to half of the distance to the
/// nearer one, or to that on the regular side, or (nearly) to the next singular point there, where these are fewer than three;
/// the shift is at most 0.4 of the distance to a singular point. None if B ≤ 0, if there are fewer than two nodes, or if it
/// would be more with nodes up to a valley of the obstacle.
/// *Cost*: one factorisation for all of them.
///
/// # Errors
/// [`ContactError::Decomposition`].
pub fn tip_fits(
    vertices: &[TipVertex<'_>],
    problem: &Problem,
    sets: &Sets,
) -> Result<Vec<Option<TipFit>>, ContactError> {
    if vertices.is_empty() {
        return Ok(Vec::new());
    }
    let mut sets = sets.clone();
    let turns: Vec<i8> = vertices.iter().map(|vertex| vertex.freeze(&mut sets)).collect();
    let v = Frozen::new(problem, &sets)?.displacement();
    Ok(vertices.iter().zip(turns).map(|(vertex, turn)| vertex.fit(turn, &v, problem)).collect())
}

/// A and B of w = A d^(1/2) + B d^(3/2) + C d^(5/2) + .., least squares with the weight 1/d. With few terms for their reach the
/// fits are biased: by 4e-4 of the zone with three, 5e-6 with four where a pin presses in its hole.
fn square_root_fit(points: &[(f64, f64)]) -> [f64; 2] {
    let terms = match points.len() {
        0..4 => 2,
        4..12 => 3,
        12..20 => 4,
        _ => 5,
    };
    // divided by d^(1/2) it is a polynomial in d, here in d over the largest one
    let largest = points.iter().fold(0.0, |m: f64, p| m.max(p.0));
    let matrix = Mat::from_fn(points.len(), terms, |i, j| (points[i].0 / largest).powi(j as i32));
    let values = Mat::from_fn(points.len(), 1, |i, _| points[i].1 / points[i].0.sqrt());
    let x = least_squares(matrix.as_ref(), values.as_ref());
    [x[(0, 0)], x[(1, 0)] / largest]
}

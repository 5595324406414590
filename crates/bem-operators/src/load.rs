//! Integrals of given data (tractions, gaps) against the nodal basis.

use std::sync::OnceLock;

use steklov_quadrature::{Rule, legendre_p};

use crate::near::panel_rule;
use crate::{BemError, Mesh, Space};

/// A point of the boundary at which a datum is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Element on which the point lies.
    pub element: usize,
    /// Reference coordinate on the element, -1..1.
    pub t: f64,
    /// Edge parameter, 0..1.
    pub s: f64,
    /// The point.
    pub point: [f64; 2],
}

impl Site {
    /// The point at the reference coordinate t of an element.
    pub fn new(mesh: &Mesh, element: usize, t: f64) -> Self {
        Self { element, t, s: mesh.edge_parameter(element, t), point: mesh.point(element, t) }
    }
}

/// A given function on the boundary, smooth on each element but at its kinks.
#[derive(Clone, Copy)]
pub struct Datum<'a> {
    /// What it is, for messages: "gap", "traction x".
    pub name: &'a str,
    /// Its value.
    pub value: &'a (dyn Fn(&Site) -> f64 + Sync),
    /// Reference coordinates in (-1, 1) of an element where the value or a derivative jumps. A kink that is not listed is
    /// found by halving, at a cost.
    pub kinks: &'a (dyn Fn(usize) -> Vec<f64> + Sync),
    /// Rounding error of the value, if it is larger than the value's size implies, as in a difference of larger terms.
    pub rounding: Option<&'a (dyn Fn(&Site) -> f64 + Sync)>,
}

impl Datum<'_> {
    /// The value, checked to be finite.
    ///
    /// # Errors
    /// [`BemError::DataNotFinite`] with side and point.
    pub fn at(&self, mesh: &Mesh, site: &Site) -> Result<f64, BemError> {
        let value = (self.value)(site);
        if value.is_finite() {
            return Ok(value);
        }
        let side = mesh.side_names[mesh.side[site.element]].clone();
        Err(BemError::DataNotFinite { name: self.name.into(), side, point: site.point, value })
    }
}

/// Fewest Gauss points on a smooth piece; doubled up to [`MOST_POINTS`], then the piece is halved.
const FEWEST_POINTS: usize = 16;
const MOST_POINTS: usize = 128;
/// Two rules must agree to this part of the integral of |f| over the side.
const AGREEMENT: f64 = 1e-12;
/// Halvings of a piece before it is given up.
const DEEPEST: usize = 48;
/// Pieces of an element after which it is given up.
const MOST_PIECES: usize = 400;
/// Largest total uncertainty of the pieces that were given up, as part of the integral of |f|: the noise of data with
/// cancellation passes.
const GIVEN_UP: f64 = 1e-5;
/// Smallest number of points on a side, whatever its number of elements: features narrower than a few of their distances are
/// not seen.
const SIDE_POINTS: usize = 512;

/// An element and p+1 moments against its nodal basis.
pub type ElementMoments = (usize, Vec<f64>);

/// Moments ∫ f φ_j ds (f times length) of every element of a side against its own nodal basis: (element, p+1 values).
///
/// Each element is cut at the datum's kinks; on each piece the number of Gauss points is doubled from 16 until two rules agree
/// to 1e-12 of the integral of |f| over the side, or to its rounding error; pieces that do not reach this with 128 points are
/// halved.
/// # Errors
/// [`BemError::DataNotFinite`] when f is not finite at a quadrature point; [`BemError::DataRough`] when the rules do not agree.
pub fn side_moments(
    mesh: &Mesh,
    space: &Space,
    side: usize,
    datum: &Datum<'_>,
) -> Result<Vec<ElementMoments>, BemError> {
    side_moments_and_squares(mesh, space, side, datum).map(|(moments, _)| moments)
}

/// [`side_moments`], and ∫ f² v ds on each of these elements by the same rules; v is |γ'| over half of the element's length, 1
/// on lines and arcs. The square of the part of f v orthogonal to the nodal basis follows as a difference, up to its roundoff.
///
/// # Errors
/// As [`side_moments`].
pub fn side_moments_and_squares(
    mesh: &Mesh,
    space: &Space,
    side: usize,
    datum: &Datum<'_>,
) -> Result<(Vec<ElementMoments>, Vec<f64>), BemError> {
    let elements: Vec<usize> = (0..mesh.len()).filter(|&e| mesh.side[e] == side).collect();
    let side_length: f64 = elements.iter().map(|&e| mesh.length(e)).sum();
    let parts = |e: usize| (mesh.length(e) / side_length * (SIDE_POINTS / FEWEST_POINTS) as f64).ceil() as usize;
    let pieces: Vec<Vec<f64>> =
        elements.iter().map(|&e| breaks((datum.kinks)(e), mesh.resolution(e), parts(e))).collect();
    let (mut whole, mut rounding) = (0.0, 0.0);
    for (&e, breaks) in elements.iter().zip(&pieces) {
        for piece in breaks.windows(2) {
            let rule = panel_rule(FEWEST_POINTS);
            for (t, w) in mapped(rule, piece[0], piece[1]) {
                let site = Site::new(mesh, e, t);
                whole += w * mesh.speed(e, t) * datum.at(mesh, &site)?.abs();
                rounding += datum.rounding.map_or(0.0, |of| w * mesh.speed(e, t) * of(&site));
            }
        }
    }
    let mut grown = false;
    loop {
        let (moments, squares, given_up) =
            at_tolerance(mesh, space, &elements, &pieces, datum, AGREEMENT * whole + rounding)?;
        let found: f64 = moments.iter().flat_map(|(_, m)| m).map(|m| m.abs()).sum();
        // more was found than the first look saw: a peak between its points
        if found > 4.0 * whole && found.is_finite() {
            (whole, grown) = (found, true);
            continue;
        }
        // a peak is found again at the tolerance of its own size, a pole is not
        let lost = if grown && found < 0.5 * whole { whole - found } else { 0.0 };
        let given_up = given_up + lost;
        // an overflow is no agreement either
        if given_up.is_nan() || given_up > GIVEN_UP * whole + rounding || !whole.is_finite() {
            let side = mesh.side_names[side].clone();
            return Err(BemError::DataRough { name: datum.name.into(), side, uncertainty: given_up, whole });
        }
        return Ok((moments, squares));
    }
}

/// Moments and square of each element, and the uncertainty of the pieces whose rules did not agree.
fn at_tolerance(
    mesh: &Mesh,
    space: &Space,
    elements: &[usize],
    pieces: &[Vec<f64>],
    datum: &Datum<'_>,
    tolerance: f64,
) -> Result<(Vec<ElementMoments>, Vec<f64>, f64), BemError> {
    let mut given_up = 0.0;
    let (mut moments, mut squares) = (Vec::with_capacity(elements.len()), Vec::with_capacity(elements.len()));
    for (&e, breaks) in elements.iter().zip(pieces) {
        let (mut sum, mut square) = (vec![0.0; space.degree(e) + 1], 0.0);
        for piece in breaks.windows(2) {
            let mut stack = vec![(piece[0], piece[1], 0)];
            let mut pieces = 0;
            while let Some((a, b, depth)) = stack.pop() {
                pieces += 1;
                let (values, squared, difference) = agreed(mesh, space, e, datum, a, b, tolerance)?;
                let middle = (a + b) / 2.0;
                let agrees = difference <= tolerance;
                if agrees || depth == DEEPEST || pieces > MOST_PIECES || middle <= a || middle >= b {
                    given_up += if agrees { 0.0 } else { difference };
                    sum.iter_mut().zip(&values).for_each(|(s, v)| *s += v);
                    square += squared;
                } else {
                    stack.push((middle, b, depth + 1));
                    stack.push((a, middle, depth + 1));
                }
            }
        }
        moments.push((e, sum));
        squares.push(square);
    }
    Ok((moments, squares, given_up))
}

/// Adds the moments of a datum that acts along `direction(element)` to a nodal load (interleaved x, y).
pub fn add_load(load: &mut [f64], space: &Space, moments: &[ElementMoments], direction: impl Fn(usize) -> [f64; 2]) {
    for (e, values) in moments {
        let [x, y] = direction(*e);
        for (node, value) in space.element_nodes(*e).zip(values) {
            load[2 * node] += x * value;
            load[2 * node + 1] += y * value;
        }
    }
}

/// Moments and square of one piece by doubling, and the uncertainty of the moments: the largest difference of the last two
/// rules, or the part that a kink between the last point and an end of the piece would hide.
fn agreed(
    mesh: &Mesh,
    space: &Space,
    e: usize,
    datum: &Datum<'_>,
    a: f64,
    b: f64,
    tolerance: f64,
) -> Result<(Vec<f64>, f64, f64), BemError> {
    let half_length = mesh.length(e) / 2.0;
    let curve = (!mesh.is_line(e)).then(|| mesh.curve(e));
    let speed = |t: f64| curve.as_ref().map_or(half_length, |curve| curve.derivative(t).norm());
    let basis = space.basis(e);
    let mut phi = vec![0.0; basis.degree + 1];
    let mut values = Vec::new();
    let mut sum = |n: usize, values: &mut Vec<f64>| -> Result<(Vec<f64>, f64), BemError> {
        let (mut sum, mut square) = (vec![0.0; basis.degree + 1], 0.0);
        values.clear();
        for (t, w) in mapped(panel_rule(n), a, b) {
            values.push(datum.at(mesh, &Site::new(mesh, e, t))?);
            let value = values[values.len() - 1];
            let weighted = w * speed(t) * value;
            square += weighted * value * (speed(t) / half_length);
            basis.evaluate(t, &mut phi);
            sum.iter_mut().zip(&phi).for_each(|(s, p)| *s += weighted * p);
        }
        Ok((sum, square))
    };
    let mut n = FEWEST_POINTS.max((basis.degree + 2).next_power_of_two());
    let (mut coarse, _) = sum(n, &mut values)?;
    loop {
        n *= 2;
        let (fine, square) = sum(n, &mut values)?;
        let difference = coarse.iter().zip(&fine).map(|(c, f)| (c - f).abs()).fold(0.0, f64::max);
        if difference <= tolerance {
            let hidden = half_length * hidden_at_ends(mesh, e, datum, a, b, &values)?;
            return Ok((fine, square, difference.max(hidden)));
        }
        if n >= MOST_POINTS {
            return Ok((fine, square, difference));
        }
        coarse = fine;
    }
}

/// Next to both ends, the value minus that of the polynomial through the Gauss points, times the distance to the last of them:
/// the error of the integral over t if the datum bends there.
fn hidden_at_ends(mesh: &Mesh, e: usize, datum: &Datum<'_>, a: f64, b: f64, values: &[f64]) -> Result<f64, BemError> {
    let &(near, ref weights) = next_to_end(values.len());
    let end: f64 = weights.iter().zip(values).map(|(w, f)| w * f).sum();
    let start: f64 = weights.iter().rev().zip(values).map(|(w, f)| w * f).sum();
    let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
    let value = |x: f64| datum.at(mesh, &Site::new(mesh, e, middle + half * x));
    let gap = 1.0 - panel_rule(values.len()).points[values.len() - 1];
    Ok(gap * half * (value(near)? - end).abs().max((value(-near)? - start).abs()))
}

/// The point a thousandth of the way from 1 to the last of n Gauss points, and the weights of their values in the
/// polynomial there: w_i Σ_k (2k+1)/2 P_k(t_i) P_k.
fn next_to_end(n: usize) -> &'static (f64, Vec<f64>) {
    static WEIGHTS: [OnceLock<(f64, Vec<f64>)>; 2 * MOST_POINTS + 1] = [const { OnceLock::new() }; 2 * MOST_POINTS + 1];
    WEIGHTS[n].get_or_init(|| {
        let rule = panel_rule(n);
        let near = 1.0 - 1e-3 * (1.0 - rule.points[n - 1]);
        let (mut at_end, mut p) = (vec![0.0; n], vec![0.0; n]);
        legendre_p(near, &mut at_end);
        let weight = |(&x, &w): (&f64, &f64)| {
            legendre_p(x, &mut p);
            let terms = p.iter().zip(&at_end).enumerate();
            w * terms.map(|(k, (p, q))| (2 * k + 1) as f64 / 2.0 * p * q).sum::<f64>()
        };
        (near, rule.points.iter().zip(&rule.weights).map(weight).collect())
    })
}

/// Ends of the smooth pieces of [-1, 1], also cut into equal parts. Kinks that rounding put beside an end are there.
fn breaks(mut kinks: Vec<f64>, resolution: f64, parts: usize) -> Vec<f64> {
    kinks.retain(|t| t.abs() < 1.0 - resolution);
    kinks.extend((1..parts).map(|k| 2.0 * k as f64 / parts as f64 - 1.0));
    kinks.extend([-1.0, 1.0]);
    kinks.sort_by(f64::total_cmp);
    kinks.dedup();
    kinks
}

/// Points and weights of a rule on [a, b].
fn mapped(rule: &Rule, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
    let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
    rule.points.iter().zip(&rule.weights).map(move |(t, w)| (middle + half * t, half * w))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Σ w_i f(t_i) next to both ends is f there for P_0, .., P_(n-1), and 0 for P_n, which the points do not see.
    #[test]
    fn values_next_to_an_end_are_those_of_the_polynomial() {
        for n in [16, 32, 128, 256] {
            let &(near, ref weights) = next_to_end(n);
            let points = &panel_rule(n).points;
            let gap = 1.0 - points[n - 1];
            assert!(((1.0 - near) / gap - 1e-3).abs() < 1e-10 && weights.len() == n);
            let legendre = |x: f64| {
                let mut p = vec![0.0; n + 1];
                legendre_p(x, &mut p);
                p
            };
            let (mut end, mut start) = (vec![0.0; n + 1], vec![0.0; n + 1]);
            for i in 0..n {
                for (k, p) in legendre(points[i]).iter().enumerate() {
                    end[k] += weights[i] * p;
                    start[k] += weights[n - 1 - i] * p;
                }
            }
            let size: f64 = weights.iter().map(|w| w.abs()).sum();
            for (k, (value, other)) in legendre(near).iter().zip(legendre(-near)).enumerate() {
                let (want, mirror) = if k < n { (*value, other) } else { (0.0, 0.0) };
                assert!((end[k] - want).abs() < 1e-12 * size, "n = {n}, P_{k}: {} {want}", end[k]);
                assert!((start[k] - mirror).abs() < 1e-12 * size);
            }
        }
    }

    #[test]
    fn kinks_within_the_resolution_of_an_end_are_there() {
        let kinks = |at: f64| vec![-at, 0.25, f64::NAN, at, 0.25, 1.7];
        let near = [1.0, 1.0 - 0.99e-9, 1.0 + 1e-16, 1.0 + 1e-3].map(|at| breaks(kinks(at), 1e-9, 1));
        assert!(near.iter().all(|b| *b == [-1.0, 0.25, 1.0]), "{near:?}");
        let far = 1.0 - 1.01e-9;
        assert_eq!(breaks(kinks(far), 1e-9, 2), [-1.0, -far, 0.0, 0.25, far, 1.0]);
    }
}

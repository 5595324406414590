//! Where a body lies in its obstacle between the nodes: gap less displacement, enclosed on every contact element.
//!
//! ```text
//! w(t) = g(t) - u_n(t), g an expression over intervals, u_n a polynomial in Bernstein form
//! stretches are halved until w ≥ -least is known, or w < -least to a part of itself
//! ```
//! Multipliers hold gaps in the mean over a node's functions, so that an asperity much narrower than an element touches no
//! node. Pressed flat it has an energy of about E*/2 δ² for its depth δ, whatever its width.

use steklov_contact::ContactBoundary;
use steklov_expression::{Enclosure, Expression, Interval, enclose, leaves};
use steklov_problem::Seen;
use steklov_quadrature::{Series, gauss_legendre, project};

use crate::answer::bernstein::{bernstein, halves};
use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;
use crate::estimate::contact_ends::ContactEnd;

/// A part of a contact element in which the body lies in the obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// The element.
    pub element: usize,
    /// Where it begins, is deepest and ends (reference coordinates of the element).
    pub at: [f64; 3],
    /// How deep it is (length).
    pub depth: f64,
    /// Whether that is known; else it is what could not be ruled out.
    pub known: bool,
}

/// The overlaps and loads that the nodes of a mesh do not show.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Unseen {
    /// Overlaps with obstacles between them.
    pub overlaps: Vec<Overlap>,
    /// h/(p+2) ‖t - Π_(p+1) t‖² of the loads of each element, and of the friction bounds where it may slip (stress² length²).
    pub unresolved: Vec<f64>,
    /// The ends of contact that are known better than by nodes.
    pub ends: Vec<ContactEnd>,
}

/// Largest number of stretches of an element.
const MOST_STRETCHES: usize = 4000;
/// An element is not divided below this part of itself.
const SHORTEST: f64 = 1e-9;
/// Depths are known to this part of themselves.
const PRECISE: f64 = 0.2;

impl OnMesh<'_> {
    /// The overlaps of a nodal displacement that are deeper than `least` of their element, in the order of the elements,
    /// except those of `closed`. Against other bodies displacements are relative.
    pub(crate) fn overlaps(
        &self,
        boundary: &ContactBoundary,
        joints: &[Joint],
        displacement: &[f64],
        least: &dyn Fn(usize) -> f64,
        closed: &[usize],
    ) -> Vec<Overlap> {
        let mut overlaps = Vec::new();
        let displacement = self.relative_to_faced(joints, displacement);
        for e in boundary.elements.iter().copied().filter(|e| !closed.contains(e)) {
            let Some(contact) = self.scene.contact(self.mesh.side[e]) else { continue };
            overlaps.extend(self.overlaps_of(e, &contact.gap, &displacement, least(e)));
        }
        overlaps
    }

    /// A nodal displacement, at the nodes of elements that face other bodies in contact relative to these: corners and held ends
    /// included, which have no multipliers.
    fn relative_to_faced(&self, joints: &[Joint], displacement: &[f64]) -> Vec<f64> {
        let mut relative = displacement.to_vec();
        for joint in joints.iter().filter(|joint| self.is_contact(joint)) {
            for row in self.rows_of(&joint.own, &joint.cells) {
                for (j, p) in row.other {
                    (0..2).for_each(|i| relative[2 * row.node + i] -= p * displacement[2 * j + i]);
                }
            }
        }
        relative
    }

    /// The overlaps on one element, along its normal.
    fn overlaps_of(&self, e: usize, gap: &Expression, displacement: &[f64], least: f64) -> Vec<Overlap> {
        let path = |t: f64| {
            let [x, y] = self.mesh.point(e, t);
            (x, y, self.mesh.arc_fraction(e, t))
        };
        let gap_at = |t: f64| {
            let (x, y, s) = path(t);
            gap.eval(x, y, s)
        };
        let narrow = self.is_narrow(gap, e);
        let mut overlaps: Vec<Overlap> = Vec::new();
        let mut stack = vec![([-1.0, 1.0], bernstein(&self.normal_displacement(e, displacement)))];
        let mut looked = 0;
        while let Some(([a, b], u)) = stack.pop() {
            looked += 1;
            let (m, [left, right]) = (a + (b - a) / 2.0, halves(&u));
            let at = |t: f64| {
                if t == a {
                    u[0]
                } else if t == b {
                    u[u.len() - 1]
                } else {
                    right[0]
                }
            };
            let w = |p: f64, q: f64| {
                let own = if p == q { Enclosure::fixed(Interval::point(at(p))) } else { over(&u, b - a) };
                gap.range(&leaves(&path, p, q)) - own
            };
            let low = enclose([a, b], &w);
            if low.value.low >= -least {
                continue;
            }
            let samples = [a, m, b].map(|t| (t, at(t) - gap_at(t)));
            let deepest = samples.into_iter().fold((m, 0.0), |most, w| if w.1 > most.1 { w } else { most });
            let shortest = b - a < 2.0 * SHORTEST;
            let last = shortest || looked >= MOST_STRETCHES;
            // where the root has no slope within this little, the points show all values
            let known = low.monotone
                || low.value.low >= -(1.0 + PRECISE) * deepest.1.max(least)
                || shortest && !low.value.is_bounded();
            if !known && !last {
                stack.extend([([m, b], right), ([a, m], left)]);
            } else {
                // a gap without anything narrow in the element is seen by as many points
                let known = known || !narrow;
                let depth = if known || !low.value.is_bounded() { deepest.1 } else { -low.value.low };
                join(&mut overlaps, Overlap { element: e, at: [a, deepest.0, b], depth, known });
            }
        }
        overlaps.retain(|o| o.depth > least);
        overlaps
    }

    /// u_n on an element minus the distance from another body that it faces; where the normal or the direction of contact
    /// turns, as a polynomial of eight more degrees.
    fn normal_displacement(&self, e: usize, displacement: &[f64]) -> Series {
        let basis = self.space.basis(e);
        let n = self.mesh.normal(e, 0.0);
        let apart = |seen: Seen| seen.distance != 0.0;
        if !self.mesh.is_line(e) || self.direction(e, 0.0) != n || self.seen(e, 0.0).is_some_and(apart) {
            let mut phi = vec![0.0; basis.degree + 1];
            let value = |t: f64| {
                basis.evaluate(t, &mut phi);
                let n = self.direction(e, t);
                let nodes = self.space.element_nodes(e).zip(&phi);
                let u: f64 =
                    nodes.map(|(k, phi)| phi * (displacement[2 * k] * n[0] + displacement[2 * k + 1] * n[1])).sum();
                u - self.seen(e, t).map_or(0.0, |seen| seen.distance)
            };
            let degree = basis.degree + 8;
            return project(value, degree, &gauss_legendre(degree + 1));
        }
        let nodes = self.space.element_nodes(e);
        let nodal: Vec<f64> = nodes.map(|k| displacement[2 * k] * n[0] + displacement[2 * k + 1] * n[1]).collect();
        let mut phi = vec![0.0; basis.degree + 1];
        let polynomial = |t: f64| {
            basis.evaluate(t, &mut phi);
            phi.iter().zip(&nodal).map(|(p, u)| p * u).sum()
        };
        project(polynomial, basis.degree, &gauss_legendre(basis.degree + 1))
    }
}

/// Adds an overlap to those before it, to the last one if that ends where it begins.
fn join(overlaps: &mut Vec<Overlap>, new: Overlap) {
    match overlaps.last_mut() {
        Some(last) if last.at[2] == new.at[0] => {
            last.at[2] = new.at[2];
            if new.depth > last.depth {
                (last.at[1], last.depth, last.known) = (new.at[1], new.depth, new.known);
            }
        }
        _ => overlaps.push(new),
    }
}

/// Values and slopes on a stretch of the given length: those of the coefficients' hull.
fn over(b: &[f64], length: f64) -> Enclosure {
    let hull = |values: &mut dyn Iterator<Item = f64>| {
        let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        Interval::new(ends[0], ends[1])
    };
    let degree = (b.len() - 1) as f64;
    Enclosure {
        value: hull(&mut b.iter().copied()),
        slope: hull(&mut b.windows(2).map(|pair| degree * (pair[1] - pair[0]) / length)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both forms are the same polynomial, on the whole and on halves of halves, within the hull of its coefficients.
    #[test]
    fn bernstein_coefficients_are_those_of_the_series() {
        for p in 1..=16 {
            let coefficients: Vec<f64> = (0..=p).map(|k| ((k * k + 3) as f64).sin()).collect();
            let series = Series { coefficients };
            let value = |t: f64| {
                let mut legendre = vec![0.0; p + 1];
                steklov_quadrature::legendre_p(t, &mut legendre);
                legendre.iter().zip(&series.coefficients).map(|(p, c)| p * c).sum::<f64>()
            };
            let whole = bernstein(&series);
            assert!((whole[0] - value(-1.0)).abs() < 1e-11 && (whole[p] - value(1.0)).abs() < 1e-11);
            let [left, right] = halves(&whole);
            let [_, quarter] = halves(&right);
            assert!((left[p] - value(0.0)).abs() < 1e-11 && (quarter[0] - value(0.5)).abs() < 1e-11, "p = {p}");
            let range = over(&quarter, 0.5);
            for k in 0..=20 {
                let t = 0.5 + f64::from(k) / 40.0;
                let slope = (value(t + 1e-6) - value(t - 1e-6)) / 2e-6;
                assert!(range.value.low - 1e-11 <= value(t) && value(t) <= range.value.high + 1e-11);
                let slack = 1e-5 * (1.0 + slope.abs());
                assert!(range.slope.low - slack <= slope && slope <= range.slope.high + slack, "p = {p}, t = {t}");
            }
        }
    }
}

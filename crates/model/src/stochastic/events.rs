//! Changes of contact and of stick as functions of the germs.

use steklov_stochastic::CellBasis;

use super::outcomes::Answer;

/// Pressures below this part of the largest, and openings below this part of the displacements and gaps, are roundoff.
const ROUNDOFF: f64 = 1e-9;

/// λ_n where a condition is closed, less the opening in the scale of the pressures where it is open: changes sign where contact
/// does.
pub(super) fn events(answers: &[&Answer]) -> Vec<Vec<f64>> {
    differences(answers, &|a| &a.pressure, &|a| &a.opening)
}

/// F - |λ_t| where a condition sticks, less |u_t| in the scale of that where it slips: changes sign where stick does.
pub(super) fn slips(answers: &[&Answer]) -> Vec<Vec<f64>> {
    differences(answers, &|a| &a.reserve, &|a| &a.slip)
}

/// Two numbers of each condition of which one is 0, a stress and a length, as one function with the sign of that which is not.
fn differences(
    answers: &[&Answer],
    stress: &dyn Fn(&Answer) -> &Vec<f64>,
    length: &dyn Fn(&Answer) -> &Vec<f64>,
) -> Vec<Vec<f64>> {
    let largest = |values: &dyn Fn(&Answer) -> &Vec<f64>| {
        answers.iter().flat_map(|a| values(a)).fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let beyond = |value: f64, scale: f64| if value > ROUNDOFF * scale { value } else { 0.0 };
    let stresses = largest(stress).max(largest(&|a| &a.pressure));
    let longest = largest(length);
    let lengths = longest.max(largest(&|a| &a.displacement));
    let open = beyond(longest, lengths);
    let scale = if open > 0.0 && stresses > 0.0 { stresses / open } else { 1.0 };
    let difference = |a: &&Answer| {
        let both = stress(a).iter().zip(length(a));
        both.map(|(p, g)| beyond(*p, stresses) - scale * beyond(*g, lengths)).collect()
    };
    answers.iter().map(difference).collect()
}

/// The events of a cell that are the same at all of its nodes, as polynomials: what they say elsewhere.
pub(super) struct Unanimous<'a> {
    basis: &'a CellBasis,
    /// Values at the nodes of each such event, and at the examined places.
    events: Vec<(Vec<f64>, Vec<f64>)>,
    /// Largest value of each at the nodes.
    size: Vec<f64>,
}

impl<'a> Unanimous<'a> {
    /// Events of contact and of stick; `places` are answers elsewhere in the cell.
    pub(super) fn new(basis: &'a CellBasis, nodes: &[Answer], places: &[Answer]) -> Self {
        let all: Vec<&Answer> = nodes.iter().chain(places).collect();
        let (mut events_of, mut size) = (Vec::new(), Vec::new());
        for rows in [events(&all), slips(&all)] {
            for event in 0..rows[0].len() {
                let at_nodes: Vec<f64> = rows[..nodes.len()].iter().map(|r| r[event]).collect();
                if at_nodes.iter().all(|v| (*v > 0.0) == (at_nodes[0] > 0.0)) {
                    size.push(at_nodes.iter().fold(0.0, |m: f64, v| m.max(v.abs())));
                    events_of.push((at_nodes, rows[nodes.len()..].iter().map(|r| r[event]).collect()));
                }
            }
        }
        Self { basis, events: events_of, size }
    }

    fn sum(theta: &[f64], values: &[f64]) -> f64 {
        theta.iter().zip(values).map(|(t, v)| t * v).sum()
    }

    /// The largest distance of an event beyond its change by the polynomials at a germ, relative to the size of the event; 0
    /// if none changes.
    pub(super) fn beyond(&self, germ: &[f64]) -> f64 {
        let mut theta = vec![0.0; self.basis.points.len()];
        self.basis.evaluate(germ, &mut theta);
        let changed = self.events.iter().zip(&self.size).filter_map(|((nodes, _), size)| {
            let value = Self::sum(&theta, nodes);
            let part = if *size > 0.0 { value.abs() / size } else { 0.0 };
            ((value > 0.0) != (nodes[0] > 0.0) && part > ROUNDOFF).then_some(part)
        });
        changed.fold(0.0, f64::max)
    }

    /// The fraction from 0 to 1 of the way from a germ inside of the nodes to a place at which the first of the events changes
    /// that are changed at the place; none if the place has changed none. `outermost` is the last fraction that nodes see.
    pub(super) fn change(&self, place: usize, from: &[f64], to: &[f64], outermost: f64) -> Option<f64> {
        let mut theta = vec![0.0; self.basis.points.len()];
        let mut value = |nodes: &[f64], t: f64| {
            let germ: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + t * (b - a)).collect();
            self.basis.evaluate(&germ, &mut theta);
            Self::sum(&theta, nodes)
        };
        let mut first: Option<f64> = None;
        for (nodes, places) in &self.events {
            let positive = nodes[0] > 0.0;
            if (places[place] > 0.0) == positive {
                continue;
            }
            let [a, b] = [value(nodes, outermost), value(nodes, 1.0)];
            let root = if (a > 0.0) != positive {
                outermost
            } else if (b > 0.0) != positive {
                let [mut low, mut high] = [outermost, 1.0];
                while high - low > 1e-12 {
                    let middle = 0.5 * (low + high);
                    if (value(nodes, middle) > 0.0) == positive { low = middle } else { high = middle }
                }
                low
            } else {
                // the polynomial does not reach the other side: the chord does
                let (near, far) = (a.abs(), places[place].abs());
                outermost + (1.0 - outermost) * if near + far > 0.0 { near / (near + far) } else { 0.0 }
            };
            first = Some(first.map_or(root, |f: f64| f.min(root)));
        }
        first
    }
}

//! Random contact problems for property tests.

use faer::Mat;
use proptest::collection::vec;
use proptest::prelude::*;

use crate::{Condition, ContactNode, Problem};

/// What a random node looks like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Unknowns (u_n, u_t), one condition.
    Ordinary,
    /// Unknowns (u_x, u_y), two conditions.
    Corner,
    /// One unknown in an oblique direction, one condition.
    Oblique,
}

/// Friction bounds to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// F = 0.
    None,
    /// F = ∞.
    Stick,
    /// 0, or 0.01 to 1 of the size of the loads.
    Tresca,
    /// Coefficients from 0 to this.
    Coulomb(f64),
}

/// Numbers drawn at least.
const UNKNOWNS: usize = 16;

/// Ordinary nodes only, 1 to `nodes` of them, positive definite stiffness.
pub fn ordinary(nodes: usize, friction: Friction) -> impl Strategy<Value = Problem> {
    vec(Just(Kind::Ordinary), 1..=nodes).prop_flat_map(move |kinds| coercive(kinds, friction))
}

/// 1 to `nodes` nodes of all kinds, positive definite stiffness.
pub fn mixed(nodes: usize, friction: Friction) -> impl Strategy<Value = Problem> {
    let kind = prop_oneof![Just(Kind::Ordinary), Just(Kind::Corner), Just(Kind::Oblique)];
    vec(kind, 1..=nodes).prop_flat_map(move |kinds| coercive(kinds, friction))
}

/// Stiffness E (G Gᵀ/m + I/10) with E from 1e-3 to 1e3 and loads of the size of E.
fn coercive(kinds: Vec<Kind>, friction: Friction) -> impl Strategy<Value = Problem> {
    let m: usize = kinds.iter().map(|k| if *k == Kind::Oblique { 1 } else { 2 }).sum();
    let numbers = (vec(-1.0..1.0, m * m), vec(-1.0..1.0, m), -3.0..3.0);
    (numbers, nodes(kinds, friction)).prop_map(move |((g, load, exponent), mut nodes)| {
        let size = 10f64.powf(exponent);
        let gram = |i: usize, j: usize| (0..m).map(|k| g[i * m + k] * g[j * m + k]).sum::<f64>() / m as f64;
        let stiffness = Mat::from_fn(m, m, |i, j| size * (gram(i, j) + if i == j { 0.1 } else { 0.0 }));
        nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.bound *= size);
        Problem { stiffness: stiffness.into(), load: load.iter().map(|f| f * size).collect(), nodes }
    })
}

/// Ordinary nodes at distinct points of a straight side of a body that nothing holds: S has the three rigid motions
/// u_n = 1, u_t = 1 and u_n = x in its kernel. The load is S w + Bᵀλ of a random displacement w and admissible λ, with
/// strictly positive pressures and, for Tresca friction, shears strictly inside the bounds: a solution exists.
pub fn floating(nodes_at_most: usize, friction: Friction) -> impl Strategy<Value = Problem> {
    assert!(nodes_at_most >= 3);
    vec(Just(Kind::Ordinary), 3..=nodes_at_most).prop_flat_map(move |kinds| {
        let n = kinds.len();
        let numbers = (vec(-1.0..1.0, 4 * n * n), vec(-1.0..1.0, 2 * n), vec((0.1..1.0, -0.9..0.9), n));
        (numbers, nodes(kinds, friction)).prop_map(move |((g, w, share), nodes)| {
            let stiffness = without_rigid_motions(n, &g);
            let mut load = crate::solvers::linear::product(&stiffness, &w);
            for (i, c) in nodes.iter().flat_map(|n| &n.conditions).enumerate() {
                load[2 * i] += c.normal_weight * share[i].0;
                load[2 * i + 1] +=
                    if c.bound.is_finite() { c.tangent_weight * c.limit(share[i].0) * share[i].1 } else { share[i].1 };
            }
            Problem { stiffness: stiffness.into(), load, nodes }
        })
    })
}

/// Q G Gᵀ Q/m with Q the orthogonal projection that removes the rigid motions of n points 0, 1, .. on a line.
fn without_rigid_motions(n: usize, g: &[f64]) -> Mat<f64> {
    let m = 2 * n;
    let middle = (n as f64 - 1.0) / 2.0;
    let modes: [Box<dyn Fn(usize) -> f64>; 3] = [
        Box::new(|i| ((i + 1) % 2) as f64),
        Box::new(|i| (i % 2) as f64),
        Box::new(move |i| if i % 2 == 0 { (i / 2) as f64 - middle } else { 0.0 }),
    ];
    let mut rows: Vec<Vec<f64>> = (0..m).map(|k| (0..m).map(|i| g[i * m + k]).collect()).collect();
    for row in &mut rows {
        for mode in &modes {
            let (a, b) = (0..m).fold((0.0, 0.0), |(a, b), i| (a + mode(i) * row[i], b + mode(i) * mode(i)));
            (0..m).for_each(|i| row[i] -= a / b * mode(i));
        }
    }
    Mat::from_fn(m, m, |i, j| rows.iter().map(|r| r[i] * r[j]).sum::<f64>() / m as f64)
}

fn nodes(kinds: Vec<Kind>, friction: Friction) -> impl Strategy<Value = Vec<ContactNode>> {
    let gap = prop_oneof![3 => -0.3..0.6f64, 1 => Just(0.0)];
    let bound = prop_oneof![3 => 0.01..1.0f64, 1 => Just(0.0)];
    let offset = prop_oneof![1 => -0.2..0.2f64, 3 => Just(0.0)];
    let angle = (-3.0..3.0f64, 0.2..2.8f64);
    let numbers = vec((0.1..1.0f64, gap, bound, offset, angle), UNKNOWNS.max(2 * kinds.len()));
    numbers.prop_map(move |numbers| {
        let (mut first, mut drawn, mut nodes) = (0, numbers.iter(), Vec::new());
        for &kind in &kinds {
            let mut draw = |normal: [f64; 2], tangent: [f64; 2]| {
                let &(weight, gap, f, slip_offset, _) = drawn.next().expect("two draws a node");
                let bound = match friction {
                    Friction::None => 0.0,
                    Friction::Stick => f64::INFINITY,
                    Friction::Tresca => f,
                    Friction::Coulomb(_) => 0.0,
                };
                let coefficient = if let Friction::Coulomb(largest) = friction { f * largest } else { 0.0 };
                Condition {
                    normal,
                    tangent,
                    normal_weight: weight,
                    tangent_weight: weight,
                    gap,
                    slip_offset,
                    bound,
                    coefficient,
                }
            };
            let (a, b) = numbers[first].4;
            let frame = |a: f64| ([a.cos(), a.sin()], [-a.sin(), a.cos()]);
            let (unknowns, conditions) = match kind {
                Kind::Ordinary => (2, vec![draw([1.0, 0.0], [0.0, 1.0])]),
                Kind::Corner => {
                    let ((n, t), (m, s)) = (frame(a), frame(a + b));
                    (2, vec![draw(n, t), draw(m, s)])
                }
                Kind::Oblique => (1, vec![draw([b.sin(), 0.0], [b.cos(), 0.0])]),
            };
            nodes.push(ContactNode { first, unknowns, conditions });
            first += unknowns;
        }
        nodes
    })
}

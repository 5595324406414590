//! The condensed problem that the solvers see, and their answer.

use steklov_algebra::Symmetric;
use steklov_elastic::plane::{cross, dot, norm};

use crate::ContactError;
use crate::solvers::law::Law;

/// One side's contact conditions at a node, in the node's own unknowns v:
///
/// ```text
/// u_n = normal·v ≤ gap,   λ_n ≥ 0,   λ_n (gap - u_n) = 0
/// u_t = tangent·v + slip_offset,   |λ_t| ≤ F,   λ_t u_t = F |u_t|
/// F = bound + coefficient λ_n
/// nodal force on v:  - D_n λ_n normal - D_t λ_t tangent
/// ```
///
/// Source: Issaoui (2014), equations (2.50) and (2.51).
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Coefficients of the normal displacement in the node's unknowns.
    pub normal: [f64; 2],
    /// Coefficients of the tangential displacement in the node's unknowns.
    pub tangent: [f64; 2],
    /// D_n = ∫ φ_i of the side (length); 0: this node carries no normal multiplier of this side.
    pub normal_weight: f64,
    /// D_t, the same for the tangential multiplier; 0: none.
    pub tangent_weight: f64,
    /// Weighted gap g_i (length).
    pub gap: f64,
    /// Contribution of a held neighbour to the weighted tangential displacement (length).
    pub slip_offset: f64,
    /// The friction bound without pressure, at least 0 (stress): Tresca's law. Infinity is full stick.
    pub bound: f64,
    /// Coulomb's coefficient of friction μ ≥ 0, 0 for Tresca's law; without effect where the bound is infinite or the
    /// condition has no normal multiplier.
    pub coefficient: f64,
}

/// A contact node: its unknowns `first .. first + unknowns` of the problem and the conditions on them.
///
/// An ordinary node has the unknowns (u_n, u_t) and one condition with `normal = [1, 0]`, `tangent = [0, 1]`. A corner inside
/// the contact boundary has the unknowns (u_x, u_y) and two conditions. A node with one held component has one unknown; the
/// second entry of `normal` and `tangent` is then 0. A node without conditions is one at which the body is free: its unknowns are
/// kept because that leaves S sparse.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactNode {
    /// Index of the node's first unknown.
    pub first: usize,
    /// Number of its unknowns, 1 or 2.
    pub unknowns: usize,
    /// One condition for each contact side that meets here, 1 or 2; none where nothing is touched.
    pub conditions: Vec<Condition>,
}

/// Find v minimising ½ vᵀ S v - fᵀ v + Σ D_t F |u_t| subject to u_n ≤ g at every condition; under Coulomb's law with the
/// bounds F of the solution itself, so that nothing is minimised over all v. There may then be several solutions, or none,
/// unless the coefficients are small.
///
/// S is m×m, symmetric, positive semi-definite (stress: force per thickness per displacement), f has m entries (force
/// per thickness), and the unknowns of the nodes are disjoint and fill 0..m.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Condensed stiffness S, m×m: in full storage, or a sum of blocks where subdomains share few unknowns.
    pub stiffness: Symmetric,
    /// Condensed load f.
    pub load: Vec<f64>,
    /// The contact nodes, in the order along the sides.
    pub nodes: Vec<ContactNode>,
}

/// State of a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// λ_n = 0: apart (a Tresca bound acts on it nevertheless).
    Apart,
    /// |λ_t| < F.
    Stick,
    /// Slip along +t, λ_t = F.
    SlipPlus,
    /// Slip along -t, λ_t = -F.
    SlipMinus,
}

/// How a solver ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The solver's own criterion was reached.
    Converged,
    /// The iteration limit was reached before.
    IterationLimit,
    /// The error grew, or would not shrink under a step beyond the safe one: the iterate is useless.
    Diverged,
}

/// What a solver returns, converged or not.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Unknowns v, m entries.
    pub displacement: Vec<f64>,
    /// `[λ_n, λ_t]` of each condition of each node, in the order of the nodes (stress).
    pub multipliers: Vec<[f64; 2]>,
    /// State of each condition, in the same order.
    pub status: Vec<Status>,
    /// Iterations done.
    pub iterations: usize,
    /// How the solver ended.
    pub outcome: Outcome,
    /// The solver's own measure of the error before each iteration and at the end.
    pub history: Vec<f64>,
}

impl Solution {
    /// Whether the solver's own criterion was reached.
    pub fn converged(&self) -> bool {
        self.outcome == Outcome::Converged
    }
}

impl Condition {
    /// u_n = normal·w of a node's unknowns w.
    fn normal_displacement(&self, w: [f64; 2]) -> f64 {
        dot(self.normal, w)
    }

    /// g - u_n, the distance that is left.
    pub fn opening(&self, w: [f64; 2]) -> f64 {
        self.gap - self.normal_displacement(w)
    }

    /// F = bound + coefficient λ_n under the pressure λ_n (stress), where a negative pressure counts as none.
    pub fn limit(&self, pressure: f64) -> f64 {
        let pressed = self.normal_weight > 0.0 && self.bound.is_finite();
        if pressed { self.bound + self.coefficient * pressure.max(0.0) } else { self.bound }
    }

    /// Whether the friction bound depends on the pressure.
    pub(crate) fn is_coulomb(&self) -> bool {
        self.coefficient > 0.0 && self.bound.is_finite() && self.normal_weight > 0.0 && self.tangent_weight > 0.0
    }

    /// u_t = tangent·w + slip_offset.
    pub fn slip(&self, w: [f64; 2]) -> f64 {
        dot(self.tangent, w) + self.slip_offset
    }
}

impl ContactNode {
    /// The node's entries of a vector of all unknowns; the second is 0 for a node with one unknown.
    ///
    /// # Panics
    /// If v is too short.
    pub fn pick(&self, v: &[f64]) -> [f64; 2] {
        [v[self.first], if self.unknowns == 2 { v[self.first + 1] } else { 0.0 }]
    }
}

impl Problem {
    /// ½ vᵀ S v - fᵀ v + Σ D_t F |u_t| with the bounds F of the multipliers (force per thickness times length); of v alone,
    /// it is least at the solution.
    pub fn energy(&self, v: &[f64], multipliers: &[[f64; 2]]) -> f64 {
        let elastic = self.stiffness.times(v);
        let work: f64 = v.iter().zip(elastic).zip(&self.load).map(|((v, s), f)| v * (0.5 * s - f)).sum();
        work + self.friction_work(v, multipliers)
    }

    /// Σ D_t F |u_t| over all conditions, those apart included; an infinite bound, where u_t = 0, adds nothing.
    pub fn friction_work(&self, v: &[f64], multipliers: &[[f64; 2]]) -> f64 {
        let conditions = self.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)));
        conditions
            .zip(multipliers)
            .filter(|((_, c), _)| c.bound.is_finite())
            .map(|((n, c), [pressure, _])| c.tangent_weight * c.limit(*pressure) * c.slip(n.pick(v)).abs())
            .sum()
    }

    /// Whether the parts fit together and all numbers are usable.
    ///
    /// # Errors
    /// [`ContactError::Inconsistent`] for wrong sizes, a matrix that is not symmetric to 1e-9 or has a diagonal entry that is
    /// negative, numbers that are not finite (except infinite bounds), negative weights, bounds or coefficients, unknowns that
    /// belong to no or to two nodes, more conditions than [`ContactNode`] allows, and conditions of a node that no
    /// displacement satisfies (an overlap that full stick does not let go, say).
    pub fn check(&self) -> Result<(), ContactError> {
        let refuse = |what: String| Err(ContactError::Inconsistent { what });
        let (m, s) = (self.load.len(), &self.stiffness);
        let columns = if let Symmetric::Full(full) = s { full.ncols() } else { s.size() };
        if s.size() != m || columns != m {
            return refuse(format!("the stiffness is {}×{columns} but the load has {m} entries", s.size()));
        }
        for i in 0..m {
            if !self.load[i].is_finite() {
                return refuse(format!("load {i} is {}", self.load[i]));
            }
        }
        let mut wrong = None;
        for j in 0..m {
            s.each_of_column(j, |i, entry| wrong = wrong.or((!entry.is_finite()).then_some((i, entry))));
            if let Some((i, entry)) = wrong {
                return refuse(format!("the stiffness ({i}, {j}) is {entry}"));
            }
        }
        let scale = (0..m).fold(0.0f64, |a, i| a.max(s[(i, i)]));
        if let Some(i) = (0..m).find(|&i| s[(i, i)] < -1e-9 * scale || scale <= 0.0) {
            let entry = s[(i, i)];
            return refuse(format!(
                "the stiffness has the diagonal entry {entry} in row {i}, of a largest one of {scale}"
            ));
        }
        let mut wrong = None;
        for j in 0..m {
            s.each_of_column(j, |i, entry| {
                let difference = (entry - s[(j, i)]).abs();
                wrong = wrong.or((difference > 1e-9 * scale).then_some((i, difference)));
            });
            if let Some((i, difference)) = wrong {
                return refuse(format!(
                    "the stiffness is not symmetric: ({i}, {j}) differs from ({j}, {i}) by {difference:.3e}"
                ));
            }
        }
        let mut used = vec![false; m];
        for (number, node) in self.nodes.iter().enumerate() {
            let allowed = if node.unknowns == 2 { 0..=2 } else { 0..=1 };
            if !(1..=2).contains(&node.unknowns) || !allowed.contains(&node.conditions.len()) {
                let (k, c) = (node.unknowns, node.conditions.len());
                return refuse(format!(
                    "contact node {number} has {k} unknowns and {c} conditions; \
                     it may have 1 and 0 or 1, or 2 and 0 to 2"
                ));
            }
            for i in node.first..node.first + node.unknowns {
                if i >= m || std::mem::replace(&mut used[i], true) {
                    return refuse(format!(
                        "unknown {i} of contact node {number} is beyond {m} or belongs to two nodes"
                    ));
                }
            }
            if let (Symmetric::Sparse(s), 2) = (s, node.unknowns)
                && s.pattern.place(node.first + 1, node.first).is_none()
            {
                return refuse(format!(
                    "the sparse stiffness has no entry between the two unknowns of contact node {number}; it needs one, if only 0"
                ));
            }
            if let Some(what) = node.conditions.iter().find_map(|c| c.fault(node.unknowns)) {
                return refuse(format!("contact node {number}: {what}"));
            }
            if let [a, b] = node.conditions.as_slice()
                && a.normal_weight > 0.0
                && b.normal_weight > 0.0
                && cross(a.normal, b.normal).abs() <= 1e-12 * norm(a.normal) * norm(b.normal)
            {
                return refuse(format!("contact node {number}: the normals of the two conditions are parallel"));
            }
            if !Law::new(node, [1.0, 1.0], &[]).is_feasible() {
                return refuse(format!("no displacement of contact node {number} satisfies all its conditions"));
            }
        }
        match used.iter().position(|u| !u) {
            Some(i) => refuse(format!("unknown {i} belongs to no contact node")),
            None => Ok(()),
        }
    }
}

impl Condition {
    /// The fault in the numbers of a condition on a node with this many unknowns, if there is one.
    fn fault(&self, unknowns: usize) -> Option<String> {
        let numbers = [self.normal[0], self.normal[1], self.tangent[0], self.tangent[1], self.gap, self.slip_offset];
        if let Some(x) = numbers.iter().find(|x| !x.is_finite()) {
            return Some(format!("a direction, gap or offset is {x}"));
        }
        if let Some(w) = [self.normal_weight, self.tangent_weight].iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
            return Some(format!("a weight is {w}; it must be finite and at least 0"));
        }
        if self.bound.is_nan() || self.bound < 0.0 {
            return Some(format!("the friction bound is {}; it must be at least 0", self.bound));
        }
        if !(self.coefficient.is_finite() && self.coefficient >= 0.0) {
            return Some(format!("the friction coefficient is {}; it must be finite and at least 0", self.coefficient));
        }
        for (weight, d) in [(self.normal_weight, self.normal), (self.tangent_weight, self.tangent)] {
            if weight > 0.0 && (norm(d) == 0.0 || unknowns == 1 && (d[0] == 0.0 || d[1] != 0.0)) {
                return Some(format!(
                    "the direction [{}, {}] has a weight but does not fit {unknowns} unknowns",
                    d[0], d[1]
                ));
            }
        }
        None
    }
}

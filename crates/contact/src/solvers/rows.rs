//! The multipliers of a problem as rows: the displacement on which each acts, and its bounds.

use crate::ContactNode;

/// One multiplier λ_k: its row of B, its weight D, the displacement it prescribes and its bounds.
///
/// Nodal force -D λ B_k; its condition is on B_k v - `at`: λ is the projection of λ + ρ (B_k v - at) on its bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MultiplierRow {
    /// First unknown of its node.
    pub first: usize,
    /// Number of the node's unknowns.
    pub unknowns: usize,
    /// Entries of the row of B at these unknowns.
    pub direction: [f64; 2],
    /// D (length); 0: there is no multiplier.
    pub weight: f64,
    /// Gap, or the slip at rest (length).
    pub at: f64,
    /// Lower bound (stress).
    pub low: f64,
    /// Upper bound (stress).
    pub high: f64,
    /// μ of a tangential row: its bounds widen by μ times the normal multiplier, which is that of the row before.
    pub coefficient: f64,
}

impl MultiplierRow {
    /// Entry of B at an unknown of the problem.
    pub fn entry(&self, unknown: usize) -> f64 {
        let own = self.first..self.first + self.unknowns;
        if own.contains(&unknown) { self.direction[unknown - self.first] } else { 0.0 }
    }

    /// The projection on the bounds, for a tangential row under the normal multiplier `pressure`.
    pub fn project(&self, value: f64, pressure: f64) -> f64 {
        let wider = if self.coefficient > 0.0 { self.coefficient * pressure } else { 0.0 };
        value.max(self.low - wider).min(self.high + wider)
    }
}

/// Normal and tangential row of every condition, in the order of the nodes.
pub fn multiplier_rows(nodes: &[ContactNode]) -> Vec<MultiplierRow> {
    let mut rows = Vec::new();
    for node in nodes {
        let (first, unknowns) = (node.first, node.unknowns);
        for c in &node.conditions {
            rows.push(MultiplierRow {
                first,
                unknowns,
                direction: c.normal,
                weight: c.normal_weight,
                at: c.gap,
                low: 0.0,
                high: f64::INFINITY,
                coefficient: 0.0,
            });
            rows.push(MultiplierRow {
                first,
                unknowns,
                direction: c.tangent,
                weight: c.tangent_weight,
                at: -c.slip_offset,
                low: -c.bound,
                high: c.bound,
                coefficient: if c.is_coulomb() { c.coefficient } else { 0.0 },
            });
        }
    }
    rows
}

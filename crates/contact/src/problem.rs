//! The condensed problem that the solvers see, and their answer.

use faer::Mat;

/// One side's contact conditions at a node, in the node's own unknowns v:
///
/// ```text
/// u_n = normal·v ≤ gap,   λ_n ≥ 0,   λ_n (gap - u_n) = 0
/// u_t = tangent·v + slip_offset,   |λ_t| ≤ F,   u_t = α λ_t with α ≥ 0,   α (|λ_t| - F) = 0
/// nodal force on v:  - D_n λ_n normal - D_t λ_t tangent
/// ```
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
    /// What a held neighbour adds to the weighted tangential displacement (length).
    pub slip_offset: f64,
    /// Friction bound F_i ≥ 0 (stress); 0 is frictionless, infinity is full stick.
    pub bound: f64,
}

/// A contact node: its unknowns `first .. first + unknowns` of the problem and the conditions on them.
///
/// An ordinary node has the unknowns (u_n, u_t) and one condition with `normal = [1, 0]`, `tangent = [0, 1]`. A corner
/// inside the contact boundary has the unknowns (u_x, u_y) and two conditions. A node of which one component is held
/// has one unknown; the second entry of `normal` and `tangent` is then 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactNode {
    /// Index of the node's first unknown.
    pub first: usize,
    /// Number of its unknowns, 1 or 2.
    pub unknowns: usize,
    /// One condition for each contact side that meets here, 1 or 2.
    pub conditions: Vec<Condition>,
}

/// Find v minimising ½ vᵀ S v - fᵀ v + Σ D_t F |u_t| subject to u_n ≤ g at every condition.
///
/// S is m×m, symmetric, positive semi-definite (stress: force per thickness per displacement), f has m entries (force
/// per thickness), and the unknowns of the nodes are disjoint and fill 0..m.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Condensed stiffness S, full storage, m×m.
    pub stiffness: Mat<f64>,
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
    /// Whether the solver's own criterion was reached.
    pub converged: bool,
    /// The solver's own measure of the error before each iteration and at the end.
    pub history: Vec<f64>,
}

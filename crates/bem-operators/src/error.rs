//! What can go wrong between a polygon and a displacement.

use steklov_elastic::RigidMotion;

/// Errors of this crate; each carries the numbers that show what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BemError {
    /// Elastic constants that no material has.
    #[error(transparent)]
    Material(#[from] steklov_elastic::MaterialError),
    /// Linear algebra that went wrong.
    #[error("{0}")]
    Fault(#[from] steklov_algebra::Fault),
    /// An element list that is not a set of closed loops.
    #[error("the mesh is not a set of closed loops of elements: {what}")]
    Mesh {
        /// Which element, and what is wrong with it.
        what: String,
    },
    /// A stored part that does not fit the others.
    #[error("{part} does not fit: {what}")]
    Part {
        /// Name of the part.
        part: &'static str,
        /// What is wrong with it.
        what: String,
    },
    /// The single layer matrix V has no Cholesky factor: the length in log(L/r) is too small for the boundary.
    #[error(
        "the single layer matrix is not positive definite (pivot {pivot} of {size}): \
         the length L = {length} in log(L/r) is too small, the diameter of the boundary, {diameter}, is always enough"
    )]
    SingleLayerIndefinite {
        /// Index of the pivot that was not positive.
        pivot: usize,
        /// Number of traction unknowns.
        size: usize,
        /// The length L that was used.
        length: f64,
        /// Diameter of the boundary.
        diameter: f64,
    },
    /// The stiffness of the eliminated unknowns has no Cholesky factor.
    #[error(
        "the stiffness of the free unknowns is not positive definite (pivot {pivot} of {size}): a rigid motion is not held, or rounding \
         leaves no digit of it"
    )]
    StiffnessSingular {
        /// Index of the pivot that was not positive.
        pivot: usize,
        /// Number of eliminated unknowns.
        size: usize,
    },
    /// The matrix of what subdomains share does not fit into memory.
    #[error("the factor of the {size} unknowns of contact and cuts does not fit into memory: allow a larger tolerance")]
    Memory {
        /// Number of unknowns.
        size: usize,
    },
    /// Nodes of interfaces that face one another in a circle.
    #[error(
        "{rows} conditions of interfaces depend on one another in a circle: let the other side of one interface carry the multipliers"
    )]
    Cycle {
        /// Conditions in the circle, and those that depend on it.
        rows: usize,
    },
    /// Nothing holds these rigid motions and the loads do work on them.
    #[error("nothing holds the body against {}: the loads do work {work:.3e} on it (of a scale of {scale:.3e}); hold a displacement, or balance the loads", RigidMotion::names(.modes))]
    RigidMotion {
        /// The motions that are free.
        modes: Vec<RigidMotion>,
        /// Largest work of the loads on a unit free motion.
        work: f64,
        /// Sum of |load|·|motion|, the scale of that work.
        scale: f64,
    },
    /// A given function is not finite where it is needed.
    #[error("{name} on side \"{side}\" is {value} at ({}, {}); it must be finite there", .point[0], .point[1])]
    DataNotFinite {
        /// What the function is.
        name: String,
        /// The side.
        side: String,
        /// The point.
        point: [f64; 2],
        /// The value.
        value: f64,
    },
    /// A given function cannot be integrated: quadrature rules of rising order do not come to agree.
    #[error(
        "{name} on side \"{side}\" cannot be integrated: rules differ by {uncertainty:.1e} of {whole:.3e}; \
         it must be bounded, with jumps and kinks only where abs, sign, min, max or a comparison makes them"
    )]
    DataRough {
        /// What the function is.
        name: String,
        /// The side.
        side: String,
        /// What the rules differ by.
        uncertainty: f64,
        /// Integral of the absolute value over the side.
        whole: f64,
    },
}

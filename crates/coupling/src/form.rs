//! The three forms of the equations on the interface.

/// Which fields are unknowns. v are the unknowns of the trace, Π v the trace in the displacement space of the boundary elements;
/// A_c and f_c are the body's stiffness and load, reduced to v; n points out of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Displacement v and traction φ of the medium; symmetric, indefinite:
    ///
    /// ```text
    /// (A_c + Πᵀ W Π) v + Πᵀ (K - ½M)ᵀ φ = f_c + Πᵀ W u0
    ///      (K - ½M) Π v            - V φ = (K - ½M) u0
    /// ```
    TwoField,
    /// Displacement v, traction φ and displacement ξ of the medium, which is determined up to a rigid motion; Z spans those:
    ///
    /// ```text
    ///  A_c v - Bᵀ φ                        = f_c
    /// -B v   - V φ + (K + ½M) ξ            = -M u0
    ///          (K + ½M)ᵀ φ + (W + Z Zᵀ) ξ  = 0
    /// ```
    /// The displacements are equal against the tractions only (B = ∫ ψ·v), so that its solution is another one than that of
    /// the two other forms, of the same order.
    ThreeField,
    /// Displacement v; S = W + (K - ½M)ᵀ V⁻¹ (K - ½M), positive definite: (A_c + Πᵀ S Π) v = f_c + Πᵀ S u0. The solution
    /// of the two-field form, with the traction eliminated; the cheapest.
    Schur,
}

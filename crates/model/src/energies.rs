//! Energies of a solution.

/// J = strain energy + energy of springs - load work + friction work. In an unbounded body under remote stress these are the energies of
/// u_c = u - ε_∞ x, J = ½⟨S u_c, u_c⟩ - ⟨t - σ_∞n, u_c⟩ + friction work: those of u are infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies {
    /// J.
    pub total: f64,
    /// Half of a(u, u): that of the bodies alone.
    pub strain: f64,
    /// ½ ∫ K u·u of springs on sides.
    pub springs: f64,
    /// Work of tractions and body force, without that of reactions.
    pub load_work: f64,
    /// Σ D_i F_i |u_t,i|.
    pub friction_work: f64,
}

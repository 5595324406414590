//! Constants of the Lamé kernels.

use steklov_elastic::Material;

/// Constants of the kernels, with μ, κ and ν of plane strain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Constants {
    /// c_V = 1/(8πμ(1-ν)).
    pub(crate) c_v: f64,
    pub(crate) kappa: f64,
    /// c_W = μ/(2π(1-ν)).
    pub(crate) c_w: f64,
    /// H = `h_log` LOG I + `h_rr` rr = 2μ c_V (-κ LOG I + rr) + LOG I/(2π).
    pub(crate) h_log: f64,
    pub(crate) h_rr: f64,
}

impl Constants {
    pub(crate) fn new(material: &Material) -> Self {
        let (mu, nu, kappa) = (material.mu(), material.nu(), material.kappa());
        let pi = std::f64::consts::PI;
        let c_v = 1.0 / (8.0 * pi * mu * (1.0 - nu));
        let h_rr = 1.0 / (4.0 * pi * (1.0 - nu));
        Self { c_v, kappa, c_w: mu / (2.0 * pi * (1.0 - nu)), h_log: 0.5 / pi - h_rr * kappa, h_rr }
    }
}

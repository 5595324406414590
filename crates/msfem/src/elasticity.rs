//! Isotropic elasticity in the plane and the bilinear element on a rectangle.
//!
//! Voigt strain (ε_xx, ε_yy, 2 ε_xy), stress (σ_xx, σ_yy, σ_xy). Local nodes (0,0), (1,0), (1,1), (0,1), local unknown
//! 2·node + component.

use steklov_elastic::Plane;

use crate::MsfemError;

/// Everything of an isotropic material but Young's modulus, which may vary from cell to cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// Poisson's ratio ν in (-1, 1/2).
    pub poisson: f64,
    /// Plane strain or plane stress.
    pub plane: Plane,
}

/// Gauss points of two on [0, 1]; each has the weight 1/2.
pub(crate) const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];

/// Values of the four bilinear functions at (ξ, η) ∈ [0, 1]².
pub(crate) fn shape([xi, eta]: [f64; 2]) -> [f64; 4] {
    [(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), xi * eta, (1.0 - xi) * eta]
}

/// Their derivatives along x and y on a cell with sides hx, hy.
pub(crate) fn gradients([xi, eta]: [f64; 2], [hx, hy]: [f64; 2]) -> [[f64; 2]; 4] {
    let dx = [-(1.0 - eta), 1.0 - eta, eta, -eta];
    let dy = [-(1.0 - xi), -xi, xi, 1.0 - xi];
    [0, 1, 2, 3].map(|a| [dx[a] / hx, dy[a] / hy])
}

impl Elasticity {
    /// A material with this ratio.
    ///
    /// # Errors
    /// [`MsfemError::Poisson`] outside of (-1, 1/2).
    pub fn new(poisson: f64, plane: Plane) -> Result<Self, MsfemError> {
        if poisson > -1.0 && poisson < 0.5 {
            Ok(Self { poisson, plane })
        } else {
            Err(MsfemError::Poisson { value: poisson })
        }
    }

    /// λ and μ for E = 1: σ = λ tr(ε) I + 2μ ε in the plane. Plane stress has λ = ν/(1-ν²).
    pub(crate) fn unit_lame(&self) -> [f64; 2] {
        let nu = self.poisson;
        let lambda = match self.plane {
            Plane::Strain => nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            Plane::Stress => nu / (1.0 - nu * nu),
        };
        [lambda, 0.5 / (1.0 + nu)]
    }

    /// C(1), the stress of a Voigt strain for E = 1.
    pub fn unit_stress(&self, strain: [f64; 3]) -> [f64; 3] {
        stress_of(self.unit_lame(), strain)
    }

    /// K₀ = ∫ Bᵀ C(1) B over a cell with sides hx, hy (dimensionless); 2×2 Gauss points are exact. K_e = E_e K₀.
    pub fn unit_stiffness(&self, spacing: [f64; 2]) -> [[f64; 8]; 8] {
        stiffness(self.unit_lame(), spacing)
    }

    /// K_λ and K_μ: the stiffness of λ = 1 alone, and of μ = 1 alone; K₀ = λ K_λ + μ K_μ.
    pub(crate) fn parts_of_stiffness(spacing: [f64; 2]) -> [[[f64; 8]; 8]; 2] {
        [[1.0, 0.0], [0.0, 1.0]].map(|lame| stiffness(lame, spacing))
    }

    /// Stress at the local point (ξ, η) of a cell with Young's modulus E and nodal displacement u.
    pub fn stress(&self, young: f64, u: &[f64; 8], at: [f64; 2], spacing: [f64; 2]) -> [f64; 3] {
        self.unit_stress(strain(u, &gradients(at, spacing))).map(|s| young * s)
    }

    /// Von Mises stress, with σ_zz = ν (σ_xx + σ_yy) in plane strain and 0 in plane stress.
    pub fn von_mises(&self, stress: [f64; 3]) -> f64 {
        steklov_elastic::von_mises(stress, self.poisson, self.plane)
    }
}

/// Stress of a Voigt strain for Lamé's constants λ, μ.
pub(crate) fn stress_of([lambda, mu]: [f64; 2], [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
    let trace = lambda * (xx + yy);
    [trace + 2.0 * mu * xx, trace + 2.0 * mu * yy, mu * xy]
}

/// ∫ Bᵀ C B over a cell for Lamé's constants.
fn stiffness(lame: [f64; 2], spacing: [f64; 2]) -> [[f64; 8]; 8] {
    let mut k = [[0.0; 8]; 8];
    let weight = 0.25 * spacing[0] * spacing[1];
    for xi in GAUSS {
        for eta in GAUSS {
            let d = gradients([xi, eta], spacing);
            for b in 0..8 {
                let mut unit = [0.0; 8];
                unit[b] = 1.0;
                let stress = stress_of(lame, strain(&unit, &d));
                for a in 0..4 {
                    k[2 * a][b] += weight * (d[a][0] * stress[0] + d[a][1] * stress[2]);
                    k[2 * a + 1][b] += weight * (d[a][1] * stress[1] + d[a][0] * stress[2]);
                }
            }
        }
    }
    // the same bits on both sides of the diagonal
    for a in 0..8 {
        for b in 0..a {
            k[a][b] = k[b][a];
        }
    }
    k
}

/// Voigt strain of nodal displacements.
pub(crate) fn strain(u: &[f64; 8], d: &[[f64; 2]; 4]) -> [f64; 3] {
    let mut e = [0.0; 3];
    for a in 0..4 {
        e[0] += d[a][0] * u[2 * a];
        e[1] += d[a][1] * u[2 * a + 1];
        e[2] += d[a][1] * u[2 * a] + d[a][0] * u[2 * a + 1];
    }
    e
}

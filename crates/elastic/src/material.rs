//! Isotropic linear elasticity in the plane.

/// Elastic constants that no material has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// Young's modulus must be positive and finite.
    #[error("Young's modulus is {young}; it must be positive and finite")]
    Young {
        /// The value given.
        young: f64,
    },
    /// Poisson's ratio must lie in (-1, 1/2).
    #[error("Poisson's ratio is {poisson}; it must lie in (-1, 1/2)")]
    Poisson {
        /// The value given.
        poisson: f64,
    },
}

/// Plane strain, or plane stress by the equivalent constants of plane strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// ε_zz = 0.
    Strain,
    /// σ_zz = 0: E' = E(1+2ν)/(1+ν)² and ν' = ν/(1+ν) stand for E and ν in every kernel.
    Stress,
}

/// Young's modulus E (stress), Poisson's ratio ν and the plane assumption.
///
/// All derived constants are those of the equivalent plane strain problem, so kernels need not ask which it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus as given.
    pub young: f64,
    /// Poisson's ratio as given.
    pub poisson: f64,
    /// Plane strain or plane stress.
    pub plane: Plane,
}

impl Material {
    /// # Errors
    /// [`MaterialError::Young`] unless 0 < E < ∞, [`MaterialError::Poisson`] unless -1 < ν < 1/2.
    pub fn new(young: f64, poisson: f64, plane: Plane) -> Result<Self, MaterialError> {
        if !(young > 0.0 && young.is_finite()) {
            return Err(MaterialError::Young { young });
        }
        if !(poisson > -1.0 && poisson < 0.5) {
            return Err(MaterialError::Poisson { poisson });
        }
        Ok(Self { young, poisson, plane })
    }

    /// Poisson's ratio of the equivalent plane strain problem.
    pub fn nu(&self) -> f64 {
        match self.plane {
            Plane::Strain => self.poisson,
            Plane::Stress => self.poisson / (1.0 + self.poisson),
        }
    }

    /// E* = E/(1-ν²) in plane strain, E in plane stress.
    pub fn plane_modulus(&self) -> f64 {
        2.0 * self.mu() / (1.0 - self.nu())
    }

    /// Shear modulus μ = E/(2(1+ν)), the same in both planes.
    pub fn mu(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// First Lamé constant λ = 2μν/(1-2ν) of the equivalent plane strain problem.
    pub fn lambda(&self) -> f64 {
        2.0 * self.mu() * self.nu() / (1.0 - 2.0 * self.nu())
    }

    /// κ = 3 - 4ν of the equivalent plane strain problem.
    pub fn kappa(&self) -> f64 {
        3.0 - 4.0 * self.nu()
    }

    /// Stress `[σ_xx, σ_yy, σ_xy]` of a displacement gradient `[[∂x u_x, ∂y u_x], [∂x u_y, ∂y u_y]]`.
    pub fn stress(&self, gradient: [[f64; 2]; 2]) -> [f64; 3] {
        let (lambda, mu) = (self.lambda(), self.mu());
        let trace = lambda * (gradient[0][0] + gradient[1][1]);
        [trace + 2.0 * mu * gradient[0][0], trace + 2.0 * mu * gradient[1][1], mu * (gradient[0][1] + gradient[1][0])]
    }

    /// Von Mises stress of `[σ_xx, σ_yy, σ_xy]`, with σ_zz = ν(σ_xx+σ_yy) in plane strain and 0 in plane stress.
    pub fn von_mises(&self, stress: [f64; 3]) -> f64 {
        von_mises(stress, self.poisson, self.plane)
    }
}

/// Principal stresses in the plane of `[σ_xx, σ_yy, σ_xy]`, the larger one first.
pub fn principal([xx, yy, xy]: [f64; 3]) -> [f64; 2] {
    let (mean, radius) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    [mean + radius, mean - radius]
}

/// Von Mises stress of `[σ_xx, σ_yy, σ_xy]`, with σ_zz = ν(σ_xx+σ_yy) in plane strain and 0 in plane stress.
pub fn von_mises([xx, yy, xy]: [f64; 3], poisson: f64, plane: Plane) -> f64 {
    let zz = match plane {
        Plane::Strain => poisson * (xx + yy),
        Plane::Stress => 0.0,
    };
    (0.5 * ((xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2)) + 3.0 * xy * xy).sqrt()
}

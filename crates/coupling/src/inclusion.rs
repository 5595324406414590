//! A homogeneous body by boundary elements alone.

use faer::Mat;
use steklov_bem_operators::{BoundaryField, Domain, Operators, Steklov, TractionMap};
use steklov_elastic::Material;
use steklov_quadrature::gauss_legendre;

use crate::{Coupled, CouplingError, Medium};

/// Points of the rule on each element for the jump of tractions, in addition to its degree.
const POINTS: usize = 8;

/// A homogeneous body, any polygon without holes, on the boundary elements of the medium around it.
///
/// *Use when* the body has one modulus and no body force: no grid is needed, and its outline is free. Of a body force whose
/// particular solution u_p is known, u - u_p is such a body, with u0 - u_p and t0 - σ(u_p)n. *Cost*: as the medium, twice the
/// three matrices and 2.3 N³ operations for S.
#[derive(Debug, Clone)]
pub struct Inclusion {
    /// Its material.
    pub material: Material,
    /// S = W + (K + ½M)ᵀ V⁻¹ (K + ½M) of the body (stress); it does not depend on a length.
    pub stiffness: Mat<f64>,
    /// ∫ t0·v, the jump of tractions (force per thickness).
    pub load: Vec<f64>,
    traction: TractionMap,
}

impl Inclusion {
    /// The body that fills the hole of this medium, with the jump of tractions t0(x, n) (stress), n out of the body, integrated
    /// by p + 8 Gauss points on each element.
    ///
    /// # Errors
    /// [`CouplingError::Inconsistent`] for boundary elements of several loops, or jumps that are not finite.
    pub fn new(
        material: Material,
        medium: &Medium,
        jump: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
    ) -> Result<Self, CouplingError> {
        let Medium { mesh, space, .. } = medium;
        let (mut loop_length, mut at) = (1, mesh.next[0]);
        while at != 0 {
            (loop_length, at) = (loop_length + 1, mesh.next[at]);
        }
        if loop_length < mesh.len() {
            let what = format!(
                "the first loop has {loop_length} of {} boundary elements: the body must have one outer boundary and no holes",
                mesh.len()
            );
            return Err(CouplingError::Inconsistent { what });
        }
        let mut load = vec![0.0; space.dofs()];
        for e in 0..mesh.len() {
            let (rule, mut phi) = (gauss_legendre(space.degree(e) + POINTS), vec![0.0; space.degree(e) + 1]);
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let x = mesh.point(e, t);
                let value = jump(x, mesh.normal(e));
                if let Some(value) = value.iter().find(|v| !v.is_finite()) {
                    let what = format!("the jump of tractions is {value} at ({}, {}): it must be finite", x[0], x[1]);
                    return Err(CouplingError::Inconsistent { what });
                }
                space.basis(e).evaluate(t, &mut phi);
                for (node, phi) in space.element_nodes(e).zip(&phi) {
                    (0..2).for_each(|i| load[2 * node + i] += 0.5 * mesh.length(e) * w * phi * value[i]);
                }
            }
        }
        let steklov = Steklov::new(Operators::assemble(mesh, space, &material, None)?, Domain::Interior)?;
        Ok(Self { material, stiffness: steklov.matrix, load, traction: steklov.traction })
    }

    /// The field of a solution in the body.
    pub fn field(&self, medium: &Medium, solved: &Coupled) -> BoundaryField {
        let Medium { mesh, space, operators, .. } = medium;
        let traction = self.traction.apply(&solved.trace);
        BoundaryField::new(mesh, space, &self.material, &solved.trace, &traction, operators.diameter)
    }
}

//! The unbounded homogeneous medium around the body.

use steklov_algebra::Cholesky;
use steklov_bem_operators::{BemError, BoundaryField, Functional, Inside, Mesh, Operators, Space, Trace};
use steklov_elastic::Material;

use crate::dense::product;
use crate::{Coupled, CouplingError};

/// Boundary elements of the medium around the body.
///
/// n points out of the body, into this medium. Its displacement ξ and traction φ on the boundary satisfy
///
/// ```text
/// V φ = (K - ½) ξ + a,        W ξ + (K' + ½) φ = 0
/// ```
/// with a the displacement at infinity.
///
/// Source: Hsiao and Wendland (2008), section 2.2.
#[derive(Debug, Clone)]
pub struct Medium {
    /// Elements on the outer boundary of the body, with the body to the left.
    pub mesh: Mesh,
    /// Their unknowns.
    pub space: Space,
    /// The homogeneous medium.
    pub material: Material,
    /// V, K, W, M and the length L in log(L/r).
    pub operators: Operators,
}

impl Medium {
    /// Assembles the operators; `length` is L, by default the diameter.
    ///
    /// Loads without a resultant have a solution that does not depend on L; with one, L selects the rigid translation.
    ///
    /// # Errors
    /// [`CouplingError::Bem`]: elements that are not closed loops, or an L so small that V is not positive definite.
    pub fn new(mesh: Mesh, material: Material, length: Option<f64>) -> Result<Self, CouplingError> {
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, length)?;
        // L not less than the diameter is enough
        if operators.length < operators.diameter
            && let Err(pivot) = Cholesky::new(operators.v.as_ref())
        {
            let (size, length, diameter) = (space.dofs(), operators.length, operators.diameter);
            return Err(BemError::SingleLayerIndefinite { pivot, size, length, diameter }.into());
        }
        Ok(Self { mesh, space, material, operators })
    }

    /// S(ξ - a) = W (ξ - a) + (K - ½)'φ of a solution at the nodes, the forces with which the medium resists (force per thickness),
    /// and ξ - a.
    pub(crate) fn forces(&self, solution: &Coupled) -> (Vec<f64>, Vec<f64>) {
        let a = solution.constant;
        let xi: Vec<f64> = solution.exterior_displacement.iter().enumerate().map(|(k, u)| u - a[k % 2]).collect();
        let Operators { k, w, mass, .. } = &self.operators;
        let mut forces = product(w.as_ref(), &xi);
        forces.iter_mut().zip(product(k.transpose(), &solution.traction)).for_each(|(f, t)| *f += t);
        for (&value, (row, column)) in mass {
            forces[column] -= 0.5 * value * solution.traction[row];
        }
        (forces, xi)
    }

    /// Strain energy ½ ⟨S(ξ - a), ξ - a⟩ of a solution in the medium (force times length per thickness); with a resultant of the
    /// loads, whose energy is infinite, it depends on L.
    pub fn energy(&self, solution: &Coupled) -> f64 {
        let (forces, xi) = self.forces(solution);
        0.5 * forces.iter().zip(&xi).map(|(f, u)| f * u).sum::<f64>()
    }

    /// The field of a solution in the medium.
    pub fn field(&self, solution: &Coupled) -> MediumField {
        let of = (&solution.exterior_displacement[..], &solution.traction[..], solution.constant);
        MediumField::new(&self.mesh, &self.space, &self.material, self.operators.length, of)
    }
}

/// Displacement and stress around the body: u = K ξ - V φ + a.
#[derive(Debug, Clone)]
pub struct MediumField {
    field: BoundaryField,
    constant: [f64; 2],
}

impl MediumField {
    /// The field of ξ, φ and a of a solution on boundary elements and their unknowns; `length` is L in log(L/r).
    pub fn new(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        length: f64,
        (u, t, constant): (&[f64], &[f64], [f64; 2]),
    ) -> Self {
        Self { field: BoundaryField::new(mesh, space, material, u, t, length), constant }
    }

    /// Values on the boundary, from the medium, at the reference coordinate t of element e.
    pub fn trace(&self, e: usize, t: f64) -> Trace {
        self.field.trace(e, t)
    }

    /// Displacement x, y and stress xx, yy, xy at a point outside of the body as functionals of fields of these degrees.
    pub fn functionals_at(&self, x: [f64; 2]) -> [Functional; 5] {
        self.field.functionals_inside(x).map(|own| {
            // the constant alone has the sign of the field
            let constant = own.of_constant();
            Functional::sum(&[own], &[-1.0]).with_constant(constant)
        })
    }

    /// Values at a point outside of the body (not on the boundary; in the body u is 0 up to the error).
    pub fn at(&self, x: [f64; 2]) -> Inside {
        // the representation of a body has the opposite sign
        let inside = self.field.inside(x);
        Inside {
            displacement: [0, 1].map(|i| self.constant[i] - inside.displacement[i]),
            gradient: inside.gradient.map(|row| row.map(|g| -g)),
            stress: inside.stress.map(|s| -s),
        }
    }
}

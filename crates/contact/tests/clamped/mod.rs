//! A square clamped at its top, for stabilised multipliers.

use faer::Mat;
use steklov_bem_operators::{Dof, Domain, Mesh, Operators, Space, Steklov, TractionMap};
use steklov_contact::{MultiplierDegree, MultiplierMesh, MultiplierSpace, StabilisedForms};
use steklov_elastic::Material;

/// The square of side 1 about the origin, its top held at 0, in contact along its floor.
pub struct Clamped {
    pub mesh: Mesh,
    pub space: Space,
    pub material: Material,
    pub stiffness: Mat<f64>,
    pub traction: TractionMap,
    pub held: Vec<(Dof, f64)>,
}

impl Clamped {
    /// A mesh within |y| ≤ ½ whose side 0 is the floor.
    pub fn on(mesh: Mesh, material: Material) -> Self {
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, None).unwrap();
        let Steklov { matrix: stiffness, traction } = Steklov::new(operators, Domain::Interior).unwrap();
        let top = (0..space.nodes()).filter(|&i| (space.points[i][1] - 0.5).abs() < 1e-12);
        let held = top.flat_map(|i| [(2 * i, 0.0), (2 * i + 1, 0.0)]).collect();
        Self { mesh, space, material, stiffness, traction, held }
    }

    pub fn forms(&self, multipliers: &MultiplierSpace) -> StabilisedForms {
        StabilisedForms::new(&self.mesh, &self.space, &self.material, &self.traction, multipliers).expect("no fault")
    }

    pub fn multipliers(&self, mesh: MultiplierMesh, degree: MultiplierDegree) -> MultiplierSpace {
        MultiplierSpace::new(&self.mesh, &[0], mesh, degree).unwrap()
    }
}

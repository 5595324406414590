//! The body of a scene on one mesh with its supports, without loads.

use faer::Mat;
use steklov_bem_operators::{Dof, Mesh, Operators, Space, Steklov, TractionMap};
use steklov_elastic::plane::dot;
use steklov_model::data::on_mesh::OnMesh;
use steklov_model::data::parts::pieces;
use steklov_model::data::supports::Supports;
use steklov_model::error::SolveError;
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_problem::{Refine, Scene};
use steklov_quadrature::gauss_legendre;

/// S of a mesh and its held unknowns.
pub(super) struct Supported {
    /// The mesh.
    pub(super) mesh: Mesh,
    /// The space of its displacements.
    pub(super) space: Space,
    /// S with the springs of sides, and with springs against the rigid motions r that the supports leave: E (∫ r·v)² /
    /// (∫ r·r ∫ 1), the same on all meshes.
    pub(super) stiffness: Mat<f64>,
    /// The map of displacements to tractions.
    pub(super) traction: TractionMap,
    /// Held unknowns and their values.
    pub(super) held: Vec<(Dof, f64)>,
}

impl Supported {
    /// The scene's body on a mesh.
    ///
    /// # Errors
    /// As [`steklov_model::solve::one_mesh::solve`] for prescribed displacements and operators.
    pub(super) fn new(scene: &Scene, mesh: Mesh) -> Result<Self, SolveError> {
        let space = Space::new(&mesh);
        let data = OnMesh { scene, mesh: &mesh, space: &space };
        let held = data.held()?;
        let supports = Supports { space: &space, held: &held };
        let springs = data.springs()?;
        let (fixed, motions) =
            (supports.dofs(), scene.unresisted(0, supports.free_motions(springs.resisted(|_| true))));
        let operators = Operators::assemble(&mesh, &space, &scene.body().material(), None)?;
        let Steklov { matrix: mut stiffness, traction } = Steklov::new(operators, scene.domain(0))?;
        springs.stiffen(&mut stiffness, &pieces(&scene.problem, &mesh, &space, None).0[0]);
        let length: f64 = (0..mesh.len()).map(|e| mesh.length(e)).sum();
        for motion in motions {
            let (moments, square) = moments(&mesh, &space, |x| motion.at(x));
            let size = scene.body().material().young / (square * length);
            for j in 0..stiffness.ncols() {
                (0..stiffness.nrows()).for_each(|i| stiffness[(i, j)] += size * moments[i] * moments[j]);
            }
        }
        Ok(Self { mesh, space, stiffness, traction, held: fixed })
    }
}

/// ∫ r·φ of all nodal functions, interleaved, and ∫ r·r, for a linear r.
fn moments(mesh: &Mesh, space: &Space, r: impl Fn([f64; 2]) -> [f64; 2]) -> (Vec<f64>, f64) {
    let (mut moments, mut square) = (vec![0.0; space.dofs()], 0.0);
    for e in 0..mesh.len() {
        let basis = space.basis(e);
        let rule = gauss_legendre(basis.degree / 2 + 2);
        let mut phi = vec![0.0; basis.degree + 1];
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            basis.evaluate(t, &mut phi);
            let (w, r) = (w * mesh.length(e) / 2.0, r(mesh.point(e, t)));
            square += w * dot(r, r);
            for (node, phi) in space.element_nodes(e).zip(&phi) {
                (0..2).for_each(|i| moments[2 * node + i] += w * phi * r[i]);
            }
        }
    }
    (moments, square)
}

/// The sides that are in contact.
pub fn contact_sides(scene: &Scene) -> Vec<usize> {
    scene.contacts().map(|(side, _)| side).collect()
}

/// The scene on one mesh with `times` its number of elements.
pub(super) fn uniform(scene: &Scene, times: usize, degree: usize) -> Scene {
    let mut scene = scene.clone();
    scene.method.refine = Refine::None;
    (scene.method.elements, scene.method.degree) = (Some(times * scene.method.elements()), degree);
    scene
}

/// The mesh of [`uniform`].
pub(super) fn uniform_mesh(scene: &Scene, times: usize, degree: usize) -> Mesh {
    first_mesh(&uniform(scene, times, degree))
}

/// Meshes given by multiples of the scene's number of elements, degree by degree.
pub(super) fn each(meshes: &'static [(&'static [usize], usize)]) -> impl Iterator<Item = (usize, usize)> {
    meshes.iter().flat_map(|(times, degree)| times.iter().map(|t| (*t, *degree)))
}

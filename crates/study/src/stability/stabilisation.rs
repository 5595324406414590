//! Stabilised multipliers over their parameter: the largest γ₀ of a coercive form on uniform meshes, and errors up to it.
//!
//! ```text
//! ⟨S v, v⟩ - ∫ γ |σ^h(v)|² > 0 for all v   if and only if   γ₀ < critical,      γ = γ₀ h/p²
//! ```
//! γ₀ E has no unit. Multipliers have degree p on the mesh of the displacements.

use steklov_bem_operators::PairCache;
use steklov_contact::{MultiplierDegree, MultiplierMesh, MultiplierSpace, StabilisedForms};
use steklov_model::error::SolveError;
use steklov_model::solve::one_mesh::solve;
use steklov_problem::{Multiplier, Scene};

use crate::convergence::for_truth;
use crate::distinct;
use crate::reference::{Reference, true_error};
use crate::supported::{Supported, contact_sides, each, uniform_mesh};
use crate::table::Column;
use crate::watch::Watch;

/// Meshes of the critical γ₀: multiples of the scene's number of elements, and degrees.
const MESHES: [(&[usize], usize); 8] = [
    (&[1, 2, 4, 8], 1),
    (&[1, 2, 4, 8], 2),
    (&[1, 2, 4, 8], 4),
    (&[1], 3),
    (&[1], 6),
    (&[1], 8),
    (&[1], 10),
    (&[1], 12),
];
/// Meshes of the errors.
const ERROR_MESHES: [(usize, usize); 3] = [(2, 1), (2, 2), (2, 4)];
/// Relative error of the reference for the errors.
const SHARP: f64 = 2e-4;
/// γ₀ over its critical value.
const RATIOS: [f64; 9] = [1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99];

/// The name of the part.
const STABILISATION: &str = "stabilisation";

/// The critical γ₀ of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Critical {
    /// Elements.
    pub elements: usize,
    /// Their degree.
    pub degree: usize,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Critical γ₀ (1/stress); NaN if not found.
    pub gamma: f64,
    /// γ₀ E.
    pub gamma_young: f64,
    /// Why it was not found.
    pub failure: Option<String>,
}

/// A uniform mesh solved with a γ₀.
#[derive(Debug, Clone, PartialEq)]
pub struct WithGamma {
    /// Elements.
    pub elements: usize,
    /// Their degree.
    pub degree: usize,
    /// γ₀ over its critical value.
    pub ratio: f64,
    /// γ₀ (1/stress).
    pub gamma: f64,
    /// ⟨S e, e⟩^½ over that of the reference solution; NaN if there is no solution.
    pub error: f64,
    /// J.
    pub energy: f64,
    /// (|J - J_ref|/|J_ref|)^½.
    pub energy_error: f64,
    /// Why it was not solved.
    pub failure: Option<String>,
}

/// Stabilised multipliers over γ₀.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stabilisation {
    /// The critical γ₀, mesh by mesh.
    pub critical: Vec<Critical>,
    /// Errors, mesh by mesh and γ₀ rising.
    pub errors: Vec<WithGamma>,
    /// Why there is no reference for errors.
    pub failure: Option<String>,
}

/// Columns of the critical γ₀.
pub(super) const CRITICAL: [Column<Critical>; 5] = [
    ("elements", "1", "elements of the uniform mesh", |c| c.elements as f64),
    ("degree", "1", "their degree", |c| c.degree as f64),
    ("dofs", "1", "displacement unknowns", |c| c.dofs as f64),
    ("gamma_critical", "1/stress", "largest gamma_0 of a coercive form", |c| c.gamma),
    ("gamma_critical_young", "1", "that times Young's modulus", |c| c.gamma_young),
];

/// Columns of the errors.
pub(super) const ERRORS: [Column<WithGamma>; 7] = [
    ("elements", "1", "elements of the uniform mesh", |p| p.elements as f64),
    ("degree", "1", "their degree", |p| p.degree as f64),
    ("ratio", "1", "gamma_0 over its critical value", |p| p.ratio),
    ("gamma", "1/stress", "gamma_0", |p| p.gamma),
    ("error", "1", "true error, energy norm, relative; NaN where it is not known", |p| p.error),
    ("energy", "force*length/thickness", "J", |p| p.energy),
    ("energy_error", "1", "(|J - J_ref|/|J_ref|)^(1/2)", |p| p.energy_error),
];

impl Stabilisation {
    /// Whether every mesh has its critical γ₀ and every γ₀ its solution.
    pub fn complete(&self) -> bool {
        self.failures().next().is_none()
    }

    /// The failures, each with its place.
    pub fn failures(&self) -> impl Iterator<Item = (String, &str)> {
        let reference = self.failure.as_deref().map(|why| ("reference".to_owned(), why));
        let critical = self.critical.iter().filter_map(|c| {
            Some((format!("critical γ₀ on {} elements of degree {}", c.elements, c.degree), c.failure.as_deref()?))
        });
        let errors = self.errors.iter().filter_map(|p| {
            let at = format!("{} of the critical γ₀ on {} elements of degree {}", p.ratio, p.elements, p.degree);
            Some((at, p.failure.as_deref()?))
        });
        reference.into_iter().chain(critical).chain(errors)
    }

    /// Degrees of the critical γ₀, rising.
    pub(super) fn degrees(&self) -> Vec<usize> {
        distinct(self.critical.iter().map(|c| c.degree))
    }

    /// Numbers of elements of the critical γ₀, rising.
    pub(super) fn elements(&self) -> Vec<usize> {
        distinct(self.critical.iter().map(|c| c.elements))
    }

    /// The errors of a mesh.
    pub(super) fn of_mesh(&self, (elements, degree): (usize, usize)) -> impl Iterator<Item = &WithGamma> {
        self.errors.iter().filter(move |p| (p.elements, p.degree) == (elements, degree))
    }

    /// The meshes of the errors.
    pub fn meshes(&self) -> Vec<(usize, usize)> {
        let mut meshes: Vec<(usize, usize)> = self.errors.iter().map(|p| (p.elements, p.degree)).collect();
        meshes.dedup();
        meshes
    }
}

/// Critical γ₀ and errors on some uniform meshes; None without contact. Meshes with more unknowns than the scene allows
/// are left out. After a request to stop no more meshes are done.
pub fn stabilisation(scene: &Scene, watch: &mut Watch<'_>) -> Option<Stabilisation> {
    let sides = contact_sides(scene);
    if sides.is_empty() {
        return None;
    }
    let mut scene = scene.clone();
    scene.method.multiplier = Multiplier::Stabilised;
    (scene.method.multiplier_mesh, scene.method.multiplier_degree) =
        (MultiplierMesh::Same, MultiplierDegree::Relative(0));
    let mut all = Stabilisation::default();
    for (times, degree) in each(&MESHES) {
        let mesh = uniform_mesh(&scene, times, degree);
        let (elements, dofs) = (mesh.len(), 2 * mesh.degree.iter().sum::<usize>());
        let done = all.critical.iter().any(|c| (c.elements, c.degree) == (elements, degree));
        if done || dofs > scene.method.max_dofs() || watch.stopped() {
            continue;
        }
        watch.tell(STABILISATION, &format!("critical γ₀, {elements} elements of degree {degree}"));
        let found = Supported::new(&scene, mesh).and_then(|body| critical(&scene, &sides, &body));
        let (gamma, failure) = found.map_or_else(|e| (f64::NAN, Some(e.to_string())), |g| (g, None));
        let gamma_young = gamma * scene.body().material().young;
        all.critical.push(Critical { elements, degree, dofs, gamma, gamma_young, failure });
    }
    if watch.stopped() {
        return Some(all);
    }
    watch.tell(STABILISATION, "reference");
    match Reference::new(&for_truth(&scene), watch.interrupts, &mut |_, _| Ok(())) {
        Ok(reference) => all.errors = errors(&scene, &all.critical, &reference, watch),
        Err(_) if watch.stopped() => {}
        Err(error) => all.failure = Some(error.to_string()),
    }
    Some(all)
}

fn critical(scene: &Scene, sides: &[usize], body: &Supported) -> Result<f64, SolveError> {
    let space = MultiplierSpace::new(&body.mesh, sides, scene.method.multiplier_mesh, scene.method.multiplier_degree)?;
    let forms = StabilisedForms::new(&body.mesh, &body.space, &scene.body().material(), &body.traction, &space)?;
    Ok(forms.critical_gamma(&body.stiffness, &body.held, &[])?)
}

/// Errors over γ₀, on the meshes whose critical γ₀ is known.
fn errors(scene: &Scene, critical: &[Critical], reference: &Reference, watch: &mut Watch<'_>) -> Vec<WithGamma> {
    let mut points = Vec::new();
    let fine = reference.levels.iter().find(|l| l.estimate <= SHARP).unwrap_or(reference.finest());
    for (times, degree) in ERROR_MESHES {
        let mesh = uniform_mesh(scene, times, degree);
        let elements = mesh.len();
        let known = critical.iter().find(|c| (c.elements, c.degree) == (elements, degree) && c.gamma.is_finite());
        let Some(known) = known else { continue };
        let mut scene = scene.clone();
        for ratio in RATIOS {
            if watch.stopped() {
                return points;
            }
            watch.tell(STABILISATION, &format!("{elements} elements of degree {degree}, {ratio} of the critical γ₀"));
            let gamma = ratio * known.gamma;
            scene.method.gamma = Some(gamma);
            let solved = solve(&scene, (mesh.clone(), None), false, &mut PairCache::default(), &mut |_| Ok(()));
            let measured = solved.and_then(|(solved, ..)| {
                let truth = true_error(&for_truth(&scene), &mesh, &solved.displacement, &fine.subdivision)?;
                let converged = truth.converged && solved.contact.as_ref().is_some_and(|c| c.reported().converged());
                Ok((truth.error / truth.norm, solved.energies.total, converged))
            });
            let (error, energy, failure) = match measured {
                Ok((error, energy, true)) => (error, energy, None),
                Ok(_) => (f64::NAN, f64::NAN, Some("the solver of contact did not reach its criterion".to_owned())),
                Err(error) => (f64::NAN, f64::NAN, Some(error.to_string())),
            };
            let energy_error = reference.energy_error(energy);
            points.push(WithGamma { elements, degree, ratio, gamma, error, energy, energy_error, failure });
        }
    }
    points
}

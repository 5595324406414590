//! Errors of uniform meshes as Poisson's ratio tends to ½.
//!
//! A method locks if its error at a mesh grows without bound as ν → ½ (bulk over shear modulus like 1/(1-2ν)).

use steklov_elastic::Material;
use steklov_model::error::SolveError;
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_model::run::adaptive_loop::{Progress, run};
use steklov_problem::{Scene, Substance};

use crate::error::StudyError;
use crate::reference::Reference;
use crate::supported::uniform;
use crate::table::Column;
use crate::watch::Watch;

/// Poisson's ratios of the study.
pub const POISSON: [f64; 8] = [0.3, 0.4, 0.45, 0.49, 0.499, 0.4999, 0.49999, 0.4999999];

/// The meshes of the study: multiples of the scene's number of elements, and degrees.
const MESHES: [(usize, usize); 5] = [(1, 1), (4, 1), (1, 2), (4, 2), (1, 4)];

/// The reference for the errors at a ratio: an hp solution on a much finer mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Poisson's ratio.
    pub poisson: f64,
    /// J; NaN if there is no solution.
    pub energy: f64,
    /// Its estimated relative error (energy norm).
    pub estimate: f64,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Why there is no reference.
    pub failure: Option<String>,
}

/// A uniform mesh at a ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Poisson's ratio.
    pub poisson: f64,
    /// Elements.
    pub elements: usize,
    /// Their degree.
    pub degree: usize,
    /// Displacement unknowns.
    pub dofs: usize,
    /// J; NaN if there is no solution.
    pub energy: f64,
    /// ⟨S e, e⟩^½ over that of the reference solution; NaN if unknown.
    pub error: f64,
    /// (|J - J_ref|/|J_ref|)^½.
    pub energy_error: f64,
    /// Why it was not solved.
    pub failure: Option<String>,
}

/// Errors over ν.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Incompressible {
    /// The references, ratio by ratio.
    pub truths: Vec<Truth>,
    /// The meshes at the first ratio, then at the next.
    pub points: Vec<Point>,
}

/// Columns of the references.
pub(super) const TRUTHS: [Column<Truth>; 4] = [
    ("poisson", "1", "Poisson's ratio", |t| t.poisson),
    ("energy", "force*length/thickness", "J of the reference", |t| t.energy),
    ("estimate", "1", "estimated relative error of the reference, energy norm", |t| t.estimate),
    ("dofs", "1", "displacement unknowns of the reference", |t| t.dofs as f64),
];

/// Columns of the meshes.
pub(super) const POINTS: [Column<Point>; 7] = [
    ("poisson", "1", "Poisson's ratio", |p| p.poisson),
    ("elements", "1", "elements of the uniform mesh", |p| p.elements as f64),
    ("degree", "1", "their degree", |p| p.degree as f64),
    ("dofs", "1", "displacement unknowns", |p| p.dofs as f64),
    ("energy", "force*length/thickness", "J", |p| p.energy),
    ("error", "1", "true error, energy norm, relative; NaN where it is not known", |p| p.error),
    ("energy_error", "1", "(|J - J_ref|/|J_ref|)^(1/2)", |p| p.energy_error),
];

impl Incompressible {
    /// Whether every ratio has its reference and every mesh its solution.
    pub fn complete(&self) -> bool {
        self.failures().next().is_none()
    }

    /// The failures, each with its ratio.
    pub fn failures(&self) -> impl Iterator<Item = (f64, &str)> {
        let truths = self.truths.iter().map(|t| (t.poisson, &t.failure));
        let all = truths.chain(self.points.iter().map(|p| (p.poisson, &p.failure)));
        all.filter_map(|(poisson, failure)| failure.as_deref().map(|why| (poisson, why)))
    }

    /// The meshes, each by its elements and its degree.
    pub fn meshes(&self) -> Vec<(usize, usize)> {
        let mut meshes: Vec<(usize, usize)> = Vec::new();
        for p in &self.points {
            if !meshes.contains(&(p.elements, p.degree)) {
                meshes.push((p.elements, p.degree));
            }
        }
        meshes
    }

    /// A mesh at all ratios.
    pub fn of_mesh(&self, (elements, degree): (usize, usize)) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |p| (p.elements, p.degree) == (elements, degree))
    }
}

/// Solves the scene on some uniform meshes at every ratio of [`POISSON`], the rest of its data unchanged, and measures
/// their errors against an hp solution at that ratio. Meshes with more unknowns than the scene allows are left out.
/// After a request to stop the current ratio is left out.
///
/// # Errors
/// As [`Reference::new`] at the first ratio; later failures are reported in their place.
pub fn incompressible(scene: &Scene, watch: &mut Watch<'_>) -> Result<Incompressible, StudyError> {
    let mut all = Incompressible::default();
    for poisson in POISSON {
        let mut scene = scene.clone();
        let Material { young, plane, .. } = scene.body().material();
        let material = Material::new(young, poisson, plane).map_err(|error| SolveError::Bem(error.into()))?;
        scene.body_mut().substance = Substance::Homogeneous(material);
        scene.expect.clear(); // the expected values hold at another ratio
        let what = format!("ν = {poisson}");
        let reference = Reference::new(&scene, watch.interrupts, &mut |step, event| {
            watch.tell_step(&what, "reference, ", step, &event);
            Ok(())
        });
        match reference {
            Err(StudyError::Solve(SolveError::Interrupted)) => break,
            Err(error) if all.truths.is_empty() => return Err(error),
            Err(error) => {
                let (energy, estimate, failure) = (f64::NAN, f64::NAN, Some(error.to_string()));
                all.truths.push(Truth { poisson, energy, estimate, dofs: 0, failure });
            }
            Ok(reference) => {
                let points = points(&scene, &reference, &what, watch);
                if watch.stopped() {
                    break;
                }
                let (energy, finest) = (reference.energy, reference.finest());
                let (estimate, dofs) = (finest.estimate, finest.dofs);
                all.truths.push(Truth { poisson, energy, estimate, dofs, failure: None });
                all.points.extend(points);
            }
        }
    }
    Ok(all)
}

/// The meshes at one ratio.
fn points(scene: &Scene, reference: &Reference, what: &str, watch: &mut Watch<'_>) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    for (times, degree) in MESHES {
        let scene = uniform(scene, times, degree);
        let mesh = first_mesh(&scene);
        let (elements, dofs) = (mesh.len(), 2 * mesh.degree.iter().sum::<usize>());
        // with many edges a mesh has more elements than requested, and may occur twice
        if dofs > scene.method.max_dofs() || points.iter().any(|p| (p.elements, p.degree) == (elements, degree)) {
            continue;
        }
        watch.tell(what, &format!("{elements} elements of degree {degree}"));
        let solved = run(&scene, Progress::first(&scene), watch.interrupts, &mut |_, _| Ok(())).and_then(|run| {
            let error = reference.true_error(&scene, run.step(), &run.last.displacement, watch.interrupts)?;
            Ok((run.last.energies.total, error))
        });
        let poisson = scene.body().material().poisson;
        let (energy, error, failure) = match solved {
            Ok((energy, error)) => (energy, error.map_or(f64::NAN, |e| e / reference.norm), None),
            Err(error) => (f64::NAN, f64::NAN, Some(error.to_string())),
        };
        let energy_error = reference.energy_error(energy);
        points.push(Point { poisson, elements, degree, dofs, energy, error, energy_error, failure });
    }
    points
}

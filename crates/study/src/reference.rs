//! True errors: the distance to a solution on a mesh that contains both the mesh in question and a fine one.
//!
//! The fine meshes are the steps of an hp run down to an error well below the tolerance. A mesh is compared with the
//! first fine mesh whose error is small beside its own, so that the errors of coarse meshes are cheap to compute.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_algebra::dot;
use steklov_bem_operators::{Mark, Mesh, PairCache, Piece, Space, Subdivision};
use steklov_model::data::on_mesh::OnMesh;
use steklov_model::data::parts::pieces;
use steklov_model::doubt::Doubt;
use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Observer, Progress, Reason, Step, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::one_mesh::solve;
use steklov_model::solve::solution::Solved;
use steklov_model::stage::Stage;
use steklov_problem::{Cutting, Refine, Scene};
use steklov_quadrature::legendre_p;

use crate::error::StudyError;

/// The solutions against which errors are measured.
#[derive(Debug, Clone)]
pub struct Reference {
    /// J to which energy errors refer.
    pub energy: f64,
    /// The source of that J.
    pub source: EnergySource,
    /// J of the finest level.
    pub own_energy: f64,
    /// How far the exact J may be from it.
    pub uncertainty: f64,
    /// (2 strain energy)^½ of the finest level: the norm to which errors are relative.
    pub norm: f64,
    /// Fine meshes with falling errors; at least one.
    pub levels: Vec<Level>,
}

/// The source of the J of a reference.
#[derive(Debug, Clone, PartialEq)]
pub enum EnergySource {
    /// The finest level: the scene expects no J.
    Own,
    /// The `[expect]` of the scene, which the finest level confirms.
    Expected {
        /// The source that the scene states.
        source: String,
    },
    /// The finest level: it contradicts the `[expect]` of the scene.
    Contradicted {
        /// The scene's value.
        expected: f64,
    },
}

/// One fine mesh of a reference.
#[derive(Debug, Clone)]
pub struct Level {
    /// Its elements.
    pub subdivision: Subdivision,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Estimated relative error (energy norm).
    pub estimate: f64,
}

/// Relative error (energy norm) that the reference aims at: the part `SHARPER` of the tolerance of the strategies, but
/// not less than `TOLERANCE`, because of rounding errors.
const SHARPER: f64 = 0.02;
const TOLERANCE: f64 = 3e-8;
/// Largest number of unknowns of the reference: this number, or 1.5 times the limit of the strategies if that is
/// larger.
const DOFS: usize = 1650;
/// A level whose error is below this part of a mesh's error gives that error to a few per cent.
const FINE: f64 = 0.05;
/// Above this part the finest level gives no error.
const TOO_COARSE: f64 = 1.0 / 3.0;
/// Largest number of unknowns of a common refinement.
const COMMON_DOFS: usize = 5000;
/// Relative error of J that rounding leaves.
const ROUNDING: f64 = 1e-12;
/// Vertices of the fine mesh are left out if they are closer than this (edge parameter) to a vertex of the mesh in
/// question.
const CLOSE: f64 = 1e-7;

impl Reference {
    /// Runs the hp strategy to an error well below the tolerance of the scene. `observe` receives the events of its
    /// steps.
    ///
    /// # Errors
    /// As [`run`]; [`SolveError::Interrupted`] also after a first request to stop; [`StudyError::NotSolved`].
    pub fn new(
        scene: &Scene,
        interrupts: &AtomicUsize,
        observe: &mut Observer<'_, BoundaryElements>,
    ) -> Result<Self, StudyError> {
        let mut fine = scene.clone();
        (fine.method.refine, fine.method.cuts) = (Refine::Hp, Cutting::None);
        fine.method.marking = None;
        fine.method.tolerance = Some(TOLERANCE.max(SHARPER * scene.method.tolerance()));
        fine.method.max_dofs = Some(DOFS.max(scene.method.max_dofs() + scene.method.max_dofs() / 2));
        let run = run(&fine, Progress::first(&fine), interrupts, observe)?;
        if run.reason == Reason::Interrupted {
            return Err(SolveError::Interrupted.into());
        }
        let steps = &run.progress.steps;
        let Some(last) = steps.iter().rev().find(|s| s.converged) else {
            return Err(StudyError::NotSolved { steps: steps.len() });
        };
        let settled = |s: &&Step<BoundaryElements>| {
            s.converged && !s.estimate().doubts.iter().any(|d| matches!(d, Doubt::Transition | Doubt::Sets))
        };
        let mut levels: Vec<Level> = steps.iter().filter(settled).map(Level::of).collect();
        if levels.last().is_none_or(|l| l.dofs != last.dofs) {
            levels.push(Level::of(last));
        }
        let estimate = last.estimate();
        let uncertainty =
            (estimate.uncertainty + (estimate.energy - last.energy).abs()).max(ROUNDING * last.energy.abs());
        let expected = scene.expect.iter().find(|e| e.path == "energy");
        let (energy, source) = match expected {
            None => (last.energy, EnergySource::Own),
            Some(e) if (e.value - last.energy).abs() <= uncertainty => {
                (e.value, EnergySource::Expected { source: e.source.clone() })
            }
            Some(e) => (last.energy, EnergySource::Contradicted { expected: e.value }),
        };
        let norm = (2.0 * last.strain).max(0.0).sqrt();
        Ok(Self { energy, source, own_energy: last.energy, uncertainty, norm, levels })
    }

    /// The finest level.
    pub fn finest(&self) -> &Level {
        self.levels.last().unwrap_or_else(|| unreachable!("a reference has a level"))
    }

    /// (|J - J_ref|/|J_ref|)^½; NaN if J_ref = 0.
    pub fn energy_error(&self, energy: f64) -> f64 {
        ((energy - self.energy).abs() / self.energy.abs()).sqrt()
    }

    /// ⟨S e, e⟩^½ of a step with the given nodal displacement, S and the exact solution from the common refinement with
    /// a level. None if it cannot be determined well enough: the error is not large beside that of the finest level,
    /// the common refinement has too many unknowns, its contact problem is not solved, or the step's body is cut into subdomains.
    ///
    /// # Errors
    /// As [`solve`]; [`SolveError::Interrupted`] after a second request to stop.
    pub fn true_error(
        &self,
        scene: &Scene,
        step: &Step<BoundaryElements>,
        displacement: &[f64],
        interrupts: &AtomicUsize,
    ) -> Result<Option<f64>, SolveError> {
        let level = self.level_for(step.estimate().error / self.norm).filter(|_| step.layout.cuts.is_none());
        let Some(level) = level else { return Ok(None) };
        let common = common_refinement(&step.layout.mesh, &level.subdivision);
        if common.dofs() > COMMON_DOFS {
            return Ok(None);
        }
        let mut watch = |_: Stage<'_>| match interrupts.load(Ordering::Relaxed) {
            0 | 1 => Ok(()),
            _ => Err(SolveError::Interrupted),
        };
        let truth = distance(scene, &step.layout.mesh, displacement, &common, &mut watch)?;
        Ok(truth.converged.then_some(truth.error))
    }

    /// The first level that is fine enough for a relative error; else the finest, if it is fine enough for a rough
    /// value.
    fn level_for(&self, error: f64) -> Option<&Level> {
        let finest = Some(self.finest()).filter(|l| l.estimate <= TOO_COARSE * error);
        self.levels.iter().find(|l| l.estimate <= FINE * error).or(finest)
    }
}

impl Level {
    fn of(step: &Step<BoundaryElements>) -> Self {
        let subdivision = Subdivision::new(&step.layout.mesh, &vec![Mark::Keep; step.layout.mesh.len()]);
        Self { subdivision, dofs: step.dofs, estimate: step.estimate().relative }
    }
}

/// Removes the rigid motions that nothing resists, which do not count as errors.
fn remove_motions(difference: &mut [f64], exact: &Solved) {
    let mut motions: Vec<Vec<f64>> = Vec::new();
    for motion in &exact.free_motions {
        let mut r = motion.nodal(&exact.space.points);
        motions.iter().for_each(|other| remove(&mut r, other));
        let norm = dot(&r, &r).sqrt();
        r.iter_mut().for_each(|v| *v /= norm);
        motions.push(r);
    }
    motions.iter().for_each(|r| remove(difference, r));
}

/// True error of a solved mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueError {
    /// ⟨S e, e⟩^½ of e = u_h - u, with u and S of the common refinement; with a medium around the body, the root of the
    /// sum of the squares of both.
    pub error: f64,
    /// (2 strain energy)^½ of u: the norm to which errors are relative.
    pub norm: f64,
    /// Whether u meets the criterion of the contact solver.
    pub converged: bool,
}

/// The true error of a nodal displacement on a mesh, measured on the common refinement with `fine`.
///
/// # Errors
/// As [`solve`].
///
/// # Panics
/// If the displacement has other nodes than the mesh: a body that is cut into subdomains has more.
pub fn true_error(
    scene: &Scene,
    mesh: &Mesh,
    displacement: &[f64],
    fine: &Subdivision,
) -> Result<TrueError, SolveError> {
    assert_eq!(displacement.len(), Space::new(mesh).dofs(), "a displacement of the nodes of the mesh");
    distance(scene, mesh, displacement, &common_refinement(mesh, fine), &mut |_| Ok(()))
}

/// The distance to the solution on a refinement of the mesh.
fn distance(
    scene: &Scene,
    mesh: &Mesh,
    displacement: &[f64],
    refinement: &Subdivision,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<TrueError, SolveError> {
    let (exact, body, _) =
        solve(scene, (refinement.mesh(&scene.problem.outline)?, None), false, &mut PairCache::default(), observe)?;
    let mut difference = prolong(mesh, displacement, &exact);
    difference.iter_mut().zip(&exact.displacement).for_each(|(a, b)| *a -= b);
    if !exact.particular.is_empty() {
        // nodal values on curves, and those of low degree, are not the particular solution: the field without it counts
        let nodal = |mesh: &Mesh, space: &Space| {
            let mut nodal = vec![0.0; space.dofs()];
            for piece in pieces(&scene.problem, mesh, space, None).0 {
                let Some(own) = scene.particular_solution(piece.body) else { continue };
                piece.part.set(&mut nodal, &piece.part.space.interpolate(|x| own.displacement(x)));
            }
            nodal
        };
        let apart = prolong(mesh, &nodal(mesh, &Space::new(mesh)), &exact);
        let missed = apart.iter().zip(nodal(&exact.mesh, &exact.space)).map(|(a, b)| a - b);
        difference.iter_mut().zip(missed).for_each(|(a, b)| *a -= b);
    }
    remove_motions(&mut difference, &exact);
    let stiff = body.condensation.multiply(&difference);
    let squared = match &body.outside {
        None => dot(&difference, &stiff),
        Some(outside) => {
            // the jumps interpolated on the two meshes differ
            let space = Space::new(mesh);
            let jump = OnMesh { scene, mesh, space: &space }.jump()?;
            let xi: Vec<f64> = displacement.iter().zip(&jump).map(|(u, jump)| u - jump).collect();
            let mut apart = prolong(mesh, &xi, &exact);
            apart.iter_mut().zip(outside.displacement(&exact.displacement)).for_each(|(a, b)| *a -= b);
            2.0 * outside.strain_energy(&difference, &apart, &stiff)
        }
    };
    Ok(TrueError {
        error: squared.max(0.0).sqrt(),
        norm: (2.0 * exact.energies.strain).max(0.0).sqrt(),
        converged: exact.balanced && exact.contact.as_ref().is_none_or(|c| c.converged()),
    })
}

/// The vertices of both meshes, without vertices of `fine` close to one of `mesh`; degrees one higher than both need.
fn common_refinement(mesh: &Mesh, fine: &Subdivision) -> Subdivision {
    let coarse = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
    let edges = coarse.edges.iter().zip(&fine.edges).map(|(a, b)| {
        let mut knots: Vec<f64> = a.iter().map(|p| p.start).chain([1.0]).collect();
        let extra = b.iter().map(|p| p.start).filter(|s| a.iter().all(|p| (p.start - s).abs() > CLOSE));
        knots.extend(extra.filter(|s| *s < 1.0 - CLOSE));
        knots.sort_by(f64::total_cmp);
        let pieces = knots.windows(2).map(|k| {
            let (middle, length) = ((k[0] + k[1]) / 2.0, k[1] - k[0]);
            let needed = |pieces: &[Piece]| {
                pieces.iter().find(|p| p.start <= middle && middle < p.end).map_or(1, |p| restricted(p, length))
            };
            let degree = (needed(a).max(needed(b)) + 1).min(Mesh::MAX_DEGREE);
            Piece { start: k[0], end: k[1], degree, mark: Mark::Keep }
        });
        pieces.collect()
    });
    Subdivision { edges: edges.collect() }
}

/// Degree that represents a polynomial of a piece on a part of it. A Legendre polynomial of degree p, restricted to a
/// part r at an end of its interval, is a polynomial of degree p r^½ + 1 up to 3 % of its largest value; in the middle
/// a lower degree suffices.
fn restricted(piece: &Piece, length: f64) -> usize {
    let share = (length / (piece.end - piece.start)).min(1.0);
    let degree = (piece.degree as f64 * share.sqrt()).ceil() as usize + 1;
    degree.min(piece.degree)
}

/// The values, at the nodes of the reference, of a displacement on a mesh that the reference refines.
fn prolong(mesh: &Mesh, displacement: &[f64], reference: &Solved) -> Vec<f64> {
    let space = Space::new(mesh);
    let (fine, nodes) = (&reference.mesh, &reference.space);
    let mut values = vec![0.0; nodes.dofs()];
    for e in 0..fine.len() {
        let [a, b] = fine.span[e];
        let middle = (a + b) / 2.0;
        let contains = |c: &usize| {
            let [s0, s1] = mesh.span[*c];
            mesh.edge[*c] == fine.edge[e] && s0.min(s1) <= middle && middle <= s0.max(s1)
        };
        let Some(c) = (0..mesh.len()).find(contains) else { continue };
        let [s0, s1] = mesh.span[c];
        // reference coordinates of both ends within the coarse element, from the nearer of its ends
        let place = |s: f64| {
            if (s - s0).abs() < (s - s1).abs() {
                -1.0 + 2.0 * (s - s0) / (s1 - s0)
            } else {
                1.0 - 2.0 * (s1 - s) / (s1 - s0)
            }
        };
        let (t0, t1) = (place(a), place(b));
        let basis = space.basis(c);
        let mut legendre = vec![0.0; basis.degree + 1];
        for (j, node) in nodes.element_nodes(e).enumerate() {
            let x = nodes.basis(e).nodes[j];
            let t = (t0 * (1.0 - x) / 2.0 + t1 * (1.0 + x) / 2.0).clamp(-1.0, 1.0);
            legendre_p(t, &mut legendre);
            let mut sum = [0.0; 2];
            for (k, coarse) in space.element_nodes(c).enumerate() {
                let phi: f64 = (0..=basis.degree).map(|n| legendre[n] * basis.to_legendre[(n, k)]).sum();
                sum = [sum[0] + phi * displacement[2 * coarse], sum[1] + phi * displacement[2 * coarse + 1]];
            }
            values[2 * node..2 * node + 2].copy_from_slice(&sum);
        }
    }
    values
}

fn remove(v: &mut [f64], unit: &[f64]) {
    let part = dot(v, unit);
    v.iter_mut().zip(unit).for_each(|(v, u)| *v -= part * u);
}

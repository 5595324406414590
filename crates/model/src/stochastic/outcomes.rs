//! Outcomes of the random input on one body: loads, gaps, bounds and modulus for given germs, and the answer to them.
//!
//! The matrices are those of the nominal modulus E₀. With e = E/E₀ the displacements of an outcome are those of E₀ under the
//! loads and friction bounds divided by e; stresses, forces and energies are e times what is then computed.

use steklov_bem_operators::{Mesh, Space};
use steklov_contact::{ContactBoundary, ContactError, Problem, Solution};
use steklov_problem::{Random, Scene, Solver, Uses};
use steklov_stochastic::{scale_bounds, solve_warm};

use super::in_body::InBody;
use super::jumps::InGerms;
use super::number::{Number, numbers};
use crate::answer::report::figures;
use crate::data::body_load::Particular;
use crate::data::motions::unresisted;
use crate::data::on_mesh::{Loads, OnMesh};
use crate::data::supports::Supports;
use crate::error::SolveError;
use crate::solve::body::{Body, Factors, Loading};
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::solve::contact_solver::solve_problem;
use crate::solve::rotations::{missed, project_load_off, rigid_load};
use crate::solve::solution::Solved;
use crate::summary::Summary;

/// The outcomes of a scene's random input on a body.
pub struct Outcomes<'a> {
    scene: &'a Scene,
    random: &'a Random,
    /// The body.
    pub body: &'a Body,
    /// The requested numbers.
    pub(super) numbers: Vec<Number>,
    /// The data in their germs.
    pub(super) data: InGerms<'a>,
    uses: Uses,
    loads: Loads,
    boundary: Option<ContactBoundary>,
}

/// The kept data of the answer to one outcome.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// E/E₀; on grids the mean of E over the body.
    pub modulus: f64,
    /// Displacement of the nodes of the boundary.
    pub displacement: Vec<f64>,
    /// The displacement of the nominal modulus that has the stress of the outcome; nothing on grids.
    pub stressed: Vec<f64>,
    /// The fields in a body on a grid, until their sums are taken; nothing for boundary elements.
    pub in_body: InBody,
    /// F - |λ_t| of each condition with friction (0 without).
    pub reserve: Vec<f64>,
    /// |u_t|.
    pub slip: Vec<f64>,
    /// λ_n of each condition.
    pub pressure: Vec<f64>,
    /// λ_t.
    pub shear: Vec<f64>,
    /// g - u_n.
    pub opening: Vec<f64>,
    /// The requested quantities.
    pub quantities: Vec<f64>,
    /// Half the elastic energy norm squared.
    pub strain: f64,
    /// Iterations of the contact solver.
    pub iterations: usize,
    /// Whether it reached its criterion, and the forces balance.
    pub converged: bool,
}

/// The answer to an outcome with the nominal modulus, and its reported numbers with its own modulus.
pub(super) struct Outcome {
    solved: Solved,
    modulus: f64,
    rows: Vec<ContactRow>,
    pub(super) figures: Summary,
}

impl<'a> Outcomes<'a> {
    /// The outcomes of a scene's random input on a body.
    ///
    /// # Errors
    /// Data that cannot be used, a quantity that is no number of an outcome.
    pub fn new(scene: &'a Scene, random: &'a Random, body: &'a Body) -> Result<Self, SolveError> {
        let data = OnMesh { scene, mesh: &body.mesh, space: &body.space };
        let in_germs = InGerms::new(scene, random);
        Ok(Self {
            scene,
            random,
            body,
            numbers: numbers(scene, random)?,
            data: in_germs,
            uses: scene.uses(random),
            loads: data.load()?,
            boundary: data.condensed_contact(&body.held, &[])?,
        })
    }

    /// The outcome as a scene, its modulus over the nominal one, and the loads on the body with the nominal modulus.
    ///
    /// # Errors
    /// [`SolveError::Data`] for data that the outcome makes impossible: correct their expressions or the range of the germs.
    /// [`SolveError::Bem`] or [`SolveError::Contact`] for loads that drive a motion which nothing resists, or if the outcome
    /// leaves other motions free than the mean input does: hold the body.
    pub fn given(&self, germs: &[f64]) -> Result<(Scene, f64, Loading), SolveError> {
        let (mesh, space): (&Mesh, &Space) = (&self.body.mesh, &self.body.space);
        let mut scene = self.scene.outcome(germs)?;
        let modulus = scene.body().material().young / self.scene.body().material().young;
        scene.body_mut().substance = self.scene.body().substance.clone();
        let data = OnMesh { scene: &scene, mesh, space };
        let uses = self.uses;
        let held = if uses.held { data.held()? } else { self.body.held.clone() };
        let mut loads = if uses.loads { data.load()? } else { self.loads.clone() };
        loads.scale(1.0 / modulus);
        let mut boundary =
            if uses.contact || uses.held { data.condensed_contact(&held, &[])? } else { self.boundary.clone() };
        if let Some(boundary) = &mut boundary {
            scale_bounds(&mut boundary.contact, 1.0 / modulus);
        }
        let pieces = &self.body.pieces;
        let product = |u: &[f64]| self.body.elastic_forces(u);
        let particular = vec![Particular::of_body(&scene, 0, 1.0 / modulus, &pieces[0].piece, product)];
        let supports = Supports { space, held: &held };
        let mut given = Loading::new(loads, particular, boundary, supports.values(), pieces);
        given.judged = false;
        let candidates = scene.unresisted(0, supports.free_motions(self.body.springs.resisted(|_| true)));
        let missed = missed(mesh, space, &candidates);
        let free = match rigid_load(&data, &given, pieces, missed)? {
            None => unresisted(&space.points, &given.load, given.boundary.as_ref(), &candidates)?,
            Some((rigid, load)) => unresisted(&rigid.points, &load, given.boundary.as_ref(), &candidates)?,
        };
        if missed > 0.0 {
            project_load_off(&mut given.load, &free.iter().map(|r| r.nodal(&space.points)).collect::<Vec<_>>());
        }
        if free.len() != self.body.free.len() {
            let (here, nominal) = (free.len(), self.body.free.len());
            let what = format!("{here} motions that nothing resists, for the mean input {nominal}: hold the body");
            return Err(ContactError::Inconsistent { what }.into());
        }
        Ok((scene, modulus, given))
    }

    /// The answer to an outcome with the nominal modulus; `warm` is the solution of a similar one.
    ///
    /// # Errors
    /// [`SolveError::Contact`] if the contact problem cannot be solved: take another solver. [`SolveError::NotFinite`] for
    /// numbers beyond the range of floating point: check the units.
    pub fn solved(
        &self,
        scene: &Scene,
        given: Loading,
        warm: &mut Option<Solution>,
    ) -> Result<(Solved, Factors), SolveError> {
        let solver = self.scene.method.solver;
        self.body.answer(scene, given, &mut |problem: &Problem| match solver {
            Solver::Auto => solve_warm(problem, warm),
            solver => solve_problem(problem, solver),
        })
    }

    /// Solves an outcome and keeps the data that statistics need.
    pub(crate) fn answer(&self, germs: &[f64], warm: &mut Option<Solution>) -> Result<Answer, SolveError> {
        let Outcome { solved, modulus, rows, figures } = self.outcome(germs, warm)?;
        Ok(self.kept(&solved, modulus, &rows, &figures))
    }

    /// Solves an outcome.
    pub(super) fn outcome(&self, germs: &[f64], warm: &mut Option<Solution>) -> Result<Outcome, SolveError> {
        let named = |error| match error {
            SolveError::Data(_) => error,
            error => SolveError::Outcome { outcome: self.random.outcome_name(germs), error: Box::new(error) },
        };
        let (scene, modulus, given) = self.given(germs).map_err(named)?;
        let (solved, _) = self.solved(&scene, given, warm).map_err(named)?;
        let (rows, figures) = self.figures(&scene, &solved, modulus, None);
        Ok(Outcome { solved, modulus, rows, figures })
    }

    /// The contact rows and the numbers of an outcome, from its answer of the nominal modulus; `multipliers` (stress of the outcome)
    /// replace its own.
    pub(crate) fn figures(
        &self,
        scene: &Scene,
        solved: &Solved,
        modulus: f64,
        multipliers: Option<&[[f64; 2]]>,
    ) -> (Vec<ContactRow>, Summary) {
        let contact = solved.contact.as_ref();
        let mut rows = contact.map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
        for row in &mut rows {
            row.pressure *= modulus;
            row.shear *= modulus;
            row.bound *= modulus;
        }
        for (row, [pressure, shear]) in rows.iter_mut().zip(multipliers.unwrap_or_default()) {
            (row.pressure, row.shear) = (*pressure, *shear);
        }
        let mut figures = figures(scene, &solved.energies, (contact, solved.trace()), &solved.reactions, &rows);
        if self.numbers.iter().any(|number| number.path.starts_with("probe")) {
            figures.probe = scene.probe.iter().map(|&x| solved.probe(scene, x)).collect();
        }
        scale(&mut figures, modulus);
        (rows, figures)
    }

    /// ⟨Su, u⟩ of the nominal modulus.
    pub(crate) fn energy(&self, u: &[f64]) -> f64 {
        self.body.condensation.multiply(u).iter().zip(u).map(|(s, u)| s * u).sum()
    }

    /// The data of an outcome that statistics need.
    pub(crate) fn kept(&self, solved: &Solved, modulus: f64, rows: &[ContactRow], figures: &Summary) -> Answer {
        let contact = solved.contact.as_ref();
        Answer {
            modulus,
            stressed: solved.displacement.iter().map(|u| modulus * u).collect(),
            quantities: self.numbers.iter().map(|number| number.of(figures)).collect(),
            strain: figures.strain_energy,
            converged: solved.balanced && contact.is_none_or(|c| c.converged()),
            displacement: solved.displacement.clone(),
            ..contact_answer(rows, contact)
        }
    }
}

/// The part of an answer that comes from its contact.
pub(super) fn contact_answer(rows: &[ContactRow], contact: Option<&ContactResult>) -> Answer {
    Answer {
        reserve: rows.iter().map(|r| if r.bound.is_finite() { r.bound - r.shear.abs() } else { 0.0 }).collect(),
        slip: rows.iter().map(|r| if r.bound > 0.0 { r.tangential_displacement.abs() } else { 0.0 }).collect(),
        pressure: rows.iter().map(|r| r.pressure).collect(),
        shear: rows.iter().map(|r| r.shear).collect(),
        opening: rows.iter().map(|r| r.gap - r.normal_displacement).collect(),
        iterations: contact.map_or(0, |c| c.solution.iterations),
        ..Answer::default()
    }
}

/// Stresses, forces and energies of the nominal modulus become those of the outcome; the contact rows have been scaled before.
fn scale(figures: &mut Summary, modulus: f64) {
    let energies =
        [&mut figures.energy, &mut figures.strain_energy, &mut figures.load_work, &mut figures.friction_work];
    energies.into_iter().chain(&mut figures.spring_energy).for_each(|e| *e *= modulus);
    if let Some(contact) = &mut figures.contact {
        contact.force = contact.force.map(|f| f * modulus);
    }
    figures.reactions.values_mut().flatten().for_each(|f| *f *= modulus);
    figures.probe.iter_mut().flat_map(|p| &mut p.stress).for_each(|s| *s *= modulus);
}

/// Paths of the quantities of a scene.
pub(crate) fn paths_of(scene: &Scene, random: &Random) -> Vec<String> {
    random.stochastic.quantities.clone().unwrap_or_else(|| default_paths(scene))
}

/// The quantities of a scene that names none.
fn default_paths(scene: &Scene) -> Vec<String> {
    let contact = scene.contacts().next().is_some();
    let more: &[&str] =
        if contact { &["contact.force.x", "contact.force.y", "contact.max_pressure", "contact.length"] } else { &[] };
    ["energy"].iter().chain(more).map(|s| (*s).to_owned()).collect()
}

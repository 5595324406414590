//! Outcomes of the random input on the bodies of a mesh: loads, gaps, bounds and moduli for given germs, and the answer to them.
//!
//! With E_k = ξ_k Ē_k of body k its matrices are ξ_k times those of Ē_k: no body is condensed again, only the skeleton of the
//! interfaces between several bodies.

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{Mesh, Space};
use steklov_contact::{ContactBoundary, ContactError, Problem, Solution};
use steklov_problem::{Random, Scene, Solver, Uses};
use steklov_stochastic::solve_warm;

use super::in_body::InBody;
use super::jumps::InGerms;
use super::number::{Number, numbers};
use crate::answer::interfaces::interface_numbers;
use crate::answer::report::figures;
use crate::data::body_load::Particular;
use crate::data::on_mesh::{Loads, OnMesh};
use crate::data::parts::Assembled;
use crate::data::supports::Supports;
use crate::error::SolveError;
use crate::solve::body::{Body, Factors, Loading};
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::solve::contact_solver::solve_problem;
use crate::solve::solution::Solved;
use crate::summary::Summary;

/// The outcomes of a scene's random input on its bodies.
pub struct Outcomes<'a> {
    scene: &'a Scene,
    random: &'a Random,
    /// The bodies with their nominal moduli.
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
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Answer {
    /// E/E₀, of several bodies that of the first one with a random modulus; on grids the mean of E over the body.
    pub modulus: f64,
    /// Displacement of the nodes of the boundary.
    pub displacement: Vec<f64>,
    /// The displacement of the nominal moduli that has the stress of the outcome; nothing on grids.
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

/// An outcome before it is solved.
pub struct Given {
    /// It as a scene.
    pub scene: Scene,
    /// The bodies with its moduli, where these are random.
    pub body: Option<Body>,
    /// The loads and supports.
    pub loading: Loading,
}

/// An outcome that is solved.
pub(super) struct Outcome {
    scene: Scene,
    solved: Solved,
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
            boundary: data.condensed_contact(&body.held, &body.joints)?,
        })
    }

    /// An outcome: its scene, its bodies, and what acts on them.
    ///
    /// # Errors
    /// [`SolveError::Data`] for data that the outcome makes impossible: correct their expressions or the range of the germs.
    /// [`SolveError::Bem`], [`SolveError::Contact`] or [`SolveError::Loose`] for loads that drive a motion which nothing resists,
    /// or if the outcome leaves other motions free than the mean input does: hold the body.
    pub fn given(&self, germs: &[f64]) -> Result<Given, SolveError> {
        let (mesh, space): (&Mesh, &Space) = (&self.body.mesh, &self.body.space);
        let scene = self.scene.outcome(germs)?;
        let uses = self.uses;
        let own = if uses.young { Some(self.body.with_moduli(&scene)?) } else { None };
        let Body { pieces, joints, springs, condensation, .. } = own.as_ref().unwrap_or(self.body);
        let data = OnMesh { scene: &scene, mesh, space };
        let held = if uses.held { data.held()? } else { self.body.held.clone() };
        let loads = if uses.loads { data.load()? } else { self.loads.clone() };
        let boundary = match uses.contact || uses.held {
            true => data.condensed_contact(&held, joints)?,
            false => self.boundary.clone(),
        };
        let tied = match uses.ties || uses.held {
            true => data.tied_nodes(joints, &held, boundary.as_ref())?,
            false => self.body.tied.clone(),
        };
        let particular = pieces.iter().map(|Assembled { piece, .. }| {
            let product = |u: &[f64]| {
                let mut all = vec![0.0; space.dofs()];
                piece.part.set(&mut all, u);
                let (forces, couples) = (condensation.multiply(&all), condensation.spring_forces(&all));
                let forces = forces.iter().zip(couples).zip(springs.pull(space, mesh.len(), &all).base);
                let of_bodies: Vec<f64> = forces.map(|((f, couple), pull)| f - couple - pull).collect();
                piece.part.own(&of_bodies)
            };
            Particular::of_body(&scene, piece.body, piece, product)
        });
        let particular = particular.collect();
        let supports = Supports { space, held: &held };
        let mut values = supports.values();
        values.extend(tied.iter().map(|tied| tied.jump));
        let mut loading = Loading::new(loads, particular, boundary, values, pieces);
        loading.judged = false;
        let (_, loose) =
            data.unresisted_motions((pieces, &space.points), (joints, &tied), (&held, springs), &mut loading)?;
        let (here, nominal) = (loose.count(), self.body.loose.count());
        if here != nominal {
            let what = format!("{here} motions that nothing resists, for the mean input {nominal}: hold the body");
            return Err(ContactError::Inconsistent { what }.into());
        }
        Ok(Given { scene, body: own, loading })
    }

    /// The answer to what acts on bodies in an outcome; `warm` is the solution of a similar one.
    ///
    /// # Errors
    /// [`SolveError::Contact`] if the contact problem cannot be solved: take another solver. [`SolveError::NotFinite`] for
    /// numbers beyond the range of floating point: check the units.
    pub fn solved(
        &self,
        scene: &Scene,
        body: &Body,
        loading: Loading,
        warm: &mut Option<Solution>,
    ) -> Result<(Solved, Factors), SolveError> {
        let solver = self.scene.method.solver;
        body.answer(scene, loading, &mut |problem: &Problem| match solver {
            Solver::Auto => solve_warm(problem, warm),
            solver => solve_problem(problem, solver),
        })
    }

    /// Solves an outcome and keeps the data that statistics need.
    pub(crate) fn answer(&self, germs: &[f64], warm: &mut Option<Solution>) -> Result<Answer, SolveError> {
        let Outcome { scene, solved, rows, figures } = self.outcome(germs, warm)?;
        Ok(self.kept(&scene, &solved, &rows, &figures))
    }

    /// Solves an outcome.
    pub(super) fn outcome(&self, germs: &[f64], warm: &mut Option<Solution>) -> Result<Outcome, SolveError> {
        let named = |error| match error {
            SolveError::Data(_) => error,
            error => SolveError::Outcome { outcome: self.random.outcome_name(germs), error: Box::new(error) },
        };
        let Given { scene, body, loading } = self.given(germs).map_err(named)?;
        let body = body.as_ref().unwrap_or(self.body);
        let (solved, _) = self.solved(&scene, body, loading, warm).map_err(named)?;
        let rows = solved.contact.as_ref().map_or(Vec::new(), |contact| contact_rows(solved.trace(), contact));
        let figures = self.figures(&scene, &solved, &rows);
        Ok(Outcome { scene, solved, rows, figures })
    }

    /// The numbers of an outcome with these contact rows.
    pub(super) fn figures(&self, scene: &Scene, solved: &Solved, rows: &[ContactRow]) -> Summary {
        let contact = solved.contact.as_ref();
        let mut figures = figures(scene, &solved.energies, (contact, solved.trace()), &solved.reactions, rows);
        let wants = |start: &str| self.numbers.iter().any(|number| number.path.starts_with(start));
        if wants("probe") {
            figures.probe = scene.probe.iter().map(|&x| solved.probe(scene, x)).collect();
        }
        if wants("interfaces") {
            figures.interfaces = interface_numbers(scene, solved, rows, None);
        }
        figures
    }

    /// ⟨Su, u⟩ of the nominal modulus.
    pub(crate) fn energy(&self, u: &[f64]) -> f64 {
        self.body.condensation.multiply(u).iter().zip(u).map(|(s, u)| s * u).sum()
    }

    /// E/E₀ of a body in an outcome.
    fn modulus(&self, outcome: &Scene, body: usize) -> f64 {
        let young = |scene: &Scene| scene.problem.bodies[body].material().young;
        young(outcome) / young(self.scene)
    }

    /// The data of an outcome that statistics need.
    pub(super) fn kept(&self, scene: &Scene, solved: &Solved, rows: &[ContactRow], figures: &Summary) -> Answer {
        let contact = solved.contact.as_ref();
        let mut stressed = solved.displacement.clone();
        for Assembled { piece, .. } in &self.body.pieces {
            let modulus = self.modulus(scene, piece.body);
            let own: Vec<f64> = piece.part.own(&stressed).iter().map(|u| u * modulus).collect();
            piece.part.set(&mut stressed, &own);
        }
        Answer {
            modulus: self.modulus(scene, self.random.constants.first_young()),
            stressed,
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

//! The dual problems of a grid solved: with its supports and contact, or in its medium, and on coarse cells.

use steklov_contact::MovedEnd;
use steklov_msfem::{Bases, Basis, Elimination, Extra, Multiscale};
use steklov_problem::Scene;

use super::duals::{OF_NODE, rough};
use super::frozen_contact::{FrozenProblem, on_contact, with_frozen};
use super::functionals::GridFunctional;
use super::in_medium::{InMedium, MediumPart};
use super::solution::GridSolved;
use super::solve::Acting;
use super::solve_coarse::lift;
use super::system::CondensedContact;
use super::trace::{GridTrace, node_at};
use crate::contact_length::ends_at_corners_are_known;
use crate::data::supports::{Held, Supports};
use crate::error::SolveError;
use crate::solve::contact_rows::contact_rows;

/// The factor of the equations of a grid.
pub(super) struct Factors {
    pub equations: Equations,
    /// The bases of coarse cells, and what is held at the nodes of their boundary.
    pub coarse: Option<(Bases, Vec<Held>)>,
}

/// How a body is held.
pub(super) enum Equations {
    Supported(Box<Supported>),
    InMedium(Box<InMedium>),
}

/// Supports and contact.
pub(super) struct Supported {
    pub elimination: Elimination,
    pub contact: Option<CondensedContact>,
    /// What is held at the nodes of the boundary of the fine grid.
    pub held: Vec<Held>,
}

impl Supported {
    /// The fine unknowns that supports hold, and what the displacement lacks of what they give.
    pub fn held_unknowns(&self, fine: &GridTrace, solved: &GridSolved) -> Vec<(usize, f64)> {
        let of_node = |(&place, held): (&[usize; 2], &Held)| {
            let node = node_at(&solved.body.grid, place);
            [0, 1]
                .map(|i| held.components[i].map(|(given, _)| (2 * node + i, given - solved.displacement[2 * node + i])))
        };
        fine.lattice.iter().zip(&self.held).flat_map(of_node).flatten().collect()
    }
}

/// Dual solutions on the fine nodes.
#[derive(Default)]
pub(super) struct Solutions {
    pub solutions: Vec<Vec<f64>>,
    pub of_ends: Vec<Vec<[f64; 2]>>,
    pub energy_of_ends: f64,
    pub medium: Option<MediumPart>,
}

impl Solutions {
    /// The fields of several loads and held displacements of the unknowns of a factor.
    fn new(
        functionals: &[GridFunctional<'_>],
        (scene, solved): (&Scene, &GridSolved),
        fine: &GridTrace,
        equations: &Equations,
        (loads, held): (&[Vec<f64>], &[Vec<f64>]),
    ) -> Result<Self, SolveError> {
        let (elimination, condensed) = match equations {
            Equations::Supported(own) => (&own.elimination, own.contact.as_ref()),
            Equations::InMedium(medium) => {
                let (solutions, part) = medium.solve(scene, (&solved.body, fine), functionals, loads)?;
                return Ok(Self { solutions, medium: Some(part), ..Self::default() });
            }
        };
        let (Some(condensed), Some(contact)) = (condensed, &solved.contact) else {
            return Ok(Self { solutions: elimination.fields(loads, held), ..Self::default() });
        };
        let largest = |both: &[MovedEnd; 2]| both.iter().map(|end| end.energy.abs()).fold(0.0, f64::max);
        let all = |frozen: &FrozenProblem<'_>, moved: &[[MovedEnd; 2]]| {
            let of = |(functional, (load, held)): (&GridFunctional<'_>, (&Vec<f64>, &Vec<f64>))| {
                let w = match &functional.of_forces {
                    Some((side, w)) => on_contact(&contact.boundary, *side, w),
                    None => vec![0.0; condensed.factors.problem.load.len()],
                };
                frozen.field(load, held, &w)
            };
            let (solutions, of_ends) = functionals.iter().zip(loads.iter().zip(held)).map(of).unzip();
            let energy_of_ends = OF_NODE * moved.iter().map(largest).sum::<f64>();
            Self { solutions, of_ends, energy_of_ends, medium: None }
        };
        let may_open = !ends_at_corners_are_known(scene, &contact_rows(solved.trace(), contact));
        Ok(with_frozen(elimination, condensed, (contact.reported(), may_open), all)?)
    }
}

/// The dual solutions on the fine nodes.
pub(super) fn solutions(
    functionals: &[GridFunctional<'_>],
    (scene, solved): (&Scene, &GridSolved),
    acting: &Acting,
    factors: Factors,
) -> Result<Solutions, SolveError> {
    let (body, trace, fine) = (&solved.body, &solved.trace, &acting.fine);
    let Factors { equations, coarse } = factors;
    let fine_held = match &equations {
        Equations::Supported(own) => own.held.clone(),
        Equations::InMedium(_) => vec![Held::default(); fine.space.nodes()],
    };
    let values = |space, held: &[Held]| Supports { space, held }.values();
    let (Some((bases, held)), Some(of_mesh)) = (coarse, &solved.coarse) else {
        let loads: Vec<Vec<f64>> = functionals.iter().map(|f| f.load.nodal(body)).collect();
        let held: Vec<Vec<f64>> = functionals.iter().map(|f| values(&fine.space, &f.held(fine, &fine_held))).collect();
        return Solutions::new(functionals, (scene, solved), fine, &equations, (&loads, &held));
    };
    let problem = Multiscale::with_bases(body, of_mesh.mesh.clone(), bases);
    let (mut loads, mut of_held, mut extras) = (Vec::new(), Vec::new(), Vec::new());
    for functional in functionals {
        let (own, own_fine) = (functional.held(trace, &held), functional.held(fine, &fine_held));
        let lift = lift(&problem, fine, &own_fine, trace, &own);
        let extra = Extra { bubbles: problem.basis != Basis::Q1, lift };
        loads.push(problem.load(&functional.load, &extra)?);
        of_held.push(values(&trace.space, &own));
        extras.push(extra);
    }
    let on_vertices = Solutions::new(functionals, (scene, solved), fine, &equations, (&loads, &of_held))?;
    let fields = on_vertices.solutions.into_iter().zip(&extras).zip(functionals);
    let on_fine = |((coarse, extra), functional): ((Vec<f64>, &Extra), &GridFunctional<'_>)| {
        let mut z = problem.downscale(&coarse, &functional.load, extra, &mut |_| true)?;
        if rough(solved).is_some() {
            for (&place, held) in fine.lattice.iter().zip(functional.held(fine, &fine_held)) {
                let node = node_at(&body.grid, place);
                (0..2).for_each(|i| z[2 * node + i] = held.components[i].map_or(z[2 * node + i], |(w, _)| w));
            }
        }
        Ok::<_, SolveError>(z)
    };
    let solutions = fields.map(on_fine).collect::<Result<_, _>>()?;
    Ok(Solutions { solutions, ..on_vertices })
}

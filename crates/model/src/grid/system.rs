//! The equations of a body on a grid, solved: supports, contact, reactions. Unknowns are those of the fine grid, or of coarse
//! vertices.

use faer::Mat;
use sprs::CsMat;
use steklov_algebra::dot;
use steklov_contact::{ContactBoundary, Problem};
use steklov_elastic::RigidMotion;
use steklov_msfem::{Elimination, ReducedLoad};
use steklov_problem::{NamedQuantity, Scene, Solver};

use super::trace::GridTrace;
use crate::data::motions::{unresisted, work};
use crate::data::supports::{Held, Supports};
use crate::error::SolveError;
use crate::solve::contact::{CondensedBody, ContactFactors, ContactResult, solve_contact};
use crate::solve::contact_solver::solve_problem;
use crate::solve::equilibrium::{Equations, reactions};
use crate::stage::Stage;

/// Unknowns of a stiffness matrix reduced to the contact nodes.
const CONTACT: &str = "displacement unknown of the contact nodes, in the order of /contact, along normal and tangent";

/// K, its load, and where its unknowns are.
pub(crate) struct System {
    /// K of all unknowns 2·node + component.
    pub stiffness: CsMat<f64>,
    pub load: Vec<f64>,
    /// Points of the nodes.
    pub points: Vec<[f64; 2]>,
    /// The nodes in an order that makes little fill.
    pub order: Vec<usize>,
    /// The node at each node of the boundary.
    pub at_boundary: Vec<usize>,
}

/// From displacements, the number e of an element and its end j: approximately the moment of the traction on e against the
/// function of j.
pub(crate) type CornerMoment<'a> = dyn Fn(&[f64], usize, usize) -> [f64; 2] + 'a;

/// The answer of a [`System`].
pub(crate) struct Answer {
    pub displacement: Vec<f64>,
    pub contact: Option<ContactResult>,
    /// Whether the residual of equilibrium is as small as rounding allows.
    pub balanced: bool,
    pub reactions: Vec<(String, [f64; 2])>,
    /// The moments and weighted forces that the scene asks for, of the forces at the nodes of the boundary.
    pub works: Vec<f64>,
    pub free_motions: Vec<RigidMotion>,
    /// uᵀ K u and uᵀ f.
    pub energy: f64,
    pub work: f64,
    /// K, and its factor.
    pub elimination: Elimination,
    /// The problem of its contact, if there is any.
    pub condensed: Option<CondensedContact>,
}

/// The contact problem of a grid, whose unknowns are the kept ones of the elimination in their frames.
pub(crate) struct CondensedContact {
    pub factors: ContactFactors,
    pub frames: Frames,
}

/// Part of all nodal forces that a translation may meet as resistance.
const RESISTING: f64 = 1e-6;

/// Unknowns that hold rigid motions which nothing resists, chosen as different in their effect as possible.
fn pins(points: &[[f64; 2]], motions: &[RigidMotion], taken: &[bool]) -> Vec<usize> {
    let mut rows: Vec<Vec<f64>> = motions.iter().map(|r| r.nodal(points)).collect();
    let mut pins = Vec::new();
    for k in 0..rows.len() {
        let size = |dof: usize| rows[k..].iter().map(|r| r[dof].abs()).fold(0.0, f64::max);
        let free = (0..taken.len()).filter(|&dof| !taken[dof]);
        let Some(pin) = free.max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a))) else { break };
        let pivot = (k..rows.len()).max_by(|&a, &b| rows[a][pin].abs().total_cmp(&rows[b][pin].abs())).unwrap_or(k);
        rows.swap(k, pivot);
        let (first, rest) = rows.split_at_mut(k + 1);
        for row in rest {
            let factor = row[pin] / first[k][pin];
            row.iter_mut().zip(&first[k]).for_each(|(a, b)| *a -= factor * b);
        }
        pins.push(pin);
    }
    pins
}

/// Values at points.
pub(super) type Field<'a> = (&'a mut [f64], &'a [[f64; 2]]);

/// Subtracts from a field its part along each motion, node by node, and the same motions from others.
pub(super) fn without_motions((u, points): Field<'_>, others: &mut [Field<'_>], motions: &[RigidMotion]) {
    let subtract = |a: &mut [f64], part: f64, b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a -= part * b);
    // on the points of the field and on those of the others
    let mut basis: Vec<Vec<Vec<f64>>> = Vec::new();
    for motion in motions {
        let mut r: Vec<Vec<f64>> = vec![motion.nodal(points)];
        r.extend(others.iter().map(|(_, points)| motion.nodal(points)));
        for b in &basis {
            let part = dot(&r[0], &b[0]) / dot(&b[0], &b[0]);
            r.iter_mut().zip(b).for_each(|(r, b)| subtract(r, part, b));
        }
        let part = dot(u, &r[0]) / dot(&r[0], &r[0]);
        subtract(u, part, &r[0]);
        others.iter_mut().zip(&r[1..]).for_each(|((u, _), r)| subtract(u, part, r));
        basis.push(r);
    }
}

/// Turns the unknowns of contact nodes into their frames and back: v = Qᵀ u.
pub(crate) struct Frames(Vec<(usize, [[f64; 2]; 2])>);

impl Frames {
    /// Where in the list of kept unknowns the frames of the nodes begin.
    fn new(boundary: &ContactBoundary) -> Self {
        let kept = boundary.kept();
        let at = |node: usize| kept.iter().position(|&dof| dof == 2 * node);
        Self(boundary.frames().into_iter().filter_map(|(node, frame)| Some((at(node)?, frame))).collect())
    }

    /// Qᵀ u.
    pub fn turn_in(&self, u: &mut [f64]) {
        for &(k, [a, b]) in &self.0 {
            let (x, y) = (u[k], u[k + 1]);
            (u[k], u[k + 1]) = (a[0] * x + a[1] * y, b[0] * x + b[1] * y);
        }
    }

    /// Q v.
    pub fn turn_back(&self, v: &mut [f64]) {
        for &(k, [a, b]) in &self.0 {
            let (p, q) = (v[k], v[k + 1]);
            (v[k], v[k + 1]) = (a[0] * p + b[0] * q, a[1] * p + b[1] * q);
        }
    }

    /// Qᵀ S Q.
    fn turn(&self, mut s: Mat<f64>) -> Mat<f64> {
        for _ in 0..2 {
            for j in 0..s.ncols() {
                self.turn_in(s.col_as_slice_mut(j));
            }
            s = s.transpose().to_owned();
        }
        s
    }
}

impl System {
    /// Solves with supports and contact on the boundary; `traction` parts the force of a corner between two supports.
    ///
    /// # Errors
    /// A free rigid motion that the loads drive; a matrix without a factor; those of the contact solver.
    pub fn solve(
        self,
        scene: &Scene,
        trace: &GridTrace,
        held: &[Held],
        boundary: Option<ContactBoundary>,
        traction: &CornerMoment<'_>,
        observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
    ) -> Result<Answer, SolveError> {
        let Self { stiffness, load, points, order, at_boundary } = self;
        let GridTrace { mesh, space, .. } = trace;
        let unknown = |dof: usize| 2 * at_boundary[dof / 2] + dof % 2;
        let supports = Supports { space, held };
        let candidates = supports.free_motions(Vec::new());
        let of_load = |motion: &RigidMotion| work(&points, &load, motion);
        let free = unresisted(&points, &load, boundary.as_ref(), &candidates)?;
        let kept: Vec<usize> = boundary.as_ref().map_or(Vec::new(), |b| b.kept().into_iter().map(unknown).collect());
        let (mut fixed, mut values): (Vec<usize>, Vec<f64>) =
            supports.dofs().into_iter().map(|(dof, value)| (unknown(dof), value)).unzip();
        let mut is_held = vec![false; load.len()];
        fixed.iter().for_each(|&u| is_held[u] = true);
        let mut taken = is_held.clone();
        kept.iter().for_each(|&u| taken[u] = true);
        let pinned = pins(&points, &free, &taken);
        fixed.extend(&pinned);
        values.resize(fixed.len(), 0.0);

        observe(Stage::Progress("factorisation", 0.45))?;
        let elimination = Elimination::new(stiffness, &order, &kept, &fixed)?;
        observe(Stage::Progress("solution", 0.55))?;
        let reduced = elimination.reduce(&load, &values);
        let (mut displacement, contact, condensed) = match boundary {
            None => (elimination.expand(&reduced, &[]), None, None),
            Some(boundary) => {
                let (body, of_boundary) = ((&elimination, &reduced), (trace, boundary));
                let solver = scene.method.solver;
                let (displacement, result, condensed) = touching(body, of_boundary, solver, &free, &of_load, observe)?;
                (displacement, Some(result), Some(condensed))
            }
        };
        without_motions((&mut displacement, &points), &mut [], &free);

        let forces = elimination.multiply(&displacement);
        let equations = Equations {
            forces: &forces,
            load: &load,
            displacement: &displacement,
            largest_diagonal: elimination.largest_diagonal(),
            contact: contact.as_ref(),
            tied: &[],
        };
        let (residual, unloaded) = (equations.residual(unknown, |u| is_held[u]), equations.is_unloaded());
        // a rigid motion meets no resistance, unless digits were lost: supports would carry another load than the given one
        let resistance = [0, 1].map(|k| forces.iter().skip(k).step_by(2).sum::<f64>().abs());
        let carried: f64 = forces.iter().map(|f| f.abs()).sum();
        let lost = resistance.iter().any(|r| *r > RESISTING * carried);
        let at_trace: Vec<f64> = (0..space.dofs()).map(|dof| residual.values[unknown(dof)]).collect();
        let of_corner = |e: usize, j: usize| traction(&displacement, e, j);
        let sides = &scene.problem.sides;
        let work = |quantity: &NamedQuantity| {
            let (side, w) = quantity.kind.weighted_side()?;
            let of_contact = contact.as_ref().map_or(0.0, |contact| contact.work(side, &space.points, &w));
            Some(of_contact + supports.work((&at_trace, side), (mesh, sides), of_corner, &w))
        };
        let works = scene.quantities.iter().filter_map(work).collect();
        let reactions = reactions(scene, (&supports, mesh), &at_trace, (contact.as_ref(), Vec::new()), of_corner);
        let contact = contact.map(|c| c.with_equilibrium(residual.relative));
        Ok(Answer {
            energy: dot(&forces, &displacement),
            work: dot(&load, &displacement),
            contact,
            balanced: residual.balanced && (unloaded || !lost),
            reactions,
            works,
            free_motions: free,
            displacement,
            elimination,
            condensed,
        })
    }
}

/// The displacement of a body in contact, and its contact.
fn touching(
    (elimination, reduced): (&Elimination, &ReducedLoad),
    (trace, boundary): (&GridTrace, ContactBoundary),
    solver: Solver,
    free: &[RigidMotion],
    driven: &dyn Fn(&RigidMotion) -> (f64, f64),
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<(Vec<f64>, ContactResult, CondensedContact), SolveError> {
    let frames = Frames::new(&boundary);
    let stiffness = frames.turn(elimination.stiffness()?);
    observe(Stage::Condensed("S_contact", CONTACT, &stiffness))?;
    let mut load = reduced.kept.clone();
    frames.turn_in(&mut load);
    let expand = |v: &[f64]| {
        let mut v = v.to_vec();
        frames.turn_back(&mut v);
        elimination.expand(reduced, &v)
    };
    let body = CondensedBody {
        mesh: &trace.mesh,
        space: &trace.space,
        stiffness: &stiffness.into(),
        load: &load,
        expand: &expand,
        largest_diagonal: elimination.largest_diagonal(),
        free,
        driven,
        judged: true,
        // pins take the motions that the obstacle would make
        liftable: false,
    };
    let solve = &mut |problem: &Problem| solve_problem(problem, solver);
    let (displacement, result, factors) = solve_contact(&body, boundary, solve)?;
    observe(Stage::Contact(&factors.problem, &result.solution))?;
    Ok((displacement, result, CondensedContact { factors, frames }))
}

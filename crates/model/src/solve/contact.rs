//! Contact on one mesh: the condensed problem, its solution, and its reported numbers.

use steklov_algebra::Symmetric;
use steklov_bem_operators::{Mesh, Space};
use steklov_contact::{
    ContactBoundary, ContactError, ContactLine, ContactNode, Decided, Kkt, Least, Problem, Sets, Solution, contraction,
    decided, kkt_in_body, lifting_motion, other_solution,
};
use steklov_elastic::RigidMotion;
use steklov_elastic::plane::dot;
use steklov_problem::Scene;

use crate::data::motions::{edges, unpressed};
use crate::solve::stabilised::StabilisedContact;

/// Contact on the solved mesh.
#[derive(Debug, Clone)]
pub struct ContactResult {
    /// Nodes and conditions.
    pub boundary: ContactBoundary,
    /// The condensed problem's nodes are those of `boundary`; the solver's answer.
    pub solution: Solution,
    /// The judge's measures; equilibrium over all unknowns of the body.
    pub audit: Kkt,
    /// Σ D_i F_i |u_t,i|, under Coulomb's law with F_i = μ λ_n,i.
    pub friction_work: f64,
    /// The answer with stabilised multipliers, if requested: the one that is reported.
    pub stabilised: Option<StabilisedContact>,
    /// The data of Coulomb's law, where it holds.
    pub coulomb: Option<Coulomb>,
    /// How far the obstacle pushes the body off, beyond the displacement of `solution`, whose gaps are larger by that.
    pub lift: Option<RigidMotion>,
}

impl ContactResult {
    /// The solver's answer that is reported.
    pub fn reported(&self) -> &Solution {
        self.stabilised.as_ref().map_or(&self.solution, |s| &s.solution)
    }

    /// The result that reports an answer with stabilised multipliers.
    pub(crate) fn with_stabilised(self, stabilised: StabilisedContact) -> Self {
        let (audit, friction_work) = (stabilised.audit, stabilised.friction_work);
        Self { audit, friction_work, stabilised: Some(stabilised), ..self }
    }

    /// The result with the equilibrium of all unknowns in its audit.
    pub(crate) fn with_equilibrium(mut self, relative: f64) -> Self {
        self.audit.equilibrium = self.audit.equilibrium.max(relative);
        self
    }

    /// Whether the solvers reached their criteria.
    pub fn converged(&self) -> bool {
        self.solution.converged() && self.reported().converged()
    }

    /// Force of the obstacle on the body over one side (force per thickness).
    pub fn force(&self, side: usize) -> [f64; 2] {
        match &self.stabilised {
            Some(s) => s.space.force(side, &s.solution.multipliers),
            None => self.boundary.force(side, &self.solution.multipliers),
        }
    }

    /// Work of the force of the obstacle on the body over a side on a field w; zero with stabilised multipliers.
    pub(crate) fn work(&self, side: usize, points: &[[f64; 2]], w: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
        match self.stabilised {
            Some(_) => 0.0,
            None => self.boundary.work(side, &self.solution.multipliers, points, w),
        }
    }
}

/// A motion that leaves an obstacle slower than this part of its fastest point touches it.
const LEAVING: f64 = 1e-9;

/// How safe a solution under Coulomb's law is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// Factor by which changes of the pressure shrink in the fixed point of Tresca problems; that does not settle from 1 on.
    pub contraction: f64,
    /// Whether another solution was found on the same mesh, or must be expected: a real eigenvalue of the fixed point from 1
    /// on.
    pub several: bool,
}

impl Coulomb {
    fn new(problem: &Problem, solution: &Solution) -> Result<Self, ContactError> {
        let contraction = contraction(problem, solution)?;
        let several = contraction.real >= 1.0 || solution.converged() && other_solution(problem, solution)?.is_some();
        Ok(Self { contraction: contraction.factor, several })
    }
}

/// The condensed contact problem and what its solution says along the edges.
pub struct ContactFactors {
    /// The problem.
    pub problem: Problem,
    /// States of the conditions.
    pub sets: Sets,
    /// The conditions by edges.
    pub lines: Vec<ContactLine>,
}

/// Smallest part of the estimated error that a zone of contact or of a gap has, unless rounding or the error itself makes the
/// zone: where gap and pressure are both 0 up to 0.004 was measured.
const DECIDED: f64 = 0.1;

impl ContactFactors {
    /// The transitions that an error (energy norm) does not explain.
    pub(crate) fn decided(&self, scene: &Scene, solution: &Solution, error: f64) -> Decided {
        let least = |edge: usize| {
            let root = scene.problem.contact_modulus(edge).sqrt();
            let norm = (DECIDED * error).max(f64::MIN_POSITIVE);
            Least { force: norm * root, gap: norm / root }
        };
        decided(&self.lines, &self.problem, solution, &self.sets, &least)
    }

    /// The problem with its solution and these transitions.
    pub(crate) fn solved<'a>(&'a self, solution: &'a Solution, decided: &'a Decided) -> steklov_contact::Solved<'a> {
        let Self { problem, sets, lines } = self;
        steklov_contact::Solved { problem, solution, sets, lines, transitions: &decided.transitions }
    }
}

/// A body with all unknowns eliminated except those of contact.
pub(crate) struct CondensedBody<'a> {
    /// The boundary and its nodes.
    pub(crate) mesh: &'a Mesh,
    pub(crate) space: &'a Space,
    /// S_c, and the reduced load.
    pub(crate) stiffness: &'a Symmetric,
    pub(crate) load: &'a [f64],
    /// All displacements from those of the contact nodes.
    pub(crate) expand: &'a dyn Fn(&[f64]) -> Vec<f64>,
    /// Largest diagonal entry of the whole stiffness matrix.
    pub(crate) largest_diagonal: f64,
    /// Rigid motions that nothing resists and no load drives, and the work of the load on a motion with its scale.
    pub(crate) free: &'a [RigidMotion],
    pub(crate) driven: &'a dyn Fn(&RigidMotion) -> (f64, f64),
    /// Whether the safety of a solution under Coulomb's law is judged.
    pub(crate) judged: bool,
    /// Whether the problem may be solved again with other gaps.
    pub(crate) liftable: bool,
}

/// Solves contact with biorthogonal multipliers: all displacements, and its reported and kept data.
pub(crate) fn solve_contact(
    body: &CondensedBody<'_>,
    boundary: ContactBoundary,
    solve: &mut dyn FnMut(&Problem) -> Result<Solution, ContactError>,
) -> Result<(Vec<f64>, ContactResult, ContactFactors), ContactError> {
    let CondensedBody { mesh, space, stiffness, load, expand, largest_diagonal, free, driven, judged, liftable } =
        *body;
    let nodes = with_free_nodes(&boundary.contact, load.len());
    let mut problem = Problem { stiffness: stiffness.clone(), load: load.to_vec(), nodes };
    let mut solution = solve(&problem)?;
    let mut displacement = expand(&solution.displacement);
    let pressed = |displacement: &[f64], solution: &Solution| {
        let largest = displacement.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        let floor = 1e-6 * largest_diagonal * (largest + boundary.largest_gap());
        unpressed(&space.points, driven, &boundary.nodal_forces(&solution.multipliers), free, floor)
    };
    let mut sets = Sets::new(&problem, &solution)?;
    let mut lift = None;
    if let Err(error) = pressed(&displacement, &solution) {
        let motion = lifting_motion(free, &edges(&boundary)).filter(|_| liftable).ok_or(error)?;
        let largest = displacement.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        let open = 10.0 * (largest + boundary.largest_gap());
        let rates = leaving_rates(&boundary, &motion);
        change_gaps(&mut problem, &rates, |_, gap, _| gap + open);
        solution = solve(&problem)?;
        displacement = expand(&solution.displacement);
        pressed(&displacement, &solution)?;
        // where it touches it does not press: the sets are those of the open gaps
        sets = Sets::new(&problem, &solution)?;
        let mut way: f64 = 0.0;
        change_gaps(&mut problem, &rates, |rate, gap, opening| {
            way = way.max((open - opening(&solution)) / rate);
            gap - open
        });
        change_gaps(&mut problem, &rates, |rate, gap, _| gap + way * rate);
        let RigidMotion { translation: [x, y], rotation, centre } = motion;
        lift = Some(RigidMotion { translation: [way * x, way * y], rotation: way * rotation, centre });
    }
    let friction_work = problem.friction_work(&solution.displacement, &solution.multipliers);
    let coulomb = (judged && problem.is_coulomb()).then(|| Coulomb::new(&problem, &solution)).transpose()?;
    let largest = displacement.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let audit = kkt_in_body(&problem, &solution, largest);
    let lines = boundary.lines(mesh, space);
    boundary.tell_slip(&boundary.relative(&displacement), &mut solution.status);
    let contact = problem.nodes[..boundary.nodes.len()].to_vec();
    let boundary = ContactBoundary { contact, ..boundary };
    let factors = ContactFactors { problem, sets, lines };
    let contact = ContactResult { boundary, solution, audit, friction_work, coulomb, stabilised: None, lift };
    Ok((displacement, contact, factors))
}

/// The contact nodes, and behind them a free one for each unknown that is kept on cuts.
fn with_free_nodes(contact: &[ContactNode], unknowns: usize) -> Vec<ContactNode> {
    let of_contact = contact.iter().map(|node| node.unknowns).sum();
    let free = (of_contact..unknowns).map(|first| ContactNode { first, unknowns: 1, conditions: Vec::new() });
    contact.iter().cloned().chain(free).collect()
}

/// How fast a motion leaves the obstacle at each condition of each node; 0 where it touches on.
fn leaving_rates(boundary: &ContactBoundary, motion: &RigidMotion) -> Vec<Vec<f64>> {
    let rates = boundary.nodes.iter().map(|node| {
        let r = motion.at(node.point);
        node.conditions.iter().map(|c| -dot(r, c.normal)).collect()
    });
    let mut rates: Vec<Vec<f64>> = rates.collect();
    let fastest = rates.iter().flatten().fold(0.0, |m: f64, rate| m.max(*rate));
    rates.iter_mut().flatten().filter(|rate| **rate <= LEAVING * fastest).for_each(|rate| *rate = 0.0);
    rates
}

/// Gives the conditions that a motion leaves the gap of their rate, gap and opening g - u_n in a solution.
fn change_gaps(
    problem: &mut Problem,
    rates: &[Vec<f64>],
    mut gap: impl FnMut(f64, f64, &dyn Fn(&Solution) -> f64) -> f64,
) {
    for (node, rates) in problem.nodes.iter_mut().zip(rates) {
        for k in (0..rates.len()).filter(|&k| rates[k] > 0.0) {
            let opening = |solution: &Solution| node.conditions[k].opening(node.pick(&solution.displacement));
            node.conditions[k].gap = gap(rates[k], node.conditions[k].gap, &opening);
        }
    }
}

//! Contact by stabilised multipliers: an answer of its own beside that of biorthogonal ones on the same mesh.
//!
//! The biorthogonal answer, a hundredth of the cost, tells the refinement and the estimate where contact and stick end;
//! the estimate and the refinement have the difference of the two answers in them.

use faer::Mat;
use steklov_bem_operators::{Dof, TractionMap};
use steklov_contact::{
    ContactError, ContactNode, Kkt, Loading, MultiplierSpace, Solution, StabilisedForms, kkt_in_body,
};

use crate::data::body_load::Particular;
use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::solve::contact_solver::solve_problem;
use crate::stage::Stage;

/// Stabilised multipliers on a solved mesh.
#[derive(Debug, Clone)]
pub struct StabilisedContact {
    /// The multipliers.
    pub space: MultiplierSpace,
    /// Gap, weight and bound of each of their nodes.
    pub nodes: Vec<ContactNode>,
    /// Weighted gap of each node.
    pub gaps: Vec<f64>,
    /// The solver's answer.
    pub solution: Solution,
    /// γ₀ (1/stress) in γ = γ₀ h/p².
    pub gamma: f64,
    /// The largest γ₀ of a coercive form on this mesh.
    pub critical: f64,
    /// The contribution of contact and its stabilisation to S u, for every displacement unknown.
    pub forces: Vec<f64>,
    /// Nodal displacement.
    pub displacement: Vec<f64>,
    /// Σ w_i F_i |u_t,i|.
    pub friction_work: f64,
    /// The judge's measures.
    pub audit: Kkt,
}

/// The equations that a stabilised answer obeys, γ = γ₀ h/p².
pub struct StabilisedSystem<'a> {
    /// B_γ, C_γ, D_γ of γ₀ = 1.
    pub forms: &'a StabilisedForms,
    /// S with that of springs.
    pub stiffness: &'a Mat<f64>,
    /// f of S u.
    pub load: &'a [f64],
    /// Unknowns with a prescribed value.
    pub held: &'a [(Dof, f64)],
    /// τ at the points of the forms, as [`StabilisedForms::particular`] has it: along n and along t.
    pub particular: [Vec<f64>; 2],
    /// The answer.
    pub contact: &'a StabilisedContact,
}

/// γ₀ over its critical value, unless the scene gives γ₀.
pub const SAFE: f64 = 0.5;

/// The matrices of a mesh that the stabilised form needs besides its data.
pub(crate) struct Body<'a> {
    pub(crate) traction: &'a TractionMap,
    /// S.
    pub(crate) stiffness: &'a Mat<f64>,
    pub(crate) load: &'a [f64],
    pub(crate) held: &'a [(Dof, f64)],
    /// Rigid motions that the supports leave, and those of them that nothing resists.
    pub(crate) rigid: &'a [Vec<f64>],
    pub(crate) free: &'a [Vec<f64>],
    pub(crate) particular: Option<&'a Particular>,
}

/// Solves contact with stabilised multipliers.
pub(crate) fn solve_stabilised(
    data: &OnMesh<'_>,
    body: &Body<'_>,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<StabilisedContact, SolveError> {
    let (scene, mesh, method) = (data.scene, data.mesh, &data.scene.method);
    let sides: Vec<usize> = scene.contacts().map(|(side, _)| side).collect();
    let space = MultiplierSpace::new(mesh, &sides, method.multiplier_mesh, method.multiplier_degree)?;
    let forms = StabilisedForms::new(mesh, data.space, &scene.body().material(), body.traction, &space)?;
    let critical = forms.critical_gamma(body.stiffness, body.held, body.rigid)?;
    if !critical.is_finite() {
        return Err(ContactError::Decomposition { size: body.load.len() }.into());
    }
    let gamma = method.gamma.unwrap_or(SAFE * critical);
    let particular = body.particular.map(|p| (&p.solution, p.displacement.as_slice()));
    let loading =
        Loading { stiffness: body.stiffness, load: body.load, held: body.held, motions: body.free, particular };
    let stabilised =
        data.with_contact_data(&[], |sides| forms.condense(mesh, &space, sides, &loading, gamma, critical))?;
    let problem = &stabilised.problem;
    let solution = solve_problem(problem, method.solver)?;
    let displacement = stabilised.displacement(&solution.displacement);
    let forces = forms.nodal_forces(mesh, gamma, &solution.multipliers, &displacement, particular);
    let largest = displacement.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let contact = StabilisedContact {
        audit: kkt_in_body(problem, &solution, largest),
        friction_work: problem.friction_work(&solution.displacement, &solution.multipliers),
        gaps: stabilised.gaps,
        nodes: stabilised.problem.nodes,
        space,
        solution,
        gamma,
        critical,
        forces,
        displacement,
    };
    let Body { stiffness, load, held, .. } = *body;
    let particular = forms.particular(mesh, particular);
    let system = StabilisedSystem { forms: &forms, stiffness, load, held, particular, contact: &contact };
    observe(Stage::Stabilised(&system))?;
    Ok(contact)
}

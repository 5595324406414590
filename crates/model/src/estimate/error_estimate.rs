//! How large the error is, and where: two-level indicators, and the correction of the enriched spaces.
//!
//! ```text
//! bubble residual  ρ_u = f(b) - <λ,b> - <Wu + (K'+½)ψ, b>     η_u² = ρ_uᵀ [W_bb]⁻¹ ρ_u
//! traction residual ρ_ψ = <(K+½)u - Vψ, P_p>                  η_ψ² = ρ_ψᵀ [V_PP]⁻¹ ρ_ψ
//! oscillation       w = g - I_p g, u_D - I_p u_D, u0 - I_p u0 η_g² = E*/2 ‖w‖ ‖dw/ds‖
//! overlap           δ = max (u_n - g) between the nodes        η_g² = E*/2 δ², where it is more than all of the others
//! ```
//! The indicators steer the refinement. The estimate is the geometric mean of their sum and of the energy of e₊, the
//! displacement that S₊ of the enriched spaces adds while the contact sets and the bounds of Coulomb friction stay fixed. For
//! strategies that keep the degree both contain the energy that tractions do not see on linear elements. The energy of the
//! difference between stabilised and biorthogonal multipliers is added. Where both components are held the error is that of
//! the traction alone, which e₊ does not see: the estimate is at least Σ η_ψ² of such elements.
//!
//! Source: Heuer, Mellado and Stephan (2001), two-level hp boundary elements, for the indicators.

use steklov_bem_operators::{Enriched, Mesh, Polygon, SAME_PLACE};
use steklov_contact::{ContactBubble, Frozen, Tip};
use steklov_elastic::Material;
use steklov_elastic::plane::dot;
use steklov_problem::{Indicator, Refine, Scene};

use crate::answer::singular_points::{are_weakly_tied, strong_vertices};
use crate::data::joints::Joint;
use crate::data::on_mesh::OnMesh;
use crate::doubt::Doubt;
use crate::energies::Energies;
use crate::error::SolveError;
use crate::estimate::dual::Duals;
use crate::estimate::elastic::{Elastic, EnrichedBody};
use crate::estimate::enriched_problem::{ENOUGH, Frame, System, frames};
use crate::estimate::enriched_solution;
use crate::estimate::interface_residual::FacingLoad;
use crate::estimate::on_springs::{ROUNDED_TURNING, held_by_springs, turns_too_far};
use crate::estimate::penetration::{Overlap, Unseen};
use crate::estimate::residual::{Residual, knows_residuals};
use crate::estimate::unseen::{unseen_at_vertices, unseen_by_tractions};
use crate::mesh::first_mesh::coarse_elements;
use crate::quantities::EstimatedQuantity;
use crate::solve::body::{Body, Factors};
use crate::solve::equilibrium::UNBALANCED;
use crate::solve::solution::Solved;
use crate::solve::thin::thickness;

/// The part of an estimate on one element; each an energy (force*length/thickness).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bubble {
    /// η_u².
    pub displacement: f64,
    /// η_ψ².
    pub traction: f64,
    /// η_g².
    pub oscillation: f64,
}

impl Bubble {
    /// η².
    pub fn total(&self) -> f64 {
        self.displacement + self.traction + self.oscillation
    }
}

/// Estimate of the error of a solved mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Indicators of the elements.
    pub indicators: Vec<Bubble>,
    /// Indicators of the elements of cuts, of both sides together.
    pub of_cuts: Vec<Bubble>,
    /// Residuals, if they are requested and known; else empty.
    pub residuals: Vec<Residual>,
    /// ⟨S₊e₊, e₊⟩ of the correction e₊ that the enriched spaces add.
    pub correction: f64,
    /// Energy of the transitions that have no vertex of the mesh; of the hp strategy only, the others fit none.
    pub tips: f64,
    /// Estimated ‖u - u_h‖ in the energy norm.
    pub error: f64,
    /// `error` over `scale`.
    pub relative: f64,
    /// (2 strain energy)^½.
    pub scale: f64,
    /// J of the enriched spaces and of the data themselves.
    pub energy: f64,
    /// How far the exact J may be from that.
    pub uncertainty: f64,
    /// What makes the estimate unreliable; empty if nothing does.
    pub doubts: Vec<Doubt>,
    /// The quantities; empty where the enriched spaces have no values.
    pub quantities: Vec<EstimatedQuantity>,
}

/// Error over the geometric mean of η and of the correction, measured: the correction alone sees 0.6 to 0.95 of the error, η,
/// which has the error of the traction in it, is 0.95 to 1.6 of it, and their mean 0.88 to 1.07.
const SATURATION: f64 = 1.03;
/// Loads vary within an element if the part that its degree does not resolve is more than this part of its indicators.
const UNFOLLOWED: f64 = 1e-3;
/// Second-order contribution of held displacements less their interpolants to J, over their η_g²: from 0 to ½.
const HELD_REST: f64 = 0.25;
/// How far the extrapolated J may be off, over the squared error: for an error estimated as 0.58 of its size, and as 0.47 with
/// contact. In 1,100 scenes with narrow data up to 0.8 and 1.7 were measured; 4 of them need more than half of that.
pub(crate) const OF_SQUARE: f64 = 1.0;
const OF_SQUARE_WITH_CONTACT: f64 = 1.75;
/// How far J may be off under Coulomb's law, over the error times (2 friction work)^½: up to 0.025 was measured. J is not
/// stationary there, as the bounds of friction are those of the approximate pressure.
pub(crate) const NOT_STATIONARY: f64 = 0.06;
/// Largest part of the squared estimate for the loads that the elements' degrees do not resolve.
pub const UNRESOLVED: f64 = 0.25;
/// Next to a singular point e_p falls like p^-2λ: beyond this degree a bubble shows less than half of the error.
const SLOW: usize = 8;
const SLOW_PART: f64 = 0.1;
/// Length of an element over the thickness of the body there, in the mean with the indicators as weights: beyond this the
/// bubbles of both faces act against each other and show less than 0.8 of the error.
const SLENDER: f64 = 4.0;
/// Relative error (energy norm) below which rounding decides.
pub const ROUNDOFF: f64 = 1e-7;

/// Unknowns of a single mesh beyond which the estimate is left out: it takes up to six times the time and three times the
/// memory of the solution.
const LARGEST_SINGLE: usize = 4000;

/// Overlaps of a depth δ with (E*/2)^½ δ below this part of the tolerance, or of the error that the indicators show, do not
/// count.
const LEAST_OVERLAP: f64 = 0.025;
/// Those below this part of displacements and gaps are roundoff.
const ROUNDED_OVERLAP: f64 = 1e-12;
/// Rounding error of J, as a part of twice the strain energy (up to 9e-13 was seen between meshes graded to corners), and as a
/// part of the largest stiffness of a node times its displacement squared; for several bodies 2.3e-12 and 4e-15 were seen.
const ROUNDED: [f64; 2] = [1e-12, 1e-15];
const ROUNDED_OF_SEVERAL: [f64; 2] = [3e-12, 5e-15];

/// Whether residuals are computed.
pub(crate) fn has_residuals(scene: &Scene) -> bool {
    scene.method.has_residuals() && knows_residuals(scene)
}

/// Whether the error is estimated on meshes of `dofs` unknowns.
pub fn is_estimated(scene: &Scene, dofs: usize) -> bool {
    scene.method.refine != Refine::None || dofs <= LARGEST_SINGLE
}

/// Estimates the error of a solved mesh whose vertices at transitions are `tips`, transitions of contact and stick left out, and returns
/// what its nodes do not show.
///
/// # Errors
/// Data that are not finite.
pub fn estimate(
    (scene, tips): (&Scene, &[Tip]),
    solved: &Solved,
    body: &Body,
    enriched: &EnrichedBody,
    factors: &Factors,
) -> Result<(Estimate, Unseen), SolveError> {
    let Solved { mesh, space, .. } = solved;
    let elastic = Elastic::new(enriched, factors);
    let data = OnMesh { scene, mesh, space };
    let bubbles = match (&solved.contact, &factors.contact) {
        (Some(contact), Some(part)) => data.contact_bubbles(&contact.boundary, &part.sets, &solved.particular)?,
        _ => Vec::new(),
    };
    let closed: Vec<usize> = bubbles.iter().filter(|b| !b.free[0]).map(|b| b.element).collect();
    let facing = data.facing_loads(&body.joints, solved.elastic_field(), &bubbles);
    let frames = frames(&data, elastic.elements(), &bubbles, &facing);
    let residual = bubble_residual(&data, factors, &elastic, &bubbles, &facing);
    let of_springs = body.springs.bubble_blocks(elastic.elements());
    let (mut indicators, held_oscillation) =
        indicators(&data, solved, &elastic, (&bubbles, &frames), (&residual, &of_springs))?;
    let of_cuts = indicators.split_off(mesh.len());
    let scale = scale(&solved.energies, body, factors);
    let nonconformity = data.nonconformity(&body.joints, solved.elastic_field(), &bubbles);
    for &(e, energy) in data.tie_oscillation(&body.joints)?.iter().chain(&nonconformity.energies(&data)) {
        indicators[e].oscillation += energy;
    }
    let overlaps = hidden_overlaps(&data, (solved, &body.joints), scale, &closed, &mut indicators);
    // residuals do not cover subdomains
    let whole = !solved.field.is_cut();
    let residuals = if whole && has_residuals(scene) { data.all_residuals(solved)? } else { Vec::new() };

    let frozen = factors.contact.as_ref().map(|c| Frozen::new(&c.problem, &c.sets)).transpose()?;
    let system = System {
        condensation: &body.condensation,
        elastic: &elastic,
        frozen: frozen.as_ref(),
        frames: &frames,
        springs: &body.springs,
        space: &body.space,
        blocks: (0..frames.len()).map(|e| sum(elastic.stiffness_block(e), of_springs[e])).collect(),
    };
    let (gained, right) = right_side(&elastic, &residual);
    let (squared, correction, _) = system.correction(&right, ENOUGH);
    let duals = Duals::new(&data, (solved, body), &system, &of_springs, &residual);
    let (quantities, ends) = enriched_solution::both((&data, tips), solved, factors, &duals, &bubbles, &right)?;

    let held = held_tractions(scene, solved, &elastic, &indicators, (&frames, &of_springs));
    let unseen = unseen_of(scene, solved, factors, &indicators, &correction);
    let all: Vec<Bubble> = indicators.iter().chain(&of_cuts).copied().collect();
    let error = combined_error(&all, squared, unseen, held, factors.difference);
    let of_nodes = (gained, squared, HELD_REST * held_oscillation);
    let [energy, uncertainty] = extrapolated(
        &data,
        (solved, &bubbles),
        (body, factors),
        of_nodes,
        nonconformity.work(solved.elastic_field()),
        (error, scale),
    )?;
    let unresolved = unresolved(&data, solved, factors, &bubbles)?;
    let mut doubts = doubts(scene, solved, (&unresolved, &overlaps), error);
    doubts.extend((error > ROUNDOFF * scale && are_weakly_tied(scene)).then_some(Doubt::Coarse));
    doubts.extend(turns_too_far(solved, body).then_some(Doubt::Roundoff));
    let relative = ratio(error, scale);
    let correction = squared;
    let estimate = Estimate {
        indicators,
        of_cuts,
        residuals,
        correction,
        tips: 0.0,
        error,
        relative,
        scale,
        energy,
        uncertainty,
        doubts,
        quantities,
    };
    Ok((estimate, Unseen { overlaps, unresolved, ends }))
}

/// J of the enriched spaces and of the data themselves, and how far the exact J may be from that. S₊ gains (`gained` - `squared`)/2 on the
/// nodes, and the rests of held displacements have some more; `error` and `scale` are those of the estimate.
fn extrapolated(
    data: &OnMesh<'_>,
    (solved, bubbles): (&Solved, &[ContactBubble]),
    (body, factors): (&Body, &Factors),
    (gained, squared, of_rests): (f64, f64, f64),
    nonconformity: f64,
    (error, scale): (f64, f64),
) -> Result<[f64; 2], SolveError> {
    let of_jump = solved.around.as_ref().map_or(Ok(0.0), |around| data.jump_work(around))?;
    let friction = data.friction_work_left(solved, factors)?;
    let turning = data.turning_work(solved, body, &factors.homogeneous);
    let on_springs = body.springs.work_on_rest(data, &solved.displacement, &solved.particular);
    let of_data = of_jump
        + data.held_work(solved, factors, bubbles)?
        + of_rests
        + friction
        + nonconformity
        + turning
        + on_springs;
    let extrapolation = 0.5 * (gained - squared);
    let energy = factors.energy + of_data + extrapolation;
    if !error.is_finite() || !energy.is_finite() {
        return Err(SolveError::NotFinite { energy });
    }
    let coulomb = solved.contact.as_ref().is_some_and(|c| c.coulomb.is_some());
    let bounds = if coulomb { NOT_STATIONARY * error * (2.0 * solved.energies.friction_work).sqrt() } else { 0.0 };
    let of_square = if solved.contact.is_some() { OF_SQUARE_WITH_CONTACT } else { OF_SQUARE };
    let first_order = extrapolation.abs() + of_jump.abs() + nonconformity.abs() + turning.abs();
    let uncertainty = 0.5 * first_order + friction.abs() + of_square * error * error + bounds;
    Ok([energy, uncertainty.max(rounding_of_energy(solved, body, scale))])
}

/// The gain of J of the nodes by S₊, and r = f₊ - S₊(u, 0).
fn right_side(elastic: &Elastic<'_>, residual: &[f64]) -> (f64, Enriched) {
    let (excess, gained) = elastic.excess();
    let force = elastic.bubble_force();
    let r = Enriched {
        base: excess.base.iter().map(|s| -s).collect(),
        extra: residual.iter().zip(&force).zip(&excess.extra).map(|((r, f), s)| r + f - s).collect(),
    };
    (gained, r)
}

/// ρ_u, with the forces of contact and other bodies on the bubbles.
fn bubble_residual(
    data: &OnMesh<'_>,
    factors: &Factors,
    elastic: &Elastic<'_>,
    bubbles: &[ContactBubble],
    facing: &[FacingLoad],
) -> Vec<f64> {
    let mut residual: Vec<f64> = factors.extra_load.iter().zip(elastic.bubble_force()).map(|(f, s)| f - s).collect();
    for bubble in bubbles {
        let (e, [n, t]) = (bubble.element, data.contact_frame(bubble.element));
        // a closed bubble's residual along n is ∫λ_n b; against another body it is the force with which that pushes back
        let pressure = match facing.iter().find(|of| of.element == e) {
            Some(of) => -dot(of.load, n),
            None => residual[2 * e] * n[0] + residual[2 * e + 1] * n[1],
        };
        let shear = bubble.load[1] - bubble.coupling * pressure;
        for i in 0..2 {
            residual[2 * e + i] += bubble.load[0] * n[i] + shear * t[i];
        }
    }
    for FacingLoad { element: e, load, share } in facing {
        let [n, t] = data.contact_frame(*e);
        let own = [residual[2 * e], residual[2 * e + 1]];
        let slides = bubbles.iter().any(|b| b.element == *e) && share[1].is_none();
        let along =
            |d: [f64; 2], share: f64, load: [f64; 2]| share * ((own[0] + load[0]) * d[0] + (own[1] + load[1]) * d[1]);
        // the carrying side of a slip has its friction already
        let tangential = along(t, share[1].unwrap_or(1.0), if slides { [0.0; 2] } else { *load });
        let normal = along(n, share[0].unwrap_or(1.0), *load);
        (0..2).for_each(|i| residual[2 * e + i] = normal * n[i] + tangential * t[i]);
    }
    residual
}

/// η_u², η_ψ² and η_g² of the elements, overlaps left out, and the sum of the η_g² of held displacements.
fn indicators(
    data: &OnMesh<'_>,
    solved: &Solved,
    elastic: &Elastic<'_>,
    (bubbles, frames): (&[ContactBubble], &[Frame]),
    (residual, springs): (&[f64], &[[[f64; 2]; 2]]),
) -> Result<(Vec<Bubble>, f64), SolveError> {
    let modulus = |e: usize| data.material_of(e).plane_modulus();
    let tractions = elastic.traction_indicators();
    let of = |e: usize| Bubble {
        displacement: frames[e]
            .energy(sum(elastic.hypersingular_block(e), springs[e]), [residual[2 * e], residual[2 * e + 1]]),
        traction: tractions[e],
        oscillation: 0.0,
    };
    let mut indicators: Vec<Bubble> = (0..elastic.elements()).map(of).collect();
    for bubble in bubbles {
        indicators[bubble.element].oscillation +=
            data.scene.problem.contact_modulus(data.mesh.edge[bubble.element]) / 2.0 * bubble.oscillation;
    }
    let mut held = 0.0;
    for (e, oscillation) in data.held_oscillation(&solved.particular)? {
        indicators[e].oscillation += modulus(e) / 2.0 * oscillation;
        held += modulus(e) / 2.0 * oscillation;
    }
    for (e, oscillation) in data.oscillation_on_springs(&solved.particular)? {
        let part = held_by_springs(elastic.hypersingular_block(e), springs[e]);
        indicators[e].oscillation += part * modulus(e) / 2.0 * oscillation;
    }
    for (e, oscillation) in data.jump_oscillation()? {
        indicators[e].oscillation += oscillation;
    }
    Ok((indicators, held))
}

/// Σ η_ψ² of the elements whose components are both held, or practically held by springs; at least the value of the medium.
fn held_tractions(
    scene: &Scene,
    solved: &Solved,
    elastic: &Elastic<'_>,
    indicators: &[Bubble],
    (frames, springs): (&[Frame], &[[[f64; 2]; 2]]),
) -> f64 {
    let weight = |e: usize| match frames[e].free {
        [false, false] => 1.0,
        _ => held_by_springs(elastic.hypersingular_block(e), springs[e]).powi(4),
    };
    // an indicator that is not finite is not to vanish in a product with 0
    let weighted =
        indicators.iter().enumerate().map(|(e, i)| (weight(e), i.traction)).filter(|(weight, _)| *weight > 0.0);
    let held: f64 = weighted.map(|(weight, traction)| weight * traction).sum();
    let moduli =
        solved.around.as_ref().map(|around| [&scene.body().material(), &around.material].map(Material::plane_modulus));
    held.max(elastic.held_tractions(moduli))
}

/// The energy that is not seen next to vertices whose stresses grow fast; and, for strategies that keep the degree, the energy
/// that tractions do not see, where loads do not vary within elements.
fn unseen_of(scene: &Scene, solved: &Solved, factors: &Factors, indicators: &[Bubble], correction: &Enriched) -> f64 {
    let seen = |e: usize| indicators[e].displacement + indicators[e].traction;
    let at_vertices = unseen_at_vertices(&solved.mesh, &strong_vertices(scene), &seen);
    if matches!(scene.method.refine, Refine::Hp | Refine::HpDecay) {
        return at_vertices;
    }
    let materials: Vec<Material> =
        std::iter::once(scene.body().material()).chain(solved.around.as_ref().map(|around| around.material)).collect();
    let modulus = scene.body().material().plane_modulus();
    let varies = |e: usize| factors.unresolved[e] > UNFOLLOWED * modulus * indicators[e].total();
    at_vertices + unseen_by_tractions(&solved.mesh, correction, &materials, &varies)
}

/// The error: the geometric mean of the correction and of η without oscillation, at least that of the `held`, plus the
/// oscillations and the `difference` of multipliers.
fn combined_error(indicators: &[Bubble], correction: f64, unseen: f64, held: f64, difference: f64) -> f64 {
    let oscillation: f64 = indicators.iter().map(|i| i.oscillation).sum();
    let two_level: f64 = indicators.iter().map(|i| i.displacement + i.traction).sum();
    // the product of two energies may leave the range of floating point
    let mean = (correction + unseen).sqrt() * (two_level + unseen).sqrt();
    (SATURATION.powi(2) * mean.max(held) + oscillation + difference).sqrt()
}

/// The part of loads and bounds that the degree does not resolve, for each element.
fn unresolved(
    data: &OnMesh<'_>,
    solved: &Solved,
    factors: &Factors,
    bubbles: &[ContactBubble],
) -> Result<Vec<f64>, SolveError> {
    let mut unresolved = factors.unresolved.clone();
    let pressure = solved
        .contact
        .as_ref()
        .map_or(0.0, |c| c.reported().multipliers.iter().fold(0.0, |m: f64, [pressure, _]| m.max(*pressure)));
    let slips = |e: usize| bubbles.iter().any(|b| b.element == e && b.free[1]);
    data.add_unresolved_bounds(&mut unresolved, pressure, &slips)?;
    Ok(unresolved)
}

/// The doubts about the data, about overlaps and about Coulomb's law.
fn doubts(scene: &Scene, solved: &Solved, (unresolved, overlaps): (&[f64], &[Overlap]), error: f64) -> Vec<Doubt> {
    let part: f64 = unresolved.iter().sum();
    let of_data = part > scene.body().material().plane_modulus() * UNRESOLVED * error * error;
    let several = solved.contact.as_ref().and_then(|c| c.coulomb).is_some_and(|c| c.several);
    let found = [
        (Doubt::Data, of_data || overlaps.iter().any(|o| !o.known)),
        (Doubt::Sets, overlaps.iter().any(|o| o.known)),
        (Doubt::Several, several),
    ];
    found.into_iter().filter(|(_, is)| *is).map(|(doubt, _)| doubt).collect()
}

/// Adds the energies of overlaps that are more than the indicators of their elements, and returns these overlaps. The
/// variation of a gap between the nodes of closed elements counts as their oscillation.
fn hidden_overlaps(
    data: &OnMesh<'_>,
    (solved, joints): (&Solved, &[Joint]),
    scale: f64,
    closed: &[usize],
    indicators: &mut [Bubble],
) -> Vec<Overlap> {
    let Some(contact) = &solved.contact else { return Vec::new() };
    let modulus = |e: usize| data.scene.problem.contact_modulus(solved.mesh.edge[e]);
    let moved = solved.displacement.iter().fold(contact.boundary.largest_gap(), |m, u| m.max(u.abs()));
    let found = indicators.iter().map(Bubble::total).sum::<f64>().sqrt();
    let wanted = LEAST_OVERLAP * (data.scene.method.tolerance() * scale).max(found);
    let least = |e: usize| (wanted * (2.0 / modulus(e)).sqrt()).max(ROUNDED_OVERLAP * moved);
    let mut overlaps = data.overlaps(&contact.boundary, joints, &solved.displacement, &least, closed);
    let mut energies = vec![0.0; indicators.len()];
    for overlap in &overlaps {
        energies[overlap.element] += modulus(overlap.element) / 2.0 * overlap.depth * overlap.depth;
    }
    overlaps.retain(|o| energies[o.element] > indicators[o.element].total());
    for e in 0..indicators.len() {
        if energies[e] > indicators[e].total() {
            indicators[e].oscillation += energies[e];
        }
    }
    overlaps
}

impl Estimate {
    /// η² of each element: what steers the refinement.
    pub fn squared(&self, indicator: Indicator) -> Vec<f64> {
        if indicator == Indicator::Bubble {
            self.indicators.iter().map(Bubble::total).collect()
        } else {
            let of = |(b, r): (&Bubble, &Residual)| r.boundary.total() + r.contact.total() + b.oscillation;
            self.indicators.iter().zip(&self.residuals).map(of).collect()
        }
    }

    /// Whether an element may have much more error than its bubble shows: between two singular points, of high degree next to
    /// one with a good part of the estimate, or, where the estimate is, longer than the body is thick.
    pub(crate) fn is_coarse(&self, outline: &Polygon, mesh: &Mesh, singular: &[Vec<f64>]) -> bool {
        let total: f64 = self.indicators.iter().map(Bubble::total).sum();
        let touches = |e: usize| {
            let points = &singular[mesh.edge[e]];
            points.iter().any(|p| mesh.span[e].iter().any(|s| (s - p).abs() < SAME_PLACE))
        };
        let slow = |e: usize| mesh.degree[e] > SLOW && self.indicators[e].total() > SLOW_PART * total && touches(e);
        let body_of = |e: usize| outline.body_of_loop(outline.edges()[mesh.edge[e]].loop_index);
        let bodies: Vec<usize> = (0..mesh.len()).map(body_of).collect();
        let slender: f64 =
            (0..mesh.len()).map(|e| self.indicators[e].total() * mesh.length(e) / thickness(mesh, &bodies, e)).sum();
        !coarse_elements(mesh, singular).is_empty() || (0..mesh.len()).any(slow) || slender > SLENDER * total
    }

    /// Adds a doubt if rounding errors dominate: if the error is down at their size, or if forces do not balance.
    pub(crate) fn add_roundoff(&mut self, solved: &Solved) {
        let unbalanced = solved.contact.as_ref().is_some_and(|c| c.converged() && c.audit.equilibrium > UNBALANCED);
        if self.relative < ROUNDOFF || unbalanced {
            self.doubts.push(Doubt::Roundoff);
        }
    }
}

fn sum(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i][j] + b[i][j]))
}

pub(crate) fn ratio(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

/// Rounding error of J: of the energy itself, and of the forces S u of displacements that mostly cancel.
fn rounding_of_energy(solved: &Solved, body: &Body, scale: f64) -> f64 {
    let largest = body.settled(&solved.displacement).iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let [energy, forces] = if body.pieces.len() > 1 { ROUNDED_OF_SEVERAL } else { ROUNDED };
    let forces = if body.springs.is_empty() { forces } else { ROUNDED_TURNING };
    let stored = energy * scale * scale + energy * 2.0 * solved.energies.springs;
    stored.max(forces * body.largest_diagonal * largest * largest)
}

/// Strain energies below this part of that of springs are roundoff.
const OF_SPRINGS: f64 = 1e-14;

/// (2 strain energy)^½; where there is no strain, that of roundoff.
fn scale(energies: &Energies, body: &Body, factors: &Factors) -> f64 {
    let largest = factors.homogeneous.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let floor = (1e-20 * body.largest_diagonal * largest * largest).max(OF_SPRINGS * 2.0 * energies.springs);
    (2.0 * energies.strain).max(floor).sqrt()
}

#[cfg(test)]
mod tests {
    use steklov_bem_operators::Loop;

    use super::*;

    /// A channel: its legs and its web are of thickness 1, 2 and 0.5, and the distance across the open part does not count.
    #[test]
    fn a_body_is_as_thick_as_it_is_across_its_inside() {
        let corners = [[0.0, 0.0], [6.0, 0.0], [6.0, 9.0], [4.0, 9.0], [4.0, 0.5], [3.8, 0.5], [3.8, 9.0], [2.8, 9.0]];
        let corners: Vec<[f64; 2]> = corners.into_iter().chain([[2.8, 0.5], [0.0, 0.5]]).collect();
        let sides = (0..corners.len()).map(|k| format!("side {k}")).collect();
        let polygon = Polygon::new(Loop::straight(corners, sides), Vec::new()).unwrap();
        let mesh = Mesh::uniform(&polygon, 21, 1);
        // (edge, thickness): right face of the right leg, faces of the slot, left face of the other leg
        for (edge, thick) in [(1, 2.0), (3, 2.0), (5, 1.0), (7, 1.0)] {
            let on_edge: Vec<usize> = (0..mesh.len()).filter(|&e| mesh.edge[e] == edge).collect();
            let middle = on_edge[on_edge.len() / 2];
            assert!(
                (thickness(&mesh, &vec![0; mesh.len()], middle) - thick).abs() < 1e-12,
                "{edge}: {}",
                thickness(&mesh, &vec![0; mesh.len()], middle)
            );
        }
    }
}

//! How large the error is, and where: two-level indicators, and the correction of the enriched spaces.
//!
//! ```text
//! bubble residual  ρ_u = f(b) - <λ,b> - <Wu + (K'+½)ψ, b>     η_u² = ρ_uᵀ [W_bb]⁻¹ ρ_u
//! traction residual ρ_ψ = <(K+½)u - Vψ, P_p>                  η_ψ² = ρ_ψᵀ [V_PP]⁻¹ ρ_ψ
//! oscillation       w = g - I_p g, u_D - I_p u_D, u0 - I_p u0 η_g² = E*/2 ‖w‖ ‖dw/ds‖
//! overlap           δ = max (u_n - g) between the nodes        η_g² = E*/2 δ², where it is more than all of the others
//! ```
//! The indicators steer the refinement. The estimate is the geometric mean of their sum and of the energy of e₊, the
//! displacement that S₊ of the enriched spaces adds with the contact sets, and the bounds of Coulomb friction, as they are, both,
//! with strategies that keep the degree, with what tractions do not see of linear elements; that and the energy in which stabilised multipliers differ from biorthogonal ones. Where both components are held the error is
//! that of the traction alone, which e₊ does not see: the estimate is at least Σ η_ψ² of such elements.

use steklov_bem_operators::{BoundaryResidual, Condensation, Enriched, Look, Material, Mesh, SAME_PLACE};
use steklov_contact::{ContactBubble, ContactResidual, Frozen, Located, TipKind};

use crate::adapt::{coarse_elements, singular_points};
use crate::body::{Body, Factors, UNBALANCED};
use crate::data::Data;
use crate::elastic::{Elastic, EnrichedBody, plane_modulus};
use crate::hidden::{Overlap, Unseen};
use crate::scene::{Condition, Indicator, Refine, Scene};
use crate::solve::{SolveError, Solved};
use crate::unseen::unseen_by_tractions;

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

/// The residual indicator of one element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residual {
    /// What is left of the boundary equations.
    pub boundary: BoundaryResidual,
    /// What is left of the contact conditions.
    pub contact: ContactResidual,
}

impl Residual {
    /// η².
    pub fn total(&self) -> f64 {
        self.boundary.total() + self.contact.total()
    }
}

/// Estimate of the error of a solved mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Indicators of the elements.
    pub indicators: Vec<Bubble>,
    /// Residual indicators, where these are asked for; else empty.
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
}

/// Why an estimate is not to be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// A transition of contact or stick lies inside an element: the frozen sets hide its error.
    Transition,
    /// The contact sets are still changing from mesh to mesh.
    Sets,
    /// The mesh is too coarse about singular points for one bubble an element to show the error: an element lies between two of
    /// them, where its error may have the other parity, or one next to them is of high degree, where the next one adds
    /// little. Or elements are longer than the body is thick there.
    Coarse,
    /// The loads vary within elements more than their degree follows: no bubble sees what they do.
    Data,
    /// Coulomb's law has several solutions on this mesh: another was found, or the fixed point leaves this one along a direction.
    Several,
    /// The error is down at rounding errors, or forces are out of balance by more than rounding may do.
    Roundoff,
    /// Outcomes of random input show contact, slip or data that the points at which it is solved do not.
    Outcomes,
}

impl Doubt {
    /// The word of the JSON object.
    pub fn word(self) -> &'static str {
        match self {
            Self::Transition => "transition",
            Self::Sets => "sets",
            Self::Coarse => "coarse",
            Self::Data => "data",
            Self::Several => "several",
            Self::Roundoff => "roundoff",
            Self::Outcomes => "outcomes",
        }
    }
}

/// Error over the geometric mean of η and of the correction, measured: the correction alone sees 0.6 to 0.95 of the error, η,
/// which has the error of the traction in it, is 0.95 to 1.6 of it, and their mean 0.88 to 1.07.
const SATURATION: f64 = 1.03;
/// Loads vary within an element if what its degree leaves of them is more than this part of its indicators.
const UNFOLLOWED: f64 = 1e-3;
/// What held displacements less their interpolants add to J beyond the first order, over their η_g²: from 0 to ½.
const HELD_REST: f64 = 0.25;
/// How far J may be off under Coulomb's law, over the error times (2 friction work)^½: up to 0.025 was measured. J is not
/// stationary there, as the bounds of friction are those of the approximate pressure.
const NOT_STATIONARY: f64 = 0.06;
/// Energy of a tip that is off by δ: 0.3 E* B² |δ|³.
const TIP: f64 = 0.3;
/// A tip farther from its vertex than this part of its edge, or a contact end farther than this part of the zone beside it:
/// the contact sets are not those of the solution yet.
const FAR: f64 = 0.006;
const FAR_IN_ZONE: f64 = 0.025;
/// Energy norm that vertices off their transitions may cost by themselves, over the estimated error, beyond which that is in
/// doubt.
const UNDONE: f64 = 10.0;
/// Part of the squared estimate from which on energies of transitions that are not where they were believed to be count.
const MATTERS: f64 = 0.05;
/// Part of the squared estimate that loads may have between the points that the elements' degrees follow.
pub const UNRESOLVED: f64 = 0.25;
/// Next to a singular point e_p falls like p^-2λ: beyond this degree a bubble shows less than half of the error.
const SLOW: usize = 8;
const SLOW_PART: f64 = 0.1;
/// Length of an element over the thickness of the body there, in the mean with the indicators as weights: beyond this the
/// bubbles of both faces act against each other and show less than 0.8 of the error.
const SLENDER: f64 = 4.0;
/// Relative error (energy norm) below which rounding decides.
pub const ROUNDOFF: f64 = 1e-7;
/// Reduction of the squared energy of the rest at which the correction is good enough.
const ENOUGH: f64 = 1e-4;
/// Steps of conjugate gradients at most.
const STEPS: usize = 40;

/// Unknowns of a single mesh beyond which the estimate is left out: it takes up to six times the time and three times the
/// memory of the solution.
const LARGEST_SINGLE: usize = 4000;

/// Overlaps of a depth δ with (E*/2)^½ δ below this part of the tolerance, or of what indicators have found, do not count.
const LEAST_OVERLAP: f64 = 0.025;
/// Those below this part of displacements and gaps are roundoff.
const ROUNDED: f64 = 1e-12;

/// Whether meshes of so many unknowns are estimated.
pub fn is_estimated(scene: &Scene, dofs: usize) -> bool {
    scene.method.refine != Refine::None || dofs <= LARGEST_SINGLE
}

/// Estimates the error of a solved mesh, transitions of contact and stick left out, and tells what its nodes do not
/// show.
///
/// # Errors
/// Data that are not finite.
pub fn estimate(
    scene: &Scene,
    solved: &Solved,
    (body, enriched): (&Body, &EnrichedBody),
    factors: &Factors,
) -> Result<(Estimate, Unseen), SolveError> {
    let Solved { mesh, space, .. } = solved;
    let elastic = Elastic::new(enriched, factors);
    let modulus = plane_modulus(&scene.material);
    let data = Data { scene, mesh, space };
    let bubbles = match (&solved.contact, &factors.contact) {
        (Some(contact), Some(part)) => {
            data.contact_bubbles(&contact.boundary, &part.sets, solved.particular.as_ref())?
        }
        _ => Vec::new(),
    };
    let frames = frames(scene, mesh, &bubbles);
    let force = elastic.bubble_force();
    let mut residual: Vec<f64> = factors.extra_load.iter().zip(&force).map(|(f, s)| f - s).collect();
    for bubble in &bubbles {
        let (e, n, t) = (bubble.element, mesh.normal(bubble.element), mesh.tangent[bubble.element]);
        // a closed bubble's residual along n is ∫λ_n b
        let pressure = residual[2 * e] * n[0] + residual[2 * e + 1] * n[1];
        let shear = bubble.load[1] - bubble.coupling * pressure;
        for i in 0..2 {
            residual[2 * e + i] += bubble.load[0] * n[i] + shear * t[i];
        }
    }
    let tractions = elastic.traction_indicators(mesh.len());
    let mut indicators = Vec::with_capacity(mesh.len());
    for e in 0..mesh.len() {
        let rho = [residual[2 * e], residual[2 * e + 1]];
        indicators.push(Bubble {
            displacement: frames[e].energy(elastic.hypersingular_block(e), rho),
            traction: tractions[e],
            oscillation: 0.0,
        });
    }
    for bubble in &bubbles {
        indicators[bubble.element].oscillation += modulus / 2.0 * bubble.oscillation;
    }
    let mut held_oscillation = 0.0;
    for (e, oscillation) in data.held_oscillation(solved.particular.as_ref())? {
        indicators[e].oscillation += modulus / 2.0 * oscillation;
        held_oscillation += modulus / 2.0 * oscillation;
    }

    for (e, oscillation) in data.jump_oscillation()? {
        indicators[e].oscillation += oscillation;
    }

    let scale = scale(solved.energies.strain, body, factors);
    let closed: Vec<usize> = bubbles.iter().filter(|b| !b.free[0]).map(|b| b.element).collect();
    let overlaps = hidden_overlaps(&data, solved, (scale, modulus), &closed, &mut indicators);

    let residuals = match scene.method.indicator {
        Indicator::Bubble => Vec::new(),
        Indicator::Residual => data.residuals(solved, 0..solved.mesh.len(), Look::Close)?,
    };

    // the enriched problem: r = f₊ - S₊(u, 0)
    let (excess, gained) = elastic.excess();
    let r = Enriched {
        base: excess.base.iter().map(|s| -s).collect(),
        extra: residual.iter().zip(&force).zip(&excess.extra).map(|((r, f), s)| r + f - s).collect(),
    };
    let frozen = factors.contact.as_ref().map(|c| Frozen::new(&c.problem, &c.sets)).transpose()?;
    let system = System {
        condensation: &body.condensation,
        elastic: &elastic,
        frozen: frozen.as_ref(),
        frames: &frames,
        blocks: (0..mesh.len()).map(|e| elastic.stiffness_block(e)).collect(),
    };
    let (squared, correction) = system.correction(&r);

    let oscillation: f64 = indicators.iter().map(|i| i.oscillation).sum();
    let two_level: f64 = indicators.iter().map(|i| i.displacement + i.traction).sum();
    let held: f64 = indicators.iter().zip(&frames).filter(|(_, f)| f.free == [false; 2]).map(|(i, _)| i.traction).sum();
    let moduli = solved.around.as_ref().map(|around| [modulus, plane_modulus(&around.material)]);
    let held = held.max(elastic.held_tractions(mesh.len(), moduli));
    let materials: Vec<Material> =
        std::iter::once(scene.material).chain(solved.around.as_ref().map(|around| around.material)).collect();
    let hp = matches!(scene.method.refine, Refine::Hp | Refine::HpDecay);
    let varies = |e: usize| factors.unresolved[e] > UNFOLLOWED * modulus * indicators[e].total();
    let unseen = if hp { 0.0 } else { unseen_by_tractions(mesh, &correction, &materials, &varies) };
    // the product of two energies may leave the range of floating point
    let mean = (squared + unseen).sqrt() * (two_level + unseen).sqrt();
    let error = (SATURATION.powi(2) * mean.max(held) + oscillation + factors.difference).sqrt();
    let energies = &solved.energies;
    let of_jump = solved.around.as_ref().map_or(Ok(0.0), |around| data.jump_work(around))?;
    let friction = data.friction_work_left(solved, factors)?;
    let of_data = of_jump + data.held_work(solved)? + HELD_REST * held_oscillation + friction;
    let extrapolation = 0.5 * (gained - squared);
    let energy = factors.energy + of_data + extrapolation;
    if !error.is_finite() || !energy.is_finite() {
        return Err(SolveError::NotFinite { energy });
    }
    let coulomb = solved.contact.as_ref().is_some_and(|c| c.coulomb.is_some());
    let bounds = if coulomb { NOT_STATIONARY * error * (2.0 * energies.friction_work).sqrt() } else { 0.0 };
    let uncertainty = 0.5 * (extrapolation.abs() + of_jump.abs()) + friction.abs() + 0.4 * error * error + bounds;
    let mut unresolved = factors.unresolved.clone();
    let pressure = solved
        .contact
        .as_ref()
        .map_or(0.0, |c| c.reported().multipliers.iter().fold(0.0, |m: f64, [pressure, _]| m.max(*pressure)));
    let slips = |e: usize| bubbles.iter().any(|b| b.element == e && b.free[1]);
    data.add_unresolved_bounds(&mut unresolved, pressure, &slips)?;
    let part: f64 = unresolved.iter().sum();
    let several = solved.contact.as_ref().and_then(|c| c.coulomb).is_some_and(|c| c.several);
    let mut doubts = Vec::new();
    if part > modulus * UNRESOLVED * error * error {
        doubts.push(Doubt::Data);
    }
    if overlaps.iter().any(|o| !o.known) && !doubts.contains(&Doubt::Data) {
        doubts.push(Doubt::Data);
    }
    if overlaps.iter().any(|o| o.known) {
        doubts.push(Doubt::Sets);
    }
    if several {
        doubts.push(Doubt::Several);
    }
    let relative = ratio(error, scale);
    let estimate = Estimate {
        indicators,
        residuals,
        correction: squared,
        tips: 0.0,
        error,
        relative,
        scale,
        energy,
        uncertainty,
        doubts,
    };
    Ok((estimate, Unseen { overlaps, unresolved }))
}

/// Adds the energies of overlaps that are more than the indicators of their elements, and returns these overlaps. What a gap does
/// between the nodes of closed elements is their oscillation.
fn hidden_overlaps(
    data: &Data<'_>,
    solved: &Solved,
    (scale, modulus): (f64, f64),
    closed: &[usize],
    indicators: &mut [Bubble],
) -> Vec<Overlap> {
    let Some(contact) = &solved.contact else { return Vec::new() };
    let moved = solved.displacement.iter().fold(contact.boundary.largest_gap(), |m, u| m.max(u.abs()));
    let found = indicators.iter().map(Bubble::total).sum::<f64>().sqrt();
    let wanted = LEAST_OVERLAP * (data.scene.method.tolerance * scale).max(found) * (2.0 / modulus).sqrt();
    let mut overlaps = data.overlaps(&solved.displacement, wanted.max(ROUNDED * moved), closed);
    let mut energies = vec![0.0; indicators.len()];
    for overlap in &overlaps {
        energies[overlap.element] += modulus / 2.0 * overlap.depth * overlap.depth;
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
    pub fn squared(&self) -> Vec<f64> {
        if self.residuals.is_empty() {
            self.indicators.iter().map(Bubble::total).collect()
        } else {
            self.indicators.iter().zip(&self.residuals).map(|(b, r)| r.total() + b.oscillation).collect()
        }
    }

    /// Whether an element may have much more error than its bubble shows: between two singular points, of high degree next to
    /// one with a good part of the estimate, or, where the estimate is, longer than the body is thick.
    fn is_coarse(&self, mesh: &Mesh, singular: &[Vec<f64>]) -> bool {
        let total: f64 = self.indicators.iter().map(Bubble::total).sum();
        let touches = |e: usize| {
            let points = &singular[mesh.edge[e]];
            points.iter().any(|p| mesh.span[e].iter().any(|s| (s - p).abs() < SAME_PLACE))
        };
        let slow = |e: usize| mesh.degree[e] > SLOW && self.indicators[e].total() > SLOW_PART * total && touches(e);
        let slender: f64 =
            (0..mesh.len()).map(|e| self.indicators[e].total() * mesh.length(e) / thickness(mesh, e)).sum();
        !coarse_elements(mesh, singular).is_empty() || (0..mesh.len()).any(slow) || slender > SLENDER * total
    }

    /// Adds the energy of transitions that no vertex of the mesh follows.
    pub(crate) fn add_tips(&mut self, scene: &Scene, located: &[Located]) {
        let modulus = plane_modulus(&scene.material);
        self.tips = located.iter().filter(|tip| !tip.at_vertex).map(|tip| tip_energy(modulus, tip)).sum();
        self.error = self.error.hypot(self.tips.sqrt());
        self.relative = ratio(self.error, self.scale);
    }

    /// Adds what the mesh's vertices miss of the transitions, and says what is in doubt. `before`: the transitions of the step
    /// before, if there was one.
    pub(crate) fn add_transitions(
        &mut self,
        scene: &Scene,
        mesh: &Mesh,
        located: &[Located],
        before: Option<&[Located]>,
    ) {
        let modulus = plane_modulus(&scene.material);
        let (located, before) = (&with_curvatures(located), before.map(with_curvatures));
        let sum = |of: &dyn Fn(&Located) -> bool| -> f64 {
            located.iter().filter(|tip| of(tip)).map(|tip| tip_energy(modulus, tip)).sum()
        };
        self.tips = unlocated_energy(scene, located);
        // a vertex that is off moves the sets of the nodes about it, which undoes most of that
        let lost = sum(&|tip| tip.at_vertex) > (UNDONE * self.error).powi(2);
        self.error = self.error.hypot(self.tips.sqrt());
        self.relative = ratio(self.error, self.scale);
        let matters = |energy: f64| energy > MATTERS * self.error * self.error;
        // linear elements follow a transition as well as they do anything
        let hp = scene.method.refine == Refine::Hp;
        let hidden = |tip: &Located| !tip.at_vertex && (hp || degree_at(mesh, tip) > 1);
        let fitted = |of: &dyn Fn(&Located) -> bool| located.iter().filter(|t| of(t)).all(|t| t.curvature.is_some());
        if lost || located.iter().any(hidden) && (!fitted(&hidden) || matters(sum(&hidden))) {
            self.doubts.push(Doubt::Transition);
        }
        let far = |tip: &Located| tip.at_vertex && tip.off.abs() > (FAR_IN_ZONE * zone(tip, located)).min(FAR);
        let moving = located.iter().any(far) && (!fitted(&far) || matters(sum(&far)));
        let contact = scene.sides.iter().any(|side| matches!(side.condition, Condition::Contact { .. }));
        let changed = before.map_or(contact, |before| matters(changed_energy(modulus, &before, located)));
        if (moving || changed) && !self.doubts.contains(&Doubt::Sets) {
            self.doubts.push(Doubt::Sets);
        }
        if self.is_coarse(mesh, &singular_points(scene, hp)) {
            self.doubts.push(Doubt::Coarse);
        }
    }

    /// Says whether rounding errors are in the way: of an error down at theirs, or of forces that do not balance.
    pub(crate) fn add_roundoff(&mut self, solved: &Solved) {
        let unbalanced = solved.contact.as_ref().is_some_and(|c| c.converged() && c.audit.equilibrium > UNBALANCED);
        if self.relative < ROUNDOFF || unbalanced {
            self.doubts.push(Doubt::Roundoff);
        }
    }
}

/// Distance from the middle of an element to the nearest other one across the body; infinite if only its neighbours are there.
fn thickness(mesh: &Mesh, e: usize) -> f64 {
    let (middle, n) = (mesh.point(e, 0.0), mesh.normal(e));
    let across = |f: usize| {
        let (c, d) = (mesh.point(f, 0.0), mesh.half(f));
        let to = [c[0] - middle[0], c[1] - middle[1]];
        let t = -((to[0] * d[0] + to[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(-1.0, 1.0);
        let to = [to[0] + t * d[0], to[1] + t * d[1]];
        let (squared, inwards) = (to[0] * to[0] + to[1] * to[1], -(to[0] * n[0] + to[1] * n[1]));
        if inwards > 0.0 && inwards * inwards > 0.25 * squared { squared } else { f64::INFINITY }
    };
    let others = (0..mesh.len()).filter(|&f| f != e && mesh.next[e] != f && mesh.next[f] != e);
    others.map(across).fold(f64::INFINITY, f64::min).sqrt()
}

fn ratio(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

/// (2 strain energy)^½; where there is no strain, that of roundoff.
fn scale(strain: f64, body: &Body, factors: &Factors) -> f64 {
    let largest = factors.homogeneous.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let floor = 1e-20 * body.condensation.largest_diagonal() * largest * largest;
    (2.0 * strain).max(floor).sqrt()
}

/// Degree of the element in which a transition lies.
fn degree_at(mesh: &Mesh, tip: &Located) -> usize {
    let inside = |e: &usize| {
        mesh.edge[*e] == tip.edge && {
            let [a, b] = mesh.span[*e];
            (a - tip.s) * (b - tip.s) <= 0.0
        }
    };
    (0..mesh.len()).find(inside).map_or(1, |e| mesh.degree[e])
}

/// Distance (edge parameter) of a contact end to the next one or the end of the edge; infinite for others.
fn zone(tip: &Located, located: &[Located]) -> f64 {
    if tip.kind != TipKind::ContactEnd {
        return f64::INFINITY;
    }
    let ends = located.iter().filter(|l| l.kind == tip.kind && l.edge == tip.edge).map(|l| l.s);
    let distances = ends.chain([0.0, 1.0]).map(|s| (s - tip.s).abs());
    distances.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
}

/// 0.3 E* B² |δ|³, in which the unit of d and δ cancels; 0 for a transition without a fit.
fn tip_energy(modulus: f64, tip: &Located) -> f64 {
    tip.curvature.map_or(0.0, |b| TIP * modulus * b * b * tip.off.abs().powi(3))
}

/// Energy of the transitions that no vertex of the mesh follows.
pub(crate) fn unlocated_energy(scene: &Scene, located: &[Located]) -> f64 {
    let modulus = plane_modulus(&scene.material);
    with_curvatures(located).iter().filter(|tip| !tip.at_vertex).map(|tip| tip_energy(modulus, tip)).sum()
}

/// The transitions, those without a vertex with curvatures of at most twice the largest of four or more of their edge that have
/// one: the fit of a new one, among others that move, may be far off.
fn with_curvatures(located: &[Located]) -> Vec<Located> {
    let limit = |edge: usize| {
        let settled = located.iter().filter(|tip| tip.edge == edge && tip.at_vertex).filter_map(|tip| tip.curvature);
        let settled: Vec<f64> = settled.collect();
        (settled.len() >= 4).then(|| 2.0 * settled.into_iter().fold(0.0, f64::max))
    };
    let of = |tip: &Located| match (tip.curvature, limit(tip.edge)) {
        (curvature, Some(limit)) if !tip.at_vertex => Located { curvature: curvature.map(|b| b.min(limit)), ..*tip },
        _ => *tip,
    };
    located.iter().map(of).collect()
}

/// What the zones had or have that only one of two steps knows: of each kind of transition on each edge, the smallest as many as
/// there are more of; infinite where one was not fitted.
fn changed_energy(modulus: f64, before: &[Located], after: &[Located]) -> f64 {
    let mut groups: Vec<(usize, TipKind)> = before.iter().chain(after).map(|tip| (tip.edge, tip.kind)).collect();
    groups.sort_by_key(|&(edge, kind)| (edge, kind as usize));
    groups.dedup();
    let mut sum = 0.0;
    for group in groups {
        let zones = |all: &[Located]| -> Vec<f64> {
            let of_group: Vec<&Located> = all.iter().filter(|tip| (tip.edge, tip.kind) == group).collect();
            let length = |tip: &Located| {
                let others = of_group.iter().map(|t| t.s).chain([0.0, 1.0]).map(|s| (s - tip.s).abs());
                others.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
            };
            let energy = |tip: &&Located| match tip.curvature {
                Some(_) => tip_energy(modulus, &Located { off: length(tip) / 2.0, ..**tip }),
                None => f64::INFINITY,
            };
            let mut zones: Vec<f64> = of_group.iter().map(energy).collect();
            zones.sort_by(f64::total_cmp);
            zones
        };
        let (a, b) = (zones(before), zones(after));
        let more = a.len().abs_diff(b.len());
        sum += if a.len() > b.len() { &a } else { &b }[..more].iter().sum::<f64>();
    }
    sum
}

/// The directions in which the bubble of an element is free.
#[derive(Debug, Clone, Copy)]
struct Frame {
    directions: [[f64; 2]; 2],
    free: [bool; 2],
}

impl Frame {
    const FREE: Self = Self { directions: [[1.0, 0.0], [0.0, 1.0]], free: [true; 2] };

    /// x = A⁻¹ρ in the free directions.
    fn solve(&self, a: [[f64; 2]; 2], rho: [f64; 2]) -> [f64; 2] {
        let [d, t] = self.directions;
        let form = |x: [f64; 2], y: [f64; 2]| {
            x[0] * (a[0][0] * y[0] + a[0][1] * y[1]) + x[1] * (a[1][0] * y[0] + a[1][1] * y[1])
        };
        let along = |x: [f64; 2]| x[0] * rho[0] + x[1] * rho[1];
        let one = |x: [f64; 2]| x.map(|c| c * along(x) / form(x, x));
        match self.free {
            [false, false] => [0.0; 2],
            [true, false] => one(d),
            [false, true] => one(t),
            [true, true] => {
                let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
                [(a[1][1] * rho[0] - a[0][1] * rho[1]) / det, (a[0][0] * rho[1] - a[1][0] * rho[0]) / det]
            }
        }
    }

    /// ρᵀA⁻¹ρ in the free directions.
    fn energy(&self, a: [[f64; 2]; 2], rho: [f64; 2]) -> f64 {
        let x = self.solve(a, rho);
        (x[0] * rho[0] + x[1] * rho[1]).max(0.0)
    }
}

/// What is free of every bubble: all, less what is held, less what the contact state prescribes.
fn frames(scene: &Scene, mesh: &Mesh, bubbles: &[ContactBubble]) -> Vec<Frame> {
    let mut frames: Vec<Frame> = (0..mesh.len())
        .map(|e| match &scene.sides[mesh.side[e]].condition {
            Condition::Displacement { values, .. } => {
                Frame { free: [values[0].is_none(), values[1].is_none()], ..Frame::FREE }
            }
            _ => Frame::FREE,
        })
        .collect();
    for bubble in bubbles {
        let e = bubble.element;
        frames[e] = Frame { directions: [mesh.normal(e), mesh.tangent[e]], free: bubble.free };
    }
    frames
}

/// S₊ on what the supports and the contact sets leave free, and S with single bubbles as its preconditioner.
struct System<'a> {
    condensation: &'a Condensation,
    elastic: &'a Elastic<'a>,
    frozen: Option<&'a Frozen<'a>>,
    frames: &'a [Frame],
    /// ⟨S₊ b, b⟩ of each bubble.
    blocks: Vec<[[f64; 2]; 2]>,
}

impl System<'_> {
    fn multiply(&self, v: &Enriched) -> Enriched {
        self.elastic.multiply(v, self.condensation.multiply(&v.base))
    }

    fn precondition(&self, r: &Enriched) -> Enriched {
        let load = self.condensation.load_of_correction(&r.base);
        let kept = self.frozen.map_or(Vec::new(), |f| f.correction(&load.kept));
        let base = self.condensation.expand(&load, &kept);
        let extra = (0..self.frames.len()).flat_map(|e| {
            let rho = [r.extra[2 * e], r.extra[2 * e + 1]];
            self.frames[e].solve(self.blocks[e], rho)
        });
        Enriched { base, extra: extra.collect() }
    }

    /// ⟨S₊e, e⟩ and e of S₊e = r, by conjugate gradients.
    fn correction(&self, r: &Enriched) -> (f64, Enriched) {
        let mut e = Enriched { base: vec![0.0; r.base.len()], extra: vec![0.0; r.extra.len()] };
        let mut r = r.clone();
        let mut z = self.precondition(&r);
        let mut p = z.clone();
        let mut rz = r.dot(&z);
        let mut energy = 0.0;
        for _ in 0..STEPS {
            let s = self.multiply(&p);
            let step = rz / p.dot(&s);
            if rz <= 0.0 || !step.is_finite() {
                break;
            }
            energy += step * rz;
            e.add(step, &p);
            if step * rz <= ENOUGH * energy {
                break;
            }
            r.add(-step, &s);
            z = self.precondition(&r);
            let next = r.dot(&z);
            let mut direction = z.clone();
            direction.add(next / rz, &p);
            (p, rz) = (direction, next);
        }
        (energy, e)
    }
}

//! Whether ends of contact and stick are where the mesh has vertices for them, and what it costs if they are not.
//!
//! ```text
//! gap or slip beside a transition in its place   B d^(3/2)
//! off by δ, the traction has                     K/(2πd)^½,  K = ⅜ (2π)^½ E* B δ
//! energy release rate of one body                K²/(2E*)
//! a transition off by δ costs, twice its energy  2 ∫ K²/(2E*) dδ = (3π/32) E* B² |δ|³
//! ```
//! Those without a vertex count in the estimate; those that are off or changed since the step before are in doubt, by their energy.

use steklov_bem_operators::Mesh;
use steklov_contact::{Decided, Located, TipKind};
use steklov_problem::{Refine, Scene};

use crate::doubt::Doubt;
use crate::estimate::error_estimate::{Estimate, OF_SQUARE, ratio};
use crate::mesh::first_mesh::singular_points;

/// Squared energy norm of a tip that is off by δ, over E* B² |δ|³.
const TIP: f64 = 3.0 * std::f64::consts::PI / 32.0;
/// A tip farther from its vertex than this part of its edge, or than this part of the way to the next transition:
/// the contact sets are not those of the solution yet.
const FAR: f64 = 0.006;
const FAR_IN_ZONE: f64 = 0.025;
/// Largest error (energy norm) by vertices off their transitions alone, over the estimated error; beyond it there is a doubt.
const UNDONE: f64 = 10.0;
/// From this part of the squared estimate on, energies of transitions away from their believed places count.
const MATTERS: f64 = 0.05;

impl Estimate {
    /// Adds the energy of transitions that no vertex of the mesh follows.
    pub(crate) fn add_tips(&mut self, scene: &Scene, located: &[Located]) {
        let modulus = |tip: &Located| scene.problem.contact_modulus(tip.edge);
        self.tips = located.iter().filter(|tip| !tip.at_vertex).map(|tip| tip_energy(modulus(tip), tip)).sum();
        self.error = self.error.hypot(self.tips.sqrt());
        self.uncertainty += OF_SQUARE * self.tips;
        self.relative = ratio(self.error, self.scale);
    }

    /// Adds the energy of the transitions that the mesh's vertices miss, and the doubts. `before`: the transitions of the step
    /// before, if there was one.
    pub(crate) fn add_transitions(
        &mut self,
        scene: &Scene,
        mesh: &Mesh,
        located: &[Located],
        before: Option<&[Located]>,
    ) {
        let modulus = |tip: &Located| scene.problem.contact_modulus(tip.edge);
        let (located, before) = (&with_curvatures(located), before.map(with_curvatures));
        let sum = |of: &dyn Fn(&Located) -> bool| -> f64 {
            located.iter().filter(|tip| of(tip)).map(|tip| tip_energy(modulus(tip), tip)).sum()
        };
        self.tips = unlocated_energy(scene, located);
        // a vertex that is off moves the sets of the nodes about it, which undoes most of that
        let lost = sum(&|tip| tip.at_vertex) > (UNDONE * self.error).powi(2);
        self.error = self.error.hypot(self.tips.sqrt());
        self.uncertainty += OF_SQUARE * self.tips;
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
        let contact = scene.contacts().next().is_some();
        let changed = before.map_or(contact, |before| matters(changed_energy(&modulus, &before, located)));
        if (moving || changed) && !self.doubts.contains(&Doubt::Sets) {
            self.doubts.push(Doubt::Sets);
        }
        let is_coarse = self.is_coarse(&scene.problem.outline, mesh, &singular_points(scene, hp));
        if is_coarse && !self.doubts.contains(&Doubt::Coarse) {
            self.doubts.push(Doubt::Coarse);
        }
    }

    /// Adds a doubt if zones with negligible pressure are more than a small part of the length of contact, or all of it.
    pub(crate) fn add_undecided(&mut self, decided: &Decided) {
        let Decided { closed, undecided, length, .. } = *decided;
        if undecided > (FAR_IN_ZONE * closed).min(FAR * length) && !self.doubts.contains(&Doubt::Sets) {
            self.doubts.push(Doubt::Sets);
        }
    }
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

/// Distance (edge parameter) of a transition to the next one or the end of the edge.
pub(crate) fn zone(tip: &Located, located: &[Located]) -> f64 {
    let ends = located.iter().filter(|l| l.edge == tip.edge).map(|l| l.s);
    let distances = ends.chain([0.0, 1.0]).map(|s| (s - tip.s).abs());
    distances.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
}

/// (3π/32) E* B² |δ|³, in which the unit of d and δ cancels; 0 for a transition without a fit.
fn tip_energy(modulus: f64, tip: &Located) -> f64 {
    tip.curvature.map_or(0.0, |b| TIP * modulus * b * b * tip.off.abs().powi(3))
}

/// Energy of the transitions that no vertex of the mesh follows.
pub(crate) fn unlocated_energy(scene: &Scene, located: &[Located]) -> f64 {
    let modulus = |tip: &Located| scene.problem.contact_modulus(tip.edge);
    with_curvatures(located).iter().filter(|tip| !tip.at_vertex).map(|tip| tip_energy(modulus(tip), tip)).sum()
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

/// The energy of zones that only one of two steps knows: for each kind of transition on each edge the smallest ones, as many
/// as one step has more than the other; infinite if one was not fitted.
fn changed_energy(modulus: &dyn Fn(&Located) -> f64, before: &[Located], after: &[Located]) -> f64 {
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
                Some(_) => tip_energy(modulus(tip), &Located { off: length(tip) / 2.0, ..**tip }),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// K of a transition off by δ, and from it twice the energy that is released on the way, by the midpoint rule.
    #[test]
    fn a_transition_off_its_place_costs_what_is_released_on_the_way() {
        let (modulus, curvature) = (110.0, 0.16);
        for off in [-3e-3, 2e-2] {
            let tip = Located {
                edge: 0,
                kind: TipKind::ContactEnd,
                s: 0.4,
                off,
                curvature: Some(curvature),
                at_vertex: true,
            };
            let steps = 1000;
            let step = f64::abs(off) / f64::from(steps);
            // half the opening of a crack is 4K/E* (d/2π)^½, a gap off by δ opens as 3/2 B δ d^½
            let intensity = |delta: f64| 1.5 * curvature * delta * modulus / 4.0 * (2.0 * std::f64::consts::PI).sqrt();
            let rate = |delta: f64| intensity(delta).powi(2) / (2.0 * modulus);
            let released: f64 = (0..steps).map(|k| rate((f64::from(k) + 0.5) * step) * step).sum();
            let told = tip_energy(modulus, &tip);
            assert!((told / (2.0 * released) - 1.0).abs() < 1e-6, "{told} {released}");
        }
    }
}

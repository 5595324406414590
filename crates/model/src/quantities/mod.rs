//! Numbers that users quote, each with its error bar, see [`crate::bars`].

mod energies;
mod forces;
pub(crate) mod told;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use steklov_bem_operators::Location;
use steklov_problem::{Interface, Law, Multiplier, NamedQuantity, QuantityKind, Scene};

use crate::answer::probes::invariants;
use crate::doubt::Doubt;
use crate::reacting::shared;
use crate::solve::fields::ElasticField;
use crate::summary::Named;

/// A number with its error bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Its value.
    pub value: f64,
    /// How far the exact value may be from that, to both sides, in the same unit.
    pub uncertainty: f64,
    /// Why the uncertainty is not to be trusted, words of [`crate::doubt::Doubt`]; empty if it is.
    pub doubts: Vec<String>,
    /// Its parts by their names, whose sum it is; empty where it has one only.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parts: BTreeMap<String, f64>,
}

impl Quantity {
    /// Adds a doubt that is not there yet.
    fn doubt(&mut self, doubt: Doubt) {
        let is_new = !self.doubts.iter().any(|word| word == doubt.word());
        self.doubts.extend(is_new.then(|| doubt.word().to_owned()));
    }
}

/// A quantity on a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedQuantity {
    /// J(u).
    pub value: f64,
    /// J(u₊) of the enriched spaces.
    pub enriched: f64,
    /// Σ |η_e| of the dual weighted residuals, and what ends of contact add that are not at their vertices; where a dual problem is known.
    pub weighted: Option<[f64; 2]>,
}

/// The quantities of a result by their paths in the JSON object.
pub type Quantities = BTreeMap<String, Quantity>;

/// The components at a point, in the order of [`at_points`].
pub(crate) const OF_POINT: [&str; 8] = [
    "displacement.x",
    "displacement.y",
    "stress.xx",
    "stress.yy",
    "stress.xy",
    "von_mises",
    "max_principal",
    "min_principal",
];

/// Displacement and stress at a point.
pub(crate) type At<'a> = dyn Fn([f64; 2]) -> ([f64; 2], [f64; 3]) + 'a;

/// Displacement, stress and its invariants at the points of a scene, of a field and that of a medium around a body, if there is one.
pub(crate) fn at_points(scene: &Scene, field: &ElasticField<'_>, medium: Option<&At<'_>>) -> Vec<f64> {
    let outline = &scene.problem.outline;
    let at = |x: [f64; 2]| match (outline.contains(x), medium) {
        (Location::Boundary { edge, s }, _) => field.on_edge(edge, s),
        (Location::Outside, Some(medium)) => medium(x),
        _ => field.inside(outline.body_at(x).unwrap_or(0), x),
    };
    scene
        .probe
        .iter()
        .flat_map(|&x| {
            let ([u, v], stress) = at(x);
            let ([xx, yy, xy], [von_mises, larger, smaller]) = (stress, invariants(scene, x, stress));
            [u, v, xx, yy, xy, von_mises, larger, smaller]
        })
        .collect()
}

/// Whether the largest von Mises stress of a scene is a quantity: that of bodies whose stresses are known to be needed.
pub(crate) fn has_largest_stress(scene: &Scene) -> bool {
    needs_tractions(scene) && !scene.is_on_grid()
}

/// Whether quantities of a scene need the tractions of the enriched spaces.
pub(crate) fn needs_tractions(scene: &Scene) -> bool {
    !scene.probe.is_empty() || !scene.quantities.is_empty() || has_contact(scene) || shares_forces(scene)
}

/// Whether two sides share a force at a corner.
fn shares_forces(scene: &Scene) -> bool {
    let sides = (0..scene.problem.sides.len()).filter(|&side| is_known(scene, side)).map(|side| vec![side]);
    let between = forces_between(scene).map(|(_, interface)| interface.sides.clone());
    sides.chain(between).any(|sides| shared(scene, &sides) != [false; 2])
}

/// Whether a scene has contact with biorthogonal multipliers, whose largest pressure is a quantity.
pub(crate) fn has_contact(scene: &Scene) -> bool {
    scene.contacts().next().is_some() && scene.method.multiplier == Multiplier::Biorthogonal
}

/// The contact whose largest pressure is a quantity: all of it (None), and where that is not all, that of each interface between bodies,
/// by its number.
pub(crate) fn peaks(scene: &Scene) -> Vec<Option<usize>> {
    if !has_contact(scene) {
        return Vec::new();
    }
    let part = contact_between(scene).filter(|(_, own)| !is_all_contact(scene, own));
    std::iter::once(None).chain(part.map(|(number, _)| Some(number))).collect()
}

/// Whether a side carries the contact of [`peaks`].
pub(crate) fn is_of_peak(scene: &Scene, peak: Option<usize>, side: usize) -> bool {
    match peak {
        None => scene.contact(side).is_some(),
        Some(number) => scene.problem.joints().nth(number).is_some_and(|own| own.sides.contains(&side)),
    }
}

/// The interfaces of contact between bodies, with their numbers.
pub(crate) fn contact_between(scene: &Scene) -> impl Iterator<Item = (usize, &Interface)> {
    scene.problem.joints().enumerate().filter(|(_, own)| matches!(own.law, Law::Contact(_)))
}

fn is_all_contact(scene: &Scene, interface: &Interface) -> bool {
    scene.contacts().all(|(side, _)| interface.sides.contains(&side))
}

/// The forces of sides, with their numbers, whose error bars are known: of supports, springs and rigid obstacles.
pub(crate) fn forces<'a>(
    scene: &'a Scene,
    reactions: &'a [(String, [f64; 2])],
) -> impl Iterator<Item = ([f64; 2], usize)> + 'a {
    let of = |(name, force): &'a (String, [f64; 2])| {
        Some((*force, scene.problem.sides.iter().position(|side| side.name == *name)?))
    };
    reactions.iter().filter_map(of).filter(|(_, side)| is_known(scene, *side))
}

/// The interfaces between bodies, with their numbers, the error bars of whose forces are known: all but those of stabilised multipliers.
pub(crate) fn forces_between(scene: &Scene) -> impl Iterator<Item = (usize, &Interface)> {
    let known = |(_, interface): &(usize, &Interface)| {
        matches!(interface.law, Law::Tied(_)) || scene.method.multiplier == Multiplier::Biorthogonal
    };
    scene.problem.joints().enumerate().filter(known)
}

/// Whether the enriched spaces tell how far the force of a side may be off: that of a support, of springs or of a rigid obstacle. On grids
/// those of springs are not known.
fn is_known(scene: &Scene, side: usize) -> bool {
    let (problem, stabilised) = (&scene.problem, scene.method.multiplier == Multiplier::Stabilised);
    let touched = problem.contact(side).is_some();
    let sprung = problem.sides[side].springs.is_some();
    !(sprung && scene.is_on_grid()) && problem.joint(side).is_none() && !(stabilised && touched)
}

/// The named quantities by their names; pressures are NaN where they are infinite.
pub(crate) fn named(scene: &Scene, values: &[f64], infinite: impl Fn([f64; 2]) -> bool) -> Named {
    let mut named = Named::default();
    let mut values = values.iter().copied();
    for NamedQuantity { name, kind } in &scene.quantities {
        let Some(value) = values.next() else { break };
        let group = match kind {
            QuantityKind::PressureAt(x) => {
                named.pressure.insert(name.clone(), if infinite(*x) { f64::NAN } else { value });
                continue;
            }
            QuantityKind::MeanDisplacement(_) => {
                named.mean_displacement.insert(name.clone(), [value, values.next().unwrap_or(f64::NAN)]);
                continue;
            }
            QuantityKind::Moment { .. } => &mut named.moment,
            QuantityKind::WeightedForce { .. } => &mut named.weighted_force,
            QuantityKind::OpeningAt(_) => &mut named.opening,
        };
        group.insert(name.clone(), value);
    }
    named
}

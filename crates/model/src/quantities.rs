//! Numbers that users quote, each with its error bar, see [`crate::bars`].

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use steklov_bem_operators::{Location, SAME_PLACE};
use steklov_elastic::plane::distance;
use steklov_problem::{Condition, Interface, Law, Multiplier, NamedQuantity, QuantityKind, Scene};

use crate::answer::data_jumps::kinks;
use crate::answer::probes::invariants;
use crate::answer::wedges::beyond_end;
use crate::bars::{Bars, Kind, OF_DIFFERENCE, ON_GRID, Of};
use crate::contact_length::ends_at_corners_are_known;
use crate::doubt::Doubt;
use crate::estimate::reaction_work::{has_friction_work, has_reaction_work};
use crate::reacting::{shared, shared_corners, works_alone};
use crate::solve::contact_rows::{ContactRow, TOUCHING};
use crate::solve::fields::ElasticField;
use crate::summary::{InterfaceSummary, Named, Probe};

/// Uncertainties below this many rounding errors are of no concern at corners.
const SMALL: f64 = 100.0;
/// How much larger the uncertainty is at corners.
const OF_CORNER: f64 = 3.0;

/// Strain energy and J are opposite numbers up to this part of them where a theorem says so.
const SAME_ENERGY: f64 = 1e-9;

/// The part of an energy that a mesh leaves at most between what is told and what follows from J: more is another problem.
const OF_LEFT: f64 = 0.1;

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

/// Whether a point is a corner of the outline, between two of its sides, or where data of its side jump or have a kink.
fn is_corner(scene: &Scene, x: [f64; 2]) -> bool {
    let outline = &scene.problem.outline;
    let Location::Boundary { edge, s } = outline.contains(x) else { return false };
    let at_end = s >= 1.0 - SAME_PLACE;
    let edges = outline.edges();
    if !at_end && s > SAME_PLACE {
        return kinks(scene, &edges[edge]).iter().any(|kink| (kink - s).abs() <= SAME_PLACE);
    }
    let (other, is_straight) = beyond_end(outline, edge, at_end);
    edges[edge].side != edges[other].side || !is_straight
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

/// What a result tells with the doubts of all of it.
#[derive(Clone, Copy)]
pub(crate) struct Told<'a> {
    /// J, and `[extrapolated, its uncertainty]`.
    pub energy: (f64, Option<[f64; 2]>),
    /// The points of the scene.
    pub probes: &'a [Probe],
    /// The named quantities.
    pub named: &'a Named,
    /// Which of them are near an end of contact.
    pub near: &'a [bool],
    /// The largest pressure of a node, if it is not zero and no stress on a side in contact infinite.
    pub peak: Option<f64>,
    /// The interfaces between bodies.
    pub interfaces: &'a [InterfaceSummary],
    /// Strain energy and load work.
    pub parts_of_energy: [f64; 2],
    /// The forces of sides.
    pub reactions: &'a [(String, [f64; 2])],
    /// The force of all contact.
    pub force: Option<[f64; 2]>,
    /// The length of contact, and what misplaced vertices add to its uncertainty.
    pub length: Option<[f64; 2]>,
    /// The contact table.
    pub rows: &'a [ContactRow],
    /// Words of doubts.
    pub doubts: &'a [String],
    /// Whether the solution is exact.
    pub is_exact: bool,
}

/// J and the values with error bars by their paths; stresses that are infinite are left out, and what two sides share at a corner.
pub(crate) fn quantities(scene: &Scene, all: &Bars, told: Told<'_>) -> Quantities {
    let with =
        |value, uncertainty| Quantity { value, uncertainty, doubts: told.doubts.to_vec(), parts: BTreeMap::new() };
    let count = if scene.surroundings().is_some() { 3 } else { 2 };
    let of_parts = |parts: &[f64; 3]| {
        let named = ON_GRID.iter().zip(parts).take(count);
        named.map(|(name, &part)| ((*name).to_owned(), part)).collect()
    };
    let doubt = |quantity: &mut Quantity, doubt: Doubt| {
        let is_new = !quantity.doubts.iter().any(|word| word == doubt.word());
        quantity.doubts.extend(is_new.then(|| doubt.word().to_owned()));
    };
    let mut quantities = Quantities::new();
    let (energy, known) = told.energy;
    if let Some(parts) = all.parts_of_energy {
        let least = all.rounded * energy.abs();
        let mut quantity = with(energy, parts.iter().sum::<f64>().max(least));
        // few nodes of contact have little part in J, few elements of a medium much
        if count == ON_GRID.len() {
            all.doubts.iter().for_each(|own| doubt(&mut quantity, *own));
        }
        quantities.insert("energy".to_owned(), Quantity { parts: of_parts(&parts), ..quantity });
    } else if let Some([extrapolated, uncertainty]) = known {
        let d = (extrapolated - energy).abs();
        let wide = d + uncertainty;
        let uncertainty = all.of_energy.map_or(wide, |half| wide.min(OF_DIFFERENCE * d.max(half)));
        quantities.insert("energy".to_owned(), with(energy, uncertainty));
    }
    // a short piece beside a corner may be open
    let known_at_corners = told.is_exact || ends_at_corners_are_known(scene, told.rows);
    // on a grid how much of a corner is whose is not known
    let is_unknown = |shared: bool, value: f64, uncertainty: f64| {
        shared && scene.is_on_grid() || !(value.is_finite() && uncertainty.is_finite())
    };
    // what depends on a piece beside a corner that no node shows
    let may_open = |quantity: &mut Quantity, depends: bool| {
        if depends && !known_at_corners {
            doubt(quantity, Doubt::Transition);
        }
    };
    let first = all.entries.iter().position(|entry| matches!(entry.of, Of::Named(_))).unwrap_or(0);
    for (k, (entry, &[value, uncertainty])) in all.entries.iter().zip(&all.values).enumerate() {
        let mut quantity = with(value, uncertainty);
        if let Some(parts) = all.parts.get(k) {
            quantity.parts = of_parts(parts);
        }
        all.doubts.iter().for_each(|own| doubt(&mut quantity, *own));
        match entry.of {
            Of::Peak(of) => {
                let at_node = told.peak.and_then(|all| match of {
                    None => Some(all),
                    Some(number) => told.interfaces.get(number)?.max_pressure.filter(|own| *own > 0.0),
                });
                let Some(at_node) = at_node.filter(|_| value.is_finite() && uncertainty.is_finite()) else {
                    continue;
                };
                // an exact pressure has more digits at nodes than as a traction
                if (value - at_node).abs() <= SMALL * all.rounding(k) {
                    quantity.value = at_node;
                }
            }
            Of::Reactions => continue,
            Of::LargestStress if !(value.is_finite() && uncertainty.is_finite()) => continue,
            Of::LargestStress | Of::Strain | Of::Springs => {}
            // between nodes that all stick there may be some slip
            Of::Friction if value == 0.0 && !told.is_exact && told.rows.iter().any(|row| row.pressure > 0.0) => {
                continue;
            }
            Of::Friction if !value.is_finite() || scene.is_on_grid() && !known_at_corners => continue,
            Of::Friction => {
                may_open(&mut quantity, true);
                quantity.uncertainty *= if known_at_corners { 1.0 } else { OF_CORNER };
            }
            Of::Length => match told.length.filter(|_| value.is_finite() && uncertainty.is_finite()) {
                Some([length, of_vertices]) => {
                    (quantity.value, quantity.uncertainty) = (length, uncertainty + of_vertices);
                }
                None => continue,
            },
            Of::Point(point) => {
                let Probe { point: x, stress_unbounded, .. } = told.probes[point];
                let is_stress = entry.kind == Kind::Stress;
                if is_stress && stress_unbounded {
                    continue;
                }
                let is_weak = all.near_singular.contains(&point)
                    || if is_stress { is_corner(scene, x) || all.at_jumps.contains(&point) } else { stress_unbounded };
                if is_weak && uncertainty > SMALL * all.rounding(k) {
                    quantity.uncertainty *= OF_CORNER;
                    quantity.parts.values_mut().for_each(|part| *part *= OF_CORNER);
                    doubt(&mut quantity, Doubt::Coarse);
                }
            }
            Of::Force(side) => {
                let shared = shared(scene, &[side])[k - entry.group.start];
                if is_unknown(shared, value, uncertainty) {
                    continue;
                }
                may_open(&mut quantity, shared);
            }
            Of::Interface(number) => {
                let sides = scene.problem.joints().nth(number).map_or(&[][..], |interface| &interface.sides);
                let shared = shared(scene, sides)[k - entry.group.start];
                if is_unknown(shared, value, uncertainty) {
                    continue;
                }
                may_open(&mut quantity, shared);
            }
            Of::Named(of) => {
                let NamedQuantity { name, kind } = &scene.quantities[of];
                if let Some((side, w)) = kind.weighted_side()
                    && (!is_known(scene, side) || is_unknown(!works_alone(scene, side, w), value, uncertainty))
                {
                    continue;
                }
                let joined = kind.weighted_side().is_some_and(|(side, w)| !works_alone(scene, side, w));
                may_open(&mut quantity, joined);
                if told.named.pressure.get(name).is_some_and(|pressure| pressure.is_nan()) {
                    continue;
                }
                // between nodes that touch only the interpolation keeps the surfaces apart
                if let QuantityKind::OpeningAt(x) = *kind
                    && touches_at(told.rows, x)
                {
                    quantity.uncertainty = uncertainty.max(value.abs());
                }
                if told.near.get(k - first).copied().unwrap_or(false) {
                    doubt(&mut quantity, Doubt::Transition);
                }
            }
        }
        quantities.insert(entry.path.clone(), quantity);
    }
    of_shared_forces(scene, &mut quantities);
    of_energies(scene, &mut quantities, (all, known_at_corners), told.parts_of_energy);
    of_carrying_sides(scene, &mut quantities, told.reactions);
    if let Some(force) = told.force {
        of_contact(scene, &mut quantities, force);
    }
    let whole = contact_between(scene).find(|(_, own)| is_all_contact(scene, own));
    if let Some((number, peak)) =
        whole.and_then(|(number, _)| Some((number, quantities.get("contact.max_pressure")?.clone())))
    {
        quantities.insert(format!("interfaces.{number}.max_pressure"), peak);
    }
    quantities
}

/// Gives forces of sides and interfaces that share corners the largest error bar of all of them, along x and along y: what one has too much
/// another one lacks; moments and weighted forces have that of what they weigh there or more.
fn of_shared_forces(scene: &Scene, quantities: &mut Quantities) {
    let of_side = |side: usize| (format!("reactions.{}", scene.problem.sides[side].name), shared(scene, &[side]));
    let of_interface =
        |(number, own): (usize, &Interface)| (format!("interfaces.{number}.force"), shared(scene, &own.sides));
    let sides = (0..scene.problem.sides.len()).map(of_side);
    let all: Vec<(String, [bool; 2])> = sides.chain(forces_between(scene).map(of_interface)).collect();
    for (i, component) in ["x", "y"].into_iter().enumerate() {
        let paths = || all.iter().filter(|(_, shared)| shared[i]).map(|(path, _)| format!("{path}.{component}"));
        let largest = paths().filter_map(|path| Some(quantities.get(&path)?.uncertainty)).fold(0.0, f64::max);
        for path in paths() {
            quantities.entry(path).and_modify(|own| own.uncertainty = largest);
        }
        for NamedQuantity { name, kind } in &scene.quantities {
            let Some((side, w)) = kind.weighted_side() else { continue };
            let at_corners = shared_corners(scene, side, &[side]).into_iter().filter(|(_, shared)| shared[i]);
            let part = at_corners.map(|(x, _)| largest * w(x)[i].abs()).fold(0.0, f64::max);
            let path = format!("{}.{name}", kind.group());
            quantities.entry(path).and_modify(|own| own.uncertainty = own.uncertainty.max(part));
        }
    }
}

/// Gives strain energy E and load work L error bars by those of J, of the work of reactions R, of that against friction F and of the energy of
/// springs S, of the solution of a mesh as well: E = R - J - S and L = R + F - 2J, of which what is told may differ by what a mesh leaves.
fn of_energies(
    scene: &Scene,
    quantities: &mut Quantities,
    (all, known_at_corners): (&Bars, bool),
    [strain, load_work]: [f64; 2],
) {
    let Some(energy) = quantities.get("energy").cloned() else { return };
    let of = |of: Of| all.entries.iter().zip(&all.values).find(|(entry, _)| entry.of == of).map(|(_, own)| *own);
    let has = |known: bool, entry: Of| if known { of(entry) } else { Some([0.0; 2]) };
    let (reactions, friction) = if has_reaction_work(scene) || of(Of::Reactions).is_some() {
        (of(Of::Reactions), has(has_friction_work(scene), Of::Friction))
    } else {
        let nothing = loads_alone_work(scene).then_some([0.0; 2]);
        (nothing, nothing)
    };
    let known = |work: &[f64; 2]| work[0].is_finite();
    let springs = has(scene.problem.has_springs(), Of::Springs).filter(known);
    let (Some(reactions), Some(springs)) = (reactions.filter(known), springs) else { return };
    // -S of the strain energy, F of the work of loads
    let (springs, friction) = (Some([-springs[0], springs[1]]), friction.filter(known));
    for (path, value, factor, more) in
        [("strain_energy", strain, 1.0, springs), ("load_work", load_work, 2.0, friction)]
    {
        let Some(more) = more else { continue };
        let sum = |k: usize| reactions[k] + more[k];
        let left = (value - (sum(0) - factor * energy.value)).abs();
        let left = if left > SAME_ENERGY * value.abs() { left } else { 0.0 };
        let bar = factor * energy.uncertainty + sum(1);
        let of_corners = [reactions[0], if factor == 2.0 { more[0] } else { 0.0 }];
        // without loads their work is exactly zero
        let unloaded = value == 0.0;
        let known =
            unloaded || known_at_corners || of_corners.iter().all(|work| work.abs() <= SAME_ENERGY * value.abs());
        if !known && scene.is_on_grid() || left > OF_LEFT * value.abs() {
            continue;
        }
        // of what depends on a piece beside a corner that no node shows
        let wider = if known { 1.0 } else { OF_CORNER };
        let uncertainty = if unloaded { 0.0 } else { wider * bar + left };
        let share = if energy.uncertainty > 0.0 { uncertainty / energy.uncertainty } else { 0.0 };
        let parts = energy.parts.iter().map(|(name, part)| (name.clone(), share * part)).collect();
        let mut doubts = energy.doubts.clone();
        doubts.extend(all.doubts.iter().map(|doubt| doubt.word().to_owned()));
        doubts.dedup();
        let is_new = !known && !doubts.iter().any(|word| word == Doubt::Transition.word());
        doubts.extend(is_new.then(|| Doubt::Transition.word().to_owned()));
        quantities.insert(path.to_owned(), Quantity { value, uncertainty, doubts, parts });
    }
}

/// Whether nothing but loads and springs does work on the bodies: no support moves, and there is no contact or jump.
fn loads_alone_work(scene: &Scene) -> bool {
    let problem = &scene.problem;
    let is_plain = |law: &Law| matches!(law, Law::Tied(tie) if tie.displacement_jump.is_none());
    let rests = |condition: &Condition| match condition {
        Condition::Displacement { values, .. } => values.iter().flatten().all(|value| value.constant() == Some(0.0)),
        _ => true,
    };
    problem.interfaces().iter().all(|interface| is_plain(&interface.law))
        && problem.sides.iter().all(|side| rests(&side.condition))
}

/// Gives the force of a side that alone carries the multipliers of an interface the error bar of that.
fn of_carrying_sides(scene: &Scene, quantities: &mut Quantities, reactions: &[(String, [f64; 2])]) {
    for (number, interface) in scene.problem.joints().enumerate() {
        let &[side] = &interface.sides[..] else { continue };
        let name = &scene.problem.sides[side].name;
        let Some((_, force)) = reactions.iter().find(|(own, _)| own == name) else { continue };
        for (component, &value) in ["x", "y"].into_iter().zip(force) {
            if let Some(own) = quantities.get(&format!("interfaces.{number}.force.{component}")) {
                let own = Quantity { value, ..own.clone() };
                quantities.insert(format!("reactions.{name}.{component}"), own);
            }
        }
    }
}

/// Gives the force of all contact its error bar, the sum of those of its sides and interfaces, where all of them have one.
fn of_contact(scene: &Scene, quantities: &mut Quantities, force: [f64; 2]) {
    let rigid = scene.contacts().filter(|&(side, _)| scene.problem.joint(side).is_none());
    let parts: Vec<String> = rigid
        .map(|(side, _)| format!("reactions.{}", scene.problem.sides[side].name))
        .chain(contact_between(scene).map(|(number, _)| format!("interfaces.{number}.force")))
        .collect();
    for (component, value) in ["x", "y"].into_iter().zip(force) {
        let own: Option<Vec<&Quantity>> =
            parts.iter().map(|part| quantities.get(&format!("{part}.{component}"))).collect();
        let Some(own) = own.filter(|own| !own.is_empty()) else { continue };
        let mut doubts: Vec<String> = own.iter().flat_map(|part| part.doubts.clone()).collect();
        doubts.sort();
        doubts.dedup();
        let uncertainty = own.iter().map(|part| part.uncertainty).sum();
        let sum = Quantity { value, uncertainty, doubts, parts: BTreeMap::new() };
        quantities.insert(format!("contact.force.{component}"), sum);
    }
}

/// Whether the node of contact that is nearest to a point touches.
fn touches_at(rows: &[ContactRow], x: [f64; 2]) -> bool {
    let nearest = rows.iter().min_by(|a, b| distance(a.point, x).total_cmp(&distance(b.point, x)));
    let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure));
    nearest.is_some_and(|row| row.pressure > TOUCHING * largest)
}

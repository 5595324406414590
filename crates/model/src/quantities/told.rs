//! The values with error bars as a result tells them: with its doubts, wider where they are weak, and without those that are not known.

use std::collections::BTreeMap;

use steklov_bem_operators::{Location, SAME_PLACE};
use steklov_elastic::plane::distance;
use steklov_problem::{NamedQuantity, QuantityKind, Scene};

use super::energies::of_energies;
use super::forces::{of_carrying_sides, of_contact, of_shared_forces};
use super::{Quantities, Quantity, contact_between, is_all_contact, is_known};
use crate::answer::data_jumps::kinks;
use crate::answer::wedges::beyond_end;
use crate::bars::{Bars, Entry, Kind, OF_DIFFERENCE, ON_GRID, Of};
use crate::contact_length::ends_at_corners_are_known;
use crate::doubt::Doubt;
use crate::reacting::{shared, works_alone};
use crate::solve::contact_rows::{ContactRow, TOUCHING};
use crate::summary::{InterfaceSummary, Named, Probe};

/// Uncertainties below this many rounding errors are of no concern at corners.
const SMALL: f64 = 100.0;
/// How much larger the uncertainty is at corners.
pub(super) const OF_CORNER: f64 = 3.0;

/// Distances below this part of the diameter are at a corner of a side with springs.
const OF_LAYER: f64 = 1e-3;

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
    /// The place of the largest von Mises stress.
    pub largest_at: Option<[f64; 2]>,
    /// Words of doubts.
    pub doubts: &'a [String],
    /// Whether the solution is exact.
    pub is_exact: bool,
}

/// J and the values with error bars by their paths; stresses that are infinite are left out.
pub(crate) fn quantities(scene: &Scene, all: &Bars, told: Told<'_>) -> Quantities {
    // a short piece beside a corner may be open
    let known_at_corners = told.is_exact || ends_at_corners_are_known(scene, told.rows);
    let telling = Telling { scene, all, told, known_at_corners };
    let mut quantities: Quantities = telling.energy().map(|energy| ("energy".to_owned(), energy)).into_iter().collect();
    let own = (0..all.entries.len()).filter_map(|k| Some((all.entries[k].path.clone(), telling.own(k)?)));
    quantities.extend(own);
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

struct Telling<'a> {
    scene: &'a Scene,
    all: &'a Bars,
    told: Told<'a>,
    known_at_corners: bool,
}

impl Telling<'_> {
    fn with(&self, value: f64, uncertainty: f64) -> Quantity {
        Quantity { value, uncertainty, doubts: self.told.doubts.to_vec(), parts: BTreeMap::new() }
    }

    /// The parts of an uncertainty on a grid by their names.
    fn of_parts(&self, parts: &[f64; 3]) -> BTreeMap<String, f64> {
        let count = if self.scene.surroundings().is_some() { 3 } else { 2 };
        let named = ON_GRID.iter().zip(parts).take(count);
        named.map(|(name, &part)| ((*name).to_owned(), part)).collect()
    }

    /// J.
    fn energy(&self) -> Option<Quantity> {
        let (energy, known) = self.told.energy;
        if let Some(parts) = self.all.parts_of_energy {
            let least = self.all.rounded * energy.abs();
            let mut quantity = self.with(energy, parts.iter().sum::<f64>().max(least));
            // few nodes of contact have little part in J, few elements of a medium much
            if self.scene.surroundings().is_some() {
                self.all.doubts.iter().for_each(|own| quantity.doubt(*own));
            }
            return Some(Quantity { parts: self.of_parts(&parts), ..quantity });
        }
        let [extrapolated, uncertainty] = known?;
        let d = (extrapolated - energy).abs();
        let wide = d + uncertainty;
        let uncertainty = self.all.of_energy.map_or(wide, |half| wide.min(OF_DIFFERENCE * d.max(half)));
        Some(self.with(energy, uncertainty))
    }

    /// The value of an entry; None where it is not told.
    fn own(&self, k: usize) -> Option<Quantity> {
        let Self { scene, all, told, known_at_corners } = self;
        let (entry, [value, uncertainty]) = (&all.entries[k], all.values[k]);
        let mut quantity = self.with(value, uncertainty);
        if let Some(parts) = all.parts.get(k) {
            quantity.parts = self.of_parts(parts);
        }
        all.doubts.iter().for_each(|own| quantity.doubt(*own));
        let is_finite = value.is_finite() && uncertainty.is_finite();
        match entry.of {
            Of::Reactions => return None,
            Of::Strain | Of::Springs => {}
            Of::LargestStress => {
                is_finite.then_some(())?;
                self.widen(&mut quantity, k, told.largest_at.is_some_and(|x| is_end_of_springs(scene, x)));
            }
            Of::Peak(of) => quantity.value = self.peak(of, k).filter(|_| is_finite)?,
            Of::Friction => {
                // between nodes that all stick there may be some slip
                let sticks = value == 0.0 && !told.is_exact && told.rows.iter().any(|row| row.pressure > 0.0);
                let unknown = scene.is_on_grid() && !known_at_corners;
                (value.is_finite() && !sticks && !unknown).then_some(())?;
                self.may_open(&mut quantity, true);
                quantity.uncertainty *= if *known_at_corners { 1.0 } else { OF_CORNER };
            }
            Of::Length => {
                let [length, of_vertices] = told.length.filter(|_| is_finite)?;
                (quantity.value, quantity.uncertainty) = (length, uncertainty + of_vertices);
            }
            Of::Point(point) => self.at_point(&mut quantity, (point, k))?,
            Of::Force(side) => self.force(&mut quantity, &[side], (entry, k))?,
            Of::Interface(number) => {
                let sides = scene.problem.joints().nth(number).map_or(&[][..], |interface| &interface.sides);
                self.force(&mut quantity, sides, (entry, k))?;
            }
            Of::Named(of) => self.named(&mut quantity, (of, k))?,
        }
        Some(quantity)
    }

    /// The largest pressure of all contact or of an interface.
    fn peak(&self, of: Option<usize>, k: usize) -> Option<f64> {
        let [value, _] = self.all.values[k];
        let all = self.told.peak?;
        let at_node = match of {
            None => all,
            Some(number) => self.told.interfaces.get(number)?.max_pressure.filter(|own| *own > 0.0)?,
        };
        // an exact pressure has more digits at nodes than as a traction
        let is_exact = (value - at_node).abs() <= SMALL * self.all.rounding(k);
        Some(if is_exact { at_node } else { value })
    }

    /// Doubts what depends on a piece beside a corner that no node shows.
    fn may_open(&self, quantity: &mut Quantity, depends: bool) {
        if depends && !self.known_at_corners {
            quantity.doubt(Doubt::Transition);
        }
    }

    fn at_point(&self, quantity: &mut Quantity, (point, k): (usize, usize)) -> Option<()> {
        let all = self.all;
        let Probe { point: x, stress_unbounded, .. } = self.told.probes[point];
        let is_stress = all.entries[k].kind == Kind::Stress;
        if is_stress && stress_unbounded {
            return None;
        }
        let of_stress = || is_corner(self.scene, x) || all.at_jumps.contains(&point);
        let is_weak = all.near_singular.contains(&point) || if is_stress { of_stress() } else { stress_unbounded };
        self.widen(quantity, k, is_weak);
        Some(())
    }

    /// Widens the bar of a number at a corner and doubts it.
    fn widen(&self, quantity: &mut Quantity, k: usize, is_weak: bool) {
        if is_weak && quantity.uncertainty > SMALL * self.all.rounding(k) {
            quantity.uncertainty *= OF_CORNER;
            quantity.parts.values_mut().for_each(|part| *part *= OF_CORNER);
            quantity.doubt(Doubt::Coarse);
        }
    }

    fn force(&self, quantity: &mut Quantity, sides: &[usize], (entry, k): (&Entry, usize)) -> Option<()> {
        let shared = shared(self.scene, sides)[k - entry.group.start];
        self.is_known_at_corners(quantity, shared).then_some(())?;
        self.may_open(quantity, shared);
        Some(())
    }

    /// Whether a number with or without a part in a corner that other sides share is known: not on grids.
    fn is_known_at_corners(&self, quantity: &Quantity, shared: bool) -> bool {
        !(shared && self.scene.is_on_grid()) && quantity.value.is_finite() && quantity.uncertainty.is_finite()
    }

    fn named(&self, quantity: &mut Quantity, (of, k): (usize, usize)) -> Option<()> {
        let (scene, told, entries) = (self.scene, &self.told, &self.all.entries);
        let NamedQuantity { name, kind } = &scene.quantities[of];
        if let Some((side, w)) = kind.weighted_side() {
            let shared = !works_alone(scene, side, w);
            (is_known(scene, side) && self.is_known_at_corners(quantity, shared)).then_some(())?;
            self.may_open(quantity, shared);
        }
        if told.named.pressure.get(name).is_some_and(|pressure| pressure.is_nan()) {
            return None;
        }
        // between nodes that touch only the interpolation keeps the surfaces apart
        if let QuantityKind::OpeningAt(x) = *kind
            && touches_at(told.rows, x)
        {
            quantity.uncertainty = quantity.uncertainty.max(quantity.value.abs());
        }
        let first = entries.iter().position(|entry| matches!(entry.of, Of::Named(_))).unwrap_or(0);
        if told.near.get(k - first).copied().unwrap_or(false) {
            quantity.doubt(Doubt::Transition);
        }
        Some(())
    }
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

/// Whether a point is at a corner of a side with springs: stiff ones make a layer there that is as steep as beside a support.
fn is_end_of_springs(scene: &Scene, x: [f64; 2]) -> bool {
    let sprung = scene.problem.outline.edges().iter().filter(|edge| scene.problem.sides[edge.side].springs.is_some());
    let mut ends = sprung.flat_map(|edge| [edge.start, edge.end]).filter(|&end| is_corner(scene, end));
    ends.any(|end| distance(end, x) <= OF_LAYER * scene.problem.outline.diameter())
}

/// Whether the node of contact that is nearest to a point touches.
fn touches_at(rows: &[ContactRow], x: [f64; 2]) -> bool {
    let nearest = rows.iter().min_by(|a, b| distance(a.point, x).total_cmp(&distance(b.point, x)));
    let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure));
    nearest.is_some_and(|row| row.pressure > TOUCHING * largest)
}

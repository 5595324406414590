//! Error bars of strain energy and of the work of loads.

use steklov_problem::{Condition, Law, Scene};

use super::told::OF_CORNER;
use super::{Quantities, Quantity};
use crate::bars::{Bars, Of};
use crate::doubt::Doubt;
use crate::estimate::reaction_work::{has_friction_work, has_reaction_work};

/// Strain energy and J are opposite numbers up to this part of them where a theorem says so.
const SAME_ENERGY: f64 = 1e-9;

/// The part of an energy that a mesh leaves at most between what is told and what follows from J: more is another problem.
const OF_LEFT: f64 = 0.1;

/// Gives strain energy E and load work L error bars by those of J, of the work of reactions R, of that against friction F and of the energy of
/// springs S, of the solution of a mesh as well: E = R - J - S and L = R + F - 2J, of which what is told may differ by what a mesh leaves.
pub(super) fn of_energies(
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

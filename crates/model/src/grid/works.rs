//! The work of supports and obstacles on a grid, and that against friction: with them and J the strain energy and the work of loads have
//! error bars.
//!
//! ```text
//! R = Σ over sides of the work of their forces on prescribed displacements, and on gaps along normals;  2E = L + R - F
//! F = -Σ t·u over nodes that slip, t their shear by Tresca's law
//! ```

use steklov_bem_operators::Edge;
use steklov_contact::{BoundaryCondition, Condition as ContactCondition};
use steklov_elastic::plane::dot;
use steklov_msfem::Loads;
use steklov_problem::{Condition, Scene};

use super::estimate::contact_sides;
use super::frozen_contact::FrozenContact;
use super::functionals::{GridFunctional, GridFunctionals, Number, Weight};
use super::solution::GridSolved;
use crate::energies::Energies;
use crate::estimate::reaction_work::{has_friction_work, has_reaction_work};

/// Whether the work against friction is a linear functional of the displacement.
pub(crate) fn knows_friction_work(scene: &Scene) -> bool {
    has_friction_work(scene) && scene.contacts().all(|(_, contact)| contact.friction.coefficient().is_none())
}

impl<'a> GridFunctionals<'a> {
    /// Adds both where they are quantities.
    pub fn add_works(&mut self, scene: &'a Scene, solved: &GridSolved, contact: &FrozenContact) {
        let Energies { strain, load_work, friction_work, .. } = solved.energies;
        if has_reaction_work(scene) {
            let first = self.functionals.len();
            for side in 0..scene.problem.sides.len() {
                self.functionals.extend(prescribed(scene, side).map(|w| GridFunctional::of_forces(f64::NAN, side, w)));
            }
            let sum = (first..self.functionals.len()).map(|k| (k, 1.0)).collect();
            // the energies of cells that do not conform are those of the cells apart
            let conforms = solved.coarse.as_ref().is_none_or(|coarse| coarse.basis.is_conforming());
            let value = if conforms { 2.0 * strain - load_work + friction_work } else { f64::NAN };
            self.numbers.push(Number { value, sum, off: work_between_gaps(scene, solved) });
        }
        if knows_friction_work(scene) {
            let mut functional = GridFunctional::of_load(friction_work, Loads::default());
            for pressed in contact_sides(solved) {
                let (cell, side) = pressed.side;
                let along = side % 2;
                let Some(shear) = contact.tractions.get(&pressed.side).and_then(|given| given[along]) else { continue };
                let mut moments = pressed.nodal_forces().map(|(_, force)| force);
                moments.iter_mut().for_each(|force| force[1 - along] = 0.0);
                functional.load.add_side(cell, side, moments);
                let mut traction = [0.0; 2];
                traction[along] = shear;
                functional.traction.insert(pressed.side, traction);
            }
            // between nodes that all stick there may be some slip
            let value = if functional.traction.is_empty() { f64::NAN } else { functional.value };
            self.add(GridFunctional { value, ..functional });
        }
    }
}

/// What a side prescribes: the displacement of a support that moves, or the gap of an obstacle along the normal.
fn prescribed(scene: &Scene, side: usize) -> Option<Weight<'_>> {
    let edges: Vec<&Edge> = scene.problem.outline.edges().iter().filter(|edge| edge.side == side).collect();
    let nearest = move |x: [f64; 2]| {
        let all = edges.iter().filter_map(|edge| Some((edge.nearest(x, f64::INFINITY)?, *edge)));
        all.min_by(|((a, _), _), ((b, _), _)| a.total_cmp(b)).map(|((_, s), edge)| (edge, s))
    };
    if let Some(contact) = scene.contact(side) {
        return Some(Box::new(move |x| {
            let Some((edge, s)) = nearest(x) else { return [0.0; 2] };
            let gap = contact.gap.eval(x[0], x[1], edge.drawn_fraction(s));
            edge.normal(s).map(|n| gap * n)
        }));
    }
    let Condition::Displacement { values, .. } = &scene.problem.sides[side].condition else { return None };
    if values.iter().flatten().all(|value| value.constant() == Some(0.0)) {
        return None;
    }
    Some(Box::new(move |x| {
        let Some((edge, s)) = nearest(x) else { return [0.0; 2] };
        let s = edge.drawn_fraction(s);
        values.each_ref().map(|value| value.as_ref().map_or(0.0, |value| value.eval(x[0], x[1], s)))
    }))
}

/// The work of the pressures on what the gaps of their conditions differ from those at the nodes.
fn work_between_gaps(scene: &Scene, solved: &GridSolved) -> f64 {
    let Some(contact) = &solved.contact else { return 0.0 };
    let condensed = contact.boundary.contact.iter().flat_map(|node| &node.conditions);
    let points = contact.boundary.nodes.iter().flat_map(|node| node.conditions.iter().map(|own| (node.point, own)));
    let multipliers = &contact.reported().multipliers;
    let of = |(((point, own), condition), [pressure, _]): (((_, &BoundaryCondition), &ContactCondition), &[f64; 2])| {
        let Some(w) = own.shares.first().and_then(|share| prescribed(scene, share.side)) else { return 0.0 };
        condition.normal_weight * pressure * (condition.gap - dot(w(point), own.normal)).abs()
    };
    points.zip(condensed).zip(multipliers).map(of).sum()
}

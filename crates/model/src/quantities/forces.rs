//! Error bars of forces that share corners, carry the multipliers of others, or are sums.

use std::collections::BTreeMap;

use steklov_problem::{Interface, NamedQuantity, Scene};

use super::{Quantities, Quantity, contact_between, forces_between};
use crate::reacting::{shared, shared_corners};

/// Gives forces of sides and interfaces that share corners the largest error bar of all of them, along x and along y: what one has too much
/// another one lacks; moments and weighted forces have that of what they weigh there or more.
pub(super) fn of_shared_forces(scene: &Scene, quantities: &mut Quantities) {
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

/// Gives the force of a side that alone carries the multipliers of an interface the error bar of that.
pub(super) fn of_carrying_sides(scene: &Scene, quantities: &mut Quantities, reactions: &[(String, [f64; 2])]) {
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
pub(super) fn of_contact(scene: &Scene, quantities: &mut Quantities, force: [f64; 2]) {
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

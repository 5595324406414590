//! The marks of elements that correspond in subdomains which are translates of each other, made equal, so that these stay
//! translates.

use std::collections::BTreeMap;

use steklov_bem_operators::{Mark, Mesh, Space, Subdomain};

use crate::mesh::layout::MeshedCuts;

/// Smallest part of a set of corresponding elements which is marked that marks all of them.
const MAJORITY: f64 = 0.5;

/// Gives all marked elements of a set of corresponding ones the same mark, that of the largest error, and where most of the set is
/// marked all elements of it. `marks` are those of the mesh, then those of the cuts.
pub(crate) fn join_marks(cuts: &MeshedCuts, mesh: &Mesh, space: &Space, marks: &mut [Mark]) {
    let (parts, _) = cuts.cuts.subdomains(mesh, space, &cuts.elements);
    for set in corresponding(&parts, marks.len()) {
        let marked = || set.iter().filter(|&&e| marks[e] != Mark::Keep);
        let Some(joined) = marked().map(|&e| marks[e]).reduce(larger) else { continue };
        let all = marked().count() as f64 >= MAJORITY * set.len() as f64;
        for e in set {
            if all || marks[e] != Mark::Keep {
                marks[e] = joined;
            }
        }
    }
}

/// Of two marks the one of an element that is halved, or that gets more degrees.
fn larger(a: Mark, b: Mark) -> Mark {
    let size = |mark: Mark| match mark {
        Mark::Keep => (false, 0, 0.0),
        Mark::Refine { rough, excess, degrees } => (rough, degrees, excess),
    };
    if size(a) >= size(b) { a } else { b }
}

/// The sets of elements that correspond in translates, those of more than one element.
fn corresponding(parts: &[Subdomain], elements: usize) -> Vec<Vec<usize>> {
    let first = Subdomain::first_translates(&parts.iter().collect::<Vec<_>>());
    // each element points at one of its set, the smallest of all at itself
    let mut set: Vec<usize> = (0..elements).collect();
    let smallest = |set: &[usize], mut e: usize| {
        while set[e] != e {
            e = set[e];
        }
        e
    };
    for (part, &first) in parts.iter().zip(&first) {
        for (&a, &b) in part.elements.iter().zip(&parts[first].elements) {
            let [a, b] = [a, b].map(|e| smallest(&set, e));
            set[a.max(b)] = a.min(b);
        }
    }
    let mut sets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    (0..elements).for_each(|e| sets.entry(smallest(&set, e)).or_default().push(e));
    sets.into_values().filter(|set| set.len() > 1).collect()
}

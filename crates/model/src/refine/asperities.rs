//! Meshes of contact along gaps that turn: asperities of the obstacle, and valleys between them.

use steklov_bem_operators::{Edge, Mark, Mesh, Piece, SAME_PLACE, Subdivision};
use steklov_contact::{Located, Obstacle};
use steklov_expression::Turn;
use steklov_problem::Scene;

use crate::estimate::penetration::Overlap;
use crate::mesh::first_mesh::insert_apart;

/// Part of the estimate whose elements the hp strategy refines; the same among asperities as long as many ends of contact have no
/// vertices.
pub(crate) const MARKED: f64 = 0.95;
const FIRST_MARKED: f64 = 0.7;
/// Overlaps narrower than this in the reference coordinate of their element get vertices of their own.
const NARROW: f64 = 0.5;

/// Where the gap of each edge turns: asperities of the obstacle, and valleys between them.
pub(crate) fn gap_turns(scene: &Scene) -> Vec<Vec<Turn>> {
    let of = |edge: &Edge| match scene.contact(edge.side) {
        Some(contact) if contact.gap.constant().is_none() => contact.gap.turns(edge),
        _ => Vec::new(),
    };
    scene.problem.outline.edges().iter().map(of).collect()
}

/// The part of the indicators whose elements are refined among asperities. Transitions that get vertices count with their
/// energy, and as marked: while that is most of the estimate nothing else is refined. Little is refined while many transitions
/// have no vertices, and never more than half of the tolerance requires; the tolerance is `goal` times the estimate.
pub(crate) fn part_to_mark(squared: &[f64], located: &[Located], energy: f64, goal: f64) -> f64 {
    let new = located.iter().filter(|tip| !tip.at_vertex).count();
    let part = if 4 * new > located.len() { FIRST_MARKED } else { MARKED };
    let part = part.min(1.0 - (goal / 2.0).powi(2));
    let sum: f64 = squared.iter().sum();
    if sum > 0.0 { (part - (1.0 - part) * energy / sum).max(0.0) } else { part }
}

/// Overlaps between the nodes that get vertices of their own.
pub(crate) struct Cuts<'a> {
    /// Those on elements along which the gap turns several times.
    several: Vec<&'a Overlap>,
    /// Others that are narrow.
    narrow: Vec<&'a Overlap>,
}

impl<'a> Cuts<'a> {
    pub(crate) fn new(mesh: &Mesh, turns: &[Vec<Turn>], overlaps: &'a [Overlap]) -> Self {
        let turns_within = |e: usize| {
            let [a, b] = mesh.span[e];
            turns[mesh.edge[e]].iter().filter(|turn| is_inside(turn, a.min(b), a.max(b))).count()
        };
        let (several, single): (Vec<&Overlap>, Vec<&Overlap>) =
            overlaps.iter().partition(|o| turns_within(o.element) > 1);
        let narrow = single.into_iter().filter(|o| o.at[2] - o.at[0] < NARROW).collect();
        Self { several, narrow }
    }

    /// The elements they lie on.
    pub(crate) fn elements(&self) -> impl Iterator<Item = usize> {
        self.several.iter().chain(&self.narrow).map(|o| o.element)
    }

    /// Makes the vertices.
    pub(crate) fn insert(&self, subdivision: &mut Subdivision, mesh: &Mesh, turns: &[Vec<Turn>]) {
        for overlap in &self.several {
            insert_turns(subdivision, mesh, overlap, &turns[mesh.edge[overlap.element]]);
        }
        for overlap in &self.narrow {
            let (e, edge) = (overlap.element, mesh.edge[overlap.element]);
            let at = overlap.at.map(|t| mesh.edge_parameter(e, t));
            insert_apart(subdivision, edge, at);
            // the valleys on both sides, so that no other asperity shares its elements
            let valleys = turns[edge].iter().filter(|t| t.maximum).map(|t| t.at);
            let before = valleys.clone().filter(|s| *s < at[1]).fold(f64::NEG_INFINITY, f64::max);
            let after = valleys.filter(|s| *s > at[1]).fold(f64::INFINITY, f64::min);
            insert_apart(subdivision, edge, [before, at[1], after]);
        }
    }
}

/// Vertices at all asperities of an overlap, and at the valleys next to them.
fn insert_turns(subdivision: &mut Subdivision, mesh: &Mesh, overlap: &Overlap, turns: &[Turn]) {
    let edge = mesh.edge[overlap.element];
    let ends = [overlap.at[0], overlap.at[2]].map(|t| mesh.edge_parameter(overlap.element, t));
    let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
    let first = turns.partition_point(|t| t.at < low);
    let last = turns.partition_point(|t| t.at <= high);
    let from = if turns.get(first).is_some_and(|t| t.maximum) { first } else { first.saturating_sub(1) };
    for turn in &turns[from..(last + 1).min(turns.len())] {
        subdivision.insert(edge, turn.at, &[], 0.0);
    }
}

/// The same for the contact crate.
pub(crate) fn obstacles(turns: &[Vec<Turn>]) -> Vec<Obstacle> {
    let of = |turns: &Vec<Turn>| {
        let (valleys, peaks): (Vec<Turn>, Vec<Turn>) = turns.iter().partition(|t| t.maximum);
        Obstacle { valleys: valleys.iter().map(|t| t.at).collect(), peaks: peaks.iter().map(|t| t.at).collect() }
    };
    turns.iter().map(of).collect()
}

/// Whether a gap turns between two vertices; one of them may be at the turn up to rounding.
fn is_inside(turn: &Turn, start: f64, end: f64) -> bool {
    turn.at - start > SAME_PLACE && end - turn.at > SAME_PLACE
}

/// Cuts the marked contact elements along which the gap turns twice or more: the multipliers of a degree that does not follow the
/// gap feel contact where there is none. Those whose error is that of the gap are cut at all asperities and valleys, others
/// at one valley.
pub(crate) fn cut_at_turns(subdivision: &mut Subdivision, turns: &[Vec<Turn>], rough: &dyn Fn(usize, &Piece) -> bool) {
    for (edge, turns) in turns.iter().enumerate() {
        let mut cuts = Vec::new();
        for piece in subdivision.edges[edge].iter_mut().filter(|p| p.mark != Mark::Keep) {
            let inside = || turns.iter().filter(|turn| is_inside(turn, piece.start, piece.end));
            let off = |t: &&Turn| (t.at - (piece.start + piece.end) / 2.0).abs();
            let valley = inside().filter(|t| t.maximum).min_by(|a, b| off(a).total_cmp(&off(b)));
            let (true, Some(valley)) = (inside().count() > 1, valley) else { continue };
            if rough(edge, piece) {
                cuts.extend(inside().map(|t| t.at));
            } else {
                cuts.push(valley.at);
            }
            piece.mark = Mark::Keep;
        }
        cuts.into_iter().for_each(|s| subdivision.insert(edge, s, &[], 0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(pieces: &[[f64; 2]], turns: &[(f64, bool)]) -> Vec<Piece> {
        let mark = Mark::refine(false, 1.0);
        let piece = |&[start, end]: &[f64; 2]| Piece { start, end, degree: 1, mark };
        let mut subdivision = Subdivision { edges: vec![pieces.iter().map(piece).collect()] };
        let turns = turns.iter().map(|&(at, maximum)| Turn { at, maximum }).collect();
        cut_at_turns(&mut subdivision, &[turns], &|_, _| false);
        subdivision.edges.remove(0)
    }

    /// An element from valley to valley with one asperity is not cut, and keeps its mark, though its ends are beside the valleys by
    /// rounding: it was left alone for ever.
    #[test]
    fn valleys_at_the_ends_of_an_element_are_not_inside() {
        let (a, b) = (0.92626953125, 0.948974609375);
        let turns = [(a, true), (0.939, false), (b, true)];
        for ends in [[a, b], [a - 3e-16, b + 3e-16], [a + 3e-16, b - 3e-16]] {
            let pieces = after(&[[0.0, ends[0]], ends, [ends[1], 1.0]], &turns);
            assert_eq!(pieces.len(), 3);
            assert!(pieces.iter().all(|piece| piece.mark != Mark::Keep), "{pieces:?}");
        }
        // with a valley inside it is cut there instead
        let pieces = after(&[[0.0, 1.0]], &turns);
        assert_eq!(pieces.iter().map(|piece| piece.start).collect::<Vec<_>>(), [0.0, a]);
        assert!(pieces.iter().all(|piece| piece.mark == Mark::Keep));
    }
}

//! Error bars of the lengths of contact, stick and slip whose ends are fitted to nodes.
//!
//! ```text
//! an end of a zone     1.2 max(|δ_k|, |δ_{k-1}| E_k/E_{k-1}) + 0.3 |δ_k|          δ_k its shift from its vertex at step k, E the estimate
//!                      1.5 times the way from the nodes between which contact ends to the fit, where that is more, and 0.005 h
//!                      μ β h under Coulomb's law, where that is more        β Dundurs' second parameter, h the distance of the nodes beside it
//! a length             Σ over its ends, and to the next node of corners that contact may or may not reach
//! on a grid            Σ over its ends of the distance of the nodes about them
//! ```
//! Vertices follow the fits, so that δ_k is the change of the end since the step before. Under Coulomb's law, where the fit does not know the
//! exponents of gap and slip, small shifts do not fall with the estimate: up to 4e-3 of the distance to the next end those of the two steps
//! before count whole, and where the mesh about an end stays as it is the fit stays as far off as the exponent differs from ½: atan(μβ)/π, Comninou
//! (1977). A zone of stick that reaches an end of contact, a
//! corner or a reversal of slip has no bar: the slip between them is narrower than what nodes see.

use steklov_bem_operators::{Edge, SAME_PLACE};
use steklov_contact::{LinePoint, Located, TipKind};
use steklov_elastic::plane::{distance, norm};
use steklov_problem::{Friction, Scene};

use crate::answer::report::{sticks, zones};
use crate::bars::{OF_CHANGE, OF_DIFFERENCE, ROUNDED};
use crate::contact_length::{is_extractable, is_symmetric, rows_along, unknown_at_corners, unsure_at_tips};
use crate::refine::transitions::zone;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, TOUCHING, Trace};

/// How far off the fit of an end of contact to nodes is at least, over their distance: 0.003 was measured where meshes stay as they are.
const OF_NODES: f64 = 0.005;
/// Shifts that do not fall under Coulomb's law, over the distance to the next end.
const STALLED: f64 = 4e-3;

/// How far each transition may be off (length), in the order of those of the last of two or three steps, between the last two of which the estimate
/// has fallen to the part `fallen`; none unless each has a vertex, and the steps before have the same ones.
pub(crate) fn off_by_fits(scene: &Scene, steps: &[&[Located]], fallen: f64) -> Option<Vec<f64>> {
    let (last, before) = steps.split_last()?;
    let edges = scene.problem.outline.edges();
    let rank = |all: &[Located], of: &Located| {
        all.iter().filter(|own| (own.edge, own.kind) == (of.edge, of.kind) && own.s < of.s).count()
    };
    let shift_in = |step: &[Located], end: &Located| {
        let mut same = step.iter().filter(|own| (own.edge, own.kind) == (end.edge, end.kind));
        Some(same.find(|own| rank(step, own) == rank(last, end))?.off.abs())
    };
    let of = |end: &Located| {
        let shifts: Vec<f64> = before.iter().map(|step| shift_in(step, end)).collect::<Option<_>>()?;
        let edge = &edges[end.edge];
        let coulomb = scene.contact(edge.side)?.friction.coefficient().is_some();
        let stalls = if coulomb { STALLED * zone(end, last) } else { 0.0 };
        let stalled = shifts.iter().fold(0.0, |most: f64, shift| most.max(shift.min(stalls)));
        let memory = stalled.max(fallen * shifts.last()?);
        let off = OF_DIFFERENCE * end.off.abs().max(memory) + OF_CHANGE * end.off.abs();
        let [a, b] = [end.s - off, end.s + off].map(|s| edge.arc_fraction(s.clamp(0.0, 1.0)));
        Some((b - a) / 2.0 * edge.length())
    };
    let same = before.iter().all(|step| step.len() == last.len());
    (same && last.iter().all(|end| end.at_vertex)).then(|| last.iter().map(of).collect())?
}

/// The same where nodes tell more: fits of ends of contact that lie beyond the nodes between which contact ends stand still and are wrong, and
/// under Coulomb's law a fit is as far off as its nodes are apart, times the mismatch of the materials and μ. Ends that are extracted are better
/// known than by nodes.
pub(crate) fn off_by_nodes(
    scene: &Scene,
    trace: Trace<'_>,
    (contact, rows): (&ContactResult, &[ContactRow]),
    (located, off): (&[Located], &[f64]),
) -> Vec<f64> {
    let edges = scene.problem.outline.edges();
    let lines = contact.boundary.lines(trace.mesh, trace.space);
    // pairs of neighbouring nodes on an edge
    let pairs =
        |edge: usize| lines.iter().filter(move |line| line.edge == edge).flat_map(|line| line.points.windows(2));
    let beyond = |end: &Located| {
        let is_end = |pair: &&[LinePoint]| {
            let [a, b] = [0, 1].map(|k: usize| rows[pair[k].index].pressure > 0.0);
            a != b
        };
        let ways = pairs(end.edge).filter(is_end).map(|pair| (pair[0].s - end.s).max(end.s - pair[1].s).max(0.0));
        ways.min_by(f64::total_cmp).unwrap_or(0.0)
    };
    let apart = |end: &Located| {
        // a fit is beside its vertex, if not at it
        let near = end.off.abs() + SAME_PLACE;
        let beside = pairs(end.edge).filter(|pair| pair[0].s <= end.s + near && pair[1].s >= end.s - near);
        beside.map(|pair| pair[1].s - pair[0].s).fold(0.0, f64::max)
    };
    let coefficient = |side: usize| {
        let pressed = rows.iter().filter(|row| row.side == side && row.pressure > 0.0);
        pressed.map(|row| row.bound / row.pressure).fold(0.0, f64::max)
    };
    let of = |(end, &off): (&Located, &f64)| {
        let edge = &edges[end.edge];
        let speed = norm(edge.derivative(end.s));
        let fitted = end.kind == TipKind::ContactEnd && !is_extractable(scene, edge);
        let of_fit =
            if fitted { ((OF_DIFFERENCE + OF_CHANGE) * beyond(end)).max(OF_NODES * apart(end)) * speed } else { 0.0 };
        let is_coulomb = scene.contact(edge.side).is_some_and(|own| own.friction.coefficient().is_some());
        let of_exponent = if is_coulomb && end.kind != TipKind::SlipReversal {
            coefficient(edge.side) * scene.problem.dundurs_beta(end.edge) * apart(end) * speed
        } else {
            0.0
        };
        off.max(of_fit).max(of_exponent)
    };
    located.iter().zip(off).map(of).collect()
}

/// What the lengths of zones need of a solution.
#[derive(Clone, Copy)]
pub(crate) struct Zones<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) trace: Trace<'a>,
    pub(crate) contact: &'a ContactResult,
    /// The contact table.
    pub(crate) rows: &'a [ContactRow],
    /// Where zones end, and how far each end may be off.
    pub(crate) located: &'a [Located],
    pub(crate) off: &'a [f64],
    /// Whether the solution is exact.
    pub(crate) is_exact: bool,
}

impl Zones<'_> {
    /// The lengths in contact and in stick on some sides with their uncertainties, where they are known. Without friction nothing sticks.
    pub(crate) fn lengths(&self, sides: &[usize]) -> [Option<[f64; 2]>; 2] {
        let edges = self.scene.problem.outline.edges();
        let of_sides = |end: &Located| sides.contains(&edges[end.edge].side);
        let own: Vec<ContactRow> = self.rows.iter().filter(|row| sides.contains(&row.side)).copied().collect();
        let largest = |rows: &[ContactRow]| rows.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure));
        if largest(&own) == 0.0 {
            return [None; 2];
        }
        let at_corners = if self.is_exact { 0.0 } else { self.off_at_corners(&own) };
        let located: Vec<Located> = self.located.iter().filter(|end| of_sides(end)).copied().collect();
        let contact = (self.contact, sides, largest(self.rows));
        let [length, stick] = zones(self.scene, self.trace, contact, Some(&located)).map(|zone| Some(zone?.0));
        let Some(length) = length else { return [None; 2] };
        let bar = |kind: TipKind| {
            let ends = self.located.iter().zip(self.off).filter(|(end, _)| of_sides(end) && end.kind == kind);
            (ends.map(|(_, off)| off).sum::<f64>() + at_corners).max(ROUNDED * length)
        };
        let stick = if sides.iter().any(|&side| rubs(self.scene, side)) {
            stick.filter(|_| self.slips_beside_ends(&own, &located)).map(|stick| [stick, bar(TipKind::StickEnd)])
        } else {
            Some([0.0; 2])
        };
        [Some([length, bar(TipKind::ContactEnd)]), stick]
    }

    /// The distances of the nodes next to the corners, and to the tips of cracks, that contact may or may not reach.
    fn off_at_corners(&self, rows: &[ContactRow]) -> f64 {
        let edges = self.scene.problem.outline.edges();
        let next = |(edge, end): (usize, f64)| {
            let at = edges[edge].point(end);
            let mut all: Vec<f64> =
                rows_along(self.scene, rows, edges[edge].side).map(|row| distance(row.point, at)).collect();
            all.sort_by(f64::total_cmp);
            all.get(1).copied().unwrap_or_else(|| edges[edge].length())
        };
        unknown_at_corners(self.scene, rows).into_iter().chain(unsure_at_tips(self.scene, rows)).map(next).sum()
    }

    /// How far each of these ends of contact may be off, x and y; none of one that is not located.
    pub(crate) fn ends(&self, ends: &[[f64; 2]]) -> Vec<Option<[f64; 2]>> {
        let edges = self.scene.problem.outline.edges();
        let rounding = ROUNDED * self.scene.problem.outline.diameter();
        let of = |&x: &[f64; 2]| {
            let place = |end: &Located| edges[end.edge].point(end.s);
            let mut own = self.located.iter().zip(self.off).filter(|(end, _)| end.kind == TipKind::ContactEnd);
            let off = own
                .find(|(end, _)| place(end) == x)
                .map(|(end, off)| edges[end.edge].tangent(end.s).map(|t| off * t.abs()));
            off.map(|off| off.map(|off| off.max(rounding)))
        };
        ends.iter().map(of).collect()
    }

    /// Whether the nodes in contact nearest to each end of contact and of an edge slip, all to one side between two zones of stick. At a line
    /// of symmetry, whose support holds the tangent, stick is what belongs there.
    fn slips_beside_ends(&self, rows: &[ContactRow], located: &[Located]) -> bool {
        let edges = self.scene.problem.outline.edges();
        let pressed = |side: usize| rows.iter().filter(move |row| row.side == side && row.pressure > 0.0);
        let slips_at = |side: usize, x: [f64; 2]| {
            let nearest = pressed(side).min_by(|a, b| distance(a.point, x).total_cmp(&distance(b.point, x)));
            nearest.is_none_or(|row| row.status != STICKS)
        };
        let at_ends = |end: &Located| match end.kind {
            TipKind::ContactEnd => slips_at(edges[end.edge].side, edges[end.edge].point(end.s)),
            TipKind::StickEnd => true,
            TipKind::SlipReversal => false,
        };
        let touching = edges.iter().enumerate().filter(|(_, edge)| pressed(edge.side).next().is_some());
        let mut corners = touching.flat_map(|(k, edge)| [0.0, 1.0].map(|s| (k, edge, s)));
        located.iter().all(at_ends)
            && corners.all(|(k, edge, s)| slips_at(edge.side, edge.point(s)) || is_symmetric(self.scene, k, s))
    }
}

/// Whether a side has friction.
pub(crate) fn rubs(scene: &Scene, side: usize) -> bool {
    scene.contact(side).is_some_and(|contact| !matches!(contact.friction, Friction::None))
}

/// The status of a row that sticks.
const STICKS: usize = 1;

/// The lengths in contact and in stick of all contact by nodes, with their uncertainties: each end is off by the distance of the nodes about it
/// at most, and contact that reaches a corner by that of the last ones, if it is not known to press there.
pub(crate) fn lengths_of_nodes(
    trace: Trace<'_>,
    (contact, rows): (&ContactResult, &[ContactRow]),
    edges: &[Edge],
    known_at_corners: bool,
) -> [[f64; 2]; 2] {
    let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row.pressure));
    let lines = contact.boundary.lines(trace.mesh, trace.space);
    [false, true].map(|stick| {
        let is_in =
            |k: usize| rows[k].pressure > TOUCHING * largest && (!stick || sticks(rows[k].shear, rows[k].bound));
        let length =
            rows.iter().enumerate().filter(|(k, _)| is_in(*k)).map(|(_, row)| row.weight).fold(0.0, |a, b| a + b);
        let mut off: f64 = 0.0;
        for line in &lines {
            for pair in line.points.windows(2) {
                let [a, b] = [0, 1].map(|k| (pair[k].index, pair[k].s));
                off += if is_in(a.0) == is_in(b.0) { 0.0 } else { (b.1 - a.1) * edges[line.edge].length() };
            }
            let [first, last] = [line.points.windows(2).next(), line.points.windows(2).next_back()];
            let at_ends = [first.map(|pair| (pair, 0)), last.map(|pair| (pair, 1))].into_iter().flatten();
            off += at_ends
                .filter(|(pair, end)| is_in(pair[*end].index) && !known_at_corners)
                .map(|(pair, _)| (pair[1].s - pair[0].s) * edges[line.edge].length())
                .sum::<f64>();
        }
        [length, off.max(ROUNDED * length)]
    })
}

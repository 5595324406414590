//! Contact in numbers and as a table, from a solved mesh.

use steklov_bem_operators::{Edge, SAME_PLACE};
use steklov_contact::{Condition, Located, TipKind};
use steklov_problem::{Place, Refine, Scene};

use crate::answer::singular_points::is_pressure_unbounded;
use crate::energies::Energies;
use crate::mesh::first_mesh::singular_points;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, TOUCHING, Trace, max_pressure};
use crate::summary::{ContactSummary, Stabilisation, Summary};

/// Lengths, largest pressure and resultant; `located`: where contact and stick are believed to end.
pub fn contact_summary(
    scene: &Scene,
    trace: Trace<'_>,
    contact: &ContactResult,
    rows: &[ContactRow],
    located: Option<&[Located]>,
) -> ContactSummary {
    let sides: Vec<usize> = scene.contacts().map(|(side, _)| side).collect();
    summary_of_sides(scene, trace, contact, rows, &sides, max_pressure(rows), located)
}

/// Lengths, largest pressure and resultant of sides, given by their rows, numbers and the largest pressure of all; `located`:
/// where contact and stick are believed to end.
pub(crate) fn summary_of_sides(
    scene: &Scene,
    trace: Trace<'_>,
    contact: &ContactResult,
    rows: &[ContactRow],
    sides: &[usize],
    largest: f64,
    located: Option<&[Located]>,
) -> ContactSummary {
    let on_sides = |l: &&Located| sides.contains(&scene.problem.outline.edges()[l.edge].side);
    let located: Option<Vec<Located>> = located.map(|all| all.iter().filter(on_sides).copied().collect());
    let located = located.as_deref();
    let weight_of = |of: &dyn Fn(&ContactRow) -> bool| {
        rows.iter().filter(|r| of(r)).map(|r| r.weight).fold(0.0, |a, b| a + b) // sum() of nothing is -0
    };
    let touches = |r: &ContactRow| r.pressure > TOUCHING * largest;
    // where nothing presses, touching has no ends
    let located = located.map(|located| if max_pressure(rows) > 0.0 { located } else { &[] });
    let [ends, stick] = zones(scene, trace, (contact, sides, largest), located);
    let length = ends.as_ref().map_or_else(|| weight_of(&touches), |(length, _)| *length);
    let stick = stick.map_or_else(|| weight_of(&|r| touches(r) && sticks(r.shear, r.bound)), |(stick, _)| stick);
    let stick = stick.min(length);
    let mut force = [0.0; 2];
    for &side in sides {
        // against another body that on the side which is named first
        let second = scene.problem.joint(side).is_some_and(|interface| interface.place == Place::Second);
        let part = contact.force(side).map(|f| if second { -f } else { f });
        force = [force[0] + part[0], force[1] + part[1]];
    }
    let point = |(edge, s): (usize, f64)| scene.problem.outline.edges()[edge].point(s);
    ContactSummary {
        // it is meaningless unless the solver converged
        contraction: contact.coulomb.filter(|_| contact.converged()).map(|c| c.contraction),
        length,
        stick,
        slip: length - stick,
        max_pressure: max_pressure(rows),
        max_pressure_unbounded: is_pressure_unbounded(scene, trace.mesh, rows),
        force,
        stabilisation: contact
            .stabilised
            .as_ref()
            .map(|s| Stabilisation { gamma: s.gamma, critical_gamma: s.critical }),
        ends: ends.map(|(_, ends)| ends.into_iter().map(point).collect()),
    }
}

/// A length with the transitions that bound its parts: edge and edge parameter.
type Zone = (f64, Vec<(usize, f64)>);

/// The length in contact and that which sticks, by the transitions that are `located` on these sides; none where one has no vertex, or where
/// the nodes between them do not agree.
pub(crate) fn zones(
    scene: &Scene,
    trace: Trace<'_>,
    (contact, sides, largest): (&ContactResult, &[usize], f64),
    located: Option<&[Located]>,
) -> [Option<Zone>; 2] {
    [false, true].map(|stick| {
        let tips = vertices(located, &|kind| stick || kind == TipKind::ContactEnd)?;
        let tips = with_singular(scene, trace, (contact, sides, largest), tips, stick);
        Some((length_between(scene, trace, (contact, sides, largest), &tips, stick)?, tips))
    })
}

/// Energies, contact and reactions of an answer: the numbers that one outcome of random input has.
pub(crate) fn figures(
    scene: &Scene,
    energies: &Energies,
    (contact, trace): (Option<&ContactResult>, Trace<'_>),
    reactions: &[(String, [f64; 2])],
    rows: &[ContactRow],
) -> Summary {
    Summary {
        energy: energies.total,
        strain_energy: energies.strain,
        spring_energy: scene.problem.has_springs().then_some(energies.springs),
        load_work: energies.load_work,
        friction_work: energies.friction_work,
        contact: contact.map(|c| contact_summary(scene, trace, c, rows, None)),
        reactions: reactions.iter().cloned().collect(),
        ..Summary::default()
    }
}

/// The transitions of a step on a mesh that has vertices for them; none for other strategies.
pub fn located<'a>(scene: &Scene, of_step: &'a [Located]) -> Option<&'a [Located]> {
    (scene.method.refine == Refine::Hp).then_some(of_step)
}

/// Edge and edge parameter of the transitions of some kinds, rising; none where one has no vertex.
fn vertices(located: Option<&[Located]>, of: &dyn Fn(TipKind) -> bool) -> Option<Vec<(usize, f64)>> {
    let tips = located?.iter().filter(|l| of(l.kind));
    let mut tips = tips.map(|l| l.at_vertex.then_some((l.edge, l.s))).collect::<Option<Vec<_>>>()?;
    tips.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    Some(tips)
}

/// Whether each condition is closed, or sticks, by the states of biorthogonal multipliers.
fn states(contact: &ContactResult, max_pressure: f64, stick: bool) -> Vec<bool> {
    let conditions = contact.boundary.contact.iter().flat_map(|node| &node.conditions);
    let state = |(condition, &[pressure, shear]): (&Condition, &[f64; 2])| {
        pressure > TOUCHING * max_pressure && (!stick || sticks(shear, condition.limit(pressure)))
    };
    conditions.zip(&contact.solution.multipliers).map(state).collect()
}

/// Transitions with those at singular points of the data, such as the ends of a stamp, which are not located: where the
/// nodes beside the point differ in their states.
fn with_singular(
    scene: &Scene,
    trace: Trace<'_>,
    (contact, sides, max_pressure): (&ContactResult, &[usize], f64),
    mut transitions: Vec<(usize, f64)>,
    stick: bool,
) -> Vec<(usize, f64)> {
    let states = states(contact, max_pressure, stick);
    let (edges, singular) = (scene.problem.outline.edges(), singular_points(scene, true));
    let lines = contact.boundary.lines(trace.mesh, trace.space);
    for line in lines.iter().filter(|line| sides.contains(&edges[line.edge].side)) {
        for &s in &singular[line.edge] {
            let before = line.points.iter().rfind(|p| p.s < s - SAME_PLACE);
            let Some((a, b)) = before.zip(line.points.iter().find(|p| p.s > s + SAME_PLACE)) else { continue };
            let known = transitions.iter().any(|t| t.0 == line.edge && a.s <= t.1 && t.1 <= b.s);
            if !known && states[a.index] != states[b.index] {
                transitions.push((line.edge, s));
            }
        }
    }
    transitions.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    transitions
}

/// Largest part of the weight of the nodes between two transitions that may differ from the others: nodes next to a transition
/// alternate.
const FEW: f64 = 0.1;

/// Length of the parts of contact edges between transitions that are closed, or that stick, by the states of biorthogonal
/// multipliers, to which the transitions belong. None if the nodes of a part do not agree, or if there are none inside.
fn length_between(
    scene: &Scene,
    trace: Trace<'_>,
    (contact, sides, max_pressure): (&ContactResult, &[usize], f64),
    transitions: &[(usize, f64)],
    stick: bool,
) -> Option<f64> {
    let conditions: Vec<&Condition> = contact.boundary.contact.iter().flat_map(|node| &node.conditions).collect();
    let states = states(contact, max_pressure, stick);
    let lines = contact.boundary.lines(trace.mesh, trace.space);
    let mut length = 0.0;
    for (k, edge) in scene.problem.outline.edges().iter().enumerate() {
        if !sides.contains(&edge.side) {
            continue;
        }
        // an edge that faces nothing has no conditions
        if scene.problem.joint(edge.side).is_some() && lines.iter().all(|line| line.edge != k) {
            continue;
        }
        let points = &lines.iter().find(|line| line.edge == k)?.points;
        let mut knots = vec![0.0];
        knots.extend(transitions.iter().filter(|t| t.0 == k).map(|t| t.1));
        let faces = scene.problem.joint(edge.side).map_or(Vec::new(), |interface| scene.problem.spans(interface));
        knots.extend(faces.iter().filter(|span| span.edge == k).flat_map(|span| span.s));
        knots.push(1.0);
        knots.sort_by(f64::total_cmp);
        knots.dedup_by(|b, a| *b - *a < SAME_PLACE);
        // the states at transitions themselves show nothing
        let off = if knots.len() > 2 { SAME_PLACE } else { -SAME_PLACE };
        for part in knots.windows(2) {
            let (mut with, mut all) = (0.0, 0.0);
            for point in points.iter().filter(|p| part[0] + off < p.s && p.s < part[1] - off) {
                let weight = conditions[point.index].normal_weight;
                all += weight;
                with += if states[point.index] { weight } else { 0.0 };
            }
            // an end of the edge that presses is not in an open part
            let pressed = |end: f64| points.iter().any(|p| (p.s - end).abs() < SAME_PLACE && states[p.index]);
            let at_ends = !stick && (part[0] == 0.0 && pressed(0.0) || part[1] == 1.0 && pressed(1.0));
            if all == 0.0 && !faces.is_empty() {
                continue;
            }
            match with / all {
                share if share > 1.0 - FEW => length += fraction(edge, part[0], part[1]) * edge.length(),
                share if share < FEW && !at_ends => {}
                _ => return None,
            }
        }
    }
    Some(length)
}

/// Fraction of the length of an edge between two parameters.
fn fraction(edge: &Edge, from: f64, to: f64) -> f64 {
    if edge.is_arc_length() { to - from } else { edge.arc_fraction(to) - edge.arc_fraction(from) }
}

/// Whether a node in contact sticks.
pub(crate) fn sticks(shear: f64, bound: f64) -> bool {
    shear.abs() < bound * (1.0 - 1e-12)
}

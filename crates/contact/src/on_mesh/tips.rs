//! Mesh vertices that follow the transitions of contact and of stick.

use steklov_bem_operators::{SAME_PLACE, Subdivision};

use crate::on_mesh::transitions::{TipFit, TipKind, TipVertex, Transition, first_guess, nodal_guess, tip_fits};
use crate::{ContactError, ContactLine, Problem, Sets, Solution};

/// A transition that has a mesh vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tip {
    /// Edge of the polygon.
    pub edge: usize,
    /// Edge parameter of the vertex.
    pub s: f64,
    /// What changes there.
    pub kind: TipKind,
    /// 1 if the regular side (open, slipping) has the larger edge parameter, -1 if the smaller one, 0 for a reversal.
    pub regular: i8,
}

/// Where a transition is believed to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located {
    /// Edge of the polygon.
    pub edge: usize,
    /// Edge parameter.
    pub s: f64,
    /// What changes there.
    pub kind: TipKind,
    /// How far that is from the vertex that the mesh has for it; half of the bracket if it has none (edge parameter).
    pub off: f64,
    /// B of the gap or slip B d^(3/2), d in edge parameters, where it was fitted.
    pub curvature: Option<f64>,
    /// Whether the mesh has a vertex for it.
    pub at_vertex: bool,
}

impl Located {
    /// A transition without a vertex: it may be off by half of its bracket.
    fn unlocated(edge: usize, transition: &Transition, s: f64) -> Self {
        let [low, high] = transition.bracket;
        Self { edge, s, kind: transition.kind, off: (high - low) / 2.0, curvature: None, at_vertex: false }
    }
}

/// A tip takes a transition closer than this part of its edge.
const REACH: f64 = 0.25;
/// A transition closer than this part of its bracket to a singular point belongs to it.
const NEAR: f64 = 0.2;
/// A vertex closer than this part of its piece is moved to a new tip.
const SNAP: f64 = 0.2;
/// Number of bracket widths by which a tip may leave its bracket in one step.
const TRUST: f64 = 1.0;
/// Part of the distance to the neighbouring singular point that a tip may go in one step.
const FARTHEST: f64 = 0.45;
/// No vertex is made closer to a singular point or to another tip than this part of the edge.
const CLOSEST: f64 = 1e-9;

/// A solved contact problem on a mesh.
#[derive(Clone, Copy)]
pub struct Solved<'a> {
    /// The condensed problem.
    pub problem: &'a Problem,
    /// Its solution.
    pub solution: &'a Solution,
    /// The sets of the solution.
    pub sets: &'a Sets,
    /// The contact boundary by edges.
    pub lines: &'a [ContactLine],
    /// The transitions of each line that count.
    pub transitions: &'a [Vec<Transition>],
}

/// Edge and edge parameter of a vertex at an end of contact, and where the end is, which is better known than by a fit.
pub type KnownEnd = (usize, f64, TipFit);

/// The obstacle along an edge (edge parameters).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Obstacle {
    /// Where the gap is largest between two asperities: no tip passes there.
    pub valleys: Vec<f64>,
    /// Where the gap is smallest: vertices there stay.
    pub peaks: Vec<f64>,
}

/// A transition, and the vertex that follows it.
struct Followed<'a> {
    line: &'a ContactLine,
    tip: Tip,
    transition: Transition,
    /// Whether the mesh has had the vertex before.
    old: bool,
}

/// Moves tips to where the solution has its transitions, drops those without one (their vertices stay), and gives each
/// new transition a vertex. `singular[k]`: the other singular points of edge k, its ends included; `obstacles[k]`: the obstacle
/// along it.
///
/// A tip takes the nearest transition of its kind and direction. Contact and stick ends that are not `known` are fitted ([`tip_fits`]) and move at
/// most to the bracket of their transition and its width on both sides; a reversal of slip keeps its vertex. Returns the
/// believed positions of the transitions, except those at a singular point and those of single nodes that differ from their
/// neighbours on both sides.
///
/// # Errors
/// [`ContactError::Decomposition`].
pub fn relocate(
    tips: &mut Vec<Tip>,
    subdivision: &mut Subdivision,
    solved: Solved<'_>,
    singular: &[Vec<f64>],
    (obstacles, known): (&[Obstacle], &[KnownEnd]),
) -> Result<Vec<Located>, ContactError> {
    let (followed, uncut) = follow_all(tips, subdivision, solved, singular, obstacles);
    let mut places = Vec::with_capacity(followed.len());
    let mut moved: Vec<Tip> = followed.iter().filter(|f| f.old).map(|f| f.tip).collect();
    let mut next = 0;
    for (f, place) in followed.iter().zip(located(&followed, solved, singular, (obstacles, known))?) {
        let Tip { edge, s, kind, .. } = f.tip;
        let of_edge = |own: usize| {
            let others = moved.iter().enumerate().filter(|(j, t)| *j != own && t.edge == edge).map(|(_, t)| t.s);
            others.chain(singular[edge].iter().copied()).collect::<Vec<f64>>()
        };
        if f.old {
            let mut fixed = of_edge(next);
            fixed.extend(&obstacles[edge].valleys);
            let to = step(f.tip, &f.transition, place.s, &fixed);
            // among asperities a vertex at an end of the bracket may be where it belongs: nothing shows where else it should go
            let [low, high] = f.transition.bracket;
            let told = obstacles[edge].valleys.is_empty()
                || place.curvature.is_some()
                || s < low - SAME_PLACE
                || s > high + SAME_PLACE
                || nodal_guess(f.line, &f.transition, solved.problem, solved.solution).is_some();
            if told && kind != TipKind::SlipReversal && (to - s).abs() > 1e-10 {
                subdivision.shift(edge, s, to, &fixed);
                moved[next].s = to;
            }
            next += 1;
        } else {
            // the others may have moved there
            let mut fixed = of_edge(usize::MAX);
            if new_vertex(&f.transition, s, subdivision, edge, &singular[edge], &fixed).is_none() {
                continue;
            }
            fixed.extend(obstacles[edge].valleys.iter().chain(&obstacles[edge].peaks));
            subdivision.insert(edge, s, &fixed, SNAP);
            moved.push(f.tip);
        }
        places.push(place);
    }
    places.extend(uncut);
    tips.extend(moved);
    tips.sort_by(|a, b| a.edge.cmp(&b.edge).then(a.s.total_cmp(&b.s)));
    Ok(places)
}

/// The transitions that tips follow, old and new ones, and those that stay without a vertex.
fn follow_all<'a>(
    tips: &mut Vec<Tip>,
    subdivision: &mut Subdivision,
    solved: Solved<'a>,
    singular: &[Vec<f64>],
    obstacles: &[Obstacle],
) -> (Vec<Followed<'a>>, Vec<Located>) {
    let mut followed: Vec<Followed<'a>> = Vec::new();
    let mut uncut = Vec::new();
    for (line, found) in solved.lines.iter().zip(solved.transitions) {
        let edge = line.edge;
        let mine: Vec<Tip> = tips.iter().copied().filter(|t| t.edge == edge).collect();
        let found = without_flicker(found.clone(), &mine);
        let found = one_zone_an_asperity(found, &obstacles[edge]);
        let mut used = vec![false; found.len()];
        tips.retain(|t| t.edge != edge);
        let first = followed.len();
        for tip in mine {
            if let Some(j) = follow(tip, line, &found, &used, solved, &obstacles[edge].valleys, &singular[edge]) {
                used[j] = true;
                followed.push(Followed { line, tip, transition: found[j], old: true });
            }
        }
        for transition in found.iter().zip(&used).filter(|(_, used)| !**used).map(|(t, _)| *t) {
            if cut_at_turns(subdivision, edge, &transition, &obstacles[edge]) {
                uncut.push(Located::unlocated(
                    edge,
                    &transition,
                    first_guess(line, &transition, solved.problem, solved.solution),
                ));
                continue;
            }
            let on_edge = followed[first..].iter().map(|f| f.tip.s);
            let points: Vec<f64> = on_edge.chain(singular[edge].iter().copied()).collect();
            let guess = first_guess(line, &transition, solved.problem, solved.solution);
            if let Some(s) = new_vertex(&transition, guess, subdivision, edge, &singular[edge], &points) {
                let tip = Tip { edge, s, kind: transition.kind, regular: transition.regular };
                followed.push(Followed { line, tip, transition, old: false });
            }
        }
    }
    (followed, uncut)
}

/// The believed positions of followed transitions: ends by fits, with up to four factorisations for those that have a vertex
/// and up to four for new ones; others by nodal values.
fn located(
    followed: &[Followed<'_>],
    solved: Solved<'_>,
    singular: &[Vec<f64>],
    (obstacles, known): (&[Obstacle], &[KnownEnd]),
) -> Result<Vec<Located>, ContactError> {
    let Solved { problem, solution, sets, .. } = solved;
    let mut fits = vec![None; followed.len()];
    // neighbours of one kind move each other: every other one is fitted at a time
    let group = |i: usize| {
        let Tip { edge, s, kind, .. } = followed[i].tip;
        let before = followed.iter().filter(|f| f.tip.edge == edge && f.tip.kind == kind && f.tip.s < s).count();
        (followed[i].old, kind == TipKind::StickEnd, before % 2)
    };
    for (old, stick, parity) in
        [true, false].into_iter().flat_map(|old| [(old, false, 0), (old, false, 1), (old, true, 0), (old, true, 1)])
    {
        let fitted = |i: &usize| followed[*i].tip.kind != TipKind::SlipReversal;
        let mine = |i: &usize| group(*i) == (old, stick, parity) && fitted(i);
        let chosen: Vec<usize> = (0..followed.len()).filter(mine).collect();
        let vertex = |&i: &usize| {
            let Followed { line, tip, .. } = &followed[i];
            let others = followed.iter().enumerate();
            let others = others.filter(|(j, f)| *j != i && f.tip.edge == tip.edge && (f.old || !old));
            let valleys = &obstacles[tip.edge].valleys;
            let fixed = singular[tip.edge].iter().chain(valleys).copied();
            let singular = others.map(|(_, f)| f.tip.s).chain(fixed).collect();
            let among_valleys = !valleys.is_empty();
            TipVertex { line, kind: tip.kind, regular: tip.regular, s: tip.s, singular, among_valleys }
        };
        let vertices: Vec<TipVertex<'_>> = chosen.iter().map(vertex).collect();
        for (i, fit) in chosen.into_iter().zip(tip_fits(&vertices, problem, sets)?) {
            fits[i] = fit;
        }
    }
    for (fit, f) in fits.iter_mut().zip(followed).filter(|(_, f)| f.old && f.tip.kind == TipKind::ContactEnd) {
        let own = |(edge, s, _): &&KnownEnd| *edge == f.tip.edge && (s - f.tip.s).abs() <= SAME_PLACE;
        *fit = known.iter().find(own).map(|(_, _, fit)| *fit).or(*fit);
    }
    let place = |(f, fit): (&Followed<'_>, &Option<TipFit>)| {
        let Tip { edge, s, kind, .. } = f.tip;
        let curvature = fit.map(|fit| fit.curvature);
        if !f.old {
            let [low, high] = f.transition.bracket;
            return Located { edge, s, kind, off: (high - low) / 2.0, curvature, at_vertex: false };
        }
        let to = match (kind, fit) {
            (TipKind::SlipReversal, _) => s,
            (_, Some(fit)) => s + fit.shift,
            (_, None) => first_guess(f.line, &f.transition, problem, solution),
        };
        Located { edge, s: to, kind, off: to - s, curvature, at_vertex: true }
    };
    Ok(followed.iter().zip(&fits).map(place).collect())
}

/// The transitions of a mesh that has no vertices for them: each may be off by half of its bracket.
pub fn unlocated(solved: Solved<'_>) -> Vec<Located> {
    let Solved { problem, solution, lines, transitions, .. } = solved;
    let place = |line: &ContactLine, transition: &Transition| {
        Located::unlocated(line.edge, transition, first_guess(line, transition, problem, solution))
    };
    let of_line = |(line, found): (&ContactLine, &Vec<Transition>)| -> Vec<Located> {
        found.iter().map(|t| place(line, t)).collect()
    };
    lines.iter().zip(transitions).flat_map(of_line).collect()
}

/// Largest number of nodes in a run that may be flicker.
const FLICKER_NODES: usize = 3;
/// Largest length of such a run, as part of those beside it.
const FLICKER_LENGTH: f64 = 0.25;

/// Leaves out pairs of transitions at a tip that enclose a run of few nodes, short beside its neighbours: next to the
/// exact transition the states of single nodes alternate, as the multipliers are averages.
fn without_flicker(mut found: Vec<Transition>, tips: &[Tip]) -> Vec<Transition> {
    for kind in [TipKind::ContactEnd, TipKind::StickEnd] {
        loop {
            let of_kind: Vec<usize> = (0..found.len()).filter(|&i| found[i].kind == kind).collect();
            let middle = |i: usize| (found[i].bracket[0] + found[i].bracket[1]) / 2.0;
            let flicker = of_kind.windows(2).enumerate().find(|(k, pair)| {
                let (a, b) = (pair[0], pair[1]);
                let length = middle(b) - middle(a);
                let before = middle(a) - k.checked_sub(1).map_or(0.0, |k| middle(of_kind[k]));
                let after = of_kind.get(k + 2).map_or(1.0, |&i| middle(i)) - middle(b);
                let near = |tip: &Tip| {
                    tip.kind == kind && tip.s > middle(a) - 2.0 * length && tip.s < middle(b) + 2.0 * length
                };
                found[a].regular == -found[b].regular
                    && found[b].point - found[a].point <= FLICKER_NODES
                    && length < FLICKER_LENGTH * before.min(after)
                    && tips.iter().any(near)
            });
            match flicker.map(|(_, pair)| [pair[0], pair[1]]) {
                Some([a, b]) => {
                    found.remove(b);
                    found.remove(a);
                }
                None => break,
            }
        }
    }
    found
}

/// Makes vertices at all asperities and valleys of the element in which a transition lies, if there are several: the end of
/// contact at one of them cannot be located before each has its own elements. Returns whether it did.
fn cut_at_turns(subdivision: &mut Subdivision, edge: usize, transition: &Transition, obstacle: &Obstacle) -> bool {
    let middle = (transition.bracket[0] + transition.bracket[1]) / 2.0;
    let Some(piece) = subdivision.edges[edge].iter().find(|p| p.start <= middle && middle < p.end) else {
        return false;
    };
    let (start, end) = (piece.start, piece.end);
    let turns = obstacle.valleys.iter().chain(&obstacle.peaks).copied();
    let inside: Vec<f64> = turns.filter(|s| start + SAME_PLACE < *s && *s < end - SAME_PLACE).collect();
    if inside.len() > 1 {
        inside.iter().for_each(|&s| subdivision.insert(edge, s, &[], 0.0));
    }
    inside.len() > 1
}

/// Leaves out pairs of contact ends that split the zone of one asperity, or are beside it, and enclose a run of few nodes: these
/// flicker as long as the elements about them are not much shorter than the zone.
fn one_zone_an_asperity(mut found: Vec<Transition>, obstacle: &Obstacle) -> Vec<Transition> {
    let middle = |t: &Transition| (t.bracket[0] + t.bracket[1]) / 2.0;
    let cell = |t: &Transition| obstacle.valleys.partition_point(|v| *v < middle(t));
    let of_peak = |s: f64| obstacle.valleys.partition_point(|v| *v < s);
    loop {
        let ends: Vec<usize> = (0..found.len()).filter(|&i| found[i].kind == TipKind::ContactEnd).collect();
        let several = |c: usize| ends.iter().filter(|&&i| cell(&found[i]) == c).count() > 2;
        let flickers = |pair: &[usize]| {
            let (a, b) = (&found[pair[0]], &found[pair[1]]);
            let c = cell(a);
            let peaks = obstacle.peaks.iter().filter(|p| of_peak(**p) == c).count();
            cell(b) == c && peaks == 1 && b.point - a.point <= FLICKER_NODES && several(c)
        };
        let length = |pair: &[usize]| middle(&found[pair[1]]) - middle(&found[pair[0]]);
        let pair = ends.windows(2).filter(|pair| flickers(pair)).min_by(|a, b| length(a).total_cmp(&length(b)));
        let Some(pair) = pair.map(|pair| [pair[0], pair[1]]) else { return found };
        found.remove(pair[1]);
        found.remove(pair[0]);
    }
}

/// The transition that a tip takes: it is on the tip's side of all valleys, and its bracket reaches the tip's side of all
/// singular points; none if there is no such transition.
fn follow(
    tip: Tip,
    line: &ContactLine,
    found: &[Transition],
    used: &[bool],
    solved: Solved<'_>,
    valleys: &[f64],
    singular: &[f64],
) -> Option<usize> {
    let middle = |t: &Transition| (t.bracket[0] + t.bracket[1]) / 2.0;
    let apart = |t: &Transition| {
        let (low, high) = (middle(t).min(tip.s), middle(t).max(tip.s));
        // no vertex goes past a singular point
        let nearer = if tip.s < t.bracket[0] { t.bracket[0] } else { tip.s.min(t.bracket[1]) };
        let (from, to) = (nearer.min(tip.s) + SAME_PLACE, nearer.max(tip.s) - SAME_PLACE);
        valleys.iter().any(|b| low < *b && *b < high) || singular.iter().any(|p| from < *p && *p < to)
    };
    let (_, j) = (0..found.len())
        .filter(|&j| !used[j] && found[j].kind == tip.kind && found[j].regular == tip.regular && !apart(&found[j]))
        .map(|j| ((middle(&found[j]) - tip.s).abs(), j))
        .filter(|(distance, _)| *distance <= REACH)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let transition = &found[j];
    if tip.kind == TipKind::SlipReversal {
        let [low, high] = transition.bracket;
        let guess = first_guess(line, transition, solved.problem, solved.solution);
        let inside = low - SAME_PLACE <= tip.s && tip.s <= high + SAME_PLACE;
        if !inside && (guess - tip.s).abs() > 0.02 * (high - low) {
            return None;
        }
    }
    Some(j)
}

/// The next position of a tip that should go to s.
fn step(tip: Tip, transition: &Transition, s: f64, others: &[f64]) -> f64 {
    let [low, high] = transition.bracket;
    let width = TRUST * (high - low);
    let before = others.iter().copied().filter(|p| *p < tip.s - SAME_PLACE).fold(0.0, f64::max);
    let after = others.iter().copied().filter(|p| *p > tip.s + SAME_PLACE).fold(1.0, f64::min);
    // the bracket may lie behind the next singular point: the limits of the step count last
    let trusted = s.max(low - width).min(high + width);
    let lowest = (tip.s - FARTHEST * (tip.s - before)).max(before + CLOSEST).min(tip.s);
    let highest = (tip.s + FARTHEST * (after - tip.s)).min(after - CLOSEST).max(tip.s);
    trusted.clamp(lowest, highest)
}

/// Where a transition without a tip gets its vertex; none if a singular point is so near that it belongs to it.
fn new_vertex(
    transition: &Transition,
    guess: f64,
    subdivision: &Subdivision,
    edge: usize,
    fixed: &[f64],
    points: &[f64],
) -> Option<f64> {
    let [low, high] = transition.bracket;
    let mut s = guess;
    if transition.kind == TipKind::SlipReversal {
        if fixed.iter().any(|p| low - 1e-9 <= *p && *p <= high + 1e-9) {
            return None;
        }
        let mut vertices = subdivision.edges[edge].iter().map(|p| p.start);
        s = vertices.rfind(|v| (v - s).abs() < 1e-9).unwrap_or(s);
    }
    let margin = (NEAR * (high - low)).max(1e-6);
    // the guess keeps its own distance from the ends of the edge, down to what can be resolved
    let inner = |p: &&f64| **p > SAME_PLACE && **p < 1.0 - SAME_PLACE;
    let resolved = s.min(1.0 - s) >= CLOSEST;
    (resolved && points.iter().filter(inner).all(|p| (p - s).abs() >= margin)).then_some(s)
}

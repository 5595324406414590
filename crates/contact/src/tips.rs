//! Mesh vertices that follow the transitions of contact and of stick.

use steklov_bem_operators::{SAME_PLACE, Subdivision};

use crate::transitions::{TipKind, Transition, first_guess, tip_fit, transitions};
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

/// A tip takes a transition closer than this part of its edge.
const REACH: f64 = 0.25;
/// A transition closer than this part of its bracket to a singular point belongs to it.
const NEAR: f64 = 0.2;
/// A vertex closer than this part of its piece is moved to a new tip.
const SNAP: f64 = 0.2;
/// Widths of its bracket by which a tip may leave it in one step.
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
}

/// Moves tips to where the solution has its transitions, drops those without one (their vertices stay), and gives each
/// new transition a vertex. `singular[k]`: the other singular points of edge k, its ends included.
///
/// A tip takes the nearest transition of its kind and direction. Contact and stick ends are fitted ([`tip_fit`]) and
/// move at most to the bracket of their transition and its width on both sides; a reversal of slip keeps its vertex.
/// Returns where the transitions are believed to be, but for those at a singular point and nodes that differ from their
/// neighbours on both sides by themselves.
///
/// # Errors
/// [`ContactError::Decomposition`].
pub fn relocate(
    tips: &mut Vec<Tip>,
    subdivision: &mut Subdivision,
    solved: Solved<'_>,
    singular: &[Vec<f64>],
) -> Result<Vec<Located>, ContactError> {
    let Solved { problem, solution, sets, lines } = solved;
    let mut located = Vec::new();
    for line in lines {
        let edge = line.edge;
        let mut mine: Vec<Tip> = tips.iter().copied().filter(|t| t.edge == edge).collect();
        let found = without_flicker(transitions(line, sets), &mine);
        let mut used = vec![false; found.len()];
        tips.retain(|t| t.edge != edge);
        let mut i = 0;
        while i < mine.len() {
            let tip = mine[i];
            let others: Vec<f64> = mine
                .iter()
                .enumerate()
                .filter(|(j, _)| *j != i)
                .map(|(_, t)| t.s)
                .chain(singular[edge].clone())
                .collect();
            match follow(tip, line, &found, &used, solved, &others)? {
                None => {
                    mine.remove(i);
                }
                Some((transition, place)) => {
                    used[transition] = true;
                    let to = step(tip, &found[transition], place.s, &others);
                    if tip.kind != TipKind::SlipReversal && (to - tip.s).abs() > 1e-10 {
                        subdivision.shift(edge, tip.s, to, &others);
                        mine[i].s = to;
                    }
                    located.push(place);
                    i += 1;
                }
            }
        }
        for (transition, _) in found.iter().zip(&used).filter(|(_, used)| !**used) {
            let points: Vec<f64> = mine.iter().map(|t| t.s).chain(singular[edge].clone()).collect();
            let guess = first_guess(line, transition, problem, solution);
            if let Some(s) = new_vertex(transition, guess, subdivision, edge, &singular[edge], &points) {
                subdivision.insert(edge, s, &points, SNAP);
                mine.push(Tip { edge, s, kind: transition.kind, regular: transition.regular });
                let [low, high] = transition.bracket;
                let (off, kind) = ((high - low) / 2.0, transition.kind);
                let fit = match kind {
                    TipKind::SlipReversal => None,
                    _ => tip_fit(line, kind, transition.regular, s, &points, problem, sets)?,
                };
                let curvature = fit.map(|f| f.curvature);
                located.push(Located { edge, s, kind, off, curvature, at_vertex: false });
            }
        }
        mine.sort_by(|a, b| a.s.total_cmp(&b.s));
        tips.extend(mine);
    }
    Ok(located)
}

/// The transitions of a mesh that has no vertices for them: each with half of its bracket as what it may be off.
pub fn unlocated(solved: Solved<'_>) -> Vec<Located> {
    let Solved { problem, solution, sets, lines } = solved;
    let place = |line: &ContactLine, transition: &Transition| {
        let [low, high] = transition.bracket;
        let s = first_guess(line, transition, problem, solution);
        let (edge, kind, off) = (line.edge, transition.kind, (high - low) / 2.0);
        Located { edge, s, kind, off, curvature: None, at_vertex: false }
    };
    lines.iter().flat_map(|line| transitions(line, sets).iter().map(|t| place(line, t)).collect::<Vec<_>>()).collect()
}

/// Nodes of a run at most that may be flicker.
const FLICKER_NODES: usize = 3;
/// Length of such a run at most, as part of those beside it.
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

/// The transition that a tip takes, and where that is; none if there is none for it.
fn follow(
    tip: Tip,
    line: &ContactLine,
    found: &[Transition],
    used: &[bool],
    solved: Solved<'_>,
    others: &[f64],
) -> Result<Option<(usize, Located)>, ContactError> {
    let Solved { problem, solution, sets, .. } = solved;
    let middle = |t: &Transition| (t.bracket[0] + t.bracket[1]) / 2.0;
    let nearest = (0..found.len())
        .filter(|&j| !used[j] && found[j].kind == tip.kind && found[j].regular == tip.regular)
        .map(|j| ((middle(&found[j]) - tip.s).abs(), j))
        .filter(|(distance, _)| *distance <= REACH)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, j)) = nearest else { return Ok(None) };
    let transition = &found[j];
    let [low, high] = transition.bracket;
    let guess = first_guess(line, transition, problem, solution);
    let place =
        |s: f64, curvature| Located { edge: tip.edge, s, kind: tip.kind, off: s - tip.s, curvature, at_vertex: true };
    if tip.kind == TipKind::SlipReversal {
        let inside = low - SAME_PLACE <= tip.s && tip.s <= high + SAME_PLACE;
        let gone = !inside && (guess - tip.s).abs() > 0.02 * (high - low);
        return Ok((!gone).then(|| (j, place(tip.s, None))));
    }
    let fit = tip_fit(line, tip.kind, tip.regular, tip.s, others, problem, sets)?;
    let s = fit.map_or(guess, |fit| tip.s + fit.shift);
    Ok(Some((j, place(s, fit.map(|f| f.curvature)))))
}

/// Where a tip goes that wants to go to s.
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

//! From the estimate of one mesh to the next mesh.

use steklov_bem_operators::{Edge, Grading, Mark, Mesh, Piece, SAME_PLACE, Subdivision, doerfler, legendre_decay};
use steklov_contact::{Located, Obstacle, Tip, relocate, unlocated};
use steklov_expression::{Expression, Turn};

use crate::apart::{limited_by_multipliers, multiplier_indicators};
use crate::body::Factors;
use crate::estimate::{Bubble, Doubt, Estimate};
use crate::hidden::{Overlap, Unseen};
use crate::scene::{Condition, Friction, Refine, Scene};
use crate::solve::{SolveError, Solved};
use crate::transitions::unlocated_energy;

/// A mesh to be solved: its elements, and the vertices that follow transitions of contact and stick.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The elements of every edge.
    pub subdivision: Subdivision,
    /// The vertices at transitions.
    pub tips: Vec<Tip>,
}

/// Part of the estimate whose elements the hp strategy refines; the same among asperities as long as many ends of contact have no
/// vertices.
const MARKED: f64 = 0.95;
const FIRST_MARKED: f64 = 0.7;
/// Degree from which the decay of Legendre coefficients tells whether a solution is smooth.
const TELLING: usize = 4;
/// Degree from which an element whose data are not resolved is halved.
const RESOLVING: usize = 3;
/// Straight corners are those whose sides turn by less than this (radian).
const STRAIGHT: f64 = 1e-9;
/// A vertex closer to a kink of the data than this part of its element is moved there.
const SNAP: f64 = 0.2;
/// Data that vary within less than an element of the first mesh get vertices there, at so many places of an edge at most.
const MOST_PLACES: usize = 64;
/// They change by this part of the largest value there.
const STEEP: f64 = 0.05;
/// Values beyond this part of the largest one are seen.
const SEEN: f64 = 0.2;
/// What is narrower than this in the reference coordinate of its element gets vertices of its own.
const NARROW: f64 = 0.5;

/// Singular points of every edge that are known before anything is solved, rising: its corners, but those where the
/// boundary goes on straight on the same side; with `kinks` also where a datum has a kink or jumps.
pub fn singular_points(scene: &Scene, kinks: bool) -> Vec<Vec<f64>> {
    let edges = scene.polygon.edges();
    let mut points = vec![Vec::new(); edges.len()];
    for l in 0..scene.polygon.loops().len() {
        let order = scene.polygon.traversal(l);
        let order: Vec<usize> = order.into_iter().collect();
        for (i, &a) in order.iter().enumerate() {
            let b = order[(i + 1) % order.len()];
            let direction = |k: usize| {
                let (s, e) = (edges[k].start, edges[k].end);
                let sign = if edges[k].reversed { -1.0 } else { 1.0 };
                [sign * (e[0] - s[0]), sign * (e[1] - s[1])]
            };
            let (x, y) = (direction(a), direction(b));
            let turn = (x[0] * y[1] - x[1] * y[0]).atan2(x[0] * y[0] + x[1] * y[1]);
            if turn.abs() > STRAIGHT || edges[a].side != edges[b].side {
                points[a].push(if edges[a].reversed { 0.0 } else { 1.0 });
                points[b].push(if edges[b].reversed { 1.0 } else { 0.0 });
            }
        }
    }
    if kinks {
        for (k, edge) in edges.iter().enumerate() {
            for datum in data(&scene.sides[edge.side].condition).into_iter().chain(scene.jumps_on(edge)) {
                let along = datum.along(edge);
                points[k].extend(along.kinks.iter().filter(|s| **s > 1e-9 && **s < 1.0 - 1e-9));
            }
        }
    }
    for points in &mut points {
        points.sort_by(f64::total_cmp);
        points.dedup_by(|b, a| *b - *a < 1e-9);
    }
    points
}

/// The elements between two of these points. The error of one may have the parity that the one bubble of an estimate has
/// not.
pub fn coarse_elements(mesh: &Mesh, singular: &[Vec<f64>]) -> Vec<usize> {
    let at = |e: usize, s: f64| singular[mesh.edge[e]].iter().any(|p| (p - s).abs() < SAME_PLACE);
    (0..mesh.len()).filter(|&e| mesh.span[e].iter().all(|&s| at(e, s))).collect()
}

/// The elements with more than a small part of what their degrees do not follow of the loads.
fn unresolved_loads(unresolved: &[f64]) -> Vec<usize> {
    let total: f64 = unresolved.iter().sum();
    (0..unresolved.len()).filter(|&e| unresolved[e] > 0.01 * total).collect()
}

/// Vertices at three places of an edge, but where there is one already.
fn insert_apart(subdivision: &mut Subdivision, edge: usize, places: [f64; 3]) {
    let apart = 0.1 * (places[2] - places[0]).abs();
    for s in places {
        let near = |p: &Piece| (p.start - s).abs() < apart || (p.end - s).abs() < apart;
        if !subdivision.edges[edge].iter().any(near) {
            subdivision.insert(edge, s, &[], 0.0);
        }
    }
}

/// Where the data of an edge, gaps apart, change within less than one of its elements, unseen by its nodes: begin, peak and
/// end of each such place. A gap matters where the body comes near the obstacle only.
fn narrow_places(scene: &Scene, edge: &Edge, elements: &[Piece]) -> Vec<[f64; 3]> {
    let shortest = elements.iter().map(|p| p.end - p.start).fold(0.0, f64::max);
    let mut places: Vec<[f64; 3]> = Vec::new();
    let condition = &scene.sides[edge.side].condition;
    let gap = |datum: &&Expression| !matches!(condition, Condition::Contact { gap, .. } if std::ptr::eq(gap, *datum));
    for datum in data(condition).into_iter().chain(scene.jumps_on(edge)).filter(gap) {
        if datum.constant().is_some() {
            continue;
        }
        let along = datum.along(edge);
        let ends = along.survey.narrow([-1.0, 2.0], 0.55 * shortest, STEEP);
        let mut clusters: Vec<[f64; 2]> = Vec::new();
        for s in ends {
            match clusters.last_mut() {
                Some(last) if s - last[1] < shortest / 4.0 => last[1] = s,
                _ => clusters.push([s, s]),
            }
        }
        // loads are integrated: a look between the nodes is enough to see them; bounds and held values count at nodes
        let loads = matches!(condition, Condition::Traction(_) | Condition::Pressure(_) | Condition::Free);
        let value = |s: f64| {
            let [x, y] = edge.point(s);
            datum.eval(x, y, s).abs()
        };
        let largest = along.survey.sampled.magnitude();
        let points: Vec<f64> = elements
            .iter()
            .flat_map(|p| {
                let parts = if loads { 4 } else { p.degree };
                (0..=parts).map(move |k| p.start + (p.end - p.start) * k as f64 / parts as f64)
            })
            .collect();
        for [a, b] in clusters.into_iter().filter(|c| c[0] < c[1] && c[1] - c[0] <= shortest) {
            if !points.iter().any(|&s| a <= s && s <= b && value(s) > SEEN * largest) {
                let inside = along.survey.samples.iter().filter(|p| a < p.0 && p.0 < b);
                let peak = inside.max_by(|p, q| p.1.abs().total_cmp(&q.1.abs())).map_or((a + b) / 2.0, |p| p.0);
                places.push([a, peak, b]);
            }
        }
    }
    if places.len() > MOST_PLACES { Vec::new() } else { places }
}

/// Where the gap of each edge turns: asperities of the obstacle, and valleys between them.
fn gap_turns(scene: &Scene) -> Vec<Vec<Turn>> {
    let of = |edge: &Edge| match &scene.sides[edge.side].condition {
        Condition::Contact { gap, .. } if gap.constant().is_none() => gap.turns(edge),
        _ => Vec::new(),
    };
    scene.polygon.edges().iter().map(of).collect()
}

/// The part of the indicators whose elements are refined among asperities. Transitions that get vertices count with their
/// energy, and as marked: while that is most of the estimate nothing else is refined; nor is much while many have none, nor more
/// than half of the tolerance asks for, which is `goal` of the estimate.
fn part_to_mark(squared: &[f64], located: &[Located], energy: f64, goal: f64) -> f64 {
    let new = located.iter().filter(|tip| !tip.at_vertex).count();
    let part = if 4 * new > located.len() { FIRST_MARKED } else { MARKED };
    let part = part.min(1.0 - (goal / 2.0).powi(2));
    let sum: f64 = squared.iter().sum();
    if sum > 0.0 { (part - (1.0 - part) * energy / sum).max(0.0) } else { part }
}

/// How often the gap turns within an element.
fn turns_within(mesh: &Mesh, turns: &[Vec<Turn>], e: usize) -> usize {
    let [a, b] = mesh.span[e];
    turns[mesh.edge[e]].iter().filter(|t| (t.at - a) * (t.at - b) < 0.0).count()
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
fn obstacles(turns: &[Vec<Turn>]) -> Vec<Obstacle> {
    let of = |turns: &Vec<Turn>| {
        let (valleys, peaks): (Vec<Turn>, Vec<Turn>) = turns.iter().partition(|t| t.maximum);
        Obstacle { valleys: valleys.iter().map(|t| t.at).collect(), peaks: peaks.iter().map(|t| t.at).collect() }
    };
    turns.iter().map(of).collect()
}

/// Cuts the marked contact elements along which the gap turns twice or more: the multipliers of a degree that does not follow the
/// gap feel contact where there is none. Those whose error is that of the gap are cut at all asperities and valleys, others
/// at one valley.
fn cut_at_turns(subdivision: &mut Subdivision, turns: &[Vec<Turn>], rough: &dyn Fn(usize, &Piece) -> bool) {
    for (edge, turns) in turns.iter().enumerate() {
        let mut cuts = Vec::new();
        for piece in subdivision.edges[edge].iter_mut().filter(|p| p.mark != Mark::Keep) {
            let inside = || turns.iter().filter(|t| piece.start < t.at && t.at < piece.end);
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

/// The expressions of a condition.
fn data(condition: &Condition) -> Vec<&Expression> {
    match condition {
        Condition::Contact { gap, friction } => match friction {
            Friction::Tresca(bound) | Friction::Coulomb(bound) => vec![gap, bound],
            Friction::None => vec![gap],
        },
        Condition::Traction(t) => t.iter().collect(),
        Condition::Pressure(p) => vec![p],
        Condition::Displacement { values, traction } => {
            values.iter().flatten().chain(traction.iter().flatten()).collect()
        }
        Condition::Free => Vec::new(),
    }
}

impl Layout {
    /// The first mesh; of the hp strategy with vertices at the kinks of the data.
    pub fn first(scene: &Scene) -> Self {
        let mesh = Mesh::uniform(&scene.polygon, scene.method.elements, scene.method.degree);
        let mut subdivision = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
        if scene.method.refine == Refine::Hp {
            for (k, points) in singular_points(scene, true).iter().enumerate() {
                for (i, &s) in points.iter().enumerate() {
                    subdivision.insert(k, s, &points[..i], SNAP);
                }
                for place in narrow_places(scene, &scene.polygon.edges()[k], &subdivision.edges[k].clone()) {
                    insert_apart(&mut subdivision, k, place);
                }
            }
        }
        Self { subdivision, tips: Vec::new() }
    }

    /// Displacement unknowns.
    pub fn dofs(&self) -> usize {
        self.subdivision.dofs()
    }

    /// The layout to solve next, and where the transitions of this one are believed to be.
    ///
    /// # Errors
    /// A decomposition that fails.
    pub fn next(
        &self,
        scene: &Scene,
        solved: &Solved,
        factors: &Factors,
        estimate: Option<&Estimate>,
        unseen: &Unseen,
    ) -> Result<(Self, Vec<Located>), SolveError> {
        let method = &scene.method;
        let Solved { mesh, space, .. } = solved;
        let state = match (&solved.contact, &factors.contact) {
            (Some(contact), Some(part)) => Some(steklov_contact::Solved {
                problem: &part.problem,
                solution: &contact.solution,
                sets: &part.sets,
                lines: &part.lines,
            }),
            _ => None,
        };
        let mut squared = estimate.map_or(vec![0.0; mesh.len()], Estimate::squared);
        let apart = multiplier_indicators(solved, factors.difference);
        squared.iter_mut().zip(&apart).for_each(|(all, part)| *all += part);
        let limited = |e: usize| limited_by_multipliers(scene, apart[e], squared[e]);
        let unresolved = match estimate {
            Some(estimate) if estimate.doubts.contains(&Doubt::Data) => unresolved_loads(&unseen.unresolved),
            _ => Vec::new(),
        };
        let decay = |e: usize| legendre_decay(mesh, space, e, &solved.displacement);
        let marked = |theta: f64, rough: &dyn Fn(usize) -> bool| -> Vec<Mark> {
            let marked = doerfler(&squared, method.marking.unwrap_or(theta));
            let mark = |(e, excess): (usize, Option<f64>)| match excess {
                None => Mark::Keep,
                Some(excess) if method.refine == Refine::Hp => Mark::Refine { rough: rough(e) || limited(e), excess },
                Some(_) => Mark::Refine { rough: rough(e) || limited(e), excess: 1.0 }, // one cut or degree at a time
            };
            let mut marks: Vec<Mark> = marked.into_iter().enumerate().map(mark).collect();
            for &e in &unresolved {
                if marks[e] == Mark::Keep {
                    marks[e] = Mark::Refine { rough: rough(e), excess: 1.0 };
                }
            }
            marks
        };
        let all = |rough: bool| vec![Mark::Refine { rough, excess: 1.0 }; mesh.len()];
        let high = Grading { max_degree: Mesh::MAX_DEGREE, ..Grading::default() };
        let by_mark = |marks: &[Mark]| Layout {
            subdivision: Subdivision::new(mesh, marks).refined_by_mark(&high),
            tips: Vec::new(),
        };
        let located = || state.map_or(Vec::new(), unlocated);
        match method.refine {
            Refine::None => Ok((self.clone(), located())),
            Refine::UniformH => Ok((by_mark(&all(true)), located())),
            Refine::UniformP => Ok((by_mark(&all(false)), located())),
            Refine::H => Ok((by_mark(&marked(0.5, &|_| true)), located())),
            Refine::HpDecay => {
                let corners = singular_points(scene, false);
                let touches = |e: usize| {
                    corners[mesh.edge[e]].iter().any(|c| mesh.span[e].iter().any(|s| (s - c).abs() < SAME_PLACE))
                };
                let rough = |e: usize| decay(e).map_or(touches(e), |d| d > method.smoothness);
                Ok((by_mark(&marked(0.5, &rough)), located()))
            }
            Refine::Hp => {
                let rough = |e: usize| {
                    let p = mesh.degree[e];
                    let oscillates = |i: &Bubble| i.oscillation > 0.5 * i.total();
                    p >= TELLING && decay(e).is_some_and(|d| d > method.smoothness)
                        || p >= RESOLVING
                            && (unresolved.contains(&e) || estimate.is_some_and(|all| oscillates(&all.indicators[e])))
                };
                let mut singular = singular_points(scene, true);
                let turns = gap_turns(scene);
                let mut part = MARKED;
                if let (Some(state), true) = (state, turns.iter().flatten().any(|t| t.maximum)) {
                    let mut whole = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
                    let tips = &mut self.tips.clone();
                    let located = relocate(tips, &mut whole, state, &singular, &obstacles(&turns))?;
                    let goal = estimate.map_or(0.0, |all| method.tolerance / all.relative);
                    part = part_to_mark(&squared, &located, unlocated_energy(scene, &located), goal);
                }
                let mut marks = marked(part, &rough);
                for e in coarse_elements(mesh, &singular) {
                    if marks[e] == Mark::Keep {
                        marks[e] = Mark::Refine { rough: true, excess: 1.0 };
                    }
                }
                let (several, single): (Vec<&Overlap>, Vec<&Overlap>) =
                    unseen.overlaps.iter().partition(|o| turns_within(mesh, &turns, o.element) > 1);
                let narrow: Vec<&Overlap> = single.into_iter().filter(|o| o.at[2] - o.at[0] < NARROW).collect();
                several.iter().chain(&narrow).for_each(|o| marks[o.element] = Mark::Keep);
                let mut subdivision = Subdivision::new(mesh, &marks);
                for overlap in several {
                    insert_turns(&mut subdivision, mesh, overlap, &turns[mesh.edge[overlap.element]]);
                }
                for overlap in narrow {
                    let (e, edge) = (overlap.element, mesh.edge[overlap.element]);
                    let at = overlap.at.map(|t| mesh.edge_parameter(e, t));
                    insert_apart(&mut subdivision, edge, at);
                    // the valleys on both sides, so that no other asperity shares its elements
                    let valleys = turns[edge].iter().filter(|t| t.maximum).map(|t| t.at);
                    let before = valleys.clone().filter(|s| *s < at[1]).fold(f64::NEG_INFINITY, f64::max);
                    let after = valleys.filter(|s| *s > at[1]).fold(f64::INFINITY, f64::min);
                    insert_apart(&mut subdivision, edge, [before, at[1], after]);
                }
                let of_gap = |edge: usize, piece: &Piece| {
                    let inside = |e: &usize| {
                        let [a, b] = mesh.span[*e];
                        mesh.edge[*e] == edge && a.min(b) <= piece.start && piece.start < a.max(b)
                    };
                    let element = (0..mesh.len()).find(inside);
                    element.zip(estimate).is_some_and(|(e, all)| {
                        let bubble = &all.indicators[e];
                        bubble.oscillation > 0.5 * bubble.total()
                    })
                };
                cut_at_turns(&mut subdivision, &turns, &of_gap);
                let mut tips = self.tips.clone();
                let located = match state {
                    Some(state) => relocate(&mut tips, &mut subdivision, state, &singular, &obstacles(&turns))?,
                    None => Vec::new(),
                };
                tips.iter().for_each(|tip| singular[tip.edge].push(tip.s));
                Ok((Self { subdivision: subdivision.refined(&singular, &Grading::default()), tips }, located))
            }
        }
    }
}

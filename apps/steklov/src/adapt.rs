//! From the estimate of one mesh to the next mesh.

use steklov_bem_operators::{Grading, Mark, Mesh, SAME_PLACE, Subdivision, doerfler, legendre_decay};
use steklov_contact::{Located, Tip, relocate, unlocated};

use crate::apart::{limited_by_multipliers, multiplier_indicators};
use crate::body::Factors;
use crate::estimate::{Bubble, Doubt, Estimate};
use crate::expression::Expression;
use crate::scene::{Condition, Friction, Refine, Scene};
use crate::solve::{SolveError, Solved};

/// A mesh to be solved: its elements, and the vertices that follow transitions of contact and stick.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The elements of every edge.
    pub subdivision: Subdivision,
    /// The vertices at transitions.
    pub tips: Vec<Tip>,
}

/// Degree from which the decay of Legendre coefficients tells whether a solution is smooth.
const TELLING: usize = 4;
/// Degree from which an element whose data are not resolved is halved.
const RESOLVING: usize = 3;
/// Straight corners are those whose sides turn by less than this (radian).
const STRAIGHT: f64 = 1e-9;
/// A vertex closer to a kink of the data than this part of its element is moved there.
const SNAP: f64 = 0.2;

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
                let found = datum.kinks(|t| {
                    let s = (1.0 + t) / 2.0;
                    let [x, y] = edge.point(s);
                    (x, y, s)
                });
                points[k].extend(found.into_iter().map(|t| (1.0 + t) / 2.0).filter(|s| *s > 1e-9 && *s < 1.0 - 1e-9));
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
            Some(estimate) if estimate.doubts.contains(&Doubt::Data) => unresolved_loads(&factors.unresolved),
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
                let mut marks = marked(0.95, &rough);
                for e in coarse_elements(mesh, &singular) {
                    if marks[e] == Mark::Keep {
                        marks[e] = Mark::Refine { rough: true, excess: 1.0 };
                    }
                }
                let mut subdivision = Subdivision::new(mesh, &marks);
                let mut tips = self.tips.clone();
                let located = match state {
                    Some(state) => relocate(&mut tips, &mut subdivision, state, &singular)?,
                    None => Vec::new(),
                };
                tips.iter().for_each(|tip| singular[tip.edge].push(tip.s));
                Ok((Self { subdivision: subdivision.refined(&singular, &Grading::default()), tips }, located))
            }
        }
    }
}

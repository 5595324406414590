//! A body cut into several along lines.
//!
//! Boundary and lines are split where they meet. The parts of lines that lie inside are traversed in both directions, the
//! boundary with the body to the left; at each point a piece continues along the part that turns most to the left. So its
//! boundary is closed, its outer loop counter-clockwise; loops that are clockwise are holes of the piece around them.

use std::f64::consts::TAU;

use steklov_elastic::plane::{cross, distance, minus, norm, unit};

use crate::polygon::winding;
use crate::{Edge, Path, Polygon};

/// Points closer than this part of the diameter are one.
const SAME: f64 = 1e-9;

/// A straight piece of a line along which a body is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Where it runs.
    pub ends: [[f64; 2]; 2],
    /// Names of the sides of the pieces to its left and to its right.
    pub sides: [String; 2],
}

/// Why a body cannot be cut along lines.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CutError {
    /// A line ends inside of the body.
    #[error("a cut ends at ({0}, {1}), inside of the body", at[0], at[1])]
    EndsInside {
        /// Where.
        at: [f64; 2],
    },
    /// The body on both sides of a line is one.
    #[error("a cut at ({0}, {1}) has the same piece on both sides", at[0], at[1])]
    SamePiece {
        /// Where.
        at: [f64; 2],
    },
    /// A part of the boundary is too short to be a side.
    #[error("a cut meets the boundary at ({0}, {1}), next to a corner", at[0], at[1])]
    NextToCorner {
        /// Where.
        at: [f64; 2],
    },
}

/// A directed part of the boundary or of a line.
pub(crate) struct Half {
    pub from: usize,
    pub to: usize,
    pub edge: Edge,
    pub of: Part,
}

/// What a directed part is a part of.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Part {
    /// An edge of the boundary, between the edge parameters at its start and its end.
    Outline(usize, [f64; 2]),
    /// A line, with a number that both directions have.
    Line(usize),
}

/// Points; those that count as one appear once.
pub(crate) struct Points {
    pub all: Vec<[f64; 2]>,
    pub near: f64,
}

/// Boundary and lines in directed parts between the points where they meet, and the closed chains that these form.
pub(crate) struct Arrangement {
    pub points: Points,
    pub halves: Vec<Half>,
    /// Each outer chain, and behind it the holes in it.
    pub pieces: Vec<Vec<Vec<usize>>>,
    side_names: Vec<String>,
}

impl Points {
    /// The number of a point.
    fn at(&self, x: [f64; 2]) -> Option<usize> {
        let is_beside = |y: &[f64; 2]| (0..2).all(|i| (x[i] - y[i]).abs() <= self.near);
        self.all.iter().position(|y| is_beside(y) && distance(x, *y) <= self.near)
    }

    fn number(&mut self, x: [f64; 2]) -> usize {
        self.at(x).unwrap_or_else(|| {
            self.all.push(x);
            self.all.len() - 1
        })
    }
}

impl Polygon {
    /// Cuts a body along lines, which may cross each other, into several bodies. Edges keep their sides; the sides of cuts are
    /// new.
    ///
    /// # Errors
    /// [`CutError`].
    ///
    /// # Panics
    /// If there are several bodies, or one that is unbounded.
    pub fn cut(&self, cuts: &[Cut]) -> Result<Polygon, CutError> {
        let Arrangement { halves, pieces, side_names, .. } = self.arranged(cuts)?;
        let edges_of = |one: Vec<usize>| one.iter().map(|&h| halves[h].edge.clone()).collect();
        let loops_of = |loops: Vec<Vec<usize>>| loops.into_iter().map(edges_of).collect();
        Ok(self.in_pieces(pieces.into_iter().map(loops_of).collect(), side_names))
    }

    /// The parts of a body along lines.
    pub(crate) fn arranged(&self, cuts: &[Cut]) -> Result<Arrangement, CutError> {
        assert!(self.bodies().len() == 1 && self.is_bounded(), "one bounded body is cut");
        let mut points = Points { all: Vec::new(), near: SAME * self.diameter() };
        self.edges().iter().for_each(|edge| {
            points.number(edge.start);
        });
        let mut side_names = self.side_names().to_vec();
        let mut halves = Vec::new();
        let on_cuts: Vec<Vec<usize>> = cuts.iter().map(|cut| self.points_on(cut, cuts, &mut points)).collect();
        self.split_boundary(&points, &mut halves)?;
        for (cut, on_cut) in cuts.iter().zip(on_cuts) {
            let sides = cut.sides.each_ref().map(|name| {
                side_names.iter().position(|n| n == name).unwrap_or_else(|| {
                    side_names.push(name.clone());
                    side_names.len() - 1
                })
            });
            for pair in on_cut.windows(2) {
                let [a, b] = [points.all[pair[0]], points.all[pair[1]]];
                if !self.is_inside([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0], points.near) {
                    continue;
                }
                let of = Part::Line(halves.len());
                for (from, to, side) in [(pair[0], pair[1], sides[0]), (pair[1], pair[0], sides[1])] {
                    let (start, end) = (points.all[from], points.all[to]);
                    let edge =
                        Edge { start, end, path: Path::Line, side, loop_index: 0, reversed: false, drawn: [0.0, 1.0] };
                    halves.push(Half { from, to, edge, of });
                }
            }
        }
        let pieces = pieces_of(&halves, traced(&halves, &points)?);
        Ok(Arrangement { points, halves, pieces, side_names })
    }

    fn is_inside(&self, x: [f64; 2], near: f64) -> bool {
        self.is_in_body(0, x) && self.edges().iter().all(|edge| edge.nearest(x, near).is_none())
    }

    /// The points at which a cut meets the boundary or other cuts, and its ends, in their order.
    fn points_on(&self, cut: &Cut, cuts: &[Cut], points: &mut Points) -> Vec<usize> {
        let ([a, b], near) = (cut.ends, points.near);
        let length = distance(a, b);
        let n = unit(minus(b, a));
        let mut on: Vec<(f64, [f64; 2])> = Vec::new();
        for edge in self.edges() {
            let hits = edge.met_by(a, n).into_iter().filter(|(_, d)| -near <= *d && *d <= length + near);
            on.extend(hits.map(|(s, d)| (d, edge.point(s))));
        }
        for other in cuts.iter().filter(|other| *other != cut) {
            let [p, q] = other.ends;
            let (d, r) = (minus(q, p), minus(p, a));
            let across = cross(n, d);
            if across.abs() < 1e-9 * norm(d) {
                continue;
            }
            let along = cross(r, d) / across;
            let part = cross(r, n) / across;
            let slack = near / norm(d);
            if -near <= along && along <= length + near && -slack <= part && part <= 1.0 + slack {
                on.push((along, [a[0] + along * n[0], a[1] + along * n[1]]));
            }
        }
        on.extend([(0.0, a), (length, b)]);
        on.sort_by(|x, y| x.0.total_cmp(&y.0));
        let mut numbers: Vec<usize> = on.into_iter().map(|(_, x)| points.number(x)).collect();
        numbers.dedup();
        numbers
    }

    /// The boundary between all points on it, in the direction of traversal.
    fn split_boundary(&self, points: &Points, halves: &mut Vec<Half>) -> Result<(), CutError> {
        for (number, edge) in self.edges().iter().enumerate() {
            let [first, last] = if edge.reversed { [1.0, 0.0] } else { [0.0, 1.0] };
            let (Some(start), Some(end)) = (points.at(edge.start), points.at(edge.end)) else {
                unreachable!("all corners are points")
            };
            let mut on = vec![(first, start), (last, end)];
            for (k, &x) in points.all.iter().enumerate().filter(|(k, _)| *k != start && *k != end) {
                on.extend(edge.nearest(x, points.near).map(|(_, s)| (s, k)));
            }
            on.sort_by(|x, y| if edge.reversed { y.0.total_cmp(&x.0) } else { x.0.total_cmp(&y.0) });
            for pair in on.windows(2) {
                let [(s0, from), (s1, to)] = [pair[0], pair[1]];
                let ends = [points.all[from], points.all[to]];
                if (s1 - s0).abs() < 1e-6 {
                    return Err(CutError::NextToCorner { at: ends[1] });
                }
                halves.push(Half { from, to, edge: edge.part([s0, s1], ends), of: Part::Outline(number, [s0, s1]) });
            }
        }
        Ok(())
    }
}

/// Each outer chain with the holes in it.
fn pieces_of(halves: &[Half], loops: Vec<Vec<usize>>) -> Vec<Vec<Vec<usize>>> {
    let area = |one: &Vec<usize>| -> f64 {
        let o = halves[one[0]].edge.start;
        let twice = |&h: &usize| {
            let e = &halves[h].edge;
            let (a, b) = (minus(e.start, o), minus(e.end, o));
            cross(a, b) + e.twice_segment()
        };
        one.iter().map(twice).sum()
    };
    let areas: Vec<f64> = loops.iter().map(area).collect();
    let (outer, holes): (Vec<usize>, Vec<usize>) = (0..loops.len()).partition(|&k| areas[k] > 0.0);
    let around = |hole: &usize| {
        let x = halves[loops[*hole][0]].edge.point(0.5);
        let contains = |&&k: &&usize| winding(loops[k].iter().map(|&h| &halves[h].edge), x) != 0;
        outer.iter().filter(contains).min_by(|a, b| areas[**a].total_cmp(&areas[**b])).copied()
    };
    let piece = |&k: &usize| {
        let inside = holes.iter().copied().filter(|hole| around(hole) == Some(k));
        std::iter::once(k).chain(inside).map(|one| loops[one].clone()).collect()
    };
    outer.iter().map(piece).collect()
}

/// The closed chains of directed parts: each part is followed by the one that turns most to the left.
fn traced(halves: &[Half], points: &Points) -> Result<Vec<Vec<usize>>, CutError> {
    let after = |h: usize| -> Option<usize> {
        let [x, y] = halves[h].edge.tangent(1.0);
        let angle = |k: usize| {
            let [u, v] = halves[k].edge.tangent(0.0);
            // from the way back, clockwise
            let turned = (-x * v + y * u).atan2(-x * u - y * v);
            if turned >= -1e-9 { TAU - turned.max(0.0) } else { -turned }
        };
        let leaving = (0..halves.len()).filter(|&k| halves[k].from == halves[h].to);
        leaving.min_by(|&a, &b| angle(a).total_cmp(&angle(b)))
    };
    let mut used = vec![false; halves.len()];
    let mut loops = Vec::new();
    for first in 0..halves.len() {
        if used[first] {
            continue;
        }
        let (mut chain, mut h) = (Vec::new(), first);
        while !used[h] {
            used[h] = true;
            chain.push(h);
            let back = |k: usize| matches!(halves[h].of, Part::Line(_)) && halves[k].of == halves[h].of && k != h;
            h = match after(h) {
                Some(next) if !back(next) => next,
                _ => return Err(CutError::EndsInside { at: points.all[halves[h].to] }),
            };
        }
        for (i, &a) in chain.iter().enumerate() {
            if matches!(halves[a].of, Part::Line(_)) && chain[..i].iter().any(|&b| halves[b].of == halves[a].of) {
                return Err(CutError::SamePiece { at: halves[a].edge.start });
            }
        }
        loops.push(chain);
    }
    Ok(loops)
}

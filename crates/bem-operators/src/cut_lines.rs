//! Lines along which a body may be cut: at its holes, and those of the lattice of equal holes.

use steklov_elastic::plane::{cross, distance, dot, minus};

use crate::plan_cuts::{DIRECTIONS, SAME, STEEP};
use crate::{Edge, Polygon};

/// Holes that are translates of others from which on lines of their lattice are tried.
const FEWEST_EQUAL: usize = 4;

/// Parallel lines: their direction, and their offsets across it.
pub(crate) struct Row {
    pub(crate) along: [f64; 2],
    pub(crate) offsets: Vec<f64>,
}

/// The lines at holes along the straight edges of a body, if holes are translates of each other: along them it may be cut into cells
/// of which many are equal.
pub(crate) fn lattice(outline: &Polygon, pitch: f64) -> Vec<Row> {
    let (edges, loops) = (outline.edges(), outline.loops());
    let near = SAME * pitch;
    let is_translate = |a: &[Edge], b: &[Edge]| {
        let by = minus(b[0].start, a[0].start);
        let same =
            |(a, b): (&Edge, &Edge)| [0.0, 0.3].iter().all(|&s| distance(minus(b.point(s), a.point(s)), by) <= near);
        a.len() == b.len() && a.iter().zip(b).all(same)
    };
    let holes: Vec<&[Edge]> = loops[1..].iter().map(|one| &edges[one.clone()]).collect();
    let has_translate = |a: &&[Edge]| holes.iter().any(|b| !std::ptr::eq(*a, *b) && is_translate(a, b));
    let equal: Vec<&[Edge]> = holes.iter().copied().filter(has_translate).collect();
    if equal.len() < FEWEST_EQUAL {
        return Vec::new();
    }
    let mut rows: Vec<Row> = Vec::new();
    for edge in edges[loops[0].clone()].iter().filter(|edge| edge.is_line()) {
        let along = edge.tangent(0.0);
        if rows.len() < DIRECTIONS && rows.iter().all(|row| cross(row.along, along).abs() > STEEP) {
            let mut offsets = at_holes([-along[1], along[0]], &equal, near);
            offsets.sort_by(f64::total_cmp);
            offsets.dedup_by(|b, a| *b - *a < near);
            rows.push(Row { along, offsets });
        }
    }
    rows
}

/// The extent of edges along a direction.
pub(crate) fn extent(along: [f64; 2], edges: &[Edge]) -> [f64; 2] {
    let of_edge = |edge: &Edge| {
        let parts = if edge.is_line() { 1 } else { 8 };
        (0..parts).map(|k| dot(along, edge.point(k as f64 / parts as f64))).collect::<Vec<f64>>()
    };
    let all = edges.iter().flat_map(of_edge);
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// The offsets of lines through the middles of holes, and midway between neighbouring extremes of holes that are not `near`.
pub(crate) fn at_holes(across: [f64; 2], holes: &[&[Edge]], near: f64) -> Vec<f64> {
    let extents: Vec<[f64; 2]> = holes.iter().map(|hole| extent(across, hole)).collect();
    let mut offsets: Vec<f64> = extents.iter().map(|[a, b]| (a + b) / 2.0).collect();
    let mut extremes: Vec<f64> = extents.into_iter().flatten().collect();
    extremes.sort_by(f64::total_cmp);
    let apart = extremes.windows(2).filter(|pair| pair[1] - pair[0] > near);
    offsets.extend(apart.map(|pair| (pair[0] + pair[1]) / 2.0));
    offsets
}

//! Triangles that fill the body, for pictures and for viewers of the result file.
//!
//! The boundary is sampled at one spacing h, the interior is filled with a hexagonal lattice of the same spacing, and
//! the constrained Delaunay triangulation of all points is cut at the boundary. Nothing is solved on these triangles.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};
use steklov_bem_operators::distance_to_segment;
use steklov_elastic::plane::{cross, distance};

/// Smallest distance of a lattice point from the boundary, in units of the spacing.
const CLEARANCE: f64 = 0.45;

/// Area of the body that one lattice point stands for, in units of the spacing squared: √3/2.
const CELL: f64 = 0.866_025_403_784_438_6;

/// A conforming triangulation of a polygon with holes: V points, T triangles, B boundary segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangulation {
    /// Points (V): those of the boundary first, edge by edge in traversal order, then the interior ones.
    pub points: Vec<[f64; 2]>,
    /// Triangles (T), counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// Edge and edge parameter (0 at its start, 1 at its end) of each point (V), `None` in the interior.
    /// A corner has the entry of the edge that starts there, with parameter 0.
    pub boundary: Vec<Option<(usize, f64)>>,
    /// Boundary segments (B) in traversal order, body to the left; each is a side of exactly one triangle.
    pub outline: Vec<[usize; 2]>,
}

/// Why a polygon could not be filled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TriangulationError {
    /// A corner is NaN or infinite.
    #[error("edge {edge} of the body has a corner that is not a finite point: ({}, {})", point[0], point[1])]
    NotFinite {
        /// Number of the edge.
        edge: usize,
        /// Its corner.
        point: [f64; 2],
    },
    /// The end of an edge is not the start of the next one of its loop, or a loop has fewer than three edges.
    #[error("edge {edge} of the body does not end where the next one of its loop starts: mend the list of corners")]
    NotClosed {
        /// Number of the edge.
        edge: usize,
    },
    /// No area (at most 1e-14 of the square over the longest extent), or loops that run with the body to the right.
    #[error("the body's signed area is {area}: list the outer corners counter-clockwise and the holes clockwise")]
    NoArea {
        /// Sum of the loops' signed areas.
        area: f64,
    },
    /// Edges cross, overlap or touch between their corners.
    #[error("{count} of the body's boundary segments cross or touch others: the edges must meet at corners only")]
    Crossing {
        /// Number of boundary segments that could not be kept.
        count: usize,
    },
}

/// Fills the polygon with about `target_points` points.
///
/// `edges` are (start, end, loop): straight edges in traversal order with the body to the left (outer boundary
/// counter-clockwise, holes clockwise), loop after loop. Every corner becomes a point, an edge of length ℓ gets max(1,
/// round(ℓ/h)) equal segments, and h is chosen such that boundary and lattice together count about `target_points`; a
/// polygon with more corners than half of `target_points` gets that half besides them. Any unit of length: only ratios
/// of lengths matter.
///
/// # Errors
/// [`TriangulationError`] if a corner is not finite, a loop does not close, the area is not positive, or edges cross.
pub fn triangulate(
    edges: &[([f64; 2], [f64; 2], usize)],
    target_points: usize,
) -> Result<Triangulation, TriangulationError> {
    let next = successors(edges)?;
    let (centre, size) = bounding_box(edges);
    let unit = |p: [f64; 2]| [(p[0] - centre[0]) / size, (p[1] - centre[1]) / size];
    let unit_edges: Vec<_> = edges.iter().map(|&(a, b, _)| (unit(a), unit(b))).collect();
    let area: f64 = unit_edges.iter().map(|(a, b)| cross(*a, *b) / 2.0).sum();
    if area.is_nan() || area <= 1e-14 {
        return Err(TriangulationError::NoArea { area: area * size * size });
    }
    let h = spacing(&unit_edges, area, target_points);

    let mut points = Vec::new();
    let mut boundary = Vec::new();
    let mut first = Vec::with_capacity(edges.len());
    for (edge, (&(a, b, _), unit_edge)) in edges.iter().zip(&unit_edges).enumerate() {
        first.push(points.len());
        let n = segments(*unit_edge, h);
        for i in 0..n {
            let s = i as f64 / n as f64;
            points.push([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]);
            boundary.push(Some((edge, s)));
        }
    }
    let mut outline = Vec::with_capacity(points.len());
    for edge in 0..edges.len() {
        let end = first.get(edge + 1).copied().unwrap_or(points.len());
        outline.extend((first[edge]..end).map(|i| [i, if i + 1 < end { i + 1 } else { first[next[edge]] }]));
    }

    points.extend(lattice(&unit_edges, h).iter().map(|p| [centre[0] + size * p[0], centre[1] + size * p[1]]));
    boundary.resize(points.len(), None);
    let triangles = delaunay(points.iter().map(|&p| unit(p)).collect(), &outline)?;
    Ok(Triangulation { points, triangles, boundary, outline })
}

/// Edge that follows each edge on its loop.
fn successors(edges: &[([f64; 2], [f64; 2], usize)]) -> Result<Vec<usize>, TriangulationError> {
    for (edge, &(a, b, _)) in edges.iter().enumerate() {
        if let Some(&point) = [a, b].iter().find(|p| !p[0].is_finite() || !p[1].is_finite()) {
            return Err(TriangulationError::NotFinite { edge, point });
        }
    }
    let mut next = Vec::with_capacity(edges.len());
    let mut start = 0;
    for (edge, &(_, end, loop_index)) in edges.iter().enumerate() {
        if edge > 0 && edges[edge - 1].2 != loop_index {
            start = edge;
        }
        let last = edges.get(edge + 1).is_none_or(|e| e.2 != loop_index);
        let follower = if last { start } else { edge + 1 };
        if edges[follower].0 != end || edge < start + 2 && last {
            return Err(TriangulationError::NotClosed { edge });
        }
        next.push(follower);
    }
    Ok(next)
}

/// Centre of the bounding box and its longer side.
fn bounding_box(edges: &[([f64; 2], [f64; 2], usize)]) -> ([f64; 2], f64) {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for (a, _, _) in edges {
        for i in 0..2 {
            low[i] = low[i].min(a[i]);
            high[i] = high[i].max(a[i]);
        }
    }
    let centre = [low[0] + (high[0] - low[0]) / 2.0, low[1] + (high[1] - low[1]) / 2.0];
    (centre, (high[0] - low[0]).max(high[1] - low[1]))
}

/// Number of equal segments of an edge.
fn segments(edge: ([f64; 2], [f64; 2]), h: f64) -> usize {
    (distance(edge.0, edge.1) / h).round().max(1.0) as usize
}

/// Spacing at which boundary and lattice together have about the wanted number of points, found by bisection.
fn spacing(edges: &[([f64; 2], [f64; 2])], area: f64, target_points: usize) -> f64 {
    let perimeter: f64 = edges.iter().map(|&(a, b)| distance(a, b)).sum();
    let target = (target_points as f64).max(edges.len() as f64 + target_points as f64 / 2.0).max(3.0);
    let count = |h: f64| {
        let on_boundary: usize = edges.iter().map(|&e| segments(e, h)).sum();
        on_boundary as f64 + (area - CLEARANCE * h * perimeter).max(0.0) / (CELL * h * h)
    };
    let (mut low, mut high) = (0.1 * perimeter.min(1.0) / target, 1.0);
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        if count(middle) > target { low = middle } else { high = middle }
    }
    high
}

/// Points of a hexagonal lattice about the origin that lie inside, no closer to the boundary than the clearance.
fn lattice(edges: &[([f64; 2], [f64; 2])], h: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    let mut crossings = Vec::new();
    let mut near = Vec::new();
    let (clearance, row_height) = (CLEARANCE * h, CELL * h);
    let rows = (0.5 / row_height).floor() as i64;
    for row in -rows..=rows {
        let y = row as f64 * row_height;
        let shift = if row % 2 == 0 { 0.0 } else { h / 2.0 };
        crossings.clear();
        near.clear();
        for &(a, b) in edges {
            if (a[1] > y) != (b[1] > y) {
                crossings.push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
            }
            if a[1].min(b[1]) < y + clearance && a[1].max(b[1]) > y - clearance {
                near.push((a, b));
            }
        }
        crossings.sort_by(f64::total_cmp);
        for span in crossings.chunks_exact(2) {
            let mut i = ((span[0] - shift) / h).ceil();
            while i * h + shift < span[1] {
                let p = [i * h + shift, y];
                if near.iter().all(|&(a, b)| distance_to_segment(p, [a, b]) >= clearance) {
                    points.push(p);
                }
                i += 1.0;
            }
        }
    }
    points
}

/// Constrained Delaunay triangles inside the outline: an odd number of boundary segments separates them from the outer
/// face.
fn delaunay(points: Vec<[f64; 2]>, outline: &[[usize; 2]]) -> Result<Vec<[usize; 3]>, TriangulationError> {
    // spade refuses coordinates below 1e-43; on the unit body they are zero.
    let snap = |v: f64| if v.abs() < 1e-30 { 0.0 } else { v };
    let vertices: Vec<_> = points.iter().map(|p| Point2::new(snap(p[0]), snap(p[1]))).collect();
    let wanted = (vertices.len(), outline.len());
    let mut count = 0;
    let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(vertices, outline.to_vec(), |_| {
        count += 1;
    })
    .expect("coordinates on the unit body are finite and not too small");
    let lost = (wanted.0 - cdt.num_vertices()).max(wanted.1.abs_diff(cdt.num_constraints())).max(count);
    if lost > 0 {
        return Err(TriangulationError::Crossing { count: lost });
    }

    let mut inside: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
    inside[cdt.outer_face().index()] = Some(false);
    let mut triangles = Vec::new();
    let mut stack: Vec<_> = cdt.convex_hull().map(|e| if e.is_outer_edge() { e } else { e.rev() }).collect();
    while let Some(edge) = stack.pop() {
        let here = inside[edge.face().index()] == Some(true);
        let Some(across) = edge.rev().face().as_inner() else { continue };
        if inside[across.index()].is_none() {
            let enters = here != edge.is_constraint_edge();
            inside[across.index()] = Some(enters);
            if enters {
                triangles.push(across.vertices().map(|v| v.index()));
            }
            stack.extend(across.adjacent_edges());
        }
    }
    Ok(triangles)
}

#[cfg(test)]
#[path = "triangulate_tests.rs"]
mod tests;

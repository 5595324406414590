//! A window of the medium around a body, filled with triangles: for pictures and for viewers of the result file.

use rayon::prelude::*;
use steklov_bem_operators::Polygon;
use steklov_elastic::plane::distance;
use steklov_model::solve::medium::Around;

use crate::bodies::chords;
use crate::triangulate::{Triangulation, triangulate};

/// Distance of the window's sides from the body, in diameters of the body.
const MARGIN: f64 = 1.0;

/// Approximate number of points of the window.
const POINTS: usize = 4000;

/// The medium in a rectangle around the body.
#[derive(Debug, Clone)]
pub struct Window {
    /// Points.
    pub points: Vec<[f64; 2]>,
    /// Triangles between them.
    pub triangles: Vec<[usize; 3]>,
    /// Displacement and stress of the points.
    pub values: Vec<([f64; 2], [f64; 3])>,
}

/// The medium around the outer loop of a body; without triangles if the outline cannot be triangulated.
pub fn window(body: &Polygon, around: &Around) -> Window {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let interface: Vec<_> = body.traversal(0).into_iter().flat_map(|k| chords(body, k)).collect();
    for chord in &interface {
        for k in 0..2 {
            low[k] = low[k].min(chord.ends[0][k]);
            high[k] = high[k].max(chord.ends[0][k]);
        }
    }
    let margin = MARGIN * distance(high, low);
    let (low, high) = (low.map(|x| x - margin), high.map(|x| x + margin));
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let mut edges: Vec<_> = (0..4).map(|k| (corners[k], corners[(k + 1) % 4], 0)).collect();
    // the body is a hole of the window
    edges.extend(interface.iter().rev().map(|chord| (chord.ends[1], chord.ends[0], 1)));
    let Triangulation { points, triangles, boundary, .. } = triangulate(&edges, POINTS).unwrap_or_else(|_| {
        Triangulation { points: Vec::new(), triangles: Vec::new(), boundary: Vec::new(), outline: Vec::new() }
    });
    let value = |i: usize| match boundary[i] {
        Some((edge, _)) if edge >= 4 => around.beside(points[i]),
        _ => around.at(points[i]),
    };
    let values = (0..points.len()).into_par_iter().map(value).collect();
    Window { points, triangles, values }
}

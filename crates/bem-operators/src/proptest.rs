//! Random valid input for property tests, here and in the crates above (feature `proptest`).

use std::f64::consts::TAU;

use ::proptest::collection::vec;
use ::proptest::prelude::*;
use steklov_elastic::plane::{cross, distance};
use steklov_elastic::{Material, Plane};

use crate::{Loop, Mesh, Polygon};

/// Corners of a polygon that is star-shaped about `centre`, counter-clockwise: n of 3 to `max_corners`, at distances
/// of 0.4 to 1 times `radius`, any two neighbours seen from the centre under less than 170 degrees.
pub fn star(centre: [f64; 2], radius: f64, max_corners: usize) -> impl Strategy<Value = Vec<[f64; 2]>> {
    (vec((-0.2..0.2f64, 0.4..1.0f64), 3..=max_corners), 0.0..TAU).prop_map(move |(polar, turn)| {
        let n = polar.len() as f64;
        let corner = |(k, &(jitter, r)): (usize, &(f64, f64))| {
            let angle = turn + TAU * (k as f64 + jitter) / n;
            [centre[0] + radius * r * angle.cos(), centre[1] + radius * r * angle.sin()]
        };
        polar.iter().enumerate().map(corner).collect()
    })
}

/// A valid outer loop (star-shaped, about the origin, of size 1) and up to two holes in it, listed in either order.
/// Sides are named "a", "b" or "c", any of them on any loop.
pub fn loops() -> impl Strategy<Value = (Loop, Vec<Loop>)> {
    star([0.0, 0.0], 1.0, 9).prop_flat_map(|outer| {
        // A disc about the origin lies in the body; the holes share it, one on each side.
        let clear = outer.iter().enumerate().map(|(k, a)| {
            let b = outer[(k + 1) % outer.len()];
            cross(*a, b) / distance(b, *a)
        });
        let disc = clear.fold(f64::INFINITY, f64::min);
        let hole = |sign: f64| {
            (star([sign * disc / 2.0, 0.0], 0.4 * disc, 6), any::<bool>()).prop_map(|(mut corners, clockwise)| {
                if clockwise {
                    corners.reverse();
                }
                corners
            })
        };
        (Just(outer), hole(-1.0), hole(1.0), 0..=2usize).prop_flat_map(|(outer, left, right, holes)| {
            let holes: Vec<_> = [left, right].into_iter().take(holes).map(named).collect();
            (named(outer), holes)
        })
    })
}

fn named(corners: Vec<[f64; 2]>) -> impl Strategy<Value = Loop> {
    let sides = vec(prop::sample::select(vec!["a", "b", "c"]), corners.len());
    sides.prop_map(move |names| Loop::straight(corners.clone(), names.into_iter().map(String::from).collect()))
}

/// A polygon from [`loops`], moved by up to its size and scaled by 1e-3 to 1e3.
pub fn polygon() -> impl Strategy<Value = Polygon> {
    (loops(), -3.0..3.0f64, [-1.0..1.0f64, -1.0..1.0f64]).prop_map(|((outer, holes), exponent, shift)| {
        let scale = 10f64.powf(exponent);
        let moved = |l: Loop| {
            let corners = l.corners.iter().map(|x| [scale * (x[0] + shift[0]), scale * (x[1] + shift[1])]).collect();
            Loop::straight(corners, l.sides)
        };
        Polygon::new(moved(outer), holes.into_iter().map(moved).collect()).expect("star-shaped loops are valid")
    })
}

/// A polygon and a mesh of it: one to three unequal elements an edge (ratios up to 4), degrees 1 to `max_degree` mixed.
pub fn polygon_and_mesh(max_degree: usize) -> impl Strategy<Value = (Polygon, Mesh)> {
    polygon().prop_flat_map(move |polygon| {
        let edges = polygon.edges().len();
        let elements = vec(vec((0.5..2.0f64, 1..=max_degree), 1..=3), edges);
        (Just(polygon), elements).prop_map(|(polygon, elements)| {
            let breaks: Vec<Vec<f64>> = elements
                .iter()
                .map(|edge| {
                    let total: f64 = edge.iter().map(|e| e.0).sum();
                    let ends = edge.iter().scan(0.0, |s, e| {
                        *s += e.0 / total;
                        Some(*s)
                    });
                    ends.take(edge.len() - 1).collect()
                })
                .collect();
            let degrees: Vec<Vec<usize>> = elements.iter().map(|edge| edge.iter().map(|e| e.1).collect()).collect();
            let mesh = Mesh::from_breaks(&polygon, &breaks, &degrees).expect("rising breaks are valid");
            (polygon, mesh)
        })
    })
}

/// A mesh from [`polygon_and_mesh`].
pub fn mesh(max_degree: usize) -> impl Strategy<Value = Mesh> {
    polygon_and_mesh(max_degree).prop_map(|(_, mesh)| mesh)
}

/// Materials with E from 1e-3 to 1e6 and ν from -0.9 to 0.499, in both planes.
pub fn material() -> impl Strategy<Value = Material> {
    (-3.0..6.0f64, -0.9..0.499f64, prop_oneof![Just(Plane::Strain), Just(Plane::Stress)]).prop_map(
        |(exponent, poisson, plane)| {
            Material::new(10f64.powf(exponent), poisson, plane).expect("both moduli are in range")
        },
    )
}

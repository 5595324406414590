//! The largest von Mises stress of the bodies, and where it is.
//!
//! Along the boundary it is looked for at points of each element, inside at points below them: beneath a contact it may be larger than at
//! the surface. From the best points it is followed uphill. What is narrower than the distances of these points is missed.

use rayon::prelude::*;
use steklov_bem_operators::{Location, Mesh};
use steklov_elastic::plane::distance;
use steklov_problem::{Scene, facets};

use crate::answer::singular_points::singular_points;
use crate::solve::contact_rows::ContactRow;
use crate::solve::fields::ElasticField;

/// Depths of points below an element, over its length.
const DEPTHS: [f64; 4] = [0.2, 0.5, 1.2, 3.0];
/// Elements with less than this part of the largest stress have no such points below them.
const PART: f64 = 0.3;
/// Least distance from an element of a point inside, over its length and for degree 1.
const NEAREST: f64 = 0.4;
/// Points of an element more than its degree.
const MORE: usize = 3;
/// Elements, and places inside, from which the largest stress is followed.
const STARTS: usize = 3;
/// Steps along an element, and times that steps inside are shortened: a place is known to this part of its neighbourhood, the stress to its
/// square.
const STEPS: usize = 24;
const SHORTENED: i32 = 4;
/// Steps uphill after which they become twice as long.
const MANY: usize = 8;
/// Stresses that differ by less are the same.
const SAME: f64 = 1e-9;
/// Distance from the middle of the boundary, over its diameter, up to which a medium is searched.
const FAR: f64 = 3.0;

/// The largest von Mises stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestStress {
    /// Its value.
    pub value: f64,
    /// Where it is.
    pub point: [f64; 2],
    /// The reference coordinate of an element, or a body.
    place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Boundary(usize, f64),
    Inside(usize),
}

impl LargestStress {
    /// The stress of another field at the same place.
    pub(crate) fn of(&self, scene: &Scene, field: &ElasticField<'_>) -> f64 {
        let (body, stress) = match self.place {
            Place::Boundary(e, t) => (scene.problem.body_of_side(field.mesh.side[e]), field.on_boundary(e, t).1),
            Place::Inside(body) => (body, field.inside(body, self.point).1),
        };
        scene.problem.bodies[body].material().von_mises(stress)
    }
}

/// Whether the stress is finite everywhere, of curves that are no polygons.
pub(crate) fn is_bounded(scene: &Scene, mesh: &Mesh, rows: &[ContactRow]) -> bool {
    facets(&scene.problem.outline).is_empty() && singular_points(scene, mesh, rows).is_empty()
}

/// The largest von Mises stress of a field of the bodies; None where that far away in a medium is larger.
pub(crate) fn largest_von_mises(scene: &Scene, field: &ElasticField<'_>) -> Option<LargestStress> {
    let problem = &scene.problem;
    let (mesh, outline) = (field.mesh, &problem.outline);
    let body_of = |e: usize| problem.body_of_side(mesh.side[e]);
    let of = |body: usize, stress: [f64; 3]| problem.bodies[body].material().von_mises(stress);
    let on_boundary = |e: usize, t: f64| of(body_of(e), field.on_boundary(e, t).1);
    // of an element the largest stress, and the largest von Mises stress with its place between two others
    let highest = |e: usize| {
        let count = mesh.degree[e] + MORE;
        let at = |k: usize| 2.0 * k as f64 / (count - 1) as f64 - 1.0;
        let stresses: Vec<[f64; 3]> = (0..count).map(|k| field.on_boundary(e, at(k)).1).collect();
        let size = stresses.iter().map(|[xx, yy, xy]| xx.hypot(*yy).hypot(*xy)).fold(0.0, f64::max);
        let best = stresses.iter().map(|&stress| of(body_of(e), stress)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(k, value)| (value, e, [at(k.saturating_sub(1)), at(k), at((k + 1).min(count - 1))], size))
    };
    let mut highest: Vec<_> = (0..mesh.len()).into_par_iter().filter_map(highest).collect();
    let least = PART * highest.iter().map(|own| own.3).fold(0.0, f64::max);
    let loaded: Vec<usize> = highest.iter().filter(|own| own.3 >= least).map(|own| own.1).collect();
    highest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let on_surface = highest.into_iter().take(STARTS).map(|(_, e, between, _)| {
        let (value, t) = uphill(between, |t| on_boundary(e, t));
        LargestStress { value, point: mesh.point(e, t), place: Place::Boundary(e, t) }
    });

    let (layers, reach) = (layers(mesh), FAR * outline.diameter());
    let inside = |body: usize, x: [f64; 2]| {
        let is_far = || !outline.is_body_bounded(body) && distance(x, outline.centroid()) > reach;
        let is_inside = || outline.body_at(x) == Some(body) && matches!(outline.contains(x), Location::Inside);
        let is_beside = layers.iter().any(|(near, points)| points.iter().any(|y| distance(*y, x) < *near));
        if is_beside || is_far() || !is_inside() { f64::NEG_INFINITY } else { of(body, field.inside(body, x).1) }
    };
    // the largest below the middle of an element, unless the stress falls from there on
    let below = |e: usize| {
        let ([x, y], [nx, ny], body) = (mesh.point(e, 0.0), mesh.normal(e, 0.0), body_of(e));
        let at = |depth: f64| [x - depth * nx, y - depth * ny];
        let depths = DEPTHS.map(|depth| depth * mesh.length(e));
        let best =
            depths.map(|depth| (inside(body, at(depth)), depth)).into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 > on_boundary(e, 0.0)).then(|| (best.0, body, at(best.1), best.1))
    };
    let mut found: Vec<_> = loaded.into_par_iter().filter_map(below).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut starts: Vec<(f64, usize, [f64; 2], f64)> = Vec::new();
    for own in found {
        if starts.len() < STARTS && starts.iter().all(|other| distance(own.2, other.2) > other.3) {
            starts.push(own);
        }
    }
    let follow = |(value, body, x, depth): (f64, usize, [f64; 2], f64)| {
        let (value, point) = climb((value, x), depth / 2.0, |x| inside(body, x));
        LargestStress { value, point, place: Place::Inside(body) }
    };
    let all = starts.into_iter().map(follow).chain(on_surface);
    let far =
        problem.bodies.iter().filter_map(|body| Some(body.material().von_mises(body.far.as_ref()?.remote_stress)));
    let least = far.fold(0.0, f64::max);
    all.max_by(|a, b| a.value.total_cmp(&b.value)).filter(|own| own.value >= least * (1.0 - SAME))
}

/// Points of each element, and how near to them a point has no stress: that of a discrete field is infinite at the ends of elements.
fn layers(mesh: &Mesh) -> Vec<(f64, [[f64; 2]; 5])> {
    let of = |e: usize| {
        let near = NEAREST * mesh.length(e) / mesh.degree[e] as f64;
        (near, [-1.0, -0.5, 0.0, 0.5, 1.0].map(|t| mesh.point(e, t)))
    };
    (0..mesh.len()).map(of).collect()
}

/// The largest value between three rising places whose middle one is the largest, and its place: by golden sections.
fn uphill([mut a, mut middle, mut b]: [f64; 3], of: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let mut best = of(middle);
    for _ in 0..STEPS {
        let next =
            if b - middle > middle - a { middle + GOLDEN * (b - middle) } else { middle - GOLDEN * (middle - a) };
        let value = of(next);
        if value > best {
            if next > middle {
                a = middle
            } else {
                b = middle
            }
            (middle, best) = (next, value);
        } else if next > middle {
            b = next;
        } else {
            a = next;
        }
    }
    (best, middle)
}

/// Uphill from a point by steps along x and y, which become longer on a long way. Where none leads higher the top of a parabola through the
/// points about it does, and the steps become shorter.
fn climb((mut value, mut point): (f64, [f64; 2]), mut step: f64, of: impl Fn([f64; 2]) -> f64) -> (f64, [f64; 2]) {
    let (shortest, mut steps) = (step / 4f64.powi(SHORTENED), 0);
    while step > shortest {
        let beside = |by: [f64; 2]| of([point[0] + by[0], point[1] + by[1]]);
        let [east, west, north, south] = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]].map(beside);
        let higher = [(east, [step, 0.0]), (west, [-step, 0.0]), (north, [0.0, step]), (south, [0.0, -step])];
        let (best, by) = higher.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        if best > value {
            (value, point) = (best, [point[0] + by[0], point[1] + by[1]]);
            steps += 1;
            step *= if steps % MANY == 0 { 2.0 } else { 1.0 };
            continue;
        }
        let corner = beside([step, step]);
        let [fx, fy] = [(east - west) / 2.0, (north - south) / 2.0];
        let [fxx, fyy] = [east - 2.0 * value + west, north - 2.0 * value + south];
        let fxy = corner - value - fx - fy - (fxx + fyy) / 2.0;
        let determinant = fxx * fyy - fxy * fxy;
        let to = [fxy * fy - fyy * fx, fxy * fx - fxx * fy].map(|by| step * by / determinant);
        let at = [point[0] + to[0], point[1] + to[1]];
        if determinant > 0.0 && to[0].hypot(to[1]) <= step {
            let top = of(at);
            if top > value {
                (value, point) = (top, at);
            }
        }
        step /= 4.0;
    }
    (value, point)
}

//! Decides from a few of their rows whether obstacles all around leave a body any rigid motion.

use nalgebra::Vector3;

type Vector = Vector3<f64>;

/// Largest number of rows that are tried.
const MOST: usize = 24;

/// Whether max_i n_i·r > `least` for all unit vectors r, with the rows n_i of three entries; false where a few of the rows do not
/// show it.
///
/// For a subset of the rows, {v: n_i·v ≤ 1 for all i} is a polytope if all rays in which two of the planes n_i·v = 0 meet are
/// stopped. With R the distance of its farthest vertex from 0, n_i·r ≥ 1/R for some i. A ray that nothing in the subset stops
/// adds the row that stops it most.
pub(crate) fn every_way(rows: &[Vec<f64>], least: f64) -> bool {
    let Some(rows) =
        rows.iter().map(|r| Some(Vector::from(<[f64; 3]>::try_from(r.as_slice()).ok()?))).collect::<Option<Vec<_>>>()
    else {
        return false;
    };
    let stops_most = |ray: Vector| {
        let most = rows.iter().max_by(|a, b| a.dot(&ray).total_cmp(&b.dot(&ray)));
        most.copied().filter(|row| row.dot(&ray) > least)
    };
    let mut some = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let Some(row) = stops_most(Vector::ith(axis, sign)) else { return false };
            some.push(row);
        }
    }
    while some.len() <= MOST {
        match open_ray(&some, least) {
            Some(ray) => match stops_most(ray) {
                Some(row) => some.push(row),
                None => return false,
            },
            // a margin for rounding errors
            None => return farthest_vertex(&some) * least < 0.1,
        }
    }
    false
}

/// A ray in which two of the planes meet and that no row stops.
fn open_ray(rows: &[Vector], least: f64) -> Option<Vector> {
    for (i, &p) in rows.iter().enumerate() {
        for &q in &rows[..i] {
            let line = p.cross(&q);
            let size = line.norm();
            for sign in [1.0, -1.0] {
                let ray = line * sign / size;
                if size > 0.0 && rows.iter().all(|row| row.dot(&ray) <= least) {
                    return Some(ray);
                }
            }
        }
    }
    None
}

/// Distance from 0 of the farthest vertex of {v: n_i·v ≤ 1}; infinite if there is none.
fn farthest_vertex(rows: &[Vector]) -> f64 {
    let mut farthest: Option<f64> = None;
    for (i, &a) in rows.iter().enumerate() {
        for (j, &b) in rows[..i].iter().enumerate() {
            for &c in &rows[..j] {
                let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
                let volume = a.dot(&bc);
                let vertex = (bc + ca + ab) / volume;
                if volume != 0.0 && rows.iter().all(|row| row.dot(&vertex) <= 1.0 + 1e-6) {
                    farthest = Some(farthest.unwrap_or(0.0).max(vertex.norm()));
                }
            }
        }
    }
    farthest.unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u_n of the motions x, y and a turn about 0 at both ends of the sides of a regular polygon on its circle of radius 1,
    /// turned by an angle, without the first `open` sides.
    fn rows(sides: usize, open: usize, angle: f64) -> Vec<Vec<f64>> {
        let at = |k: f64| (angle + std::f64::consts::TAU * k / sides as f64).sin_cos();
        let side = |k: usize| {
            let (ny, nx) = at(k as f64 + 0.5);
            [k as f64, k as f64 + 1.0].map(at).map(|(y, x)| vec![nx, ny, x * ny - y * nx])
        };
        (open..sides).flat_map(side).collect()
    }

    /// The largest of n_i·r on a unit sphere is least along the turn: the sine of half the angle of a side, by the ends of the
    /// sides that move outwards.
    #[test]
    fn a_polygon_among_obstacles_is_stopped_up_to_the_turn_of_a_side() {
        for sides in [3, 4, 7, 40, 1000] {
            let margin = (std::f64::consts::PI / sides as f64).sin();
            for angle in [0.0, 0.3] {
                let rows = rows(sides, 0, angle);
                assert!(every_way(&rows, 0.02 * margin), "{sides}");
                assert!(!every_way(&rows, 1.001 * margin), "{sides}");
            }
        }
    }

    #[test]
    fn what_can_leave_on_one_side_is_not_stopped() {
        for (sides, open) in [(4, 1), (7, 4), (40, 21), (1000, 501), (1000, 999)] {
            assert!(!every_way(&rows(sides, open, 0.1), 1e-9), "{sides} {open}");
        }
        // two thirds of the sides hold it
        assert!(every_way(&rows(999, 333, 0.1), 1e-9));
    }

    /// Rows of one plane, as those of a floor, and of a circle about the centre of the turn leave motions.
    #[test]
    fn rows_of_less_than_three_dimensions_stop_not_every_way() {
        let turned = |n: usize| std::f64::consts::TAU * n as f64 / 100.0;
        let circle: Vec<Vec<f64>> = (0..100).map(|n| vec![turned(n).cos(), turned(n).sin(), 0.0]).collect();
        assert!(!every_way(&circle, 1e-9));
        let floor: Vec<Vec<f64>> = (0..100).map(|n| vec![0.0, -1.0, n as f64 - 50.0]).collect();
        assert!(!every_way(&floor, 1e-9));
        assert!(!every_way(&[vec![1.0, 0.0]], 1e-9) && !every_way(&[], 1e-9));
    }
}

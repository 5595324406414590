//! Vectors `[x, y]` of the plane. Each function is one order of operations, so that its bits are the same wherever it is called.

/// a·b = a_x b_x + a_y b_y.
pub fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// a × b = a_x b_y - a_y b_x, positive where b is to the left of a.
pub fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// J a = (-a_y, a_x), the rotation by +90°.
pub fn turned(a: [f64; 2]) -> [f64; 2] {
    [-a[1], a[0]]
}

/// a - b.
pub fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// |a| = √(a_x² + a_y²), without overflow.
pub fn norm(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

/// |a - b|, the distance of two points.
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    norm(minus(a, b))
}

/// a / |a|, not a number for a = 0.
pub fn unit(a: [f64; 2]) -> [f64; 2] {
    let length = norm(a);
    [a[0] / length, a[1] / length]
}

/// The angle from a to b in [-π, π], positive where b is to the left of a: atan2(a × b, a·b).
pub fn angle(a: [f64; 2], b: [f64; 2]) -> f64 {
    cross(a, b).atan2(dot(a, b))
}

/// x of A x = b by Cramer's rule: (a_11 b_0 - a_01 b_1, a_00 b_1 - a_10 b_0) / (a_00 a_11 - a_01 a_10).
pub fn solve2(a: [[f64; 2]; 2], b: [f64; 2]) -> [f64; 2] {
    let det = cross(a[0], a[1]);
    [(a[1][1] * b[0] - a[0][1] * b[1]) / det, (a[0][0] * b[1] - a[1][0] * b[0]) / det]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// All numbers are exact: multiples of the triangle of sides 3, 4 and 5.
    #[test]
    fn functions_of_vectors_follow_their_formulas() {
        let (a, b) = ([3.0, 4.0], [-8.0, 6.0]);
        assert_eq!((dot(a, b), cross(a, b), cross(b, a)), (0.0, 50.0, -50.0));
        assert_eq!((dot(a, a), turned(a), minus(a, b)), (25.0, [-4.0, 3.0], [11.0, -2.0]));
        assert_eq!((norm(a), norm(b), distance([1.0, 2.0], [4.0, -2.0])), (5.0, 10.0, 5.0));
        assert_eq!((unit(a), unit(b)), ([0.6, 0.8], [-0.8, 0.6]));
        let large = a.map(|x| x * 2f64.powi(800));
        assert_eq!((norm(large), unit(large)), (5.0 * 2f64.powi(800), [0.6, 0.8]));
        assert_eq!((angle(a, b), angle(b, a), angle(a, [-3.0, -4.0])), (FRAC_PI_2, -FRAC_PI_2, PI));
    }

    #[test]
    fn two_equations_are_solved() {
        let a = [[2.0, -1.0], [1.0, 4.0]];
        let x = solve2(a, [8.0, -5.0]);
        assert_eq!(x, [3.0, -2.0]);
        assert_eq!(a.map(|row| dot(row, x)), [8.0, -5.0]);
        assert_eq!(solve2([[0.0, 2.0], [4.0, 0.0]], [6.0, 8.0]), [2.0, 3.0]);
    }
}

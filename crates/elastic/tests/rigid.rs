//! Rigid motions that given constraints leave free, and their names.

use proptest::prelude::*;
use steklov_elastic::{RigidMotion, free_motions};

type Held = ([f64; 2], [f64; 2]);

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];

/// Largest |r(x)·d| over the constraints, for d of length 1, relative to the motion's size on the square.
fn violation(r: &RigidMotion, held: &[Held]) -> f64 {
    let scale = SQUARE.iter().map(|&x| r.at(x)[0].hypot(r.at(x)[1])).fold(0.0, f64::max);
    let work = |(x, d): &Held| (r.at(*x)[0] * d[0] + r.at(*x)[1] * d[1]).abs() / d[0].hypot(d[1]);
    held.iter().map(work).fold(0.0, f64::max) / scale
}

/// Coordinates (r(c), ρω) of the square: c = (1, 1), ρ = √2.
fn coordinates(r: &RigidMotion) -> [f64; 3] {
    let a = r.at([1.0, 1.0]);
    [a[0], a[1], r.rotation * 2f64.sqrt()]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

#[test]
fn names_of_the_usual_supports() {
    let (x, y) = ([1.0, 0.0], [0.0, 1.0]);
    let name = |held: &[Held]| RigidMotion::names(&free_motions(&SQUARE, held));
    assert_eq!(name(&[]), "translation along (1, 0), translation along (0, 1) and rotation about (1, 1)");
    assert_eq!(name(&[([0.5, 0.0], x), ([0.5, 0.0], y)]), "rotation about (0.5, 0)");
    assert_eq!(name(&[([0.0, 0.0], y), ([2.0, 0.0], y)]), "translation along (1, 0)");
    assert_eq!(name(&[([0.0, 0.0], x), ([0.0, 2.0], x)]), "translation along (0, 1)");
    assert_eq!(name(&[([0.0, 0.0], [-1.0, 1.0]), ([2.0, 2.0], [-2.0, 2.0])]), "translation along (0.707107, 0.707107)");
    assert_eq!(name(&[([2.0, 0.0], y)]), "translation along (1, 0) and rotation about (2, 1)");
    assert_eq!(name(&[([0.0, 0.0], x), ([0.0, 0.0], y), ([2.0, 0.0], y)]), "no rigid motion");
    // Rollers on a circle about (1/3, 0), which is not a held point.
    let rollers: Vec<Held> =
        (0..7).map(|k| f64::from(k).sin_cos()).map(|(s, c)| ([1.0 / 3.0 + c, s], [c, s])).collect();
    assert_eq!(name(&rollers), "rotation about (0.333333, 0)");
}

#[test]
fn any_motion_has_a_name() {
    let moved = RigidMotion { translation: [0.0, 1.0], rotation: 2.0, centre: [3.0, 4.0] };
    assert_eq!(moved.to_string(), "rotation about (2.5, 4)");
    assert_eq!(moved.at([2.5, 4.0]), [0.0, 0.0]);
    assert_eq!(RigidMotion::along([0.0, -3.0]).to_string(), "translation along (0, -1)");
    assert_eq!(RigidMotion::along([0.0, 0.0]).to_string(), "no motion");
    assert_eq!(RigidMotion::about([1.25e9, -3e-7], 1.0).to_string(), "rotation about (1250000000, 0)");
}

/// Two pinned points a distance d apart hold the rotation as long as d is seen by the body: the edge of the rank.
#[test]
fn two_points_hold_the_rotation_down_to_the_tolerance() {
    for (d, free) in [(1.0, 0), (1e-8, 0), (1e-9, 0), (1e-11, 1), (1e-13, 1), (0.0, 1)] {
        let held: Vec<Held> =
            [[1.0, 0.0], [1.0 + d, 0.0]].iter().flat_map(|&x| [(x, [1.0, 0.0]), (x, [0.0, 1.0])]).collect();
        assert_eq!(free_motions(&SQUARE, &held).len(), free, "{d}");
        let large: Vec<[f64; 2]> = SQUARE.iter().map(|x| [1e-6 * x[0], 1e-6 * x[1]]).collect();
        let small: Vec<Held> =
            held.iter().map(|(x, d)| ([1e-6 * x[0], 1e-6 * x[1]], [1e6 * d[0], 1e6 * d[1]])).collect();
        assert_eq!(free_motions(&large, &small).len(), free, "{d}, scaled");
    }
}

#[test]
fn a_zero_direction_is_no_constraint() {
    assert_eq!(free_motions(&SQUARE, &[([0.0, 0.0], [0.0, 0.0])]), free_motions(&SQUARE, &[]));
}

fn constraint() -> impl Strategy<Value = Held> {
    ([0.0..2.0f64, 0.0..2.0f64], 0.0..6.3f64, 0.1..10.0f64).prop_map(|(x, a, r)| (x, [r * a.cos(), r * a.sin()]))
}

proptest! {
    /// No two points change their distance to first order, and the nodal values are those of the points.
    #[test]
    fn motions_are_rigid(a in [-1.0..1.0f64, -1.0..1.0f64], w in -2.0..2.0f64, c in [-1.0..1.0f64, -1.0..1.0f64]) {
        let r = RigidMotion { translation: a, rotation: w, centre: c };
        let u = r.nodal(&SQUARE);
        prop_assert_eq!(r.at(c), a);
        for i in 0..4 {
            for j in 0..i {
                let d = [SQUARE[i][0] - SQUARE[j][0], SQUARE[i][1] - SQUARE[j][1]];
                let e = [u[2 * i] - u[2 * j], u[2 * i + 1] - u[2 * j + 1]];
                prop_assert!((d[0] * e[0] + d[1] * e[1]).abs() < 1e-14);
                prop_assert!((d[0] * e[1] - d[1] * e[0] - w * (d[0] * d[0] + d[1] * d[1])).abs() < 1e-13);
            }
        }
    }

    /// k constraints in general position leave 3 - k motions, orthonormal and at zero where they are held.
    #[test]
    fn each_constraint_takes_one_motion(held in prop::collection::vec(constraint(), 0..6)) {
        let free = free_motions(&SQUARE, &held);
        prop_assert_eq!(free.len(), 3usize.saturating_sub(held.len()));
        for (i, r) in free.iter().enumerate() {
            prop_assert!(violation(r, &held) < 1e-11, "{}", violation(r, &held));
            for (j, q) in free.iter().enumerate() {
                let expected = if i == j { 1.0 } else { 0.0 };
                prop_assert!((dot(coordinates(r), coordinates(q)) - expected).abs() < 1e-10);
            }
        }
    }

    /// Constraints across a chosen motion leave that motion and no other.
    #[test]
    fn the_motion_that_no_constraint_sees_is_found(
        points in prop::collection::vec([0.0..2.0f64, 0.0..2.0f64], 3..9),
        centre in [-9.0..9.0f64, -9.0..9.0f64],
        direction in 0.0..6.3f64,
        turns in any::<bool>(),
    ) {
        let wanted = match turns {
            true => RigidMotion::about(centre, 1.0),
            false => RigidMotion::along([direction.cos(), direction.sin()]),
        };
        let held: Vec<Held> = points.iter().map(|&x| (x, [-wanted.at(x)[1], wanted.at(x)[0]])).collect();
        // Points on one line through the fixed point would leave a second motion: not in general position.
        let free = free_motions(&SQUARE, &held);
        prop_assert_eq!(free.len(), 1);
        let (a, b) = (coordinates(&free[0]), coordinates(&wanted));
        let aligned = dot(a, b).powi(2) / (dot(a, a) * dot(b, b));
        prop_assert!((aligned - 1.0).abs() < 1e-9, "{} instead of {}", free[0], wanted);
        prop_assert_eq!(free[0].rotation != 0.0, turns);
        prop_assert!(violation(&free[0], &held) < 1e-9);
    }
}

//! Rigid motions of bodies on obstacles: held, free, or driven.

use proptest::prelude::*;
use steklov_contact::{ContactEdge, ContactError, resisted_motions};
use steklov_elastic::{RigidMotion, free_motions};

const CORNERS: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];

fn floor(friction: f64) -> ContactEdge {
    ContactEdge { ends: [CORNERS[0], CORNERS[1]], normal: [0.0, -1.0], friction, coefficient: 0.0 }
}

/// Free motions of a square on the edges under a force at a point.
fn check(edges: &[ContactEdge], forces: &[([f64; 2], [f64; 2])]) -> Result<Vec<RigidMotion>, ContactError> {
    resisted_motions(&free_motions(&CORNERS, &[]), edges, |r| {
        let works = forces.iter().map(|(x, f)| (r.at(*x), f)).map(|(u, f)| u[0] * f[0] + u[1] * f[1]);
        works.fold((0.0, 0.0), |(sum, scale), w| (sum + w, scale + w.abs()))
    })
}

#[test]
fn a_block_on_a_rough_floor_is_held_by_friction_up_to_its_bound() {
    let press = ([0.0, 0.5], [0.0, -1.0]);
    assert_eq!(check(&[floor(0.3)], &[press]).expect("held"), vec![]);
    assert_eq!(check(&[floor(0.3)], &[press, ([0.0, -0.5], [0.2999, 0.0])]).expect("held"), vec![]);
    let pushed = check(&[floor(0.3)], &[press, ([0.0, -0.5], [0.3001, 0.0])]);
    assert!(matches!(pushed, Err(ContactError::RigidMotion { .. })), "{pushed:?}");
    // full stick holds any push that does not overturn the block
    assert_eq!(check(&[floor(f64::INFINITY)], &[press, ([0.0, -0.4], [4.9, 0.0])]).expect("held"), vec![]);
    assert!(check(&[floor(f64::INFINITY)], &[press, ([0.0, -0.4], [5.1, 0.0])]).is_err());
}

#[test]
fn coulomb_friction_holds_up_to_its_share_of_the_pressure() {
    let rough = |coefficient| [ContactEdge { coefficient, ..floor(0.0) }];
    let pushed = |q: f64, height: f64| [([0.0, 0.5], [0.0, -2.0]), ([0.0, height], [q, 0.0])];
    assert_eq!(check(&rough(0.3), &pushed(0.5999, -0.5)).expect("held"), vec![]);
    let slides = check(&rough(0.3), &pushed(0.6001, -0.5)).expect_err("slides");
    let ContactError::RigidMotion { work, resistance, .. } = slides else { panic!("{slides:?}") };
    assert!(work > 0.0 && resistance == 0.0);
    // pushed at the top the block overturns before it slides: 1 q against 2/2
    assert_eq!(check(&rough(2.0), &pushed(0.999, 0.5)).expect("held"), vec![]);
    assert!(check(&rough(2.0), &pushed(1.001, 0.5)).is_err());
    // no pressure, no friction
    assert!(check(&rough(5.0), &[([0.0, 0.5], [0.0, 1e-3])]).is_err());
    // Tresca's part comes on top
    let both = [ContactEdge { coefficient: 0.3, ..floor(0.1) }];
    assert_eq!(check(&both, &pushed(0.6999, -0.5)).expect("held"), vec![]);
    assert!(check(&both, &pushed(0.7001, -0.5)).is_err());
    // a wedge at 45° on both sides jams without any load along it, from μ = 1 on
    let walls = |coefficient| {
        let d = 0.5f64.sqrt();
        let wall = |ends, normal| ContactEdge { ends, normal, friction: 0.0, coefficient };
        [wall([CORNERS[0], CORNERS[3]], [-d, -d]), wall([CORNERS[1], CORNERS[2]], [d, -d])]
    };
    let up = [([0.0, 0.0], [0.0, 0.1])];
    assert!(check(&walls(0.99), &up).is_err() && check(&walls(1.01), &up).is_ok());
}

#[test]
fn a_block_on_a_smooth_floor_slides_freely_unless_pushed() {
    let press = ([0.1, 0.5], [0.0, -1.0]);
    let free = check(&[floor(0.0)], &[press]).expect("free to slide");
    assert_eq!(free.len(), 1);
    assert!(free[0].rotation.abs() < 1e-12 && free[0].translation[1].abs() < 1e-12 && free[0].translation[0] != 0.0);
    assert!(check(&[floor(0.0)], &[press, ([0.0, 0.0], [1e-6, 0.0])]).is_err());
    // a wall on the right stops a push to the right, not one to the left
    let wall = ContactEdge { ends: [CORNERS[1], CORNERS[2]], normal: [1.0, 0.0], friction: 0.0, coefficient: 0.0 };
    assert_eq!(check(&[floor(0.0), wall.clone()], &[press, ([0.5, -0.3], [0.1, 0.0])]).expect("held"), vec![]);
    assert!(check(&[floor(0.0), wall], &[press, ([0.5, -0.3], [-0.1, 0.0])]).is_err());
}

#[test]
fn lifting_and_overturning_are_named() {
    for forces in [vec![([0.0, 0.5], [0.0, 1.0])], vec![([0.6, 0.5], [0.0, -1.0])]] {
        let error = check(&[floor(1.0)], &forces).expect_err("not held");
        let text = error.to_string();
        assert!(text.contains("translation along") || text.contains("rotation about"), "{text}");
    }
    // a resultant just inside the foot is held
    assert_eq!(check(&[floor(1.0)], &[([0.499, 0.5], [0.0, -1.0])]).expect("held"), vec![]);
}

/// Balanced loads leave all motions to springs that no friction holds, also those that only lift.
#[test]
fn what_nothing_drives_may_lift() {
    let squeeze = [([0.5, 0.3], [-40.0, 0.0]), ([-0.5, 0.3], [40.0, 0.0])];
    for forces in [&[][..], &squeeze] {
        assert_eq!(check(&[floor(0.0)], forces).expect("free").len(), 3);
        let lifts = check(&[floor(1.0)], forces).expect("free");
        assert!(!lifts.is_empty() && lifts.iter().any(|r| r.at([0.0, -0.5])[1].abs() > 0.1), "{lifts:?}");
    }
    let moment = [squeeze[0], ([-0.5, 0.3 + 1e-6], [40.0, 0.0])];
    assert!(check(&[floor(0.0)], &moment).is_err());
}

proptest! {
    /// The rays decide: L - j sampled over the cone is never larger than what they allow.
    #[test]
    fn sampled_motions_agree_with_the_verdict(
        press in 0.1..2.0f64, at in -0.7..0.7f64, push in -1.0..1.0f64, friction in 0.0..1.0f64,
        samples in proptest::collection::vec([-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64], 400),
    ) {
        let forces = [([at, 0.5], [0.0, -press]), ([0.0, -0.5], [push, 0.0])];
        let verdict = check(&[floor(friction)], &forces);
        let mut driven = false;
        for [x, y, w] in samples {
            // motions that only lift: u_y ≥ 0 at both ends of the floor
            let (left, right) = (y.abs(), w.abs());
            let rotation = right - left;
            let r = RigidMotion { translation: [x, (left + right) / 2.0], rotation, centre: [0.0, -0.5] };
            let work: f64 = forces.iter().map(|(p, f)| (r.at(*p), f)).map(|(u, f)| u[0] * f[0] + u[1] * f[1]).sum();
            driven |= work > friction * x.abs() + 1e-7;
        }
        prop_assert!(!(driven && verdict.is_ok()), "{verdict:?}");
    }
}

//! The proximal map and the complementarity functions against their definitions.

use proptest::prelude::*;

use steklov_elastic::plane::{distance, dot, turned};

use crate::proptest::{Friction, mixed};
use crate::solvers::law::Law;
use crate::{Condition, ContactNode, Problem, active_set, kkt};

fn condition(normal: [f64; 2], bound: f64, gap: f64) -> Condition {
    let tangent = turned(normal);
    Condition {
        normal,
        tangent,
        normal_weight: 1.0,
        tangent_weight: 1.0,
        gap,
        slip_offset: 0.0,
        bound,
        coefficient: 0.0,
    }
}

fn phi(law: &Law, w: [f64; 2]) -> f64 {
    let theta = |k: &crate::solvers::law::Kink| {
        let s = dot(k.direction, w) - k.at;
        // the indicator forgives roundoff
        if s.abs() < 1e-12 {
            0.0
        } else if s < 0.0 {
            if k.low == 0.0 { 0.0 } else { k.low * s }
        } else {
            k.high * s
        }
    };
    law.kinks.iter().map(theta).sum()
}

proptest! {
    #[test]
    fn prox_minimises_its_functional(problem in mixed(1, Friction::Tresca), z in (-3.0..3.0f64, -3.0..3.0f64),
                                     y in (-1.0..1.0f64, -1.0..1.0f64),
                                     c in (0.1..10.0f64, 0.1..10.0f64), t in 1e-6..1.0f64) {
        let node = &problem.nodes[0];
        let two = node.unknowns == 2;
        let law = Law::new(node, [c.0, c.1], &[]);
        let z = [z.0, if two { z.1 } else { 0.0 }];
        let (w, _, missed) = law.prox(z);
        prop_assert!(missed <= 1e-12, "{missed:e}");
        let cost = |w: [f64; 2]| phi(&law, w) + 0.5 * (c.0 * (w[0] - z[0]).powi(2) + c.1 * (w[1] - z[1]).powi(2));
        let other = [w[0] + t * y.0, if two { w[1] + t * y.1 } else { 0.0 }];
        prop_assert!(cost(w) <= cost(other) + 1e-10, "{w:?} {} {other:?} {}", cost(w), cost(other));
    }

    #[test]
    fn prox_does_not_expand(problem in mixed(1, Friction::Tresca), a in (-3.0..3.0f64, -3.0..3.0f64), b in (-3.0..3.0f64, -3.0..3.0f64)) {
        let law = Law::new(&problem.nodes[0], [1.0, 1.0], &[]);
        let two = problem.nodes[0].unknowns == 2;
        let cut = |a: (f64, f64)| [a.0, if two { a.1 } else { 0.0 }];
        let (a, b) = (cut(a), cut(b));
        let (x, y) = (law.prox(a).0, law.prox(b).0);
        prop_assert!(distance(x, y) <= distance(a, b) + 1e-12);
    }

    #[test]
    fn without_friction_prox_is_a_projection(problem in mixed(1, Friction::Tresca), z in (-3.0..3.0f64, -3.0..3.0f64)) {
        let mut node = problem.nodes[0].clone();
        node.conditions.iter_mut().for_each(|c| c.bound = 0.0);
        let law = Law::new(&node, [1.0, 1.0], &[]);
        let once = law.prox([z.0, if node.unknowns == 2 { z.1 } else { 0.0 }]).0;
        let twice = law.prox(once).0;
        prop_assert!(distance(once, twice) <= 1e-13);
    }

    #[test]
    fn an_ordinary_node_is_a_minimum_and_a_soft_threshold(z in (-3.0..3.0f64, -3.0..3.0f64), gap in -1.0..1.0f64,
                                                          bound in 0.0..2.0f64, c in (0.1..10.0f64, 0.1..10.0f64)) {
        let node = ContactNode { first: 0, unknowns: 2, conditions: vec![condition([1.0, 0.0], bound, gap)] };
        let (w, ..) = Law::new(&node, [c.0, c.1], &[]).prox([z.0, z.1]);
        let threshold = z.1.signum() * (z.1.abs() - bound / c.1).max(0.0);
        prop_assert!((w[0] - z.0.min(gap)).abs() < 1e-14 && (w[1] - threshold).abs() < 1e-14);
    }

    #[test]
    fn pressures_alone_carry_a_corner_pressed_inwards(angle in -3.0..3.0f64, opening in 0.2..2.8f64,
                                                      share in (0.01..1.0f64, 0.01..1.0f64),
                                                      bound in 0.01..2.0f64) {
        let (n, m) = ([angle.cos(), angle.sin()], [(angle + opening).cos(), (angle + opening).sin()]);
        let load = vec![share.0 * n[0] + share.1 * m[0], share.0 * n[1] + share.1 * m[1]];
        let conditions = vec![condition(n, bound, 0.0), condition(m, bound, 0.0)];
        let nodes = vec![ContactNode { first: 0, unknowns: 2, conditions }];
        let problem = Problem { stiffness: faer::Mat::identity(2, 2).into(), load, nodes };
        let answer = active_set(&problem, None).unwrap();
        for (found, pressure) in answer.multipliers.iter().zip([share.0, share.1]) {
            prop_assert!((found[0] - pressure).abs() < 1e-12 / opening.sin() && found[1].abs() < 1e-13, "{answer:?}");
        }
    }
}

/// Shears appear at a corner only as far as pressures cannot carry the load, and no smaller ones would do.
#[test]
fn a_corner_pulled_outwards_is_held_by_the_least_shears() {
    // normals +x and +y; a pull (-0.1, -0.2) needs shears -x = tangent of the second, -y = minus the tangent of the
    // first
    let nodes = vec![ContactNode {
        first: 0,
        unknowns: 2,
        conditions: vec![condition([1.0, 0.0], 0.3, 0.0), condition([0.0, 1.0], 0.3, 0.0)],
    }];
    let mut problem = Problem { stiffness: faer::Mat::identity(2, 2).into(), load: vec![-0.1, -0.2], nodes };
    let answer = active_set(&problem, None).unwrap();
    let expected = [[0.0, -0.2], [0.0, 0.1]];
    for (a, b) in answer.multipliers.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < 1e-15, "{answer:?}");
    }
    // normals at ±45° from y, pulled straight down with a force below 2 F cos 45°: both shears carry the same
    let d = 0.5f64.sqrt();
    problem.nodes[0].conditions = vec![condition([d, d], 0.3, 0.0), condition([-d, d], 0.3, 0.0)];
    problem.load = vec![0.0, -0.2];
    let answer = active_set(&problem, None).unwrap();
    assert!(kkt(&problem, &answer).worst() < 1e-14);
    let [a, b] = [answer.multipliers[0], answer.multipliers[1]];
    assert!((a[1] + b[1]).abs() < 1e-15 && (a[1].abs() - 0.2 * d).abs() < 1e-15, "{answer:?}");
    // beyond that it slides off
    problem.load = vec![0.0, -0.5];
    let answer = active_set(&problem, None).unwrap();
    assert!((answer.displacement[1] + 0.5 - 0.6 * d).abs() < 1e-15, "{answer:?}");
}

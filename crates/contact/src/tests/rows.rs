//! Rows of nodes on springs, which do not feel each other: what each node does is chosen by its load.

use faer::Mat;

use crate::{Condition, ContactLine, ContactNode, LinePoint, Outcome, Problem, Sets, Solution, Status};

/// Stiffness of every spring, and weight of every condition.
pub const SPRING: f64 = 3.0;
pub const WEIGHT: f64 = 0.5;

/// An edge with a node at each s, and the problem of these nodes.
#[derive(Debug, Clone)]
pub struct Row {
    pub line: ContactLine,
    pub problem: Problem,
}

impl Row {
    /// Nodes with the gap g and the friction bound F, without load.
    pub fn new(s: &[f64], gap: f64, bound: f64) -> Self {
        let condition = Condition {
            normal: [1.0, 0.0],
            tangent: [0.0, 1.0],
            normal_weight: WEIGHT,
            tangent_weight: WEIGHT,
            gap,
            slip_offset: 0.0,
            bound,
            coefficient: 0.0,
        };
        let node = |i| ContactNode { first: 2 * i, unknowns: 2, conditions: vec![condition.clone()] };
        let point = |(i, &s)| LinePoint { s, node: i, condition: 0, index: i };
        let m = 2 * s.len();
        Self {
            line: ContactLine { edge: 0, points: s.iter().enumerate().map(point).collect() },
            problem: Problem {
                stiffness: Mat::from_fn(m, m, |i, j| if i == j { SPRING } else { 0.0 }).into(),
                load: vec![0.0; m],
                nodes: (0..s.len()).map(node).collect(),
            },
        }
    }

    /// Loads under which node i opens by w(s_i) if it is open; with w < 0 it closes under λ_n = 6 |w|.
    pub fn opening(&mut self, w: impl Fn(f64) -> f64) {
        for (i, point) in self.line.points.iter().enumerate() {
            self.problem.load[2 * i] = SPRING * (self.problem.nodes[i].conditions[0].gap - w(point.s));
        }
    }

    /// Loads under which node i has u_t = turn w(s_i) if it slips in the direction `turn`.
    pub fn slip(&mut self, turn: f64, w: impl Fn(f64) -> f64) {
        for (i, point) in self.line.points.iter().enumerate() {
            let hold = WEIGHT * self.problem.nodes[i].conditions[0].bound;
            self.problem.load[2 * i + 1] = turn * (SPRING * w(point.s) + hold);
        }
    }

    /// The given states: closed or not, and stick (0) or slip.
    pub fn sets(&self, states: &[(bool, i8)]) -> Sets {
        let mut sets = Sets::new(&self.problem, &self.at_rest()).expect("of its own sizes");
        for (i, &(closed, slip)) in states.iter().enumerate() {
            sets.set_closed(i, closed);
            sets.set_slip(i, slip);
        }
        sets
    }

    /// No displacement, no multipliers.
    pub fn at_rest(&self) -> Solution {
        let nodes = self.problem.nodes.len();
        Solution {
            displacement: vec![0.0; 2 * nodes],
            multipliers: vec![[0.0; 2]; nodes],
            status: vec![Status::Stick; nodes],
            iterations: 0,
            outcome: Outcome::Converged,
            history: Vec::new(),
        }
    }
}

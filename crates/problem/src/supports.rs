//! Rigid motions that supports and springs leave free.

use steklov_bem_operators::Edge;
use steklov_elastic::{RigidMotion, free_motions};

use super::{Condition, Scene};

impl Scene {
    /// The rigid motions that held displacements and springs leave free, of one of several bodies or of all as one.
    pub fn free_of_supports(&self, body: Option<usize>) -> Vec<RigidMotion> {
        let mut constraints = Vec::new();
        let outline = &self.problem.outline;
        let own = |edge: &&Edge| body.is_none_or(|body| outline.body_of_loop(edge.loop_index) == body);
        let edges: Vec<&Edge> = outline.edges().iter().filter(own).collect();
        for edge in &edges {
            let side = &self.problem.sides[edge.side];
            if let Some(springs) = &side.springs {
                for (k, _) in springs.stiffnesses().iter().enumerate().filter(|(_, k)| k.constant() != Some(0.0)) {
                    let at = |s: f64| (edge.point(s), springs.directions(edge.normal(s))[k]);
                    constraints.extend([0.0, 0.5, 1.0].map(at));
                }
            }
            if let Condition::Displacement { values, .. } = &side.condition {
                for (value, direction) in values.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                    if value.is_some() {
                        constraints.extend([edge.start, edge.end].map(|x| (x, direction)));
                    }
                }
            }
        }
        let corners: Vec<[f64; 2]> = edges.iter().map(|e| e.start).collect();
        free_motions(&corners, &constraints)
    }
}

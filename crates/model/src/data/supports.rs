//! Held displacements: the motions that they leave free, and the forces that they carry.

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::{RigidMotion, free_motions};
use steklov_problem::Side;

/// A direction in which springs resist the displacement of a point.
pub type Resisted = ([f64; 2], [f64; 2]);

/// Prescribed components of one node: value and the first side that holds it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Held {
    /// One for x and one for y.
    pub components: [Option<(f64, usize)>; 2],
}

/// The held nodes of a space.
pub struct Supports<'a> {
    /// The nodes.
    pub space: &'a Space,
    /// The held components of each.
    pub held: &'a [Held],
}

impl Supports<'_> {
    /// Held unknowns and their values.
    pub fn dofs(&self) -> Vec<(usize, f64)> {
        let held = self.held.iter().enumerate();
        held.flat_map(|(node, h)| (0..2).filter_map(move |i| h.components[i].map(|(value, _)| (2 * node + i, value))))
            .collect()
    }

    /// The values alone.
    pub fn values(&self) -> Vec<f64> {
        self.dofs().into_iter().map(|(_, value)| value).collect()
    }

    /// Rigid motions left free by the supports and by the directions that springs resist.
    pub fn free_motions(&self, resisted: Vec<Resisted>) -> Vec<RigidMotion> {
        let mut constraints = resisted;
        for (node, held) in self.held.iter().enumerate() {
            for (component, direction) in held.components.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                if component.is_some() {
                    constraints.push((self.space.points[node], direction));
                }
            }
        }
        free_motions(&self.space.points, &constraints)
    }

    /// Whether an unknown is held.
    pub fn is_held(&self, dof: usize) -> bool {
        self.held[dof / 2].components[dof % 2].is_some()
    }

    /// Force of the supports on the body, side by side.
    pub fn reactions(
        &self,
        residual: &[f64],
        mesh: &Mesh,
        sides: &[Side],
        traction: impl Fn(usize, usize) -> [f64; 2],
    ) -> Vec<(usize, [f64; 2])> {
        let mut reactions = vec![[0.0; 2]; sides.len()];
        self.each_reaction(residual, mesh, sides, traction, |side, _, i, force| reactions[side][i] += force);
        let held = |side: usize| sides[side].holds(0) || sides[side].holds(1);
        reactions.into_iter().enumerate().filter(|&(side, _)| held(side)).collect()
    }

    /// Work of the forces of the supports on one side on a field w.
    pub(crate) fn work(
        &self,
        (residual, side): (&[f64], usize),
        (mesh, sides): (&Mesh, &[Side]),
        traction: impl Fn(usize, usize) -> [f64; 2],
        w: impl Fn([f64; 2]) -> [f64; 2],
    ) -> f64 {
        let mut work = 0.0;
        self.each_reaction(residual, mesh, sides, traction, |own, node, i, force| {
            if own == side {
                work += w(self.space.points[node])[i] * force;
            }
        });
        work
    }

    /// Calls `call` with the side, node, component and size of each force of the supports on the body: the residuals at held unknowns.
    /// Where two sides hold a component of a common node, each takes the moment of the traction on its own elements (`traction(e, j)`) and
    /// half of the rest.
    pub(crate) fn each_reaction(
        &self,
        residual: &[f64],
        mesh: &Mesh,
        sides: &[Side],
        traction: impl Fn(usize, usize) -> [f64; 2],
        mut call: impl FnMut(usize, usize, usize, f64),
    ) {
        let holds = |side: usize, component: usize| sides[side].holds(component);
        let previous = mesh.previous();
        for e in 0..mesh.len() {
            for j in 0..self.space.degree(e) {
                let node = self.space.node(e, j);
                for i in 0..2 {
                    let force = residual[2 * node + i];
                    let before = previous[e];
                    let (here, there) = (mesh.side[e], mesh.side[before]);
                    match (holds(here, i), j == 0 && here != there && holds(there, i)) {
                        (true, true) => {
                            let a = traction(e, 0)[i];
                            let b = traction(before, self.space.degree(before))[i];
                            let rest = (force - a - b) / 2.0;
                            call(here, node, i, a + rest);
                            call(there, node, i, b + rest);
                        }
                        (true, false) => call(here, node, i, force),
                        (false, true) => call(there, node, i, force),
                        (false, false) => {}
                    }
                }
            }
        }
    }
}

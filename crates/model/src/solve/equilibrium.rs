//! The residual of a solution in the equations S u = f + forces of supports and obstacles, for any kind of S.

use steklov_bem_operators::Mesh;
use steklov_problem::Scene;

use crate::data::joints::TiedNode;
use crate::data::supports::Supports;
use crate::solve::contact::ContactResult;

/// Relative residual of equilibrium beyond which an answer has lost too many digits.
pub(crate) const UNBALANCED: f64 = 1e-7;

/// Equations with their solution: unknowns 2·node + component.
pub(crate) struct Equations<'a> {
    /// S u (force per thickness).
    pub forces: &'a [f64],
    /// f.
    pub load: &'a [f64],
    /// u.
    pub displacement: &'a [f64],
    /// Largest entry of the diagonal of S.
    pub largest_diagonal: f64,
    /// Contact, if there is any.
    pub contact: Option<&'a ContactResult>,
    /// The nodes that are tied to other bodies, each before those that it faces.
    pub tied: &'a [TiedNode],
}

/// The residual of the equations.
pub(crate) struct Residual {
    /// S u - f with the forces of obstacles and of other bodies: at held unknowns the forces of supports, at tied ones those of ties.
    pub values: Vec<f64>,
    /// Largest one at an unknown that is not held, over max |S u| + max |f|.
    pub relative: f64,
    /// Whether that is as small as rounding allows. Without a load a body may move as a whole or not at all: forces of
    /// roundoff give no scale, the forces of moving by as much as it moves do.
    pub balanced: bool,
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

impl Equations<'_> {
    /// Whether nothing loads the body.
    pub fn is_unloaded(&self) -> bool {
        largest(self.load) == 0.0
    }

    /// The residual; `unknown` gives the unknown of an unknown of the boundary.
    pub fn residual(&self, unknown: impl Fn(usize) -> usize, is_held: impl Fn(usize) -> bool) -> Residual {
        let mut values: Vec<f64> = self.forces.iter().zip(self.load).map(|(s, f)| s - f).collect();
        match self.contact.map(|c| (c, &c.stabilised)) {
            Some((_, Some(s))) => values.iter_mut().zip(&s.forces).for_each(|(r, f)| *r += f),
            Some((c, None)) => {
                for (node, force) in c.boundary.nodal_forces(&c.solution.multipliers) {
                    (0..2).for_each(|i| values[unknown(2 * node + i)] += force[i]);
                }
            }
            None => {}
        }
        for tied in self.tied {
            let force = values[tied.dof];
            for &(node, c) in &tied.relative.faced {
                (0..2).for_each(|i| values[2 * node + i] += force * c[i]);
            }
        }
        let is_tied = |dof: usize| self.tied.iter().any(|tied| tied.dof == dof);
        let free = values.iter().enumerate().filter(|(dof, _)| !is_held(*dof) && !is_tied(*dof));
        let worst = free.fold(0.0, |m: f64, (_, r)| m.max(r.abs()));
        let scale = largest(self.forces) + largest(self.load);
        let gap = self.contact.map_or(0.0, |c| c.boundary.largest_gap());
        let moved = largest(self.displacement) + gap;
        let floor = if self.is_unloaded() { 1e-6 * self.largest_diagonal * moved } else { 0.0 };
        let over = |scale: f64| if scale > 0.0 { worst / scale } else { 0.0 };
        Residual { relative: over(scale), balanced: over(scale + floor) <= UNBALANCED, values }
    }
}

/// Force of the support, the springs or the obstacle on the body for each held, sprung or contacting side, in their order;
/// `residual` at the unknowns of the boundary. `traction(e, j)` parts the force of a corner between two supports: the moment of the traction on element e.
pub(crate) fn reactions(
    scene: &Scene,
    (supports, mesh): (&Supports<'_>, &Mesh),
    residual: &[f64],
    (contact, springs): (Option<&ContactResult>, Vec<(usize, [f64; 2])>),
    traction: impl Fn(usize, usize) -> [f64; 2],
) -> Vec<(String, [f64; 2])> {
    let mut reactions = supports.reactions(residual, mesh, &scene.problem.sides, traction);
    reactions.extend(springs);
    if let Some(c) = contact {
        reactions.extend(scene.contacts().map(|(side, _)| (side, c.force(side))));
    }
    reactions.sort_by_key(|r| r.0);
    reactions.into_iter().map(|(side, force)| (mesh.side_names[side].clone(), force)).collect()
}

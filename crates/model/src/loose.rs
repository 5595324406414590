//! Motions of several bodies that neither supports nor interfaces resist.

use faer::{Mat, Side};
use steklov_bem_operators::Relative;
use steklov_elastic::RigidMotion;

use crate::body::Given;
use crate::data::Data;
use crate::error::SolveError;
use crate::joints::TiedNode;
use crate::motions::nodal_work;
use crate::parts::Assembled;
use crate::supports::Supports;

/// Squared part of a constraint below which a motion does not meet it.
const RANK: f64 = 1e-13;
/// Part of the scale of the loads' work from which on loads drive a motion.
const DRIVEN: f64 = 1e-9;

impl Data<'_> {
    /// Nodal vectors of the motions that move bodies without a held displacement, a tie, an approach or, with friction, a slip
    /// of a contact; no load may do work on them.
    ///
    /// # Errors
    /// [`SolveError::Loose`].
    pub(crate) fn loose_motions(
        &self,
        bodies: &[Assembled],
        supports: &Supports<'_>,
        given: &Given,
        tied: &[TiedNode],
    ) -> Result<Vec<Vec<f64>>, SolveError> {
        let mut motions: Vec<(usize, RigidMotion)> = Vec::new();
        for (body, Assembled { piece, .. }) in bodies.iter().enumerate() {
            let centre = piece.space.points.iter().fold([0.0; 2], |sum, x| [sum[0] + x[0], sum[1] + x[1]]);
            let centre = centre.map(|sum| sum / piece.space.nodes() as f64);
            let size = piece.mesh.diameter() / 2.0;
            let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(RigidMotion::along);
            let all = vec![x, y, RigidMotion::about(centre, 1.0 / size)];
            motions.extend(self.scene.unresisted(body, all).into_iter().map(|motion| (body, motion)));
        }
        let body_of = |node: usize| bodies.iter().position(|b| b.piece.nodes.contains(&node)).unwrap_or(0);
        // d·(r - r') at a point, r' of the body that it faces: of exact motions, which nodal values on curves are not
        let constraint = |node: usize, d: [f64; 2], row: Option<&Relative>| -> Vec<f64> {
            let own = body_of(node);
            let faced = row.and_then(|row| row.faced.iter().map(|f| body_of(f.0)).find(|body| *body != own));
            let of = |(body, motion): &(usize, RigidMotion)| {
                let r = motion.at(self.space.points[node]);
                let sign = f64::from(*body == own) - f64::from(Some(*body) == faced);
                sign * (d[0] * r[0] + d[1] * r[1])
            };
            motions.iter().map(of).collect()
        };
        let axis = |dof: usize| if dof.is_multiple_of(2) { [1.0, 0.0] } else { [0.0, 1.0] };
        let mut constraints: Vec<Vec<f64>> =
            supports.dofs().iter().map(|(dof, _)| constraint(dof / 2, axis(*dof), None)).collect();
        constraints.extend(tied.iter().map(|tied| constraint(tied.dof / 2, axis(tied.dof), Some(&tied.relative))));
        if let Some(boundary) = &given.boundary {
            let mut first = 0;
            for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
                for (k, (condition, law)) in node.conditions.iter().zip(&contact.conditions).enumerate() {
                    let row = boundary.rows.iter().find(|row| row.condition == first + k).map(|row| &row.relative);
                    constraints.push(constraint(node.node, condition.normal, row));
                    if law.bound > 0.0 || law.coefficient > 0.0 {
                        constraints.push(constraint(node.node, condition.tangent, row));
                    }
                }
                first += node.conditions.len();
            }
        }
        let count = motions.len();
        let (free, rounding) = kernel(&constraints, count);
        let mut found = Vec::new();
        for parts in free {
            let mut nodal = vec![0.0; self.space.dofs()];
            for (part, (body, motion)) in parts.iter().zip(&motions) {
                let piece = &bodies[*body].piece;
                let own = &mut nodal[2 * piece.nodes.start..2 * piece.nodes.end];
                own.iter_mut().zip(motion.nodal(&piece.space.points)).for_each(|(a, b)| *a += part * b);
            }
            let (work, scale) = nodal_work(&given.load, &nodal);
            if work.abs() > DRIVEN * scale + rounding * largest_work(&given.load, &nodal) {
                let moves = |b: &usize| motions.iter().zip(&parts).any(|((body, _), v)| body == b && v.abs() > 1e-6);
                let names: Vec<&str> =
                    (0..bodies.len()).filter(moves).map(|b| self.scene.problem.bodies[b].name.as_str()).collect();
                return Err(SolveError::Loose { bodies: names.join(", "), work, scale });
            }
            found.push(nodal);
        }
        Ok(found)
    }
}

/// Orthonormal vectors of so many numbers that meet all constraints, and what rounding leaves in them of others.
fn kernel(constraints: &[Vec<f64>], count: usize) -> (Vec<Vec<f64>>, f64) {
    let gram = Mat::from_fn(count, count, |i, j| constraints.iter().map(|c| c[i] * c[j]).sum::<f64>());
    let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) else { return (Vec::new(), 0.0) };
    let values = eigen.S().column_vector();
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(*v));
    let (free, met): (Vec<usize>, Vec<usize>) = (0..count).partition(|&k| values[k] <= RANK * largest);
    let smallest = met.iter().fold(largest, |m: f64, &k| m.min(values[k]));
    let rounding = if largest > 0.0 { count as f64 * f64::EPSILON * largest / smallest } else { 0.0 };
    (free.into_iter().map(|k| (0..count).map(|i| eigen.U()[(i, k)]).collect()).collect(), rounding)
}

/// Σ |f| max |r|: the work of a load on a motion as large everywhere as it is somewhere.
fn largest_work(load: &[f64], motion: &[f64]) -> f64 {
    let size = |v: &[f64]| v[0].hypot(v[1]);
    let forces: f64 = load.chunks_exact(2).map(size).sum();
    forces * motion.chunks_exact(2).map(size).fold(0.0, f64::max)
}

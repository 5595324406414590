//! Rotations of bodies with curves, which the polynomials of curved elements are not.

use faer::Mat;
use rayon::prelude::*;
use steklov_algebra::dot;
use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::RigidMotion;

use crate::data::on_mesh::OnMesh;
use crate::data::parts::Assembled;
use crate::error::SolveError;
use crate::solve::body::Loading;

/// Part of a rigid motion that its nodal values miss between the nodes: 0 except for a rotation of a body with curves, whose
/// points are no polynomials of low degree.
pub(crate) fn missed(mesh: &Mesh, space: &Space, motions: &[RigidMotion]) -> f64 {
    if motions.iter().all(|motion| motion.rotation == 0.0) {
        return 0.0;
    }
    let mut worst: f64 = 0.0;
    for motion in motions {
        let nodal = motion.nodal(&space.points);
        let largest = nodal.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        for e in (0..mesh.len()).filter(|&e| !mesh.is_line(e)) {
            let basis = space.basis(e);
            let mut phi = vec![0.0; basis.degree + 1];
            for t in basis.nodes.windows(2).map(|t| (t[0] + t[1]) / 2.0) {
                basis.evaluate(t, &mut phi);
                let exact = motion.at(mesh.point(e, t));
                for (i, exact) in exact.into_iter().enumerate() {
                    let found: f64 =
                        space.element_nodes(e).zip(&phi).map(|(node, phi)| phi * nodal[2 * node + i]).sum();
                    worst = worst.max((found - exact).abs() / largest);
                }
            }
        }
    }
    worst
}

/// A space that follows rotations to rounding, where that of the mesh does not, and the nodal load (x, y) of it.
pub(crate) fn rigid_load(
    data: &OnMesh<'_>,
    given: &Loading,
    bodies: &[Assembled],
    missed: f64,
) -> Result<Option<(Space, Vec<f64>)>, SolveError> {
    if missed < NOTHING_MISSED {
        return Ok(None);
    }
    let degree = data.mesh.degree.iter().map(|p| *p.max(&ROTATIONS)).collect();
    let mesh = Mesh { degree, ..data.mesh.clone() };
    let space = Space::new(&mesh);
    let mut load = OnMesh { scene: data.scene, mesh: &mesh, space: &space }.load()?.nodal;
    for (body, particular) in bodies.iter().zip(&given.particular) {
        let Some(particular) = particular else { continue };
        // the rest of its load, S u_p, does no work on motions; nor do tractions on cuts, which are balanced
        let traction = particular.solution.traction_load_of(&mesh, &space, |e, _| body.piece.part.has(e));
        load.iter_mut().zip(traction).for_each(|(f, t)| *f -= t);
    }
    Ok(Some((space, load)))
}

/// Largest part of a rotation that may be missed.
const NOTHING_MISSED: f64 = 1e-12;
/// Degree that follows rotations on an arc of 180°.
const ROTATIONS: usize = 18;

/// PᵀSP, P = I - QQᵀ the projection off the span Q of the motions: the part of a rotation that nodal values miss on curves
/// must not resist it. It is S - QRᵀ - RQᵀ with R = SQ - ½ Q(QᵀSQ).
pub(crate) fn project_off(matrix: &mut Mat<f64>, motions: &[Vec<f64>]) {
    let basis = orthonormal(motions);
    let column = |j: usize| matrix.col(j).try_as_col_major().map_or(&[][..], |column| column.as_slice());
    let rows: Vec<Vec<f64>> =
        (0..matrix.ncols()).into_par_iter().map(|j| basis.iter().map(|q| dot(column(j), q)).collect()).collect();
    let mut resisted: Vec<Vec<f64>> = (0..basis.len()).map(|k| rows.iter().map(|row| row[k]).collect()).collect();
    let energies: Vec<Vec<f64>> = resisted.iter().map(|r| basis.iter().map(|q| dot(r, q)).collect()).collect();
    for (r, energies) in resisted.iter_mut().zip(&energies) {
        for (q, energy) in basis.iter().zip(energies) {
            r.iter_mut().zip(q).for_each(|(r, q)| *r -= 0.5 * energy * q);
        }
    }
    matrix.par_col_chunks_mut(1).enumerate().for_each(|(j, column)| {
        for (i, s) in column.col_mut(0).iter_mut().enumerate() {
            *s -= basis.iter().zip(&resisted).map(|(q, r)| q[i] * r[j] + r[i] * q[j]).sum::<f64>();
        }
    });
}

/// Removes the parts of a load that do work on the motions.
pub(crate) fn project_load_off(load: &mut [f64], motions: &[Vec<f64>]) {
    project_off_basis(load, &orthonormal(motions));
}

/// P v, P = I - QQᵀ with the columns of `basis`, which are orthonormal.
pub(crate) fn project_off_basis(v: &mut [f64], basis: &[Vec<f64>]) {
    for q in basis {
        let part: f64 = dot(v, q);
        v.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
    }
}

/// Both translations and the rotation of points about their mean, nodal vectors.
pub(crate) fn rigid_motions(points: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let sum = points.iter().fold([0.0; 2], |sum, x| [sum[0] + x[0], sum[1] + x[1]]);
    let centre = sum.map(|sum| sum / points.len() as f64);
    let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(RigidMotion::along);
    [x, y, RigidMotion::about(centre, 1.0)].map(|motion| motion.nodal(points)).to_vec()
}

/// An orthonormal basis of the span of motions.
pub(crate) fn orthonormal(motions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for motion in motions {
        let mut q = motion.clone();
        for _ in 0..2 {
            for b in &basis {
                let part: f64 = dot(&q, b);
                q.iter_mut().zip(b).for_each(|(q, b)| *q -= part * b);
            }
        }
        let norm = q.iter().map(|v| v * v).sum::<f64>().sqrt();
        basis.push(q.into_iter().map(|v| v / norm).collect());
    }
    basis
}

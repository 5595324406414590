//! Motions of several bodies that neither supports nor interfaces resist.
//!
//! Contact resists a motion r of a body by the change of the distance, d·r. A body whose sides in contact are arcs about one
//! centre has a rotation that maps these sides onto themselves, n·r = 0 with its own normals n: it changes no distance,
//! although d·r, of the normals of both bodies, may be small instead of nothing. Loads must not drive it either; a couple
//! holds it, as large as the work of pressures along d instead of n on it.

use faer::Mat;
use steklov_algebra::{dot, solve_full_lu, symmetric_eigen};
use steklov_bem_operators::{Mesh, Relative, Space};
use steklov_contact::ContactBoundary;
use steklov_elastic::{RigidMotion, plane};
use steklov_quadrature::{gauss_legendre, legendre_p};

use crate::data::joints::{Joint, TiedNode};
use crate::data::motions::{nodal_work, unresisted};
use crate::data::on_mesh::OnMesh;
use crate::data::parts::Assembled;
use crate::data::springs::Springs;
use crate::data::supports::{Held, Supports};
use crate::error::SolveError;
use crate::solve::body::Loading;
use crate::solve::rotations::{missed, project_load_off, rigid_load};

/// Squared part of a constraint below which a motion does not meet it.
const RANK: f64 = 1e-13;
/// Part of the scale of the loads' work from which on loads drive a motion.
const DRIVEN: f64 = 1e-9;
/// Sine of the angle between two motions below which they are one.
const SAME: f64 = 0.1;
/// Part of a motion beyond others below which it is one of them.
const EXACT: f64 = 1e-12;
/// Part of a motion below which it does not change a gap.
const GLIDING: f64 = 1e-9;
/// Part of a rotation that rounding leaves in other motions.
const ROUNDED: f64 = 1e-9;

/// Motions, nodal vectors, that nothing resists and no load drives.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loose {
    /// Those that change no distance along directions of contact.
    pub(crate) motions: Vec<Vec<f64>>,
    /// Those that map the sides in contact of a body onto themselves, with its number.
    pub(crate) rotations: Vec<(usize, Vec<f64>)>,
}

impl Loose {
    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.motions.len() + self.rotations.len()
    }

    /// Takes the motions that change no contact out of a nodal displacement: of all that they allow, the rest has the smallest
    /// ∮|u|² over the boundaries of all bodies, whatever the nodes and the cuts are. Rotations of bodies in sides that they map
    /// onto themselves stay.
    pub(crate) fn take_out(
        &self,
        displacement: &mut [f64],
        (mesh, space): (&Mesh, &Space),
        boundary: Option<&ContactBoundary>,
    ) {
        for Normalised { motion, on_nodes, .. } in self.normalised((mesh, space), boundary) {
            let part: f64 = on_nodes.iter().zip(&*displacement).map(|(m, u)| m * u).sum();
            displacement.iter_mut().zip(&motion).for_each(|(u, r)| *u -= part * r);
        }
    }

    /// The motions that change no contact, with ∮ r_j·r_k = δ_jk; nodes on cuts count for nothing.
    pub(crate) fn normalised(
        &self,
        (mesh, space): (&Mesh, &Space),
        boundary: Option<&ContactBoundary>,
    ) -> Vec<Normalised> {
        let product = |u: &[f64], v: &[f64]| u.iter().zip(v).map(|(u, v)| u * v).sum::<f64>();
        let mut found: Vec<Normalised> = Vec::new();
        for motion in self.motions.iter().filter(|r| glides(r, boundary)) {
            let mut motion = motion.clone();
            for before in &found {
                let part = product(&before.on_nodes, &motion);
                motion.iter_mut().zip(&before.motion).for_each(|(r, q)| *r -= part * q);
            }
            let norm = product(&weighted(&motion, mesh, space)[0], &motion).sqrt();
            motion.iter_mut().for_each(|r| *r /= norm);
            let [on_nodes, on_bubbles] = weighted(&motion, mesh, space);
            found.push(Normalised { motion, on_nodes, on_bubbles });
        }
        found
    }
}

/// A motion r that nothing resists.
pub(crate) struct Normalised {
    /// Its nodal values.
    pub(crate) motion: Vec<f64>,
    /// ∮ φ_j r and ∮ b_e r, two for each node and element: ∮ u·r of displacements.
    pub(crate) on_nodes: Vec<f64>,
    pub(crate) on_bubbles: Vec<f64>,
}

/// ∮ φ_j r of the nodal basis and ∮ b_e r of the bubbles b = (P_(p+1) - P_(p-1))/(2p+1).
fn weighted(motion: &[f64], mesh: &Mesh, space: &Space) -> [Vec<f64>; 2] {
    let (mut on_nodes, mut on_bubbles) = (vec![0.0; 2 * space.nodes()], vec![0.0; 2 * mesh.len()]);
    for e in 0..mesh.len() {
        let basis = space.basis(e);
        let p = basis.degree;
        let rule = gauss_legendre(p + if mesh.is_line(e) { 2 } else { 12 });
        let (mut phi, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
        for (&t, weight) in rule.points.iter().zip(&rule.weights) {
            basis.evaluate(t, &mut phi);
            legendre_p(t, &mut legendre);
            let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
            let ds = weight * mesh.speed(e, t);
            for i in 0..2 {
                let r: f64 = space.element_nodes(e).zip(&phi).map(|(node, phi)| phi * motion[2 * node + i]).sum();
                on_bubbles[2 * e + i] += ds * bubble * r;
                space.element_nodes(e).zip(&phi).for_each(|(node, phi)| on_nodes[2 * node + i] += ds * phi * r);
            }
        }
    }
    [on_nodes, on_bubbles]
}

/// Whether a motion, a nodal vector, changes no gap and slips nowhere against friction.
fn glides(motion: &[f64], boundary: Option<&ContactBoundary>) -> bool {
    let Some(boundary) = boundary else { return true };
    let relative = boundary.relative(motion);
    let largest = motion.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    boundary.nodes.iter().zip(&boundary.contact).all(|(node, condensed)| {
        let r = [relative[2 * node.node], relative[2 * node.node + 1]];
        let still = |direction| plane::dot(r, direction).abs() <= GLIDING * largest;
        let mut conditions = node.conditions.iter().zip(&condensed.conditions);
        conditions.all(|(plane, condition)| {
            let rubs = condition.bound > 0.0 || condition.coefficient > 0.0;
            still(plane.normal) && (!rubs || still(plane.tangent))
        })
    })
}

/// A rigid motion of a body.
type Motion = (usize, RigidMotion);

/// d·(r - r') of all motions, for every constraint.
#[derive(Default)]
struct Constraints {
    /// Along the directions of contact between bodies.
    touching: Vec<Vec<f64>>,
    /// Constraints of supports, springs, ties, friction and obstacles.
    firm: Vec<Vec<f64>>,
}

impl OnMesh<'_> {
    /// The motions that neither supports nor interfaces resist and no load may drive, as rigid motions of a single body and as
    /// nodal vectors. The part of the load on those that nodal values miss on curves is taken out of it.
    ///
    /// # Errors
    /// [`SolveError::Loose`], for a single body [`ContactError::Inconsistent`](steklov_contact::ContactError) or
    /// [`SolveError::Bem`]: loads drive a motion.
    pub(crate) fn unresisted_motions(
        &self,
        (bodies, points): (&[Assembled], &[[f64; 2]]),
        (joints, tied): (&[Joint], &[TiedNode]),
        (held, springs): (&[Held], &Springs),
        given: &mut Loading,
    ) -> Result<(Vec<RigidMotion>, Loose), SolveError> {
        let supports = Supports { space: self.space, held };
        if self.scene.problem.has_several_bodies() {
            self.turn_with_bodies(bodies, given)?;
            let loose = self.loose_motions(bodies, joints, (&supports, springs), given, tied)?;
            if bodies.iter().any(|body| !body.turning.is_empty()) {
                project_load_off(&mut given.load, &loose.motions);
            }
            for (body, rotation) in &loose.rotations {
                let part = &bodies[*body].piece.part;
                let mut own = part.own(&given.load);
                project_load_off(&mut own, std::slice::from_ref(rotation));
                part.set(&mut given.load, &own);
            }
            return Ok((Vec::new(), loose));
        }
        let candidates = self.scene.unresisted(0, supports.free_motions(springs.resisted(|_| true)));
        let missed = missed(self.mesh, self.space, &candidates);
        let free = match rigid_load(self, given, bodies, missed)? {
            None => unresisted(points, &given.load, given.boundary.as_ref(), &candidates)?,
            Some((space, load)) => unresisted(&space.points, &load, given.boundary.as_ref(), &candidates)?,
        };
        let motions: Vec<Vec<f64>> = free.iter().map(|motion| motion.nodal(points)).collect();
        if missed > 0.0 {
            project_load_off(&mut given.load, &motions);
        }
        Ok((free, Loose { motions, rotations: Vec::new() }))
    }

    /// Gives the loads of bodies that turn the work of the loads on their rotations, which nodal values are not on curves.
    fn turn_with_bodies(&self, bodies: &[Assembled], given: &mut Loading) -> Result<(), SolveError> {
        let of_body = |body: &Assembled| missed(&body.piece.part.mesh, &body.piece.part.space, &body.turning);
        let Some((space, exact)) = rigid_load(self, given, bodies, bodies.iter().map(of_body).fold(0.0, f64::max))?
        else {
            return Ok(());
        };
        let mut turning = vec![0.0; given.load.len()];
        for Assembled { piece, turning: free, .. } in bodies.iter().filter(|body| !body.turning.is_empty()) {
            let part = &piece.part;
            let motions: Vec<Vec<f64>> = free.iter().map(|motion| motion.nodal(&part.space.points)).collect();
            let own = part.own(&given.load);
            let nodes = || part.elements.iter().flat_map(|&e| space.offset[e]..space.offset[e + 1]);
            let work = |motion: &RigidMotion| -> f64 {
                nodes()
                    .map(|node| plane::dot([exact[2 * node], exact[2 * node + 1]], motion.at(space.points[node])))
                    .sum()
            };
            let lacked = Mat::from_fn(free.len(), 1, |k, _| work(&free[k]) - dot(&own, &motions[k]));
            let gram = Mat::from_fn(free.len(), free.len(), |i, j| dot(&motions[i], &motions[j]));
            let parts = solve_full_lu(gram.as_ref(), lacked.as_ref());
            let mut added = vec![0.0; own.len()];
            for (k, motion) in motions.iter().enumerate() {
                added.iter_mut().zip(motion).for_each(|(f, r)| *f += parts[(k, 0)] * r);
            }
            part.set(&mut turning, &added);
        }
        given.load.iter_mut().zip(&turning).for_each(|(f, added)| *f += added);
        given.loads.turning = turning;
        Ok(())
    }

    /// The motions that move bodies without a held displacement, a tie, an approach or, with friction, a slip
    /// of a contact; no load may do work on them.
    ///
    /// # Errors
    /// [`SolveError::Loose`].
    fn loose_motions(
        &self,
        bodies: &[Assembled],
        joints: &[Joint],
        (supports, springs): (&Supports<'_>, &Springs),
        given: &Loading,
        tied: &[TiedNode],
    ) -> Result<Loose, SolveError> {
        let motions = self.motions_of(bodies);
        let constraints = self.constraints(bodies, &motions, (supports, springs), given, tied);
        let all: Vec<Vec<f64>> = constraints.firm.iter().chain(&constraints.touching).cloned().collect();
        let (mut free, rounding) = kernel(&all, motions.len());
        let mut rotations = self.own_rotations(bodies, joints, &motions, &constraints.firm);
        // for circles about one centre they are among the others
        rotations.retain(|(_, parts)| beyond(&free, parts) > EXACT);
        for (_, parts) in &rotations {
            // directions of contact between circles turn a body about another centre than its own
            free.retain(|f| dot(f, parts).powi(2) < 1.0 - SAME * SAME);
        }
        let resisted = free.len();
        free.extend(rotations.iter().map(|(_, parts)| parts.clone()));
        let moved = |parts: &[f64]| {
            let mut nodal = vec![0.0; self.space.dofs()];
            for (part, (body, motion)) in parts.iter().zip(&motions) {
                for &node in &bodies[*body].piece.part.nodes {
                    let moved = motion.at(self.space.points[node]);
                    (0..2).for_each(|i| nodal[2 * node + i] += part * moved[i]);
                }
            }
            nodal
        };
        let mut nodal: Vec<Vec<f64>> = free.iter().map(|parts| moved(parts)).collect();
        for (parts, nodal) in free.iter().zip(&nodal) {
            let (work, scale) = nodal_work(&given.load, nodal);
            if work.abs() > DRIVEN * scale + rounding * largest_work(&given.load, nodal) {
                let moves = |b: &usize| motions.iter().zip(parts).any(|((body, _), v)| body == b && v.abs() > 1e-6);
                let names: Vec<&str> =
                    (0..bodies.len()).filter(moves).map(|b| self.scene.problem.bodies[b].name.as_str()).collect();
                return Err(SolveError::Loose { bodies: names.join(", "), work, scale });
            }
        }
        let own = nodal.split_off(resisted);
        let of_body =
            |((body, _), nodal): (&(usize, Vec<f64>), Vec<f64>)| (*body, bodies[*body].piece.part.own(&nodal));
        Ok(Loose { motions: nodal, rotations: rotations.iter().zip(own).map(of_body).collect() })
    }

    /// The motions of all bodies that media around them do not resist, as large as one at their boundaries.
    fn motions_of(&self, bodies: &[Assembled]) -> Vec<Motion> {
        let mut motions = Vec::new();
        for (body, Assembled { piece, .. }) in bodies.iter().enumerate() {
            let space = &piece.part.space;
            let centre = space.points.iter().fold([0.0; 2], |sum, x| [sum[0] + x[0], sum[1] + x[1]]);
            let centre = centre.map(|sum| sum / space.nodes() as f64);
            let size = piece.part.mesh.diameter() / 2.0;
            let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(RigidMotion::along);
            let all = vec![x, y, RigidMotion::about(centre, 1.0 / size)];
            motions.extend(self.scene.unresisted(body, all).into_iter().map(|motion| (body, motion)));
        }
        motions
    }

    /// The constraints of supports, ties and contact on motions.
    fn constraints(
        &self,
        bodies: &[Assembled],
        motions: &[Motion],
        (supports, springs): (&Supports<'_>, &Springs),
        given: &Loading,
        tied: &[TiedNode],
    ) -> Constraints {
        let body_of = |node: usize| bodies.iter().position(|b| b.piece.part.nodes.contains(&node)).unwrap_or(0);
        // d·(r - r') at a point, r' of the body that it faces: of exact motions, which nodal values on curves are not
        let constraint = |node: usize, d: [f64; 2], row: Option<&Relative>| -> Vec<f64> {
            let own = body_of(node);
            let faced = row.and_then(|row| row.faced.iter().map(|f| body_of(f.0)).find(|body| *body != own));
            let of = |(body, motion): &Motion| {
                let sign = f64::from(*body == own) - f64::from(Some(*body) == faced);
                sign * dot(&d, &motion.at(self.space.points[node]))
            };
            motions.iter().map(of).collect()
        };
        let axis = |dof: usize| if dof.is_multiple_of(2) { [1.0, 0.0] } else { [0.0, 1.0] };
        let mut found = Constraints::default();
        found.firm.extend(supports.dofs().iter().map(|(dof, _)| constraint(dof / 2, axis(*dof), None)));
        found.firm.extend(tied.iter().map(|tied| constraint(tied.dof / 2, axis(tied.dof), Some(&tied.relative))));
        for (body, Assembled { piece, .. }) in bodies.iter().enumerate() {
            let of = |x: [f64; 2], d: [f64; 2]| {
                let of_motion = |(of, motion): &Motion| if *of == body { dot(&d, &motion.at(x)) } else { 0.0 };
                motions.iter().map(of_motion).collect()
            };
            found.firm.extend(springs.resisted(|e| piece.part.has(e)).into_iter().map(|(x, d)| of(x, d)));
        }
        let Some(boundary) = &given.boundary else { return found };
        let mut first = 0;
        for (node, contact) in boundary.nodes.iter().zip(&boundary.contact) {
            for (k, (condition, law)) in node.conditions.iter().zip(&contact.conditions).enumerate() {
                let row = boundary.rows.iter().find(|row| row.condition == first + k).map(|row| &row.relative);
                let normal = constraint(node.node, condition.normal, row);
                if row.is_some() { &mut found.touching } else { &mut found.firm }.push(normal);
                if law.bound > 0.0 || law.coefficient > 0.0 {
                    found.firm.push(constraint(node.node, condition.tangent, row));
                }
            }
            first += node.conditions.len();
        }
        found
    }

    /// The rotations of bodies that map their sides in contact with others onto themselves and that nothing firm resists.
    fn own_rotations(
        &self,
        bodies: &[Assembled],
        joints: &[Joint],
        motions: &[Motion],
        firm: &[Vec<f64>],
    ) -> Vec<(usize, Vec<f64>)> {
        let touching: Vec<usize> = joints
            .iter()
            .filter(|joint| self.is_contact(joint))
            .flat_map(|joint| joint.own.iter().chain(&joint.other).copied())
            .collect();
        let mut found = Vec::new();
        for (body, Assembled { piece, .. }) in bodies.iter().enumerate() {
            let mut constraints = firm.to_vec();
            let of_body: Vec<usize> = touching.iter().copied().filter(|&e| piece.part.has(e)).collect();
            if of_body.is_empty() {
                continue;
            }
            for e in of_body {
                for t in [-1.0, 0.0, 1.0] {
                    let (x, n) = (self.mesh.point(e, t), self.mesh.normal(e, t));
                    constraints.push(motions.iter().map(|(_, motion)| dot(&n, &motion.at(x))).collect());
                }
            }
            let own: Vec<usize> = (0..motions.len()).filter(|&k| motions[k].0 == body).collect();
            constraints.iter_mut().for_each(|row| *row = own.iter().map(|&k| row[k]).collect());
            let turns = |parts: &Vec<f64>| {
                own.iter().zip(parts).any(|(&k, part)| motions[k].1.rotation != 0.0 && part.abs() > ROUNDED)
            };
            for parts in kernel(&constraints, own.len()).0.into_iter().filter(turns) {
                let mut whole = vec![0.0; motions.len()];
                own.iter().zip(parts).for_each(|(&k, part)| whole[k] = part);
                found.push((body, whole));
            }
        }
        found
    }
}

/// Orthonormal vectors of `count` numbers that meet all constraints, and the part of other vectors that rounding leaves in
/// them.
fn kernel(constraints: &[Vec<f64>], count: usize) -> (Vec<Vec<f64>>, f64) {
    let gram = Mat::from_fn(count, count, |i, j| constraints.iter().map(|c| c[i] * c[j]).sum::<f64>());
    let Ok(eigen) = symmetric_eigen(gram.as_ref()) else { return (Vec::new(), 0.0) };
    let values = &eigen.values;
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(*v));
    let (free, met): (Vec<usize>, Vec<usize>) = (0..count).partition(|&k| values[k] <= RANK * largest);
    let smallest = met.iter().fold(largest, |m: f64, &k| m.min(values[k]));
    let rounding = if largest > 0.0 { count as f64 * f64::EPSILON * largest / smallest } else { 0.0 };
    (free.into_iter().map(|k| (0..count).map(|i| eigen.vectors[(i, k)]).collect()).collect(), rounding)
}

/// The length of the part of a vector outside the span of orthonormal vectors.
fn beyond(others: &[Vec<f64>], vector: &[f64]) -> f64 {
    let mut left = vector.to_vec();
    for other in others {
        let part = dot(other, vector);
        left.iter_mut().zip(other).for_each(|(left, other)| *left -= part * other);
    }
    dot(&left, &left).sqrt()
}

/// Σ |f| max |r|: the work of a load on a motion as large everywhere as it is somewhere.
fn largest_work(load: &[f64], motion: &[f64]) -> f64 {
    let size = |v: &[f64]| v[0].hypot(v[1]);
    let forces: f64 = load.chunks_exact(2).map(size).sum();
    forces * motion.chunks_exact(2).map(size).fold(0.0, f64::max)
}

//! Bodies that are condensed one by one and then joined: the stiffness of several bodies for their relative displacements.
//!
//! Each body k has S_k and f_k on its own nodes. With w = d·u_i - Σ_j c_j·u_j for the nodes i and directions d that carry
//! multipliers, and U = T Z, Z the same unknowns with w in the place of d·u_i,
//!
//! ```text
//! S_z = Tᵀ (⊕ S_k) T      f_z = Tᵀ (⊕ f_k)
//! ```
//! w is kept where there is contact and held where bodies are tied; all else is eliminated. Elimination has two levels: first
//! all nodes of each body except those of interfaces, then the remaining skeleton of m unknowns. The kept unknowns obey the
//! laws of contact with an obstacle, with w for u. A single body has no skeleton.
//!
//! The parts may be subdomains of one body too, which have the nodes on the cuts between them in common: one displacement in
//! the skeleton and no multipliers,
//!
//! ```text
//! K U = F      K = Σ R_kᵀ S_k R_k      F = Σ R_kᵀ f_k
//! ```
//! The tractions on both sides of a cut are those of two subdomains: their sum vanishes only weakly.
//!
//! Many subdomains are joined two by two first, by fronts (`fronts.rs`): m are the unknowns that remain.
//!
//! Cost: Σ n_k³/3 + m³/3 and that of the fronts; 8 Σ n_k² + 8 m² bytes.
//!
//! Source: Hsiao, Steinbach and Wendland (2000) for subdomains with their Steklov-Poincaré operators.

use std::collections::BTreeMap;
use std::sync::Arc;

use faer::Mat;
use steklov_algebra::Symmetric;

use crate::condense::{Springs, add_springs};
use crate::skeleton::{Joined, Shared, Skeleton, nodes_of_skeleton};
use crate::space::Dof;
use crate::{BemError, Condensation, CondensedLoad, Partition};

/// The displacement of a node along a direction, relative to what it faces: w = `direction`·u - Σ `faced`·u_j.
#[derive(Debug, Clone, PartialEq)]
pub struct Relative {
    /// The node.
    pub node: usize,
    /// Unit direction d.
    pub direction: [f64; 2],
    /// Nodes j and c_j.
    pub faced: Vec<(usize, [f64; 2])>,
}

impl Relative {
    /// w of a nodal displacement (interleaved x, y).
    pub fn of(&self, displacement: &[f64]) -> f64 {
        let along = |node: usize, d: [f64; 2]| displacement[2 * node] * d[0] + displacement[2 * node + 1] * d[1];
        self.faced.iter().fold(along(self.node, self.direction), |w, &(j, c)| w - along(j, c))
    }
}

/// A nodal displacement with w in the place of u along the directions of `rows`.
pub fn relative_displacement<'a>(rows: impl IntoIterator<Item = &'a Relative>, displacement: &[f64]) -> Vec<f64> {
    let mut relative = displacement.to_vec();
    for row in rows {
        let u: f64 = (0..2).map(|i| row.direction[i] * displacement[2 * row.node + i]).sum();
        let change = row.of(displacement) - u;
        (0..2).for_each(|i| relative[2 * row.node + i] += change * row.direction[i]);
    }
    relative
}

/// Bodies without the unknowns that are eliminated.
#[derive(Debug, Clone)]
pub struct Assembly {
    bodies: Vec<Member>,
    /// The factor of S_k of each body.
    moduli: Vec<f64>,
    skeleton: Option<Skeleton>,
    /// Number of all unknowns.
    size: usize,
    /// Where held values go, in the order in which they are given.
    held: Vec<Holder>,
    /// Springs that hold the rotations of bodies which touch only along arcs about one centre, with the number of the body.
    springs: Vec<(usize, Springs)>,
}

/// A body.
#[derive(Debug, Clone)]
struct Member {
    /// The number of each of its nodes among all.
    nodes: Vec<usize>,
    /// Which of them are in the skeleton, and their numbers there.
    in_skeleton: Vec<(usize, usize)>,
    condensation: Arc<Condensation>,
}

impl Member {
    /// Its part of a nodal vector.
    fn own(&self, nodal: &[f64]) -> Vec<f64> {
        self.nodes.iter().flat_map(|&node| [nodal[2 * node], nodal[2 * node + 1]]).collect()
    }

    /// Adds its part to a nodal vector.
    fn add_to(&self, nodal: &mut [f64], own: &[f64]) {
        for (&node, own) in self.nodes.iter().zip(own.chunks_exact(2)) {
            (0..2).for_each(|i| nodal[2 * node + i] += own[i]);
        }
    }

    /// The unknowns of the skeleton that it has.
    fn of_skeleton(&self) -> impl Iterator<Item = Dof> + '_ {
        self.in_skeleton.iter().flat_map(|&(_, number)| [2 * number, 2 * number + 1])
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Holder {
    Body(usize),
    Skeleton,
}

/// A load reduced to what is kept.
#[derive(Debug, Clone)]
pub struct AssembledLoad {
    /// The load on the kept unknowns.
    pub kept: Vec<f64>,
    bodies: Vec<CondensedLoad>,
    skeleton: Vec<CondensedLoad>,
}

impl Assembly {
    /// Joins bodies, each given by the number of its S_k among `matrices`, which equal bodies share, and by the numbers of its
    /// nodes among all: nodes that several of them have are one. `partition` and `motions` refer to all nodes, the partition to Z:
    /// for a node with rows it keeps or holds w. `rotations` are nodal vectors of single bodies that rows need not leave free:
    /// springs hold them as couples, [`Assembly::spring_forces`].
    ///
    /// # Errors
    /// [`BemError::StiffnessSingular`] when bodies can move although the kept unknowns do not; [`BemError::Cycle`].
    ///
    /// # Panics
    /// If the nodes of a single body are not in their order.
    pub fn new(
        matrices: Vec<Mat<f64>>,
        of_bodies: &[(usize, Vec<usize>)],
        partition: &Partition,
        rows: &[Relative],
        motions: &[Vec<f64>],
        rotations: &[(usize, Vec<f64>)],
    ) -> Result<Self, BemError> {
        Self::joined(matrices, of_bodies, partition, rows, motions, rotations, false)
    }

    /// Joins the subdomains of one body that is held, and keeps all unknowns that several of them share too, behind those of the
    /// partition: S_c is a sum of blocks.
    ///
    /// *Use when* many unknowns are kept, spread over the subdomains. *Cost*: Σ n_k³/3, and memory for the blocks alone.
    ///
    /// # Errors
    /// As [`Assembly::new`].
    ///
    /// # Panics
    /// As [`Assembly::new`].
    pub fn of_blocks(
        matrices: Vec<Mat<f64>>,
        of_bodies: &[(usize, Vec<usize>)],
        partition: &Partition,
    ) -> Result<Self, BemError> {
        Self::joined(matrices, of_bodies, partition, &[], &[], &[], true)
    }

    fn joined(
        mut matrices: Vec<Mat<f64>>,
        of_bodies: &[(usize, Vec<usize>)],
        partition: &Partition,
        rows: &[Relative],
        motions: &[Vec<f64>],
        rotations: &[(usize, Vec<f64>)],
        keeps_shared: bool,
    ) -> Result<Self, BemError> {
        let size = 2 * of_bodies.iter().flat_map(|(_, nodes)| nodes).max().map_or(0, |last| last + 1);
        if of_bodies.len() == 1 && rows.is_empty() {
            let nodes = of_bodies[0].1.clone();
            assert!(nodes.iter().copied().eq(0..size / 2), "the nodes of one body are in their order");
            let held = vec![Holder::Body(0); partition.held.len()];
            let condensation = Arc::new(Condensation::new(matrices.remove(0), partition, motions)?);
            let body = Member { nodes, in_skeleton: Vec::new(), condensation };
            return Ok(Self { bodies: vec![body], moduli: vec![1.0], skeleton: None, size, held, springs: Vec::new() });
        }
        let nodes = nodes_of_skeleton(of_bodies.iter().map(|(_, nodes)| nodes), partition, rows);
        let mut held = vec![Holder::Skeleton; partition.held.len()];
        let number_of_held: BTreeMap<Dof, usize> = partition.held.iter().map(|held| held.0).zip(0..).collect();
        let (mut bodies, mut springs, mut stiffness) = (Vec::new(), Vec::new(), Vec::new());
        let mut condensing = Condensing::new(matrices, of_bodies.iter().map(|(matrix, _)| *matrix));
        for (k, (matrix, own)) in of_bodies.iter().enumerate() {
            let in_skeleton = places(own, &nodes);
            let (of_body, held_here) = partition_of(own, &in_skeleton, &number_of_held, partition);
            held_here.into_iter().for_each(|h| held[h] = Holder::Body(k));
            // a body without interfaces has springs of its own
            let part = |motion: &Vec<f64>| own.iter().flat_map(|&n| [motion[2 * n], motion[2 * n + 1]]).collect();
            let mut alone: Vec<Vec<f64>> =
                if in_skeleton.is_empty() { motions.iter().map(part).collect() } else { Vec::new() };
            alone.retain(|motion| motion.iter().any(|v| *v != 0.0));
            let of_rotations = rotations.iter().filter(|(body, _)| *body == k).map(|(_, motion)| without_mean(motion));
            let of_rotations: Vec<Vec<f64>> = of_rotations.collect();
            let (condensation, own_springs) = condensing.condense(*matrix, of_body, &alone, &of_rotations)?;
            springs.extend(own_springs.into_iter().map(|spring| (k, spring)));
            let numbers: Vec<usize> = in_skeleton.iter().map(|&(_, number)| number).collect();
            let here = Shared { nodes: numbers, stiffness: condensation.stiffness };
            stiffness.push((!here.nodes.is_empty()).then_some(here));
            bodies.push(Member { nodes: own.clone(), in_skeleton, condensation: condensation.of });
        }
        let number = |node: usize| nodes.binary_search(&node).expect("a node of the skeleton");
        let numbered = |row: &Relative| Relative {
            node: number(row.node),
            direction: row.direction,
            faced: row.faced.iter().map(|&(node, c)| (number(node), c)).collect(),
        };
        let rows: Vec<Relative> = order_of_rows(rows)?.into_iter().map(|k| numbered(&rows[k])).collect();
        let of_skeleton = held.iter().zip(&partition.held).filter(|(holder, _)| **holder == Holder::Skeleton);
        let of_skeleton = Partition {
            kept: partition.kept.iter().map(|dof| 2 * number(dof / 2) + dof % 2).collect(),
            held: of_skeleton.map(|(_, &(dof, value))| (2 * number(dof / 2) + dof % 2, value)).collect(),
            frames: partition.frames.iter().map(|&(node, frame)| (number(node), frame)).collect(),
        };
        let motions = motions.iter().map(|motion| {
            let u: Vec<f64> = nodes.iter().flat_map(|node| [motion[2 * node], motion[2 * node + 1]]).collect();
            relative_displacement(&rows, &u)
        });
        let motions: Vec<Vec<f64>> = motions.filter(|motion| motion.iter().any(|v| *v != 0.0)).collect();
        let moduli = vec![1.0; bodies.len()];
        let joined = Joined { nodes, rows, stiffness, partition: of_skeleton, motions, keeps_shared };
        let skeleton = Some(Arc::new(joined).skeleton(&moduli)?);
        Ok(Self { bodies, moduli, skeleton, size, held, springs })
    }

    /// The same bodies, each S_k of those that were joined times a factor: other Young's moduli.
    ///
    /// Cost: m³/3 of the skeleton; no body is condensed again.
    ///
    /// # Errors
    /// [`BemError::StiffnessSingular`], [`BemError::Fault`].
    ///
    /// # Panics
    /// When there are fewer or more factors than bodies.
    pub fn with_moduli(&self, moduli: &[f64]) -> Result<Self, BemError> {
        assert_eq!(moduli.len(), self.bodies.len(), "factors of bodies");
        let skeleton = self.skeleton.as_ref().map(|skeleton| skeleton.joined.clone().skeleton(moduli)).transpose()?;
        Ok(Self { moduli: moduli.to_vec(), skeleton, ..self.clone() })
    }

    /// S_c of the kept unknowns: in full storage, but a sum of blocks from [`Assembly::of_blocks`].
    ///
    /// # Errors
    /// [`BemError::Fault`].
    pub fn stiffness(&self) -> Result<Symmetric, BemError> {
        match &self.skeleton {
            None => Ok((self.bodies[0].condensation.stiffness()? * faer::Scale(self.moduli[0])).into()),
            Some(skeleton) => skeleton.stiffness(),
        }
    }

    /// Reduces a nodal load (interleaved x, y, all nodes) and the forces of held values, in the order of [`Partition::held`].
    ///
    /// # Panics
    /// When there are fewer or more of them.
    pub fn load_held(&self, load: &[f64], held: &[f64]) -> AssembledLoad {
        assert_eq!(held.len(), self.held.len(), "values of held unknowns");
        let values = |of: Holder| -> Vec<f64> {
            self.held.iter().zip(held).filter(|(holder, _)| **holder == of).map(|(_, value)| *value).collect()
        };
        let part = |(k, body): (usize, &Member)| {
            let modulus = self.moduli[k];
            let mut load = body.own(load);
            load.iter_mut().for_each(|f| *f /= modulus);
            // loads at the nodes of the skeleton act once, whichever bodies have them
            if self.skeleton.is_some() {
                body.in_skeleton.iter().for_each(|(local, _)| load[2 * local..2 * local + 2].fill(0.0));
            }
            let mut condensed = body.condensation.load_held(&load, &values(Holder::Body(k)));
            condensed.kept.iter_mut().for_each(|f| *f *= modulus);
            condensed
        };
        let bodies: Vec<CondensedLoad> = self.bodies.iter().enumerate().map(part).collect();
        let Some(skeleton) = &self.skeleton else {
            return AssembledLoad { kept: bodies[0].kept.clone(), bodies, skeleton: Vec::new() };
        };
        let mut f: Vec<f64> =
            skeleton.joined.nodes.iter().flat_map(|&node| [load[2 * node], load[2 * node + 1]]).collect();
        for (body, condensed) in self.bodies.iter().zip(&bodies) {
            body.of_skeleton().zip(&condensed.kept).for_each(|(dof, kept)| f[dof] += kept);
        }
        let (kept, skeleton) = skeleton.load(f, &values(Holder::Skeleton));
        AssembledLoad { kept, bodies, skeleton }
    }

    /// Reduces the nodal load of a correction: all held values are 0.
    pub fn load_of_correction(&self, load: &[f64]) -> AssembledLoad {
        self.load_held(load, &vec![0.0; self.held.len()])
    }

    /// Nodal displacement (interleaved x, y, all nodes) from the kept values, in equilibrium with the load at the eliminated
    /// unknowns.
    pub fn expand(&self, load: &AssembledLoad, kept: &[f64]) -> Vec<f64> {
        let Some(skeleton) = &self.skeleton else {
            return self.bodies[0].condensation.expand(&load.bodies[0], kept);
        };
        let u = skeleton.expand(&load.skeleton, kept);
        let mut all = vec![0.0; self.size];
        for (body, load) in self.bodies.iter().zip(&load.bodies) {
            let kept: Vec<f64> = body.of_skeleton().map(|dof| u[dof]).collect();
            let own = body.condensation.expand(load, &kept);
            for (&node, own) in body.nodes.iter().zip(own.chunks_exact(2)) {
                all[2 * node..2 * node + 2].copy_from_slice(own);
            }
        }
        all
    }

    /// Largest diagonal entry of all S_k.
    pub fn largest_diagonal(&self) -> f64 {
        let of = |(body, modulus): (&Member, &f64)| modulus * body.condensation.largest_diagonal();
        self.bodies.iter().zip(&self.moduli).map(of).fold(0.0, f64::max)
    }

    /// Σ S_k u of the bodies from a nodal displacement (both interleaved x, y).
    pub fn multiply(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.size];
        for (k, body) in self.bodies.iter().enumerate() {
            body.add_to(&mut forces, &self.multiply_body(k, &body.own(displacement)));
        }
        if !self.springs.is_empty() {
            forces.iter_mut().zip(self.spring_forces(displacement)).for_each(|(f, spring)| *f += spring);
        }
        forces
    }

    /// S_k u of a body from the displacement of its own nodes.
    pub fn multiply_body(&self, k: usize, own: &[f64]) -> Vec<f64> {
        let mut forces = self.bodies[k].condensation.multiply(own);
        forces.iter_mut().for_each(|f| *f *= self.moduli[k]);
        forces
    }

    /// The nodal forces of the springs that hold rotations: couples, as large as the work of the rows on the rotations.
    pub fn spring_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; displacement.len()];
        for (k, springs) in &self.springs {
            let body = &self.bodies[*k];
            let of_body: Vec<f64> =
                springs.forces(&body.own(displacement)).into_iter().map(|f| self.moduli[*k] * f).collect();
            body.add_to(&mut forces, &of_body);
        }
        forces
    }
}

/// Which nodes of a body are in the skeleton, and their numbers there.
fn places(own: &[usize], skeleton: &[usize]) -> Vec<(usize, usize)> {
    own.iter().enumerate().filter_map(|(local, node)| Some((local, skeleton.binary_search(node).ok()?))).collect()
}

/// The partition of a body that keeps its nodes of the skeleton, and the numbers of what it holds.
fn partition_of(
    own: &[usize],
    in_skeleton: &[(usize, usize)],
    number_of_held: &BTreeMap<Dof, usize>,
    partition: &Partition,
) -> (Partition, Vec<usize>) {
    let mut held: Vec<(usize, Dof)> = Vec::new();
    for (local, node) in own.iter().enumerate() {
        if in_skeleton.binary_search_by_key(&local, |(local, _)| *local).is_err() {
            (0..2).for_each(|i| held.extend(number_of_held.get(&(2 * node + i)).map(|&h| (h, 2 * local + i))));
        }
    }
    held.sort_unstable();
    let of_body = Partition {
        kept: in_skeleton.iter().flat_map(|(local, _)| [2 * local, 2 * local + 1]).collect(),
        held: held.iter().map(|&(h, dof)| (dof, partition.held[h].1)).collect(),
        frames: Vec::new(),
    };
    (of_body, held.into_iter().map(|(h, _)| h).collect())
}

/// The matrices of bodies, and those that are condensed: equal bodies share them.
struct Condensing {
    matrices: Vec<Mat<f64>>,
    /// Number of bodies that are yet to have each of them.
    uses: Vec<usize>,
    /// The number of the matrix, its partition, and the result.
    done: Vec<(usize, Partition, Condensed)>,
}

/// A condensed matrix.
#[derive(Clone)]
struct Condensed {
    of: Arc<Condensation>,
    /// S_c of what is kept.
    stiffness: Arc<Mat<f64>>,
}

impl Condensing {
    fn new(matrices: Vec<Mat<f64>>, of_bodies: impl Iterator<Item = usize>) -> Self {
        let mut uses = vec![0; matrices.len()];
        of_bodies.for_each(|matrix| uses[matrix] += 1);
        Self { matrices, uses, done: Vec::new() }
    }

    /// A condensed matrix, with springs that hold motions, and those that hold rotations as couples.
    fn condense(
        &mut self,
        matrix: usize,
        partition: Partition,
        motions: &[Vec<f64>],
        rotations: &[Vec<f64>],
    ) -> Result<(Condensed, Vec<Springs>), BemError> {
        let has_springs = !motions.is_empty() || !rotations.is_empty();
        let is_same = |(of, other, _): &&(usize, Partition, Condensed)| *of == matrix && *other == partition;
        self.uses[matrix] -= 1;
        if let Some((_, _, condensed)) = self.done.iter().find(is_same).filter(|_| !has_springs) {
            return Ok((condensed.clone(), Vec::new()));
        }
        let mut own = match self.uses[matrix] {
            0 => std::mem::replace(&mut self.matrices[matrix], Mat::new()),
            _ => self.matrices[matrix].clone(),
        };
        let springs =
            rotations.iter().map(|rotation| add_springs(own.as_mut(), std::slice::from_ref(rotation))).collect();
        let of = Arc::new(Condensation::new(own, &partition, motions)?);
        let stiffness = Arc::new(if partition.kept.is_empty() { Mat::new() } else { of.stiffness()? });
        let condensed = Condensed { of, stiffness };
        if !has_springs {
            self.done.push((matrix, partition, condensed.clone()));
        }
        Ok((condensed, springs))
    }
}

/// A nodal vector without its resultant.
fn without_mean(nodal: &[f64]) -> Vec<f64> {
    let nodes = (nodal.len() / 2) as f64;
    let mean = [0, 1].map(|i| nodal.iter().skip(i).step_by(2).sum::<f64>() / nodes);
    nodal.iter().enumerate().map(|(dof, v)| v - mean[dof % 2]).collect()
}

/// Numbers of rows in an order in which each comes before those of nodes that it faces.
///
/// # Errors
/// [`BemError::Cycle`].
pub fn order_of_rows(rows: &[Relative]) -> Result<Vec<usize>, BemError> {
    let mut left: Vec<usize> = (0..rows.len()).collect();
    let mut order = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let mut faced: Vec<usize> = left.iter().flat_map(|&k| rows[k].faced.iter().map(|f| f.0)).collect();
        faced.sort_unstable();
        let (ready, later): (Vec<usize>, Vec<usize>) =
            left.into_iter().partition(|&k| faced.binary_search(&rows[k].node).is_err());
        if ready.is_empty() {
            return Err(BemError::Cycle { rows: later.len() });
        }
        order.extend(ready);
        left = later;
    }
    Ok(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A positive definite matrix.
    fn matrix(nodes: usize, seed: f64, factor: f64) -> Mat<f64> {
        let n = 2 * nodes;
        let a = Mat::from_fn(n, n, |i, j| (seed + 12.9 * i as f64 + 78.2 * j as f64).sin());
        (a.transpose() * &a + Mat::<f64>::identity(n, n)) * faer::Scale(factor)
    }

    /// Two bodies of 6 and 5 nodes; nodes 2, 3 of the first face nodes 6, 7 of the second, one in contact, one tied.
    fn joined(factors: [f64; 2]) -> Assembly {
        let row = |node: usize, direction: [f64; 2], faced: usize| Relative {
            node,
            direction,
            faced: vec![(faced, direction.map(|d| 0.7 * d)), (faced + 1, direction.map(|d| 0.3 * d))],
        };
        let rows = [row(2, [1.0, 0.0], 6), row(3, [1.0, 0.0], 7), row(3, [0.0, 1.0], 7)];
        let partition = Partition { kept: vec![4], held: vec![(0, 0.1), (6, 0.0), (7, 0.02)], frames: Vec::new() };
        let matrices = vec![matrix(6, 1.0, factors[0]), matrix(5, 2.0, factors[1])];
        let of_bodies = [(0, (0..6).collect()), (1, (6..11).collect())];
        Assembly::new(matrices, &of_bodies, &partition, &rows, &[], &[]).expect("positive matrices")
    }

    /// With moduli an assembly is that of the matrices times them, and no body is condensed again.
    #[test]
    fn moduli_scale_the_matrices_of_bodies() {
        let factors = [3.5, 0.02];
        let (of_one, exact) = (joined([1.0; 2]), joined(factors));
        let scaled = of_one.with_moduli(&factors).expect("positive matrices");
        let same = |(a, b): (&Member, &Member)| Arc::ptr_eq(&a.condensation, &b.condensation);
        assert!(of_one.bodies.iter().zip(&scaled.bodies).all(same));
        let close = |a: &[f64], b: &[f64]| {
            let size = b.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * size)
        };
        let load: Vec<f64> = (0..22).map(|k| (1.3 * f64::from(k)).sin()).collect();
        let solve = |assembly: &Assembly| {
            let reduced = assembly.load_held(&load, &[0.1, 0.0, 0.02]);
            let stiffness = assembly.stiffness().expect("no fault");
            let kept = [reduced.kept[0] / stiffness[(0, 0)]];
            (stiffness[(0, 0)], reduced.kept.clone(), assembly.expand(&reduced, &kept))
        };
        let ((s, f, u), (s_exact, f_exact, u_exact)) = (solve(&scaled), solve(&exact));
        assert!((s / s_exact - 1.0).abs() < 1e-12 && close(&f, &f_exact) && close(&u, &u_exact), "{s} {s_exact}");
        assert!(close(&scaled.multiply(&u), &exact.multiply(&u)));
        assert!((scaled.largest_diagonal() / exact.largest_diagonal() - 1.0).abs() < 1e-14);
        // from other moduli as from those of 1
        let again = scaled.with_moduli(&[1.0; 2]).expect("positive matrices");
        assert!(close(&solve(&again).2, &solve(&of_one).2));
        // the same equations hold with the moduli
        let rest: Vec<f64> = scaled.multiply(&u).iter().zip(&load).map(|(s, f)| s - f).collect();
        let free = [2, 3, 8, 9, 10, 11, 18, 19, 20, 21];
        assert!(free.iter().all(|&dof| rest[dof].abs() < 1e-11), "{rest:?}");
    }
}

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
//! The bodies may be subdomains of one body, cut along lines on which both sides have the same elements. The nodes of both
//! sides are then one ([`shared_nodes`]), with one displacement in the skeleton and no multipliers:
//!
//! ```text
//! K U = F      K = Σ R_kᵀ S_k R_k      F = Σ R_kᵀ f_k
//! ```
//! The tractions on both sides of a cut are those of two bodies: their sum vanishes only weakly.
//!
//! Cost: Σ n_k³/3 + m³/3; 8 Σ n_k² + 8 m² bytes.
//!
//! Source: Hsiao, Steinbach and Wendland (2000) for subdomains with their Steklov-Poincaré operators.

use std::collections::BTreeMap;
use std::sync::Arc;

use faer::Mat;

use crate::condense::{Springs, add_springs};
use crate::space::Dof;
use crate::{BemError, Condensation, CondensedLoad, Partition, Space};

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
    /// Each body, and the number of its first node.
    bodies: Vec<(usize, Arc<Condensation>)>,
    /// The factor of S_k of each body.
    moduli: Vec<f64>,
    skeleton: Option<Skeleton>,
    /// Where held values go, in the order in which they are given.
    held: Vec<Holder>,
    /// Springs that hold the rotations of bodies which touch only along arcs about one centre, with the number of the body.
    springs: Vec<(usize, Springs)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Holder {
    Body(usize),
    Skeleton,
    /// A shared node that is held already.
    Before,
}

/// The held unknowns of the skeleton; those that are held a second time are marked so.
fn held_by_skeleton(holders: &mut [Holder], held: &[(Dof, f64)], number: impl Fn(usize) -> usize) -> Vec<(Dof, f64)> {
    let mut of_skeleton: Vec<(Dof, f64)> = Vec::new();
    for (holder, &(dof, value)) in holders.iter_mut().zip(held).filter(|(holder, _)| **holder == Holder::Skeleton) {
        let dof = 2 * number(dof / 2) + dof % 2;
        match of_skeleton.iter().any(|(other, _)| *other == dof) {
            true => *holder = Holder::Before,
            false => of_skeleton.push((dof, value)),
        }
    }
    of_skeleton
}

/// The unknowns of several bodies that remain when each body is condensed.
#[derive(Debug, Clone)]
struct Skeleton {
    condensation: Condensation,
    joined: Arc<Joined>,
}

/// The data from which a skeleton is condensed, whatever the moduli of the bodies.
#[derive(Debug)]
struct Joined {
    /// The nodes of the bodies that it has, rising.
    nodes: Vec<usize>,
    /// The number of each of them in the skeleton; shared nodes have one.
    number: Vec<usize>,
    /// How many numbers there are.
    count: usize,
    /// The rows, numbered by the nodes of the skeleton, each before those of nodes that it faces.
    rows: Vec<Relative>,
    /// The first of `nodes` that each body has, and its condensed S_k; none of a body without.
    stiffness: Vec<Option<(usize, Mat<f64>)>>,
    partition: Partition,
    /// Motions that springs hold.
    motions: Vec<Vec<f64>>,
}

impl Joined {
    /// The skeleton of bodies whose S_k have these factors.
    fn skeleton(self: Arc<Self>, moduli: &[f64]) -> Result<Skeleton, BemError> {
        let size = 2 * self.count;
        let mut stiffness = Mat::zeros(size, size);
        for ((at, own), modulus) in self.stiffness.iter().zip(moduli).filter_map(|(own, m)| Some((own.as_ref()?, m))) {
            let dofs: Vec<Dof> = (0..own.nrows()).map(|i| self.dof(2 * at + i)).collect();
            for (j, &column) in dofs.iter().enumerate() {
                dofs.iter().enumerate().for_each(|(i, &row)| stiffness[(row, column)] += modulus * own[(i, j)]);
            }
        }
        self.rows.iter().for_each(|row| substitute(&mut stiffness, row));
        Ok(Skeleton { condensation: Condensation::new(stiffness, &self.partition, &self.motions)?, joined: self })
    }

    /// The unknown of the skeleton of an unknown of the nodes of the bodies.
    fn dof(&self, k: Dof) -> Dof {
        2 * self.number[k / 2] + k % 2
    }

    /// A nodal vector of the skeleton: the sum of those of the bodies at each node.
    fn gather(&self, of_bodies: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut sum = vec![0.0; 2 * self.count];
        of_bodies.into_iter().enumerate().for_each(|(k, f)| sum[self.dof(k)] += f);
        sum
    }

    /// The values of a nodal vector of the skeleton at the nodes of the bodies.
    fn scatter(&self, of_skeleton: &[f64]) -> Vec<f64> {
        (0..2 * self.nodes.len()).map(|k| of_skeleton[self.dof(k)]).collect()
    }
}

/// The nodes that subdomains share, for pairs of elements that run along each other in opposite directions and have one degree.
///
/// # Panics
/// If the elements of a pair have different degrees.
pub fn shared_nodes(space: &Space, twins: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let of = |&[e, f]: &[usize; 2]| {
        let p = space.degree(e);
        assert_eq!(p, space.degree(f), "degrees of the elements {e} and {f} on both sides of a cut");
        (0..=p).map(move |j| [space.node(e, j), space.node(f, p - j)])
    };
    twins.iter().flat_map(of).collect()
}

/// The smallest of the nodes that are one with each node, by pairs that are one.
fn representatives(pairs: &[[usize; 2]]) -> BTreeMap<usize, usize> {
    let mut parent: BTreeMap<usize, usize> = BTreeMap::new();
    let root = |parent: &BTreeMap<usize, usize>, node: usize| {
        let mut at = node;
        while let Some(&up) = parent.get(&at).filter(|&&up| up != at) {
            at = up;
        }
        at
    };
    for pair in pairs {
        let [a, b] = pair.map(|node| root(&parent, node));
        parent.insert(a.max(b), a.min(b));
        parent.entry(a.min(b)).or_insert(a.min(b));
        pair.iter().for_each(|&node| {
            parent.insert(node, a.min(b));
        });
    }
    parent.keys().map(|&node| (node, root(&parent, node))).collect()
}

/// A load reduced to what is kept.
#[derive(Debug, Clone)]
pub struct AssembledLoad {
    /// The load on the kept unknowns.
    pub kept: Vec<f64>,
    bodies: Vec<CondensedLoad>,
    skeleton: Option<CondensedLoad>,
}

impl Assembly {
    /// Joins bodies, whose nodes follow one another, each given by its S_k. `partition` and `motions` refer to all nodes, the
    /// partition to Z: for a node with rows it keeps or holds w. `shared` are pairs of nodes that are one, neither kept nor
    /// with rows; one that is held holds the others. `rotations` are nodal vectors of single bodies that rows need not leave
    /// free: springs hold them as couples, [`Assembly::spring_forces`].
    ///
    /// # Errors
    /// [`BemError::StiffnessSingular`] when bodies can move although the kept unknowns do not; [`BemError::Cycle`].
    ///
    /// # Panics
    /// If a shared node is kept or has rows.
    pub fn new(
        mut matrices: Vec<Mat<f64>>,
        partition: &Partition,
        rows: &[Relative],
        shared: &[[usize; 2]],
        motions: &[Vec<f64>],
        rotations: &[(usize, Vec<f64>)],
    ) -> Result<Self, BemError> {
        if matrices.len() == 1 && rows.is_empty() {
            let held = vec![Holder::Body(0); partition.held.len()];
            let body = Arc::new(Condensation::new(matrices.remove(0), partition, motions)?);
            return Ok(Self { bodies: vec![(0, body)], moduli: vec![1.0], skeleton: None, held, springs: Vec::new() });
        }
        let mut nodes: Vec<usize> =
            rows.iter().flat_map(|row| row.faced.iter().map(|f| f.0).chain([row.node])).collect();
        nodes.extend(partition.kept.iter().map(|dof| dof / 2));
        let same = representatives(shared);
        assert!(nodes.iter().all(|node| !same.contains_key(node)), "a shared node is kept or has a row");
        nodes.extend(same.keys());
        nodes.sort_unstable();
        nodes.dedup();
        let first_of = |node: usize| same.get(&node).copied().unwrap_or(node);
        let mut firsts: Vec<usize> = nodes.iter().map(|&node| first_of(node)).collect();
        firsts.sort_unstable();
        firsts.dedup();
        let number = |node: usize| firsts.binary_search(&first_of(node)).expect("a node of the skeleton");
        let mut held = vec![Holder::Skeleton; partition.held.len()];
        let (mut bodies, mut first, mut springs) = (Vec::new(), 0, Vec::new());
        let mut stiffness = Vec::new();
        let mut alone: Vec<Vec<f64>> = Vec::new();
        for (k, mut matrix) in matrices.into_iter().enumerate() {
            let count = matrix.nrows() / 2;
            let own = first..first + count;
            let of_skeleton: Vec<usize> = nodes.iter().copied().filter(|node| own.contains(node)).collect();
            let local = |dof: Dof| dof - 2 * first;
            let mut of_body = Partition {
                kept: of_skeleton.iter().flat_map(|node| [local(2 * node), local(2 * node + 1)]).collect(),
                ..Partition::default()
            };
            for (holder, &(dof, value)) in held.iter_mut().zip(&partition.held) {
                if own.contains(&(dof / 2)) && nodes.binary_search(&(dof / 2)).is_err() {
                    *holder = Holder::Body(k);
                    of_body.held.push((local(dof), value));
                }
            }
            // a body without interfaces has springs of its own
            if of_skeleton.is_empty() {
                alone = motions.iter().map(|motion| motion[2 * own.start..2 * own.end].to_vec()).collect();
                alone.retain(|motion| motion.iter().any(|v| *v != 0.0));
            }
            let springs_alone = if of_skeleton.is_empty() { alone.as_slice() } else { &[] };
            for (_, rotation) in rotations.iter().filter(|(body, _)| *body == k) {
                springs.push((k, add_springs(matrix.as_mut(), &[without_mean(rotation)])));
            }
            let body = Condensation::new(matrix, &of_body, springs_alone)?;
            let at = of_skeleton.first().and_then(|node| nodes.binary_search(node).ok());
            stiffness.push(at.map(|at| Ok::<_, BemError>((at, body.stiffness()?))).transpose()?);
            bodies.push((first, Arc::new(body)));
            first += count;
        }
        let numbered = |row: &Relative| Relative {
            node: number(row.node),
            direction: row.direction,
            faced: row.faced.iter().map(|&(node, c)| (number(node), c)).collect(),
        };
        let rows: Vec<Relative> = order_of_rows(rows)?.into_iter().map(|k| numbered(&rows[k])).collect();
        let of_skeleton = Partition {
            kept: partition.kept.iter().map(|dof| 2 * number(dof / 2) + dof % 2).collect(),
            held: held_by_skeleton(&mut held, &partition.held, number),
            frames: partition.frames.iter().map(|&(node, frame)| (number(node), frame)).collect(),
        };
        let motions = motions.iter().map(|motion| {
            let u: Vec<f64> = firsts.iter().flat_map(|node| [motion[2 * node], motion[2 * node + 1]]).collect();
            relative_displacement(&rows, &u)
        });
        let motions: Vec<Vec<f64>> = motions.filter(|motion| motion.iter().any(|v| *v != 0.0)).collect();
        let moduli = vec![1.0; bodies.len()];
        let (number, count) = (nodes.iter().map(|&node| number(node)).collect(), firsts.len());
        let joined = Joined { nodes, number, count, rows, stiffness, partition: of_skeleton, motions };
        let skeleton = Arc::new(joined).skeleton(&moduli)?;
        Ok(Self { bodies, moduli, skeleton: Some(skeleton), held, springs })
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
        let (bodies, held, springs) = (self.bodies.clone(), self.held.clone(), self.springs.clone());
        Ok(Self { bodies, moduli: moduli.to_vec(), skeleton, held, springs })
    }

    /// S_c of the kept unknowns, full storage.
    ///
    /// # Errors
    /// [`BemError::Fault`].
    pub fn stiffness(&self) -> Result<Mat<f64>, BemError> {
        match &self.skeleton {
            None => Ok(self.bodies[0].1.stiffness()? * faer::Scale(self.moduli[0])),
            Some(skeleton) => skeleton.condensation.stiffness(),
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
        let part = |(k, (first, body)): (usize, &(usize, Arc<Condensation>))| {
            let modulus = self.moduli[k];
            let load: Vec<f64> = load[2 * first..2 * first + body.size()].iter().map(|f| f / modulus).collect();
            let mut condensed = body.load_held(&load, &values(Holder::Body(k)));
            condensed.kept.iter_mut().for_each(|f| *f *= modulus);
            condensed
        };
        let bodies: Vec<CondensedLoad> = self.bodies.iter().enumerate().map(part).collect();
        let Some(skeleton) = &self.skeleton else {
            return AssembledLoad { kept: bodies[0].kept.clone(), bodies, skeleton: None };
        };
        let mut f = skeleton.joined.gather(bodies.iter().flat_map(|body| body.kept.iter().copied()));
        for row in &skeleton.joined.rows {
            let along: f64 = (0..2).map(|i| row.direction[i] * f[2 * row.node + i]).sum();
            row.faced.iter().for_each(|&(j, c)| (0..2).for_each(|i| f[2 * j + i] += along * c[i]));
        }
        let load = skeleton.condensation.load_held(&f, &values(Holder::Skeleton));
        AssembledLoad { kept: load.kept.clone(), bodies, skeleton: Some(load) }
    }

    /// Reduces the nodal load of a correction: all held values are 0.
    pub fn load_of_correction(&self, load: &[f64]) -> AssembledLoad {
        self.load_held(load, &vec![0.0; self.held.len()])
    }

    /// Nodal displacement (interleaved x, y, all nodes) from the kept values, in equilibrium with the load at the eliminated
    /// unknowns.
    pub fn expand(&self, load: &AssembledLoad, kept: &[f64]) -> Vec<f64> {
        let Some((skeleton, of_skeleton)) = self.skeleton.as_ref().zip(load.skeleton.as_ref()) else {
            return self.bodies[0].1.expand(&load.bodies[0], kept);
        };
        let mut u = skeleton.condensation.expand(of_skeleton, kept);
        for row in skeleton.joined.rows.iter().rev() {
            let faced: f64 = row.faced.iter().map(|&(j, c)| c[0] * u[2 * j] + c[1] * u[2 * j + 1]).sum();
            (0..2).for_each(|i| u[2 * row.node + i] += faced * row.direction[i]);
        }
        let u = skeleton.joined.scatter(&u);
        let mut at = 0;
        let part = |((_, body), load): (&(usize, Arc<Condensation>), &CondensedLoad)| {
            let own = at..at + load.kept.len();
            at = own.end;
            body.expand(load, &u[own])
        };
        self.bodies.iter().zip(&load.bodies).flat_map(part).collect()
    }

    /// The nodes of interfaces; empty for a single body.
    pub fn interface_nodes(&self) -> &[usize] {
        self.skeleton.as_ref().map_or(&[], |skeleton| &skeleton.joined.nodes)
    }

    /// Largest diagonal entry of all S_k.
    pub fn largest_diagonal(&self) -> f64 {
        let own = self.bodies.iter().zip(&self.moduli).map(|((_, body), modulus)| modulus * body.largest_diagonal());
        own.fold(0.0, f64::max)
    }

    /// S_k u of every body from a nodal displacement of all bodies (both interleaved x, y).
    pub fn multiply(&self, displacement: &[f64]) -> Vec<f64> {
        let part = |((first, body), modulus): (&(usize, Arc<Condensation>), &f64)| {
            let mut forces = body.multiply(&displacement[2 * first..2 * first + body.size()]);
            forces.iter_mut().for_each(|f| *f *= modulus);
            forces
        };
        let mut forces: Vec<f64> = self.bodies.iter().zip(&self.moduli).flat_map(part).collect();
        if !self.springs.is_empty() {
            forces.iter_mut().zip(self.spring_forces(displacement)).for_each(|(f, spring)| *f += spring);
        }
        forces
    }

    /// The nodal forces of the springs that hold rotations: couples, as large as the work of the rows on the rotations.
    pub fn spring_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; displacement.len()];
        for (k, springs) in &self.springs {
            let (first, modulus) = (self.bodies[*k].0, self.moduli[*k]);
            let own = 2 * first..2 * first + springs.size();
            let of_body = springs.forces(&displacement[own.clone()]);
            forces[own].iter_mut().zip(of_body).for_each(|(f, spring)| *f += modulus * spring);
        }
        forces
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

/// d·u = w + Σ c_j·u_j in a stiffness matrix, from both sides.
fn substitute(stiffness: &mut Mat<f64>, Relative { node, direction, faced }: &Relative) {
    let size = stiffness.nrows();
    let along: Vec<f64> = (0..size)
        .map(|row| direction[0] * stiffness[(row, 2 * node)] + direction[1] * stiffness[(row, 2 * node + 1)])
        .collect();
    for &(j, c) in faced {
        for i in 0..2 {
            (0..size).for_each(|row| stiffness[(row, 2 * j + i)] += c[i] * along[row]);
        }
    }
    let along: Vec<f64> = (0..size)
        .map(|column| direction[0] * stiffness[(2 * node, column)] + direction[1] * stiffness[(2 * node + 1, column)])
        .collect();
    for &(j, c) in faced {
        for i in 0..2 {
            (0..size).for_each(|column| stiffness[(2 * j + i, column)] += c[i] * along[column]);
        }
    }
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
        Assembly::new(matrices, &partition, &rows, &[], &[], &[]).expect("positive matrices")
    }

    /// With moduli an assembly is that of the matrices times them, and no body is condensed again.
    #[test]
    fn moduli_scale_the_matrices_of_bodies() {
        let factors = [3.5, 0.02];
        let (of_one, exact) = (joined([1.0; 2]), joined(factors));
        let scaled = of_one.with_moduli(&factors).expect("positive matrices");
        assert!(of_one.bodies.iter().zip(&scaled.bodies).all(|(a, b)| Arc::ptr_eq(&a.1, &b.1)));
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

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
//! Cost: Σ n_k³/3 + m³/3; 8 Σ n_k² + 8 m² bytes.

use faer::Mat;

use crate::condense::{Springs, add_springs};
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
    /// Each body, and the number of its first node.
    bodies: Vec<(usize, Condensation)>,
    skeleton: Option<Skeleton>,
    /// Where held values go, in the order in which they are given.
    held: Vec<Holder>,
    /// Springs that hold the rotations of bodies which touch only along arcs about one centre.
    springs: Vec<(usize, Springs)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Holder {
    Body(usize),
    Skeleton,
}

/// The unknowns of several bodies that remain when each body is condensed.
#[derive(Debug, Clone)]
struct Skeleton {
    condensation: Condensation,
    /// Its nodes, rising.
    nodes: Vec<usize>,
    /// The rows, numbered by the nodes of the skeleton, each before those of nodes that it faces.
    rows: Vec<Relative>,
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
    /// partition to Z: for a node with rows it keeps or holds w. `rotations` are nodal vectors of single bodies that rows need
    /// not leave free: springs hold them as couples, [`Assembly::spring_forces`].
    ///
    /// # Errors
    /// [`BemError::StiffnessSingular`] when bodies can move although the kept unknowns do not; [`BemError::Cycle`].
    pub fn new(
        mut matrices: Vec<Mat<f64>>,
        partition: &Partition,
        rows: &[Relative],
        motions: &[Vec<f64>],
        rotations: &[(usize, Vec<f64>)],
    ) -> Result<Self, BemError> {
        if matrices.len() == 1 && rows.is_empty() {
            let held = vec![Holder::Body(0); partition.held.len()];
            let body = Condensation::new(matrices.remove(0), partition, motions)?;
            return Ok(Self { bodies: vec![(0, body)], skeleton: None, held, springs: Vec::new() });
        }
        let mut nodes: Vec<usize> =
            rows.iter().flat_map(|row| row.faced.iter().map(|f| f.0).chain([row.node])).collect();
        nodes.extend(partition.kept.iter().map(|dof| dof / 2));
        nodes.sort_unstable();
        nodes.dedup();
        let mut held = vec![Holder::Skeleton; partition.held.len()];
        let (mut bodies, mut first, mut springs) = (Vec::new(), 0, Vec::new());
        let mut stiffness = Mat::zeros(2 * nodes.len(), 2 * nodes.len());
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
                springs.push((first, add_springs(matrix.as_mut(), &[without_mean(rotation)])));
            }
            let body = Condensation::new(matrix, &of_body, springs_alone)?;
            if let Some(node) = of_skeleton.first() {
                let at = 2 * nodes.binary_search(node).unwrap_or(0);
                let n = 2 * of_skeleton.len();
                stiffness.as_mut().submatrix_mut(at, at, n, n).copy_from(&body.stiffness()?);
            }
            bodies.push((first, body));
            first += count;
        }
        let number = |node: usize| nodes.binary_search(&node).expect("a node of the skeleton");
        let numbered = |row: &Relative| Relative {
            node: number(row.node),
            direction: row.direction,
            faced: row.faced.iter().map(|&(node, c)| (number(node), c)).collect(),
        };
        let rows: Vec<Relative> = order_of_rows(rows)?.into_iter().map(|k| numbered(&rows[k])).collect();
        rows.iter().for_each(|row| substitute(&mut stiffness, row));
        let of_skeleton = Partition {
            kept: partition.kept.iter().map(|dof| 2 * number(dof / 2) + dof % 2).collect(),
            held: held
                .iter()
                .zip(&partition.held)
                .filter(|(holder, _)| **holder == Holder::Skeleton)
                .map(|(_, &(dof, value))| (2 * number(dof / 2) + dof % 2, value))
                .collect(),
            frames: partition.frames.iter().map(|&(node, frame)| (number(node), frame)).collect(),
        };
        let motions = motions.iter().map(|motion| {
            let u: Vec<f64> = nodes.iter().flat_map(|node| [motion[2 * node], motion[2 * node + 1]]).collect();
            relative_displacement(&rows, &u)
        });
        let motions: Vec<Vec<f64>> = motions.filter(|motion| motion.iter().any(|v| *v != 0.0)).collect();
        let condensation = Condensation::new(stiffness, &of_skeleton, &motions)?;
        Ok(Self { bodies, skeleton: Some(Skeleton { condensation, nodes, rows }), held, springs })
    }

    /// S_c of the kept unknowns, full storage.
    ///
    /// # Errors
    /// [`BemError::Fault`].
    pub fn stiffness(&self) -> Result<Mat<f64>, BemError> {
        match &self.skeleton {
            None => self.bodies[0].1.stiffness(),
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
        let part = |(k, (first, body)): (usize, &(usize, Condensation))| {
            body.load_held(&load[2 * first..2 * first + body.size()], &values(Holder::Body(k)))
        };
        let bodies: Vec<CondensedLoad> = self.bodies.iter().enumerate().map(part).collect();
        let Some(skeleton) = &self.skeleton else {
            return AssembledLoad { kept: bodies[0].kept.clone(), bodies, skeleton: None };
        };
        let mut f: Vec<f64> = bodies.iter().flat_map(|body| body.kept.iter().copied()).collect();
        for row in &skeleton.rows {
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
        for row in skeleton.rows.iter().rev() {
            let faced: f64 = row.faced.iter().map(|&(j, c)| c[0] * u[2 * j] + c[1] * u[2 * j + 1]).sum();
            (0..2).for_each(|i| u[2 * row.node + i] += faced * row.direction[i]);
        }
        let mut at = 0;
        let part = |((_, body), load): (&(usize, Condensation), &CondensedLoad)| {
            let own = at..at + load.kept.len();
            at = own.end;
            body.expand(load, &u[own])
        };
        self.bodies.iter().zip(&load.bodies).flat_map(part).collect()
    }

    /// The nodes of interfaces; empty for a single body.
    pub fn interface_nodes(&self) -> &[usize] {
        self.skeleton.as_ref().map_or(&[], |skeleton| &skeleton.nodes)
    }

    /// Largest diagonal entry of all S_k.
    pub fn largest_diagonal(&self) -> f64 {
        self.bodies.iter().fold(0.0, |m: f64, (_, body)| m.max(body.largest_diagonal()))
    }

    /// S_k u of every body from a nodal displacement of all bodies (both interleaved x, y).
    pub fn multiply(&self, displacement: &[f64]) -> Vec<f64> {
        let part =
            |(first, body): &(usize, Condensation)| body.multiply(&displacement[2 * first..2 * first + body.size()]);
        let mut forces: Vec<f64> = self.bodies.iter().flat_map(part).collect();
        if !self.springs.is_empty() {
            forces.iter_mut().zip(self.spring_forces(displacement)).for_each(|(f, spring)| *f += spring);
        }
        forces
    }

    /// The nodal forces of the springs that hold rotations: couples, as large as the work of the rows on the rotations.
    pub fn spring_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; displacement.len()];
        for (first, springs) in &self.springs {
            let own = 2 * first..2 * first + springs.size();
            forces[own.clone()].iter_mut().zip(springs.forces(&displacement[own])).for_each(|(f, spring)| *f += spring);
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

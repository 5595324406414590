//! The unknowns that several bodies or subdomains share, joined from their condensed matrices.

use std::sync::Arc;

use faer::Mat;

use crate::assembly::Relative;
use crate::fronts::{Front, Group, dissect};
use crate::space::Dof;
use crate::{BemError, Condensation, Partition};

/// The unknowns of several bodies that remain when each body is condensed.
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    /// Those that are eliminated first.
    pub(crate) fronts: Vec<Front>,
    /// The nodes that are left, among those of the skeleton.
    pub(crate) nodes: Vec<usize>,
    pub(crate) condensation: Condensation,
    pub(crate) joined: Arc<Joined>,
}

/// The nodes that a body has in the skeleton, and its condensed S_k, which equal bodies share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) nodes: Vec<usize>,
    pub(crate) stiffness: Arc<Mat<f64>>,
}

/// The data from which a skeleton is condensed, whatever the moduli of the bodies.
#[derive(Debug)]
pub(crate) struct Joined {
    /// Its nodes, rising.
    pub(crate) nodes: Vec<usize>,
    /// The rows, numbered by the nodes of the skeleton, each before those of nodes that it faces.
    pub(crate) rows: Vec<Relative>,
    /// The nodes that each body has here with its condensed S_k; none of bodies that have no nodes here.
    pub(crate) stiffness: Vec<Option<Shared>>,
    pub(crate) partition: Partition,
    /// Motions that springs hold.
    pub(crate) motions: Vec<Vec<f64>>,
}

impl Joined {
    /// The skeleton of bodies whose S_k have these factors.
    pub(crate) fn skeleton(self: Arc<Self>, moduli: &[f64]) -> Result<Skeleton, BemError> {
        let protected = self.protected();
        let groups = self.stiffness.iter().zip(moduli).filter_map(|(group, &modulus)| {
            let Shared { nodes, stiffness } = group.as_ref()?;
            Some(Group { nodes: nodes.clone(), stiffness: &**stiffness * faer::Scale(modulus) })
        });
        let (fronts, groups) = dissect(groups.collect(), &|node| protected[node])?;
        let mut nodes: Vec<usize> = groups.iter().flat_map(|group| group.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut stiffness = Mat::zeros(2 * nodes.len(), 2 * nodes.len());
        groups.iter().for_each(|group| group.add_to(&mut stiffness, &nodes));
        let place = |node: usize| nodes.binary_search(&node).expect("a node that is left");
        let dof = |dof: Dof| 2 * place(dof / 2) + dof % 2;
        for Relative { node, direction, faced } in &self.rows {
            let faced = faced.iter().map(|&(j, c)| (place(j), c)).collect();
            substitute(&mut stiffness, &Relative { node: place(*node), direction: *direction, faced });
        }
        let partition = Partition {
            kept: self.partition.kept.iter().map(|&of| dof(of)).collect(),
            held: self.partition.held.iter().map(|&(of, value)| (dof(of), value)).collect(),
            frames: self.partition.frames.iter().map(|&(node, frame)| (place(node), frame)).collect(),
        };
        let own = |motion: &Vec<f64>| nodes.iter().flat_map(|k| [motion[2 * k], motion[2 * k + 1]]).collect();
        let motions: Vec<Vec<f64>> = self.motions.iter().map(own).collect();
        let condensation = Condensation::new(stiffness, &partition, &motions)?;
        Ok(Skeleton { fronts, nodes, condensation, joined: self })
    }

    /// Whether each node has a row, is faced, kept or held, or has a frame.
    fn protected(&self) -> Vec<bool> {
        let Partition { kept, held, frames } = &self.partition;
        let mut protected = vec![false; self.nodes.len()];
        let of_rows = self.rows.iter().flat_map(|row| row.faced.iter().map(|f| f.0).chain([row.node]));
        let of_partition = kept.iter().copied().chain(held.iter().map(|held| held.0)).map(|dof| dof / 2);
        of_rows.chain(of_partition).chain(frames.iter().map(|frame| frame.0)).for_each(|node| protected[node] = true);
        protected
    }
}

/// The nodes that interfaces have, or several bodies, and those that are kept; rising.
pub(crate) fn nodes_of_skeleton<'a>(
    nodes_of: impl Iterator<Item = &'a Vec<usize>>,
    partition: &Partition,
    rows: &[Relative],
) -> Vec<usize> {
    let mut all: Vec<usize> = nodes_of.flatten().copied().collect();
    all.sort_unstable();
    let shared = all.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
    let of_rows = rows.iter().flat_map(|row| row.faced.iter().map(|f| f.0).chain([row.node]));
    let mut nodes: Vec<usize> = shared.chain(of_rows).chain(partition.kept.iter().map(|dof| dof / 2)).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
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

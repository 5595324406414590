//! The unknowns that several bodies or subdomains share, joined from their condensed matrices.

use std::sync::Arc;

use faer::Mat;
use steklov_algebra::Symmetric;

use crate::assembly::Relative;
use crate::blocks::Blocks;
use crate::fronts::{Front, Group, dissect};
use crate::space::Dof;
use crate::{BemError, Condensation, CondensedLoad, Partition};

/// The unknowns of several bodies that remain when each body is condensed.
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    form: Form,
    pub(crate) joined: Arc<Joined>,
}

/// What is done to the unknowns of a skeleton.
#[derive(Debug, Clone)]
enum Form {
    /// All are eliminated that are not kept.
    Condensed {
        /// Those that are eliminated first.
        fronts: Vec<Front>,
        /// The nodes that are left, among those of the skeleton.
        nodes: Vec<usize>,
        condensation: Box<Condensation>,
    },
    /// What several bodies share is kept too.
    Blocks(Blocks),
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
    /// Whether what several bodies share is kept, behind what the partition keeps; then there are no rows and no motions.
    pub(crate) keeps_shared: bool,
}

impl Joined {
    /// The skeleton of bodies whose S_k have these factors.
    pub(crate) fn skeleton(self: Arc<Self>, moduli: &[f64]) -> Result<Skeleton, BemError> {
        if self.keeps_shared {
            let form = Form::Blocks(Blocks::new(&self, moduli)?);
            return Ok(Skeleton { form, joined: self });
        }
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
        let condensation = Box::new(Condensation::new(stiffness, &partition, &motions)?);
        Ok(Skeleton { form: Form::Condensed { fronts, nodes, condensation }, joined: self })
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

impl Skeleton {
    /// S_c of what is kept.
    pub(crate) fn stiffness(&self) -> Result<Symmetric, BemError> {
        match &self.form {
            Form::Condensed { condensation, .. } => Ok(condensation.stiffness()?.into()),
            Form::Blocks(blocks) => blocks.stiffness(),
        }
    }

    /// Reduces a nodal load on the skeleton, and the forces of held values: the load on what is kept, and what
    /// [`Skeleton::expand`] needs.
    pub(crate) fn load(&self, mut f: Vec<f64>, held: &[f64]) -> (Vec<f64>, Vec<CondensedLoad>) {
        let (fronts, nodes, condensation) = match &self.form {
            Form::Blocks(blocks) => return blocks.load(&f, held),
            Form::Condensed { fronts, nodes, condensation } => (fronts, nodes, condensation),
        };
        let mut loads: Vec<CondensedLoad> = fronts.iter().map(|front| front.load(&mut f)).collect();
        for row in &self.joined.rows {
            let along: f64 = (0..2).map(|i| row.direction[i] * f[2 * row.node + i]).sum();
            row.faced.iter().for_each(|&(j, c)| (0..2).for_each(|i| f[2 * j + i] += along * c[i]));
        }
        let left: Vec<f64> = nodes.iter().flat_map(|node| [f[2 * node], f[2 * node + 1]]).collect();
        let load = condensation.load_held(&left, held);
        let kept = load.kept.clone();
        loads.push(load);
        (kept, loads)
    }

    /// The nodal displacement of the skeleton from the kept values.
    ///
    /// # Panics
    /// If the loads are none of [`Skeleton::load`].
    pub(crate) fn expand(&self, loads: &[CondensedLoad], kept: &[f64]) -> Vec<f64> {
        let (fronts, nodes, condensation) = match &self.form {
            Form::Blocks(blocks) => return blocks.expand(loads, kept, self.joined.nodes.len()),
            Form::Condensed { fronts, nodes, condensation } => (fronts, nodes, condensation),
        };
        let (last, of_fronts) = loads.split_last().expect("the load on what fronts leave");
        let mut u = vec![0.0; 2 * self.joined.nodes.len()];
        for (node, left) in nodes.iter().zip(condensation.expand(last, kept).chunks_exact(2)) {
            u[2 * node..2 * node + 2].copy_from_slice(left);
        }
        for row in self.joined.rows.iter().rev() {
            let faced: f64 = row.faced.iter().map(|&(j, c)| c[0] * u[2 * j] + c[1] * u[2 * j + 1]).sum();
            (0..2).for_each(|i| u[2 * row.node + i] += faced * row.direction[i]);
        }
        for (front, load) in fronts.iter().zip(of_fronts).rev() {
            front.expand(load, &mut u);
        }
        u
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

//! A skeleton of which nothing is eliminated that several subdomains share: its matrix is a sum of blocks and stays one.
//!
//! ```text
//! S_c = Σ R_kᵀ S_k R_k      kept: the unknowns of contact, then all that subdomains share
//! ```
//! With many contact unknowns S_c has few entries: those of two subdomains meet in what these share alone. What one subdomain has
//! alone and contact does not keep is eliminated in its block.

use faer::Scale;
use steklov_algebra::{NoSparseFactor, SparseSymmetric, Symmetric};

use crate::skeleton::Joined;
use crate::{BemError, Condensation, CondensedLoad, Partition};

/// The block of a subdomain.
#[derive(Debug, Clone)]
struct Block {
    /// Its nodes in the skeleton.
    nodes: Vec<usize>,
    /// Whether the loads on each of them act here: on a node that several subdomains have they act in the first.
    is_loaded: Vec<bool>,
    /// The place in S_c of each unknown that it keeps.
    kept: Vec<usize>,
    /// The numbers of what it holds.
    held: Vec<usize>,
    condensation: Condensation,
}

/// The blocks of all subdomains.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    blocks: Vec<Block>,
    /// Number of unknowns of S_c.
    kept: usize,
}

/// Where an unknown of the skeleton goes.
#[derive(Debug, Clone, Copy)]
enum Place {
    Kept(usize),
    Held(usize),
    Eliminated,
}

/// The places of all unknowns of a skeleton, and the number of those that are kept.
fn places(joined: &Joined) -> (Vec<Place>, usize) {
    let mut places = vec![Place::Eliminated; 2 * joined.nodes.len()];
    joined.partition.kept.iter().enumerate().for_each(|(k, &dof)| places[dof] = Place::Kept(k));
    joined.partition.held.iter().enumerate().for_each(|(h, &(dof, _))| places[dof] = Place::Held(h));
    let mut owners = vec![0; joined.nodes.len()];
    joined.stiffness.iter().flatten().flat_map(|shared| &shared.nodes).for_each(|&node| owners[node] += 1);
    let mut kept = joined.partition.kept.len();
    for (dof, place) in places.iter_mut().enumerate() {
        if owners[dof / 2] > 1 && matches!(place, Place::Eliminated) {
            *place = Place::Kept(kept);
            kept += 1;
        }
    }
    (places, kept)
}

impl Blocks {
    /// The blocks of subdomains whose S_k have these factors.
    pub(crate) fn new(joined: &Joined, moduli: &[f64]) -> Result<Self, BemError> {
        let (places, kept) = places(joined);
        let mut is_loaded = vec![false; joined.nodes.len()];
        let mut frame_of = vec![None; joined.nodes.len()];
        joined.partition.frames.iter().for_each(|&(node, frame)| frame_of[node] = Some(frame));
        let mut blocks = Vec::new();
        for (shared, &modulus) in joined.stiffness.iter().zip(moduli) {
            let Some(shared) = shared else { continue };
            let nodes = shared.nodes.clone();
            let mut partition = Partition::default();
            let (mut of_kept, mut of_held) = (Vec::new(), Vec::new());
            for dof in 0..2 * nodes.len() {
                match places[2 * nodes[dof / 2] + dof % 2] {
                    Place::Kept(k) => {
                        partition.kept.push(dof);
                        of_kept.push(k);
                    }
                    Place::Held(h) => {
                        partition.held.push((dof, joined.partition.held[h].1));
                        of_held.push(h);
                    }
                    Place::Eliminated => {}
                }
            }
            let frames = nodes.iter().enumerate().filter_map(|(local, &node)| Some((local, frame_of[node]?)));
            partition.frames = frames.collect();
            let first = nodes.iter().map(|&node| !std::mem::replace(&mut is_loaded[node], true)).collect();
            let condensation = Condensation::new(&*shared.stiffness * Scale(modulus), &partition, &[])?;
            blocks.push(Block { nodes, is_loaded: first, kept: of_kept, held: of_held, condensation });
        }
        Ok(Self { blocks, kept })
    }

    /// S_c.
    pub(crate) fn stiffness(&self) -> Result<Symmetric, BemError> {
        let matrices = self.blocks.iter().map(|block| block.condensation.stiffness());
        let matrices = matrices.collect::<Result<Vec<_>, _>>()?;
        let blocks = self.blocks.iter().zip(&matrices).map(|(block, matrix)| (block.kept.as_slice(), matrix.as_ref()));
        match SparseSymmetric::sum(self.kept, blocks.clone()) {
            Ok(sum) => Ok(Symmetric::Sparse(sum)),
            Err(NoSparseFactor::Fault(fault)) => Err(fault.into()),
            Err(_) => Err(BemError::Memory { size: self.kept }),
        }
    }

    /// Reduces a nodal load on the skeleton, and the forces of held values: the load on what is kept, and that of each block.
    pub(crate) fn load(&self, load: &[f64], held: &[f64]) -> (Vec<f64>, Vec<CondensedLoad>) {
        let mut kept = vec![0.0; self.kept];
        let of = |block: &Block| {
            let nodes = block.nodes.iter().zip(&block.is_loaded);
            let own: Vec<f64> = nodes
                .flat_map(|(node, acts)| if *acts { [load[2 * node], load[2 * node + 1]] } else { [0.0; 2] })
                .collect();
            let values: Vec<f64> = block.held.iter().map(|&h| held[h]).collect();
            let condensed = block.condensation.load_held(&own, &values);
            block.kept.iter().zip(&condensed.kept).for_each(|(&k, f)| kept[k] += f);
            condensed
        };
        let loads = self.blocks.iter().map(of).collect();
        (kept, loads)
    }

    /// The nodal displacement of the skeleton from the kept values.
    pub(crate) fn expand(&self, loads: &[CondensedLoad], kept: &[f64], nodes: usize) -> Vec<f64> {
        let mut u = vec![0.0; 2 * nodes];
        for (block, load) in self.blocks.iter().zip(loads) {
            let own: Vec<f64> = block.kept.iter().map(|&k| kept[k]).collect();
            for (node, own) in block.nodes.iter().zip(block.condensation.expand(load, &own).chunks_exact(2)) {
                u[2 * node..2 * node + 2].copy_from_slice(own);
            }
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;
    use steklov_algebra::Lu;

    use super::*;
    use crate::Assembly;

    /// A positive definite matrix.
    fn matrix(nodes: usize, seed: f64) -> Mat<f64> {
        let n = 2 * nodes;
        let a = Mat::from_fn(n, n, |i, j| (seed + 12.9 * i as f64 + 78.2 * j as f64).sin());
        a.transpose() * &a + Mat::<f64>::identity(n, n)
    }

    fn column(entries: impl ExactSizeIterator<Item = f64>) -> Mat<f64> {
        let entries: Vec<f64> = entries.collect();
        Mat::from_fn(entries.len(), 1, |i, _| entries[i])
    }

    /// Three subdomains with a node in common, and one between two of them each. Contact keeps the normal displacement of a node of
    /// one, and of a shared one, and both of a third; a shared node is held along y.
    #[test]
    fn blocks_are_those_of_the_condensed_skeleton() {
        let of_bodies = [(0, vec![0, 1, 2, 3, 4]), (1, vec![3, 4, 5, 6, 7]), (2, vec![4, 7, 8, 9, 10])];
        let matrices = || (1..=3).map(|k| matrix(5, f64::from(k))).collect::<Vec<_>>();
        let frame = |angle: f64| [[angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]];
        let partition = Partition {
            kept: vec![2, 14, 18, 19],
            held: vec![(0, 0.1), (7, -0.2), (20, 0.05)],
            frames: vec![(1, frame(0.3)), (7, frame(1.1))],
        };
        let values: Vec<f64> = partition.held.iter().map(|held| held.1).collect();
        let load: Vec<f64> = (0..22).map(|k| (1.3 * f64::from(k)).sin()).collect();
        let of_contact = partition.kept.len();

        let condensed = Assembly::new(matrices(), &of_bodies, &partition, &[], &[], &[]).expect("positive matrices");
        let blocks = Assembly::of_blocks(matrices(), &of_bodies, &partition).expect("positive matrices");
        let Symmetric::Sparse(sparse) = blocks.stiffness().expect("no fault") else { panic!("a sum of blocks") };
        // nodes 3 along x, 4, and 7 along its tangent
        assert_eq!(sparse.pattern.size(), of_contact + 4);
        let full = Symmetric::Sparse(sparse);
        assert_eq!(full[(0, 2)], 0.0, "contact nodes of two subdomains do not meet");
        let (all, few) = (blocks.load_held(&load, &values), condensed.load_held(&load, &values));

        // some forces of contact beside the loads
        let contact = [0.3, -0.7, 0.2, 0.9];
        let force = |k: usize| contact.get(k).copied().unwrap_or(0.0);
        let right = column((0..all.kept.len()).map(|k| all.kept[k] - force(k)));
        let v = Lu::new((*full.full()).as_ref()).solve(right.as_ref());
        let right = column((0..of_contact).map(|k| few.kept[k] - force(k)));
        let w = Lu::new((*condensed.stiffness().expect("no fault").full()).as_ref()).solve(right.as_ref());
        let v = v.col_as_slice(0);
        assert!((0..of_contact).all(|k| (v[k] - w[(k, 0)]).abs() < 1e-12), "{v:?} {w:?}");

        let (u, exact) = (blocks.expand(&all, v), condensed.expand(&few, w.col_as_slice(0)));
        let off = u.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12 && u[0] == 0.1 && u[7] == -0.2 && u[20] == 0.05, "{off:e} {u:?}");
        // and other moduli scale the blocks
        let doubled = blocks.with_moduli(&[2.0; 3]).expect("positive matrices").stiffness().expect("no fault");
        let same = |i, j| (doubled[(i, j)] - 2.0 * full[(i, j)]).abs() < 1e-11;
        assert!((0..v.len()).all(|i| (0..v.len()).all(|j| same(i, j))));
    }
}

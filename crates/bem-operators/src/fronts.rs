//! Nested dissection of the unknowns that subdomains share: fronts, eliminated one after the other.
//!
//! Two groups of subdomains become one; the nodes that no other subdomain has are eliminated from the sum of their matrices,
//! and what is left is the matrix of the new group,
//!
//! ```text
//! S := S_KK - S_KR S_RR⁻¹ S_RK      R: the nodes of this group alone, K: those that it shares with others
//! ```
//! until few groups remain. In each round the groups with the fewest nodes choose first, each the neighbour with which it shares most.
//!
//! Cost: for a plate of N subdomains with b unknowns on a side of each O(N^3/2 b³) operations and O(N log N b²) numbers,
//! instead of O(N³ b³) and O(N² b²).
//!
//! Source: George (1973) for nested dissection; Duff and Reid (1983) for fronts.

use std::collections::BTreeMap;

use faer::Mat;

use crate::{BemError, Condensation, CondensedLoad, Partition};

/// So many groups, or fewer, are not joined further.
const FEW: usize = 4;

/// The matrix of a group of subdomains on the nodes that are left of it; two unknowns each.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    pub(crate) nodes: Vec<usize>,
    pub(crate) stiffness: Mat<f64>,
}

impl Group {
    /// The sum of two groups.
    fn with(&self, other: &Self) -> Self {
        let mut nodes = [&self.nodes[..], &other.nodes].concat();
        nodes.sort_unstable();
        nodes.dedup();
        let mut stiffness = Mat::zeros(2 * nodes.len(), 2 * nodes.len());
        self.add_to(&mut stiffness, &nodes, 1.0);
        other.add_to(&mut stiffness, &nodes, 1.0);
        Self { nodes, stiffness }
    }

    /// Adds a multiple of its matrix to one of rising `nodes`, which has all of its own.
    pub(crate) fn add_to(&self, stiffness: &mut Mat<f64>, nodes: &[usize], factor: f64) {
        let place = |node: &usize| nodes.binary_search(node).expect("a node of the group");
        let dofs: Vec<usize> = self.nodes.iter().map(place).flat_map(|k| [2 * k, 2 * k + 1]).collect();
        for (j, &column) in dofs.iter().enumerate() {
            dofs.iter().enumerate().for_each(|(i, &row)| stiffness[(row, column)] += factor * self.stiffness[(i, j)]);
        }
    }
}

/// A group from which nodes are eliminated.
#[derive(Debug, Clone)]
pub(crate) struct Front {
    nodes: Vec<usize>,
    /// Which of them are kept.
    kept: Vec<usize>,
    condensation: Condensation,
}

impl Front {
    /// Reduces the load on its nodes in a nodal load of all: what its own carry goes to those that it keeps.
    pub(crate) fn load(&self, load: &mut [f64]) -> CondensedLoad {
        let mut own: Vec<f64> = self.nodes.iter().flat_map(|node| [load[2 * node], load[2 * node + 1]]).collect();
        self.kept.iter().for_each(|k| own[2 * k..2 * k + 2].fill(0.0));
        let condensed = self.condensation.load(&own);
        for (k, f) in self.kept.iter().zip(condensed.kept.chunks_exact(2)) {
            (0..2).for_each(|i| load[2 * self.nodes[*k] + i] += f[i]);
        }
        condensed
    }

    /// The displacement of its own nodes from that of those that it keeps, in a nodal displacement of all.
    pub(crate) fn expand(&self, load: &CondensedLoad, displacement: &mut [f64]) {
        let of = |k: &usize| [displacement[2 * self.nodes[*k]], displacement[2 * self.nodes[*k] + 1]];
        let kept: Vec<f64> = self.kept.iter().flat_map(of).collect();
        let own = self.condensation.expand(load, &kept);
        for (node, u) in self.nodes.iter().zip(own.chunks_exact(2)) {
            displacement[2 * node..2 * node + 2].copy_from_slice(u);
        }
    }
}

/// Joins groups until few are left, and returns the fronts in the order of their elimination with the groups that are left.
/// Nodes that are `protected` stay.
///
/// # Errors
/// [`BemError::StiffnessSingular`], [`BemError::Fault`].
pub(crate) fn dissect(
    mut groups: Vec<Group>,
    protected: &dyn Fn(usize) -> bool,
) -> Result<(Vec<Front>, Vec<Group>), BemError> {
    let mut fronts = Vec::new();
    while groups.len() > FEW {
        let mut owners: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (k, group) in groups.iter().enumerate() {
            group.nodes.iter().for_each(|&node| owners.entry(node).or_default().push(k));
        }
        let shared = |node: &usize| if protected(*node) { &[][..] } else { &owners[node] };
        let pairs = pairs(&groups, &shared);
        if pairs.is_empty() {
            break;
        }
        let mut next = Vec::new();
        let mut joined = vec![false; groups.len()];
        for [a, b] in pairs {
            let both = groups[a].with(&groups[b]);
            let is_kept = |node: &usize| protected(*node) || owners[node].iter().any(|k| ![a, b].contains(k));
            let kept: Vec<usize> = (0..both.nodes.len()).filter(|&k| is_kept(&both.nodes[k])).collect();
            let partition =
                Partition { kept: kept.iter().flat_map(|k| [2 * k, 2 * k + 1]).collect(), ..Partition::default() };
            let condensation = Condensation::new(both.stiffness, &partition, &[])?;
            let nodes = kept.iter().map(|&k| both.nodes[k]).collect();
            next.push(Group { nodes, stiffness: condensation.stiffness()? });
            fronts.push(Front { nodes: both.nodes, kept, condensation });
            (joined[a], joined[b]) = (true, true);
        }
        next.extend(groups.into_iter().zip(joined).filter(|(_, joined)| !joined).map(|(group, _)| group));
        groups = next;
    }
    Ok((fronts, groups))
}

/// Pairs of groups to be joined: each group in the order of the number of its nodes, and the free neighbour with which it shares most
/// nodes that may be eliminated. `sharing` are the groups that share such a node.
fn pairs<'a>(groups: &[Group], sharing: &dyn Fn(&usize) -> &'a [usize]) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..groups.len()).collect();
    order.sort_by_key(|&k| (groups[k].nodes.len(), k));
    let mut free = vec![true; groups.len()];
    let mut pairs = Vec::new();
    for a in order {
        if !std::mem::replace(&mut free[a], false) {
            continue;
        }
        let mut shared: BTreeMap<usize, usize> = BTreeMap::new();
        for &b in groups[a].nodes.iter().flat_map(sharing).filter(|&&b| free[b]) {
            *shared.entry(b).or_default() += 1;
        }
        // of several the first
        if let Some((b, _)) = shared.into_iter().max_by_key(|&(b, count)| (count, std::cmp::Reverse(b))) {
            free[b] = false;
            pairs.push([a, b]);
        }
    }
    pairs
}

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
    /// Adds its matrix to one of rising `nodes`, which has all of its own.
    pub(crate) fn add_to(&self, stiffness: &mut Mat<f64>, nodes: &[usize]) {
        let place = |node: &usize| nodes.binary_search(node).expect("a node of the group");
        let dofs: Vec<usize> = self.nodes.iter().map(place).flat_map(|k| [2 * k, 2 * k + 1]).collect();
        for (j, &column) in dofs.iter().enumerate() {
            dofs.iter().enumerate().for_each(|(i, &row)| stiffness[(row, column)] += self.stiffness[(i, j)]);
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

/// Two groups that become one.
struct Join {
    pair: [usize; 2],
    /// The nodes of both, rising.
    nodes: Vec<usize>,
    /// Which of them are kept.
    kept: Vec<usize>,
}

/// Joins groups of nodes, until few are left or none share any nodes but the `protected` ones; each new group gets the next number.
/// Returns the numbers of those that are left too.
fn joins(mut groups: Vec<Vec<usize>>, protected: &dyn Fn(usize) -> bool) -> (Vec<Join>, Vec<usize>) {
    let mut joins = Vec::new();
    let mut left: Vec<usize> = (0..groups.len()).collect();
    while left.len() > FEW {
        let mut owners: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for &k in &left {
            groups[k].iter().for_each(|&node| owners.entry(node).or_default().push(k));
        }
        let sharing = |node: &usize| if protected(*node) { &[][..] } else { &owners[node] };
        let pairs = pairs(&groups, &left, &sharing);
        if pairs.is_empty() {
            break;
        }
        left.retain(|k| pairs.iter().all(|pair| !pair.contains(k)));
        let others = left.len();
        for pair in pairs {
            let mut nodes = pair.map(|k| groups[k].as_slice()).concat();
            nodes.sort_unstable();
            nodes.dedup();
            let is_kept = |node: &usize| protected(*node) || owners[node].iter().any(|k| !pair.contains(k));
            let kept: Vec<usize> = (0..nodes.len()).filter(|&k| is_kept(&nodes[k])).collect();
            left.push(groups.len());
            groups.push(kept.iter().map(|&k| nodes[k]).collect());
            joins.push(Join { pair, nodes, kept });
        }
        left.rotate_left(others);
    }
    (joins, left)
}

/// Pairs of groups to be joined: each group in the order of the number of its nodes, and the free neighbour with which it shares most
/// nodes that may be eliminated. `sharing` are the groups that share such a node.
fn pairs<'a>(groups: &[Vec<usize>], left: &[usize], sharing: &dyn Fn(&usize) -> &'a [usize]) -> Vec<[usize; 2]> {
    let mut order = left.to_vec();
    order.sort_by_key(|&k| (groups[k].len(), k));
    let mut free = vec![true; groups.len()];
    let mut pairs = Vec::new();
    for a in order {
        if !std::mem::replace(&mut free[a], false) {
            continue;
        }
        let mut shared: BTreeMap<usize, usize> = BTreeMap::new();
        for &b in groups[a].iter().flat_map(sharing).filter(|&&b| free[b]) {
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

/// Unknowns of each front of groups of nodes, none of them protected, and of the matrix that is left.
pub fn front_sizes(groups: Vec<Vec<usize>>) -> Vec<usize> {
    let given = groups.clone();
    let (joins, left) = joins(groups, &|_| false);
    let nodes_of = |&k: &usize| match k.checked_sub(given.len()) {
        None => given[k].clone(),
        Some(join) => joins[join].kept.iter().map(|&k| joins[join].nodes[k]).collect(),
    };
    let mut last: Vec<usize> = left.iter().flat_map(nodes_of).collect();
    last.sort_unstable();
    last.dedup();
    joins.iter().map(|join| join.nodes.len()).chain([last.len()]).map(|nodes| 2 * nodes).collect()
}

/// Joins groups until few are left, and returns the fronts in the order of their elimination with the groups that are left.
/// Nodes that are `protected` stay.
///
/// # Errors
/// [`BemError::StiffnessSingular`], [`BemError::Fault`].
pub(crate) fn dissect(
    groups: Vec<Group>,
    protected: &dyn Fn(usize) -> bool,
) -> Result<(Vec<Front>, Vec<Group>), BemError> {
    let (joins, left) = joins(groups.iter().map(|group| group.nodes.clone()).collect(), protected);
    let mut groups: Vec<Option<Group>> = groups.into_iter().map(Some).collect();
    let mut fronts = Vec::new();
    for Join { pair, nodes, kept } in joins {
        let mut stiffness = Mat::zeros(2 * nodes.len(), 2 * nodes.len());
        pair.iter().filter_map(|&k| groups[k].take()).for_each(|group| group.add_to(&mut stiffness, &nodes));
        let partition =
            Partition { kept: kept.iter().flat_map(|k| [2 * k, 2 * k + 1]).collect(), ..Partition::default() };
        let condensation = Condensation::new(stiffness, &partition, &[])?;
        let of_kept = kept.iter().map(|&k| nodes[k]).collect();
        groups.push(Some(Group { nodes: of_kept, stiffness: condensation.stiffness()? }));
        fronts.push(Front { nodes, kept, condensation });
    }
    Ok((fronts, left.into_iter().filter_map(|k| groups[k].take()).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 8 by 8 cells with 3 nodes inside of each of their sides: few fronts are larger than a row of it has nodes, each node is
    /// eliminated once or left, and the numbers are far below those of one matrix.
    #[test]
    fn grids_are_dissected() {
        let side = |across: usize, i: usize, j: usize| (0..3).map(move |k| ((across * 9 + i) * 9 + j) * 3 + k);
        let cell = |k: usize| {
            let (i, j) = (k % 8, k / 8);
            let on_boundary = |at: usize| at == 0 || at == 8;
            let sides = [(0, i, j), (0, i + 1, j), (1, j, i), (1, j + 1, i)];
            sides
                .into_iter()
                .filter(|side| !on_boundary(side.1))
                .flat_map(|(across, i, j)| side(across, i, j))
                .collect()
        };
        let groups: Vec<Vec<usize>> = (0..64).map(cell).collect();
        let mut all: Vec<usize> = groups.concat();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 3 * 2 * 7 * 8);
        let (joins, left) = joins(groups.clone(), &|_| false);
        assert!(left.len() <= FEW && joins.len() == 64 - left.len());
        let eliminated: usize = joins.iter().map(|join| join.nodes.len() - join.kept.len()).sum();
        let sizes = front_sizes(groups);
        assert_eq!(eliminated + sizes[sizes.len() - 1] / 2, all.len());
        let numbers: usize = sizes.iter().map(|n| n * n).sum();
        assert!(2 * numbers < (2 * all.len()).pow(2), "{numbers}");
        assert!(sizes.iter().all(|&n| n <= 2 * 3 * 8 * 3), "{sizes:?}");
        // what is protected stays
        let (_, left_of_all) = super::joins((0..9).map(|k| vec![k, k + 1]).collect(), &|_| true);
        assert_eq!(left_of_all.len(), 9);
    }
}

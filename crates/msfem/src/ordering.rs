//! Nested dissection of the nodes of elements.

/// Fewer elements than this are not parted any more.
const LEAF: usize = 12;

/// Elements, their places, and the nodes that their stiffness couples.
#[derive(Debug, Clone, Default)]
pub(crate) struct Incidence {
    /// Twice the centre of each element, on the lattice of the fine grid.
    pub centres: Vec<[u32; 2]>,
    /// Start of the nodes of each element in `nodes`, and their number at the end.
    pub first: Vec<usize>,
    /// Nodes, element by element.
    pub nodes: Vec<u32>,
}

impl Incidence {
    pub fn push(&mut self, centre: [u32; 2], nodes: impl IntoIterator<Item = usize>) {
        if self.first.is_empty() {
            self.first.push(0);
        }
        self.centres.push(centre);
        self.nodes.extend(nodes.into_iter().map(|n| n as u32));
        self.first.push(self.nodes.len());
    }

    fn of(&self, element: u32) -> &[u32] {
        &self.nodes[self.first[element as usize]..self.first[element as usize + 1]]
    }

    /// All nodes 0..count in an order of elimination: elements are parted across the longer side of their box; the nodes of
    /// both halves alone come first, those that both touch last. Nodes of no element come at the end.
    ///
    /// Source: George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973).
    pub fn nested_dissection(&self, count: usize) -> Vec<usize> {
        let mut elements: Vec<u32> = (0..self.centres.len() as u32).collect();
        let mut state =
            Dissection { of: self, placed: vec![false; count], left: vec![0; count], call: 0, order: vec![] };
        state.order.reserve(count);
        state.dissect(&mut elements);
        let Dissection { placed, mut order, .. } = state;
        order.extend((0..count).filter(|&n| !placed[n]));
        order
    }
}

struct Dissection<'a> {
    of: &'a Incidence,
    placed: Vec<bool>,
    /// The last cut that had the node on its left side.
    left: Vec<u32>,
    call: u32,
    order: Vec<usize>,
}

impl Dissection<'_> {
    fn place(&mut self, node: u32) -> bool {
        !std::mem::replace(&mut self.placed[node as usize], true)
    }

    fn dissect(&mut self, elements: &mut [u32]) {
        let Some(middle) = (elements.len() > LEAF).then(|| self.part(elements)).flatten() else {
            for &element in &*elements {
                for &node in self.of.of(element) {
                    if self.place(node) {
                        self.order.push(node as usize);
                    }
                }
            }
            return;
        };
        let (low, high) = elements.split_at_mut(middle);
        self.call += 1;
        for &element in &*low {
            for &node in self.of.of(element) {
                self.left[node as usize] = self.call;
            }
        }
        let mut separator = Vec::new();
        for &element in &*high {
            for &node in self.of.of(element) {
                if self.left[node as usize] == self.call && self.place(node) {
                    separator.push(node as usize);
                }
            }
        }
        self.dissect(low);
        self.dissect(high);
        self.order.extend(separator);
    }

    /// Puts the elements of the lower half first; their number, None where all lie at one place.
    fn part(&self, elements: &mut [u32]) -> Option<usize> {
        let centre = |e: u32, k: usize| self.of.centres[e as usize][k];
        let [x, y] = [0, 1].map(|k| {
            let all = elements.iter().map(|&e| centre(e, k));
            (all.clone().min().unwrap_or(0), all.max().unwrap_or(0))
        });
        let (along, (low, high)) = if y.1 - y.0 > x.1 - x.0 { (1, y) } else { (0, x) };
        if low == high {
            return None;
        }
        let middle = elements.len() / 2;
        let (_, &mut median, _) = elements.select_nth_unstable_by_key(middle, |&e| centre(e, along));
        // all elements of one line go together
        let cut = centre(median, along).max(low + 1);
        elements.sort_unstable_by_key(|&e| (centre(e, along) >= cut, e));
        Some(elements.partition_point(|&e| centre(e, along) < cut))
    }
}

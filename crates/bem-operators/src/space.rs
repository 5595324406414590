//! Numbering of the unknowns of a mesh.

use std::collections::BTreeMap;

use steklov_quadrature::LobattoBasis;

use crate::{BemError, Mesh};

/// Displacement and traction unknowns of a [`Mesh`].
///
/// *Displacement* is continuous on each loop and of degree p_e on element e, given at the Gauss-Lobatto points. Element
/// e owns its start point and its interior points, the nodes `offset[e] .. offset[e+1]`; its end point is the first node
/// of the element that follows. *Traction* is discontinuous and of degree p_e - 1, given by Legendre coefficients
/// m = 0..p_e: these have the same numbers `offset[e] + m`. Each node and each coefficient carries two unknowns x, y,
/// so both spaces have `2 * nodes()` unknowns (each loop is closed).
#[derive(Debug, Clone)]
pub struct Space {
    /// Number of the first node of each element, and the number of nodes at the end; n+1 entries.
    pub offset: Vec<usize>,
    /// Successor of each element on its loop, as in the mesh.
    pub next: Vec<usize>,
    /// Nodal points.
    pub points: Vec<[f64; 2]>,
    bases: BTreeMap<usize, LobattoBasis>,
}

/// Number of a displacement or traction unknown: component 0 (x) or 1 (y) of a node or coefficient.
pub type Dof = usize;

impl Space {
    /// Numbers the unknowns of `mesh`.
    pub fn new(mesh: &Mesh) -> Self {
        let mut offset = vec![0];
        let mut points = Vec::new();
        let mut bases = BTreeMap::new();
        for e in 0..mesh.len() {
            let p = mesh.degree[e];
            let basis = bases.entry(p).or_insert_with(|| LobattoBasis::new(p));
            points.push(mesh.vertices[e]);
            points.extend(basis.nodes[1..p].iter().map(|&t| mesh.point(e, t)));
            offset.push(points.len());
        }
        Self { offset, next: mesh.next.clone(), points, bases }
    }

    /// The space of these offsets, successors and nodal points; its bases are made anew.
    ///
    /// # Errors
    /// [`BemError::Part`] unless offsets rise from 0 to the number of points by degrees from 1 to [`Mesh::MAX_DEGREE`], each
    /// element follows one other, and points are finite.
    pub fn from_parts(offset: Vec<usize>, next: Vec<usize>, points: Vec<[f64; 2]>) -> Result<Self, BemError> {
        let n = next.len();
        let wrong = |part: &'static str, what: String| Err(BemError::Part { part, what });
        if n == 0 || offset.len() != n + 1 || offset[0] != 0 || offset[n] != points.len() {
            return wrong("offset", format!("{} of them for {n} elements and {} nodes", offset.len(), points.len()));
        }
        let mut bases = BTreeMap::new();
        for (e, ends) in offset.windows(2).enumerate() {
            match ends[1].checked_sub(ends[0]) {
                Some(p @ 1..=Mesh::MAX_DEGREE) => bases.entry(p).or_insert_with(|| LobattoBasis::new(p)),
                _ => return wrong("offset", format!("element {e} owns the nodes from {} to {}", ends[0], ends[1])),
            };
        }
        let mut followed = vec![false; n];
        for (e, &next) in next.iter().enumerate() {
            if next >= n || next == e || std::mem::replace(&mut followed[next], true) {
                return wrong("next", format!("element {e} is followed by {next}, of {n} elements in closed loops"));
            }
        }
        if let Some(k) = points.iter().position(|x| !x.iter().all(|x| x.is_finite())) {
            return wrong("points", format!("node {k} is at ({}, {})", points[k][0], points[k][1]));
        }
        Ok(Self { offset, next, points, bases })
    }

    /// Number of displacement nodes, equal to the number of traction coefficients.
    pub fn nodes(&self) -> usize {
        self.points.len()
    }

    /// Number of displacement unknowns, held ones included, equal to the number of traction unknowns.
    pub fn dofs(&self) -> usize {
        2 * self.nodes()
    }

    /// Degree of element e.
    pub fn degree(&self, e: usize) -> usize {
        self.offset[e + 1] - self.offset[e]
    }

    /// Node at the local point j = 0..=p of element e.
    pub fn node(&self, e: usize, j: usize) -> usize {
        if j < self.degree(e) { self.offset[e] + j } else { self.offset[self.next[e]] }
    }

    /// Nodes of element e from start to end, p+1 of them.
    pub fn element_nodes(&self, e: usize) -> impl Iterator<Item = usize> + '_ {
        (0..=self.degree(e)).map(move |j| self.node(e, j))
    }

    /// Lobatto basis of element e.
    pub fn basis(&self, e: usize) -> &LobattoBasis {
        &self.bases[&self.degree(e)]
    }

    /// Nodal values of a function of the point: interleaved x, y.
    pub fn interpolate(&self, f: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
        self.points.iter().flat_map(|&x| f(x)).collect()
    }
}

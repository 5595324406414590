//! The sides of cells beside the medium around a grid: its tractions there, and the part of their residuals that the cells bear.

use std::collections::HashMap;

use steklov_bem_operators::{Mesh, Space};
use steklov_elastic::plane::{cross, distance, dot, minus};
use steklov_msfem::{Grid, HeterogeneousBody};

use super::loads::Tractions;
use super::trace::{GridTrace, node_at};

/// A fine side beside the medium.
pub(super) struct InterfaceSide {
    /// Fine cell and its side.
    pub side: (usize, usize),
    /// Fine nodes at the start and the end.
    pub nodes: [usize; 2],
    pub length: f64,
    ends: [[f64; 2]; 2],
    /// Boundary elements on it, each with the part that it covers, from 0 to 1 along the side.
    elements: Vec<(usize, [f64; 2])>,
}

/// ∫ φ·v of a traction φ with both linear functions of a side.
pub(super) type Moments = [[f64; 2]; 2];

/// The fine sides of an interface.
pub(super) struct InterfaceSides {
    pub sides: Vec<InterfaceSide>,
    /// Young's modulus of the medium.
    young: f64,
}

impl InterfaceSides {
    /// Those of the boundary of a grid on which boundary elements of a medium lie.
    pub fn new(grid: &Grid, fine: &GridTrace, mesh: &Mesh, young: f64) -> Self {
        let of = |e: usize| {
            let (ends, length) = (fine.mesh.ends(e), fine.mesh.length(e));
            let on = |f: usize| Some((f, overlap(ends, length, mesh, f)?));
            let elements: Vec<(usize, [f64; 2])> = (0..mesh.len()).filter_map(on).collect();
            let covered: f64 = elements.iter().map(|(_, [from, to])| to - from).sum();
            let nodes = [e, fine.mesh.next[e]].map(|node| node_at(grid, fine.lattice[node]));
            // sides of holes have no boundary element on them
            (covered > 0.5).then(|| InterfaceSide { side: fine.cell(grid, e), nodes, length, ends, elements })
        };
        Self { sides: (0..fine.mesh.len()).filter_map(of).collect(), young }
    }

    /// The moments of a traction of the medium on each side.
    pub fn moments(&self, mesh: &Mesh, space: &Space, traction: &[f64]) -> Vec<Moments> {
        let of = |side: &InterfaceSide| {
            let mut moments = [[0.0; 2]; 2];
            for &(f, part) in &side.elements {
                add_moments(&mut moments, side.ends, part, (mesh, space, traction), f);
            }
            moments
        };
        self.sides.iter().map(of).collect()
    }

    /// Adds the moments to forces of the fine nodes.
    pub fn add(&self, moments: &[Moments], forces: &mut [f64]) {
        for (node, moment) in self.forces(moments) {
            (0..2).for_each(|i| forces[2 * node + i] += moment[i]);
        }
    }

    /// The moments by their nodes, of which each has those of two sides.
    pub fn forces(&self, moments: &[Moments]) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.sides.iter().zip(moments).flat_map(|(side, moments)| side.nodes.into_iter().zip(*moments))
    }

    /// The residual of the traction balance acts on body and medium alike: of the energy r²/k₁ that it would have in a cell alone,
    /// the part k₁/(k₁ + k₂) remains, with k₁ and k₂ in the ratio of the moduli.
    fn share(&self, body: &HeterogeneousBody, cell: usize) -> f64 {
        share_of_moduli(body.young[cell], self.young)
    }

    /// The share of each node of the interface, the mean over both sides.
    pub fn shares(&self, body: &HeterogeneousBody) -> HashMap<usize, f64> {
        let mut shares: HashMap<usize, (f64, f64)> = HashMap::new();
        for side in &self.sides {
            for node in side.nodes {
                let (sum, count) = shares.entry(node).or_default();
                (*sum, *count) = (*sum + self.share(body, side.side.0), *count + 1.0);
            }
        }
        shares.into_iter().map(|(node, (sum, count))| (node, sum / count)).collect()
    }

    /// The traction on each side, what is `given` there and that of the medium, drawn to that of the cell in the field u.
    pub fn tractions(
        &self,
        body: &HeterogeneousBody,
        u: &[f64],
        moments: &[Moments],
        given: impl Fn((usize, usize)) -> [Option<f64>; 2],
    ) -> Tractions {
        let of = |(side, moments): (&InterfaceSide, &Moments)| {
            let (cell, number) = side.side;
            let middle = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]][number];
            let [xx, yy, xy] = body.stress(cell, &body.cell_values(u, cell), middle);
            let own = [[-xy, -yy], [xx, xy], [xy, yy], [-xx, -xy]][number];
            let (share, given) = (self.share(body, cell), given(side.side));
            let drawn = |i: usize| {
                let mean = (moments[0][i] + moments[1][i]) / side.length;
                given[i].map(|jump| own[i] + share * (jump + mean - own[i]))
            };
            (side.side, [0, 1].map(drawn))
        };
        self.sides.iter().zip(moments).map(of).collect()
    }
}

fn share_of_moduli(own: f64, other: f64) -> f64 {
    (own / (own + other)).sqrt()
}

/// The part of a side that a boundary element covers, from 0 to 1 along the side.
fn overlap([a, b]: [[f64; 2]; 2], length: f64, mesh: &Mesh, f: usize) -> Option<[f64; 2]> {
    let d = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    let place = |x: [f64; 2]| {
        let r = minus(x, a);
        (dot(r, d) / length, cross(d, r) / length)
    };
    let [(from, off), (to, off_too)] = mesh.ends(f).map(place);
    let (from, to) = (from.max(0.0), to.min(1.0));
    (off.abs() < 1e-6 && off_too.abs() < 1e-6 && to - from > 1e-9).then_some([from, to])
}

/// Adds the moments of the traction of element f on the part of a side.
fn add_moments(
    moments: &mut [[f64; 2]; 2],
    [a, b]: [[f64; 2]; 2],
    [from, to]: [f64; 2],
    (mesh, space, traction): (&Mesh, &Space, &[f64]),
    f: usize,
) {
    let p = space.degree(f);
    let rule = steklov_quadrature::gauss_legendre(p / 2 + 2);
    let side = distance(b, a);
    let [start, end] = mesh.ends(f);
    let d = minus(end, start);
    let mut legendre = vec![0.0; p];
    for (&t, w) in rule.points.iter().zip(&rule.weights) {
        let s = from + (to - from) * (1.0 + t) / 2.0;
        let x = [a[0] + s * (b[0] - a[0]) - start[0], a[1] + s * (b[1] - a[1]) - start[1]];
        let along = dot(x, d) / dot(d, d);
        steklov_quadrature::legendre_p(2.0 * along - 1.0, &mut legendre);
        for i in 0..2 {
            let value: f64 = (0..p).map(|m| legendre[m] * traction[2 * (space.offset[f] + m) + i]).sum();
            let weight = w * (to - from) / 2.0 * side * value;
            moments[0][i] += (1.0 - s) * weight;
            moments[1][i] += s * weight;
        }
    }
}

#[cfg(test)]
mod tests {
    use steklov_bem_operators::{Loop, Polygon};

    use super::*;

    /// v = 1 + c t along an element of length 3, t in [-1, 1]: ∫(1-s)v and ∫sv of halves of it in closed form.
    #[test]
    fn moments_of_a_linear_traction_are_exact() {
        let corners = vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]];
        let polygon = Polygon::new(Loop::straight(corners, vec!["all".to_owned(); 4]), Vec::new()).unwrap();
        let mesh = Mesh::uniform(&polygon, 1, 2);
        let space = Space::new(&mesh);
        let mut traction = vec![0.0; space.dofs()];
        let slope = 0.4;
        let first = space.offset[0];
        traction[2 * first] = 1.0;
        traction[2 * (first + 1)] = slope;
        // v = v0 + (v1 - v0) s on the half: its moments are h (v0/3 + v1/6), h (v0/6 + v1/3)
        for (a, b) in [(0.0, 0.5), (0.5, 1.0)] {
            let [v0, v1] = [a, b].map(|s: f64| 1.0 + slope * (2.0 * s - 1.0));
            let mut moments = [[0.0; 2]; 2];
            let ends = [[3.0 * a, 0.0], [3.0 * b, 0.0]];
            add_moments(&mut moments, ends, [0.0, 1.0], (&mesh, &space, &traction), 0);
            let exact = [1.5 * (v0 / 3.0 + v1 / 6.0), 1.5 * (v0 / 6.0 + v1 / 3.0)];
            for k in 0..2 {
                assert!((moments[k][0] - exact[k]).abs() < 1e-14 && moments[k][1] == 0.0, "{moments:?} {exact:?}");
            }
        }
    }

    /// Two springs k₁ and k₂ that a force r pulls apart from their balance have the energy r²/(k₁ + k₂), those of both shares together.
    #[test]
    fn the_share_of_a_cell_leaves_the_energy_of_both_springs() {
        for [own, other, r] in [[1.0, 1.0, 3.0], [200.0, 2.0, 0.1], [2.0, 200.0, 0.1]] {
            let energy = (r * share_of_moduli(own, other)).powi(2) / own;
            assert!((energy * (own + other) / (r * r) - 1.0).abs() < 1e-14, "{own} {other}: {energy}");
        }
    }
}

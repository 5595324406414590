//! Boundary elements cut into equal parts, and fields on them.

use steklov_bem_operators::{Mesh, Space};
use steklov_quadrature::{gauss_legendre, legendre_p};

/// Each element of a mesh, halved several times; the parts keep its degree.
pub(crate) struct Subdivided {
    pub mesh: Mesh,
    pub space: Space,
    /// First part of each element, and the number of parts at the end.
    pub first: Vec<usize>,
}

impl Subdivided {
    pub fn new(mesh: &Mesh, halvings: usize) -> Self {
        let (mut mesh, mut parent): (Mesh, Vec<usize>) = (mesh.clone(), (0..mesh.len()).collect());
        let whole = mesh.len();
        for _ in 0..halvings {
            let (next, from) = mesh.bisected(&vec![true; mesh.len()]);
            parent = from.into_iter().map(|e| parent[e]).collect();
            mesh = next;
        }
        let first = (0..=whole).map(|e| parent.partition_point(|&p| p < e)).collect();
        let space = Space::new(&mesh);
        Self { mesh, space, first }
    }

    /// How many parts element e has.
    pub fn parts(&self, e: usize) -> usize {
        self.first[e + 1] - self.first[e]
    }

    /// The part of element e on which its point t lies, and its place there.
    pub fn place(&self, e: usize, t: f64) -> (usize, f64) {
        let count = self.parts(e) as f64;
        let along = (t + 1.0) / 2.0 * count;
        let part = along.floor().clamp(0.0, count - 1.0);
        (self.first[e] + part as usize, 2.0 * (along - part) - 1.0)
    }

    /// The values of a nodal field of the whole elements at the nodes of the parts, interleaved.
    pub fn displacement(&self, whole: &Space, nodal: &[f64]) -> Vec<f64> {
        let mut fine = Vec::with_capacity(self.space.dofs());
        let mut phi = vec![0.0; Mesh::MAX_DEGREE + 1];
        self.each_part(|e, [from, to]| {
            let basis = whole.basis(e);
            let phi = &mut phi[..=basis.degree];
            for s in &basis.nodes[..basis.degree] {
                basis.evaluate(from + (to - from) * (s + 1.0) / 2.0, phi);
                let nodes = || whole.element_nodes(e).zip(&*phi);
                fine.extend([0, 1].map(|i| nodes().map(|(node, phi)| phi * nodal[2 * node + i]).sum::<f64>()));
            }
        });
        fine
    }

    /// The Legendre coefficients on the parts of a traction of the whole elements, interleaved.
    pub fn traction(&self, whole: &Space, coefficients: &[f64]) -> Vec<f64> {
        let mut fine = Vec::with_capacity(self.space.dofs());
        let (mut on_whole, mut on_part) = (vec![0.0; Mesh::MAX_DEGREE], vec![0.0; Mesh::MAX_DEGREE]);
        self.each_part(|e, [from, to]| {
            let p = whole.degree(e);
            let (on_whole, on_part) = (&mut on_whole[..p], &mut on_part[..p]);
            let (start, rule) = (fine.len(), gauss_legendre(p));
            fine.resize(start + 2 * p, 0.0);
            for (s, w) in rule.points.iter().zip(&rule.weights) {
                legendre_p(from + (to - from) * (s + 1.0) / 2.0, on_whole);
                legendre_p(*s, on_part);
                for i in 0..2 {
                    let terms = on_whole.iter().enumerate();
                    let value: f64 = terms.map(|(n, l)| l * coefficients[2 * (whole.offset[e] + n) + i]).sum();
                    for (m, l) in on_part.iter().enumerate() {
                        fine[start + 2 * m + i] += w * value * l * (2 * m + 1) as f64 / 2.0;
                    }
                }
            }
        });
        fine
    }

    /// Calls `at` with each part: its element, and its reference coordinates there.
    fn each_part(&self, mut at: impl FnMut(usize, [f64; 2])) {
        for e in 0..self.first.len() - 1 {
            let parts = self.parts(e);
            (0..parts).for_each(|j| at(e, [j, j + 1].map(|j| 2.0 * j as f64 / parts as f64 - 1.0)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steklov_bem_operators::{Loop, Polygon};

    #[test]
    fn fields_stay_what_they_are_on_the_parts() {
        let corners = vec![[0.0, 0.0], [2.0, 0.3], [1.1, 1.7]];
        let sides = ["a", "b", "c"].map(String::from).to_vec();
        let polygon = Polygon::new(Loop::straight(corners, sides), Vec::new()).unwrap();
        let mesh = Mesh::from_breaks(&polygon, &[vec![0.3], vec![], vec![]], &[vec![1, 3], vec![4], vec![2]]).unwrap();
        let space = Space::new(&mesh);
        let parts = Subdivided::new(&mesh, 2);
        assert_eq!((parts.mesh.len(), &parts.first[..]), (16, &[0, 4, 8, 12, 16][..]));
        let field = |[x, y]: [f64; 2]| [x - 2.0 * y + 1.0, 0.5 * x + y];
        let (found, wanted) = (parts.displacement(&space, &space.interpolate(field)), parts.space.interpolate(field));
        assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {wanted:?}");
        let coefficients: Vec<f64> = (0..space.dofs()).map(|i| (i as f64).sin()).collect();
        let fine = parts.traction(&space, &coefficients);
        let value = |space: &Space, all: &[f64], e: usize, t: f64| {
            let mut p = vec![0.0; space.degree(e)];
            legendre_p(t, &mut p);
            p.iter().enumerate().map(|(n, p)| p * all[2 * (space.offset[e] + n)]).sum::<f64>()
        };
        for e in 0..mesh.len() {
            for j in 0..4 {
                let (t, s) = (-1.0 + 0.5 * (j as f64 + 0.3), -0.4);
                let (a, b) = (value(&space, &coefficients, e, t), value(&parts.space, &fine, 4 * e + j, s));
                assert!((a - b).abs() < 1e-13, "{e} {j}: {a} {b}");
            }
        }
    }
}

//! Springs of sides on a mesh: their contributions to stiffness, forces and energies.
//!
//! For an element with functions f_a, its nodal ones and the bubble, and u = Σ u_a f_a
//!
//! ```text
//! M_ab = ∫ Σ_i k_i (d_i·f_a)(d_i·f_b)      force on f_a  -∫ Σ_i k_i (d_i·u)(d_i·f_a)      energy ½ ∫ Σ_i k_i (d_i·u)²
//! ```
//! are sums over Lobatto points t_j with the moments ∫ k_i ℓ_j of the Lagrange functions as weights: exact for the polynomials
//! of straight elements, however k varies within them. The part of particular solutions that nodes miss does not pull at
//! springs: it counts in J, to first order.

use std::collections::BTreeMap;

use faer::Mat;
use steklov_bem_operators::{Enriched, Mesh, Site, Space, side_moments};
use steklov_contact::oscillation;
use steklov_elastic::plane::dot;
use steklov_expression::Expression;
use steklov_problem::STIFFNESS;
use steklov_quadrature::{LobattoBasis, legendre_p};

use crate::data::body_load::Particulars;
use crate::data::on_mesh::OnMesh;
use crate::data::parts::Piece;
use crate::data::supports::Resisted;
use crate::error::SolveError;

/// Degrees beyond that of an element that follow its curve.
const ON_CURVES: usize = 17;

/// A point of an element: the values of its functions, the weight and the direction of both springs.
#[derive(Debug, Clone)]
struct Point {
    t: f64,
    values: Vec<f64>,
    springs: [(f64, [f64; 2]); 2],
}

/// The callback for a point, with the weight, the direction d and d·u of a spring there.
type OfSpring<'a> = dyn FnMut(&Point, f64, [f64; 2], f64) + 'a;

/// The springs of an element.
#[derive(Debug, Clone)]
struct OfElement {
    element: usize,
    points: Vec<Point>,
}

/// The springs of all sides.
#[derive(Debug, Clone, Default)]
pub struct Springs {
    elements: Vec<OfElement>,
    /// The directions that they resist, each with its element.
    resisted: Vec<(usize, Resisted)>,
}

impl OnMesh<'_> {
    /// h/(p+2) ‖K u - Π K u‖² of each element, u a nodal displacement: the part that its degree, raised by one, does not
    /// resolve.
    pub(crate) fn unresolved_springs(&self, displacement: &[f64]) -> Result<Vec<f64>, SolveError> {
        let mut unresolved = vec![0.0; self.mesh.len()];
        if !self.scene.problem.has_springs() {
            return Ok(unresolved);
        }
        let raised = Space::new(&self.mesh.raised(&vec![true; self.mesh.len()]));
        for (side, of_side) in self.scene.problem.sides.iter().enumerate() {
            let Some(springs) = &of_side.springs else { continue };
            for (k, stiffness) in springs.stiffnesses().into_iter().enumerate() {
                for i in (0..2).filter(|_| stiffness.constant() != Some(0.0)) {
                    let factor = |site: &Site| {
                        let d = springs.directions(self.mesh.normal(site.element, site.t))[k];
                        dot(d, self.displacement(displacement, site)) * d[i]
                    };
                    for part in self.followed(&raised, side, STIFFNESS, stiffness, &factor)? {
                        unresolved[part.element] += part.rest;
                    }
                }
            }
        }
        Ok(unresolved)
    }

    /// ‖w‖ ‖dw/ds‖ of the part w = u_p - I_p u_p of particular solutions on springs that nodes miss, as for held
    /// displacements: (element, length²).
    pub(crate) fn oscillation_on_springs(&self, particular: &Particulars) -> Result<Vec<(usize, f64)>, SolveError> {
        let (mut found, none) = (Vec::new(), Expression::number(0.0));
        for (side, _) in self.scene.problem.sides.iter().enumerate().filter(|(_, side)| side.springs.is_some()) {
            let Some(solution) = self.particular_of_side(particular, side) else { continue };
            for direction in [[1.0, 0.0], [0.0, 1.0]] {
                let function = self.less_particular(&none, Some(solution), |_| direction);
                for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == side) {
                    found.push((e, oscillation(self.mesh, self.space, e, &function.datum(STIFFNESS))?));
                }
            }
        }
        Ok(found)
    }

    /// A nodal displacement at a point of the boundary.
    fn displacement(&self, nodal: &[f64], site: &Site) -> [f64; 2] {
        let basis = self.space.basis(site.element);
        let mut phi = vec![0.0; basis.degree + 1];
        basis.evaluate(site.t, &mut phi);
        let nodes = self.space.element_nodes(site.element).zip(&phi);
        nodes.fold([0.0; 2], |u, (node, phi)| [0, 1].map(|i| u[i] + phi * nodal[2 * node + i]))
    }

    /// The springs of all sides.
    ///
    /// # Errors
    /// Stiffnesses that are not finite.
    pub fn springs(&self) -> Result<Springs, SolveError> {
        let mut all = Springs::default();
        for (side, of_side) in self.scene.problem.sides.iter().enumerate() {
            let Some(springs) = &of_side.springs else { continue };
            let degree = |e: usize| {
                let p = self.mesh.degree[e];
                if self.mesh.is_line(e) { 2 * (p + 1) } else { p + 1 + ON_CURVES.max(p + 1) }
            };
            let on_side = |e: usize| self.mesh.side[e] == side;
            let degrees = (0..self.mesh.len()).map(|e| if on_side(e) { degree(e) } else { 1 }).collect();
            let rules = Space::new(&Mesh { degree: degrees, ..self.mesh.clone() });
            let mut moments = Vec::new();
            for stiffness in springs.stiffnesses() {
                let function = self.function(stiffness);
                let found = side_moments(self.mesh, &rules, side, &function.datum(STIFFNESS));
                moments.push(found.map_err(|error| self.located(error, stiffness))?);
            }
            for ((e, first), (_, second)) in moments[0].iter().zip(&moments[1]) {
                let points = rules.basis(*e).nodes.iter().zip(first).zip(second);
                let point = |((&t, &a), &b): ((&f64, &f64), &f64)| {
                    let [d, n] = springs.directions(self.mesh.normal(*e, t));
                    Point { t, values: functions(self.space.basis(*e), t), springs: [(a, d), (b, n)] }
                };
                let points: Vec<Point> = points.map(point).collect();
                for i in 0..2 {
                    if points.iter().map(|point| point.springs[i].0).sum::<f64>() > 0.0 {
                        let at = |point: &Point| (*e, (self.mesh.point(*e, point.t), point.springs[i].1));
                        all.resisted.extend(points.iter().map(at));
                    }
                }
                all.elements.push(OfElement { element: *e, points });
            }
        }
        Ok(all)
    }
}

/// The values of the nodal functions of a basis and of the bubble (P_(p+1) - P_(p-1))/(2p+1).
fn functions(basis: &LobattoBasis, t: f64) -> Vec<f64> {
    let p = basis.degree;
    let (mut values, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
    basis.evaluate(t, &mut values);
    legendre_p(t, &mut legendre);
    values.push((legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64);
    values
}

impl OfElement {
    /// Numbers of the first unknowns of the functions: of nodal ones by their nodes, of the bubble behind those of all nodes.
    fn unknowns(&self, space: &Space) -> Vec<usize> {
        let nodes = space.element_nodes(self.element).map(|node| 2 * node);
        nodes.chain([space.dofs() + 2 * self.element]).collect()
    }

    /// Calls `call` with each point and spring, for a displacement of all nodes, or of all nodes and the bubbles behind them.
    fn each(&self, unknowns: &[usize], displacement: &[f64], call: &mut OfSpring<'_>) {
        for point in &self.points {
            let mut u = [0.0; 2];
            for (dof, value) in unknowns.iter().zip(&point.values) {
                (0..2).for_each(|i| u[i] += displacement.get(dof + i).map_or(0.0, |u| u * value));
            }
            point.springs.iter().for_each(|&(weight, d)| call(point, weight, d, dot(d, u)));
        }
    }
}

impl Springs {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// The directions that they resist on the elements for which `of` holds.
    pub fn resisted(&self, of: impl Fn(usize) -> bool) -> Vec<Resisted> {
        self.resisted.iter().filter(|(e, _)| of(*e)).map(|(_, resisted)| *resisted).collect()
    }

    /// Adds M to the matrix of a body.
    pub fn stiffen(&self, matrix: &mut Mat<f64>, piece: &Piece) {
        for (own, local) in self.elements.iter().filter_map(|own| Some((own, piece.part.local(own.element)?))) {
            let nodes: Vec<usize> = piece.part.space.element_nodes(local).map(|node| 2 * node).collect();
            for Point { values, springs, .. } in &own.points {
                for &(weight, d) in springs {
                    for (a, b) in (0..nodes.len()).flat_map(|a| (0..nodes.len()).map(move |b| (a, b))) {
                        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                            matrix[(nodes[a] + i, nodes[b] + j)] += weight * values[a] * values[b] * (d[i] * d[j]);
                        }
                    }
                }
            }
        }
    }

    /// M u on all nodes and bubbles, for a displacement without bubbles or with all of them.
    pub(crate) fn pull(&self, space: &Space, elements: usize, u: &[f64]) -> Enriched {
        let mut pull = vec![0.0; space.dofs() + 2 * elements];
        for own in &self.elements {
            let unknowns = own.unknowns(space);
            own.each(&unknowns, u, &mut |point, weight, d, along| {
                for (dof, value) in unknowns.iter().zip(&point.values) {
                    (0..2).for_each(|i| pull[dof + i] += weight * along * d[i] * value);
                }
            });
        }
        let extra = pull.split_off(space.dofs());
        Enriched { base: pull, extra }
    }

    /// ½ ∫ K u·u of a nodal displacement.
    pub(crate) fn energy(&self, space: &Space, displacement: &[f64]) -> f64 {
        let mut energy = 0.0;
        for own in &self.elements {
            own.each(&own.unknowns(space), displacement, &mut |_, weight, _, along| {
                energy += 0.5 * weight * along * along;
            });
        }
        energy
    }

    /// -∫ K u of each side with springs: their force on the body.
    pub(crate) fn reactions(&self, mesh: &Mesh, space: &Space, displacement: &[f64]) -> Vec<(usize, [f64; 2])> {
        let mut forces: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for own in &self.elements {
            let force = forces.entry(mesh.side[own.element]).or_default();
            own.each(&own.unknowns(space), displacement, &mut |_, weight, d, along| {
                (0..2).for_each(|i| force[i] -= weight * along * d[i]);
            });
        }
        forces.into_iter().collect()
    }

    /// -∫ w·K u of a side with springs: the work of their force on the body on a field w.
    pub(crate) fn work(
        &self,
        data: &OnMesh<'_>,
        displacement: &[f64],
        side: usize,
        w: &dyn Fn([f64; 2]) -> [f64; 2],
    ) -> f64 {
        let mut work = 0.0;
        for own in self.elements.iter().filter(|own| data.mesh.side[own.element] == side) {
            own.each(&own.unknowns(data.space), displacement, &mut |point, weight, d, along| {
                work -= weight * along * dot(w(data.mesh.point(own.element, point.t)), d);
            });
        }
        work
    }

    /// The first-order gain of J from the part of particular solutions that the nodes miss: ∫ K u·(u_p - I_p u_p).
    pub(crate) fn work_on_rest(&self, data: &OnMesh<'_>, displacement: &[f64], particular: &Particulars) -> f64 {
        let (space, mut work) = (data.space, 0.0);
        for own in &self.elements {
            let Some(solution) = particular.of(own.element) else { continue };
            let nodal: Vec<[f64; 2]> =
                space.element_nodes(own.element).map(|node| solution.displacement(space.points[node])).collect();
            own.each(&own.unknowns(space), displacement, &mut |point, weight, d, along| {
                let mut rest = solution.displacement(data.mesh.point(own.element, point.t));
                for (u, value) in nodal.iter().zip(&point.values) {
                    (0..2).for_each(|i| rest[i] -= value * u[i]);
                }
                work += weight * along * dot(d, rest);
            });
        }
        work
    }

    /// M of the bubble of each element.
    pub(crate) fn bubble_blocks(&self, elements: usize) -> Vec<[[f64; 2]; 2]> {
        let mut blocks = vec![[[0.0; 2]; 2]; elements];
        for own in &self.elements {
            for Point { values, springs, .. } in &own.points {
                let bubble = values[values.len() - 1];
                for (weight, d) in springs {
                    let block = &mut blocks[own.element];
                    (0..4).for_each(|k| block[k / 2][k % 2] += weight * bubble * bubble * (d[k / 2] * d[k % 2]));
                }
            }
        }
        blocks
    }
}

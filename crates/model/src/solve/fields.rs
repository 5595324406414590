//! Displacement and stress of a solved body, inside and on its boundary.

use std::ops::Range;

use steklov_bem_operators::{BoundaryField, Inside, Mesh, ParticularSolution, Trace};

use crate::data::body_load::Particulars;
use crate::data::on_mesh::OnMesh;

/// The fields of all bodies of a mesh, without particular solutions.
#[derive(Debug, Clone)]
pub struct Field {
    /// The elements of each body, and its field.
    bodies: Vec<(Range<usize>, BoundaryField)>,
}

impl Field {
    /// The field of bodies in the order of their elements.
    pub(crate) fn new(bodies: Vec<(Range<usize>, BoundaryField)>) -> Self {
        Self { bodies }
    }

    /// Values on the boundary at the reference coordinate t of element e.
    pub fn trace(&self, e: usize, t: f64) -> Trace {
        let body = self.bodies.partition_point(|(elements, _)| elements.end <= e);
        let (elements, field) = &self.bodies[body];
        field.trace(e - elements.start, t)
    }

    /// Values at a point inside a body.
    pub fn inside(&self, body: usize, x: [f64; 2]) -> Inside {
        self.bodies[body].1.inside(x)
    }

    /// The elements of a body.
    pub fn elements(&self, body: usize) -> Range<usize> {
        self.bodies[body].0.clone()
    }

    /// The field of a body; its elements are counted from 0.
    pub fn of_body(&self, body: usize) -> &BoundaryField {
        &self.bodies[body].1
    }
}

/// A field of a body, inside and on its boundary.
#[derive(Clone, Copy)]
pub struct ElasticField<'a> {
    /// The boundary elements.
    pub mesh: &'a Mesh,
    /// Their displacement and traction.
    pub field: &'a Field,
    /// The particular solutions that are added to it.
    pub particular: &'a Particulars,
}

impl ElasticField<'_> {
    /// Displacement and stress at a point inside a body.
    pub fn inside(&self, body: usize, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let Inside { displacement: mut u, mut stress, .. } = self.field.inside(body, x);
        if let Some(p) = self.particular.of(self.field.bodies[body].0.start) {
            let (v, sigma) = (p.displacement(x), p.stress(x));
            (0..2).for_each(|i| u[i] += v[i]);
            (0..3).for_each(|i| stress[i] += sigma[i]);
        }
        (u, stress)
    }

    /// Displacement and stress at the reference coordinate t of element e.
    pub fn on_boundary(&self, e: usize, t: f64) -> ([f64; 2], [f64; 3]) {
        let trace = self.field.trace(e, t);
        let (mut u, mut stress) = (trace.displacement, trace.stress);
        if let Some(p) = self.particular.of(e) {
            let x = self.mesh.point(e, t);
            let (v, sigma) = (p.displacement(x), p.stress(x));
            (0..2).for_each(|i| u[i] += v[i]);
            (0..3).for_each(|i| stress[i] += sigma[i]);
        }
        (u, stress)
    }

    /// Traction at the reference coordinate t of element e.
    pub fn traction(&self, e: usize, t: f64) -> [f64; 2] {
        let traction = self.field.trace(e, t).traction;
        let of = |b: &ParticularSolution| b.traction(self.mesh.point(e, t), self.mesh.normal(e, t));
        let extra = self.particular.of(e).map_or([0.0; 2], of);
        [traction[0] + extra[0], traction[1] + extra[1]]
    }

    /// Displacement and stress at the edge parameter s of an edge; at a vertex the mean of the stresses beside it.
    pub fn on_edge(&self, edge: usize, s: f64) -> ([f64; 2], [f64; 3]) {
        let within = |e: &usize| {
            let [a, b] = self.mesh.span[*e];
            self.mesh.edge[*e] == edge && a.min(b) <= s && s <= a.max(b)
        };
        let e = (0..self.mesh.len()).find(within).unwrap_or(0);
        let [a, b] = self.mesh.span[e];
        let t = (2.0 * (s - a) / (b - a) - 1.0).clamp(-1.0, 1.0);
        let (displacement, stress) = self.on_boundary(e, t);
        // at a vertex the mean of the stresses of its two elements
        let other = match t {
            1.0 => self.on_boundary(self.mesh.next[e], -1.0).1,
            -1.0 => {
                (0..self.mesh.len()).find(|&f| self.mesh.next[f] == e).map_or(stress, |f| self.on_boundary(f, 1.0).1)
            }
            _ => stress,
        };
        (displacement, [0, 1, 2].map(|i| (stress[i] + other[i]) / 2.0))
    }
}

impl OnMesh<'_> {
    /// ∫ t φ_j over element e of the whole traction, for its local node j.
    pub fn traction_moment(&self, field: &Field, particular: &Particulars, e: usize, j: usize) -> [f64; 2] {
        let basis = self.space.basis(e);
        let more = if self.mesh.is_line(e) { 2 } else { 16 };
        let rule = steklov_quadrature::gauss_legendre(basis.degree + more);
        let mut phi = vec![0.0; basis.degree + 1];
        let mut sum = [0.0; 2];
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            basis.evaluate(t, &mut phi);
            let mut traction = field.trace(e, t).traction;
            if let Some(body) = particular.of(e) {
                let extra = body.traction(self.mesh.point(e, t), self.mesh.normal(e, t));
                traction = [traction[0] + extra[0], traction[1] + extra[1]];
            }
            for i in 0..2 {
                sum[i] += w * self.mesh.speed(e, t) * phi[j] * traction[i];
            }
        }
        sum
    }
}

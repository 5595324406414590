//! Displacement and stress of a solved body, inside and on its boundary.

use std::ops::Range;
use std::sync::Arc;

use steklov_bem_operators::{BoundaryField, Cuts, Inside, Mesh, ParticularSolution, Subdomain, Trace};
use steklov_elastic::plane::{cross, dot, minus};

use crate::data::body_load::Particulars;
use crate::data::on_mesh::OnMesh;

/// The fields of all bodies of a mesh, without particular solutions.
#[derive(Debug, Clone)]
pub struct Field {
    /// The fields of bodies, of one that is cut those of its subdomains.
    pieces: Vec<BoundaryField>,
    /// The piece of each element of the boundary, and its number there.
    places: Vec<(usize, usize)>,
    /// Where the only body is cut.
    cuts: Option<OnCuts>,
}

/// The elements of cuts.
#[derive(Debug, Clone)]
struct OnCuts {
    cuts: Arc<Cuts>,
    /// Subdomain, number in it, and ends of each: every element has two sides.
    elements: Vec<(usize, usize, [[f64; 2]; 2])>,
}

impl OnCuts {
    /// The elements on which a point lies, and where: subdomain, number in it, reference coordinate.
    fn at(&self, x: [f64; 2]) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.elements.iter().filter_map(move |&(piece, local, [a, b])| {
            let (d, to) = (minus(b, a), minus(x, a));
            let (along, across) = (dot(to, d) / dot(d, d), cross(d, to) / dot(d, d));
            let inside = -ON_CUT < along && along < 1.0 + ON_CUT && across.abs() < ON_CUT;
            inside.then(|| (piece, local, (2.0 * along - 1.0).clamp(-1.0, 1.0)))
        })
    }
}

/// Distance from an element of a cut, over its length, below which a point is on it.
const ON_CUT: f64 = 1e-9;

impl Field {
    /// The fields of the bodies, or of the subdomains of one that is cut; the mesh has that many elements.
    pub(crate) fn new(pieces: Vec<(&Subdomain, BoundaryField)>, cuts: Option<Arc<Cuts>>, elements: usize) -> Self {
        let mut places = vec![(0, 0); elements];
        for (k, (part, _)) in pieces.iter().enumerate() {
            for (local, &e) in part.elements.iter().enumerate().filter(|(_, e)| **e < elements) {
                places[e] = (k, local);
            }
        }
        let of_piece = |(k, (part, _)): (usize, &(&Subdomain, BoundaryField))| {
            let on_cuts = part.elements.iter().enumerate().filter(|(_, e)| **e >= elements);
            on_cuts.map(|(local, _)| (k, local, part.mesh.ends(local))).collect::<Vec<_>>()
        };
        let of_cuts = |cuts| OnCuts { cuts, elements: pieces.iter().enumerate().flat_map(of_piece).collect() };
        let cuts = cuts.map(of_cuts);
        Self { pieces: pieces.into_iter().map(|(_, field)| field).collect(), places, cuts }
    }

    /// The piece of element e, and its number there.
    pub(crate) fn place(&self, e: usize) -> (usize, usize) {
        self.places[e]
    }

    /// The piece of a point inside a body.
    pub(crate) fn piece_at(&self, body: usize, x: [f64; 2]) -> usize {
        self.cuts.as_ref().map_or(body, |of| of.cuts.at(x))
    }

    /// Whether the body is cut into subdomains.
    pub fn is_cut(&self) -> bool {
        self.cuts.is_some()
    }

    /// Values on the boundary at the reference coordinate t of element e.
    pub fn trace(&self, e: usize, t: f64) -> Trace {
        let (piece, local) = self.places[e];
        self.pieces[piece].trace(local, t)
    }

    /// Displacement and stress at a point inside a body; on cuts the mean of all sides.
    pub fn inside(&self, body: usize, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let sides: Vec<Trace> =
            self.cuts.iter().flat_map(|cuts| cuts.at(x)).map(|(k, e, t)| self.pieces[k].trace(e, t)).collect();
        if !sides.is_empty() {
            let mean = |of: &dyn Fn(&Trace) -> f64| sides.iter().map(of).sum::<f64>() / sides.len() as f64;
            return ([0, 1].map(|i| mean(&|s| s.displacement[i])), [0, 1, 2].map(|i| mean(&|s| s.stress[i])));
        }
        let piece = self.piece_at(body, x);
        let Inside { displacement, stress, .. } = self.pieces[piece].inside(x);
        (displacement, stress)
    }

    /// The elements of a body.
    pub fn elements(&self, body: usize) -> Range<usize> {
        let first = self.places.partition_point(|(k, _)| *k < body);
        first..first + self.places[first..].partition_point(|(k, _)| *k == body)
    }

    /// The field of a body that is not cut, or of a subdomain; its elements are counted from 0.
    pub fn of_piece(&self, piece: usize) -> &BoundaryField {
        &self.pieces[piece]
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
        let (mut u, mut stress) = self.field.inside(body, x);
        if let Some(p) = self.particular.of(self.field.elements(if self.field.cuts.is_some() { 0 } else { body }).start)
        {
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

//! The medium around a body, solved.

use steklov_bem_operators::{Inside, Mesh, ParticularSolution, Space};
use steklov_coupling::{Balance, Coupled, MediumField, Radiation};
use steklov_elastic::Material;
use steklov_elastic::plane::{distance, dot, minus};
use steklov_problem::Surroundings;

use crate::summary::MediumSummary;

/// The medium around a body; its fields are those of the remote stress plus u_c = K ξ - V φ + a.
#[derive(Debug, Clone)]
pub struct Around {
    /// Boundary elements where body and medium meet, the body to the left.
    pub mesh: Mesh,
    /// Their unknowns.
    pub space: Space,
    /// The medium.
    pub material: Material,
    /// L in log(L/r).
    pub length: f64,
    /// ξ = u_c at the nodes (length).
    pub displacement: Vec<f64>,
    /// φ = σ(u_c)n by Legendre coefficients (stress), n out of the body.
    pub traction: Vec<f64>,
    /// Displacement a at infinity (length).
    pub constant: [f64; 2],
    /// Resultant of the loads.
    pub balance: Balance,
    /// The requested behaviour at infinity.
    pub radiation: Radiation,
    /// Stress far away.
    pub remote_stress: [f64; 3],
    /// Its field.
    remote: ParticularSolution,
    field: MediumField,
}

impl Around {
    /// The medium of a solved transmission problem; `length` is L in log(L/r).
    pub fn new(medium: Surroundings<'_>, mesh: Mesh, space: Space, length: f64, coupled: &Coupled) -> Self {
        let of = (&coupled.exterior_displacement[..], &coupled.traction[..], coupled.constant);
        let field = MediumField::new(&mesh, &space, &medium.material, length, of);
        Self {
            mesh,
            space,
            material: medium.material,
            length,
            displacement: coupled.exterior_displacement.clone(),
            traction: coupled.traction.clone(),
            constant: coupled.constant,
            balance: coupled.balance,
            radiation: medium.radiation,
            remote_stress: medium.far.remote_stress,
            remote: medium.remote(),
            field,
        }
    }

    /// Displacement and stress at a point outside of the body, the remote ones included.
    pub fn at(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let Inside { displacement, stress, .. } = self.field.at(x);
        self.with_remote(x, displacement, stress)
    }

    /// Displacement and stress on the boundary, from the medium, at the reference coordinate t of element e.
    pub fn on_boundary(&self, e: usize, t: f64) -> ([f64; 2], [f64; 3]) {
        let trace = self.field.trace(e, t);
        self.with_remote(self.mesh.point(e, t), trace.displacement, trace.stress)
    }

    /// Displacement and stress of the medium next to a point of the boundary: there the mean of both elements beside it.
    pub fn beside(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let from = |e: usize| {
            if !self.mesh.is_line(e) {
                return self.mesh.curve(e).nearest(x);
            }
            let ([a, b], d) = (self.mesh.ends(e), self.mesh.half_chord(e));
            let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
            let along = dot(minus(x, middle), d) / dot(d, d);
            let t = along.clamp(-1.0, 1.0);
            let y = self.mesh.point(e, t);
            (distance(x, y), t)
        };
        let nearest = (0..self.mesh.len()).map(|e| (from(e), e));
        let least = nearest.min_by(|((a, _), _), ((b, _), _)| a.total_cmp(b));
        let Some(((_, t), e)) = least else { return self.at(x) };
        let (displacement, stress) = self.on_boundary(e, t);
        let other = match t {
            1.0 => self.on_boundary(self.mesh.next[e], -1.0).1,
            -1.0 => self.on_boundary(self.mesh.previous()[e], 1.0).1,
            _ => stress,
        };
        (displacement, [0, 1, 2].map(|k| (stress[k] + other[k]) / 2.0))
    }

    /// A displacement and a stress at a point, with the remote ones.
    pub(crate) fn with_remote(&self, x: [f64; 2], u: [f64; 2], stress: [f64; 3]) -> ([f64; 2], [f64; 3]) {
        let remote = self.remote.displacement(x);
        ([0, 1].map(|i| u[i] + remote[i]), [0, 1, 2].map(|k| stress[k] + self.remote_stress[k]))
    }

    /// Its reported numbers.
    pub(crate) fn summary(&self) -> MediumSummary {
        let radiation = match self.radiation {
            Radiation::Decaying => "decaying",
            Radiation::Bounded => "bounded",
        };
        MediumSummary {
            radiation: radiation.into(),
            resultant: self.balance.force,
            balanced: self.balance.is_balanced(),
            constant: self.constant,
            length: self.length,
        }
    }
}

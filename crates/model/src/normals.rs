//! How much it matters for J whether contact between two bodies acts along the normals of the one or of the other.
//!
//! Surfaces that touch have one normal, which neither has where they are apart; small displacements take it from both as they are
//! drawn, d = (E₁n₁ - E₂n₂)/|…|. With another direction d' and the point y' that x meets along it, as J is stationary,
//!
//! ```text
//! J' - J = ∫ λ_n (d'·(u(x) - u(y')) - g' - d·(u(x) - u(y)) + g) + λ_t (t'·(u(x) - u(y')) - t·(u(x) - u(y))) ds
//! ```
//! to first order, g the distance along the direction.

use steklov_coupling::{Cell, Facing, Met, meet};
use steklov_quadrature::gauss_legendre;

use crate::data::Data;
use crate::fields::ElasticField;
use crate::joints::Joint;

/// Gauss points on a cell.
const POINTS: usize = 12;
/// Where the pressure is below this part of the largest one, normals do not count.
const PRESSED: f64 = 1e-3;

/// What a choice of the direction of contact decides on an interface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Normals {
    /// Largest angle between the normal of one side and that against the other where they press each other (radian).
    pub angle: f64,
    /// |J' - J''| of contact along the normals of the one side and of the other (energy per thickness): 0 of mirror images, which
    /// have no choice.
    pub change: f64,
}

/// A point of an interface that presses.
struct Pressed {
    pressure: f64,
    angle: f64,
}

impl Data<'_> {
    /// What the direction decides on an interface of contact.
    pub(crate) fn normals(&self, joint: &Joint, field: ElasticField<'_>) -> Normals {
        let moduli = self.moduli();
        // the normals of one side are those of contact with a partner that gives way to it
        let alone = |sides: &[usize]| -> Vec<f64> {
            let of = |e: usize| if sides.contains(&e) { 1.0 } else { 0.0 };
            (0..self.mesh.len()).map(of).collect()
        };
        let directions = [moduli, alone(&joint.own), alone(&joint.other)];
        let (mut change, mut pressed) = ([0.0; 2], Vec::new());
        for cell in &joint.cells {
            let of_cell = self.normals_of_cell(cell, &directions, field, &mut pressed);
            (0..2).for_each(|k| change[k] += of_cell[k]);
        }
        let largest = pressed.iter().fold(0.0, |m: f64, p| m.max(p.pressure));
        let counts = pressed.iter().filter(|p| p.pressure > PRESSED * largest);
        Normals { angle: counts.fold(0.0, |m, p| m.max(p.angle)), change: (change[0] - change[1]).abs() }
    }

    /// J' - J of both other directions on a cell.
    fn normals_of_cell(
        &self,
        cell: &Cell,
        directions: &[Vec<f64>; 3],
        field: ElasticField<'_>,
        pressed: &mut Vec<Pressed>,
    ) -> [f64; 2] {
        let Cell { element: e, span, other: m } = *cell;
        let (half, rule) = ((span[1] - span[0]) / 2.0, gauss_legendre(POINTS));
        let mut change = [0.0; 2];
        for (&g, &w) in rule.points.iter().zip(&rule.weights) {
            let t = span[0] + half * (1.0 + g);
            let (here, pull) = (field.on_boundary(e, t).0, field.traction(e, t));
            let met = directions.each_ref().map(|modulus| {
                let side = Facing { mesh: self.mesh, space: self.space, elements: &[], modulus };
                let Met { t: s, distance, direction } = meet(side, (e, t), side, m)?;
                let beyond = field.on_boundary(m, s.clamp(-1.0, 1.0)).0;
                let apart = [here[0] - beyond[0], here[1] - beyond[1]];
                Some((direction, dot(apart, direction) - distance, cross(direction, apart)))
            });
            let [Some((d, normal, tangential)), first, second] = met else { continue };
            let (pressure, shear) = (-dot(pull, d), -cross(d, pull));
            if pressure <= 0.0 {
                continue;
            }
            let ds = half * w * self.mesh.speed(e, t);
            for (change, other) in change.iter_mut().zip([first, second]) {
                let Some((_, n, t)) = other else { continue };
                *change += ds * (pressure * (n - normal) + shear * (t - tangential));
            }
            if let (Some((a, ..)), Some((b, ..))) = (first, second) {
                pressed.push(Pressed { pressure, angle: cross(a, b).atan2(dot(a, b)).abs() });
            }
        }
        change
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

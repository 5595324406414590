//! Linear functionals of the field of a boundary.
//!
//! ```text
//! J(u, ψ) = Σ_e Σ_n (a_n·û_n + d_n·û'_n + b_n·ψ_n) + c·a       û, û', ψ Legendre coefficients of u, du/dt and the traction on an element
//! ```
//! Of the enriched spaces they are known by their values of the nodal functions and bubbles, and of the tractions: the right side of the
//! dual problem.

use num_complex::Complex64;
use steklov_quadrature::legendre_p;

use crate::near::MAX_ORDER;
use crate::potential::AtPoint;
use crate::{BoundaryField, Enriched, Space, Trace};

/// A linear functional of displacement and traction on a boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct Functional {
    elements: Vec<Weights>,
    /// c, of the constant a at infinity.
    constant: [f64; 2],
}

/// The weights of the coefficients of an element; none where they are 0.
#[derive(Debug, Clone, Default, PartialEq)]
struct Weights {
    displacement: Vec<[f64; 2]>,
    derivative: Vec<[f64; 2]>,
    traction: Vec<[f64; 2]>,
}

impl Functional {
    /// 0, for the fields of a boundary of that many elements.
    pub fn zero(elements: usize) -> Self {
        Self { elements: vec![Weights::default(); elements], constant: [0.0; 2] }
    }

    /// The sum of functionals of one boundary, times these factors.
    ///
    /// # Panics
    /// Without functionals.
    pub fn sum(all: &[Self], factors: &[f64]) -> Self {
        let mut sum = Self::zero(all[0].elements.len());
        for (functional, &factor) in all.iter().zip(factors).filter(|(_, factor)| **factor != 0.0) {
            for (own, weights) in sum.elements.iter_mut().zip(&functional.elements) {
                own.add(factor, &weights.displacement, 0);
                own.add(factor, &weights.derivative, 1);
                own.add(factor, &weights.traction, 2);
            }
            (0..2).for_each(|i| sum.constant[i] += factor * functional.constant[i]);
        }
        sum
    }

    /// Adds the values of a field at the reference coordinate t of element e, times these weights: Σ over displacement, traction and stress.
    pub fn add_trace(&mut self, field: &BoundaryField, (e, t): (usize, f64), by: &Trace) {
        let piece = &field.elements[e];
        let mut p = [0.0; MAX_ORDER];
        let p = &mut p[..piece.displacement.len()];
        legendre_p(t, p);
        let slope = piece.curve.derivative(t);
        let speed = slope.norm();
        // stress of a unit traction, and of a unit derivative by arc length
        let of = |traction, along| field.boundary_stress(slope / speed, traction, along);
        let weighted = |stress: [f64; 3]| stress.iter().zip(&by.stress).map(|(s, w)| s * w).sum::<f64>();
        let units = [[1.0, 0.0], [0.0, 1.0]];
        let traction = [0, 1].map(|i| (by.traction[i] + weighted(of(units[i], [0.0; 2]))) * piece.half / speed);
        let along = [0, 1].map(|i| weighted(of([0.0; 2], units[i])) / speed);
        let weights = &mut self.elements[e];
        add_all(&mut weights.displacement, p, by.displacement);
        add_all(&mut weights.derivative, &p[..piece.derivative.len()], along);
        add_all(&mut weights.traction, &p[..piece.traction.len()], traction);
    }

    /// Its value of a field of the same boundary, of degrees that are not higher; the motion of that is left out.
    pub fn of(&self, field: &BoundaryField) -> f64 {
        let sum = |w: &[[f64; 2]], c: &[[f64; 2]]| w.iter().zip(c).map(|(w, c)| w[0] * c[0] + w[1] * c[1]).sum::<f64>();
        let on = |(w, piece): (&Weights, &crate::potential::Piece)| {
            sum(&w.displacement, &piece.displacement)
                + sum(&w.derivative, &piece.derivative)
                + sum(&w.traction, &piece.traction)
        };
        let of_constant = sum(&[self.constant], &[field.at_infinity()]);
        self.elements.iter().zip(&field.elements).map(on).sum::<f64>() + of_constant
    }

    /// The same functional with other weights c of the constant at infinity.
    pub fn with_constant(self, constant: [f64; 2]) -> Self {
        Self { constant, ..self }
    }

    /// Its weights c of the constant at infinity.
    pub fn of_constant(&self) -> [f64; 2] {
        self.constant
    }

    /// Its values of the functions of the enriched spaces of a space of one degree less than its own: of displacements, and of tractions.
    pub fn enriched(&self, space: &Space) -> [Enriched; 2] {
        let zero = || Enriched { base: vec![0.0; space.dofs()], extra: vec![0.0; 2 * self.elements.len()] };
        let [mut displacement, mut traction] = [zero(), zero()];
        for (e, weights) in self.elements.iter().enumerate() {
            let basis = space.basis(e);
            let p = basis.degree;
            let at = |of: &[[f64; 2]], n: usize, i: usize| of.get(n).map_or(0.0, |w| w[i]);
            for i in 0..2 {
                for (j, node) in space.element_nodes(e).enumerate() {
                    let nodal: f64 = (0..=p).map(|n| basis.to_legendre[(n, j)] * at(&weights.displacement, n, i)).sum();
                    let slope: f64 =
                        (0..p).map(|n| basis.derivative_to_legendre[(n, j)] * at(&weights.derivative, n, i)).sum();
                    displacement.base[2 * node + i] += nodal + slope;
                }
                // (P_(p+1) - P_(p-1))/(2p+1), whose derivative is P_p
                let bubble = at(&weights.displacement, p + 1, i) - at(&weights.displacement, p - 1, i);
                displacement.extra[2 * e + i] = bubble / (2 * p + 1) as f64 + at(&weights.derivative, p, i);
                (0..p).for_each(|n| traction.base[2 * (space.offset[e] + n) + i] = at(&weights.traction, n, i));
                traction.extra[2 * e + i] = at(&weights.traction, p, i);
            }
        }
        [displacement, traction]
    }
}

/// Adds P_n times a weight to all coefficients.
fn add_all(weights: &mut Vec<[f64; 2]>, p: &[f64], by: [f64; 2]) {
    if by == [0.0; 2] {
        return;
    }
    weights.resize(p.len().max(weights.len()), [0.0; 2]);
    weights.iter_mut().zip(p).for_each(|(w, p)| (0..2).for_each(|i| w[i] += p * by[i]));
}

impl Weights {
    /// The weights of the coefficients of the displacement, its derivative, or the traction.
    fn of(&mut self, kind: usize) -> &mut Vec<[f64; 2]> {
        match kind {
            0 => &mut self.displacement,
            1 => &mut self.derivative,
            _ => &mut self.traction,
        }
    }

    /// Adds a factor times weights of one kind.
    fn add(&mut self, factor: f64, weights: &[[f64; 2]], kind: usize) {
        let own = self.of(kind);
        own.resize(weights.len().max(own.len()), [0.0; 2]);
        own.iter_mut().zip(weights).for_each(|(own, w)| (0..2).for_each(|i| own[i] += factor * w[i]));
    }
}

impl BoundaryField {
    /// Displacement x, y and stress xx, yy, xy at a point inside the body (not on the boundary) as functionals of fields of these degrees.
    ///
    /// *Cost*: one Legendre function each and 50 multiplications for each of the coefficients.
    pub fn functionals_inside(&self, x: [f64; 2]) -> [Functional; 5] {
        let x = Complex64::new(x[0], x[1]);
        let mut all = [(); 5].map(|()| Functional::zero(self.elements.len()));
        (0..2).for_each(|i| all[i].constant[i] = 1.0);
        let mut at = AtPoint::default();
        for (e, piece) in self.elements.iter().enumerate() {
            at.at_distance(piece, x);
            let counts = [piece.displacement.len(), piece.derivative.len(), piece.traction.len()];
            for (kind, count) in counts.into_iter().enumerate() {
                all.iter_mut().for_each(|of| of.elements[e].of(kind).resize(count, [0.0; 2]));
                for (n, i) in (0..count).flat_map(|n| [(n, 0), (n, 1)]) {
                    let mut unit = [0.0; 2];
                    unit[i] = 1.0;
                    let (mut u, mut gradient) = ([0.0; 2], [[0.0; 2]; 2]);
                    match kind {
                        0 => at.add_double(n, unit, &mut u),
                        1 => piece.add_terms(&self.constants, &at, n, ([0.0; 2], unit), (&mut u, &mut gradient)),
                        _ => piece.add_terms(&self.constants, &at, n, (unit, [0.0; 2]), (&mut u, &mut gradient)),
                    }
                    let [xx, yy, xy] = self.material().stress(gradient);
                    let values = [u[0], u[1], xx, yy, xy];
                    all.iter_mut().zip(values).for_each(|(of, value)| of.elements[e].of(kind)[n][i] = value);
                }
            }
        }
        all
    }
}

//! Residuals of a solution in the equations on the interface, boundary element by boundary element.

use rayon::prelude::*;
use steklov_bem_operators::BoundaryField;
use steklov_msfem::HeterogeneousBody;
use steklov_quadrature::{Rule, gauss_legendre, legendre_p, substituted};

use crate::body_side::{Body, derivative};
use crate::far::Split;
use crate::subdivided::Subdivided;
use crate::transfer::Overlap;
use crate::{Coupled, CouplingError, Form, Medium};

/// The jumps on the interface, as functions.
#[derive(Clone, Copy)]
pub struct Jumps<'a> {
    /// u0(x) (length).
    pub displacement: &'a (dyn Fn([f64; 2]) -> [f64; 2] + Sync),
    /// t0(x, n) (stress), n out of the body.
    pub traction: &'a (dyn Fn([f64; 2], [f64; 2]) -> [f64; 2] + Sync),
    /// How often an element is halved before u0 is interpolated on it: 0 takes the nodal values that
    /// [`crate::Transmission::solve`] is given for u0; 2 sees the error of that interpolation; 5 at most.
    pub halvings: usize,
}

/// The residuals on the interface of each boundary element of length h and degree p, as squares of energies (force times
/// length per thickness).
///
/// ```text
/// two fields    traction       h/p ‖E₁^-½ (t0 - σ(u)n - W ξ - (K' - ½) φ)‖²,    ξ = u - u0
/// three fields  traction       h/p ‖E₁^-½ (t0 - σ(u)n + φ)‖²
///               hypersingular  h/(p E₂) ‖W ξ + (K' + ½) φ‖²
/// both          displacement   h E₂/p ‖d/ds (u0 - u + (K + ½) ξ - V φ)‖²
/// ```
/// with E₁ of the cell at the place, E₂ of the medium. ‖r‖² is h times the mean of |r̄_k|², where r̄_k are averages against hats
/// on 4p equal parts of the element, or on twice as many parts as it has sides of cells, if that is more.
///
/// The root of the sum with [`crate::CellIndicators`] was measured as 3.9 to 4.4 times the error where the body is as stiff as
/// the medium or stiffer. For a body 50 times softer it was 5.6 to 9.3 times with two halvings: the interpolation error of u0
/// is of higher order, but E₂ multiplies it.
///
/// *Use when* the body conforms on its grid. *Fails when* it is much softer than the medium: 1/E₁ then overestimates
/// tractions. *Cost*: 26 points an element (p = 1); no matrix. 8 points represent the contribution of distant elements, so
/// that one core takes 0.1 s for 256 elements, and 11 times as long with two halvings. Parallel over elements, the same bits
/// for any number of threads.
///
/// Source: Carstensen, *A posteriori error estimate for the symmetric coupling of finite elements and boundary elements*,
/// 1996, with moduli as weights; Issaoui (2014), theorem 5.6, for three fields.
#[derive(Debug, Clone, PartialEq)]
pub struct InterfaceIndicators {
    /// Balance of tractions.
    pub traction: Vec<f64>,
    /// First equation of the medium and jump of displacements.
    pub displacement: Vec<f64>,
    /// Second equation of the medium; None where it is part of the balance of tractions.
    pub hypersingular: Option<Vec<f64>>,
    /// Σ ⟨w, P_m⟩²/⟨V P_m, P_m⟩ over m = p, p + 1, w = u0 - u + (K + ½) ξ - V φ, P_m the Legendre polynomials of the two
    /// lowest degrees that φ lacks: the gain of energy by two degrees more, on each element by itself. It follows ‖φ - V⁻¹(K -
    /// ½)ξ‖² in the norm of V, the error of φ for this ξ, without a constant: the root of its sum was measured as 0.86 to 1.08
    /// times that for p = 1 to 4. It is not part of the sum of residuals.
    pub traction_error: Vec<f64>,
}

impl InterfaceIndicators {
    /// The residuals of a solution on a grid; `fine` is the displacement (length) of all nodes of the grid, for multiscale
    /// elements as [`steklov_msfem::Multiscale::downscale`] brings it back.
    ///
    /// # Errors
    /// [`CouplingError::Boundary`] for a medium around another body, [`CouplingError::Inconsistent`] for fields of another size,
    /// values that are not finite, or too many halvings, and as [`crate::Outline::new`].
    pub fn new(
        medium: &Medium,
        body: &HeterogeneousBody,
        fine: &[f64],
        solved: &Coupled,
        form: Form,
        jumps: &Jumps<'_>,
    ) -> Result<Self, CouplingError> {
        check(medium, solved, jumps)?;
        check_field("displacement of the grid", fine, body.grid.dofs())?;
        let body = Body::new(body, fine)?;
        let three = form == Form::ThreeField;
        let parts = Subdivided::new(&medium.mesh, jumps.halvings);
        let jump = parts.space.interpolate(jumps.displacement);
        if let Some((k, value)) = jump.iter().enumerate().find(|(_, u)| !u.is_finite()) {
            let [x, y] = parts.space.points[k / 2];
            let what = format!("the jump of displacements is {value} at ({x}, {y}): it must be finite");
            return Err(CouplingError::Inconsistent { what });
        }
        let xi = if three {
            parts.displacement(&medium.space, &solved.exterior_displacement)
        } else {
            let trace = parts.displacement(&medium.space, &solved.trace);
            trace.iter().zip(&jump).map(|(u, u0)| u - u0).collect()
        };
        let phi = parts.traction(&medium.space, &solved.traction);
        let (material, length) = (&medium.material, medium.operators.length);
        let field = BoundaryField::new(&parts.mesh, &parts.space, material, &xi, &phi, length);
        let residual = Residual { medium, body, jumps, parts, jump, field, three };
        let all: Vec<_> = (0..medium.mesh.len()).into_par_iter().map(|e| residual.element(e)).collect();
        let all: Vec<[f64; 4]> = all.into_iter().collect::<Result<_, _>>()?;
        let term = |k: usize| all.iter().map(|terms| terms[k]).collect::<Vec<f64>>();
        Ok(Self {
            traction: term(0),
            displacement: term(1),
            hypersingular: three.then(|| term(2)),
            traction_error: term(3),
        })
    }

    /// The sum of the residuals of each element, without the estimate of the error of the traction.
    pub fn squared(&self) -> Vec<f64> {
        let hypersingular = |e: usize| self.hypersingular.as_ref().map_or(0.0, |t| t[e]);
        let sum = |e: usize| self.traction[e] + self.displacement[e] + hypersingular(e);
        (0..self.traction.len()).map(sum).collect()
    }
}

/// Checks that the fields of a solution fit the boundary elements and are finite, and that the halvings are not too many.
fn check(medium: &Medium, solved: &Coupled, jumps: &Jumps<'_>) -> Result<(), CouplingError> {
    let needed = medium.space.dofs();
    check_field("displacement on the interface", &solved.trace, needed)?;
    check_field("displacement of the medium", &solved.exterior_displacement, needed)?;
    check_field("traction of the medium", &solved.traction, needed)?;
    if jumps.halvings > MOST_HALVINGS {
        let what = format!("each element is to be halved {} times: at most {MOST_HALVINGS}", jumps.halvings);
        return Err(CouplingError::Inconsistent { what });
    }
    Ok(())
}

fn check_field(name: &str, values: &[f64], needed: usize) -> Result<(), CouplingError> {
    if values.len() != needed {
        return Err(CouplingError::Inconsistent {
            what: format!("the {name} has {} values, not {needed}", values.len()),
        });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(k) => Err(CouplingError::Inconsistent {
            what: format!("value {k} of the {name} is {}: it must be finite", values[k]),
        }),
        None => Ok(()),
    }
}

/// Halvings of an element: 32 parts.
const MOST_HALVINGS: usize = 5;
/// Gauss points next to a logarithm, in the variable that tames it, and elsewhere.
const POINTS: [usize; 2] = [8, 5];
/// Power of the variable that tames logarithms.
const POWER: u32 = 4;
/// Breaks closer than this on the reference element are one.
const SAME: f64 = 1e-9;

/// The data that the residuals at a point need.
struct Residual<'a> {
    medium: &'a Medium,
    body: Body<'a>,
    jumps: &'a Jumps<'a>,
    parts: Subdivided,
    /// u0 at the nodes of the parts.
    jump: Vec<f64>,
    field: BoundaryField,
    three: bool,
}

/// Residuals at a point: E₁^-½ times that of tractions, E₂^½ d/ds w, E₂^-½ times the hypersingular one.
type Values = [[f64; 2]; 3];

impl Residual<'_> {
    /// Traction, displacement, hypersingular, error of the traction of an element.
    fn element(&self, e: usize) -> Result<[f64; 4], CouplingError> {
        let overlaps = self.body.overlaps(&self.medium.mesh, e)?;
        let (h, p) = (self.medium.mesh.length(e), self.medium.space.degree(e));
        let count = (4 * p).max((2 * overlaps.len()).next_multiple_of(4));
        let knot = |k: usize| 2.0 * k as f64 / count as f64 - 1.0;
        let mut averages = vec![Values::default(); count + 1];
        let mut moments = [[0.0; 2]; 2];
        let mut legendre = vec![0.0; p + 3];
        let all = Split::new(&self.field, &self.parts, &self.medium.mesh, e);
        for (rule, part) in self.rules(e, count, &overlaps) {
            for (&t, w) in rule.points.iter().zip(&rule.weights) {
                let values = self.at(e, part, t, &overlaps, &all)?;
                // the two hats at t; those of the ends count for nothing
                let k = (((t + 1.0) / 2.0 * count as f64) as usize).min(count - 1);
                let right = (t - knot(k)) / (knot(k + 1) - knot(k));
                for (hat, k) in [(1.0 - right, k), (right, k + 1)] {
                    for (sum, value) in averages[k].iter_mut().zip(values) {
                        (0..2).for_each(|i| sum[i] += 0.5 * count as f64 * w * hat * value[i]);
                    }
                }
                legendre_p(t, &mut legendre);
                // P_m integrated by parts
                for (m, moment) in (p..).zip(&mut moments) {
                    (0..2).for_each(|i| moment[i] += w * values[1][i] * (legendre[m - 1] - legendre[m + 1]));
                }
            }
        }
        let squared = |k: usize| {
            let sum: f64 = averages[1..count].iter().map(|a| a[k][0].powi(2) + a[k][1].powi(2)).sum();
            h * h / p as f64 * sum / (count - 1) as f64
        };
        // ⟨V P_m, P_m⟩ = κ/(8πμ(1-ν)) (h/2)² 2/(m(m+1)): only the logarithm acts
        let material = &self.medium.material;
        let single = material.kappa() / (8.0 * std::f64::consts::PI * material.mu() * (1.0 - material.nu()));
        let gain = |(m, moment): (usize, [f64; 2])| {
            let squared = (moment[0].powi(2) + moment[1].powi(2)) / material.young;
            0.125 * h * h * (m * (m + 1)) as f64 * squared / (single * ((2 * m + 1) as f64).powi(2))
        };
        let error = (p..).zip(moments).map(gain).sum();
        Ok([squared(0), squared(1), squared(2), error])
    }

    /// Rules on the pieces between the breaks of an element, and the part of it on which each lies.
    fn rules(&self, e: usize, count: usize, overlaps: &[Overlap]) -> Vec<(Rule, usize)> {
        let parts = self.parts.parts(e);
        let equal = |n: usize| (0..=n).map(move |k| 2.0 * k as f64 / n as f64 - 1.0);
        let mut breaks: Vec<f64> = equal(count).chain(equal(parts)).collect();
        breaks.extend(overlaps.iter().flat_map(|o| o.span));
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|b, a| *b - *a < SAME);
        let p = self.medium.space.degree(e);
        let (tamed, smooth) = (substituted(POINTS[0] + p / 2, POWER), gauss_legendre(POINTS[1] + p / 2));
        // from the end with the logarithm to the other one
        let towards = |end: f64, other: f64| Rule {
            points: tamed.points.iter().map(|s| end + (other - end) * s).collect(),
            weights: tamed.weights.iter().map(|w| (other - end).abs() * w).collect(),
            degree: tamed.degree,
        };
        let mut rules = Vec::new();
        for ends in breaks.windows(2) {
            let [a, b] = [ends[0], ends[1]];
            let middle = (a + b) / 2.0;
            let part = (((middle + 1.0) / 2.0 * parts as f64) as usize).min(parts - 1);
            let [start, end] = [part, part + 1].map(|j| 2.0 * j as f64 / parts as f64 - 1.0);
            // the nearer the logarithm of the part's end, the more it is felt
            match [a - start < (b - a) * (1.0 - SAME), end - b < (b - a) * (1.0 - SAME)] {
                [false, false] => rules.push((smooth.mapped(a, b), part)),
                [true, false] => rules.push((towards(a, b), part)),
                [false, true] => rules.push((towards(b, a), part)),
                [true, true] => rules.extend([(towards(a, middle), part), (towards(b, middle), part)]),
            }
        }
        rules
    }

    /// The residuals at the point t of an element, which lies on this part of it.
    fn at(&self, e: usize, part: usize, t: f64, overlaps: &[Overlap], all: &Split) -> Result<Values, CouplingError> {
        let (mesh, young) = (&self.medium.mesh, self.medium.material.young);
        let side = self.body.at(t, overlaps);
        let (x, n) = (mesh.point(e, t), mesh.normal(e, t));
        let given = (self.jumps.traction)(x, n);
        if let Some(value) = given.iter().find(|v| !v.is_finite()) {
            let what = format!("the jump of tractions is {value} at ({}, {}): it must be finite", x[0], x[1]);
            return Err(CouplingError::Inconsistent { what });
        }
        let child = self.parts.first[e] + part;
        let s = self.parts.parts(e) as f64 * (t + 1.0) - (2 * part + 1) as f64;
        let (hypersingular, slope) = all.at(&self.field, t, child, s);
        let phi = self.field.trace(child, s).traction;
        let jump = derivative(&self.parts.mesh, &self.parts.space, child, s, &self.jump);
        let mut values = Values::default();
        for i in 0..2 {
            // W ξ + (K' - ½) φ = W ξ + (K' + ½) φ - φ
            let outside = if self.three { 0.0 } else { hypersingular[i] };
            values[0][i] = (given[i] - side.traction[i] + phi[i] - outside) / side.young.sqrt();
            values[1][i] = (jump[i] - side.slope[i] + slope[i]) * young.sqrt();
            values[2][i] = hypersingular[i] / young.sqrt();
        }
        Ok(values)
    }
}

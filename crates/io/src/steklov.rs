//! [`Persist`] for the Steklov-Poincaré matrix with its traction map, and for its condensation.
//!
//! Both are stored with their factors and read by the checked constructors of `steklov-bem-operators`: nothing is
//! factorised again, and answers have the same bits.

use faer::{Mat, MatRef};
use hdf5::Group;
use steklov_bem_operators::{BemError, Condensation, CondensationParts, Domain, Steklov, TractionParts, Translations};

use crate::array::{load_integers, load_points, load_vector, save_integers, save_points, save_vector};
use crate::bem_operators::{DISPLACEMENT, TRACTION};
use crate::dataset::label;
use crate::error::{IoError, invalid, write_error};
use crate::matrix::{load_dense, save_dense};
use crate::persist::Persist;
use crate::quadrature::{check_length, load_sized};
use crate::text::{load_text, save_text};

/// The error at the part that does not fit.
pub(crate) fn misfit(at: &Group, error: BemError) -> IoError {
    match error {
        BemError::Part { part, what } => invalid(at, part, what),
        other => invalid(at, "", other),
    }
}

/// Largest rounding error of the entries of a form, over the roots of the diagonals.
const SAME: f64 = 1e-10;

/// Demands that a stored matrix equals the one computed from its parts, up to rounding of `scale(i, j)`.
pub(crate) fn check_same(
    at: &Group,
    name: &str,
    made: MatRef<'_, f64>,
    scale: impl Fn(usize, usize) -> f64,
) -> Result<(), IoError> {
    let stored = load_sized(at, name, made.nrows(), made.ncols())?;
    for (i, j) in (0..made.nrows()).flat_map(|i| (0..made.ncols()).map(move |j| (i, j))) {
        let (found, wanted) = (stored[(i, j)], made[(i, j)]);
        let difference = (found - wanted).abs();
        if difference.is_nan() || difference > SAME * scale(i, j) {
            return Err(invalid(at, name, format!("it is {found} at ({i}, {j}), its parts make {wanted}")));
        }
    }
    Ok(())
}

/// Names of the domains.
const DOMAINS: [(&str, Domain); 4] = [
    ("interior", Domain::Interior),
    ("exterior", Domain::Exterior),
    ("bounded at infinity", Domain::BoundedAtInfinity),
    ("exterior, bounded at infinity", Domain::ExteriorBoundedAtInfinity),
];

impl Persist for Steklov {
    const KIND: &'static str = "Steklov-Poincare matrix";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let TractionParts { domain, factor, solved, translations } = self.traction.parts();
        let meaning =
            "S = W + H^T V^-1 H, symmetric; t = S u, exterior t = -S u; S u less what a constant at infinity takes";
        save_dense(at, "S", self.matrix.as_ref(), &label("stress", meaning, &[DISPLACEMENT, DISPLACEMENT]))?;
        let meaning = "lower triangle: L of V = L L^T, length/stress^(1/2); above the diagonal: V, length^2/stress";
        save_dense(at, "factor", factor.as_ref(), &label("length/stress^(1/2)", meaning, &[TRACTION, TRACTION]))?;
        let meaning =
            "X = L^-1 H, H = M/2 + K, exterior M/2 - K; S = W + X^T X; where there is a basis Q, less Q Q^T X";
        save_dense(at, "solved", solved.as_ref(), &label("stress^(1/2)", meaning, &[TRACTION, DISPLACEMENT]))?;
        let name = DOMAINS.iter().find(|(_, d)| d == domain).map_or("", |(name, _)| name);
        save_text(
            at,
            "domain",
            name,
            "where the body lies, and whether its displacement tends to a constant at infinity",
        )?;
        if let Some(Translations { basis, constant }) = translations {
            let meaning = "Q of L^-1 H 1 = Q R, 1 the two translations: Q^T Q = 1";
            save_dense(at, "basis", basis.as_ref(), &label("1", meaning, &[TRACTION, "column"]))?;
            let meaning = "a = R^-1 Q^T L^-1 H u, the displacement at infinity; that of a translation is itself";
            save_dense(at, "constant", constant.as_ref(), &label("1", meaning, &["component", DISPLACEMENT]))?;
        }
        Ok(())
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let name = load_text(at, "domain")?;
        let domain = DOMAINS.iter().find(|(known, _)| *known == name).map(|(_, domain)| *domain);
        let domain = domain.ok_or_else(|| invalid(at, "domain", format!("{name:?} is none")))?;
        let translations = match domain {
            Domain::Interior | Domain::Exterior => None,
            _ => Some(Translations { basis: load_dense(at, "basis")?, constant: load_dense(at, "constant")? }),
        };
        if translations.is_none() && at.link_exists("basis") {
            return Err(invalid(at, "domain", format!("{name:?} has no basis of translations")));
        }
        let parts = TractionParts {
            domain,
            factor: load_dense(at, "factor")?,
            solved: load_dense(at, "solved")?,
            translations,
        };
        Steklov::from_parts(load_dense(at, "S")?, parts).map_err(|e| misfit(at, e))
    }
}

const ELIMINATED: &str = "eliminated unknown";
const KEPT: &str = "kept unknown";
const POSITION: &str = "unknown: eliminated, kept, held";

impl Persist for Condensation {
    const KIND: &'static str = "condensed Steklov-Poincare matrix";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let CondensationParts { matrix, diagonal, order, eliminated: r, kept: k, held, frames } = self.parts();
        let (r, k, n) = (*r, *k, order.len());
        let unknowns =
            |name, part: &[usize], meaning, axis| save_integers(at, name, part, &label("1", meaning, &[axis]));
        unknowns("eliminated", &order[..r], "unknowns R, 2 node + component", ELIMINATED)?;
        unknowns("kept", &order[r..r + k], "unknowns K, in the order of the condensed system", KEPT)?;
        unknowns("held", &order[r + k..], "unknowns H with a prescribed value", "held unknown")?;
        save_vector(at, "held_values", held, &label("length", "prescribed values u_H", &["held unknown"]))?;
        let nodes: Vec<usize> = frames.iter().map(|f| f.0).collect();
        unknowns("frame_nodes", &nodes, "nodes whose unknowns are taken along other directions than x, y", "frame")?;
        let directions: Vec<[f64; 2]> = frames.iter().flat_map(|f| f.1).collect();
        let meaning = "the first direction of each of these nodes, then the second, orthonormal";
        save_points(at, "frames", &directions, &label("1", meaning, &["frame and direction", "xy"]))?;

        let entry = |i: usize, j: usize| if i == j { diagonal[i] } else { matrix[(i.min(j), i.max(j))] };
        let meaning =
            "S in this order and these directions, with a spring against each rigid motion that nothing resists";
        save_dense(at, "S", Mat::from_fn(n, n, entry).as_ref(), &label("stress", meaning, &[POSITION, POSITION]))?;
        let factor = Mat::from_fn(r, r, |i, j| if i < j { 0.0 } else { matrix[(i, j)] });
        let meaning = "L of S_RR = L L^T, 0 above the diagonal; u_R = L^-T (y - C^T u_K), y = L^-1 (f_R - S_RH u_H)";
        save_dense(at, "L", factor.as_ref(), &label("stress^(1/2)", meaning, &[ELIMINATED, ELIMINATED]))?;
        let meaning = "C = S_KR L^-T; the condensed load is f_K - S_KH u_H - C y";
        let coupling = matrix.as_ref().submatrix(r, 0, k, r);
        save_dense(at, "coupling", coupling, &label("stress^(1/2)", meaning, &[KEPT, ELIMINATED]))?;
        let condensed = self.stiffness().map_err(|e| write_error(at, "condensed", e))?;
        let meaning = "S_c = S_KK - C C^T = S_KK - S_KR S_RR^-1 S_RK";
        save_dense(at, "condensed", condensed.as_ref(), &label("stress", meaning, &[KEPT, KEPT]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (mut order, kept) = (load_integers(at, "eliminated")?, load_integers(at, "kept")?);
        let (r, k) = (order.len(), kept.len());
        order.extend(kept);
        order.extend(load_integers(at, "held")?);
        let n = order.len();
        let held = load_vector(at, "held_values")?;
        check_length(at, "held_values", held.len(), n - r - k)?;
        let (nodes, directions) = (load_integers(at, "frame_nodes")?, load_points(at, "frames")?);
        if nodes.len().checked_mul(2) != Some(directions.len()) {
            return Err(invalid(at, "frames", format!("{} directions of {} nodes", directions.len(), nodes.len())));
        }
        let frames = nodes.into_iter().zip(directions.chunks_exact(2)).map(|(node, d)| (node, [d[0], d[1]])).collect();

        let mut matrix = load_sized(at, "S", n, n)?;
        for (i, j) in (0..n).flat_map(|j| (0..j).map(move |i| (i, j))) {
            if matrix[(i, j)] != matrix[(j, i)] {
                let what = format!("it is {} at ({i}, {j}), {} at ({j}, {i})", matrix[(i, j)], matrix[(j, i)]);
                return Err(invalid(at, "S", what));
            }
        }
        let diagonal: Vec<f64> = (0..n).map(|i| matrix[(i, i)]).collect();
        let (factor, coupling) = (load_sized(at, "L", r, r)?, load_sized(at, "coupling", k, r)?);
        for (i, j) in (0..r).flat_map(|j| (0..r).map(move |i| (i, j))) {
            match i < j {
                true if factor[(i, j)] != 0.0 => {
                    return Err(invalid(
                        at,
                        "L",
                        format!("it is {} at ({i}, {j}), above the diagonal", factor[(i, j)]),
                    ));
                }
                true => {}
                false => matrix[(i, j)] = factor[(i, j)],
            }
        }
        matrix.as_mut().submatrix_mut(r, 0, k, r).copy_from(&coupling);
        let parts = CondensationParts { matrix, diagonal, order, eliminated: r, kept: k, held, frames };
        let condensation = Condensation::from_parts(parts).map_err(|e| misfit(at, e))?;
        let made = condensation.stiffness().map_err(|e| invalid(at, "condensed", e))?;
        let size = |i: usize| condensation.parts().diagonal[r + i].max(0.0).sqrt();
        check_same(at, "condensed", made.as_ref(), |i, j| size(i) * size(j))?;
        Ok(condensation)
    }
}

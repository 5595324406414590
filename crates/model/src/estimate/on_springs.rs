//! Elements that springs practically hold, and bodies that springs let move too far.

use crate::solve::body::Body;
use crate::solve::solution::Solved;

/// Rounding error of the strain energy of a body that turns on soft springs, as a part of the largest stiffness of a node
/// times its displacement squared: nodal values of rotations on curves are no motions of S; 1.1e-14 was seen for a disc.
pub(crate) const ROUNDED_TURNING: f64 = 2e-14;
/// Largest part of the strain energy that may be rounding.
const ROUNDED_STRAIN: f64 = 1e-3;

/// Whether springs let a body move so far that its strain energy is rounding.
pub(crate) fn turns_too_far(solved: &Solved, body: &Body) -> bool {
    let largest = body.settled(&solved.displacement).iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let rounded = ROUNDED_TURNING * body.largest_diagonal * largest * largest;
    !body.springs.is_empty() && rounded > ROUNDED_STRAIN * solved.energies.strain
}

/// How far springs hold the bubble of an element, from 0 to 1: the smallest part that M has in its stiffness W + M.
pub(crate) fn held_by_springs(w: [[f64; 2]; 2], m: [[f64; 2]; 2]) -> f64 {
    let (mean, half) = ((m[0][0] + m[1][1]) / 2.0, (m[0][0] - m[1][1]) / 2.0);
    let least = (mean - half.hypot(m[0][1])).max(0.0);
    let elastic = w[0][0].max(w[1][1]);
    if least > 0.0 { least / (least + elastic) } else { 0.0 }
}

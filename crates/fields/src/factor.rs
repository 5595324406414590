//! The largest factor at which displacements may be drawn.

use steklov_elastic::plane::{cross, distance, minus, norm};
use steklov_model::solve::contact_rows::ContactRow;
use steklov_model::solve::solution::TieRow;
use steklov_model::summary::InterfaceSummary;
use steklov_picture::Largest;
use steklov_unstructured::Grid;

use crate::medium::body_part;

/// Distances and overlaps of bodies below this part of their extent are hardly visible.
const HARDLY_SEEN: f64 = 4e-3;
/// Folds as long as this part of the extent are hardly visible.
const FOLD: f64 = 1e-3;
/// Points closer than this part of the extent coincide.
const ONE: f64 = 1e-9;

/// A deformed body, or several: what limits the factor of their displacements.
#[derive(Debug, Clone, Copy)]
pub struct Deformed<'a> {
    /// Nodes of the boundary.
    pub points: &'a [[f64; 2]],
    /// Displacement there.
    pub displacement: &'a [[f64; 2]],
    /// Names of the sides.
    pub side_names: &'a [String],
    /// Interfaces between bodies.
    pub interfaces: &'a [InterfaceSummary],
    /// Rows of the contact table.
    pub contact: &'a [ContactRow],
    /// Rows of the tables of ties.
    pub ties: &'a [TieRow],
    /// The fields.
    pub grid: &'a Grid,
}

/// The largest factor k of displacements at which touching bodies visibly touch, other bodies do not overlap, and no
/// visible part of a body is folded over.
pub fn largest_factor(deformed: &Deformed<'_>) -> Largest {
    let extent = |i: usize| {
        let along = || deformed.points.iter().map(|x| x[i]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let extent = extent(0).max(extent(1));
    let between_bodies = of_contact(deformed, HARDLY_SEEN * extent).min(of_ties(deformed, extent));
    let unfolded = of_folds(deformed, FOLD * extent);
    match between_bodies <= unfolded {
        true => Largest { factor: between_bodies, why: "the bodies would overlap or part at more" },
        false => Largest { factor: unfolded, why: "the body would fold at its corners at more" },
    }
}

/// The largest factor for contact between bodies: displacements close u_n of the gap g, which is drawn as g - k u_n.
fn of_contact(deformed: &Deformed<'_>, hardly_seen: f64) -> f64 {
    let joined: Vec<&String> = deformed.interfaces.iter().flat_map(|i| &i.sides[0]).collect();
    let between = |row: &&ContactRow| joined.contains(&&deformed.side_names[row.side]);
    let largest = |row: &ContactRow| match row.status {
        0 if row.normal_displacement <= 0.0 => f64::INFINITY,
        0 => (row.gap.max(0.0) + hardly_seen) / row.normal_displacement,
        _ => 1.0 + hardly_seen / row.normal_displacement.abs(),
    };
    deformed.contact.iter().filter(between).map(largest).fold(f64::INFINITY, f64::min)
}

/// The largest factor for ties: bodies tied with a displacement jump w are drawn k |w| apart.
fn of_ties(deformed: &Deformed<'_>, extent: f64) -> f64 {
    let jump = |x: [f64; 2]| {
        let mut at = (0..deformed.points.len()).filter(|&i| distance(deformed.points[i], x) <= ONE * extent);
        match (at.next(), at.next(), at.next()) {
            (Some(a), Some(b), None) => distance(deformed.displacement[a], deformed.displacement[b]),
            _ => 0.0,
        }
    };
    let largest = deformed.ties.iter().map(|row| jump(row.point)).fold(0.0, f64::max);
    if largest <= ONE * extent { f64::INFINITY } else { (HARDLY_SEEN * extent / largest).max(1.0) }
}

/// The factor above which turned-over triangles have an area of more than `hardly_seen`². Triangles lower than 1.5
/// `hardly_seen` are left out, because on a coarse mesh displacements inside do not continue those of the boundary. A
/// triangle turns over where det(I + k G) = 1 + k tr G + k² det G falls to 0, with the gradient G of its displacement.
fn of_folds(deformed: &Deformed<'_>, hardly_seen: f64) -> f64 {
    let fields = deformed.grid;
    let Some(displacement) = Grid::field(&fields.point_data, "displacement", 3) else {
        return f64::INFINITY;
    };
    let at = |i: usize| [displacement.values[3 * i], displacement.values[3 * i + 1]];
    let fold = |&[a, b, c]: &[usize; 3]| {
        let [p, q] = [b, c].map(|i| minus(fields.points[i], fields.points[a]));
        let [u, v] = [b, c].map(|i| minus(at(i), at(a)));
        let area = cross(p, q);
        let (trace, determinant) = ((cross(u, q) + cross(p, v)) / area, cross(u, v) / area);
        let longest = norm(p).max(norm(q)).max(norm(minus(q, p)));
        let is_seen = area.abs() > 1.5 * hardly_seen * longest;
        (if is_seen { first_root(trace, determinant) } else { f64::INFINITY }, area.abs() / 2.0)
    };
    let mut folds: Vec<(f64, f64)> = body_part(fields).1.iter().map(fold).filter(|(k, _)| k.is_finite()).collect();
    folds.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut folded = 0.0;
    let seen = folds.iter().find(|(_, area)| {
        folded += area;
        folded > hardly_seen * hardly_seen
    });
    seen.map_or(f64::INFINITY, |(k, _)| *k)
}

/// The smallest k > 0 with 1 + b k + c k² = 0; infinite if there is none.
fn first_root(b: f64, c: f64) -> f64 {
    let discriminant = b * b - 4.0 * c;
    if discriminant < 0.0 || b.is_nan() {
        return f64::INFINITY;
    }
    // the roots are -2/(b ± √discriminant)
    let roots = [1.0, -1.0].map(|sign| -2.0 / (b + sign * discriminant.sqrt()));
    roots.into_iter().filter(|k| *k > 0.0).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cases (b, c) of 1 + b k + c k²: simple shear (0, 0) and a rotation (0, c) never fold; a compression by 1 % folds
    /// at 100, a compression of both axes by 1 % and 2 % at 50, and stretching one axis while the other shrinks by 1 %
    /// at 100.
    #[test]
    fn the_first_root_is_the_smallest_positive_one() {
        for (b, c, root) in [
            (0.0, 0.0, f64::INFINITY),
            (0.0, 1e-4, f64::INFINITY),
            (-0.01, 0.0, 100.0),
            (-0.03, 2e-4, 50.0),
            (0.02, -3e-4, 100.0),
            (0.03, 2e-4, f64::INFINITY),
        ] {
            let found = first_root(b, c);
            assert!(found == root || (found - root).abs() < 1e-9 * root, "{b} {c}: {found}, not {root}");
        }
    }
}

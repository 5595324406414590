//! The rigid motions that must be removed from the three-field form.

use faer::Mat;
use steklov_algebra::symmetric_eigenvalues;
use steklov_bem_operators::Polygon;

use super::grids::Level;
use super::manufactured::{Manufactured, Pair};
use super::systems::Reduced;
use crate::table::Column;
use crate::watch::{Found, Watch};

/// Reciprocal condition of the three-field matrix of one pair on one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// Number of the pair.
    pub pair: usize,
    /// Cells along x and y, over the bounding box.
    pub cells: [usize; 2],
    /// Unknowns of the interface: displacements of body and medium, tractions.
    pub size: usize,
    /// Smallest over largest eigenvalue, by magnitude, with both translations removed from ξ.
    pub two: f64,
    /// The same with the rotation removed as well.
    pub three: f64,
}

/// Columns of the conditions.
pub(super) const CONDITIONS: [Column<Condition>; 6] = [
    ("pair", "1", "number of the pair of materials", |c| c.pair as f64),
    ("cells_x", "1", "cells along x", |c| c.cells[0] as f64),
    ("cells_y", "1", "cells along y", |c| c.cells[1] as f64),
    ("size", "1", "unknowns of the interface", |c| c.size as f64),
    ("two", "1", "smallest over largest magnitude of an eigenvalue, two translations removed", |c| c.two),
    ("three", "1", "the same, translations and rotation removed", |c| c.three),
];

/// Conditions by pair and grid.
pub type Conditioning = Found<Condition>;

impl Conditioning {
    /// The points of a pair.
    pub fn of(&self, pair: usize) -> impl Iterator<Item = &Condition> {
        self.points.iter().filter(move |c| c.pair == pair)
    }
}

/// Smallest over largest magnitude of an eigenvalue of a symmetric matrix; NaN if they cannot be computed.
fn reciprocal(matrix: &Mat<f64>) -> f64 {
    let Ok(values) = symmetric_eigenvalues(matrix.as_ref()) else { return f64::NAN };
    let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    values.iter().fold(f64::INFINITY, |m, v| m.min(v.abs())) / largest
}

/// Measures all pairs on all grids. After a request to stop nothing more is measured.
pub fn conditioning(polygon: &Polygon, pairs: &[Pair], levels: &[Level], watch: &mut Watch<'_>) -> Conditioning {
    let mut all = Conditioning::default();
    for (pair, materials) in pairs.iter().enumerate() {
        let exact = Manufactured::new(polygon, materials);
        for level in levels {
            if watch.stopped() {
                return all;
            }
            let cells = level.grid.cells;
            let at = format!("conditioning, {}, {} by {} cells", materials.name, cells[0], cells[1]);
            watch.tell("conditioning", &at);
            let found = Reduced::new(&exact, level).map(|reduced| {
                let [two, three] = [2, 3].map(|motions| reciprocal(&reduced.three_field(1.0, motions)));
                Some(Condition { pair, cells, size: 3 * level.trace, two, three })
            });
            all.take(at, found);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_diagonal_has_the_condition_of_its_entries() {
        let (c, s) = (0.6, 0.8);
        let turn = Mat::from_fn(2, 2, |i, j| [[c, -s], [s, c]][i][j]);
        let diagonal = Mat::from_fn(2, 2, |i, j| if i == j { [-4.0, 1e-3][i] } else { 0.0 });
        let found = reciprocal(&(&turn * diagonal * turn.transpose()));
        assert!((found - 2.5e-4).abs() < 1e-12, "{found}");
    }
}

//! Systems with signs and factors from the literature that do not converge, and the systems that do.

use faer::Scale;
use steklov_bem_operators::Polygon;

use super::convergence::ENERGY;
use super::grids::Level;
use super::manufactured::{Manufactured, Pair};
use super::systems::Reduced;
use crate::table::Column;
use crate::watch::{Found, Watch};

/// The systems and their names.
pub const SYSTEMS: [&str; 5] =
    ["two-field, t = -S u", "two-field, t = +S u", "K + ½M for K - ½M in S", "three-field", "three-field with 2W"];

/// One system on one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrong {
    /// Number in [`SYSTEMS`].
    pub system: usize,
    /// Cells along x and y, over the bounding box.
    pub cells: [usize; 2],
    /// Error of the body in the energy norm ((force length/thickness)^½).
    pub error: f64,
}

/// Columns of the systems.
pub(super) const WRONG: [Column<Wrong>; 4] = [
    (
        "system",
        "1",
        "0 two-field with -S, 1 with +S, 2 with K + M/2 in S; 3 three-field, 4 three-field with 2 W",
        |w| w.system as f64,
    ),
    ("cells_x", "1", "cells along x", |w| w.cells[0] as f64),
    ("cells_y", "1", "cells along y", |w| w.cells[1] as f64),
    ("error", ENERGY, "error of the body, energy norm", |w| w.error),
];

/// Errors of right and wrong systems, by grid and system.
pub type Wrongs = Found<Wrong>;

impl Wrongs {
    /// The points of a system.
    pub fn of(&self, system: usize) -> impl Iterator<Item = &Wrong> {
        self.points.iter().filter(move |w| w.system == system)
    }
}

/// Solves one pair by all systems on all grids. After a request to stop nothing more is solved.
pub fn wrongs(polygon: &Polygon, pair: &Pair, levels: &[Level], watch: &mut Watch<'_>) -> Wrongs {
    let mut all = Wrongs::default();
    let exact = Manufactured::new(polygon, pair);
    for level in levels {
        if watch.stopped() {
            return all;
        }
        let cells = level.grid.cells;
        let at = format!("wrong signs, {} by {} cells", cells[0], cells[1]);
        watch.tell("wrong signs", &at);
        all.take(at, Reduced::new(&exact, level).map(|reduced| solved(&exact, &reduced, cells)));
    }
    all
}

/// All systems on one grid.
fn solved(exact: &Manufactured<'_>, reduced: &Reduced, cells: [usize; 2]) -> [Wrong; 5] {
    let s = reduced.steklov(-0.5);
    let fields = [
        reduced.with_operator(&s),
        reduced.with_operator(&(&s * Scale(-1.0))),
        reduced.with_operator(&reduced.steklov(0.5)),
        reduced.by_three_fields(1.0),
        reduced.by_three_fields(2.0),
    ];
    [0, 1, 2, 3, 4].map(|system| {
        let [error, _] = exact.energy_error(&reduced.body, &fields[system]);
        Wrong { system, cells, error }
    })
}

//! Loads, cell by cell: the part that a coarse cell carries must not depend on its neighbours.

use std::collections::BTreeMap;

use rayon::prelude::*;

use steklov_quadrature::{Rule, gauss_legendre};

use crate::elasticity::shape;
use crate::{HeterogeneousBody, MsfemError};

/// Two rules must agree to this part of the integral of |f|.
const AGREEMENT: f64 = 1e-12;

/// Largest total uncertainty of the pieces on which they do not agree, as part of that integral.
const ROUGH: f64 = 1e-4;

/// Part of a jump by which a rule of six points is off along an axis, at most: half of its largest weight.
const OF_JUMP: f64 = 0.12;

/// How much a force varies between the corners and middles of a rectangle, times its area.
fn variation(force: &impl Fn([f64; 2]) -> [f64; 2], at: [f64; 2], size: [f64; 2]) -> f64 {
    let value = |k: usize| {
        let [i, j] = [k % 3, k / 3].map(|i| i as f64 / 2.0);
        force([at[0] + i * size[0], at[1] + j * size[1]])
    };
    let of = |k: usize| {
        let values = (0..9).map(|point| value(point)[k]);
        let range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        range[1] - range[0]
    };
    size[0] * size[1] * of(0).max(of(1))
}

/// Integrals of a force on a rectangle.
struct Piece {
    /// Against the four bilinear functions of the rectangle itself.
    on_piece: [f64; 8],
    /// Integral of |f_x| + |f_y|.
    size: f64,
    /// A point at which the force is not finite.
    singular: Option<[f64; 2]>,
}

impl Piece {
    fn new(force: &impl Fn([f64; 2]) -> [f64; 2], at: [f64; 2], size: [f64; 2], rule: &Rule) -> Self {
        let mut piece = Self { on_piece: [0.0; 8], size: 0.0, singular: None };
        for (&s, &v) in rule.points.iter().zip(&rule.weights) {
            for (&t, &w) in rule.points.iter().zip(&rule.weights) {
                let local = [(1.0 + s) / 2.0, (1.0 + t) / 2.0];
                let point = [at[0] + size[0] * local[0], at[1] + size[1] * local[1]];
                let f = force(point);
                if !f.iter().all(|f| f.is_finite()) {
                    piece.singular = Some(point);
                    return piece;
                }
                let weight = v * w * size[0] * size[1] / 4.0;
                piece.size += weight * (f[0].abs() + f[1].abs());
                for (a, phi) in shape(local).into_iter().enumerate() {
                    (0..2).for_each(|i| piece.on_piece[2 * a + i] += weight * phi * f[i]);
                }
            }
        }
        piece
    }

    /// Adds the integrals against the functions of the cell around the rectangle, which are bilinear on it.
    fn add_to(&self, load: &mut [f64; 8], at: [f64; 2], size: [f64; 2], first: [f64; 2], spacing: [f64; 2]) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for (p, corner) in corners.into_iter().enumerate() {
            let local = [0, 1].map(|k| (at[k] + size[k] * corner[k] - first[k]) / spacing[k]);
            for (a, phi) in shape(local).into_iter().enumerate() {
                (0..2).for_each(|i| load[2 * a + i] += phi * self.on_piece[2 * p + i]);
            }
        }
    }
}

/// Nodal forces of cells (force per thickness), in the order of the local unknowns. A node's load is the sum over its cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loads {
    /// Tractions: cells at the boundary.
    pub boundary: BTreeMap<usize, [f64; 8]>,
    /// Body force: every cell of the bounding box, or none of them.
    pub body: Vec<[f64; 8]>,
}

impl Loads {
    /// Adds the moments ∫ t φ over one side of a cell (0 lower, 1 right, 2 upper, 3 left) against the functions of its two
    /// ends, the end first that comes first counter-clockwise.
    pub fn add_side(&mut self, cell: usize, side: usize, moments: [[f64; 2]; 2]) {
        let load = self.boundary.entry(cell).or_default();
        for (local, moment) in [side, (side + 1) % 4].into_iter().zip(moments) {
            (0..2).for_each(|i| load[2 * local + i] += moment[i]);
        }
    }

    /// A body force (force per area). Each cell is integrated by 4 × 4 and 6 × 6 Gauss points, and quartered until both agree to
    /// 1e-12 of the integral of |f| over the body, or pieces are as small as 1/4096 of it (jumps and kinks). The cells whose load is
    /// not known so well, each with the force (force per thickness) by which it may be off.
    ///
    /// # Errors
    /// [`MsfemError::Force`] where f is not finite, or so rough that the small pieces are uncertain by more than 1e-4 of the
    /// whole.
    pub fn set_body_force(
        &mut self,
        body: &HeterogeneousBody,
        force: impl Fn([f64; 2]) -> [f64; 2] + Sync,
    ) -> Result<Vec<(usize, f64)>, MsfemError> {
        self.set_body_force_that_turns(body, force, |_, _| false)
    }

    /// As [`Self::set_body_force`], where rectangles, by their first corner and their sizes, are quartered too in which the force `turns`: has a
    /// kink or a jump that no point of a rule may see.
    ///
    /// # Errors
    /// As [`Self::set_body_force`].
    pub fn set_body_force_that_turns(
        &mut self,
        body: &HeterogeneousBody,
        force: impl Fn([f64; 2]) -> [f64; 2] + Sync,
        turns: impl Fn([f64; 2], [f64; 2]) -> bool + Sync,
    ) -> Result<Vec<(usize, f64)>, MsfemError> {
        let grid = &body.grid;
        let ny = grid.cells[1];
        let rules = [4, 6].map(gauss_legendre);
        let count = grid.cells[0] * ny;
        let inside = |cell: usize| grid.inside(cell / ny, cell % ny);
        let first = |cell: usize| grid.lattice_point(grid.cell(cell));
        let sizes: Vec<f64> = (0..count)
            .into_par_iter()
            .map(|cell| if inside(cell) { Piece::new(&force, first(cell), grid.spacing, &rules[0]).size } else { 0.0 })
            .collect();
        let whole: f64 = sizes.iter().sum();
        let across = grid.cells[0].max(ny);
        let depth = (4096 / across).max(1).ilog2().clamp(0, 9);
        let integrate = |cell: usize| -> Result<([f64; 8], [f64; 3]), MsfemError> {
            if !inside(cell) {
                return Ok(([0.0; 8], [0.0; 3]));
            }
            let (mut load, mut doubtful, mut found, mut off) = ([0.0; 8], 0.0, 0.0, 0.0);
            let mut open = vec![(first(cell), grid.spacing, 0)];
            while let Some((at, size, level)) = open.pop() {
                let [a, b] = [0, 1].map(|k| Piece::new(&force, at, size, &rules[k]));
                if let Some(point) = b.singular.or(a.singular) {
                    return Err(MsfemError::Force { point, what: "is not finite" });
                }
                let apart = (0..8).fold(0.0f64, |m, c| m.max((a.on_piece[c] - b.on_piece[c]).abs()));
                if level < depth && (apart > AGREEMENT * whole || turns(at, size)) {
                    let half = size.map(|h| h / 2.0);
                    for [i, j] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
                        open.push(([at[0] + i * half[0], at[1] + j * half[1]], half, level + 1));
                    }
                    continue;
                }
                let disagree = if apart > AGREEMENT * whole { apart } else { 0.0 };
                doubtful += disagree;
                off += if turns(at, size) { disagree.max(OF_JUMP * variation(&force, at, size)) } else { disagree };
                found += b.size;
                b.add_to(&mut load, at, size, first(cell), grid.spacing);
            }
            Ok((load, [doubtful, found, off]))
        };
        let cells = (0..count).into_par_iter().map(integrate).collect::<Result<Vec<_>, MsfemError>>()?;
        let [doubtful, found] = [0, 1].map(|k| cells.iter().map(|(_, of_cell)| of_cell[k]).sum::<f64>());
        if doubtful > ROUGH * whole.max(found) {
            let worst = (0..count).max_by(|&a, &b| cells[a].1[0].total_cmp(&cells[b].1[0])).unwrap_or(0);
            return Err(MsfemError::Force { point: grid.centre(worst), what: "is too rough to be integrated" });
        }
        let uncertain = cells.iter().enumerate().map(|(cell, (_, [_, _, off]))| (cell, *off));
        let uncertain = uncertain.filter(|(_, off)| *off > 0.0).collect();
        self.body = cells.into_iter().map(|(load, _)| load).collect();
        Ok(uncertain)
    }

    /// The load of a cell; zero where nothing acts.
    pub fn cell(&self, cell: usize) -> [f64; 8] {
        let mut load = self.body.get(cell).copied().unwrap_or_default();
        if let Some(boundary) = self.boundary.get(&cell) {
            (0..8).for_each(|i| load[i] += boundary[i]);
        }
        load
    }

    /// The load of all unknowns of the fine grid.
    pub fn nodal(&self, body: &HeterogeneousBody) -> Vec<f64> {
        let mut nodal = vec![0.0; body.grid.dofs()];
        let mut add = |cell: usize, load: &[f64; 8]| {
            for (a, node) in body.grid.cell_nodes(cell).into_iter().enumerate() {
                (0..2).for_each(|i| nodal[2 * node + i] += load[2 * a + i]);
            }
        };
        if !self.body.is_empty() {
            body.grid.body_cells().for_each(|cell| add(cell, &self.body[cell]));
        }
        self.boundary.iter().for_each(|(cell, load)| add(*cell, load));
        nodal
    }
}

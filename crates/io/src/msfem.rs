//! [`Persist`] for the types of `steklov-msfem`.
//!
//! Grids, media and coarse meshes are rebuilt from the data that determine them, with the same bits and their own
//! checks.

use faer::Mat;
use hdf5::Group;
use steklov_msfem::{
    CellBasis, CoarseCell, CoarseMesh, CoarseSystem, CrossingContrast, Elasticity, Grid, HeterogeneousBody, Indicators,
    Loads,
};

use crate::array::{
    load_integers, load_number, load_pairs, load_points, load_vector, save_integers, save_number, save_pairs,
    save_points, save_vector,
};
use crate::dataset::{Label, label};
use crate::elastic::{load_plane, save_plane};
use crate::error::{IoError, invalid, mismatch, write_error};
use crate::matrix::{load_sparse, save_dense, save_sparse};
use crate::persist::{Persist, load, save};
use crate::quadrature::{check_length, load_sized};

/// The one row of a list.
fn only<T: Copy>(at: &Group, name: &str, rows: &[T]) -> Result<T, IoError> {
    match rows {
        &[row] => Ok(row),
        _ => Err(mismatch(at, name, "one row", format!("{} rows", rows.len()))),
    }
}

const LOCAL: &str = "local unknown: 2 corner + component";

/// Rows of eight numbers.
fn save_eights(at: &Group, name: &str, rows: &[[f64; 8]], label: &Label<'_>) -> Result<(), IoError> {
    save_dense(at, name, Mat::from_fn(rows.len(), 8, |i, j| rows[i][j]).as_ref(), label)
}

/// `n` rows of eight numbers.
fn load_eights(at: &Group, name: &str, n: usize) -> Result<Vec<[f64; 8]>, IoError> {
    let table = load_sized(at, name, n, 8)?;
    Ok((0..n).map(|i| std::array::from_fn(|j| table[(i, j)])).collect())
}

impl Persist for Elasticity {
    const KIND: &'static str = "isotropic elasticity without a modulus";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_number(at, "poisson", self.poisson, "1", "Poisson's ratio")?;
        save_plane(at, self.plane)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let plane = load_plane(at)?;
        Self::new(load_number(at, "poisson")?, plane).map_err(|e| invalid(at, "poisson", e))
    }
}

impl Persist for Grid {
    const KIND: &'static str = "grid of rectangles";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let xy = &["value", "xy"];
        save_points(at, "origin", &[self.origin], &label("length", "lower left corner", xy))?;
        save_points(at, "spacing", &[self.spacing], &label("length", "sides of a cell", xy))?;
        save_pairs(at, "cells", &[self.cells], &label("1", "cells nx, ny along x and y", xy))?;
        let mut inside = vec![0; self.cells[0] * self.cells[1]];
        self.body_cells().for_each(|cell| inside[cell] = 1);
        let meaning = "1 for a cell of the body, else 0; cell (ix, iy) has the number ix ny + iy";
        save_integers(at, "inside", &inside, &label("1", meaning, &["cell"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let [nx, ny] = only(at, "cells", &load_pairs(at, "cells")?)?;
        let inside = load_integers(at, "inside")?;
        if nx.checked_mul(ny) != Some(inside.len()) {
            return Err(invalid(at, "inside", format!("{} entries for {nx} by {ny} cells", inside.len())));
        }
        if let Some(other) = inside.iter().find(|i| **i > 1) {
            return Err(invalid(at, "inside", format!("{other} is neither 0 nor 1")));
        }
        let [origin, spacing] =
            [only(at, "origin", &load_points(at, "origin")?)?, only(at, "spacing", &load_points(at, "spacing")?)?];
        Self::new(origin, spacing, [nx, ny], |ix, iy| inside[ix * ny + iy] == 1).map_err(|e| invalid(at, "", e))
    }
}

impl Persist for HeterogeneousBody {
    const KIND: &'static str = "heterogeneous body";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save(at, "grid", &self.grid)?;
        save(at, "elasticity", &self.elasticity)?;
        let meaning = "Young's modulus of each cell; of any value outside of the body";
        save_vector(at, "young", &self.young, &label("stress", meaning, &["cell"]))?;
        let meaning = "Poisson's ratio of each cell; of any value outside of the body";
        let ratios = |poisson: &[f64]| save_vector(at, "poisson", poisson, &label("1", meaning, &["cell"]));
        self.poisson().map_or(Ok(()), ratios)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (grid, elasticity) = (load(at, "grid")?, load(at, "elasticity")?);
        let body = Self::new(grid, load_vector(at, "young")?, elasticity).map_err(|e| invalid(at, "young", e))?;
        match at.link_exists("poisson") {
            true => body.with_poisson(load_vector(at, "poisson")?).map_err(|e| invalid(at, "poisson", e)),
            false => Ok(body),
        }
    }
}

/// Largest number of rectangles between all lines through sides of coarse cells that are checked; four per cell are
/// always allowed.
const MOST: usize = 1 << 22;

/// The lines through the sides of coarse cells, each once; those along y first.
fn lines(cells: &[CoarseCell]) -> Result<[Vec<usize>; 2], String> {
    let along = |k: usize| -> Result<Vec<usize>, String> {
        let mut lines = Vec::new();
        for cell in cells {
            let (first, size) = (cell.first[k], cell.size[k]);
            let end = first.checked_add(size).filter(|end| size > 0 && *end < 1 << 32);
            lines.extend([first, end.ok_or_else(|| format!("a coarse cell of {size} fine cells from {first} on"))?]);
        }
        lines.sort_unstable();
        lines.dedup();
        Ok(lines)
    };
    let lines = [along(0)?, along(1)?];
    match lines[0].len().saturating_mul(lines[1].len()) {
        n if n > MOST.max(4 * (cells.len() + 1)) => Err(format!("{n} rectangles for {} coarse cells", cells.len())),
        _ => Ok(lines),
    }
}

/// The mesh of some cells without their grid, checked as a mesh on the grid of lines through their sides.
fn coarse_mesh(cells: Vec<CoarseCell>) -> Result<CoarseMesh, String> {
    let lines = lines(&cells)?;
    let rank = |k: usize, line: usize| lines[k].partition_point(|l| *l < line);
    let shrunk: Vec<CoarseCell> = cells
        .iter()
        .map(|cell| {
            let first = [0, 1].map(|k| rank(k, cell.first[k]));
            CoarseCell { first, size: [0, 1].map(|k| rank(k, cell.first[k] + cell.size[k]) - first[k]) }
        })
        .collect();
    let counts = [0, 1].map(|k| lines[k].len().saturating_sub(1));
    let mut inside = vec![false; counts[0] * counts[1]];
    for cell in &shrunk {
        for ix in cell.first[0]..cell.first[0] + cell.size[0] {
            inside[ix * counts[1]..][cell.first[1]..cell.first[1] + cell.size[1]].fill(true);
        }
    }
    let grid =
        Grid::new([0.0; 2], [1.0; 2], counts, |ix, iy| inside[ix * counts[1] + iy]).map_err(|e| e.to_string())?;
    let mut mesh = CoarseMesh::new(&grid, shrunk).map_err(|e| e.to_string())?;
    mesh.vertices.iter_mut().for_each(|v| *v = [lines[0][v[0]], lines[1][v[1]]]);
    Ok(CoarseMesh { cells, ..mesh })
}

impl Persist for CoarseMesh {
    const KIND: &'static str = "coarse mesh";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        lines(&self.cells).map_err(|why| write_error(at, "first", why))?;
        let (first, size): (Vec<_>, Vec<_>) = self.cells.iter().map(|c| (c.first, c.size)).unzip();
        let axes = &["coarse cell", "xy"];
        save_pairs(at, "first", &first, &label("1", "lower left fine cell", axes))?;
        save_pairs(at, "size", &size, &label("1", "fine cells along x and y", axes))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (first, size) = (load_pairs(at, "first")?, load_pairs(at, "size")?);
        check_length(at, "size", size.len(), first.len())?;
        let cells = first.into_iter().zip(size).map(|(first, size)| CoarseCell { first, size });
        coarse_mesh(cells.collect()).map_err(|why| invalid(at, "first", why))
    }
}

impl Persist for CellBasis {
    const KIND: &'static str = "multiscale basis of a coarse cell";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_pairs(at, "size", &[self.size], &label("1", "fine cells m, n", &["value", "xy"]))?;
        let rows = "2 node + component, node (i, j) is j (m+1) + i";
        save_eights(at, "values", &self.values, &label("1", "R", &[rows, LOCAL]))?;
        let meaning = label("stress", "R^T K R, K the stiffness of the fine cells", &[LOCAL, LOCAL]);
        save_eights(at, "stiffness", &self.stiffness, &meaning)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let size = only(at, "size", &load_pairs(at, "size")?)?;
        let nodes =
            size[0].checked_add(1).zip(size[1].checked_add(1)).and_then(|(a, b)| a.checked_mul(b)?.checked_mul(2));
        let Some(rows) = nodes.filter(|_| !size.contains(&0)) else {
            return Err(invalid(at, "size", format!("{} by {} fine cells", size[0], size[1])));
        };
        let values = load_eights(at, "values", rows)?;
        let stiffness = load_eights(at, "stiffness", 8)?;
        Ok(Self { size, values, stiffness: std::array::from_fn(|i| stiffness[i]) })
    }
}

impl Persist for Loads {
    const KIND: &'static str = "loads of the cells of a grid";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let (cells, boundary): (Vec<usize>, Vec<[f64; 8]>) = self.boundary.iter().map(|(c, load)| (*c, *load)).unzip();
        save_integers(at, "boundary_cells", &cells, &label("1", "cells with tractions, rising", &["row"]))?;
        let force = "force/thickness";
        save_eights(at, "boundary", &boundary, &label(force, "nodal forces of tractions", &["row", LOCAL]))?;
        let body = label(force, "nodal forces of a body force, of all cells or none", &["cell", LOCAL]);
        save_eights(at, "body", &self.body, &body)?;
        save_integers(at, "body_cells", &[self.body.len()], &label("1", "rows of body", &["value"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let cells = load_integers(at, "boundary_cells")?;
        if let Some(pair) = cells.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(invalid(at, "boundary_cells", format!("cell {} follows cell {}", pair[1], pair[0])));
        }
        let boundary = load_eights(at, "boundary", cells.len())?;
        let rows = only(at, "body_cells", &load_integers(at, "body_cells")?)?;
        Ok(Self { boundary: cells.into_iter().zip(boundary).collect(), body: load_eights(at, "body", rows)? })
    }
}

impl Persist for CoarseSystem {
    const KIND: &'static str = "coarse system";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_sparse(at, "stiffness", &self.stiffness, &label("stress", "K_H", &["unknown", "unknown"]))?;
        save_vector(at, "load", &self.load, &label("force/thickness", "load", &["unknown"]))
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let (stiffness, load) = (load_sparse(at, "stiffness")?, load_vector(at, "load")?);
        if stiffness.shape() != (load.len(), load.len()) {
            let expected = format!("a square matrix of {} rows", load.len());
            return Err(mismatch(at, "stiffness", expected, format!("{:?}", stiffness.shape())));
        }
        Ok(Self { stiffness, load })
    }
}

impl Persist for Indicators {
    const KIND: &'static str = "residual indicators of coarse cells";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        let term = |name, values: &[f64], meaning| {
            save_vector(at, name, values, &label("force*length/thickness", meaning, &["coarse cell"]))
        };
        term("volume_mean", &self.volume_mean, "H^2/E of the mean body force")?;
        term("volume_oscillation", &self.volume_oscillation, "H^2/E of the rest of the body force")?;
        term("jump_mean", &self.jump_mean, "H/E of the mean jumps of the traction")?;
        term("jump_oscillation", &self.jump_oscillation, "H/E of the rest of these jumps")?;
        term("neumann", &self.neumann, "H/E of the given traction less that of the field")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let volume_mean = load_vector(at, "volume_mean")?;
        let term = |name| {
            let values = load_vector(at, name)?;
            check_length(at, name, values.len(), volume_mean.len())?;
            Ok(values)
        };
        Ok(Self {
            volume_oscillation: term("volume_oscillation")?,
            jump_mean: term("jump_mean")?,
            jump_oscillation: term("jump_oscillation")?,
            neumann: term("neumann")?,
            volume_mean,
        })
    }
}

impl Persist for CrossingContrast {
    const KIND: &'static str = "contrast along coarse sides";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_number(at, "largest", self.largest, "1", "largest ratio of moduli along a side")?;
        save_points(at, "at", &[self.at], &label("length", "middle of that side", &["value", "xy"]))?;
        save_number(at, "share", self.share, "1", "share of the sides with a ratio of at least the threshold")
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let middle = only(at, "at", &load_points(at, "at")?)?;
        Ok(Self { largest: load_number(at, "largest")?, at: middle, share: load_number(at, "share")? })
    }
}

//! Vector-valued basis functions of one coarse cell.

use super::body::Bounds;
use super::fields::{FieldPanel, ends, field_panels};
use super::raster::Raster;
use super::{Picture, PictureError};

/// A basis function on a coarse cell of m × n fine cells, bilinear in each.
#[derive(Debug, Clone, Copy)]
pub struct BasisFunction<'a> {
    /// Text above both components, for instance the kind of boundary data.
    pub name: &'a str,
    /// Sides of the coarse cell, whose lower left corner is drawn at the origin.
    pub size: [f64; 2],
    /// Fine cells m, n along x and y.
    pub cells: [usize; 2],
    /// Component x at the (m+1)·(n+1) nodes; node (i, j) has the index j·(m+1) + i.
    pub x: &'a [f64],
    /// Component y, likewise.
    pub y: &'a [f64],
}

/// Draws the components of functions side by side, a row for each function; each component has its own colours.
///
/// The colours run to the largest value, from the smallest value if it is negative or if the values vary by less than
/// half of the largest, else from 0. A component whose values are all below 1e-12 of the other's largest counts as 0.
///
/// # Errors
/// [`PictureError::Raster`] if the pixels cannot be made.
///
/// # Panics
/// If a function has no cell, a side that is not positive, or not two values for each node.
pub fn basis(title: &str, functions: &[BasisFunction<'_>]) -> Result<Picture, PictureError> {
    let panels: Vec<FieldPanel<'_>> = functions.iter().flat_map(components).collect();
    field_panels(title, &panels, 2..=2, false)
}

fn components<'a>(function: &'a BasisFunction<'a>) -> [FieldPanel<'a>; 2] {
    let &BasisFunction { name, size, cells: [m, n], x, y } = function;
    assert!(m > 0 && n > 0 && [x, y].iter().all(|v| v.len() == (m + 1) * (n + 1)), "two values for each of some nodes");
    assert!(size[0] > 0.0 && size[1] > 0.0, "positive sides");
    let largest = |values: &[f64]| values.iter().filter(|v| v.is_finite()).fold(0.0f64, |l, v| l.max(v.abs()));
    let rounding = 1e-12 * largest(x).max(largest(y));
    [("component x", x), ("component y", y)].map(|(label, values)| FieldPanel {
        caption: name,
        label,
        length: None,
        bounds: Bounds { low: [0.0; 2], high: size },
        ends: if largest(values) > rounding { ends(values.iter().copied()) } else { [0.0, 1.0] },
        beyond: [false; 2],
        pixels: Box::new(move |pixels, ends| {
            Raster::new(pixels, ends, |i, j| bilinear([m, n], values, pixels, [i, j]))
        }),
        overlay: &[],
    })
}

/// The interpolant at the middle of a pixel; rows are counted from the bottom.
fn bilinear(cells: [usize; 2], values: &[f64], pixels: [usize; 2], at: [usize; 2]) -> f64 {
    let [(i, s), (j, t)] = [0, 1].map(|k| {
        let place = (at[k] as f64 + 0.5) / pixels[k] as f64 * cells[k] as f64;
        let cell = (place as usize).min(cells[k] - 1);
        (cell, place - cell as f64)
    });
    let row = |j: usize| {
        let first = j * (cells[0] + 1) + i;
        (1.0 - s) * values[first] + s * values[first + 1]
    };
    (1.0 - t) * row(j) + t * row(j + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_bilinear_function_is_its_own_interpolant(
            c in prop::array::uniform4(-1.0f64..1.0), m in 1usize..9, n in 1usize..9, w in 1usize..40, h in 1usize..40
        ) {
            let f = |x: f64, y: f64| c[0] + c[1] * x + c[2] * y + c[3] * x * y;
            let node = |k: usize| f((k % (m + 1)) as f64 / m as f64, (k / (m + 1)) as f64 / n as f64);
            let values: Vec<f64> = (0..(m + 1) * (n + 1)).map(node).collect();
            for (i, j) in (0..w).flat_map(|i| (0..h).map(move |j| (i, j))) {
                let there = f((i as f64 + 0.5) / w as f64, (j as f64 + 0.5) / h as f64);
                prop_assert!((bilinear([m, n], &values, [w, h], [i, j]) - there).abs() < 1e-13);
            }
        }
    }
}

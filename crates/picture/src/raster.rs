//! A field as coloured pixels: values on a grid of any size are resampled to the size at which they are drawn.

use super::PictureError;
use super::bands::{BANDS, colour};
use super::canvas::{PIXELS, Rect};
use kuva::backend::raster::RasterBackend;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};
use std::ops::Range;

/// The band of a pixel outside of the body.
const OUTSIDE: u8 = u8::MAX;

/// An outline of more lines than this belongs to speckles, which are clearer without one.
const OUTLINE: usize = 20_000;

/// Rows of bands, from the top.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Raster {
    /// Pixels along x and y.
    pub size: [usize; 2],
    bands: Vec<u8>,
}

impl Raster {
    /// The pixels whose values are `value(column, row)`, rows counted from the bottom; NaN is outside of the body.
    pub fn new(size: [usize; 2], [low, high]: [f64; 2], value: impl Fn(usize, usize) -> f64) -> Self {
        let band = |v: f64| {
            let level = (v - low) / (high - low) * BANDS as f64;
            if v.is_nan() { OUTSIDE } else { level.clamp(0.0, (BANDS - 1) as f64) as u8 }
        };
        let rows = (0..size[1]).rev().flat_map(|j| (0..size[0]).map(move |i| (i, j)));
        Self { size, bands: rows.map(|(i, j)| band(value(i, j))).collect() }
    }

    fn row(&self, j: usize) -> &[u8] {
        &self.bands[j * self.size[0]..(j + 1) * self.size[0]]
    }

    /// Rectangles of one colour that cover the body once, with the raster's corner at the frame's.
    fn rectangles(&self, [left, top]: [f64; 2]) -> Primitive {
        let [mut x, mut y, mut w, mut h] = [const { Vec::new() }; 4];
        let mut fills = Vec::new();
        let palette: Vec<Color> = (0..BANDS).map(colour).collect();
        let rows: Vec<&[u8]> = (0..self.size[1]).map(|j| self.row(j)).collect();
        let mut j = 0;
        for equal in rows.chunk_by(|a, b| a == b) {
            let mut i = 0;
            for run in equal[0].chunk_by(|a, b| a == b) {
                if run[0] != OUTSIDE {
                    x.push(left + i as f64 / PIXELS);
                    y.push(top + j as f64 / PIXELS);
                    w.push(run.len() as f64 / PIXELS);
                    h.push(equal.len() as f64 / PIXELS);
                    fills.push(palette[usize::from(run[0])].clone());
                }
                i += run.len();
            }
            j += equal.len();
        }
        Primitive::RectBatch { x, y, w, h, fills }
    }

    /// The rectangles for the PNG and the element for the SVG, at a frame of the raster's size that lies on whole
    /// pixels. The SVG embeds a PNG, because a rectangle for each run of pixels would take hundreds of times its bytes.
    pub fn drawn(&self, frame: Rect) -> Result<(Primitive, String), PictureError> {
        let [width, height] = self.size.map(|n| n as f64 / PIXELS);
        let mut scene = Scene::new(width, height);
        scene.elements.push(self.rectangles([0.0; 2]));
        let png = RasterBackend::new().with_scale(PIXELS as f32).render_scene(&scene).map_err(PictureError::Raster)?;
        let element = format!(
            "<image x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             image-rendering=\"optimizeSpeed\" href=\"data:image/png;base64,{}\"/>",
            frame.left,
            frame.top,
            base64(&png)
        );
        Ok((self.rectangles([frame.left, frame.top]), element))
    }

    /// The lines around the body; none if there are too many.
    pub fn outline(&self, [left, top]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
        let [columns, rows] = self.size;
        let body = |i: Option<usize>, j: Option<usize>| match (i, j) {
            (Some(i), Some(j)) if i < columns && j < rows => self.bands[j * columns + i] != OUTSIDE,
            _ => false,
        };
        let at = |i: usize, j: usize| [left + i as f64 / PIXELS, top + j as f64 / PIXELS];
        let level = |j: usize| {
            let edge = move |i| body(Some(i), j.checked_sub(1)) != body(Some(i), Some(j));
            ranges(columns, edge).map(move |r| vec![at(r.start, j), at(r.end, j)])
        };
        let upright = |i: usize| {
            let edge = move |j| body(i.checked_sub(1), Some(j)) != body(Some(i), Some(j));
            ranges(rows, edge).map(move |r| vec![at(i, r.start), at(i, r.end)])
        };
        let lines: Vec<_> =
            (0..=rows).flat_map(level).chain((0..=columns).flat_map(upright)).take(OUTLINE + 1).collect();
        if lines.len() > OUTLINE { Vec::new() } else { lines }
    }
}

/// The largest ranges of 0..n in which `at` holds.
fn ranges(n: usize, at: impl Fn(usize) -> bool) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let start = (next..n).find(|&i| at(i))?;
        let end = (start..n).find(|&i| !at(i)).unwrap_or(n);
        next = end;
        Some(start..end)
    })
}

/// The cells that pixel p of `pixels` shows out of `cells` in a row: its share of the cells, or the cell at its middle
/// if there are fewer cells than pixels.
pub(super) fn shown(p: usize, pixels: usize, cells: usize) -> Range<usize> {
    if cells < pixels {
        let middle = (2 * p + 1) * cells / (2 * pixels);
        middle..middle + 1
    } else {
        p * cells / pixels..(p + 1) * cells / pixels
    }
}

/// Bytes as text (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits = (0..3).fold(0, |b, k| b << 8 | u32::from(group.get(k).copied().unwrap_or(0)));
        for k in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * k)) as usize & 63];
            text.push(if k <= group.len() { letter.into() } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_vectors_of_the_standard() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("fooba", "Zm9vYmE=")];
        for (bytes, text) in cases {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xfe]), "+//+");
    }

    #[test]
    fn ends_and_values_beyond_them_have_the_outer_bands() {
        let values = [f64::NEG_INFINITY, -1.0, 1.0, 2.0, 3.0, f64::INFINITY, f64::NAN];
        let raster = Raster::new([7, 1], [1.0, 3.0], |i, _| values[i]);
        assert_eq!(raster.bands, [0, 0, 0, 16, 31, 31, OUTSIDE]);
    }

    #[test]
    fn the_outline_of_an_l_has_six_lines() {
        let raster = Raster::new([8, 6], [0.0, 1.0], |i, j| if i >= 4 && j >= 2 { f64::NAN } else { 1.0 });
        let [left, middle, right] = [10.0, 12.0, 14.0];
        let [top, step, bottom] = [20.0, 22.0, 23.0];
        let level = [([left, middle], top), ([middle, right], step), ([left, right], bottom)];
        let upright = [(left, [top, bottom]), (middle, [top, step]), (right, [step, bottom])];
        let level = level.map(|([l, r], y)| vec![[l, y], [r, y]]);
        let upright = upright.map(|(x, [t, b])| vec![[x, t], [x, b]]);
        assert_eq!(raster.outline([left, top]), [level, upright].concat());
        let speckles =
            Raster::new([400, 400], [0.0, 1.0], |i, j| if (i * i + 3 * j * j) % 7 < 3 { 1.0 } else { f64::NAN });
        assert!(speckles.outline([0.0; 2]).is_empty());
    }

    proptest! {
        #[test]
        fn every_cell_is_in_one_pixel_or_every_pixel_in_its_cell(pixels in 1usize..400, cells in 1usize..900) {
            let shares: Vec<Range<usize>> = (0..pixels).map(|p| shown(p, pixels, cells)).collect();
            if cells >= pixels {
                prop_assert!(shares.iter().all(|s| !s.is_empty()));
                prop_assert!(shares.iter().cloned().flatten().eq(0..cells));
            } else {
                for (p, share) in shares.iter().enumerate() {
                    let middle = (p as f64 + 0.5) / pixels as f64 * cells as f64;
                    prop_assert!(share.len() == 1 && share.start < cells);
                    prop_assert!((share.start as f64 + 0.5 - middle).abs() <= 0.5 + 1e-9);
                }
            }
        }

        #[test]
        fn rectangles_cover_each_pixel_of_the_body_once(bands in prop::collection::vec(0u8..4, 20), twice in any::<bool>()) {
            let size = [4, if twice { 10 } else { 5 }];
            let value = |i: usize, j: usize| match bands[4 * (j % 5) + i] { 3 => f64::NAN, k => f64::from(k) };
            let raster = Raster::new(size, [0.0, 2.0], value);
            let Primitive::RectBatch { x, y, w, h, .. } = raster.rectangles([0.0; 2]) else { panic!() };
            let mut covered = vec![0; raster.bands.len()];
            for k in 0..x.len() {
                let [i, j, m, n] = [x[k], y[k], w[k], h[k]].map(|v| (PIXELS * v) as usize);
                (j..j + n).flat_map(|j| (i..i + m).map(move |i| j * 4 + i)).for_each(|p| covered[p] += 1);
            }
            for (count, band) in covered.iter().zip(&raster.bands) {
                prop_assert_eq!(*count, usize::from(*band != OUTSIDE));
            }
        }
    }
}

//! Pixels of a text that is read upwards: the pixels of the same text along x, turned by a quarter, so that it is as
//! sharp.

use super::PictureError;
use super::canvas::{BLACK, PIXELS, text_width};
use kuva::backend::raster::RasterBackend;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene, TextAnchor};

/// Rectangles, each of one grey on white, that draw a text upwards, centred on a point of its base line.
pub(super) fn upright([x, y]: [f64; 2], content: &str, size: u32) -> Result<Primitive, PictureError> {
    // the text is centred in a strip; its base line leaves room for descenders
    let [length, line] = [text_width(content, size) + 4.0, 2.0 * f64::from(size)].map(f64::ceil);
    let [middle, base] = [length / 2.0, (1.4 * f64::from(size)).ceil()];
    let mut scene = Scene::new(length, line);
    scene.font_family = Some("sans-serif".to_owned());
    scene.add(Primitive::Text {
        x: middle,
        y: base,
        content: content.to_owned(),
        size,
        anchor: TextAnchor::Middle,
        rotate: None,
        bold: false,
        color: Some(BLACK),
    });
    let png = RasterBackend::new().with_scale(PIXELS as f32).render_scene(&scene).map_err(PictureError::Raster)?;
    let (width, rows) = pixels(&png)?;
    // whole pixels of the picture
    let [left, bottom] = [x - base, y + middle].map(|v| (PIXELS * v).round() / PIXELS);
    let [mut at_x, mut at_y, mut w, mut h] = [const { Vec::new() }; 4];
    let mut fills = Vec::new();
    for (k, pixel) in rows.into_iter().enumerate().filter(|(_, pixel)| *pixel != [255; 3]) {
        let (column, row) = (k % width, k / width);
        at_x.push(left + row as f64 / PIXELS);
        at_y.push(bottom - (column + 1) as f64 / PIXELS);
        w.push(1.0 / PIXELS);
        h.push(1.0 / PIXELS);
        fills.push(Color::Rgb(pixel[0], pixel[1], pixel[2]));
    }
    Ok(Primitive::RectBatch { x: at_x, y: at_y, w, h, fills })
}

/// Width and pixels, row by row from the top, of a PNG with four bytes per pixel, on white.
pub(super) fn pixels(png: &[u8]) -> Result<(usize, Vec<[u8; 3]>), PictureError> {
    let failed = |error: png::DecodingError| PictureError::Raster(error.to_string());
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().map_err(failed)?;
    let too_large = || PictureError::Raster("it is too large".to_owned());
    let mut bytes = vec![0; reader.output_buffer_size().ok_or_else(too_large)?];
    let info = reader.next_frame(&mut bytes).map_err(failed)?;
    let on_white = |p: &[u8]| [0, 1, 2].map(|i| (255 - ((255 - u32::from(p[i])) * u32::from(p[3]) + 127) / 255) as u8);
    Ok((info.width as usize, bytes.chunks_exact(4).map(on_white).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Canvas;

    #[test]
    fn a_text_upwards_has_the_pixels_of_one_along_x() {
        let text = "von Mises stress (×10⁻³) y";
        let mut canvas = Canvas::new(900.0);
        canvas.text([450.0, 450.0], text, 15, TextAnchor::Middle);
        let (width, along) = pixels(&canvas.finish().unwrap().png).unwrap();
        // neither coordinate falls on a pixel
        let mut canvas = Canvas::new(900.0);
        canvas.text_upwards([450.2, 450.3], text, 15);
        let picture = canvas.finish().unwrap();
        assert!(picture.svg.contains("rotate(-90"), "text in the SVG");
        let (_, upwards) = pixels(&picture.png).unwrap();
        let dark = |all: &[[u8; 3]]| -> Vec<[usize; 2]> {
            (0..all.len()).filter(|&k| all[k][0] < 128).map(|k| [k % width, k / width]).collect()
        };
        let (along, mut upwards) = (dark(&along), dark(&upwards));
        assert!(along.len() > 500 && along.len() == upwards.len(), "{} and {}", along.len(), upwards.len());
        // turned back, the lower left corners on each other
        upwards.iter_mut().for_each(|p| *p = [width - 1 - p[1], p[0]]);
        let least = |all: &[[usize; 2]], i: usize| all.iter().map(|p| p[i]).min().unwrap();
        let shifted = |all: &[[usize; 2]]| -> std::collections::BTreeSet<[usize; 2]> {
            let low = [0, 1].map(|i| least(all, i));
            all.iter().map(|p| [p[0] - low[0], p[1] - low[1]]).collect()
        };
        assert_eq!(shifted(&along), shifted(&upwards));
        let off = [0, 1].map(|i| least(&along, i).abs_diff(least(&upwards, i)));
        assert!(off.iter().all(|&d| d <= 2), "{off:?} pixels away");
    }
}

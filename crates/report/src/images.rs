//! Pictures inside of the page.

use serde::Serialize;
use steklov_picture::{Picture, PictureError, data_uri};

/// Vectors with more bytes than this become pixels.
const LARGE: usize = 100_000;

/// A picture inside of the page.
#[derive(Serialize)]
pub(crate) struct Image {
    pub source: String,
    pub alternative: String,
}

/// A picture by the part of its name in files.
pub(crate) fn image(name: &str, picture: &Picture) -> Result<Image, PictureError> {
    let source = match picture.svg.len() <= LARGE {
        true => data_uri("svg+xml", &picture.svg),
        false => data_uri("png", halved(&picture.png)?),
    };
    Ok(Image { source, alternative: alternative(name) })
}

/// What a picture shows.
fn alternative(name: &str) -> String {
    if let Some(side) = name.strip_prefix("contact-") {
        return format!("Pressure and shear along the contact side {side}");
    }
    match name {
        "body" => "The deformed body, coloured by its von Mises stress, over its undeformed outline",
        "medium" => "The deformed body and the medium around it, coloured by von Mises stress",
        "convergence-unknowns" => "The estimated error over the unknowns of the steps",
        "convergence-seconds" => "The estimated error over the seconds of the steps",
        "moduli" => "Young's modulus in the cells of the undeformed body",
        "stress" => "Von Mises stress in the cells of the undeformed body",
        "estimate" => "Indicators of the coarse cells",
        "steps" => "The estimate of the steps and its parts",
        "basis" => "Multiscale basis functions of a coarse cell",
        "pressure" => "The pressure over the outcomes of random input",
        "density" => "Densities of quantities over the outcomes of random input",
        "probability" => "The probability of contact along the contact sides",
        other => return format!("Picture {other}"),
    }
    .to_owned()
}

/// The PNG with half as many pixels along x and y, each the mean of four.
fn halved(png: &[u8]) -> Result<Vec<u8>, PictureError> {
    let failed = |e: &dyn std::fmt::Display| PictureError::Raster(e.to_string());
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().map_err(|e| failed(&e))?;
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or_default()];
    let info = reader.next_frame(&mut pixels).map_err(|e| failed(&e))?;
    let (channels, line) = (info.color_type.samples(), info.line_size);
    let [width, height] = [info.width / 2, info.height / 2];
    let mut means = Vec::with_capacity(channels * (width * height) as usize);
    for j in 0..height as usize {
        for i in 0..width as usize {
            for c in 0..channels {
                let at = |di: usize, dj: usize| u16::from(pixels[(2 * j + dj) * line + (2 * i + di) * channels + c]);
                means.push(((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8);
            }
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().map_err(|e| failed(&e))?;
    writer.write_image_data(&means).map_err(|e| failed(&e))?;
    writer.finish().map_err(|e| failed(&e))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_has_means_of_four_pixels() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 4, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[0, 4, 10, 20, 8, 12, 30, 40]).unwrap();
        let half = halved(&bytes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(half)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height, &pixels[..2]), (2, 1, [6, 25].as_slice()));
    }
}

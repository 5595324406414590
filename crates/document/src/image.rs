//! Moduli and ratios of cells from the grey levels of images.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Transformations};
use steklov_problem::{CellModuli, TableOrder};

use super::error::{ReadError, SceneErrorKind as Kind};
use super::fields::Field;
use super::source::Source;

/// An image: columns, rows, and the grey level of each pixel from 0, black, to 1, white, row by row from the top.
struct Grey {
    columns: usize,
    rows: usize,
    levels: Vec<f64>,
}

/// The numbers of an image with a pixel for each cell, from that of black to that of white. Cells that do not fit the body are refused
/// later, by their size.
pub(super) fn from_image(
    image: &Field<'_>,
    [low, high]: [f64; 2],
    (cells, size): (Option<[usize; 2]>, f64),
    source: &Source,
) -> Result<CellModuli, ReadError> {
    let at = image.text()?;
    let path = Path::new(&source.name).parent().unwrap_or(Path::new("")).join(at);
    let refused = |why: String, help: &str| ReadError::new(Kind::Read, image.item.place, format!("{at}: {why}"), help);
    let grey = read(&path).map_err(|(why, help)| refused(why, help))?;
    let order = TableOrder::Rows;
    let values: Vec<f64> = match cells {
        None => Vec::new(),
        Some(cells) => {
            let [nx, ny] = cells;
            if [grey.columns, grey.rows] != cells {
                let why =
                    format!("it has {} by {} pixels for {nx} by {ny} cells of size {size}", grey.columns, grey.rows);
                return Err(image.problem(format!("{at}: {why}"), "a pixel is a cell: change size, or scale the image"));
            }
            let value = |cell: usize| {
                let [row, column] = order.entry([cell / ny, cell % ny], cells);
                low + (high - low) * grey.levels[row * grey.columns + column]
            };
            (0..nx * ny).map(value).collect()
        }
    };
    let source = format!("grey levels of {at}, black {low} and white {high}");
    Ok(CellModuli::Table { values: values.into(), order, source })
}

/// Reads a PNG of grey levels; what is wrong with it, and the remedy.
fn read(path: &Path) -> Result<Grey, (String, &'static str)> {
    let open = |e: std::io::Error| (e.to_string(), "the path is relative to the folder of the scene");
    let wrong = |e: png::DecodingError| (e.to_string(), "write a PNG of grey levels");
    let mut decoder = Decoder::new(BufReader::new(File::open(path).map_err(open)?));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(wrong)?;
    let too_large = || ("it does not fit into memory".to_owned(), "take a smaller image");
    let mut bytes = vec![0; reader.output_buffer_size().ok_or_else(too_large)?];
    let info = reader.next_frame(&mut bytes).map_err(wrong)?;
    let bytes = &bytes[..info.buffer_size()];
    let levels = match (info.color_type, info.bit_depth) {
        (ColorType::Grayscale, BitDepth::Eight) => bytes.iter().map(|v| f64::from(*v) / 255.0).collect(),
        (ColorType::Grayscale, BitDepth::Sixteen) => {
            bytes.as_chunks().0.iter().map(|v| f64::from(u16::from_be_bytes(*v)) / 65535.0).collect()
        }
        _ => {
            return Err((
                "it has colours or is transparent".to_owned(),
                "save it in grey levels, 8 or 16 bits a pixel",
            ));
        }
    };
    Ok(Grey { columns: info.width as usize, rows: info.height as usize, levels })
}

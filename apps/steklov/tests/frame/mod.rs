//! What every picture has to keep to. With `STEKLOV_PICTURES=DIR` the files stay in DIR to be looked at.

use std::path::PathBuf;

use steklov_picture::{Picture, write};

/// Edges with the numbers of their loops.
pub fn loops(corners: &[&[[f64; 2]]]) -> Vec<([f64; 2], [f64; 2], usize)> {
    let of = |l: usize, c: &[[f64; 2]]| (0..c.len()).map(|i| (c[i], c[(i + 1) % c.len()], l)).collect::<Vec<_>>();
    corners.iter().enumerate().flat_map(|(l, c)| of(l, c)).collect()
}

pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> [[f64; 2]; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// Every number that the SVG places something at lies in the frame, and every text too, by its estimated width.
pub fn check(name: &str, picture: &Picture) {
    check_up_to(name, picture, 900.0);
}

/// The same for a picture that may be as high as `highest`.
pub fn check_up_to(name: &str, picture: &Picture, highest: f64) {
    let svg = &picture.svg;
    // embedded pixels are letters at random
    let drawn = svg.lines().filter(|line| !line.contains("base64,"));
    assert!(drawn.clone().all(|line| !line.contains("NaN") && !line.contains("inf")), "{name}");
    let attribute = |line: &str, key: &str| -> Option<f64> {
        let rest = line.split(&format!(" {key}=\"")).nth(1)?;
        rest.split('"').next()?.parse().ok()
    };
    let height = attribute(svg.lines().next().unwrap(), "height").unwrap();
    assert!((200.0..highest).contains(&height), "{name}: height {height}");
    for line in drawn {
        if let Some(path) = line.split(" d=\"").nth(1).or(line.split("<path d=\"").nth(1)) {
            let numbers = path.split('"').next().unwrap().split(['M', 'L', 'Z', ' ']).filter(|s| !s.is_empty());
            let numbers: Vec<f64> = numbers.map(|s| s.parse().unwrap()).collect();
            for p in numbers.chunks(2) {
                assert!((0.0..=900.0).contains(&p[0]) && (0.0..=height).contains(&p[1]), "{name}: {p:?}");
            }
        }
        if line.contains("<text") {
            let (x, y) = (attribute(line, "x").unwrap(), attribute(line, "y").unwrap());
            let letters = line.split('>').nth(1).unwrap().split('<').next().unwrap().chars().count() as f64;
            let width = 0.6 * attribute(line, "font-size").unwrap() * letters;
            let (start, end) = if line.contains("\"start\"") {
                (x, x + width)
            } else if line.contains("\"end\"") {
                (x - width, x)
            } else {
                (x - width / 2.0, x + width / 2.0)
            };
            if line.contains("rotate") {
                let (top, bottom) = (y - width / 2.0, y + width / 2.0);
                assert!((10.0..=896.0).contains(&x) && top >= 0.0 && bottom <= height, "{name}: {line}");
            } else {
                assert!(start >= 0.0 && end <= 900.0 && y <= height - 4.0 && y > 10.0, "{name}: {line}");
            }
        }
    }
    let folder = std::env::var_os("STEKLOV_PICTURES").map(PathBuf::from);
    let temporary = tempfile::tempdir().unwrap();
    let [_, png] = write(folder.as_deref().unwrap_or(temporary.path()), name, picture).unwrap();
    let bytes = std::fs::read(png).unwrap();
    // Width and height stand at bytes 16 to 24 of a PNG file.
    let size = [16, 20].map(|i| u32::from_be_bytes(bytes[i..i + 4].try_into().unwrap()));
    assert_eq!(size, [1800, 2 * height as u32], "{name}");
}

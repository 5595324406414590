//! Files of other kinds given in place of scenes.

/// The kind of a result file.
pub const HDF5: &str = "an HDF5 file";

/// The kind of a file that is no scene, recognised by its first bytes, and what to do with it.
pub fn foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    const DRAWING: &str = "a scene is TOML text: write the points of the drawing as body.corners, what is round as circle, ellipse, arcs \
                           or curves; `steklov new` prints a scene to start from";
    const OTHER: &str = "a scene is TOML text; `steklov new` prints one to start from";
    let start = &bytes[..bytes.len().min(4096)];
    let text = String::from_utf8_lossy(start);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let mut lines = text.lines().map(str::trim);
    let is_dxf = match (lines.next(), lines.next()) {
        (Some("0"), Some("SECTION")) | (Some("999"), Some(_)) => true,
        _ => text.starts_with("AutoCAD Binary DXF"),
    };
    if text.starts_with('<') && text.contains("<svg") {
        Some(("a drawing (SVG)", DRAWING))
    } else if is_dxf {
        Some(("a drawing (DXF)", DRAWING))
    } else if start.starts_with(b"AC10") {
        Some(("a drawing (DWG)", DRAWING))
    } else if text.starts_with("ISO-10303-21") {
        Some(("a drawing (STEP)", DRAWING))
    } else if start.starts_with(b"%PDF") || start.starts_with(b"%!PS") {
        Some(("a page (PDF or PostScript)", DRAWING))
    } else if start.starts_with(b"\x89PNG") || start.starts_with(b"\xff\xd8\xff") {
        Some(("a picture (PNG or JPEG)", OTHER))
    } else if start.starts_with(b"\x93NUMPY") {
        Some(("an array of NumPy (.npy)", OTHER))
    } else if start.starts_with(b"\x89HDF") {
        Some((HDF5, "`steklov show` shows a result; the scene that it was made of is its data set `scene`"))
    } else {
        None
    }
}

//! The list of shapes of a picture: thin functions over kuva's scene, from which both SVG and PNG are made.

use super::raster::Raster;
use super::upright::upright;
use super::{Picture, PictureError};
use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use std::fmt::Write as _;

/// Width of every picture.
pub(super) const WIDTH: f64 = 900.0;

/// Pixels of the PNG per unit of the frame.
pub(super) const PIXELS: f64 = 2.0;

pub(super) const BLACK: Color = Color::Rgb(20, 20, 20);
pub(super) const GREY: Color = Color::Rgb(110, 110, 110);
pub(super) const LIGHT: Color = Color::Rgb(222, 222, 222);

/// Axis-aligned rectangle in the frame, y downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// Size of the letters of a title, and height of a line of it.
const TITLE_TEXT: u32 = 19;
const TITLE_LINE: f64 = 25.0;

/// The title above a picture, in at most three lines.
pub(super) struct Title(Vec<String>);

impl Title {
    pub fn new(text: &str) -> Self {
        Self(wrap(text, TITLE_TEXT, WIDTH - 40.0, 3))
    }

    pub fn height(&self) -> f64 {
        TITLE_LINE * self.0.len() as f64
    }
}

/// Colour, width, and lengths of dash and pause of a line.
#[derive(Debug, Clone)]
pub(super) struct Pen {
    pub colour: Color,
    pub width: f64,
    pub dash: Option<[f64; 2]>,
}

impl Pen {
    pub fn solid(colour: Color, width: f64) -> Self {
        Self { colour, width, dash: None }
    }

    pub fn dashed(colour: Color, width: f64, dash: f64, pause: f64) -> Self {
        Self { colour, width, dash: Some([dash, pause]) }
    }
}

pub(super) struct Canvas {
    scene: Scene,
    /// SVG elements that replace the rectangles of a raster, with their positions among the shapes.
    images: Vec<(usize, String)>,
}

impl Canvas {
    pub fn new(height: f64) -> Self {
        let mut scene = Scene::new(WIDTH, height.ceil());
        scene.font_family = Some("sans-serif".to_owned());
        Self { scene, images: Vec::new() }
    }

    /// A title whose first base line is at y.
    pub fn title(&mut self, title: &Title, y: f64) {
        for (i, line) in title.0.iter().enumerate() {
            self.text([WIDTH / 2.0, y + TITLE_LINE * i as f64], line, TITLE_TEXT, TextAnchor::Middle);
        }
    }

    /// Open polylines drawn as one shape; dashes run on over their corners.
    pub fn lines(&mut self, lines: &[Vec<[f64; 2]>], pen: &Pen) {
        let mut path = String::new();
        for line in lines {
            match pen.dash {
                None => add_path(&mut path, line, false),
                Some(dash) => dashes(line, dash).iter().for_each(|d| add_path(&mut path, d, false)),
            }
        }
        self.path(path, None, pen.colour.clone(), pen.width);
    }

    pub fn line(&mut self, a: [f64; 2], b: [f64; 2], pen: &Pen) {
        self.lines(&[vec![a, b]], pen);
    }

    /// Filled polygons of one colour, with a hairline of the same colour that closes the gaps between neighbours.
    pub fn fill(&mut self, polygons: &[Vec<[f64; 2]>], colour: Color) {
        let mut path = String::new();
        polygons.iter().for_each(|p| add_path(&mut path, p, true));
        self.path(path, Some(colour.clone()), colour, 0.9);
    }

    fn path(&mut self, d: String, fill: Option<Color>, stroke: Color, stroke_width: f64) {
        if !d.is_empty() {
            let data = PathData { d, fill, stroke, stroke_width, opacity: None, stroke_dasharray: None };
            self.scene.add(Primitive::Path(Box::new(data)));
        }
    }

    /// A disc with a white rim.
    pub fn disc(&mut self, [cx, cy]: [f64; 2], r: f64, fill: Color) {
        let (stroke, stroke_width) = (Some(Color::Rgb(255, 255, 255)), Some(0.6));
        self.scene.add(Primitive::Circle { cx, cy, r, fill, fill_opacity: None, stroke, stroke_width });
    }

    /// Text whose base line starts, is centred or ends at the point.
    pub fn text(&mut self, [x, y]: [f64; 2], text: &str, size: u32, anchor: TextAnchor) {
        self.write(x, y, text, size, anchor, None);
    }

    /// Text that is read upwards, centred on the point.
    pub fn text_upwards(&mut self, [x, y]: [f64; 2], text: &str, size: u32) {
        self.write(x, y, text, size, TextAnchor::Middle, Some(-90.0));
    }

    fn write(&mut self, x: f64, y: f64, text: &str, size: u32, anchor: TextAnchor, rotate: Option<f64>) {
        // A dollar sign would start a formula.
        let content = text.replace('$', "\\$");
        self.scene.add(Primitive::Text { x, y, content, size, anchor, rotate, bold: false, color: Some(BLACK) });
    }

    /// Pixels in a frame of their size, whose corner lies on a pixel of the picture.
    pub fn raster(&mut self, frame: Rect, raster: &Raster) -> Result<(), PictureError> {
        let (rectangles, element) = raster.drawn(frame)?;
        self.images.push((self.scene.elements.len(), element));
        self.scene.add(rectangles);
        Ok(())
    }

    pub fn finish(mut self) -> Result<Picture, PictureError> {
        // the PNG gets texts that are read upwards as pixels, the SVG as text
        let mut texts = Vec::new();
        for (place, element) in self.scene.elements.iter_mut().enumerate() {
            if let Primitive::Text { x, y, content, size, rotate: Some(_), .. } = element {
                let pixels = upright([*x, *y], content, *size)?;
                texts.push((place, std::mem::replace(element, pixels)));
            }
        }
        let png =
            RasterBackend::new().with_scale(PIXELS as f32).render_scene(&self.scene).map_err(PictureError::Raster)?;
        texts.into_iter().for_each(|(place, text)| self.scene.elements[place] = text);
        for (k, (place, _)) in self.images.iter().enumerate().rev() {
            let extra_attrs = Some(format!("id=\"raster-{k}\""));
            let group = Primitive::GroupStart { transform: None, title: None, extra_attrs };
            self.scene.elements.splice(place..=place, [group, Primitive::GroupEnd]);
        }
        let view_box = format!("<svg viewBox=\"0 0 {WIDTH} {}\" ", self.scene.height);
        let mut svg = SvgBackend::new().with_pretty(true).render_scene(&self.scene).replacen("<svg ", &view_box, 1);
        for (k, (_, element)) in self.images.iter().enumerate() {
            let group = format!("<g id=\"raster-{k}\">");
            svg = svg.replacen(&group, &format!("<g>\n{element}"), 1);
        }
        Ok(Picture { svg, png })
    }
}

fn add_path(path: &mut String, points: &[[f64; 2]], close: bool) {
    for (i, p) in points.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(path, "{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, p[0], p[1]);
    }
    if close {
        path.push('Z');
    }
}

/// The dashes of a polyline, measured along its length.
fn dashes(line: &[[f64; 2]], [dash, pause]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut result = Vec::new();
    let mut current: Vec<[f64; 2]> = line.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, dash);
    for w in line.windows(2) {
        let (mut a, b) = (w[0], w[1]);
        loop {
            let rest = (b[0] - a[0]).hypot(b[1] - a[1]);
            if rest <= left {
                left -= rest;
                if drawing {
                    current.push(b);
                }
                break;
            }
            let s = left / rest;
            a = [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
            current.push(a);
            if drawing {
                result.push(std::mem::take(&mut current));
            } else {
                current = vec![a];
            }
            drawing = !drawing;
            left = if drawing { dash } else { pause };
        }
    }
    if drawing && current.len() > 1 {
        result.push(current);
    }
    result
}

/// Pieces of a polyline inside a rectangle. A point that is not finite breaks the line.
pub(super) fn clip(line: &[[f64; 2]], rect: Rect) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut joined = false;
    for w in line.windows(2) {
        match clip_segment(w[0], w[1], rect) {
            Some((a, b)) => {
                match pieces.last_mut() {
                    Some(piece) if joined && a == w[0] => piece.push(b),
                    _ => pieces.push(vec![a, b]),
                }
                joined = b == w[1];
            }
            None => joined = false,
        }
    }
    pieces
}

/// Part of a segment inside a rectangle (Liang and Barsky 1984).
fn clip_segment(a: [f64; 2], b: [f64; 2], rect: Rect) -> Option<([f64; 2], [f64; 2])> {
    if [a, b].iter().flatten().any(|v| !v.is_finite()) {
        return None;
    }
    let d = [b[0] - a[0], b[1] - a[1]];
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (p, q) in
        [(-d[0], a[0] - rect.left), (d[0], rect.right() - a[0]), (-d[1], a[1] - rect.top), (d[1], rect.bottom() - a[1])]
    {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            enter = enter.max(q / p);
        } else {
            leave = leave.min(q / p);
        }
    }
    let at = |s: f64| [a[0] + s * d[0], a[1] + s * d[1]];
    let start = if enter == 0.0 { a } else { at(enter) };
    let end = if leave == 1.0 { b } else { at(leave) };
    (enter <= leave).then_some((start, end))
}

/// Width of a text, on the safe side for the usual sans-serif fonts.
pub(super) fn text_width(text: &str, size: u32) -> f64 {
    let letter = |c: char| match c {
        'i' | 'j' | 'l' | 't' | 'f' | 'r' | ' ' | '.' | ',' | ':' | '\'' | '(' | ')' | '|' => 0.42,
        'a'..='z' | '0'..='9' if !matches!(c, 'm' | 'w') => 0.64,
        _ => 1.0,
    };
    f64::from(size) * text.chars().map(letter).sum::<f64>()
}

/// Breaks a text into at most `lines` lines of a width, at spaces if possible; the last line ends with an ellipsis if
/// the text is longer.
pub(super) fn wrap(text: &str, size: u32, width: f64, lines: usize) -> Vec<String> {
    let room = (width / text_width("n", size)).floor().max(1.0) as usize;
    let mut result: Vec<String> = Vec::new();
    let mut current = String::new();
    for word in text.split_whitespace() {
        let letters: Vec<char> = word.chars().collect();
        for part in letters.chunks(room) {
            let needed = current.chars().count() + part.len() + usize::from(!current.is_empty());
            if needed > room {
                result.push(std::mem::take(&mut current));
            } else if !current.is_empty() {
                current.push(' ');
            }
            current.extend(part);
        }
    }
    result.extend((!current.is_empty()).then_some(current));
    if result.len() > lines {
        result.truncate(lines);
        if let Some(last) = result.last_mut() {
            *last = last.chars().take(room - 1).chain(['…']).collect();
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOX: Rect = Rect { left: 0.0, top: 0.0, width: 2.0, height: 1.0 };

    fn length(lines: &[Vec<[f64; 2]>]) -> f64 {
        lines.iter().flat_map(|l| l.windows(2)).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum()
    }

    #[test]
    fn dashes_run_over_corners() {
        let line = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [3.0, 5.0]];
        let d = dashes(&line, [2.0, 2.0]);
        assert_eq!(d, [vec![[0.0, 0.0], [2.0, 0.0]], vec![[3.0, 1.0], [3.0, 3.0]]]);
        assert_eq!(length(&dashes(&line, [9.0, 1.0])), 8.0);
        assert!(dashes(&[], [1.0, 1.0]).is_empty());
    }

    #[test]
    fn lines_are_cut_at_the_frame_and_at_gaps() {
        let through = clip(&[[-1e300, 0.5], [1.0, 0.5], [1.0, 7.0], [0.5, 7.0], [0.5, 0.5]], BOX);
        assert_eq!(through, [vec![[0.0, 0.5], [1.0, 0.5], [1.0, 1.0]], vec![[0.5, 1.0], [0.5, 0.5]]]);
        assert_eq!(clip(&[[0.0, 0.0], [f64::NAN, 0.0], [1.0, 0.0], [2.0, 0.0]], BOX), [vec![[1.0, 0.0], [2.0, 0.0]]]);
        assert!(clip(&[[-1.0, -1.0], [3.0, -1.0]], BOX).is_empty());
    }

    #[test]
    fn long_titles_are_broken_and_shortened() {
        assert_eq!(wrap("one two three", 10, 6.4 * 7.0, 3), ["one two", "three"]);
        assert_eq!(wrap("unbreakable", 10, 6.4 * 5.5, 3), ["unbre", "akabl", "e"]);
        assert_eq!(wrap("one two three four", 10, 6.4 * 5.0, 2), ["one", "two…"]);
        assert!(wrap("  ", 10, 100.0, 2).is_empty());
    }

    #[test]
    fn special_letters_are_safe_and_the_svg_has_a_view_box() {
        let mut c = Canvas::new(50.0);
        c.text([10.0, 20.0], "a < b & \"c\" costs $5 and $6 λ", 14, TextAnchor::Start);
        let p = c.finish().unwrap();
        assert!(p.svg.starts_with("<svg viewBox=\"0 0 900 50\" "));
        assert!(p.svg.contains("a &lt; b &amp; &quot;c&quot; costs $5 and $6 λ"), "{}", p.svg);
        assert_eq!(p.png[..8], [137, 80, 78, 71, 13, 10, 26, 10]);
    }

    #[test]
    fn rasters_keep_their_places_among_the_shapes() {
        let mut c = Canvas::new(50.0);
        let dot = |v: f64| Raster::new([2, 2], [0.0, 1.0], |_, _| v);
        let frame = |left: f64| Rect { left, top: 5.0, width: 1.0, height: 1.0 };
        c.raster(frame(3.0), &dot(0.0)).unwrap();
        c.line([0.0, 1.0], [7.0, 1.0], &Pen::solid(BLACK, 1.0));
        c.raster(frame(4.0), &dot(1.0)).unwrap();
        c.text([10.0, 20.0], "<g id=\"raster-0\">", 14, TextAnchor::Start);
        let svg = c.finish().unwrap().svg;
        let places = ["<image x=\"3\"", "<path", "<image x=\"4\"", "<text"].map(|s| svg.find(s).unwrap());
        assert!(places.is_sorted(), "{svg}");
        assert!(!svg.contains("<rect x=\"3\"") && svg.matches("<image").count() == 2);
    }

    proptest! {
        #[test]
        fn dashes_have_their_share_of_the_length(steps in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0), 2..30)) {
            let line: Vec<[f64; 2]> = steps.iter().map(|&(x, y)| [x, y]).collect();
            let total = length(std::slice::from_ref(&line));
            let drawn = length(&dashes(&line, [3.0, 2.0]));
            let rounds = (total / 5.0).floor();
            let expected = rounds * 3.0 + (total - rounds * 5.0).min(3.0);
            prop_assert!((drawn - expected).abs() < 1e-9 * (1.0 + total));
        }

        #[test]
        fn clipped_lines_stay_in_the_frame(steps in prop::collection::vec((-3.0f64..5.0, -3.0f64..5.0), 2..20)) {
            let line: Vec<[f64; 2]> = steps.iter().map(|&(x, y)| [x, y]).collect();
            let pieces = clip(&line, BOX);
            for p in pieces.iter().flatten() {
                prop_assert!((-1e-12..=2.0 + 1e-12).contains(&p[0]) && (-1e-12..=1.0 + 1e-12).contains(&p[1]));
            }
            // Length inside by brute force.
            let n = 2000;
            let inside: f64 = line.windows(2).map(|w| {
                let at = |s: f64| [w[0][0] + s * (w[1][0] - w[0][0]), w[0][1] + s * (w[1][1] - w[0][1])];
                let hits = (0..n).map(|i| at((f64::from(i) + 0.5) / f64::from(n)))
                    .filter(|p| (0.0..=2.0).contains(&p[0]) && (0.0..=1.0).contains(&p[1])).count();
                length(&[w.to_vec()]) * hits as f64 / f64::from(n)
            }).sum();
            prop_assert!((length(&pieces) - inside).abs() < 0.02 * line.len() as f64);
        }
    }
}

//! Triangles that show a slope, placed so that they cover no curve.

use super::axes::TICK_TEXT;
use super::canvas::{Canvas, GREY, Pen, Rect, clip, text_width};
use kuva::render::render::TextAnchor;

/// Length of the horizontal leg, shorter (but not shorter than the second) if the triangle would be higher than a part
/// of the frame.
const LEG: f64 = 80.0;
const SHORTEST: f64 = 8.0;
const HIGHEST: f64 = 0.3;

/// Space kept around a triangle.
const CLEAR: f64 = 10.0;

/// Places tried in each direction.
const TRIED: usize = 40;

/// A right triangle whose longest side has the slope, with its label below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slope<'a> {
    label: &'a str,
    /// Horizontal leg and signed height, positive upwards.
    width: f64,
    rise: f64,
    /// Box of triangle and label.
    area: Rect,
}

impl Slope<'_> {
    pub fn draw(&self, canvas: &mut Canvas) {
        let middle = self.area.left + self.area.width / 2.0;
        let (left, right) = (middle - self.width / 2.0, middle + self.width / 2.0);
        let (top, bottom) = (self.area.top, self.area.top + self.rise.abs());
        let (upright, far) = if self.rise < 0.0 { (left, right) } else { (right, left) };
        let corners = vec![[upright, bottom], [far, bottom], [upright, top], [upright, bottom], [far, bottom]];
        canvas.lines(&[corners], &Pen::solid(GREY, 1.2));
        canvas.text([middle, bottom + 16.0], self.label, TICK_TEXT, TextAnchor::Middle);
    }
}

/// The free place in the frame that is nearest to a curve, for a triangle that rises `slope` pixels per pixel.
///
/// None if no place is free or the slope is too steep for a triangle.
pub(super) fn place<'a>(
    label: &'a str,
    slope: f64,
    frame: Rect,
    lines: &[Vec<[f64; 2]>],
    taken: &[Slope<'_>],
) -> Option<Slope<'a>> {
    let width = LEG.min(HIGHEST * frame.height / slope.abs());
    if slope.is_nan() || width < SHORTEST {
        return None;
    }
    let rise = slope * width;
    let needed = [text_width(label, TICK_TEXT).max(width) + 2.0 * CLEAR, rise.abs() + 20.0 + 2.0 * CLEAR];
    let room = [frame.width - needed[0], frame.height - needed[1]];
    if room[0] < 0.0 || room[1] < 0.0 {
        return None;
    }
    let share = |i: usize| (i as f64 + 0.5) / TRIED as f64;
    let places = (0..TRIED).flat_map(|i| (0..TRIED).map(move |j| [share(i), share(j)])).map(|[s, t]| {
        let (left, top) = (frame.left + s * room[0], frame.top + t * room[1]);
        Rect { left, top, width: needed[0], height: needed[1] }
    });
    let free = places.filter(|r| {
        let apart = |o: &Rect| r.left > o.right() || o.left > r.right() || r.top > o.bottom() || o.top > r.bottom();
        taken.iter().all(|o| apart(&o.area)) && lines.iter().all(|l| misses(l, *r))
    });
    let distance = |r: &Rect| {
        let centre = [r.left + r.width / 2.0, r.top + r.height / 2.0];
        let to = |p: &[f64; 2]| (p[0] - centre[0]).hypot(p[1] - centre[1]);
        lines.iter().flatten().map(to).filter(|d| d.is_finite()).fold(f64::INFINITY, f64::min)
    };
    let nearest = free.map(|r| (distance(&r), r)).min_by(|a, b| a.0.total_cmp(&b.0))?.1;
    let area = Rect {
        left: nearest.left + CLEAR,
        top: nearest.top + CLEAR,
        width: nearest.width - 2.0 * CLEAR,
        height: nearest.height - 2.0 * CLEAR,
    };
    Some(Slope { label, width, rise, area })
}

/// Whether neither a point nor a piece of a line lies in a rectangle.
pub(super) fn misses(line: &[[f64; 2]], r: Rect) -> bool {
    let inside = |p: &[f64; 2]| (r.left..=r.right()).contains(&p[0]) && (r.top..=r.bottom()).contains(&p[1]);
    !line.iter().any(inside) && clip(line, r).is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Rect = Rect { left: 100.0, top: 50.0, width: 500.0, height: 400.0 };

    #[test]
    fn a_full_frame_has_no_place_and_an_empty_one_has() {
        let full: Vec<Vec<[f64; 2]>> =
            (0..20).map(|i| vec![[100.0, 50.0 + 20.0 * f64::from(i)], [600.0, 50.0 + 20.0 * f64::from(i)]]).collect();
        assert!(place("N^-1", -0.5, FRAME, &full, &[]).is_none());
        assert!(place("N^-1", -0.5, FRAME, &[], &[]).is_some());
        for slope in [f64::NAN, f64::INFINITY, -15.1] {
            assert!(place("N^-1", slope, FRAME, &[], &[]).is_none());
        }
        assert!(place("N^-1", -14.9, FRAME, &[], &[]).is_some());
    }

    proptest! {
        #[test]
        fn triangles_have_their_slope_stay_inside_and_cover_nothing(
            steps in prop::collection::vec((100.0f64..600.0, 50.0f64..450.0), 1..12),
            slopes in prop::collection::vec(-9.0f64..9.0, 1..5),
        ) {
            let line = vec![steps.iter().map(|&(x, y)| [x, y]).collect::<Vec<_>>()];
            let mut found: Vec<Slope<'_>> = Vec::new();
            for slope in slopes {
                if let Some(s) = place("N^-1.5", slope, FRAME, &line, &found) {
                    prop_assert!((s.rise - slope * s.width).abs() < 1e-9);
                    prop_assert!(s.width <= s.area.width + 1e-9 && s.rise.abs() + 19.0 < s.area.height);
                    prop_assert!(s.area.left > FRAME.left && s.area.right() < FRAME.right());
                    prop_assert!(s.area.top > FRAME.top && s.area.bottom() < FRAME.bottom());
                    // By brute force: points of the line keep away from the box.
                    let a = s.area;
                    for w in line[0].windows(2) {
                        for i in 0..=2000 {
                            let t = f64::from(i) / 2000.0;
                            let p = [w[0][0] + t * (w[1][0] - w[0][0]), w[0][1] + t * (w[1][1] - w[0][1])];
                            prop_assert!(p[0] < a.left || p[0] > a.right() || p[1] < a.top || p[1] > a.bottom());
                        }
                    }
                    for o in &found {
                        let b = o.area;
                        prop_assert!(a.left > b.right() || b.left > a.right() || a.top > b.bottom() || b.top > a.bottom());
                    }
                    found.push(s);
                }
            }
        }
    }
}

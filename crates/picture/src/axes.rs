//! A framed plotting area with ticks and axis titles.

use super::canvas::{BLACK, Canvas, LIGHT, Pen, Rect, text_width};
use super::scale::{Ticks, ticks};
use kuva::render::render::TextAnchor;

/// Size of the letters at the ticks, and of axis titles and keys.
pub(super) const TICK_TEXT: u32 = 13;
pub(super) const LABEL_TEXT: u32 = 15;

/// Height that tick labels and title of an x axis take below the frame.
pub(super) const BELOW: f64 = 46.0;

/// A frame and the intervals of x and y that it shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    pub frame: Rect,
    pub x: [f64; 2],
    pub y: [f64; 2],
}

impl Axes {
    /// Place of a point in the picture. Halves prevent overflow in the widest intervals.
    pub fn at(&self, p: [f64; 2]) -> [f64; 2] {
        let share = |v: f64, [low, high]: [f64; 2]| (v / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0);
        let (s, t) = (share(p[0], self.x), share(p[1], self.y));
        [self.frame.left + s * self.frame.width, self.frame.bottom() - t * self.frame.height]
    }

    /// The largest number of ticks whose labels do not touch.
    fn x_ticks(&self) -> Ticks {
        let mut n = (self.frame.width / 75.0).max(2.0) as usize;
        loop {
            let t = ticks(self.x[0], self.x[1], n);
            let widest = widest_label(&t) + 12.0;
            if n <= 1 || widest * t.labels.len() as f64 <= self.frame.width {
                return t;
            }
            n -= 1;
        }
    }

    fn y_ticks(&self) -> Ticks {
        ticks(self.y[0], self.y[1], (self.frame.height / 40.0).max(2.0) as usize)
    }

    /// Width that tick labels and title of the y axis take left of the frame.
    pub fn left_margin(&self) -> f64 {
        widest_label(&self.y_ticks()) + 44.0
    }

    /// Draws the x axis alone, with light lines at its ticks.
    pub fn draw_x(&self, canvas: &mut Canvas, title: Option<&str>) {
        let (f, x, pen) = (self.frame, self.x_ticks(), Pen::solid(BLACK, 1.0));
        for (&v, label) in x.values.iter().zip(&x.labels) {
            let p = self.at([v, self.y[0]])[0];
            canvas.line([p, f.top], [p, f.bottom()], &Pen::solid(LIGHT, 1.0));
            canvas.line([p, f.bottom()], [p, f.bottom() + 5.0], &pen);
            if title.is_some() {
                canvas.text([p, f.bottom() + 19.0], label, TICK_TEXT, TextAnchor::Middle);
            }
        }
        canvas.line([f.left, f.bottom()], [f.right(), f.bottom()], &pen);
        if let Some(title) = title {
            let middle = [f.left + f.width / 2.0, f.bottom() + 40.0];
            canvas.text(middle, &x.title(title), LABEL_TEXT, TextAnchor::Middle);
        }
    }

    /// Draws frame, ticks, labels and titles; with `grid` light lines at the ticks. Without an x title there are no x
    /// labels. The y title is at the left end of `left_margin`.
    pub fn draw(&self, canvas: &mut Canvas, x_title: Option<&str>, y_title: &str, left_margin: f64, grid: bool) {
        let f = self.frame;
        let (x, y) = (self.x_ticks(), self.y_ticks());
        let pen = Pen::solid(BLACK, 1.0);
        if grid {
            let vertical =
                x.values.iter().map(|&v| self.at([v, self.y[0]])[0]).map(|v| vec![[v, f.top], [v, f.bottom()]]);
            let level = y.values.iter().map(|&v| self.at([self.x[0], v])[1]).map(|v| vec![[f.left, v], [f.right(), v]]);
            canvas.lines(&vertical.chain(level).collect::<Vec<_>>(), &Pen::solid(LIGHT, 1.0));
        }
        for (&v, label) in x.values.iter().zip(&x.labels) {
            let p = self.at([v, self.y[0]])[0];
            canvas.line([p, f.bottom()], [p, f.bottom() + 5.0], &pen);
            if x_title.is_some() {
                canvas.text([p, f.bottom() + 19.0], label, TICK_TEXT, TextAnchor::Middle);
            }
        }
        for (&v, label) in y.values.iter().zip(&y.labels) {
            let p = self.at([self.x[0], v])[1];
            canvas.line([f.left - 5.0, p], [f.left, p], &pen);
            canvas.text([f.left - 9.0, p + 4.5], label, TICK_TEXT, TextAnchor::End);
        }
        let corners =
            [[f.left, f.top], [f.right(), f.top], [f.right(), f.bottom()], [f.left, f.bottom()], [f.left, f.top]];
        canvas.lines(&[corners.to_vec()], &pen);
        if let Some(title) = x_title {
            let middle = [f.left + f.width / 2.0, f.bottom() + 40.0];
            canvas.text(middle, &x.title(title), LABEL_TEXT, TextAnchor::Middle);
        }
        let middle = [f.left - left_margin + 22.0, f.top + f.height / 2.0];
        canvas.text_upwards(middle, &y.title(y_title), LABEL_TEXT);
    }
}

fn widest_label(t: &Ticks) -> f64 {
    t.labels.iter().map(|l| text_width(l, TICK_TEXT)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn corners_of_the_interval_are_corners_of_the_frame_and_labels_fit(
            low in -1e3f64..1e3, width in 1e-6f64..1e3, power in -280i32..280, pixels in 120.0f64..800.0
        ) {
            let unit = 10f64.powi(power);
            let x = [low * unit, (low + width) * unit];
            let frame = Rect { left: 90.0, top: 40.0, width: pixels, height: 200.0 };
            let axes = Axes { frame, x, y: [-1.0, 3.0] };
            prop_assert!((axes.at([x[0], -1.0])[0] - frame.left).abs() < 1e-9);
            prop_assert!((axes.at([x[1], -1.0])[0] - frame.right()).abs() < 1e-9);
            prop_assert_eq!(axes.at([x[0], -1.0])[1], frame.bottom());
            prop_assert_eq!(axes.at([x[0], 3.0])[1], frame.top);
            let t = axes.x_ticks();
            let places: Vec<f64> = t.values.iter().map(|&v| axes.at([v, 0.0])[0]).collect();
            for (p, l) in places.windows(2).zip(t.labels.windows(2)) {
                prop_assert!(p[1] - p[0] > (text_width(&l[0], TICK_TEXT) + text_width(&l[1], TICK_TEXT)) / 2.0);
            }
        }
    }
}

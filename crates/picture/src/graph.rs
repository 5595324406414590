//! A framed plotting area whose axes are linear, logarithmic or of square roots.

use super::axes::{Axes, LABEL_TEXT, TICK_TEXT};
use super::canvas::{BLACK, Canvas, LIGHT, Pen, text_width};
use super::scale::{power, short, ticks};
use kuva::render::render::TextAnchor;

/// Values beyond this are not drawn, so that no interval overflows.
const LARGEST: f64 = 1e300;

/// How an axis maps its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps for equal differences; the axis contains zero.
    Linear,
    /// Equal steps for equal factors; for positive values.
    Log,
    /// Equal steps for equal differences of the square roots, labelled by the values themselves; for values ≥ 0. A
    /// logarithm that falls like exp(-b √N) is a straight line over N.
    SquareRoot,
}

impl Scale {
    /// The coordinate in which the axis is linear: v, log10 v or √v; NaN if v has none.
    pub(super) fn of(self, v: f64) -> f64 {
        match self {
            _ if v.is_nan() || v.abs() > LARGEST => f64::NAN,
            Self::Linear => v,
            Self::Log if v > 0.0 => v.log10(),
            Self::SquareRoot if v >= 0.0 => v.sqrt(),
            _ => f64::NAN,
        }
    }

    /// Interval that contains all finite coordinates, with a margin.
    pub(super) fn interval(self, coordinates: impl Iterator<Item = f64>) -> [f64; 2] {
        let start = if self == Self::Linear { [0.0, 0.0] } else { [f64::INFINITY, f64::NEG_INFINITY] };
        let [low, high] = coordinates.filter(|v| v.is_finite()).fold(start, |[l, h], v| [l.min(v), h.max(v)]);
        let margin = 0.05 * (high - low);
        match self {
            _ if low > high => [0.0, 1.0],
            Self::Linear if low == high => [0.0, 1.0],
            Self::Linear => {
                [if low == 0.0 { 0.0 } else { low - margin }, if high == 0.0 { 0.0 } else { high + margin }]
            }
            // At least a factor of ten is shown, so that rounding errors do not fill the frame.
            Self::Log => {
                let margin = margin.max((1.0 - (high - low)) / 2.0);
                [low - margin, high + margin]
            }
            // At least a tenth of the largest root is shown, so that labels of five digits distinguish the ticks.
            Self::SquareRoot if high == 0.0 => [0.0, 1.0],
            Self::SquareRoot => {
                let margin = margin.max((0.1 * high - (high - low)) / 2.0);
                [(low - margin).max(0.0), high + margin]
            }
        }
    }
}

/// One labelled tick: its coordinate (see [`Scale::of`]) and its label.
type Mark = (f64, String);

/// Ticks of one axis and the suffix of its title.
#[derive(Debug, Clone, PartialEq)]
struct Marks {
    labelled: Vec<Mark>,
    /// Coordinates of small ticks without labels.
    small: Vec<f64>,
    /// Power of ten that the labels leave out, as [`super::scale::Ticks`] writes it.
    suffix: String,
}

/// The densest round ticks of an interval of coordinates that `fits` accepts.
fn marks(scale: Scale, [low, high]: [f64; 2], fits: impl Fn(&[Mark]) -> bool) -> Marks {
    let plain = |coordinate: fn(f64) -> f64, label: fn(f64, String) -> String, ends: [f64; 2]| {
        let some = (1..12).rev().map(|n| ticks(ends[0], ends[1], n)).map(|t| {
            let suffix = t.title("");
            let place = |v: &f64| coordinate(*v);
            let labelled = t.values.iter().zip(t.labels).map(|(v, l)| (place(v), label(*v, l))).collect();
            Marks { labelled, small: Vec::new(), suffix }
        });
        some.collect::<Vec<_>>()
    };
    let candidates = match scale {
        Scale::Linear => plain(|v| v, |_, l| l, [low, high]),
        Scale::SquareRoot => {
            let mut all = plain(|v| v, |v, _| short(v * v, 5), [low, high]);
            all.iter_mut().for_each(|m| m.suffix.clear());
            all
        }
        Scale::Log => log_marks(low, high),
    };
    let last = candidates.last().cloned();
    let chosen = candidates.into_iter().find(|m| !m.labelled.is_empty() && fits(&m.labelled)).or(last);
    chosen.unwrap_or(Marks { labelled: Vec::new(), small: Vec::new(), suffix: String::new() })
}

/// Choices of logarithmic ticks, densest first: 1 to 9 over about a decade, 1, 2, 5 over about two, powers of ten, fewer
/// powers.
fn log_marks(low: f64, high: f64) -> Vec<Marks> {
    let inside = |c: f64| c >= low - 1e-9 && c <= high + 1e-9;
    let powers = || (low.floor() as i32)..=(high.ceil() as i32);
    let digits = |digits: &[u32]| -> Vec<(u32, i32)> {
        powers().flat_map(|k| digits.iter().map(move |&d| (d, k)).collect::<Vec<_>>()).collect()
    };
    let coordinate = |(d, k): (u32, i32)| f64::from(d).log10() + f64::from(k);
    let few = high - low <= 20.0;
    let small: Vec<f64> = if few {
        digits(&[1, 2, 3, 4, 5, 6, 7, 8, 9]).into_iter().map(coordinate).filter(|&c| inside(c)).collect()
    } else {
        Vec::new()
    };
    let mut result = Vec::new();
    for (some, widest) in [(&[1, 2, 3, 4, 5, 6, 7, 8, 9][..], 1.2), (&[1, 2, 5], 2.5)] {
        if high - low <= widest {
            let labelled = digits(some).into_iter().filter(|&p| inside(coordinate(p)));
            let label = |(d, k): (u32, i32)| short(f64::from(d) * 10f64.powi(k), 1);
            let labelled = labelled.map(|p| (coordinate(p), label(p))).collect();
            result.push(Marks { labelled, small: small.clone(), suffix: String::new() });
        }
    }
    for step in [1, 2, 3, 5, 10, 20, 50, 100, 200] {
        let kept: Vec<i32> = powers().filter(|k| k % step == 0 && inside(f64::from(*k))).collect();
        let readable = kept.iter().all(|k| (-2..=4).contains(k));
        let label = |k: i32| if readable { short(10f64.powi(k), 1) } else { power(k) };
        let small = if step == 1 { small.clone() } else { kept.iter().map(|&k| f64::from(k)).collect() };
        let labelled = kept.iter().map(|&k| (f64::from(k), label(k))).collect();
        result.push(Marks { labelled, small, suffix: String::new() });
    }
    result
}

/// A frame and its two scales; the intervals of `axes` are coordinates (see [`Scale::of`]).
#[derive(Debug, Clone, Copy)]
pub(super) struct Graph {
    pub axes: Axes,
    pub x: Scale,
    pub y: Scale,
}

impl Graph {
    fn x_marks(&self) -> Marks {
        let pixels = |c: f64| self.axes.at([c, 0.0])[0];
        let half = |l: &str| text_width(l, TICK_TEXT) / 2.0;
        marks(self.x, self.axes.x, |m| {
            m.windows(2).all(|w| pixels(w[1].0) - pixels(w[0].0) > half(&w[0].1) + half(&w[1].1) + 12.0)
        })
    }

    fn y_marks(&self) -> Marks {
        let pixels = |c: f64| self.axes.at([0.0, c])[1];
        marks(self.y, self.axes.y, |m| m.windows(2).all(|w| pixels(w[0].0) - pixels(w[1].0) > 28.0))
    }

    /// Width that tick labels and title of the y axis take left of the frame.
    pub fn left_margin(&self) -> f64 {
        self.y_marks().labelled.iter().map(|m| text_width(&m.1, TICK_TEXT)).fold(0.0, f64::max) + 44.0
    }

    /// Draws grid, frame, ticks, labels and titles.
    pub fn draw(&self, canvas: &mut Canvas, x_title: &str, y_title: &str) {
        let f = self.axes.frame;
        let (x, y) = (self.x_marks(), self.y_marks());
        let across = |c: f64| self.axes.at([c, self.axes.y[0]])[0];
        let up = |c: f64| self.axes.at([self.axes.x[0], c])[1];
        let grid_x = x.labelled.iter().map(|m| across(m.0)).map(|p| vec![[p, f.top], [p, f.bottom()]]);
        let grid_y = y.labelled.iter().map(|m| up(m.0)).map(|p| vec![[f.left, p], [f.right(), p]]);
        canvas.lines(&grid_x.chain(grid_y).collect::<Vec<_>>(), &Pen::solid(LIGHT, 1.0));

        let mut lines = vec![vec![
            [f.left, f.top],
            [f.right(), f.top],
            [f.right(), f.bottom()],
            [f.left, f.bottom()],
            [f.left, f.top],
        ]];
        let tick_x = |c: f64, length: f64| vec![[across(c), f.bottom()], [across(c), f.bottom() + length]];
        let tick_y = |c: f64, length: f64| vec![[f.left - length, up(c)], [f.left, up(c)]];
        lines.extend(x.small.iter().map(|&c| tick_x(c, 3.0)));
        lines.extend(y.small.iter().map(|&c| tick_y(c, 3.0)));
        for (c, label) in &x.labelled {
            lines.push(tick_x(*c, 6.0));
            canvas.text([across(*c), f.bottom() + 20.0], label, TICK_TEXT, TextAnchor::Middle);
        }
        for (c, label) in &y.labelled {
            lines.push(tick_y(*c, 6.0));
            canvas.text([f.left - 9.0, up(*c) + 4.5], label, TICK_TEXT, TextAnchor::End);
        }
        canvas.lines(&lines, &Pen::solid(BLACK, 1.0));

        let below = [f.left + f.width / 2.0, f.bottom() + 40.0];
        canvas.text(below, &format!("{x_title}{}", x.suffix), LABEL_TEXT, TextAnchor::Middle);
        let beside = [f.left - self.left_margin() + 22.0, f.top + f.height / 2.0];
        canvas.text_upwards(beside, &format!("{y_title}{}", y.suffix), LABEL_TEXT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Rect;
    use proptest::prelude::*;

    const FRAME: Rect = Rect { left: 90.0, top: 40.0, width: 560.0, height: 420.0 };

    fn graph(x: Scale, y: Scale, values: [[f64; 2]; 2]) -> Graph {
        let [x_ends, y_ends] = [0, 1].map(|i| {
            let scale = [x, y][i];
            scale.interval(values.iter().map(|v| scale.of(v[i])))
        });
        Graph { axes: Axes { frame: FRAME, x: x_ends, y: y_ends }, x, y }
    }

    fn labels(m: &Marks) -> Vec<&str> {
        m.labelled.iter().map(|m| m.1.as_str()).collect()
    }

    /// The number that a label states.
    fn said(label: &str) -> f64 {
        let plain = label.replace('\u{2212}', "-");
        let lowered = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|r| r == c).map_or('-', |d| (b'0' + d as u8) as char);
        let raised: String = plain.chars().filter(|c| "⁻⁰¹²³⁴⁵⁶⁷⁸⁹".contains(*c)).map(lowered).collect();
        if raised.is_empty() {
            return plain.parse().unwrap();
        }
        let factor: f64 = plain.split_once('·').map_or(1.0, |(m, _)| m.parse().unwrap());
        factor * 10f64.powi(raised.parse().unwrap())
    }

    #[test]
    fn coordinates_and_values_without_one() {
        assert_eq!((Scale::Linear.of(-2.0), Scale::Log.of(1e-3), Scale::SquareRoot.of(9.0)), (-2.0, -3.0, 3.0));
        for (scale, v) in [
            (Scale::Log, 0.0),
            (Scale::Log, -1.0),
            (Scale::SquareRoot, -1.0),
            (Scale::Linear, f64::INFINITY),
            (Scale::Log, f64::INFINITY),
            (Scale::Linear, f64::NAN),
        ] {
            assert!(scale.of(v).is_nan(), "{scale:?} of {v}");
        }
    }

    #[test]
    fn usual_axes_of_a_convergence_plot() {
        let g = graph(Scale::Log, Scale::Log, [[32.0, 1e-7], [1000.0, 0.2]]);
        assert_eq!(labels(&g.x_marks()), ["50", "100", "200", "500", "1000"]);
        assert_eq!(labels(&g.y_marks()), ["10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"]);
        let g = graph(Scale::SquareRoot, Scale::Linear, [[16.0, 0.9], [900.0, 2.2]]);
        assert_eq!(labels(&g.x_marks())[..3], ["25", "100", "225"]);
        assert_eq!(labels(&g.y_marks())[0], "0.0");
        let decades = graph(Scale::Log, Scale::Log, [[1.0, 1e-14], [1e6, 1e3]]);
        assert!((5..=10).contains(&decades.y_marks().labelled.len()), "{:?}", labels(&decades.y_marks()));
    }

    #[test]
    fn powers() {
        assert_eq!((power(-14), power(0), power(3)), ("10⁻¹⁴".to_owned(), "10⁰".to_owned(), "10³".to_owned()));
    }

    proptest! {
        #[test]
        fn labels_say_where_they_stand_and_do_not_touch(
            kind in 0usize..3, a in -12.0f64..12.0, width in 0.0f64..18.0
        ) {
            let scale = [Scale::Linear, Scale::Log, Scale::SquareRoot][kind];
            let ends = [10f64.powf(a), 10f64.powf(a + width)];
            let g = graph(scale, scale, [[ends[0]; 2], [ends[1]; 2]]);
            for (m, ends, space) in [(g.x_marks(), g.axes.x, FRAME.width), (g.y_marks(), g.axes.y, FRAME.height)] {
                prop_assert!(!m.labelled.is_empty());
                let unit = if m.suffix.is_empty() { 1.0 } else { said(m.suffix.trim_matches([' ', '(', ')', '×'])) };
                for (c, label) in &m.labelled {
                    prop_assert!(*c > ends[0] - 1e-6 && *c < ends[1] + 1e-6 * ends[1].abs().max(1.0));
                    // Squares keep five digits.
                    let value = said(label) * unit;
                    prop_assert!((scale.of(value) - c).abs() <= 5e-4 * (ends[1] - ends[0]), "{label} at {c}");
                }
                let gap = |w: &[Mark]| (w[1].0 - w[0].0) / (ends[1] - ends[0]) * space;
                prop_assert!(m.labelled.windows(2).all(|w| gap(w) > 20.0));
                prop_assert!(m.labelled.windows(2).all(|w| w[0].1 != w[1].1));
            }
            // Both values lie inside of the frame.
            for v in ends {
                let p = g.axes.at([scale.of(v), scale.of(v)]);
                prop_assert!(p[0] >= FRAME.left - 1e-9 && p[0] <= FRAME.right() + 1e-9);
                prop_assert!(p[1] >= FRAME.top - 1e-9 && p[1] <= FRAME.bottom() + 1e-9);
            }
        }
    }
}

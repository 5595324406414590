//! Strongly refined sides with elements of equal width: degree upwards, length downwards; linear elements have the
//! length alone.

use super::canvas::{BLACK, Canvas, LIGHT, Pen, Rect, text_width, wrap};
use super::mesh::{MeshPanel, Shades, finite};
use super::scale::power;
use kuva::render::color::Color;
use kuva::render::render::TextAnchor;

/// A side is drawn if it has an element below this share of its length.
const SHORT: f64 = 0.02;

/// More sides than this are not drawn.
const MOST: usize = 8;

/// Heights: degrees (with a head for the figures above the bars), space, lengths, and the sum.
const DEGREES: f64 = 96.0;
const HEAD: f64 = 15.0;
const SPACE: f64 = 6.0;
const LENGTHS: f64 = 82.0;
pub(super) const STRIP: f64 = DEGREES + SPACE + LENGTHS;

/// Space between two sides, and the widest bar.
const BETWEEN: f64 = 14.0;
const WIDEST: f64 = 24.0;

const NAME_TEXT: u32 = 12;
const NUMBER_TEXT: u32 = 10;
const BAR: Color = Color::Rgb(150, 150, 150);

/// Number of a named side.
pub(super) type Side = usize;

/// The sides that have an element under 2 % of them in one of the meshes, at most [`MOST`], and how many more there
/// are.
pub(super) fn sides(panels: &[MeshPanel<'_>]) -> (Vec<Side>, usize) {
    let number = panels.iter().flat_map(|p| p.side).max().map_or(0, |s| s + 1);
    let least = |s: Side| panels.iter().flat_map(|p| shares(p, s)).map(|e| e.1).fold(1.0, f64::min);
    let mut found: Vec<(Side, f64)> = (0..number).map(|s| (s, least(s))).filter(|f| f.1 < SHORT).collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let hidden = found.len().saturating_sub(MOST);
    let mut kept: Vec<Side> = found.into_iter().take(MOST).map(|f| f.0).collect();
    kept.sort_unstable();
    (kept, hidden)
}

/// Element number and length over the length of the side, in order.
fn shares(panel: &MeshPanel<'_>, side: Side) -> Vec<(usize, f64)> {
    let length = |i: usize| {
        let [a, b] = panel.elements[i];
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    let on = (0..panel.elements.len()).filter(|&i| panel.side[i] == side && finite(&panel.elements[i]));
    let lengths: Vec<(usize, f64)> = on.map(|i| (i, length(i))).collect();
    let total: f64 = lengths.iter().map(|l| l.1).sum();
    lengths.into_iter().map(|(i, l)| (i, l / total)).filter(|l| l.1.is_finite()).collect()
}

/// Sides and scales of all panels of a figure, so that the panels can be compared.
pub(super) struct Strips<'a> {
    sides: &'a [Side],
    names: &'a [String],
    /// Highest degree.
    degree: usize,
    /// Heights of degrees, with the space below them, and of lengths.
    degrees: f64,
    lengths: f64,
    /// The length axis ends at 10 to the power of minus this.
    decades: i32,
}

impl<'a> Strips<'a> {
    pub fn new(panels: &[MeshPanel<'_>], sides: &'a [Side], names: &'a [String]) -> Self {
        let degree = panels.iter().flat_map(|p| p.degree).max().map_or(1, |&p| p.max(1));
        let every = || panels.iter().flat_map(|p| sides.iter().flat_map(|&s| shares(p, s)));
        let least = every().map(|e| e.1).filter(|&l| l > 0.0).fold(1.0, f64::min);
        let [degrees, lengths] = if degree == 1 { [0.0, STRIP] } else { [DEGREES + SPACE, LENGTHS] };
        Self { sides, names, degree, degrees, lengths, decades: (-least.log10()).ceil().clamp(1.0, 20.0) as i32 }
    }

    /// Draws the sides of one mesh between two x, names above `top`.
    pub fn draw(&self, canvas: &mut Canvas, [left, right]: [f64; 2], top: f64, panel: &MeshPanel<'_>, shades: &Shades) {
        let slot = (right - left + BETWEEN) / self.sides.len() as f64 - BETWEEN;
        let place = |i: usize| left + i as f64 * (slot + BETWEEN);
        self.axes(canvas, left, top);
        for (i, &side) in self.sides.iter().enumerate() {
            let above = Rect { left: place(i), top, width: slot, height: DEGREES };
            let below = Rect { top: top + self.degrees, height: self.lengths, ..above };
            self.grid(canvas, above, below);
            let name = wrap(&self.names[side], NAME_TEXT, slot + BETWEEN, 2);
            for (k, line) in name.iter().enumerate() {
                let y = top - 5.0 - 15.0 * (name.len() - 1 - k) as f64;
                canvas.text([above.left + slot / 2.0, y], line, NAME_TEXT, TextAnchor::Middle);
            }
            self.bars(canvas, above, below, &shares(panel, side), panel.degree, shades);
            if self.has_degrees() {
                canvas.line([above.left, above.bottom()], [above.right(), above.bottom()], &Pen::solid(BLACK, 1.0));
            }
            canvas.line([below.left, below.top], [below.right(), below.top], &Pen::solid(BLACK, 1.0));
        }
    }

    fn bars(
        &self,
        canvas: &mut Canvas,
        above: Rect,
        below: Rect,
        shares: &[(usize, f64)],
        degrees: &[usize],
        shades: &Shades,
    ) {
        let width = (above.width / shares.len() as f64).min(WIDEST);
        let start = above.left + (above.width - width * shares.len() as f64) / 2.0;
        // Half of the space between two bars.
        let inset = if width >= 4.0 { 1.0 } else { 0.0 };
        for (k, &(element, share)) in shares.iter().enumerate() {
            let (l, r) = (start + k as f64 * width + inset, start + (k + 1) as f64 * width - inset);
            let down = below.top + self.down(share);
            canvas.fill(&[vec![[l, below.top], [r, below.top], [r, down], [l, down]]], BAR);
            if !self.has_degrees() {
                continue;
            }
            let (degree, bottom) = (degrees[element], above.bottom());
            let t = bottom - self.up(degree);
            canvas.fill(&[vec![[l, bottom], [r, bottom], [r, t], [l, t]]], shades.colour(degree));
            if inset > 0.0 {
                canvas.lines(&[vec![[l, bottom], [l, t], [r, t], [r, bottom]]], &Pen::solid(BLACK, 0.7));
            }
            let number = degree.to_string();
            if 0.9 * text_width(&number, NUMBER_TEXT) < width {
                canvas.text([(l + r) / 2.0, t - 3.0], &number, NUMBER_TEXT, TextAnchor::Middle);
            }
        }
    }

    /// Whether degrees are drawn.
    fn has_degrees(&self) -> bool {
        self.degrees > 0.0
    }

    /// Height of the bar of a degree.
    fn up(&self, degree: usize) -> f64 {
        (DEGREES - HEAD) * degree as f64 / self.degree as f64
    }

    /// Height of the bar of a length over the length of the side.
    fn down(&self, share: f64) -> f64 {
        self.lengths * (-share.log10() / f64::from(self.decades)).clamp(0.0, 1.0)
    }

    /// Degrees and powers of ten that have a tick.
    fn ticks(&self) -> (Vec<usize>, Vec<i32>) {
        let step = |n: usize| [1, 2, 5, 10, 20, 50].into_iter().find(|s| n / s <= 5).unwrap_or(n);
        let degrees = (0..=self.degree).step_by(step(self.degree)).filter(|_| self.has_degrees()).collect();
        let decades = self.decades as usize;
        (degrees, (0..=self.decades).step_by(step(decades)).collect())
    }

    fn grid(&self, canvas: &mut Canvas, above: Rect, below: Rect) {
        let (degrees, decades) = self.ticks();
        let levels = degrees.iter().map(|&p| above.bottom() - self.up(p));
        let levels = levels.chain(decades.iter().map(|&k| below.top + self.down(10f64.powi(-k))));
        let lines: Vec<Vec<[f64; 2]>> = levels.map(|y| vec![[above.left, y], [above.right(), y]]).collect();
        canvas.lines(&lines, &Pen::solid(LIGHT, 1.0));
    }

    /// Labels and titles left of the first side.
    fn axes(&self, canvas: &mut Canvas, left: f64, top: f64) {
        let (degrees, decades) = self.ticks();
        let (bottom, hanging) = (top + DEGREES, top + self.degrees);
        for p in degrees {
            // The lengths start close below.
            if p > 0 {
                canvas.text([left - 6.0, bottom - self.up(p) + 4.0], &p.to_string(), 11, TextAnchor::End);
            }
        }
        for k in decades {
            let label = if k == 0 { "1".to_owned() } else { power(-k) };
            canvas.text([left - 6.0, hanging + self.down(10f64.powi(-k)) + 4.0], &label, 11, TextAnchor::End);
        }
        if self.has_degrees() {
            canvas.text_upwards([left - 40.0, top + HEAD + (DEGREES - HEAD) / 2.0], "degree", 12);
        }
        canvas.text_upwards([left - 40.0, hanging + self.lengths / 2.0], "length / side", 12);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A side of length 3 from x = 0, cut at the given shares of it, then one of length 1 upwards in one piece.
    fn panel(cuts: &[f64]) -> (Vec<[[f64; 2]; 2]>, Vec<usize>) {
        let mut elements: Vec<[[f64; 2]; 2]> =
            cuts.windows(2).map(|w| [[3.0 * w[0], 0.0], [3.0 * w[1], 0.0]]).collect();
        elements.push([[3.0, 0.0], [3.0, 1.0]]);
        let mut side = vec![0; cuts.len() - 1];
        side.push(1);
        (elements, side)
    }

    fn found(cuts: &[f64]) -> Vec<Side> {
        let (elements, side) = panel(cuts);
        let degree = vec![1; side.len()];
        sides(&[MeshPanel { caption: "", elements: &elements, degree: &degree, side: &side }]).0
    }

    #[test]
    fn a_side_is_drawn_from_two_per_cent_on() {
        assert_eq!(found(&[0.0, 0.0199, 1.0]), [0]);
        assert!(found(&[0.0, 0.0201, 1.0]).is_empty());
        assert!(found(&[0.0, 1.0]).is_empty());
    }

    #[test]
    fn of_many_sides_the_most_refined_are_drawn() {
        // Side k has a first element of 10^-(k+2).
        let piece = |k: usize| {
            let (x, y) = (10f64.powi(-(k as i32) - 2), k as f64);
            [[[0.0, y], [x, y]], [[x, y], [1.0, y]]]
        };
        let elements: Vec<_> = (0..12).flat_map(piece).collect();
        let side: Vec<usize> = (0..24).map(|i| i / 2).collect();
        let panel = MeshPanel { caption: "", elements: &elements, degree: &[1; 24], side: &side };
        assert_eq!(sides(&[panel]), ((4..12).collect(), 4));
    }

    #[test]
    fn lengths_hang_from_the_whole_side_to_the_shortest_element() {
        let (elements, side) = panel(&[0.0, 1e-7, 0.1, 1.0]);
        let panel = MeshPanel { caption: "", elements: &elements, degree: &[1, 2, 3, 4], side: &side };
        let names = ["a".to_owned(), "b".to_owned()];
        let strips = Strips::new(&[panel], &[0], &names);
        assert_eq!((strips.degree, strips.decades), (4, 7));
        assert_eq!((strips.down(1.0), strips.up(0)), (0.0, 0.0));
        assert!((strips.down(1e-7) - LENGTHS).abs() < 1e-9 && strips.up(4) == DEGREES - HEAD);
        // linear elements have lengths alone
        let panel = MeshPanel { caption: "", elements: &elements, degree: &[1; 4], side: &side };
        let strips = Strips::new(&[panel], &[0], &names);
        assert!((strips.down(1e-7) - STRIP).abs() < 1e-9 && strips.ticks().0.is_empty());
    }

    proptest! {
        #[test]
        fn shares_of_a_side_are_positive_and_add_up_to_one(steps in prop::collection::vec(1e-6f64..1.0, 1..30)) {
            let total: f64 = steps.iter().sum();
            let cuts: Vec<f64> = std::iter::once(0.0)
                .chain(steps.iter().scan(0.0, |s, d| { *s += d / total; Some(*s) }))
                .collect();
            let (elements, side) = panel(&cuts);
            let degree = vec![1; side.len()];
            let all = shares(&MeshPanel { caption: "", elements: &elements, degree: &degree, side: &side }, 0);
            prop_assert_eq!(all.len(), steps.len());
            prop_assert!((all.iter().map(|s| s.1).sum::<f64>() - 1.0).abs() < 1e-12);
            prop_assert!(all.iter().zip(&steps).all(|(s, d)| (s.1 - d / total).abs() < 1e-12));
        }
    }
}

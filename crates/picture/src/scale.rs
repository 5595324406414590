//! Round numbers: ticks, their labels, and the factor by which displacements are drawn larger.

/// Places and labels of the ticks of one axis; the labels are the values over 10^exponent.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    pub values: Vec<f64>,
    pub labels: Vec<String>,
    pub exponent: i32,
}

impl Ticks {
    /// `name`, followed by the power of ten that the labels leave out.
    pub fn title(&self, name: &str) -> String {
        if self.exponent == 0 { name.to_owned() } else { format!("{name} (×{})", power(self.exponent)) }
    }
}

/// At most `at_most` (but at least one) ticks at multiples of 1, 2 or 5 times a power of ten inside [low, high].
///
/// Powers of ten outside 10⁻³…10⁴ go into the exponent, in steps of three. No ticks if the interval is empty or not
/// finite.
pub(super) fn ticks(low: f64, high: f64, at_most: usize) -> Ticks {
    let mut result = Ticks { values: Vec::new(), labels: Vec::new(), exponent: 0 };
    let magnitude = low.abs().max(high.abs());
    let width = high - low;
    // Below a relative width of 1e-12 the ticks would repeat themselves.
    if !width.is_finite() || width <= 1e-12 * magnitude || width < 1e-290 {
        return result;
    }
    let (mantissa, power) = nice_above(width / at_most.max(1) as f64);
    let place = |i: f64| if power < 0 { i * mantissa / 10f64.powi(-power) } else { i * mantissa * 10f64.powi(power) };
    let step = place(1.0);
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let leading = magnitude.log10().floor() as i32;
    if !(-3..=4).contains(&leading) {
        result.exponent = 3 * leading.div_euclid(3);
    }
    let decimals = (result.exponent - power).max(0) as usize;
    let mut i = first;
    while i <= last {
        // `+ 0.0` turns -0 into 0.
        let value = place(i) + 0.0;
        result.values.push(value);
        result.labels.push(format!("{:.decimals$}", scaled(value, result.exponent)).replace('-', "\u{2212}"));
        i += 1.0;
    }
    result
}

/// Ticks of a colour bar: at most `at_most`, or more if there would be fewer than three.
pub(super) fn bar_ticks(low: f64, high: f64, at_most: usize) -> Ticks {
    // a step is less than 2.5 times the wanted one: with eight wanted it is less than a third of the interval
    let most = at_most.max(8);
    let mut choices = (at_most..=most).map(|n| ticks(low, high, n));
    choices.find(|t| t.values.len() >= 3).unwrap_or_else(|| ticks(low, high, most))
}

fn scaled(value: f64, exponent: i32) -> f64 {
    if exponent < 0 { value * 10f64.powi(-exponent) } else { value / 10f64.powi(exponent) }
}

/// Smallest m 10^k ≥ x with m = 1, 2, 5.
fn nice_above(x: f64) -> (f64, i32) {
    let power = x.log10().floor() as i32;
    let rest = x / 10f64.powi(power);
    match [1.0, 2.0, 5.0].into_iter().find(|m| rest <= m * (1.0 + 1e-9)) {
        Some(m) => (m, power),
        None => (1.0, power + 1),
    }
}

/// Largest m 10^k ≤ x with m = 1, 2, 5.
fn nice_below(x: f64) -> f64 {
    let power = x.log10().floor() as i32;
    let rest = x / 10f64.powi(power);
    let m = [5.0, 2.0, 1.0].into_iter().find(|m| rest >= m * (1.0 - 1e-9)).unwrap_or(1.0);
    if power < 0 { m / 10f64.powi(-power) } else { m * 10f64.powi(power) }
}

/// Factor at which displacements are drawn, from the ratio r of the largest one to the size of the body.
///
/// 1 for 0.05 ≤ r ≤ 0.5 and for r = 0; else the largest of 1, 2, 5 times a power of ten that brings r to at most 0.1
/// (so r times factor lies in (0.04, 0.1]). A factor above 1 is at most `most`: the largest such number up to `most`,
/// or 1.
pub fn exaggeration(ratio: f64, most: f64) -> f64 {
    let visible = (0.05..=0.5).contains(&ratio);
    let factor = if visible || !(1e-200..1e200).contains(&ratio) { 1.0 } else { nice_below(0.1 / ratio) };
    if factor <= most.max(1.0) { factor } else { nice_below(most.max(1.0)) }
}

/// 10 to a power, with raised digits.
pub(super) fn power(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |d| RAISED[d as usize]);
    format!("10{}", exponent.to_string().chars().map(raise).collect::<String>())
}

/// A number with `digits` significant digits, with a power of ten if it would be long without.
pub fn short(value: f64, digits: usize) -> String {
    let text = match decimal(value, digits) {
        (text, 0) => text,
        (mantissa, exponent) if mantissa == "1" => power(exponent),
        (mantissa, exponent) => format!("{mantissa}·{}", power(exponent)),
    };
    text.replace('-', "\u{2212}")
}

/// The same in the letters of a terminal, as programs read numbers: 0.0037, -1.5e-9.
pub fn plain(value: f64, digits: usize) -> String {
    match decimal(value, digits) {
        (text, 0) => text,
        (mantissa, exponent) => format!("{mantissa}e{exponent}"),
    }
}

/// `digits` significant digits without zeros at their end, and the power of ten of a long number, otherwise 0.
fn decimal(value: f64, digits: usize) -> (String, i32) {
    if value == 0.0 || !value.is_finite() {
        return (format!("{}", value + 0.0), 0); // + 0: no -0
    }
    // Rounding may carry into the next power of ten, so the exponent is read after rounding.
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trim =
        |s: &str| if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_owned() } else { s.to_owned() };
    if (-4..=5).contains(&exponent) {
        (trim(&format!("{value:.*}", (digits as i32 - 1 - exponent).max(0) as usize)), 0)
    } else {
        (trim(mantissa), exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn labels_are_round_and_large_powers_leave_them() {
        let t = ticks(-0.5, 0.5, 5);
        assert_eq!(t.labels, ["−0.4", "−0.2", "0.0", "0.2", "0.4"]);
        assert_eq!((t.exponent, t.title("x").as_str()), (0, "x"));
        let t = ticks(0.0, 2.5e-9, 5);
        assert_eq!(t.labels, ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"][..t.labels.len()]);
        assert_eq!(t.title("p"), "p (×10⁻⁹)");
        assert_eq!(ticks(0.0, 3e12, 3).title("p"), "p (×10¹²)");
        assert_eq!(ticks(1e6, 1e6 + 2.0, 2).values, [1e6, 1e6 + 1.0, 1e6 + 2.0]);
        for (low, high) in
            [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-f64::MAX, f64::MAX), (0.0, 1e-300)]
        {
            assert!(ticks(low, high, 5).values.is_empty());
        }
    }

    #[test]
    fn factors() {
        for (ratio, factor) in
            [(0.0, 1.0), (0.05, 1.0), (0.2, 1.0), (0.049, 2.0), (1e-3, 100.0), (1.1e-3, 50.0), (3e-9, 2e7), (4.0, 0.02)]
        {
            assert_eq!(exaggeration(ratio, f64::INFINITY), factor, "{ratio}");
        }
        assert_eq!(exaggeration(f64::NAN, f64::INFINITY), 1.0);
        for (ratio, most, factor) in
            [(1e-3, 99.0, 50.0), (1e-3, 100.0, 100.0), (1e-3, 1.9, 1.0), (1e-3, 0.0, 1.0), (4.0, 0.0, 0.02)]
        {
            assert_eq!(exaggeration(ratio, most), factor, "{ratio} {most}");
        }
    }

    #[test]
    fn short_numbers() {
        for (value, text) in [
            (0.0506743, "0.0507"),
            (100.0, "100"),
            (2e7, "2·10⁷"),
            (1e9, "10⁹"),
            (-1.5e-9, "−1.5·10⁻⁹"),
            (9.9996, "10"),
            (0.0, "0"),
        ] {
            assert_eq!(short(value, 3), text);
        }
        let plainly = [(-1.5e-9, "-1.5e-9"), (1e9, "1e9"), (0.0037, "0.0037"), (-0.0, "0"), (f64::NAN, "NaN")];
        for (value, text) in plainly {
            assert_eq!(plain(value, 7), text);
        }
    }

    proptest! {
        #[test]
        fn plain_numbers_are_read_as_what_they_were(mantissa in -10.0f64..10.0, power in -290i32..290, digits in 1usize..17) {
            let value = mantissa * 10f64.powi(power);
            let read: f64 = plain(value, digits).parse().unwrap();
            prop_assert!((read - value).abs() <= 0.500001 * 10f64.powi(1 - digits as i32) * value.abs());
        }

        #[test]
        fn ticks_lie_inside_are_few_and_their_labels_say_where(low in -1e3f64..1e3, width in 1e-3f64..1e3, power in -200i32..200, n in 1usize..12) {
            let unit = 10f64.powi(power);
            let (low, high) = (low * unit, (low + width) * unit);
            let t = ticks(low, high, n);
            prop_assert!(t.values.len() <= n + 1);
            prop_assert!(n < 3 || !t.values.is_empty());
            let slack = 1e-8 * (high - low);
            for (v, label) in t.values.iter().zip(&t.labels) {
                prop_assert!(*v >= low - slack && *v <= high + slack);
                let said: f64 = label.replace('\u{2212}', "-").parse().unwrap();
                prop_assert!((said * 10f64.powi(t.exponent) - v).abs() <= 1e-12 * v.abs() + slack);
            }
            prop_assert!(t.labels.windows(2).all(|w| w[0] != w[1]));
        }

        #[test]
        fn colour_bars_have_at_least_three_ticks(low in -1e3f64..1e3, width in 1e-6f64..1e3, n in 1usize..12) {
            let t = bar_ticks(low, low + width, n);
            prop_assert!((3..=n.max(8) + 1).contains(&t.values.len()), "{:?}", t.values);
        }

        #[test]
        fn drawn_displacements_are_visible_and_not_absurd(log in -15.0f64..2.0) {
            let ratio = 10f64.powf(log);
            let drawn = ratio * exaggeration(ratio, f64::INFINITY);
            let most = if ratio >= 0.05 { 0.5 } else { 0.1 + 1e-9 };
            prop_assert!(drawn > 0.0399 && drawn <= most, "{ratio} is drawn as {drawn}");
        }
    }
}

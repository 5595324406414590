//! Choice of the values of a field that have the outer colours.

use super::bands::interval;

/// The values of the outer colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Colours {
    /// Chosen from the values by the rule of the picture.
    #[default]
    Automatic,
    /// From the smallest value, or zero if that is smaller, to the largest, or zero if that is larger. If a few values
    /// are far beyond the others of their sign, the colours end at twice the others.
    WithZero,
    /// From the first to the second value, the smaller one first. Values beyond an end have its colour, and the bar has
    /// an arrow there.
    Range([f64; 2]),
}

impl Colours {
    /// The ends for values with their weights; `automatic` computes those of [`Self::Automatic`].
    pub(super) fn ends(self, values: &[(f64, f64)], automatic: impl FnOnce(&[(f64, f64)]) -> [f64; 2]) -> [f64; 2] {
        match self {
            Self::Automatic => automatic(values),
            Self::WithZero => with_zero(values),
            Self::Range(ends) => ends,
        }
    }
}

/// The ends of colours that contain zero.
fn with_zero(values: &[(f64, f64)]) -> [f64; 2] {
    let end = |sign: f64| {
        let all = values.iter().map(|(v, weight)| (sign * v, *weight));
        let of_sign: Vec<(f64, f64)> = all.filter(|(v, _)| *v > 0.0 && v.is_finite()).collect();
        if of_sign.is_empty() { 0.0 } else { interval(&of_sign)[1] }
    };
    let [low, high] = [-end(-1.0), end(1.0)];
    if low < high { [low, high] } else { [0.0, 1.0] }
}

/// Whether there are values below the lower end, and above the upper one.
pub(super) fn beyond(values: impl Iterator<Item = f64>, [low, high]: [f64; 2]) -> [bool; 2] {
    values.fold([false; 2], |[below, above], v| [below || v < low, above || v > high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_lies_between_the_ends_and_few_values_beyond_them() {
        let with_zero = |values: &[f64]| with_zero(&values.iter().map(|&v| (v, 1.0)).collect::<Vec<_>>());
        assert_eq!(with_zero(&[-3.0, -2.0, f64::NAN]), [-3.0, 0.0]);
        assert_eq!(with_zero(&[8.0, 9.0, f64::INFINITY]), [0.0, 9.0]);
        assert_eq!(with_zero(&[-3.0, 0.0, 2.0]), [-3.0, 2.0]);
        assert_eq!((with_zero(&[0.0]), with_zero(&[])), ([0.0, 1.0], [0.0, 1.0]));
        let tip: Vec<f64> = (0..100).map(|k| if k == 50 { -500.0 } else { f64::from(k) - 49.5 }).collect();
        let [low, high] = with_zero(&tip);
        assert_eq!(high, 49.5);
        assert!(low > -500.0 && low < -49.0, "{low}");
        assert_eq!(beyond(tip.iter().copied(), [low, high]), [true, false]);
    }
}

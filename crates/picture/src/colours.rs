//! Which values have the outer colours of a field.

/// The values of the outer colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Colours {
    /// As the values need them; the picture says how.
    #[default]
    Automatic,
    /// These, the smaller one first. Values beyond them have the colour of their end, where the bar has an arrow.
    Range([f64; 2]),
}

impl Colours {
    /// The ends, `automatic` of the values unless they are given.
    pub(super) fn ends(self, automatic: impl FnOnce() -> [f64; 2]) -> [f64; 2] {
        match self {
            Self::Automatic => automatic(),
            Self::Range(ends) => ends,
        }
    }
}

/// Whether there are values below the lower end, and above the upper one.
pub(super) fn beyond(values: impl Iterator<Item = f64>, [low, high]: [f64; 2]) -> [bool; 2] {
    values.fold([false; 2], |[below, above], v| [below || v < low, above || v > high])
}

//! What of a result the pictures show.

use steklov_picture::Colours;

/// What the pictures of fields show; the default is all of the body by its von Mises stress.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct View {
    /// Values of the outer colours, the smaller one first, in the unit of the field; those beyond have the colour of their
    /// end. None: those that the field takes.
    pub range: Option<[f64; 2]>,
}

impl View {
    /// The colours of the field of the body.
    pub(crate) fn colours(&self) -> Colours {
        self.range.map_or(Colours::Automatic, Colours::Range)
    }
}

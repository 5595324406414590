//! The texts from which a problem was read.

/// The texts of a scene, as they were given.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Source {
    /// Name of the file, for messages.
    pub name: String,
    /// Its text.
    pub text: String,
    /// The overrides `KEY=VALUE`, in order.
    pub overrides: Vec<String>,
}

impl Source {
    /// The text that a place counts in: 0 is the file, k the k-th override.
    pub fn part(&self, source: usize) -> &str {
        if source == 0 { &self.text } else { &self.overrides[source - 1] }
    }
}

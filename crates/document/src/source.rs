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
    /// Settings `KEY=VALUE` of a study, for keys that no override decides.
    pub settings: Vec<String>,
}

impl Source {
    /// The text to which a place refers: 0 is the file, then come the overrides, then the settings.
    pub fn part(&self, source: usize) -> &str {
        let change = source.checked_sub(1).and_then(|k| self.changes().nth(k));
        change.unwrap_or(&self.text)
    }

    /// Overrides and settings, numbered in this order by places.
    pub fn changes(&self) -> impl Iterator<Item = &String> {
        self.overrides.iter().chain(&self.settings)
    }
}

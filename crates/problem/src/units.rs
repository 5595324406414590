//! The names of the units of a scene.

use serde::{Deserialize, Serialize};

/// Names of the units that the numbers of a scene are in; nothing is converted.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Units {
    /// That of coordinates and displacements, such as "mm".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<String>,
    /// That of moduli, tractions and stresses, such as "MPa".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<String>,
}

impl Units {
    /// Whether no unit has a name.
    pub fn are_unknown(&self) -> bool {
        *self == Self::default()
    }
}

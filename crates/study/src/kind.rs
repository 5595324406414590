//! Which studies there are, and what each sets in a scene.

use steklov_document::Document;
use steklov_problem::{DataError, Method};

use crate::settings::{Setting, settings};
use crate::{coupling, inf_sup, stability};

/// A study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StudyKind {
    /// Errors of strategies of refinement.
    Convergence,
    /// Inf-sup constants of multipliers.
    InfSup,
    /// Almost incompressible materials, degenerate sizes, stabilisation.
    Stability,
    /// Solvers of contact.
    Solvers,
    /// Random input.
    Stochastic,
    /// Multiscale bases.
    Multiscale,
    /// A body and the medium around it.
    Coupling,
}

impl StudyKind {
    /// The word of the command.
    pub fn word(self) -> &'static str {
        match self {
            Self::Convergence => "convergence",
            Self::InfSup => "inf-sup",
            Self::Stability => "stability",
            Self::Solvers => "solvers",
            Self::Stochastic => "stochastic",
            Self::Multiscale => "multiscale",
            Self::Coupling => "coupling",
        }
    }

    /// The name of its files.
    pub fn file_name(self) -> &'static str {
        if self == Self::Convergence { "study" } else { self.word() }
    }

    /// What it sets in a scene of such a method where the user sets nothing else.
    fn settings(self, method: &Method) -> Vec<Setting> {
        match self {
            Self::Convergence | Self::Solvers | Self::Stochastic => settings(method),
            Self::InfSup => inf_sup::SETTINGS.to_vec(),
            Self::Stability => stability::settings(method),
            Self::Multiscale => Vec::new(),
            Self::Coupling => coupling::settings(method),
        }
    }

    /// Gives a scene the settings of the study where no override decides, and notes them among its texts.
    ///
    /// # Errors
    /// A scene that cannot be solved with them.
    pub fn prepare(self, document: &mut Document) -> Result<(), DataError> {
        for setting in self.settings(&document.scene.method) {
            let text = setting.to_string();
            if !document.overrides(&text) {
                setting.apply(&mut document.scene.method);
                document.source.settings.push(text);
            }
        }
        document.scene.check()
    }
}

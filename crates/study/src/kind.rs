//! The kinds of studies, their settings in a scene, and their execution.

use std::path::{Path, PathBuf};

use steklov_document::Document;
use steklov_picture::PictureError;
use steklov_problem::{DataError, Scene};

use crate::convergence::{Chosen, strategies as strategies_of};
use crate::settings::{Setting, settings};
use crate::stability::Beside;
use crate::{Report, StudyError, Watch, contact_sides};
use crate::{convergence, coupling, inf_sup, multiscale, quantities, solvers, stability, stochastic};

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
    /// Error bars of quantities.
    Quantities,
}

/// The options of a study besides its scene.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The strategies to compare, for [`StudyKind::Convergence`].
    pub strategies: Vec<Chosen>,
    /// Results of other methods, for [`StudyKind::Stability`].
    pub beside: Vec<Beside>,
    /// The steps whose meshes are drawn, for [`StudyKind::Convergence`]; some of each strategy if there are none.
    pub steps: Vec<usize>,
    /// Number of runs whose median gives the seconds, in studies that repeat runs.
    pub repeat: usize,
}

/// Draws the pictures of a study into a folder; returns the files.
pub type Draw<'d> = &'d dyn Fn(&Path) -> Result<Vec<PathBuf>, PictureError>;

impl StudyKind {
    /// All studies, each with its word on the command line and its description.
    pub const ALL: [(Self, &'static str, &'static str); 8] = [
        (Self::Convergence, "convergence", "Errors of strategies of refinement over unknowns and seconds"),
        (Self::InfSup, "inf-sup", "Inf-sup constants of contact multipliers, with and without stabilisation"),
        (
            Self::Stability,
            "stability",
            "Errors as the material becomes incompressible; the single layer at degenerate sizes of the body",
        ),
        (
            Self::Solvers,
            "solvers",
            "Iterations and seconds of contact solvers, and how fast the semi-smooth Newton method converges",
        ),
        (
            Self::Stochastic,
            "stochastic",
            "Errors of means and variances of a scene with random input, in chance and in space; iterations of contact solvers",
        ),
        (
            Self::Multiscale,
            "multiscale",
            "Errors of multiscale bases on a scene with a grid, of resonance and of high contrast, beside the fine grid's own",
        ),
        (
            Self::Coupling,
            "coupling",
            "Errors, seconds and conditions of a body on a grid coupled with the unbounded medium around it",
        ),
        (Self::Quantities, "quantities", "Error bars of quantities over their true errors, at every step of a run"),
    ];

    /// The word of the command.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(kind, ..)| *kind == self).map_or("", |(_, word, _)| word)
    }

    /// The study of a word.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known, _)| *known == word).map(|(kind, ..)| *kind)
    }

    /// The name of its files.
    pub fn file_name(self) -> &'static str {
        if self == Self::Convergence { "study" } else { self.word() }
    }

    /// The settings for a scene, if the user sets nothing else.
    fn settings(self, scene: &Scene) -> Vec<Setting> {
        let method = &scene.method;
        match self {
            Self::Stochastic if scene.is_on_grid() => Vec::new(),
            Self::Convergence | Self::Solvers | Self::Stochastic => settings(method),
            Self::InfSup => inf_sup::SETTINGS.to_vec(),
            Self::Stability => stability::settings(method),
            Self::Multiscale => Vec::new(),
            Self::Coupling => coupling::settings(method),
            Self::Quantities => quantities::settings(scene),
        }
    }

    /// Gives a scene the settings of the study that no override replaces, and adds them to its texts.
    ///
    /// # Errors
    /// A scene that cannot be solved with them.
    pub fn prepare(self, document: &mut Document) -> Result<(), DataError> {
        for setting in self.settings(&document.scene) {
            let text = setting.to_string();
            if !document.overrides(&text) {
                setting.apply(&mut document.scene.method);
                document.source.settings.push(text);
            }
        }
        document.scene.check()
    }

    /// Its options for a scene: the strategies and the multipliers of these names, all strategies if there are none, and
    /// the scene's own multipliers.
    ///
    /// # Errors
    /// [`StudyError::OnGrid`], [`StudyError::NoContact`], and [`StudyError::Misplaced`] of names for another study.
    pub fn options<S: AsRef<str>>(
        self,
        scene: &Scene,
        strategies: &[S],
        multipliers: &[S],
    ) -> Result<Options, StudyError> {
        let is_of_convergence = self == Self::Convergence;
        for (option, names) in [("strategies", strategies), ("multipliers", multipliers)] {
            if !is_of_convergence && !names.is_empty() {
                return Err(StudyError::Misplaced { option, study: Self::Convergence.word(), other: self.word() });
            }
        }
        if scene.is_on_grid() && (is_of_convergence || self == Self::Stability) {
            let other = if scene.problem.medium().is_some() { Self::Coupling } else { Self::Multiscale };
            return Err(StudyError::OnGrid { model: scene.model().word(), other: other.word() });
        }
        if !multipliers.is_empty() && contact_sides(scene).is_empty() {
            return Err(StudyError::NoContact);
        }
        let chosen = if is_of_convergence { strategies_of(scene, strategies, multipliers) } else { Vec::new() };
        Ok(Options { strategies: chosen, repeat: 1, ..Options::default() })
    }

    /// Number of parts that it reports for a scene.
    ///
    /// # Errors
    /// A scene that this study cannot treat.
    pub fn parts(self, scene: &Scene, options: &Options) -> Result<usize, DataError> {
        Ok(match self {
            Self::Convergence => 1 + options.strategies.len() * (options.repeat + 1),
            Self::InfSup => inf_sup::check(scene).map(|()| 3)?,
            Self::Stability => stability::POISSON.len() + 3,
            Self::Solvers => solvers::check(scene).map(|()| 1)?,
            Self::Stochastic => stochastic::random(scene).map(|_| stochastic::FAMILIES.len() + 8)?,
            Self::Multiscale => multiscale::coarse_cells(scene).map(|_| multiscale::BASES.len() + 4)?,
            Self::Coupling => {
                let pairs = coupling::pairs(scene)?;
                coupling::grids(scene)?;
                pairs.len() + 6
            }
            Self::Quantities => quantities::check(scene).map(|()| 2)?,
        })
    }

    /// Runs the study, and passes its report and its pictures to `told`.
    ///
    /// # Errors
    /// A scene that this study cannot treat; a reference that cannot be solved.
    pub fn carry_out<T>(
        self,
        document: &Document,
        options: Options,
        watch: &mut Watch<'_>,
        told: impl FnOnce(&Report<'_>, Draw<'_>) -> T,
    ) -> Result<T, StudyError> {
        let Document { scene, source } = document;
        let Options { strategies, beside, steps, repeat } = options;
        Ok(match self {
            Self::Convergence => {
                let study = convergence::study(scene, source, &strategies, repeat, watch)?;
                told(&convergence::report(&study), &|folder| convergence::pictures(&study, &steps, folder))
            }
            Self::InfSup => {
                let study = inf_sup::study(scene, source, watch)?;
                told(&inf_sup::report(&study), &|folder| inf_sup::pictures(&study, folder))
            }
            Self::Stability => {
                let study = stability::study(scene, source, beside, watch)?;
                told(&stability::report(&study), &|folder| stability::pictures(&study, folder))
            }
            Self::Solvers => {
                let study = solvers::study(scene, source, watch)?;
                told(&solvers::report(&study), &|folder| solvers::pictures(&study, folder))
            }
            Self::Stochastic => {
                let study = stochastic::study(scene, source, stochastic::random(scene)?, watch)?;
                told(&stochastic::report(&study), &|folder| stochastic::pictures(&study, folder))
            }
            Self::Multiscale => {
                let sizes = multiscale::coarse_cells(scene)?;
                let study = multiscale::study(scene, source, &sizes, repeat, watch)?;
                told(&multiscale::report(&study), &|folder| multiscale::pictures(&study, folder))
            }
            Self::Coupling => {
                let (pairs, grids) = (coupling::pairs(scene)?, coupling::grids(scene)?);
                let study = coupling::study(scene, source, pairs, &grids, repeat, watch);
                told(&coupling::report(&study), &|folder| coupling::pictures(&study, folder))
            }
            Self::Quantities => {
                let study = quantities::study(scene, source, watch)?;
                told(&quantities::report(&study), &|folder| quantities::pictures(&study, folder))
            }
        })
    }
}

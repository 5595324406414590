//! What is wrong with a scene: file, line, the text that is meant, and the remedy.

use std::sync::Arc;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, NamedSource, SourceSpan};
use steklov_expression::Place;

/// Sorts of errors of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SceneErrorKind {
    /// The scene, or a file that it names, cannot be read.
    Read,
    /// The text is not TOML, or an override is not `KEY=VALUE`.
    Syntax,
    /// A key or the name of a side that does not exist.
    UnknownKey,
    /// An override that changes nothing: no expression uses the name that it sets.
    UnusedKey,
    /// A key that must be there.
    MissingKey,
    /// A value of another type than the key takes.
    WrongType,
    /// A value of the right type that is impossible.
    Value,
    /// The text of an expression cannot be read.
    Expression,
    /// Two entries exclude each other.
    Conflict,
    /// The loops do not bound a body.
    Geometry,
    /// A datum has an impossible value at a point of its side or of the body.
    Data,
    /// Neither supports nor contact hold the body.
    Unsupported,
}

/// An error of a scene. [`SceneError::render`] shows it with the line that is meant.
#[derive(Debug, Clone, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct SceneError {
    /// Sort of the error.
    pub kind: SceneErrorKind,
    /// What is wrong.
    pub message: String,
    /// What to change.
    #[help]
    pub help: String,
    #[source_code]
    source_code: Arc<NamedSource<String>>,
    #[label("{label}")]
    span: Option<SourceSpan>,
    label: &'static str,
}

impl SceneError {
    /// Name of the file, or `--set` for an override.
    pub fn file(&self) -> &str {
        self.source_code.name()
    }

    /// Line of the text that is meant, from 1; none if the file could not be read.
    pub fn line(&self) -> Option<usize> {
        let start = self.span?.offset();
        Some(1 + self.source_code.inner().as_bytes()[..start].iter().filter(|&&b| b == b'\n').count())
    }

    /// The text that is meant.
    pub fn offending(&self) -> &str {
        let text = self.source_code.inner();
        self.span.map_or("", |s| &text[s.offset()..s.offset() + s.len()])
    }

    /// The whole message without colours: what is wrong, file and line, the text, the remedy.
    pub fn render(&self) -> String {
        let mut out = String::new();
        GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
            .with_wrap_lines(false)
            .render_report(&mut out, self)
            .expect("writing to a string does not fail");
        out
    }

    /// A file that cannot be read.
    pub(super) fn unreadable(name: &str, why: impl std::fmt::Display, help: &str) -> Self {
        Self {
            kind: SceneErrorKind::Read,
            message: format!("cannot read the scene {name}: {why}"),
            help: help.to_owned(),
            source_code: Arc::new(NamedSource::new(name, String::new())),
            span: None,
            label: "",
        }
    }
}

/// The texts of a scene, as they were given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name of the file, for messages.
    pub name: String,
    /// Its text.
    pub text: String,
    /// The overrides `KEY=VALUE`, in order.
    pub overrides: Vec<String>,
}

impl Source {
    /// The text of a source: 0 is the file, k the k-th override.
    pub(super) fn text(&self, source: usize) -> &str {
        if source == 0 { &self.text } else { &self.overrides[source - 1] }
    }

    pub(super) fn error(&self, problem: Problem) -> SceneError {
        let Problem { kind, message, help, place, label } = problem;
        let text = self.text(place.source);
        let name = if place.source == 0 { &self.name } else { "--set" };
        // Only the first line of what is meant: tables and lists can be long.
        let meant = text.get(place.start..place.end).unwrap_or("");
        let length = meant.find('\n').unwrap_or(meant.len());
        SceneError {
            kind,
            message,
            help,
            source_code: Arc::new(NamedSource::new(name, text.to_owned())),
            span: Some((place.start.min(text.len()), length).into()),
            label,
        }
    }
}

/// An error before its source is attached.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    pub(super) kind: SceneErrorKind,
    pub(super) message: String,
    pub(super) help: String,
    pub(super) place: Place,
    pub(super) label: &'static str,
}

impl Problem {
    pub(super) fn new(kind: SceneErrorKind, place: Place, message: impl Into<String>, help: impl Into<String>) -> Self {
        let label = match kind {
            SceneErrorKind::UnknownKey => "not known",
            SceneErrorKind::UnusedKey => "not used",
            SceneErrorKind::MissingKey => "incomplete",
            SceneErrorKind::WrongType => "wrong type",
            SceneErrorKind::Conflict => "excluded by another entry",
            _ => "here",
        };
        Self { kind, message: message.into(), help: help.into(), place, label }
    }
}

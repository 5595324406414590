//! Errors of a scene: file, line, the offending text, and the remedy.

use std::sync::Arc;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, NamedSource, SourceSpan};
use steklov_expression::Place;
use steklov_problem::{About, DataError, DataErrorKind};

use super::source::Source;
use super::tree;

/// Largest number of bytes of a line that is shown.
const LONG: usize = 160;

/// Sort of the error of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    /// A text that cannot be read as an expression.
    Expression,
    /// Impossible data.
    Data(DataErrorKind),
}

impl From<DataErrorKind> for SceneErrorKind {
    fn from(kind: DataErrorKind) -> Self {
        Self::Data(kind)
    }
}

/// An error in the text or the data of a scene, found while it is read.
#[derive(Debug)]
pub(super) struct ReadError {
    pub kind: SceneErrorKind,
    /// What is wrong.
    pub message: String,
    /// What to change.
    pub help: String,
    pub about: About,
}

impl ReadError {
    /// An error about a part of a text.
    pub fn new(
        kind: impl Into<SceneErrorKind>,
        place: Place,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self { kind: kind.into(), message: message.into(), help: help.into(), about: About::Text(place) }
    }
}

impl From<DataError> for ReadError {
    fn from(DataError { kind, message, help, about }: DataError) -> Self {
        Self { kind: kind.into(), message, help, about }
    }
}

/// An error of a scene. [`SceneError::render`] shows it with the offending line.
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

    /// Line of the offending text, from 1; None if the file could not be read.
    pub fn line(&self) -> Option<usize> {
        let start = self.span?.offset();
        Some(1 + self.source_code.inner().as_bytes()[..start].iter().filter(|&&b| b == b'\n').count())
    }

    /// The offending text.
    pub fn offending(&self) -> &str {
        let text = self.source_code.inner();
        self.span.map_or("", |s| &text[s.offset()..s.offset() + s.len()])
    }

    /// The whole message without colours: what is wrong, file and line, the text, the remedy. Long lines are shown in
    /// part.
    pub fn render(&self) -> String {
        let shown = self.with_short_lines();
        let mut out = String::new();
        GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
            .with_wrap_lines(false)
            .render_report(&mut out, shown.as_ref().unwrap_or(self))
            .expect("writing to a string does not fail");
        let Some(span) = self.span else { return out };
        let before = &self.source_code.inner()[..span.offset()];
        let column = 1 + before[before.rfind('\n').map_or(0, |end| end + 1)..].chars().count();
        // the column in the line of the file, counted in characters
        let place = format!("[{}:{}:", self.file(), self.line().unwrap_or(1));
        match out.split_once(&place).and_then(|(before, behind)| Some((before, behind.split_once(']')?.1))) {
            Some((before, behind)) => format!("{before}{place}{column}]{behind}"),
            None => out,
        }
    }

    /// The error with long lines cut to the parts that are shown; None if no line is long.
    fn with_short_lines(&self) -> Option<Self> {
        let (text, span) = (self.source_code.inner(), self.span?);
        if text.lines().all(|line| line.len() <= LONG) {
            return None;
        }
        let begin = text[..span.offset()].rfind('\n').map_or(0, |end| end + 1);
        let column = span.offset() - begin;
        let (mut short, mut at, mut start) = (String::new(), span, 0);
        for line in text.split_inclusive('\n') {
            let end = line.trim_end().len();
            if start == begin {
                let from = boundary(line, column.saturating_sub(LONG / 2));
                let to = boundary(line, end.min(from + LONG).max(column));
                let cut = if from > 0 { "… " } else { "" };
                let length = span.len().min(to - column);
                at = (short.len() + cut.len() + column - from, length).into();
                short.extend([cut, &line[from..to], if to < end { " …" } else { "" }, "\n"]);
            } else {
                let to = boundary(line, end.min(LONG));
                short.extend([&line[..to], if to < end { " …" } else { "" }, "\n"]);
            }
            start += line.len();
        }
        let source_code = Arc::new(NamedSource::new(self.file(), short));
        Some(Self { source_code, span: Some(at), ..self.clone() })
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

/// The place that an error is about: the value of the first of its keys that the scene has, or its first line.
fn place_of(source: &Source, about: About) -> Place {
    match about {
        About::Text(place) => place,
        About::Keys(keys) => tree::build(source).map_or(Place::default(), |root| {
            let at = |path: &Vec<String>| root.at(&path.iter().map(String::as_str).collect::<Vec<_>>());
            keys.iter().find_map(at).unwrap_or(&root).place
        }),
    }
}

/// An error of the data, at its place in the scene.
pub(super) fn located(source: &Source, error: impl Into<ReadError>) -> SceneError {
    let ReadError { kind, message, help, about } = error.into();
    let place = place_of(source, about);
    let text = source.part(place.source);
    let name = if place.source == 0 { &source.name } else { "--set" };
    // Only the first line of the offending text: tables and lists can be long.
    let meant = text.get(place.start..place.end).unwrap_or("");
    let length = meant.find('\n').unwrap_or(meant.len());
    SceneError {
        kind,
        message,
        help,
        source_code: Arc::new(NamedSource::new(name, text.to_owned())),
        span: Some((place.start.min(text.len()), length).into()),
        label: label(kind),
    }
}

/// The last character boundary up to `at`.
fn boundary(text: &str, at: usize) -> usize {
    (0..=at).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

/// The label beside the offending text.
fn label(kind: SceneErrorKind) -> &'static str {
    match kind {
        SceneErrorKind::UnknownKey | SceneErrorKind::Data(DataErrorKind::Unknown) => "not known",
        SceneErrorKind::UnusedKey => "not used",
        SceneErrorKind::MissingKey | SceneErrorKind::Data(DataErrorKind::Missing) => "incomplete",
        SceneErrorKind::WrongType => "wrong type",
        SceneErrorKind::Data(DataErrorKind::Conflict) => "excluded by another entry",
        _ => "here",
    }
}

//! The observer of a study, which may stop it, and the results found until then.

use std::fmt::Display;
use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_model::run::adaptive_loop::{Event, Model};
use steklov_model::stage::Stage;

/// Observes the progress of a study, and may stop it.
pub struct Watch<'a> {
    /// Number of requests to stop.
    pub(crate) interrupts: &'a AtomicUsize,
    tell: &'a mut dyn FnMut(&str, &str),
}

impl<'a> Watch<'a> {
    /// `tell` receives the name of a part and the progress in it; `interrupts` counts requests to stop.
    pub fn new(interrupts: &'a AtomicUsize, tell: &'a mut dyn FnMut(&str, &str)) -> Self {
        Self { interrupts, tell }
    }

    /// The counter of requests to stop.
    pub fn interrupts(&self) -> &'a AtomicUsize {
        self.interrupts
    }

    /// Whether there was a request to stop.
    pub fn stopped(&self) -> bool {
        self.interrupts.load(Ordering::Relaxed) > 0
    }

    /// Reports the progress.
    pub fn tell(&mut self, part: &str, detail: &str) {
        (self.tell)(part, detail);
    }

    /// Reports the progress of an adaptive run in a step; `prefix` comes before the number of the step.
    pub(crate) fn tell_step<M: Model>(&mut self, part: &str, prefix: &str, step: usize, event: &Event<'_, M>) {
        if let Event::Stage(Stage::Progress(what, _)) = event {
            self.tell(part, &format!("{prefix}step {}, {what}", step + 1));
        }
    }
}

/// The results of a part of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Found<T> {
    /// The results in the order in which they were found.
    pub points: Vec<T>,
    /// The failures, each with its reason.
    pub failures: Vec<(String, String)>,
}

impl<T> Default for Found<T> {
    fn default() -> Self {
        Self { points: Vec::new(), failures: Vec::new() }
    }
}

impl<T> Found<T> {
    /// Keeps points, or the reason why there are none.
    pub(crate) fn take<E: Display>(&mut self, at: String, found: Result<impl IntoIterator<Item = T>, E>) {
        match found {
            Ok(points) => self.points.extend(points),
            Err(error) => self.failures.push((at, error.to_string())),
        }
    }
}

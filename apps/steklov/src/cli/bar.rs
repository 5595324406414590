//! Progress of a solve on stderr.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use steklov_model::stage::Stage;

/// Seconds after which the first line is told where there is no terminal, and most seconds until the next one, which is told when the
/// run has taken twice as long as at the last.
const FIRST: f64 = 2.0;
const LONGEST: f64 = 60.0;

/// A bar on a terminal, a few lines elsewhere; nothing when quiet.
pub(super) struct Bar {
    bar: Option<ProgressBar>,
    start: Instant,
    quiet: bool,
    /// When the next line is due, in seconds from the start.
    due: Mutex<f64>,
}

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(100), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{elapsed:>4} {bar:30} {prefix}{msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, start: Instant::now(), quiet, due: Mutex::new(FIRST) }
    }

    pub(super) fn show(&self, step: usize, stage: &Stage<'_>) {
        let Stage::Progress(what, share) = stage else { return };
        if let Some(bar) = &self.bar {
            bar.set_prefix(format!("step {} ", step + 1));
            bar.set_message(*what);
            bar.set_position((100.0 * share) as u64);
        } else {
            self.tell(|| format!("step {}  {what}", step + 1));
        }
    }

    pub(super) fn outcomes(&self, done: usize, count: usize) {
        if let Some(bar) = &self.bar {
            bar.set_message(format!("outcomes {done} of {count}"));
            bar.set_position((100 * done / count.max(1)) as u64);
        } else {
            self.tell(|| format!("outcomes {done} of {count}"));
        }
    }

    /// Points of a sweep, with the time that is left.
    pub(super) fn points(&self, done: usize, count: usize) {
        let left = self.start.elapsed().as_secs_f64() * (count - done) as f64 / done.max(1) as f64;
        let text = || format!("points {done} of {count}, {left:.0} s left");
        if let Some(bar) = &self.bar {
            bar.set_message(text());
            bar.set_position((100 * done / count.max(1)) as u64);
        } else {
            self.tell(text);
        }
    }

    /// A line where there is no terminal, if one is due.
    fn tell(&self, text: impl FnOnce() -> String) {
        let seconds = self.start.elapsed().as_secs_f64();
        let mut due = self.due.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.quiet && seconds > *due {
            *due = seconds + seconds.min(LONGEST);
            eprintln!("{seconds:6.1} s  {}", text());
        }
    }

    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

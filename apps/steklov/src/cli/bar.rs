//! Progress of a solve on stderr.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use steklov_model::stage::Stage;

/// Lines about the outcomes of random input where there is no terminal.
const TOLD: usize = 10;

/// A bar on a terminal, plain lines elsewhere, for what takes longer than a second; nothing when quiet.
pub(super) struct Bar {
    bar: Option<ProgressBar>,
    start: Instant,
    quiet: bool,
    told: AtomicUsize,
    /// Step, part and tenth of the last line where there is no terminal.
    line: Mutex<(usize, &'static str, u8)>,
}

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(100), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{elapsed:>4} {bar:30} step {prefix} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, start: Instant::now(), quiet, told: AtomicUsize::new(0), line: Mutex::default() }
    }

    pub(super) fn show(&self, step: usize, stage: &Stage<'_>) {
        let Stage::Progress(what, share) = stage else { return };
        if let Some(bar) = &self.bar {
            bar.set_prefix((step + 1).to_string());
            bar.set_message(*what);
            bar.set_position((100.0 * share) as u64);
        } else if !self.quiet && self.start.elapsed().as_secs_f64() > 1.0 {
            let line = (step + 1, *what, (10.0 * share) as u8);
            let last = std::mem::replace(&mut *self.line.lock().unwrap_or_else(PoisonError::into_inner), line);
            if last != line {
                eprintln!("{:6.1} s  step {}  {what}", self.start.elapsed().as_secs_f64(), step + 1);
            }
        }
    }

    pub(super) fn outcomes(&self, done: usize, count: usize) {
        let tenth = TOLD * done / count.max(1);
        if let Some(bar) = &self.bar {
            bar.set_message(format!("outcomes {done} of {count}"));
            bar.set_position((100 * done / count.max(1)) as u64);
        } else if !self.quiet
            && self.start.elapsed().as_secs_f64() > 1.0
            && self.told.fetch_max(tenth, Ordering::Relaxed) < tenth
        {
            eprintln!("{:6.1} s  outcomes {done} of {count}", self.start.elapsed().as_secs_f64());
        }
    }

    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

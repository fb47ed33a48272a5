//! A progress bar on a terminal, nothing in a pipe.
//!
//! Progress goes to stderr, so that results on stdout stay clean.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Steps of a long task. The bar goes away when this is dropped.
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar over so many steps; hidden unless stderr is a terminal.
    pub fn new(steps: usize) -> Progress {
        let target = if std::io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(steps as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {bar:24} {pos}/{len} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        Progress(bar)
    }

    /// A task of unknown length: something turns, with the seconds beside it.
    pub fn spinner(what: impl Into<String>) -> Progress {
        let progress = Progress::new(1);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            progress.0.set_style(style);
        }
        progress.doing(what);
        progress
    }

    /// Says what is being done now.
    pub fn doing(&self, what: impl Into<String>) {
        self.0.set_message(what.into());
    }

    /// One step is done.
    pub fn advance(&self) {
        self.0.inc(1);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

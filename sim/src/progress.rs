//! A progress bar on a terminal, nothing in a pipe.
//!
//! Progress goes to stderr, so that results on stdout stay clean.

use crate::cli::printable;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Steps of a long task. The bar goes away when this is dropped.
pub struct ProgressMeter(ProgressBar);

/// Positions of the bar per step, so that it can move within one.
const FINENESS: u64 = 1000;

impl ProgressMeter {
    /// A bar over so many steps; hidden unless stderr is a terminal.
    pub fn new(steps: usize) -> ProgressMeter {
        ProgressMeter::with_style(
            steps,
            "{spinner} {bar:24} {percent:>3} % {elapsed} {wide_msg}",
        )
    }

    /// A task of unknown length: something turns, with the seconds beside it.
    pub fn spinner(what: impl Into<String>) -> ProgressMeter {
        let progress = ProgressMeter::with_style(1, "{spinner} {elapsed} {wide_msg}");
        progress.doing(what);
        progress
    }

    fn with_style(steps: usize, template: &str) -> ProgressMeter {
        let target = if std::io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(steps as u64 * FINENESS), target);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        ProgressMeter(bar)
    }

    /// Says what is being done now.
    pub fn doing(&self, what: impl Into<String>) {
        let what = printable(&what.into());
        #[cfg(test)]
        heard::note(what.clone());
        self.0.set_message(what);
    }

    /// One step is done.
    pub fn advance(&self) {
        self.0
            .set_position((self.0.position() / FINENESS + 1) * FINENESS);
    }

    /// So much of the present step is done; from any thread, in any order.
    pub fn part(&self, done: usize, of: usize) {
        let before = self.0.position() / FINENESS * FINENESS;
        let within = FINENESS * done as u64 / of.max(1) as u64;
        // A whole step is left to `advance`, which would otherwise count it twice.
        let position = before + within.min(FINENESS - 1);
        if position > self.0.position() {
            self.0.set_position(position);
        }
    }
}

impl Drop for ProgressMeter {
    fn drop(&mut self) {
        #[cfg(test)]
        heard::note(format!(
            "{} of {}",
            self.0.position(),
            self.0.length().unwrap_or(0)
        ));
        self.0.finish_and_clear();
    }
}

#[cfg(test)]
#[path = "progress_tests.rs"]
pub mod heard;

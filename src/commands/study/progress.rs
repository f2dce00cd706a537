//! The progress of a running study.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::ProgressBar;

use crate::commands::interrupt::Interrupt;
use crate::commands::progress::bar;

const TEMPLATE: &str = "{bar:30} trial {pos}/{len}, {eta} left";

/// A progress bar on stderr, if stderr is a terminal. The bar is cleared at the end. A signal ends
/// the study after the running trials.
pub(super) struct StudyProgress {
    bar: ProgressBar,
    interrupt: Interrupt,
    finished: Arc<AtomicUsize>,
}

impl StudyProgress {
    pub fn new(quiet: bool, interrupt: Interrupt) -> Self {
        Self {
            bar: bar(0, TEMPLATE, quiet),
            interrupt,
            finished: Arc::default(),
        }
    }

    /// Returns the same bar, which also counts finished trials in `finished`.
    pub fn counting(mut self, finished: Arc<AtomicUsize>) -> Self {
        self.finished = finished;
        self
    }

    /// Shows how many trials are finished. Breaks after a signal.
    pub fn watch(&mut self, finished: usize, trials: usize) -> ControlFlow<()> {
        if finished == 0 {
            self.bar.set_length(trials as u64);
            self.bar.reset_eta();
        } else {
            self.bar.inc(1);
            self.finished.fetch_add(1, Ordering::Relaxed);
        }
        if self.interrupt.came() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

impl Drop for StudyProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

//! Signals: the first asks for an orderly end, the second for an immediate one.

use std::io;
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, sleep};
use std::time::Duration;

use signal_hook::{consts, flag};

use super::failure::{Exit, Failure};
use super::terminal::say;

/// The signals that end a run.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [consts::SIGINT, consts::SIGTERM, consts::SIGUSR1];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [consts::SIGINT, consts::SIGTERM];

/// The exit code after a second signal.
const IMPATIENT: i32 = 130;
/// How long what is under way may still take after the first signal ...
const PATIENCE: Duration = Duration::from_secs(4);
/// ... and how soon that signal is noticed here.
const GLANCE: Duration = Duration::from_millis(50);

/// Whether a signal came that asks for the end. The next one ends the process at once.
#[derive(Debug, Clone)]
pub struct Interrupt {
    came: Arc<AtomicBool>,
}

impl Interrupt {
    /// Takes notice of signals from now on.
    pub fn notice() -> io::Result<Self> {
        let came = Arc::new(AtomicBool::new(false));
        for signal in SIGNALS {
            // In this order: the first signal finds the flag down and raises it.
            flag::register_conditional_shutdown(signal, IMPATIENT, came.clone())?;
            flag::register(signal, came.clone())?;
        }
        Ok(Self { came })
    }

    /// The same, and watches. When what is under way takes too long after a signal, such as an
    /// episode in a winding maze, the process ends with what `farewell` says: like a process that is
    /// killed, it leaves its last checkpoint or journal whole.
    pub fn watch(shutdown_message: impl Fn() -> Failure + Send + 'static) -> io::Result<Self> {
        let this = Self::notice()?;
        let watch = this.clone();
        Builder::new().spawn(move || watch.end_in_time(&shutdown_message))?;
        Ok(this)
    }

    /// Did one come?
    pub fn came(&self) -> bool {
        self.came.load(Ordering::Relaxed)
    }

    fn end_in_time(&self, shutdown_message: &impl Fn() -> Failure) {
        while !self.came() {
            sleep(GLANCE);
        }
        sleep(PATIENCE);
        let failure = shutdown_message();
        say("");
        failure.print();
        process::exit(failure.exit as i32);
    }
}

/// Lets what goes beyond a limit of the system end in code 74, where otherwise a signal kills:
/// writing beyond a file-size limit fails with an error, and memory that cannot be had, which the
/// standard library names on stderr before it aborts, ends the process as a kill would, so that
/// the last checkpoint or journal is whole.
pub fn limits_are_errors() -> io::Result<()> {
    #[cfg(unix)]
    flag::register(consts::SIGXFSZ, Arc::default())?;
    let always = Arc::new(AtomicBool::new(true));
    flag::register_conditional_shutdown(consts::SIGABRT, Exit::Io as i32, always)?;
    Ok(())
}

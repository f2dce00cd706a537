//! Signal handling: the first signal requests a graceful shutdown, the second ends the process.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, sleep};
use std::time::Duration;

use signal_hook::{consts, flag};

use super::failure::Failure;
use super::terminal::say;

/// The signals that end a run.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [consts::SIGINT, consts::SIGTERM, consts::SIGUSR1];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [consts::SIGINT, consts::SIGTERM];

/// The exit code after a second signal.
const SECOND_SIGNAL_EXIT: i32 = 130;
/// Grace period after the first signal.
const GRACE_PERIOD: Duration = Duration::from_secs(4);
/// The name of the thread that watches. It starts after all handlers are registered.
const WATCHER: &str = "signals";
/// Interval at which the watcher polls for the signal.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// A flag that the first signal sets. The second signal ends the process at once.
#[derive(Debug, Clone)]
pub struct Interrupt {
    came: Arc<AtomicBool>,
}

impl Interrupt {
    /// Registers the signal handlers.
    pub fn notice() -> Result<Self, Failure> {
        let came = Arc::new(AtomicBool::new(false));
        let mut signals = SIGNALS.into_iter();
        let registered = signals.try_for_each(|signal| {
            // In this order: the first signal finds the flag cleared and sets it.
            flag::register_conditional_shutdown(signal, SECOND_SIGNAL_EXIT, came.clone())?;
            flag::register(signal, came.clone()).map(drop)
        });
        registered.map_err(Failure::system("handle signals"))?;
        Ok(Self { came })
    }

    /// Registers the signal handlers and starts a watcher. If the current work, such as an episode
    /// in a winding maze, exceeds the grace period, the process ends with the failure from
    /// `shutdown_message`. As after a kill, every complete file stays intact.
    pub fn watch(shutdown_message: impl Fn() -> Failure + Send + 'static) -> Result<Self, Failure> {
        let this = Self::notice()?;
        let watch = this.clone();
        let watcher = Builder::new()
            .name(WATCHER.to_owned())
            .spawn(move || watch.end_in_time(&shutdown_message));
        watcher.map_err(Failure::system("start a thread"))?;
        Ok(this)
    }

    /// Returns true if a signal was received.
    pub fn came(&self) -> bool {
        self.came.load(Ordering::Relaxed)
    }

    fn end_in_time(&self, shutdown_message: &impl Fn() -> Failure) {
        while !self.came() {
            sleep(POLL_INTERVAL);
        }
        sleep(GRACE_PERIOD);
        let failure = shutdown_message();
        say("");
        failure.print();
        process::exit(failure.kind().exit_code().into());
    }
}

/// Makes writing beyond a file-size limit fail with an error, where a signal would otherwise kill the process.
pub fn limits_are_errors() -> Result<(), Failure> {
    #[cfg(unix)]
    flag::register(consts::SIGXFSZ, Arc::default()).map_err(Failure::system("handle signals"))?;
    Ok(())
}

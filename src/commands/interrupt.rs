//! Signals: the first asks for an orderly end, the second for an immediate one.

use std::io::{self, Write};
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use signal_hook::{consts, flag};
use xcscr::episode::{Observer, Step};

use super::failure::Exit;

/// The signals that end a run.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [consts::SIGINT, consts::SIGTERM, consts::SIGUSR1];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [consts::SIGINT, consts::SIGTERM];

/// The exit code after a second signal.
const IMPATIENT: i32 = 130;
/// How long the episode may still take after the first signal.
const PATIENCE: Duration = Duration::from_secs(4);

/// Whether a signal came that asks for the end. The next one ends the process at once.
#[derive(Debug, Clone)]
pub struct Interrupt {
    came: Arc<AtomicBool>,
}

impl Interrupt {
    /// Watches from now on.
    pub fn watch() -> io::Result<Self> {
        let came = Arc::new(AtomicBool::new(false));
        for signal in SIGNALS {
            // In this order: the first signal finds the flag down and raises it.
            flag::register_conditional_shutdown(signal, IMPATIENT, came.clone())?;
            flag::register(signal, came.clone())?;
        }
        Ok(Self { came })
    }

    /// Did one come?
    pub fn came(&self) -> bool {
        self.came.load(Ordering::Relaxed)
    }
}

/// Lets writing beyond a file-size limit fail with an error, where otherwise a signal kills.
pub fn ignore_file_size_signal() -> io::Result<()> {
    #[cfg(unix)]
    flag::register(consts::SIGXFSZ, Arc::default())?;
    Ok(())
}

/// Ends the process when an episode takes too long after a signal: the last checkpoint is from
/// before that episode, and whole.
pub struct Patience {
    interrupt: Interrupt,
    since: Option<Instant>,
    message: String,
}

impl Patience {
    /// Says `message` when it ends the process.
    pub fn new(interrupt: Interrupt, message: String) -> Self {
        Self {
            interrupt,
            since: None,
            message,
        }
    }
}

impl Observer for Patience {
    fn stepped(&mut self, _: &Step<'_>) {
        if !self.interrupt.came() {
            return;
        }
        if self.since.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
            let _ = writeln!(io::stderr(), "\nerror: {}", self.message);
            process::exit(Exit::Interrupted as i32);
        }
    }
}

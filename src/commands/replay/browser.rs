//! Opens links in the browser.

use std::fmt::Display;
use std::process::{Command, Stdio};
use std::thread;

use crate::commands::terminal::say;

/// Opens an address in the browser named by the variable `BROWSER`, or in the system's default. If
/// that fails, prints a message; the address can still be copied.
pub fn open(address: &str) {
    let named = std::env::var_os("BROWSER").filter(|name| !name.is_empty());
    let mut command = named.map_or_else(system, Command::new);
    command.arg(address).stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let program = command.get_program().to_string_lossy().into_owned();
    let failed = move |cause: &dyn Display| {
        say(&format!(
            "cannot open a browser with {program}: {cause}; open a link above"
        ));
    };
    match command.spawn() {
        Err(cause) => failed(&cause),
        // If no browser is installed, the system's program only fails later.
        Ok(mut browser) => drop(thread::spawn(move || match browser.wait() {
            Ok(status) if !status.success() => failed(&status),
            _ => (),
        })),
    }
}

/// Returns the system's command that opens addresses.
fn system() -> Command {
    if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        Command::new("explorer")
    } else {
        Command::new("xdg-open")
    }
}

//! Opening a link in the browser.

use std::fmt::Display;
use std::process::{Command, Stdio};
use std::thread;

use crate::commands::terminal::say;

/// Opens an address in the browser: that of the variable `BROWSER`, or the system's own. When there
/// is none, says so; the address can still be copied.
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
        // Where no browser is installed, the system's program finds that out later.
        Ok(mut browser) => drop(thread::spawn(move || match browser.wait() {
            Ok(status) if !status.success() => failed(&status),
            _ => (),
        })),
    }
}

/// What opens addresses on this system.
fn system() -> Command {
    if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        Command::new("explorer")
    } else {
        Command::new("xdg-open")
    }
}

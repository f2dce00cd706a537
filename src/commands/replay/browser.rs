//! Opening a link in the browser.

use std::process::{Command, Stdio};

use crate::commands::terminal::say;

/// Opens an address in the browser: that of the variable `BROWSER`, or the system's own. When there
/// is none, says so; the address can still be copied.
pub fn open(address: &str) {
    let named = std::env::var_os("BROWSER").filter(|name| !name.is_empty());
    let mut command = named.map_or_else(system, Command::new);
    command.arg(address).stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    if let Err(cause) = command.spawn() {
        let program = command.get_program().to_string_lossy();
        say(&format!(
            "cannot open a browser with {program}: {cause}; open a link above"
        ));
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

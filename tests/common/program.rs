//! Runs the program as a user would.

use std::process::{Child, Command, Output, Stdio};

/// The program with these arguments, in the folder of the project.
pub fn xcscr(args: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("xcscr"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    command
}

/// The same in the background, with its output kept for later.
pub fn spawn(args: &[&str]) -> Child {
    let mut command = xcscr(args);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Stdout and stderr of a program that ended with this code and did not panic.
#[track_caller]
pub fn ended(output: &Output, code: i32, what: &str) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    let status = output.status;
    assert_eq!(
        status.code(),
        Some(code),
        "{what}: {status}\n{stdout}\n{stderr}"
    );
    assert!(!stderr.contains("panicked"), "{what}\n{stderr}");
    (stdout, stderr)
}

/// Runs the program, which must end with `code`; gives stdout and stderr.
#[track_caller]
pub fn expect(code: i32, args: &[&str]) -> (String, String) {
    ended(&xcscr(args).output().unwrap(), code, &format!("{args:?}"))
}

/// Runs the program; gives its exit code, stdout and stderr.
pub fn outcome(args: &[&str]) -> (Option<i32>, String, String) {
    let output = xcscr(args).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    (output.status.code(), stdout, stderr)
}

/// Sends a signal, such as `TERM`, to a program that runs.
pub fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    // The program may have ended by itself, which is no fault of this.
    let _ = Command::new("kill").args(["-s", name, &pid]).output();
}

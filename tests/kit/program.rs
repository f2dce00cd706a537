//! Runs the program as a user would.

use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Longer than anything takes here, even on a busy machine: what is not done by then is stuck.
const STUCK: Duration = Duration::from_secs(600);
/// How often [`wait_until`] looks.
const LOOK: Duration = Duration::from_millis(5);

/// The program with these arguments, in the folder of the project.
pub fn xcscr(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xcscr"));
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

/// Waits for the end of a program, and kills it when it is stuck.
pub fn output_of(child: Child) -> Output {
    let (pid, (done, ended)) = (child.id().to_string(), mpsc::channel::<()>());
    let guard = thread::spawn(move || {
        if ended.recv_timeout(STUCK) == Err(mpsc::RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").args(["-s", "KILL", &pid]).output();
        }
    });
    let output = child.wait_with_output().unwrap();
    drop(done);
    guard.join().unwrap();
    output
}

/// Looks again and again until it is so.
#[track_caller]
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    for _ in 0..STUCK.div_duration_f64(LOOK) as u32 {
        if is_so() {
            return;
        }
        thread::sleep(LOOK);
    }
    panic!("waited in vain: {what}");
}

/// Sends a signal, such as `TERM`, to a program that runs.
pub fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    // The program may have ended by itself, which is no fault of this.
    let _ = Command::new("kill").args(["-s", name, &pid]).output();
}

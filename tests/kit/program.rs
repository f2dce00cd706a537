//! Runs the program as a user does.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// The timeout. It is longer than any operation takes, even on a busy machine.
const STUCK: Duration = Duration::from_secs(600);
/// The poll interval of [`wait_until`].
const LOOK: Duration = Duration::from_millis(5);

/// Returns the command with these arguments, in the folder of the project.
pub fn xcscr(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xcscr"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    command
}

/// Returns stdout and stderr of a program that must have ended with this code and without a panic.
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

/// Runs the program, which must end with `code`. Returns stdout and stderr.
#[track_caller]
pub fn expect(code: i32, args: &[&str]) -> (String, String) {
    ended(&xcscr(args).output().unwrap(), code, &format!("{args:?}"))
}

/// Runs the program. Returns its exit code, stdout and stderr.
pub fn outcome(args: &[&str]) -> (Option<i32>, String, String) {
    let output = xcscr(args).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    (output.status.code(), stdout, stderr)
}

/// Waits until a program ends, and kills it after [`STUCK`].
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

/// Polls until the condition is true.
#[track_caller]
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    for _ in 0..STUCK.div_duration_f64(LOOK) as u32 {
        if is_so() {
            return;
        }
        thread::sleep(LOOK);
    }
    panic!("timed out waiting for: {what}");
}

/// Waits until a file exists.
#[track_caller]
pub fn wait_for(path: &Path) {
    wait_until(&format!("{}", path.display()), || path.exists());
}

/// Waits until a program has registered its signal handlers, as the system reports it.
#[track_caller]
pub fn wait_for_handlers(child: &Child) {
    // The thread that watches starts after the last handler is registered.
    let tasks = format!("/proc/{}/task", child.id());
    let name =
        |task: fs::DirEntry| fs::read_to_string(task.path().join("comm")).unwrap_or_default();
    wait_until("signal handlers", || {
        let mut tasks = fs::read_dir(&tasks).unwrap();
        tasks.any(|task| name(task.unwrap()).trim() == "signals")
    });
}

/// Sends a signal, such as `TERM`, to a running program.
pub fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    // The program may have ended already, which is not an error.
    let _ = Command::new("kill").args(["-s", name, &pid]).output();
}

//! A folder in which a user runs studies.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use crate::kit::{folder, program};
use serde_json::Value;
use tempfile::TempDir;

/// 2 worlds x 2 methods x 4 trials.
pub const SMALL: &str = r#"
name = "small"
worlds = ["maze4", "maze5"]
methods = ["xcs", "xcscr"]
trials = 4
episodes = 12
seed = 7
"#;

/// A folder with the study file `small.toml`, and studies in it. Programs in its folder `bin` are found
/// first.
pub struct Desk(TempDir);

impl Desk {
    pub fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.write("small.toml", SMALL);
        desk
    }

    /// The desk with the finished study `whole` of `small.toml`.
    fn with_whole() -> Self {
        let desk = Self::new();
        desk.done("run small.toml --out whole --jobs 1");
        desk
    }

    /// A desk with a finished study that tests run commands on, one after the other, and leave as it is.
    pub fn finished() -> MutexGuard<'static, Self> {
        static DESK: LazyLock<Mutex<Desk>> = LazyLock::new(|| Mutex::new(Desk::with_whole()));
        DESK.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xcscr"));
        let path = std::env::var("PATH").unwrap();
        command
            .current_dir(self.0.path())
            .env("PATH", format!("{}:{path}", self.path("bin").display()))
            .arg("study")
            .args(words.split(' '));
        command
    }

    /// Starts a command whose message is read when it has ended.
    pub fn begin(&self, words: &str) -> Child {
        let mut command = self.command(words);
        let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    /// Runs a command that ends with this code, and returns its stdout and stderr.
    #[track_caller]
    pub fn ends(&self, words: &str, code: i32) -> (String, String) {
        program::ended(&self.command(words).output().unwrap(), code, words)
    }

    /// Runs a command that must succeed, and returns its stdout.
    #[track_caller]
    pub fn done(&self, words: &str) -> String {
        self.ends(words, 0).0
    }

    /// Runs a command that must succeed, and returns the JSON document that it prints.
    #[track_caller]
    pub fn json(&self, words: &str) -> Value {
        serde_json::from_str(&self.done(words)).unwrap()
    }

    /// Runs a command that must end with `code` and a message that has these words.
    #[track_caller]
    pub fn refused(&self, words: &str, code: i32, message: &str) {
        let said = self.ends(words, code).1;
        assert!(said.contains(message), "{words}: {message}: {said}");
    }

    /// A study has the results and trials of another one, whatever its number of tasks.
    #[track_caller]
    pub fn assert_same(&self, name: &str, other: &str) {
        folder::assert_same_study(&self.path(name), &self.path(other), name);
    }

    /// The same for a finished one that nobody runs commands on.
    #[track_caller]
    pub fn assert_whole(&self, name: &str) {
        static DESK: LazyLock<Desk> = LazyLock::new(Desk::with_whole);
        folder::assert_same_study(&self.path(name), &DESK.path("whole"), name);
    }

    /// Returns arm and number of the trials in the journals of a study, in the order of their lines.
    pub fn trials(&self, name: &str) -> Vec<String> {
        let journals = self.path(name).join("journals");
        let journals = match journals.exists() {
            true => folder::contents(&journals),
            false => Vec::new(),
        };
        let trial = |line: &str| {
            let (_, json) = line.split_once(' ').unwrap();
            let record: Value = serde_json::from_str(json).unwrap();
            format!("{} {}", record["arm"], record["trial"])
        };
        let of_one = |(_, bytes): (String, Vec<u8>)| {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let whole = text.rfind('\n').map_or(0, |end| end + 1);
            let lines = text[..whole].lines().skip(1).map(trial);
            lines.collect::<Vec<_>>()
        };
        journals.into_iter().flat_map(of_one).collect()
    }

    /// Changes the record of the trial of an arm in the journals of a study, with a valid checksum.
    pub fn edit_record(&self, name: &str, (arm, trial): (&str, usize), edit: impl Fn(&mut Value)) {
        let number = format!("\"trial\":{trial},");
        for entry in fs::read_dir(self.path(name).join("journals")).unwrap() {
            let path = entry.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let lines = text.lines().map(|line| match line.split_once(' ') {
                Some((_, json)) if json.contains(arm) && json.contains(&number) => {
                    let mut record: Value = serde_json::from_str(json).unwrap();
                    edit(&mut record);
                    let json = record.to_string();
                    format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes()))
                }
                _ => format!("{line}\n"),
            });
            fs::write(&path, lines.collect::<String>()).unwrap();
        }
    }

    /// Runs a command until so many trials of a study are finished, and sends it a signal. Returns its code.
    #[cfg(unix)]
    pub fn signalled(&self, words: &str, name: &str, trials: usize, signal: &str) -> Option<i32> {
        let mut child = self.begin(words);
        program::wait_until("trials", || {
            let has_ended = child.try_wait().unwrap().is_some();
            has_ended || self.trials(name).len() >= trials
        });
        program::signal(&child, signal);
        child.wait().unwrap().code()
    }
}

//! A folder in which a user runs studies.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use crate::kit::folder;
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

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
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

    pub fn study(&self, words: &str) -> Output {
        self.command(words).output().unwrap()
    }

    /// Runs a command that ends with this code, and returns its stdout and stderr.
    #[track_caller]
    pub fn ends(&self, words: &str, code: i32) -> (String, String) {
        let output = self.study(words);
        assert_eq!(output.status.code(), Some(code), "{words}: {output:?}");
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (text(output.stdout), text(output.stderr))
    }

    /// Runs a command that must succeed.
    #[track_caller]
    pub fn done(&self, words: &str) -> String {
        self.ends(words, 0).0
    }

    /// Runs a command that must end with `code`, and returns its message.
    #[track_caller]
    pub fn refused(&self, words: &str, code: i32) -> String {
        self.ends(words, code).1
    }

    #[track_caller]
    pub fn assert_same(&self, name: &str, other: &str) {
        folder::assert_same(&self.path(name), &self.path(other), name);
    }
}

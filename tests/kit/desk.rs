//! A folder for the files of a test, and the program that works with them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use serde_json::Value;
use tempfile::TempDir;
use xcscr::record::reader::Recording;

use super::folder::copy;
use super::program::{ended, xcscr};

/// A temporary folder. In a command line, a word that begins with `@` is a path in it: `@run` is its
/// file or folder `run`.
pub struct Desk(TempDir);

impl Desk {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Returns the path of the folder.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// Returns the path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Returns the path of a file as text.
    pub fn name(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    /// Writes a file, and creates the folders above it.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    #[track_caller]
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    #[track_caller]
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    #[track_caller]
    pub fn recording(&self, name: &str) -> Recording {
        Recording::open(&self.path(name)).unwrap()
    }

    /// Returns the words of a command line, with paths in place of `@` names.
    pub fn args(&self, line: &str) -> Vec<String> {
        let word = |word: &str| match word.strip_prefix('@') {
            Some(name) => self.name(name),
            None => word.to_owned(),
        };
        line.split_whitespace().map(word).collect()
    }

    /// Returns the command of a command line.
    pub fn command(&self, line: &str) -> Command {
        let mut command = xcscr(&[]);
        command.args(self.args(line));
        command
    }

    /// Returns the command of a command line under a limit of the shell, such as `-v 1000`.
    pub fn limited(&self, limit: &str, line: &str) -> Command {
        let mut shell = Command::new("sh");
        shell
            .args(["-c", &format!("ulimit {limit}; exec \"$0\" \"$@\"")])
            .arg(env!("CARGO_BIN_EXE_xcscr"))
            .args(self.args(line))
            .current_dir(env!("CARGO_MANIFEST_DIR"));
        shell
    }

    /// Starts a command line in the background and captures its output.
    pub fn spawn(&self, line: &str) -> Child {
        let mut command = self.command(line);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    /// Runs a command line, and returns its output whatever its exit code is.
    pub fn output(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs a command line, which must end with `code`. Returns stdout and stderr.
    #[track_caller]
    pub fn run(&self, code: i32, line: &str) -> (String, String) {
        ended(&self.output(line), code, line)
    }

    /// Runs a command line, which must succeed. Returns stdout.
    #[track_caller]
    pub fn ok(&self, line: &str) -> String {
        self.run(0, line).0
    }

    /// Runs a command line, which must succeed and print one JSON document.
    #[track_caller]
    pub fn json(&self, line: &str) -> Value {
        serde_json::from_str(&self.ok(line)).unwrap()
    }

    /// Runs a command line, which must end with `code` and with these words on stderr. Returns stderr.
    #[track_caller]
    pub fn fails(&self, code: i32, line: &str, words: &str) -> String {
        let (_, stderr) = self.run(code, line);
        assert!(stderr.contains(words), "{line}: {words} is not in {stderr}");
        stderr
    }

    /// Puts a run into the folder: the result of `train` with these arguments. Each test binary trains it
    /// once.
    #[track_caller]
    pub fn train(&self, name: &str, arguments: &str) -> PathBuf {
        let to = self.path(name);
        copy(&trained(arguments), &to);
        to
    }
}

/// A folder of a run, and whether it is trained.
type Run = (PathBuf, Arc<OnceLock<()>>);

/// The runs of this process, by their arguments.
static TRAINED: Mutex<BTreeMap<String, Run>> = Mutex::new(BTreeMap::new());

/// The folder of [`TRAINED`]. The folders of processes that have ended are deleted.
static RUNS: LazyLock<PathBuf> = LazyLock::new(|| {
    let all = Path::new(env!("CARGO_TARGET_TMPDIR")).join("runs");
    fs::create_dir_all(&all).unwrap();
    for entry in fs::read_dir(&all).unwrap().map(Result::unwrap) {
        if !Path::new("/proc").join(entry.file_name()).exists() {
            // Another process may delete it at the same time.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
    let own = all.join(std::process::id().to_string());
    fs::create_dir_all(&own).unwrap();
    own
});

/// Returns the folder of a run, which is trained at the first call.
#[track_caller]
fn trained(arguments: &str) -> PathBuf {
    let (folder, is_trained) = {
        let mut all = TRAINED.lock().unwrap();
        let folder = RUNS.join(all.len().to_string());
        let new = || (folder, Arc::default());
        all.entry(arguments.to_owned()).or_insert_with(new).clone()
    };
    is_trained.get_or_init(|| {
        let mut command = xcscr(&["train", "--quiet", "--out", folder.to_str().unwrap()]);
        let output = command.args(arguments.split_whitespace()).output().unwrap();
        ended(&output, 0, arguments);
    });
    folder
}

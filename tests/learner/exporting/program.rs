//! Exported policies as programs that answer questions. The drivers say in which form.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;
use xcscr::export::Target;
use xcscr::world::{Cell, Maze};

pub const LANGUAGES: [Target; 2] = [Target::C99, Target::Python];

/// A program made of an exported policy.
pub struct Program {
    folder: TempDir,
    target: Target,
}

impl Program {
    pub fn new(target: Target, policy: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        match target {
            Target::C99 => {
                write("policy.h", policy);
                write("driver.c", include_str!("driver.c"));
                compile_c(folder.path(), "driver.c");
            }
            _ => {
                write("policy.py", policy);
                write("driver.py", include_str!("driver.py"));
            }
        }
        Self { folder, target }
    }

    /// The command that runs the program, with the letters of a map.
    pub fn command(&self, map: &str) -> Command {
        let mut command = match self.target {
            Target::Python => Command::new("python3"),
            _ => Command::new(self.folder.path().join("driver")),
        };
        if self.target == Target::Python {
            command.arg("driver.py");
        }
        command.arg(map).current_dir(self.folder.path());
        command
    }

    /// Returns the answers, one a line.
    pub fn answers(&self, questions: &Questions) -> Vec<String> {
        let mut command = self.command(&questions.map);
        let printed = fed(&mut command, questions.lines.clone().into_bytes());
        let text = String::from_utf8(printed).unwrap();
        text.lines().map(str::to_owned).collect()
    }
}

/// Returns what a command prints for an input. It must succeed without a warning.
pub fn fed(command: &mut Command, input: Vec<u8>) -> Vec<u8> {
    let command = command.stdin(Stdio::piped());
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|cause| panic!("{command:?}: {cause}"));
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().unwrap();
    let _ = writer.join().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    let is_well = output.status.success() && stderr.is_empty();
    assert!(is_well, "{command:?}: {stderr}");
    output.stdout
}

/// Compiles a C program as `driver`.
pub fn compile_c(folder: &Path, file: &str) {
    let mut compiler = Command::new("cc");
    let strict = "-std=c99 -O1 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Werror";
    let compiler = compiler
        .args(strict.split(' '))
        .args([file, "-o", "driver"]);
    fed(compiler.current_dir(folder), Vec::new());
}

/// Questions to an exported program, as `driver.c` lists them.
#[derive(Default)]
pub struct Questions {
    map: String,
    lines: String,
}

impl Questions {
    /// Questions about a maze.
    pub fn about(maze: &Maze) -> Self {
        let letter = |cell| match (maze.is_wall(cell), maze.is_goal(cell)) {
            (true, _) => '#',
            (false, true) => 'G',
            (false, false) => '.',
        };
        Self {
            map: maze.cells().map(letter).collect(),
            lines: String::new(),
        }
    }

    /// Asks a question: its letter and up to four numbers.
    pub fn ask(&mut self, command: char, numbers: &[u64]) {
        self.lines.push(command);
        for at in 0..numbers.len().max(4) {
            let number = numbers.get(at).copied().unwrap_or(0);
            self.lines += &format!(" {number:x}");
        }
        self.lines.push('\n');
    }

    /// Asks a question with lengths, cosines and sines.
    pub fn say(&mut self, command: char, numbers: &[f64]) {
        let bits: Vec<u64> = numbers.iter().map(|number| number.to_bits()).collect();
        self.ask(command, &bits);
    }

    /// Asks a question about a cell.
    pub fn of(&mut self, command: char, cell: Cell) {
        self.ask(command, &[cell.col.into(), cell.row.into()]);
    }
}

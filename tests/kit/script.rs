//! Command lines as data. A script is a text with a step per line:
//!
//! ```text
//! == A title, after which the folder is empty
//! CODE COMMAND LINE => WORDS => !WORDS      ends with this code, says these words, and not those
//! save FILE COMMAND LINE                    writes what the command prints into a file
//! train RUN ARGUMENTS                       puts a run there, see `Desk::train`
//! write FILE TEXT                           `\n` begins a new line
//! rename FILE FILE, remove FILE
//! text FILE TEXT, other FILE TEXT           the file has this text, or another one
//! has FILE WORDS                            the file has these words in it
//! there FILE, gone FILE                     the file exists, or does not
//! same FOLDER FOLDER                        both have the same files with the same bytes
//! ```
//!
//! A command that is refused (2, 65, 66 and 73) prints no result and changes no file. Warnings and errors
//! do not go to stdout. No command prints what a terminal obeys.

use std::fs;
use std::path::Path;

use super::desk::Desk;
use super::folder::assert_same;

/// The exit codes of commands that have done nothing.
const REFUSED: [i32; 4] = [2, 65, 66, 73];

/// Runs a script.
pub fn run(script: &str) {
    run_with(script, &[]);
}

/// Runs a script in which words stand for others.
pub fn run_with(script: &str, words: &[(&str, &str)]) {
    let (mut desk, mut title) = (Desk::new(), "");
    let is_step = |line: &&str| !line.is_empty() && !line.starts_with('#');
    for line in script.lines().filter(is_step) {
        match line.strip_prefix("== ") {
            Some(next) => (desk, title) = (Desk::new(), next),
            None => step(&desk, line, words, &format!("{title}: {line}")),
        }
    }
}

/// Runs the steps of a script with the files of a desk.
pub fn run_at(desk: &Desk, steps: &str) {
    for line in steps.lines().map(str::trim_start) {
        step(desk, line, &[], line);
    }
}

fn step(desk: &Desk, line: &str, words: &[(&str, &str)], what: &str) {
    let line = words.iter().fold(line.to_owned(), |line, (word, other)| {
        line.replace(word, other)
    });
    let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
    if let Ok(code) = word.parse() {
        return command(desk, code, rest, what);
    }
    let (name, text) = rest.split_once(' ').unwrap_or((rest, ""));
    let (path, text) = (desk.path(name), text.replace("\\n", "\n"));
    match word {
        "save" => desk.write(name, desk.ok(&text)),
        "train" => drop(desk.train(name, &text)),
        "write" => desk.write(name, text),
        "rename" => fs::rename(path, desk.path(&text)).unwrap(),
        "remove" if path.is_dir() => fs::remove_dir_all(path).unwrap(),
        "remove" => fs::remove_file(path).unwrap(),
        "text" => assert_eq!(desk.text(name), text, "{what}"),
        "other" => assert!(desk.read(name) != text.as_bytes(), "{what}"),
        "has" => assert!(desk.text(name).contains(&text), "{what}"),
        "same" => assert_same(&path, &desk.path(&text), what),
        "there" => assert!(path.exists(), "{what}"),
        "gone" => assert!(!path.exists(), "{what}"),
        _ => panic!("{what}: no such step"),
    }
}

/// Runs a command line, which ends with a code and says words.
fn command(desk: &Desk, code: i32, line: &str, what: &str) {
    let mut parts = line.split(" => ");
    let line = parts.next().unwrap();
    let before = REFUSED.contains(&code).then(|| files(desk.folder()));
    let (stdout, stderr) = desk.run(code, line);
    let said = format!("{stdout}{stderr}");
    assert!(!said.contains(is_obeyed), "{what}\n{said:?}");
    let is_told_apart = !["warning:", "error:"]
        .iter()
        .any(|word| stdout.contains(word));
    assert!(is_told_apart || line.contains("check"), "{what}\n{stdout}");
    for words in parts {
        match words.strip_prefix('!') {
            Some(words) => assert!(!said.contains(words), "{what}\n{said}"),
            None => assert!(said.contains(words), "{what}\n{said}"),
        }
    }
    if let Some(before) = before {
        let is_check = line.contains("check");
        assert!(stdout.is_empty() || is_check, "{what}\n{stdout}");
        let after = files(desk.folder());
        assert!(after == before, "{what}: a file was changed");
    }
}

/// A terminal does more with this character than to show it.
fn is_obeyed(letter: char) -> bool {
    letter == '\u{202e}' || (letter.is_control() && letter != '\n' && letter != '\t')
}

/// Every file below a folder with its bytes, sorted by path.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|one| one.unwrap().path());
    let of_entry = |path: std::path::PathBuf| match path.is_dir() {
        true => [vec![(path.display().to_string(), Vec::new())], files(&path)].concat(),
        false => vec![(path.display().to_string(), fs::read(&path).unwrap())],
    };
    let mut all: Vec<_> = entries.flat_map(of_entry).collect();
    all.sort();
    all
}

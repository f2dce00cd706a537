//! Every command that the pages show does what it says: those in blocks marked `sh` are run, page by
//! page, in an empty folder with the worlds beside it; those in blocks marked `sh,parsed`, which
//! would take too long or serve for ever, must be valid arguments. Those in blocks marked
//! `text,refused` follow a `$`, and must fail with the message below them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A command, and what must come of it.
#[derive(Debug, PartialEq)]
struct Shown {
    command: String,
    end: End,
}

#[derive(Debug, PartialEq)]
enum End {
    /// It runs and succeeds.
    Succeeds,
    /// Its arguments are valid.
    Parses,
    /// It is refused with this message, in which `...` stands for any text.
    Refused(String),
}

/// The commands of the program in the blocks of a page; `cargo run ... -- X` is `xcscr X`.
fn shown(page: &str) -> Vec<Shown> {
    let mut found: Vec<Shown> = Vec::new();
    let mut block: Option<&str> = None;
    for line in page.lines() {
        if let Some(kind) = line.strip_prefix("```") {
            block = block.is_none().then_some(kind);
            continue;
        }
        let (line, end) = match block {
            Some("sh") => (line, End::Succeeds),
            Some("sh,parsed") => (line, End::Parses),
            Some("text,refused") => match line.strip_prefix("$ ") {
                Some(line) => (line, End::Refused(String::new())),
                None => {
                    let last = found.last_mut().map(|shown| &mut shown.end);
                    let Some(End::Refused(message)) = last else {
                        panic!("a message without a command: {line}");
                    };
                    message.push_str(line);
                    message.push('\n');
                    continue;
                }
            },
            _ => continue,
        };
        if let Some(command) = of_the_program(line) {
            found.push(Shown { command, end });
        }
    }
    found
}

/// A line of a block as a command of the program, if it is one.
fn of_the_program(line: &str) -> Option<String> {
    if line.starts_with("xcscr ") {
        return Some(line.to_owned());
    }
    let (options, rest) = line.strip_prefix("cargo run ")?.split_once("-- ")?;
    (!options.contains("--example")).then(|| format!("xcscr {rest}"))
}

/// A folder with the worlds and the sample recording.
fn folder() -> TempDir {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().unwrap();
    for (from, ending) in [("worlds", "json"), ("recordings", "mcap")] {
        fs::create_dir(folder.path().join(from)).unwrap();
        for file in fs::read_dir(root.join(from)).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let wanted = from == "worlds" || name.starts_with("sample");
            if wanted && path.extension().is_some_and(|e| e == ending) {
                fs::copy(&path, folder.path().join(from).join(name)).unwrap();
            }
        }
    }
    folder
}

/// Runs a line in the shell, where `xcscr` is the program that was built.
fn shell(line: &str, folder: &Path) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_xcscr"));
    let beside = program.parent().unwrap().display();
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = Command::new("sh");
    command.args(["-euc", line]).current_dir(folder);
    command.env("PATH", format!("{beside}:{path}"));
    command.output().unwrap()
}

/// Writes the study files that the page shows to where its commands look for them: each goes by the
/// name that is said behind it.
fn write_shown_studies(page: &str, folder: &Path) {
    for rest in page.split("```toml\n").skip(1) {
        let (study, behind) = rest.split_once("```").unwrap();
        let name = behind.split('`').nth(1).unwrap();
        fs::write(folder.join(name), study).unwrap();
    }
}

/// Runs or parses every command of a page; gives how many.
#[track_caller]
fn follow(file: &str) -> usize {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let folder = folder();
    write_shown_studies(&page, folder.path());
    let commands = shown(&page);
    for Shown { command, end } in &commands {
        // Arguments are parsed from left to right, and `--help` ends it before anything is done.
        let without_comment = command.split(" #").next().unwrap();
        let line = match end {
            End::Succeeds | End::Refused(_) => command.clone(),
            End::Parses => format!("{without_comment} --help"),
        };
        let Output {
            status,
            stdout,
            stderr,
        } = shell(&line, folder.path());
        let [stdout, stderr] =
            [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        let is_as_shown = match end {
            End::Refused(message) => !status.success() && is_shown(&stderr, message),
            End::Succeeds | End::Parses => status.success(),
        };
        assert!(is_as_shown, "{file}: {line}: {status}\n{stdout}\n{stderr}");
    }
    commands.len()
}

/// Returns whether a message is the shown one, whose lines may be wrapped.
fn is_shown(message: &str, shown: &str) -> bool {
    let [message, shown] =
        [message, shown].map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "));
    let parts: Vec<&str> = shown.split("...").collect();
    let mut rest = Some(&message[..]);
    for part in &parts {
        rest = rest.and_then(|rest| Some(rest.split_once(part)?.1));
    }
    message.starts_with(parts[0]) && rest == Some("")
}

/// All pages of the guide, as paths from `docs/src`.
fn pages() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src");
    let mut pages = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => pages.push(path.strip_prefix(&root).unwrap().display().to_string()),
            }
        }
    }
    pages.sort();
    pages
}

#[test]
fn the_readme_can_be_followed() {
    assert!(follow("README.md") > 6);
}

#[test]
fn every_page_of_the_guide_can_be_followed() {
    let pages = pages();
    let commands: usize = std::thread::scope(|scope| {
        let follow = |page| scope.spawn(move || follow(&format!("docs/src/{page}")));
        let threads: Vec<_> = pages.iter().map(follow).collect();
        threads.into_iter().map(|one| one.join().unwrap()).sum()
    });
    assert!(commands > 60, "only {commands} commands");
}

#[test]
fn every_page_is_in_the_summary() {
    let summary = include_str!("../../docs/src/SUMMARY.md");
    for page in pages() {
        let listed = summary.contains(&format!("({page})"));
        assert!(
            listed || page == "SUMMARY.md",
            "{page} is not in SUMMARY.md"
        );
    }
}

#[test]
fn control_blocks_and_commands_are_told_apart() {
    let page = "```sh\nxcscr a # b\ncargo run --release -- c\ncargo test\n```\nxcscr d\n\
                ```sh,parsed\nxcscr e\n```\n```text\nxcscr f\n```\n\
                ```text,refused\n$ xcscr g\nerror:\nh\n```\n";
    let expected = [
        ("xcscr a # b", End::Succeeds),
        ("xcscr c", End::Succeeds),
        ("xcscr e", End::Parses),
        ("xcscr g", End::Refused("error:\nh\n".to_owned())),
    ];
    let expected = expected.map(|(command, end)| Shown {
        command: command.to_owned(),
        end,
    });
    assert_eq!(shown(page), expected);
}

#[test]
fn control_a_message_is_compared_whole() {
    assert!(is_shown("error: a (1) b\n", "error: a\n(...) b"));
    for other in [
        "error: a (...) c",
        "error: a",
        "a (...) b",
        "error: a (...) b c",
    ] {
        assert!(!is_shown("error: a (1) b\n", other), "{other}");
    }
}

#[test]
fn control_a_command_with_unknown_arguments_fails_even_when_only_parsed() {
    let folder = folder();
    let status = |line: &str| shell(line, folder.path()).status.code();
    assert_eq!(status("xcscr study run paper --help"), Some(0));
    assert_eq!(
        status("xcscr study run paper --such-as-this --help"),
        Some(2)
    );
    assert_eq!(status("xcscr study run paper --trials few --help"), Some(2));
    assert_eq!(status("xcscr no-such-command"), Some(2));
}

//! The contract of the command line: what goes where, and the exit codes.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn xcscr(args: &[&str]) -> Output {
    let mut command = Command::new(binary());
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    command.output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn help_documents_every_exit_code() {
    let help = text(&xcscr(&["--help"]).stdout);
    for code in ["0", "1", "2", "65", "66", "70", "73", "74", "75"] {
        let listed = help
            .lines()
            .any(|line| line.trim_start().starts_with(&format!("{code}  ")));
        assert!(listed, "{code} is missing in\n{help}");
    }
}

#[test]
fn a_wrong_word_is_a_usage_error_with_code_2() {
    let output = xcscr(&["wrold"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
}

#[test]
fn a_missing_world_gives_code_66() {
    let output = xcscr(&["world", "show", "worlds/none.json"]);
    assert_eq!(output.status.code(), Some(66), "{output:?}");
    assert_eq!(
        text(&output.stderr),
        "error: there is no world file `worlds/none.json`\n"
    );
}

#[test]
fn a_missing_world_names_the_shipped_ones_that_are_near() {
    for name in ["maez4.json", "worlds/maez4.json", "elsewhere/Maze4.json"] {
        let said = text(&xcscr(&["train", name]).stderr);
        assert!(said.contains("did you mean maze4"), "{said}");
    }
}

#[test]
fn what_is_no_recording_gets_no_advice_for_recordings() {
    for command in [
        &["recording", "check", "README.md"][..],
        &["recording", "info", "README.md"],
        &["recording", "recover", "README.md", "-o", "no/such/out"],
    ] {
        let output = xcscr(command);
        assert_eq!(output.status.code(), Some(65), "{output:?}");
        let said = text(&[output.stdout, output.stderr].concat());
        assert!(said.contains("this is not a recording"), "{said}");
        assert!(!said.contains("`xcscr"), "{said}");
    }
    // Control: a damaged recording gets it.
    let folder = tempfile::tempdir().unwrap();
    let damaged = folder.path().join("damaged.mcap");
    let sound = fs::read("recordings/sample-maze4.mcap").unwrap();
    fs::write(&damaged, &sound[..sound.len() / 2]).unwrap();
    let said = text(&xcscr(&["recording", "info", damaged.to_str().unwrap()]).stderr);
    assert!(said.contains("`xcscr recording recover`"), "{said}");
}

#[test]
fn a_folder_instead_of_a_world_gives_code_74() {
    let output = xcscr(&["world", "info", "worlds"]);
    assert_eq!(output.status.code(), Some(74), "{output:?}");
}

#[test]
fn check_goes_on_after_a_bad_world_and_ends_with_code_65() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.json");
    fs::write(&bad, "{}").unwrap();
    let bad = bad.to_str().unwrap();
    let output = xcscr(&["world", "check", "none.json", bad, "worlds/maze4.json"]);
    assert_eq!(output.status.code(), Some(65), "{output:?}");
    assert_eq!(
        text(&output.stdout),
        "worlds/maze4.json: maze4, 8 x 8 cells, 10 steps on 3 shortest paths\n"
    );
    let stderr = text(&output.stderr);
    assert!(
        stderr.ends_with("error: 2 of 3 worlds cannot be used\n"),
        "{stderr}"
    );
}

#[test]
fn show_draws_the_maze() {
    let output = xcscr(&["world", "show", "worlds/maze4.json"]);
    insta::assert_snapshot!(text(&output.stdout), @r"
    ████████████████
    ██S   ██      ██
    ████    ██    ██
    ████  ██    ████
    ██            ██
    ████  ██      ██
    ██        ██G ██
    ████████████████
    ");
}

#[test]
fn info_tells_size_paths_and_cells_that_look_alike() {
    let output = xcscr(&["world", "info", "worlds/maze4.json"]);
    insta::assert_snapshot!(text(&output.stdout));
}

#[test]
fn info_with_json_prints_one_json_document() {
    for world in ["maze4", "woods1"] {
        let output = xcscr(&["world", "info", "--json", &format!("worlds/{world}.json")]);
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(document["world"], world);
        assert!(output.stderr.is_empty(), "{output:?}");
    }
}

#[test]
fn a_reader_that_goes_away_is_a_clean_end() {
    // Larger than the buffer of a pipe, so that writing must notice the closed end.
    let side = 300;
    let rows: Vec<String> = (0..side)
        .map(|row| match row {
            0 => "#".repeat(side),
            1 => format!("#SG{}", "#".repeat(side - 3)),
            _ => "#".repeat(side),
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("big.json");
    fs::write(&file, format!(r#"{{"rows": {rows:?}}}"#)).unwrap();
    let mut child = Command::new(binary())
        .args(["world", "show"])
        .arg(&file)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stderr.is_empty(), "{output:?}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_gives_code_74() {
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let output = Command::new(binary())
        .args(["world", "show", "worlds/maze4.json"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdout(full)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(output.status.code(), Some(74), "{output:?}");
    assert!(
        text(&output.stderr).starts_with("error: cannot write"),
        "{output:?}"
    );
}

fn binary() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_xcscr"))
}

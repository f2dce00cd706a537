//! What files hold is printed, and never obeyed: one file of each kind, full of escape sequences.

use std::fs;
use std::path::Path;

use crate::kit::program::{expect, xcscr};

/// Red, a new title, a cleared screen by one character above ASCII, backspaces, and a text that runs
/// from right to left.
const EVIL: &str = "\u{1b}[31m\u{1b}]0;title\u{7}\u{9b}2J\u{8}\u{7f}\r\u{202e}evil";

/// What a command prints holds nothing that commands a terminal, and says that something is evil.
#[track_caller]
fn assert_harmless(args: &[&str]) -> String {
    let output = xcscr(args).output().unwrap();
    let printed = [output.stdout, output.stderr].concat();
    let text = String::from_utf8(printed).unwrap();
    let commands = |letter: char| {
        letter == '\u{202e}' || (letter.is_control() && letter != '\n' && letter != '\t')
    };
    assert!(!text.contains(commands), "{args:?}: {text:?}");
    assert!(!text.contains("panicked"), "{args:?}: {text}");
    text
}

fn write(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A text as it stands in JSON and TOML.
fn quoted(text: &str) -> String {
    let json = serde_json::to_string(text).unwrap();
    // TOML wants more of them spelt out.
    json.replace('\u{7f}', "\\u007f")
        .replace('\u{9b}', "\\u009b")
}

#[test]
fn worlds_settings_studies_and_rules() {
    let folder = tempfile::tempdir().unwrap();
    let evil = quoted(EVIL);
    for (name, text) in [
        ("key.json", format!("{{{evil}: 1}}")),
        ("raw.json", format!("{{\"rows\": [\"{EVIL}\"]}}")),
        (
            "name.json",
            format!("{{\"name\": {evil}, \"rows\": [\"SG\"]}}"),
        ),
        (
            "wrap.json",
            format!("{{\"wrap\": {evil}, \"rows\": [\"SG\"]}}"),
        ),
    ] {
        let file = write(folder.path(), name, text);
        let said = assert_harmless(&["world", "check", &file]);
        assert!(said.contains("error"), "{said}");
        assert_harmless(&["train", &file]);
    }
    let world = "worlds/maze4.json";
    for (name, text) in [
        ("key.toml", format!("{evil} = 1\n")),
        ("section.toml", format!("[{evil}]\nx = 1\n")),
        ("value.toml", format!("xcs.beta = {evil}\n")),
        ("raw.toml", format!("xcs.beta = {EVIL}\n")),
    ] {
        let file = write(folder.path(), name, &text);
        let said = assert_harmless(&["train", world, "--config", &file]);
        assert!(said.contains("evil"), "{name}: {said}");
        assert_harmless(&["study", "run", &file, "--out", "no/such"]);
    }
    let study = "worlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 1\nepisodes = 1\n";
    for (name, text) in [
        ("name", format!("name = {evil}\n{study}")),
        (
            "sweep",
            format!("name = \"s\"\n{study}[sweep]\n{evil} = [1]\n"),
        ),
        (
            "world",
            format!("name = \"s\"\n{study}").replace("\"maze4\"", &evil),
        ),
        (
            "method",
            format!("name = \"s\"\n{study}").replace("\"xcs\"", &evil),
        ),
    ] {
        let file = write(folder.path(), &format!("{name}.toml"), text);
        let said = assert_harmless(&["study", "run", &file, "--out", "no/such"]);
        assert!(said.contains("error"), "{name}: {said}");
    }
    for (name, text) in [
        (
            "condition",
            format!("{{\"rules\": [{{\"condition\": {evil}}}]}}"),
        ),
        ("kind", format!("{{{evil}: []}}")),
        ("table", format!("{{\"table\": {{{evil}: []}}}}")),
    ] {
        let file = write(folder.path(), &format!("{name}-rules.json"), text);
        let said = assert_harmless(&["evaluate", &file, "--world", world]);
        assert!(said.contains("error"), "{name}: {said}");
    }
}

#[test]
fn recordings() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("evil.mcap");
    let mut writer = mcap::Writer::new(fs::File::create(&path).unwrap()).unwrap();
    let schema = writer.add_schema(EVIL, "jsonschema", b"{}").unwrap();
    let entries = [(EVIL.to_owned(), EVIL.to_owned())];
    let entries: std::collections::BTreeMap<String, String> = entries.into();
    writer.add_channel(schema, EVIL, "json", &entries).unwrap();
    let name = "run".to_owned();
    let metadata = mcap::records::Metadata {
        name,
        metadata: entries,
    };
    writer.write_metadata(&metadata).unwrap();
    for name in ["config.json", "world.json"] {
        let attachment = mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: EVIL.to_owned(),
            data: format!("{{{}: 1}}", quoted(EVIL)).into_bytes().into(),
        };
        writer.attach(&attachment).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let file = path.to_str().unwrap();
    let shown = assert_harmless(&["recording", "info", file]);
    assert!(shown.contains("\\u001b[31m"), "{shown}");
    let (json, _) = expect(0, &["recording", "info", file, "--json"]);
    let shown: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(shown[0]["topics"][0]["name"], EVIL, "the same as before");
    for args in [
        &["recording", "check", file][..],
        &["recording", "check", file, "--json"],
        &["recording", "verify", file],
        &["map", file, "-o", "no/such.svg"],
    ] {
        assert_harmless(args);
    }
}

#[test]
fn journals_and_plans() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("s");
    let dir = out.to_str().unwrap();
    let study =
        "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 1\nepisodes = 1\n";
    let file = write(folder.path(), "s.toml", study);
    let words = ["study", "run", &file];
    expect(0, &[&words[..], &["--quiet", "--out", dir]].concat());
    let journal = crate::kit::folder::journal(&out);
    let text = fs::read_to_string(&journal).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let json = format!("{{\"trial\":0,\"result\":{{\"Err\":{}}}}}", quoted(EVIL));
    lines[1] = format!("{:08x} {json}", crc32fast::hash(json.as_bytes()));
    fs::write(&journal, lines.join("\n") + "\n").unwrap();
    let said = assert_harmless(&["study", "report", dir, "--force"]);
    assert!(said.contains("\\u001b[31m"), "{said}");
    assert_harmless(&[&words[..], &["--quiet", "--out", dir]].concat());
    let plan = fs::read_to_string(out.join("plan.json")).unwrap();
    let forged = plan.replacen("\"plan\"", &quoted(EVIL), 1);
    fs::write(out.join("plan.json"), forged).unwrap();
    let said = assert_harmless(&["study", "status", dir]);
    assert!(said.contains("evil"), "{said}");
}

#[test]
fn names_of_files() {
    let folder = tempfile::tempdir().unwrap();
    let name = EVIL.replace('\r', "");
    let file = write(folder.path(), &name, "{}");
    for args in [
        &["world", "check", &file][..],
        &["recording", "check", &file],
        &["recording", "info", &file],
        &["train", &file],
        &["evaluate", &file],
        &["study", "run", &file, "--out", "no/such"],
    ] {
        let said = assert_harmless(args);
        assert!(said.contains("evil"), "{args:?}: {said}");
    }
    let out = folder.path().join("run-\u{1b}[31m");
    let out = out.to_str().unwrap();
    let shown = assert_harmless(&[
        "train",
        "worlds/maze4.json",
        "--episodes",
        "1",
        "--out",
        out,
    ]);
    assert!(shown.contains("$'"), "as a shell reads it: {shown}");
}

/// What stands behind flags goes through the library of the command line, which quotes it.
#[test]
fn arguments() {
    let flag = format!("--{EVIL}");
    let set = format!("{EVIL}=1");
    for args in [
        &[EVIL][..],
        &[&flag],
        &["train", "worlds/maze4.json", &flag],
        &["train", "worlds/maze4.json", "--method", EVIL],
        &["train", "worlds/maze4.json", "--seed", EVIL],
        &["train", "worlds/maze4.json", "--set", &set],
        &["replay", "x.mcap", "--allow-origin", EVIL],
        &["world", EVIL],
        &["study", "run", EVIL, EVIL],
    ] {
        let said = assert_harmless(args);
        assert!(
            said.contains("error") && said.contains("evil"),
            "{args:?}: {said}"
        );
        assert!(!said.contains("error: error"), "{args:?}: {said}");
    }
}

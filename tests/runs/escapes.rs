//! What files hold is printed, and never obeyed: one file of each kind, full of escape sequences.

use std::collections::BTreeMap;
use std::fs;

use crate::kit::desk::Desk;
use crate::kit::folder::journal;
use crate::kit::script;

/// Red, a new title, a cleared screen by one character above ASCII, backspaces, and a text that runs
/// from right to left.
const EVIL: &str = "\u{1b}[31m\u{1b}]0;title\u{7}\u{9b}2J\u{8}\u{7f}\r\u{202e}evil";

/// A text as it stands in JSON and TOML.
fn quoted(text: &str) -> String {
    let json = serde_json::to_string(text).unwrap();
    // TOML wants more of them spelt out.
    json.replace('\u{7f}', "\\u007f")
        .replace('\u{9b}', "\\u009b")
}

#[test]
fn worlds_settings_studies_rules_names_of_files_and_arguments() {
    let quoted = quoted(EVIL);
    // A carriage return would end an argument.
    let evil = EVIL.replace('\r', "");
    let words = [("QUOTED", &quoted[..]), ("EVIL", &evil[..])];
    script::run_with(include_str!("escapes.txt"), &words);
}

#[test]
fn recordings() {
    let desk = Desk::new();
    let file = fs::File::create(desk.path("evil.mcap")).unwrap();
    let mut writer = mcap::Writer::new(file).unwrap();
    let schema = writer.add_schema(EVIL, "jsonschema", b"{}").unwrap();
    let entries: BTreeMap<_, _> = [(EVIL.to_owned(), EVIL.to_owned())].into();
    writer.add_channel(schema, EVIL, "json", &entries).unwrap();
    let metadata = mcap::records::Metadata {
        name: "run".to_owned(),
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
    let shown = desk.json("recording info @evil.mcap --json");
    assert_eq!(shown[0]["topics"][0]["name"], EVIL, "the same as before");
    script::run_at(
        &desk,
        "0 recording info @evil.mcap => \\u001b[31m
         65 recording check @evil.mcap
         65 recording check @evil.mcap --json
         1 recording verify @evil.mcap
         65 map @evil.mcap -o @map.svg",
    );
}

#[test]
fn journals_and_plans() {
    let desk = Desk::new();
    let text =
        "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 1\nepisodes = 1\n";
    desk.write("s.toml", text);
    desk.ok("study run @s.toml --quiet --out @s");
    let path = journal(&desk.path("s"));
    let text = fs::read_to_string(&path).unwrap();
    let head = text.lines().next().unwrap();
    let line = text.lines().nth(1).unwrap();
    let arm = line.split_inclusive(',').next().unwrap();
    let json = format!(
        "{}\"trial\":1,\"result\":{{\"Err\":{}}}}}",
        &arm[9..],
        quoted(EVIL)
    );
    let sum = crc32fast::hash(json.as_bytes());
    fs::write(&path, format!("{head}\n{sum:08x} {json}\n")).unwrap();
    script::run_at(
        &desk,
        "1 study report @s --force => \\u001b[31m
         1 study run @s.toml --quiet --out @s",
    );
    let plan = desk.text("s/study.json");
    desk.write("s/study.json", plan.replacen("\"plan\"", &quoted(EVIL), 1));
    script::run_at(&desk, "65 study status @s => evil");
}

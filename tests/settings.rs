//! A setting is declared once, and all that is said of it comes from there.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use xcscr::agent::Method;
use xcscr::record::Topic;
use xcscr::sensor::Sensor;
use xcscr::study::{StudyKey, report_columns};
use xcscr::trial::{Resolved, Settings};

/// The page of the documentation, as the declarations have it.
fn page() -> String {
    let mut page = "# Settings\n\nEvery setting with its default and its range. The full name of a setting begins with its section: \
        `--set arena.slip=0.1` changes `slip` of the section `arena` \
        ([other ways](../how-to/choose-a-method.md#change-settings)). Defaults of single methods follow in parentheses. \
        A setting without a range is a switch, `true` or `false`, or its description gives the range. \
        [XCS on one page](../explanation/xcscr.md#xcs-on-one-page) explains the symbols. \
        This page is generated from the declarations in the source \
        (`UPDATE_DOCS=1 cargo test --test suite settings::` regenerates it).\n"
        .to_owned();
    let resolved = Resolved::new(&Settings::default(), &[], &[]).unwrap();
    let declared = Settings::declared();
    let mut rows: Vec<_> = declared.iter().zip(resolved.entries()).collect();
    rows.sort_by_key(|(setting, _)| setting.key.rsplit_once('.'));
    let mut section = "";
    for (setting, (key, value, _)) in rows {
        assert_eq!(setting.key, key);
        let (of, name) = setting.key.rsplit_once('.').unwrap();
        if of != section {
            section = of;
            let head = "| setting | default | range | what it is |\n|---|---|---|---|";
            writeln!(page, "\n## {section}\n\n{head}").unwrap();
        }
        let range = setting.range.clone().or_else(|| words_of(key, &value));
        let range = range.unwrap_or_default();
        let about = setting.about.split_whitespace().collect::<Vec<_>>();
        let about = about.join(" ").replace('|', "\\|");
        let others = other_defaults(key, &value);
        writeln!(page, "| `{name}` | {value}{others} | {range} | {about} |").unwrap();
    }
    page
}

/// The defaults of methods that differ from the common one, such as ` (3200: xcscr)`.
fn other_defaults(key: &str, common: &str) -> String {
    let mut others: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for &method in Method::ALL {
        let resolved = Resolved::new(&Settings::of(method), &[], &[]).unwrap();
        let (_, own, _) = resolved.entries().find(|(of, ..)| *of == key).unwrap();
        if own != common {
            others.entry(own).or_default().push(method.name());
        }
    }
    let named =
        |(value, methods): (&String, &Vec<&str>)| format!(" ({value}: {})", methods.join(", "));
    others.iter().map(named).collect()
}

/// The values of a setting that is a word, as the refusal of any other word lists them.
fn words_of(key: &str, value: &str) -> Option<String> {
    if !value.starts_with('"') {
        return None;
    }
    let set = [format!("{key}=other")];
    let refusal = Resolved::new(&Settings::default(), &[], &set).unwrap_err();
    let refusal = refusal.to_string();
    let (_, allowed) = refusal.split_once("but must be ").unwrap();
    Some(allowed.replace("one of ", ""))
}

/// The table of the columns of a report stands in a page that has more.
#[test]
fn the_page_of_results_has_the_columns_of_a_report_as_they_are_described_there() {
    let path = "docs/src/results.md";
    let text = fs::read_to_string(path).unwrap();
    let head = "| metric | meaning |\n|---|---|\n";
    let (before, rest) = text.split_once(head).unwrap();
    let (_, after) = rest.split_once("\n\n").unwrap();
    let rows = report_columns().map(|(names, about)| format!("| {names} | {about} |"));
    let table = rows.collect::<Vec<_>>().join("\n");
    require(&format!("{before}{head}{table}\n\n{after}"), path);
}

#[test]
fn the_page_of_settings_says_what_is_declared() {
    let page = page() + &keys_of_a_study_file();
    require(&page, "docs/src/reference/settings.md");
}

/// Requires that a page of the documentation is this one.
fn require(page: &str, path: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, page).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap();
    let hint = "UPDATE_DOCS=1 cargo test --test suite settings:: regenerates it";
    assert_eq!(written, page, "{hint}");
}

/// The section of the page with the keys of a study file.
fn keys_of_a_study_file() -> String {
    let mut page = "\n## Keys of a study file\n".to_owned();
    for key in StudyKey::all() {
        let default = match &key.default {
            None => "required".to_owned(),
            Some(default) => format!("default: {}", default.replace('`', "")),
        };
        let (name, kind, about, example) = (&key.name, &key.kind, &key.about, &key.example);
        let text = format!(
            "\n### {name}\n\nA {kind}; {default}. {about}\n\n```toml,example\n{example}\n```"
        );
        writeln!(page, "{text}").unwrap();
    }
    page
}

/// The help of a command, at its default width.
fn help_of(words: &[&str]) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_xcscr"));
    let output = program.args(words).arg("--help").output().unwrap();
    assert!(output.status.success(), "{words:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Adds the help of a command and of all commands below it to a page.
fn write_help(page: &mut String, words: &[&str]) {
    let help = help_of(words);
    let title = words.join(" ");
    writeln!(
        page,
        "\n## xcscr {title}\n\n```text\n{}\n```",
        help.trim_end()
    )
    .unwrap();
    let below = help.split("\nCommands:\n").nth(1).unwrap_or_default();
    let below = below.lines().take_while(|line| !line.is_empty());
    let names = below.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    for name in names.filter_map(|line| line.split_whitespace().next()) {
        if name != "help" {
            write_help(page, &[words, &[name]].concat());
        }
    }
}

#[test]
fn the_page_of_the_command_line_has_the_help_of_every_command() {
    let mut page = "# Command line\n\nThe help of every command, as `xcscr COMMAND --help` prints it. This page is \
        generated from the program (`UPDATE_DOCS=1 cargo test --test suite settings::` regenerates it).\n"
        .to_owned();
    write_help(&mut page, &[]);
    let commands = page.matches("\n## xcscr").count();
    assert!(commands > 25, "{commands} commands");
    require(
        &page.replace("## xcscr \n", "## xcscr\n"),
        "docs/src/reference/command-line.md",
    );
}

#[test]
fn every_setting_is_declared_and_every_number_has_a_range() {
    let resolved = Resolved::new(&Settings::default(), &[], &[]).unwrap();
    let declared = Settings::declared();
    let keys: Vec<&str> = declared.iter().map(|setting| setting.key).collect();
    assert!(resolved.entries().map(|(key, ..)| key).eq(keys));
    // What it may be at most depends on another setting.
    let depending = "physics.deceleration_mps2";
    for (setting, (key, value, _)) in declared.iter().zip(resolved.entries()) {
        let ranged = value.parse::<f64>().is_ok() && key != depending;
        assert_eq!(setting.range.is_some(), ranged, "{key}");
        assert!(!setting.about.is_empty(), "{key}");
    }
}

/// What a page does not name at the begin of a row of a table.
fn missing(page: &str, names: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/src").join(page)).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("| "));
    let first: Vec<&str> = rows.filter_map(|row| row.split('|').next()).collect();
    let is_named = |name: &str| first.iter().any(|cell| cell.contains(&format!("`{name}`")));
    names.filter(|name| !is_named(name)).collect()
}

#[test]
fn a_table_explains_every_sensor_method_and_topic() {
    let none: [&str; 0] = [];
    let sensors = Sensor::ALL.iter().map(|sensor| sensor.name());
    assert_eq!(missing("reference/robot.md", sensors.clone()), none);
    let methods = Method::ALL.iter().map(|method| method.name());
    assert_eq!(missing("how-to/choose-a-method.md", methods), none);
    let topics = Topic::ALL.iter().map(|topic| topic.name());
    assert_eq!(missing("reference/recordings.md", topics), none);
    assert!(
        !missing("reference/recordings.md", sensors).is_empty(),
        "control"
    );
}

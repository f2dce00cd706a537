//! What users of the library can name, so that nothing becomes public by accident: a name more or
//! less is a decision (`cargo insta accept`), and a line in the changelog once there are users. What
//! the command line and recordings name, the pages explain.

use std::fs;
use std::path::{Path, PathBuf};

use xcscr::agent::Method;
use xcscr::record::Topic;
use xcscr::sensor::Sensor;

/// The kinds of items that have names.
const KINDS: [&str; 7] = [
    "const fn ",
    "fn ",
    "struct ",
    "enum ",
    "trait ",
    "type ",
    "const ",
];

/// The file of a module, if there is such a module; `lib.rs` has the empty path.
fn file(root: &Path, module: &str) -> Option<PathBuf> {
    let path = root.join(module.replace("::", "/"));
    let lib = module.is_empty().then(|| root.join("lib.rs"));
    let mut files = lib
        .into_iter()
        .chain([path.with_extension("rs"), path.join("mod.rs")]);
    files.find(|file| file.exists())
}

/// The code of a module, without comments.
fn code(root: &Path, module: &str) -> String {
    let file = file(root, module).unwrap_or_else(|| panic!("{module} has no file"));
    let text = fs::read_to_string(file).unwrap();
    let lines = text.lines().map(|line| line.split("//").next().unwrap());
    lines.collect::<Vec<_>>().join("\n")
}

/// A name in a module.
fn inside(module: &str, name: &str) -> String {
    match module {
        "" => name.to_owned(),
        _ => format!("{module}::{name}"),
    }
}

/// The name that a text begins with.
fn word(text: &str) -> String {
    let is_part = |letter: &char| letter.is_alphanumeric() || *letter == '_';
    text.chars().take_while(is_part).collect()
}

/// The paths of an import such as `a::{b, c::d as e}`, each with its name: `a::b` and `b`, `a::c::d`
/// and `e`.
fn imported(tree: &str) -> Vec<(String, String)> {
    let (front, names) = tree.split_once('{').unwrap_or(("", tree));
    assert!(!names.contains('{'), "nested: {tree}");
    let named = |name: &str| {
        let (path, name) = name.split_once(" as ").unwrap_or((name, name));
        let last = name.rsplit("::").next().unwrap();
        (format!("{front}{path}"), last.to_owned())
    };
    let names = names.trim_end_matches('}').split(',').map(str::trim);
    names.filter(|name| !name.is_empty()).map(named).collect()
}

/// Does this path lead to a module, and not to something of the same name in it?
fn is_public_module(root: &Path, path: &str) -> bool {
    let (parent, name) = path.rsplit_once("::").unwrap_or(("", path));
    file(root, parent).is_some() && code(root, parent).contains(&format!("pub mod {name};"))
}

/// The names that a public module exports, with those of the modules in it. `shown` is its path for
/// users.
fn names(root: &Path, module: &str, shown: &str) -> Vec<String> {
    let mut found = Vec::new();
    for item in code(root, module).split("\npub ").skip(1) {
        if let Some(name) = item.strip_prefix("mod ") {
            let name = word(name);
            found.extend(names(root, &inside(module, &name), &inside(shown, &name)));
        } else if let Some(tree) = item.strip_prefix("use ") {
            for (path, name) in imported(tree.split(';').next().unwrap()) {
                let (path, name) = (inside(module, &path), inside(shown, &name));
                match is_public_module(root, &path) {
                    true => found.extend(names(root, &path, &name)),
                    false => found.push(name),
                }
            }
        } else if let Some(item) = KINDS.iter().find_map(|kind| item.strip_prefix(kind)) {
            found.push(inside(shown, &word(item)));
        }
    }
    found
}

/// The names of a crate, in the order of the alphabet.
fn exported(source: &str) -> String {
    let mut names = names(&Path::new(env!("CARGO_MANIFEST_DIR")).join(source), "", "");
    names.sort();
    format!("{} names\n{}", names.len(), names.join("\n"))
}

#[test]
fn the_crates_export_no_other_names() {
    for (name, source) in [
        ("xcscr", "src"),
        ("xcscr_robot", "crates/robot/src"),
        ("xcscr_learner", "crates/learner/src"),
        ("xcscr_recording", "crates/recording/src"),
        ("xcs", "crates/xcs/src"),
    ] {
        let name = format!("{name}_exports_no_other_names");
        insta::assert_snapshot!(name, exported(source));
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

#[test]
fn control_names_are_found_however_they_are_exported() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("room")).unwrap();
    file("lib.rs", "mod hidden;\npub mod room;\npub use hidden::A;\n");
    file("hidden.rs", "\npub struct A;\npub struct B;\n");
    fs::create_dir(folder.path().join("room/inner")).unwrap();
    file("room/inner/mod.rs", "pub mod shelf;\nmod c;\npub use c::c;");
    file("room/inner/shelf.rs", "\npub trait I {}\n");
    file(
        "room/mod.rs",
        "\npub use inner::{c, C,\n    d as e};\npub use inner::shelf;\npub(crate) use x::F;\n// pub fn no()\npub const fn g() {}\nimpl C {\n    pub fn h() {}\n}\n",
    );
    assert_eq!(
        names(folder.path(), "", ""),
        [
            "room::c",
            "room::C",
            "room::e",
            "room::shelf::I",
            "room::g",
            "A"
        ]
    );
}

//! The order of the modules is the order of imports: an arrow in any other direction fails.

use std::fs;
use std::path::{Path, PathBuf};

/// Who may import what, in the order in which `lib.rs` lists the modules.
const ALLOWED: [(&str, &[&str]); 14] = [
    ("streams", &[]),
    ("disk", &[]),
    ("page", &[]),
    ("world", &["streams", "disk"]),
    ("arena", &["streams", "world"]),
    ("sensor", &["world", "arena"]),
    ("agent", &["streams", "arena"]),
    ("episode", &["world", "arena", "sensor", "agent"]),
    (
        "trial",
        &[
            "streams", "disk", "world", "arena", "sensor", "agent", "episode",
        ],
    ),
    ("export", &["streams", "world", "sensor", "agent", "trial"]),
    (
        "record",
        &[
            "disk", "world", "arena", "sensor", "agent", "episode", "trial",
        ],
    ),
    (
        "run",
        &[
            "disk", "world", "arena", "sensor", "agent", "episode", "trial", "record",
        ],
    ),
    (
        "picture",
        &[
            "disk", "world", "arena", "sensor", "agent", "episode", "trial",
        ],
    ),
    (
        "study",
        &[
            "streams", "disk", "world", "arena", "sensor", "agent", "episode", "trial", "picture",
            "page",
        ],
    ),
];

/// The files of the binary, which sees the library only from outside.
const BINARY: [&str; 3] = ["main", "cli", "commands"];

/// The only folder that names the physics engine.
const PHYSICS: &str = "arena/physics";

/// The robot's own computer, of which the controller lies in the library: it knows what its sensors
/// tell, and nothing of the maze, the engine or its true pose.
const ONBOARD: &str = "crates/sensing/src/onboard";
const CONTROLLER: &str = "arena/physics/controller.rs";
const UNKNOWN_ON_BOARD: [&str; 12] = [
    "Maze",
    "Cell",
    "View",
    "Sample",
    "Moment",
    "Terrain",
    "Push",
    "sensors",
    "true_motion",
    "simulation",
    "rapier2d",
    "parry2d",
];

/// All Rust files below a folder of this package, in the order of their paths.
fn files_below(folder: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// All Rust files below `src`, with their paths from there.
fn sources() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let read = |file: PathBuf| {
        let text = fs::read_to_string(&file).unwrap();
        (file.strip_prefix(&root).unwrap().to_owned(), text)
    };
    files_below("src").into_iter().map(read).collect()
}

/// The module that a file belongs to: the first part of its path.
fn module(file: &Path) -> String {
    let first = file.iter().next().unwrap();
    let name = first.to_string_lossy().into_owned();
    name.trim_end_matches(".rs").to_owned()
}

/// The text without comments, so that links in documentation are no arrows.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap());
    lines.collect::<Vec<_>>().join("\n")
}

/// The modules named after `prefix`, such as `crate::`, alone or in braces.
fn named_after(code: &str, prefix: &str) -> Vec<String> {
    let starts = code.match_indices(prefix).map(|(at, _)| at + prefix.len());
    starts.flat_map(|at| first_names(&code[at..])).collect()
}

/// The name that the text begins with, or the first name of each path in the braces.
fn first_names(text: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        let letters = text.trim_start().chars();
        letters
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let Some(group) = text.strip_prefix('{') else {
        return vec![name(text)];
    };
    let (mut names, mut depth) = (vec![name(group)], 0);
    for (at, letter) in group.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(name(&group[at + 1..])),
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// What the robot's own computer names but cannot know.
fn privileged(code: &str) -> Vec<String> {
    let names = words(code).filter(|word| UNKNOWN_ON_BOARD.contains(word));
    names.map(str::to_owned).collect()
}

/// All names in a text.
fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// What a file imports but must not.
fn forbidden(file: &Path, text: &str) -> Vec<String> {
    let (module, code) = (module(file), code(text));
    let allowed: Vec<&str> = match ALLOWED.iter().find(|(name, _)| *name == module) {
        Some((name, others)) => [&[*name], *others].concat(),
        None if BINARY.contains(&module.as_str()) => BINARY.to_vec(),
        None => vec![],
    };
    let mut found = named_after(&code, "crate::");
    found.retain(|name| !allowed.contains(&name.as_str()));
    if !file.starts_with(PHYSICS) {
        let engines = ["rapier2d", "parry2d"].into_iter();
        found.extend(engines.filter(|e| code.contains(e)).map(str::to_owned));
    }
    if file == Path::new(CONTROLLER) {
        found.extend(privileged(&code));
    }
    let message = |name| format!("{} must not name `{name}`", file.display());
    found.into_iter().map(message).collect()
}

#[test]
fn every_import_follows_the_order_of_the_modules() {
    let found: Vec<String> = sources()
        .iter()
        .flat_map(|(file, text)| forbidden(file, text))
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn the_robots_own_computer_names_nothing_that_it_cannot_know() {
    let files = files_below(ONBOARD);
    for path in &files {
        let found = privileged(&code(&fs::read_to_string(path).unwrap()));
        assert!(found.is_empty(), "{} names {found:?}", path.display());
    }
    assert!(files.len() >= 8, "only {} files in {ONBOARD}", files.len());
}

#[test]
fn every_file_belongs_to_a_known_module() {
    for (file, _) in sources() {
        let module = module(&file);
        let known = module == "lib"
            || BINARY.contains(&module.as_str())
            || ALLOWED.iter().any(|(name, _)| *name == module);
        assert!(known, "{} is in no module of the table", file.display());
    }
}

#[test]
fn lib_rs_lists_the_modules_in_the_order_of_imports() {
    let lib = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let listed = named_after(&code(&lib), "pub mod ");
    let mut expected: Vec<&str> = ALLOWED.iter().map(|(name, _)| *name).collect();
    expected.retain(|name| listed.iter().any(|one| one == name));
    assert_eq!(listed, expected);
}

#[test]
fn the_table_itself_has_no_arrow_backward() {
    for (i, (module, imports)) in ALLOWED.iter().enumerate() {
        for import in *imports {
            let earlier = ALLOWED[..i].iter().any(|(name, _)| name == import);
            assert!(earlier, "{module} imports {import}, which comes later");
        }
    }
}

#[test]
fn every_file_that_the_readme_names_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let folders = ["tests/", "src/", "examples/", "crates/"];
    let named = readme.split('`');
    let named = named.filter(|word| folders.iter().any(|folder| word.starts_with(folder)));
    let named: Vec<&str> = named.filter(|word| !word.contains([' ', '\n'])).collect();
    assert!(named.len() > 20, "{named:?}");
    for file in named {
        assert!(root.join(file).exists(), "README.md names {file}");
    }
}

#[test]
fn control_a_forbidden_arrow_is_found() {
    let found = |file: &str, text: &str| forbidden(Path::new(file), text).len();
    assert_eq!(found("agent/plus/mod.rs", "use crate::world::Maze;"), 1);
    assert_eq!(found("world/maze.rs", "fn f() { crate::arena::g(); }"), 1);
    assert_eq!(
        found(
            "arena/grid.rs",
            "use crate::{world::{Cell, Maze}, sensor, agent};"
        ),
        2
    );
    assert_eq!(found("world/file.rs", "use crate::{\n    sensor,\n};"), 1);
    assert_eq!(found("arena/grid.rs", "use rapier2d::prelude::*;"), 1);
    assert_eq!(found("commands/train.rs", "use crate::world::Maze;"), 1);
    let onboard = |text| found(CONTROLLER, text);
    assert_eq!(onboard("use crate::world::{Cell, Maze};"), 2);
    assert_eq!(onboard("fn f(v: &crate::arena::View<'_>) {}"), 1);
    assert_eq!(onboard("use super::robot::true_motion;"), 1);
    let sensors = privileged("use crate::sensors::{Moment, Terrain};");
    assert_eq!(sensors, ["sensors", "Moment", "Terrain"]);
}

#[test]
fn control_an_allowed_arrow_and_a_comment_are_not_found() {
    let found = |file: &str, text: &str| forbidden(Path::new(file), text);
    let none: [String; 0] = [];
    assert_eq!(
        found("agent/plus/mod.rs", "use crate::arena::Outcome;"),
        none
    );
    assert_eq!(
        found("agent/plus/mod.rs", "/// See [`crate::world`].\n"),
        none
    );
    assert_eq!(
        found("arena/physics/mod.rs", "use rapier2d::prelude::*;"),
        none
    );
    assert_eq!(found(CONTROLLER, "use super::motion::Motion;"), none);
    assert_eq!(found("commands/world.rs", "use crate::cli::Cli;"), none);
}

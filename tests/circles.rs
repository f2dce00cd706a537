//! Inside a room, imports run one way: no file needs another that needs it back.
//!
//! The nodes are the files and subfolders of a folder; what is below a subfolder counts as its
//! own. A name that `mod.rs` re-exports leads to the file it comes from. A file and the `mod.rs`
//! above it may name each other, as a trait and those who implement it do.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

type Name = Vec<String>;
/// Who names whom among the members of each room.
type Rooms = BTreeMap<Name, BTreeMap<String, BTreeSet<String>>>;

fn words(path: &str) -> Name {
    let parts = path.split("::").map(str::trim);
    parts.filter(|p| !p.is_empty()).map(str::to_owned).collect()
}

/// The code without comments and without the tests at the end.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap());
    let code: Vec<&str> = lines.collect();
    let code = code.join("\n");
    code.split("#[cfg(test)]").next().unwrap().to_owned()
}

/// The paths of a tree of imports such as `a::{b, c::d}`.
fn paths(tree: &str) -> Vec<Name> {
    let Some((front, group)) = tree.split_once('{') else {
        return vec![words(tree.split(" as ").next().unwrap())];
    };
    let group = group.trim_end().trim_end_matches('}');
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for letter in group.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        match letter {
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().unwrap().push(letter),
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    let inner = parts.flat_map(|part| paths(part));
    inner.map(|path| [words(front), path].concat()).collect()
}

/// The trees of imports behind a keyword such as `use `.
fn trees<'a>(code: &'a str, keyword: &'a str) -> impl Iterator<Item = &'a str> {
    let behind = code.match_indices(keyword).map(move |(at, _)| at);
    behind.map(move |at| code[at + keyword.len()..].split(';').next().unwrap())
}

/// The files of a crate by the paths of their modules.
fn modules(root: &Path) -> BTreeMap<Name, String> {
    let (mut found, mut folders) = (BTreeMap::new(), vec![root.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(root).unwrap().with_extension("");
                let mut name: Name = name.iter().map(|p| p.to_str().unwrap().into()).collect();
                name.retain(|part| part != "mod" && part != "lib");
                found.insert(name, code(&fs::read_to_string(path).unwrap()));
            }
        }
    }
    found
}

/// Where a path leads that is written in the module `from`; `None` if out of the crate.
fn target(
    from: &Name,
    path: &Name,
    modules: &BTreeMap<Name, String>,
    exported: &BTreeMap<Name, Name>,
) -> Option<Name> {
    let supers = path.iter().take_while(|part| *part == "super").count();
    let (mut at, rest) = match path.first()?.as_str() {
        "crate" => (vec![], &path[1..]),
        "super" => (
            from[..from.len().checked_sub(supers)?].to_vec(),
            &path[supers..],
        ),
        _ => return None,
    };
    for part in rest {
        let next = [at.clone(), vec![part.clone()]].concat();
        if !modules.contains_key(&next) {
            return Some(exported.get(&next).cloned().unwrap_or(at));
        }
        at = next;
    }
    Some(at)
}

fn rooms(modules: &BTreeMap<Name, String>) -> Rooms {
    let mut exported = BTreeMap::new();
    for (module, code) in modules {
        for path in ["pub use ", "pub(super) use "]
            .iter()
            .flat_map(|keyword| trees(code, keyword))
            .flat_map(paths)
        {
            let child = [module.clone(), vec![path[0].clone()]].concat();
            if modules.contains_key(&child) {
                let name = [module.clone(), vec![path.last().unwrap().clone()]].concat();
                exported.insert(name, child);
            }
        }
    }
    let mut rooms = Rooms::new();
    for (module, code) in modules {
        let imports = trees(code, "use ").flat_map(paths);
        let inline = ["super::", "crate::"].into_iter().flat_map(|front| {
            code.match_indices(front).map(|(at, _)| {
                let end = code[at..].find(|c: char| !(c.is_alphanumeric() || "_:".contains(c)));
                words(&code[at..at + end.unwrap_or(code.len() - at)])
            })
        });
        for to in imports
            .chain(inline)
            .filter_map(|path| target(module, &path, modules, &exported))
        {
            let shared = module.iter().zip(&to).take_while(|(a, b)| a == b).count();
            if shared < module.len().min(to.len()) {
                let room = rooms.entry(module[..shared].to_vec()).or_default();
                let named = room.entry(module[shared].clone()).or_default();
                named.insert(to[shared].clone());
            }
        }
    }
    rooms
}

/// All that a member needs, directly or not.
fn needs(room: &BTreeMap<String, BTreeSet<String>>, member: &str) -> BTreeSet<String> {
    let (mut found, mut open) = (BTreeSet::new(), vec![member]);
    while let Some(next) = open.pop() {
        for other in room.get(next).into_iter().flatten() {
            if found.insert(other.clone()) {
                open.push(other);
            }
        }
    }
    found
}

/// The members of circles, room by room.
fn circles(modules: &BTreeMap<Name, String>) -> Vec<(String, Vec<String>)> {
    let rooms = rooms(modules).into_iter().map(|(name, room)| {
        let members = room
            .keys()
            .filter(|member| needs(&room, member).contains(*member));
        (name.join("/"), members.cloned().collect::<Vec<_>>())
    });
    rooms.filter(|(_, members)| !members.is_empty()).collect()
}

fn given(files: &[(&str, &str)]) -> Vec<(String, Vec<String>)> {
    let module = |(name, text): &(&str, &str)| (words(name), code(text));
    circles(&files.iter().map(module).collect())
}

#[test]
fn no_room_has_a_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for source in ["src", "crates/xcs/src", "crates/sensing/src"] {
        assert_eq!(circles(&modules(&root.join(source))), [], "{source}");
    }
}

#[test]
fn control_circles_are_found_however_they_are_written() {
    let circle = [("room".to_owned(), vec!["a".to_owned(), "b".to_owned()])];
    let head = ("room", "mod a; mod b; pub use b::{B, C};");
    for there in [
        "use super::{x, b::B};",
        "fn f() { super::b::g() }",
        "use super::B;",
    ] {
        for back in [
            "use crate::room::a::A;",
            "use super::a;",
            "fn g(_: super::a::A) {}",
        ] {
            let found = given(&[head, ("room::a", there), ("room::b", back)]);
            assert_eq!(found, circle, "{there} {back}");
        }
    }
    let through = [
        ("room", ""),
        ("room::a", "use super::b::inner::X;"),
        ("room::b", ""),
        ("room::b::inner", "use super::super::a::Y;"),
    ];
    assert_eq!(given(&through), circle);
}

#[test]
fn control_one_way_comments_tests_and_the_room_itself_are_no_circle() {
    let there = ("room::a", "use super::b::B;\nuse super::Trait;");
    for back in [
        "// use super::a::A;",
        "#[cfg(test)]\nmod tests { use super::super::a::A; }",
        "use super::Trait;",
        "use std::a::b;",
    ] {
        let head = ("room", "pub use a::A; pub trait Trait {}");
        assert_eq!(given(&[head, there, ("room::b", back)]), [], "{back}");
    }
}

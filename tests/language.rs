//! How the pages are written: short sentences, and the terms of the field.

use std::fs;
use std::path::{Path, PathBuf};

/// The most words of a sentence.
const MOST_WORDS: usize = 30;
/// Words of our own for which the field has a term, and the term.
const OWN_WORDS: [(&str, &str); 15] = [
    ("astray", "mislocalised"),
    ("atlas", "maps"),
    ("ballot", "quantised policy"),
    ("charted", "mapped"),
    ("eaten", "collected"),
    ("foreseen", "predicted"),
    ("foretell", "predict"),
    ("foretold", "predicted"),
    ("ghost", "estimated-pose marker"),
    ("habits", "noise model"),
    ("lessons", "examples"),
    ("look alike", "share a percept"),
    ("misread", "observed wrongly"),
    ("salvage", "recover"),
    ("the teller", "highlights builder"),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All pages below a folder.
fn pages_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let pages = entries.flat_map(|path| match path.is_dir() {
        true => pages_below(&path),
        false => vec![path],
    });
    pages
        .filter(|path| path.extension().is_some_and(|end| end == "md"))
        .collect()
}

fn pages() -> Vec<PathBuf> {
    let single = [
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "SECURITY.md",
        "benches/README.md",
        "python/README.md",
    ];
    let crates = ["xcs", "sensing", "robot", "learner", "recording"]
        .map(|name| format!("crates/{name}/README.md"));
    let single = single.iter().map(|name| root().join(name));
    let crates = crates.iter().map(|name| root().join(name));
    single
        .chain(crates)
        .chain(pages_below(&root().join("docs/src")))
        .collect()
}

/// The paragraphs and list items of a page, without code, tables, headings and pictures.
fn paragraphs(page: &str) -> Vec<String> {
    let (mut found, mut open, mut is_code) = (Vec::new(), String::new(), false);
    for line in page.lines().chain([""]) {
        let text = line.trim_start();
        if text.starts_with("```") {
            is_code = !is_code;
        }
        let ends =
            text.is_empty() || text.starts_with(['|', '#', '<', '!']) || text.starts_with("```");
        let is_item = text.starts_with("- ")
            || text
                .split_once(". ")
                .is_some_and(|(n, _)| n.parse::<u32>().is_ok());
        if (ends || is_item || is_code) && !open.is_empty() {
            found.push(std::mem::take(&mut open));
        }
        if !ends && !is_code {
            open.push_str(text);
            open.push(' ');
        }
    }
    found
}

/// A text without the contents of code spans, and without the targets of links.
fn plain(text: &str) -> String {
    let spans = text.split('`').enumerate();
    let text: String = spans
        .map(|(at, span)| if at % 2 == 0 { span } else { "code" })
        .collect();
    let mut parts = text.split("](");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |sum, part| {
        sum + part.split_once(')').map_or(part, |(_, rest)| rest)
    })
}

/// The sentences of a paragraph that are too long.
fn long_sentences(paragraph: &str) -> Vec<String> {
    let text = plain(paragraph).replace(['?', '!', ';', ':'], ".");
    let sentences = text.split(". ").map(str::trim);
    let long = sentences.filter(|sentence| sentence.split_whitespace().count() > MOST_WORDS);
    long.map(str::to_owned).collect()
}

/// What is wrong on the pages, each with its page.
fn faults(of: impl Fn(&str) -> Vec<String>) -> Vec<String> {
    let mut found = Vec::new();
    for path in pages() {
        let page = fs::read_to_string(&path).unwrap();
        let name = path.strip_prefix(root()).unwrap().display();
        found.extend(of(&page).iter().map(|fault| format!("{name}: {fault}")));
    }
    found
}

#[test]
fn no_sentence_of_a_page_has_more_than_thirty_words() {
    let long = faults(|page| {
        let paragraphs = paragraphs(page);
        paragraphs
            .iter()
            .flat_map(|text| long_sentences(text))
            .collect()
    });
    assert!(long.is_empty(), "{long:#?}");
}

#[test]
fn pages_use_the_terms_of_the_field() {
    let own = faults(|page| {
        let text: String = paragraphs(&page.to_lowercase())
            .iter()
            .map(|text| plain(text))
            .collect();
        let used = OWN_WORDS.iter().filter(|(own, _)| text.contains(own));
        used.map(|(own, term)| format!("write `{term}` for `{own}`"))
            .collect()
    });
    assert!(own.is_empty(), "{own:#?}");
}

#[test]
fn control_long_sentences_are_found_and_tables_and_code_are_not_read() {
    let long = "word ".repeat(31);
    let page = format!(
        "# Title\n\n{long}.\n\n| {long} |\n\n```sh\n{long}\n```\n\n- short. {}\n",
        "a ".repeat(30)
    );
    let found: Vec<String> = paragraphs(&page)
        .iter()
        .flat_map(|text| long_sentences(text))
        .collect();
    assert_eq!(found.len(), 1, "{found:?}");
}

//! The reports of studies: what they compare, correct, draw and leave out.

use crate::study::desk::{Desk, SMALL};
use serde_json::Value;

#[test]
fn what_was_turned_off_is_compared_with_nothing() {
    let desk = Desk::new();
    let keys = r#"
        name = "parts"
        worlds = ["maze5", "rooms-8-1"]
        methods = ["xcscr-plus"]
        trials = 3
        episodes = 10
        without = ["plus.return_rules", "xcs.theta_ga=5"]
        [world-settings]
        rooms-8-1 = { "reward.step_threshold" = 60 }
        [world-sensors]
        rooms-8-1 = ["neighbours-position"]
    "#;
    desk.write("parts.toml", keys);
    desk.done("run parts.toml --out parts");
    let report = desk.read("parts/report.md");
    for part in ["plus.return_rules", "xcs.theta_ga"] {
        let words = format!("xcscr-plus without {part} − without nothing");
        assert!(report.contains(&words), "{words}: {report}");
    }
    let table = desk.read("parts/trials.csv");
    for (words, rows) in [
        ("without=nothing", 6),
        ("without=plus.return_rules", 6),
        ("neighbours-position", 9),
    ] {
        assert_eq!(table.matches(words).count(), rows, "{words}: {table}");
    }
}

#[test]
fn a_report_says_what_came_out_and_draws_it() {
    let desk = Desk::finished();
    let printed = desk.done("report whole");
    for words in ["maze5", "xcscr − xcs", "Pairwise comparisons"] {
        assert!(printed.contains(words), "{words} is missing in\n{printed}");
    }
    let files =
        "report.md trials.csv summary.json curves.svg curves-by-steps.svg first-optimal.svg";
    for file in files.split(' ') {
        assert!(desk.path("whole").join(file).is_file(), "{file}");
    }
    let report = desk.json("report whole --json");
    assert_eq!(report["arms"].as_array().unwrap().len(), 4);
    let summary: Value = serde_json::from_str(&desk.read("whole/summary.json")).unwrap();
    let keys = "trials successes wilson_low median_episode p95_episode retained";
    for key in keys.split(' ') {
        assert!(summary["arms"][0].get(key).is_some(), "{key}");
    }
}

#[test]
fn the_figures_show_every_method_however_many_there_are() {
    let desk = Desk::new();
    let all = "xcs xcsam adapted-even adapted-discounted xcscr xcscr-coevolved xcscr-plus q-learning \
               sarsa-lambda dyna-q r-max";
    let all: Vec<&str> = all.split(' ').collect();
    for count in [2, 7, 11] {
        let methods = &all[..count];
        let name = format!("m{count}");
        let file = format!(
            "name = \"{name}\"\nworlds = [\"maze4\", \"maze5\"]\nmethods = {methods:?}\ntrials = 1\nepisodes = 2\n"
        );
        desk.write(&format!("{name}.toml"), &file);
        desk.done(&format!("run {name}.toml --out {name}"));
        for figure in ["curves", "curves-by-steps", "first-optimal"] {
            let svg = desk.read(&format!("{name}/{figure}.svg"));
            for method in methods {
                let named = svg.matches(&format!(">{method}</text>")).count();
                assert_eq!(named, 1, "{method} in {figure} of {count}");
            }
            assert!(svg.contains("width=\"333\""), "the width of a column");
            // Control: other methods are not named.
            let others = all[count..].iter();
            let named = others.filter(|method| svg.contains(&format!(">{method}</text>")));
            assert_eq!(named.count(), 0, "{figure} of {count}");
        }
    }
}

/// Holm's step-down correction, written from its definition.
fn step_down(ps: &[f64]) -> Vec<f64> {
    let corrected = |p: f64| {
        let as_small = ps.iter().filter(|&&other| other <= p);
        let factor = |one: f64| ps.iter().filter(|&&other| other >= one).count() as f64;
        as_small
            .map(|&one| (one * factor(one)).min(1.0))
            .fold(0.0, f64::max)
    };
    ps.iter().map(|&p| corrected(p)).collect()
}

#[test]
fn tests_are_corrected_for_all_worlds_and_methods_that_are_compared() {
    let desk = Desk::new();
    desk.write(
        "three.toml",
        "name = \"three\"\nworlds = [\"maze4\", \"maze5\"]\nmethods = [\"q-learning\", \"xcs\", \"xcscr\"]\n\
         trials = 12\nepisodes = 40\n",
    );
    desk.done("run three.toml --out a");
    let report = desk.json("report a --json");
    let comparisons = report["comparisons"].as_array().unwrap();
    let column = |name: &str| -> Vec<f64> {
        let cells = comparisons.iter().map(|one| one[name].as_f64().unwrap());
        cells.collect()
    };
    let (ps, found) = (column("mcnemar_p"), column("holm_p"));
    assert_eq!(ps.len(), 4, "two worlds, two other methods");
    for (found, expected) in found.iter().zip(step_down(&ps)) {
        let off = (found - expected).abs();
        assert!(off < 1e-5, "{ps:?}: {found} {expected}");
    }
    // Control: a correction over the two worlds of a pair alone would at most double a p.
    let more_than_doubled = |(found, p): (&f64, &f64)| *found > 2.0 * p + 1e-9;
    let is_so = found.iter().zip(&ps).any(more_than_doubled);
    assert!(is_so, "{ps:?} {found:?}");
}

#[test]
fn an_ablation_leaves_out_each_part_in_every_world() {
    let desk = Desk::new();
    desk.done("run ablation --out a --trials 1 --episodes 3");
    // A head, and 3 worlds with 8 parts left out in turn, and none.
    assert_eq!(desk.read("a/trials.csv").lines().count(), 1 + 3 * 9);
}

/// Every address or file that a page would fetch names it in one of these ways.
const FETCHES: [&str; 9] = [
    "http:", "https:", "//", " src", " href", "url(", "@import", "<link", "fetch(",
];

#[test]
fn the_html_report_is_one_page_that_needs_nothing_else_and_has_the_parts_of_a_results_section() {
    let desk = Desk::finished();
    let page = desk.read("whole/report.html");
    // Comments of the script are no addresses.
    let is_code = |line: &&str| !line.trim_start().starts_with("// ");
    let code: Vec<&str> = page.lines().filter(is_code).collect();
    let code = code.join("\n");
    for fetch in FETCHES {
        let at = code.find(fetch);
        let around = at.map(|at| &code[at.saturating_sub(80)..(at + 80).min(code.len())]);
        assert_eq!(around, None, "{fetch}");
    }
    for words in ["default-src 'none'", "prefers-color-scheme: dark"] {
        assert!(page.contains(words), "{words}");
    }
    assert_eq!(page.matches("<svg ").count(), 3, "all figures are inside");
    let markdown = desk.read("whole/report.md");
    let headings = markdown.lines().filter_map(|line| line.strip_prefix("## "));
    let sections = "Setup Table Figures Tests Limitations".split(' ');
    assert!(headings.eq(sections.clone()), "{markdown}");
    for section in sections {
        assert!(page.contains(&format!("<h2>{section}</h2>")), "{section}");
    }
}

#[test]
fn names_and_errors_from_files_stay_text_in_reports_and_tables() {
    let desk = Desk::new();
    desk.write("evil.toml", &SMALL.replace("small", "<img src=x>"));
    desk.done("run evil.toml --out a --quiet --trials 1");
    let report = desk.read("a/report.md");
    assert!(report.starts_with("# Study \\<img src=x>"), "{report}");
    let page = desk.read("a/report.html");
    let is_text = !page.contains("<img") && page.contains("&lt;img src=x");
    assert!(is_text, "{page}");
}

/// The generated rooms have cells with the same neighbours that need opposite moves.
#[test]
fn a_world_that_needs_memory_is_marked_and_is_in_no_test() {
    let desk = Desk::new();
    let text = SMALL.replace("\"maze5\"", "\"rooms-12-3\"");
    desk.write("rooms.toml", &text.replace("trials = 4", "trials = 2"));
    let report = desk.done("run rooms.toml --out a --quiet");
    let json = desk.json("report a --json");
    let marked = |world: &str| {
        let arms = json["arms"].as_array().unwrap().iter();
        let mut own = arms.filter(|arm| arm["world"] == world);
        own.all(|arm| arm["needs_memory"] == true)
    };
    assert!(marked("rooms-12-3") && !marked("maze4"));
    let comparisons = json["comparisons"].as_array().unwrap();
    let worlds: Vec<_> = comparisons.iter().map(|one| &one["world"]).collect();
    assert_eq!(worlds, ["maze4"]);
    assert!(report.contains("no policy without memory is optimal"));
    let position =
        text.replace("trials = 4", "trials = 1") + "sensors = [\"neighbours-position\"]\n";
    desk.write("position.toml", &position);
    let report = desk.done("run position.toml --out b --quiet");
    assert!(!report.contains("memory"), "control: {report}");
}

#[test]
fn an_arm_with_earlier_steps_in_the_percept_needs_no_memory_in_whichever_order() {
    let desk = Desk::new();
    let text = SMALL.replace("\"maze4\", \"maze5\"", "\"rooms-12-3\"");
    let text = text.replace("trials = 4", "trials = 1");
    for order in ["[0, 1]", "[1, 0]"] {
        let sweep = format!("{text}[sweep]\nsensor.history = {order}\n");
        desk.write("sweep.toml", &sweep);
        desk.done(&format!("run sweep.toml --out {} --quiet", &order[1..2]));
        let json = desk.json(&format!("report {} --json", &order[1..2]));
        for arm in json["arms"].as_array().unwrap() {
            let has_none = arm["variant"].as_str().unwrap().ends_with('0');
            assert_eq!(arm["needs_memory"] == true, has_none, "{order}: {arm}");
        }
    }
}

//! Studies as their users run them: whole, in shards, interrupted, mixed up.
//!
//! The promise is that the folder of a finished study holds the same tables and report, byte for byte,
//! and the same trials, however it came about.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::Duration;

use crate::desk::{Desk, SMALL};
use crate::kit::folder;
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;

/// The size of all journals of a study.
fn journaled(desk: &Desk, name: &str) -> usize {
    let journals = desk.path(name).join("journals");
    if !journals.exists() {
        return 0;
    }
    let contents = folder::contents(&journals);
    contents.iter().map(|(_, bytes)| bytes.len()).sum()
}

#[test]
fn the_same_bytes_for_any_number_of_jobs_and_any_shards() {
    let desk = Desk::new();
    desk.done("run small.toml --out one --jobs 1");
    for jobs in [2, 8] {
        desk.done(&format!("run small.toml --out jobs{jobs} --jobs {jobs}"));
        desk.assert_same("one", &format!("jobs{jobs}"));
    }
    for index in 1..=7 {
        desk.done(&format!(
            "run small.toml --out s{index} --shard {index}/7 --json"
        ));
    }
    for index in 1..=2 {
        desk.done(&format!("run small.toml --out h{index} --shard {index}/2"));
    }
    desk.done("merge s1 s2 s3 s4 s5 s6 s7 --out forward");
    desk.done("merge s5 s3 s7 s1 s6 s2 s4 --out shuffled");
    desk.done("merge h2 h1 --out halves");
    desk.done("merge one --out alone");
    // The same shard twice, and shards that share trials, agree with each other.
    desk.done("merge h1 s1 h2 h1 s4 one --out mixed");
    for merged in ["forward", "shuffled", "halves", "alone", "mixed"] {
        desk.assert_same("one", merged);
    }
}

#[test]
fn of_eight_processes_in_one_folder_one_wins_and_the_others_name_a_process() {
    let desk = Desk::new();
    let words = "run small.toml --trials 40 --out a --quiet";
    let begin = |_| {
        let mut command = desk.command(words);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    };
    let children: Vec<_> = (0..8).map(begin).collect();
    let mut won = 0;
    for child in children {
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(0) => won += 1,
            code => {
                let stderr = String::from_utf8(output.stderr).unwrap();
                assert_eq!(code, Some(73), "{stderr}");
                assert!(stderr.contains("is in use by process"), "{stderr}");
            }
        }
    }
    // Who comes when the winner is done finds the study finished, which is no fault either.
    assert!(won >= 1, "nobody won");
    desk.done("run small.toml --trials 40 --out b --quiet");
    desk.assert_same("a", "b");
}

#[cfg(unix)]
#[test]
fn links_in_a_study_folder_lead_nobody_out_of_it() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 1 --out a");
    desk.write("precious", "precious");
    let written = ["trials.csv", "report.md", "curves.svg"];
    for name in written {
        let _ = fs::remove_file(desk.path("a").join(name));
        std::os::unix::fs::symlink(desk.path("precious"), desk.path("a").join(name)).unwrap();
    }
    let message = desk.refused("run small.toml --trials 1 --out a", 73);
    assert!(message.contains("trials.csv exists"), "{message}");
    desk.done("run small.toml --trials 1 --out a --force");
    assert_eq!(fs::read(desk.path("precious")).unwrap(), b"precious");
}

#[test]
fn killed_at_random_moments_and_run_again_it_ends_with_the_same_bytes() {
    let desk = Desk::new();
    desk.done("run small.toml --out whole");
    let mut moments = Stream::new(1, StreamName::World);
    for round in 0..4 {
        let words = format!("run small.toml --out round{round} --jobs 2 --quiet");
        for _ in 0..3 {
            let mut child = desk.command(&words).stdout(Stdio::null()).spawn().unwrap();
            std::thread::sleep(Duration::from_millis(5 + moments.below(300) as u64));
            child.kill().unwrap();
            child.wait().unwrap();
        }
        desk.done(&words);
        desk.assert_same("whole", &format!("round{round}"));
    }
}

#[test]
#[cfg(unix)]
fn a_signal_ends_it_in_order_and_the_same_command_goes_on() {
    let desk = Desk::new();
    let words = "run small.toml --out a --trials 200 --jobs 1";
    let mut child = desk.command(words).stderr(Stdio::null()).spawn().unwrap();
    // The first lines of the journal show that trials are running.
    while journaled(&desk, "a") < 500 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let pid = child.id().to_string();
    std::process::Command::new("kill")
        .args(["-TERM", &pid])
        .status()
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(75));
    let status: serde_json::Value = serde_json::from_str(&desk.done("status a --json")).unwrap();
    assert!(status["finished"].as_u64() > Some(0), "{status}");
    assert!(!desk.path("a/trials.csv").exists());
}

/// The interval of the share of successes in each row of the table of a study that is not complete.
fn intervals(desk: &Desk, folder: &str) -> Vec<String> {
    let report = desk.ends(&format!("report {folder} --format md"), 1).0;
    let lines = report.lines().map(|line| line.split('|').map(str::trim));
    let mut rows = lines.skip_while(|line| line.clone().nth(1) != Some("world"));
    let column = rows
        .next()
        .and_then(|mut heads| heads.position(|head| head == "95 % interval"));
    let column = column.expect("a report has a table of results");
    let cells = rows.skip(1).map_while(|mut cells| cells.nth(column));
    cells.map(str::to_owned).collect()
}

#[test]
fn a_partial_report_gives_an_interval_only_of_arms_with_a_finished_trial() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --shard 1/16");
    let of_one_trial = intervals(&desk, "a");
    assert!(of_one_trial[0].ends_with(" %"), "{of_one_trial:?}");
    assert_eq!(of_one_trial[1..], ["–"; 3], "{of_one_trial:?}");
}

#[test]
fn an_incomplete_study_is_no_result_and_status_says_what_is_missing() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --shard 1/4");
    desk.done("run small.toml --out b --shard 3/4");
    let message = desk.refused("merge a b --out ab", 1);
    assert!(message.contains("8 of 16 trials are missing"), "{message}");
    assert!(!desk.path("ab").exists());
    // What is finished is shown, but not tested, and no file says that it is the result.
    let (shown, said) = desk.ends("report a", 1);
    assert!(shown.contains("12 of 16 trials are missing"), "{shown}");
    assert!(
        shown.contains("maze4") && !shown.contains("Tests") && !shown.contains("Fewest"),
        "{shown}"
    );
    assert!(said.contains("12 of 16 trials are missing"), "{said}");
    assert!(!desk.path("a/report.md").exists() && !desk.path("a/trials.csv").exists());
    let shown = desk.ends("report a --json", 1).0;
    let json: serde_json::Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(json["missing"], 12);
    assert_eq!(json["comparisons"], serde_json::json!([]));
    let status = desk.done("status a b --shards 4");
    assert!(status.contains("8 of 16 trials finished"), "{status}");
    assert!(
        status.contains("missing (8):\n    maze4 xcs grid neighbours: 2 4\n    maze4 xcscr"),
        "{status}"
    );
    assert!(status.contains("shards to run (2): 2/4 4/4"), "{status}");
    let json: serde_json::Value = serde_json::from_str(&desk.done("status a --json")).unwrap();
    assert_eq!(json["finished"], 4);
}

#[test]
fn status_does_not_list_a_hundred_arms_that_have_not_begun() {
    let desk = Desk::new();
    desk.write(
        "wide.toml",
        &(SMALL.to_owned() + "[sweep]\n\"xcs.mu\" = [0.1, 0.2, 0.3, 0.4]\n"),
    );
    desk.done("run wide.toml --out a --trials 2 --episodes 2 --shard 1/32");
    let status = desk.done("status a");
    assert_eq!(status.lines().count(), 4, "{status}");
    assert!(
        status.contains("all 2 trials of each of 15 arms"),
        "{status}"
    );
}

#[test]
fn the_fewest_steps_are_told_with_the_arena_only_where_there_are_several() {
    let desk = Desk::new();
    let text = SMALL.replace(", \"maze5\"", "").replace("xcscr", "r-max");
    desk.write("one.toml", &text);
    desk.write("two.toml", &(text + "arenas = [\"grid\", \"physics\"]\n"));
    let more = "--trials 1 --episodes 40";
    let told = |name: &str| {
        let said = desk.done(&format!("run {name}.toml --out {name} {more}"));
        let said = said.replace('\n', " ");
        let from = said.find("fewest steps to the first optimum").unwrap();
        said[from..].chars().take(90).collect::<String>()
    };
    let (one, two) = (told("one"), told("two"));
    assert!(!one.contains("maze4 grid"), "{one}");
    assert!(
        two.contains("maze4 grid") && two.contains("maze4 physics"),
        "{two}"
    );
}

#[test]
fn different_studies_do_not_mix() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --trials 1");
    desk.done("run small.toml --out b --trials 1 --set xcs.beta=0.1");
    let message = desk.refused("merge a b --out ab", 65);
    assert!(message.contains("different studies"), "{message}");
    let message = desk.refused("run small.toml --out a --trials 2", 73);
    assert!(message.contains("another study"), "{message}");
}

#[test]
fn a_trial_that_fails_is_a_row_with_its_error() {
    let desk = Desk::new();
    // Physics refuses a world whose edges join.
    let text = SMALL.replace("\"maze5\"", "\"woods1\"") + "arenas = [\"physics\"]\n";
    desk.write("mixed.toml", &text);
    let message = desk.refused("run mixed.toml --out a --trials 1 --episodes 2", 1);
    assert!(message.contains("2 trials failed"), "{message}");
    let table = fs::read_to_string(desk.path("a/trials.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 5, "{table}");
    assert!(
        rows[1].starts_with("maze4,xcs,physics,") && rows[1].ends_with(','),
        "{table}"
    );
    assert!(
        rows[3].starts_with("woods1,xcs,physics,") && rows[3].contains("joins its edges"),
        "{table}"
    );
    desk.refused("run mixed.toml --out a --trials 1 --episodes 2", 1);
}

#[test]
fn a_folder_in_use_is_refused_with_the_holder_and_a_dead_holder_does_not_matter() {
    let desk = Desk::new();
    let words = "run paper --out a --jobs 1 --quiet";
    let mut child = desk.command(words).stdout(Stdio::null()).spawn().unwrap();
    while journaled(&desk, "a") == 0 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let message = desk.refused(words, 73);
    assert!(
        message.contains(&format!("process {}", child.id())),
        "{message}"
    );
    child.kill().unwrap();
    child.wait().unwrap();
    desk.refused("run small.toml --out a", 73);
    desk.done("run paper --out a --shard 1200/1200 --quiet");
}

#[test]
fn faults_in_a_study_file_are_told_with_the_way_out() {
    let desk = Desk::new();
    desk.write("typo.toml", &SMALL.replace("episodes", "episods"));
    assert!(
        desk.refused("run typo.toml --out x", 65)
            .contains("did you mean `episodes`?")
    );
    let message = desk.refused("run small.toml --out x --set xcs.betta=1", 65);
    assert!(message.contains("did you mean `xcs.beta`?"), "{message}");
    desk.write("method.toml", &SMALL.replace("\"xcs\"", "\"xxx\""));
    assert!(
        desk.refused("run method.toml --out x", 65)
            .contains("line 4"),
        "a place"
    );
    assert!(
        desk.refused("run none.toml --out x", 66)
            .contains("paper, paper-search, ablation, plus")
    );
    desk.refused("run small.toml --out x --shard 8/7", 2);
    desk.refused("run small.toml --out x --jobs 100000", 2);
    desk.refused("status x", 66);
    assert!(!desk.path("x").exists(), "nothing was begun");
}

#[test]
fn damage_is_noticed() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --trials 1");
    let plan = fs::read_to_string(desk.path("a/plan.json")).unwrap();
    fs::write(
        desk.path("a/plan.json"),
        plan.replace("\"beta\": 0.2", "\"beta\": 0.3"),
    )
    .unwrap();
    let message = desk.refused("report a", 65);
    assert!(
        message.contains("plan.json is damaged: it was changed after it was frozen"),
        "{message}"
    );
    fs::write(desk.path("a/plan.json"), &plan[..plan.len() / 2]).unwrap();
    assert!(
        desk.refused("report a", 65)
            .contains("plan.json is damaged")
    );
}

/// The journal of a study of 12 episodes, and its lines, in the order of the trials.
fn journal(desk: &Desk) -> (PathBuf, Vec<String>) {
    desk.done("run small.toml --out a --trials 2 --jobs 1");
    let path = folder::journal(&desk.path("a"));
    let text = fs::read_to_string(&path).unwrap();
    (path, text.lines().map(str::to_owned).collect())
}

/// The same with other figures in the line of a trial, and the right checksum.
fn forge(line: &str, figure: &str, value: serde_json::Value) -> String {
    let mut record: serde_json::Value = serde_json::from_str(&line[9..]).unwrap();
    let figures = &mut record["result"]["Ok"];
    match figures["progress"].get_mut(figure) {
        Some(progress) => *progress = value,
        None => figures[figure] = value,
    }
    let json = record.to_string();
    format!("{:08x} {json}", crc32fast::hash(json.as_bytes()))
}

#[test]
fn one_flipped_bit_in_a_journal_is_damage_and_takes_no_finished_trial_away() {
    let desk = Desk::new();
    let (path, mut lines) = journal(&desk);
    let flipped = lines[2].replacen("\"steps\"", "\"stepr\"", 1);
    assert_ne!(lines[2], flipped);
    lines[2] = flipped;
    let text = lines.join("\n") + "\n";
    fs::write(&path, &text).unwrap();
    for words in [
        "status a",
        "report a",
        "run small.toml --out a --trials 2",
        "merge a --out b",
    ] {
        let message = desk.refused(words, 65);
        assert!(message.contains("line 3 is damaged"), "{words}: {message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    // Control: the way out that the message names.
    lines.remove(2);
    fs::write(&path, lines.join("\n") + "\n").unwrap();
    desk.done("run small.toml --out a --trials 2");
}

#[test]
fn a_journal_that_contradicts_itself_is_refused() {
    let desk = Desk::new();
    let (path, mut lines) = journal(&desk);
    lines.push(lines[3].clone());
    fs::write(&path, lines.join("\n") + "\n").unwrap();
    desk.done("status a");
    lines.push(forge(&lines[3], "rules", 999.into()));
    fs::write(&path, lines.join("\n") + "\n").unwrap();
    let message = desk.refused("status a", 65);
    assert!(
        message.contains("another result of trial 2 than an earlier line"),
        "{message}"
    );
}

#[test]
fn a_merge_into_a_folder_with_other_results_is_refused() {
    let desk = Desk::new();
    let (_, mut lines) = journal(&desk);
    desk.done("merge a --out b");
    lines[1] = forge(&lines[1], "rules", 999.into());
    let merged = folder::journal(&desk.path("b"));
    fs::write(merged, lines.join("\n") + "\n").unwrap();
    let message = desk.refused("merge a --out b", 65);
    assert!(message.contains("another result of trial 0"), "{message}");
}

#[test]
fn figures_that_no_trial_can_have_are_refused_though_their_checksum_is_right() {
    let desk = Desk::new();
    let (path, lines) = journal(&desk);
    for (figure, value) in [
        ("first_optimal_episode", serde_json::json!(0)),
        ("first_optimal_episode", serde_json::json!(13)),
        ("first_optimal_episode", serde_json::json!(4294967295_u32)),
        ("first_optimal_env_steps", serde_json::json!(u64::MAX)),
        ("first_executed_optimal_episode", serde_json::json!(13)),
        ("best_steps", serde_json::json!(0)),
        ("optimal_episodes", serde_json::json!(u32::MAX)),
        ("episodes", serde_json::json!(11)),
        ("steps", serde_json::json!(u64::MAX)),
        ("collisions", serde_json::json!(u64::MAX)),
        ("rules", serde_json::json!(u64::MAX)),
        ("compacted_rules", serde_json::json!(u32::MAX)),
    ] {
        for trial in 1..lines.len() {
            let mut lines = lines.clone();
            lines[trial] = forge(&lines[trial], figure, value.clone());
            fs::write(&path, lines.join("\n") + "\n").unwrap();
            for words in ["report a", "run small.toml --out a --trials 2"] {
                let message = desk.refused(words, 65);
                assert!(message.contains(figure), "{figure} {value}: {message}");
            }
        }
    }
}

#[test]
fn only_the_papers_own_experiment_is_set_beside_the_paper() {
    let desk = Desk::new();
    let printed = desk.done("run small.toml --episodes 180 --trials 1 --out a");
    for words in [
        "Comparison with the paper",
        "p = 0.8646",
        "Eq. 6: the denominator",
    ] {
        assert!(printed.contains(words), "{words} is missing in\n{printed}");
    }
    let other = SMALL.replace("trials = 4", "sensors = [\"position\"]\ntrials = 1");
    desk.write("other.toml", &other.replace("= 12", "= 180"));
    assert!(
        !desk
            .done("run other.toml --out b")
            .contains("Comparison with the paper")
    );
}

#[test]
fn what_was_learned_before_or_turned_off_is_compared_with_nothing() {
    let desk = Desk::new();
    let text = SMALL.replace(
        "methods = [\"xcs\", \"xcscr\"]",
        "methods = [\"xcscr-plus\"]",
    );
    desk.write(
        "after.toml",
        &format!("after = [\"nothing\", \"maze6\"]\n{text}"),
    );
    let printed = desk.done("run after.toml --out a");
    assert!(
        printed.contains("xcscr-plus after maze6 − after nothing"),
        "{printed}"
    );
    desk.write(
        "without.toml",
        &format!("without = [\"plus.return_rules\", \"plus.certainty=1\"]\n{text}"),
    );
    desk.done("run without.toml --out w");
    let printed = desk.done("report w --format md");
    for part in ["plus.return_rules", "plus.certainty"] {
        let words = format!("xcscr-plus without {part} − without nothing");
        assert!(printed.contains(&words), "{printed}");
    }
}

#[test]
fn a_report_says_what_came_out_and_draws_it() {
    let desk = Desk::new();
    let printed = desk.done("run small.toml --out a");
    for words in ["maze5", "xcscr − xcs", "Pairwise comparisons"] {
        assert!(printed.contains(words), "{words} is missing in\n{printed}");
    }
    assert!(
        !printed.contains("Comparison with the paper"),
        "12 episodes are not the paper's"
    );
    for file in [
        "report.md",
        "trials.csv",
        "summary.json",
        "curves.svg",
        "first-optimal.png",
        "steps.svg",
    ] {
        assert!(desk.path("a").join(file).is_file(), "{file}");
    }
    let report: serde_json::Value = serde_json::from_str(&desk.done("report a --json")).unwrap();
    assert_eq!(report["arms"].as_array().unwrap().len(), 4);
    let summary = fs::read(desk.path("a/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    for key in [
        "trials",
        "successes",
        "wilson_low",
        "median_episode",
        "p95_episode",
        "retained",
    ] {
        assert!(summary["arms"][0].get(key).is_some(), "{key}");
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
    let report: serde_json::Value = serde_json::from_str(&desk.done("report a --json")).unwrap();
    let comparisons = report["comparisons"].as_array().unwrap();
    let column = |name: &str| -> Vec<f64> {
        let cells = comparisons.iter().map(|one| one[name].as_f64().unwrap());
        cells.collect()
    };
    let (ps, found) = (column("mcnemar_p"), column("holm_p"));
    assert_eq!(ps.len(), 4, "two worlds, two other methods");
    let expected = step_down(&ps);
    for (found, expected) in found.iter().zip(&expected) {
        assert!(
            (found - expected).abs() < 1e-5,
            "{ps:?}: {found} {expected}"
        );
    }
    // Control: a correction over the two worlds of a pair alone would at most double a p.
    let more_than_doubled = |(found, p): (&f64, &f64)| *found > 2.0 * p + 1e-9;
    assert!(
        found.iter().zip(&ps).any(more_than_doubled),
        "{ps:?} {found:?}"
    );
}

#[test]
fn an_ablation_tells_what_each_switch_contributes() {
    let desk = Desk::new();
    let printed = desk.done("run ablation --out a --trials 1 --episodes 3");
    assert!(printed.contains("Contribution of each switch"), "{printed}");
    assert!(desk.path("a/ablation.svg").is_file());
    assert_eq!(
        fs::read_to_string(desk.path("a/trials.csv"))
            .unwrap()
            .lines()
            .count(),
        49
    );
}

#[test]
fn a_trial_of_a_study_is_the_same_as_training_with_its_seed() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --trials 1");
    let table = fs::read_to_string(desk.path("a/trials.csv")).unwrap();
    let cells = |line: usize| table.lines().nth(line).unwrap().split(',');
    let row: BTreeMap<&str, &str> = cells(0).zip(cells(2)).collect();
    assert_eq!([row["world"], row["method"]], ["maze4", "xcscr"]);
    let world = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/maze4.json");
    let mut train = std::process::Command::new(env!("CARGO_BIN_EXE_xcscr"));
    train.current_dir(desk.path("")).args([
        "train",
        world,
        "--method",
        "xcscr",
        "--arena",
        "grid",
        "--episodes",
        "12",
    ]);
    train.args(["--seed", row["seed"], "--record", "none", "--json"]);
    let trained: serde_json::Value =
        serde_json::from_slice(&train.output().unwrap().stdout).unwrap();
    assert_eq!(trained["steps"].to_string(), row["steps"]);
    assert_eq!(trained["collisions"].to_string(), row["collisions"]);
}

/// Every address or file that a page would fetch names it in one of these ways.
const FETCHES: [&str; 9] = [
    "http:", "https:", "//", " src", " href", "url(", "@import", "<link", "fetch(",
];

#[test]
fn the_html_report_is_one_page_that_needs_nothing_else() {
    let desk = Desk::new();
    desk.done("run small.toml --out a");
    let page = desk.done("report a --format html");
    assert_eq!(
        page.as_bytes(),
        fs::read(desk.path("a/report.html")).unwrap()
    );
    // Comments of the script are no addresses.
    let code: Vec<&str> = page
        .lines()
        .filter(|line| !line.trim_start().starts_with("// "))
        .collect();
    let code = code.join("\n");
    for fetch in FETCHES {
        let at = code.find(fetch);
        let around = at.map(|at| &code[at.saturating_sub(80)..(at + 80).min(code.len())]);
        assert_eq!(around, None, "{fetch}");
    }
    assert!(
        page.contains("default-src 'none'"),
        "the browser refuses to fetch"
    );
    assert_eq!(page.matches("<svg ").count(), 3, "all figures are inside");
    assert!(page.contains("prefers-color-scheme: dark"));
}

#[test]
fn a_report_has_the_parts_of_a_results_section_in_every_format() {
    let desk = Desk::new();
    desk.done("run small.toml --out a");
    let sections = [
        "Question",
        "Setup",
        "Table",
        "Figures",
        "Tests",
        "Limitations",
    ];
    let markdown = desk.done("report a --format md");
    let headings: Vec<&str> = markdown
        .lines()
        .filter_map(|line| line.strip_prefix("## "))
        .collect();
    assert_eq!(headings, sections);
    let page = desk.done("report a --format html");
    for section in sections {
        assert!(page.contains(&format!("<h2>{section}</h2>")), "{section}");
    }
    let json = desk.done("report a --format json");
    assert_eq!(json, desk.done("report a --json"));
    desk.refused("report a --format pdf", 2);
}

#[test]
fn names_and_errors_from_files_stay_text_in_reports_and_tables() {
    let desk = Desk::new();
    desk.write("evil.toml", &SMALL.replace("small", "<img src=x>"));
    desk.done("run evil.toml --out a --quiet --trials 1");
    let report = fs::read_to_string(desk.path("a/report.md")).unwrap();
    assert!(report.starts_with("# Study \\<img src=x>"), "{report}");
    let page = fs::read_to_string(desk.path("a/report.html")).unwrap();
    assert!(
        !page.contains("<img") && page.contains("&lt;img src=x"),
        "{page}"
    );
}

#[test]
fn a_study_tries_a_sample_of_its_combinations() {
    let desk = Desk::new();
    let sweep = "sample = 3\n[sweep]\n\"xcs.beta\" = [0.1, 0.2, 0.3]\n\"xcs.mu\" = [0.1, 0.2]\n";
    desk.write("sample.toml", &(SMALL.to_owned() + sweep));
    desk.done("run sample.toml --out a --trials 1");
    let status = desk.done("status a");
    // 2 worlds x 2 methods x 3 of 6 combinations.
    assert!(status.contains("12 of 12 trials"), "{status}");
}

//! Studies in folders that other processes, or their users, write in as well.

use std::fs;
use std::os::unix::fs::symlink;

use super::tasks::desk;
use crate::desk::Desk;
use crate::kit::folder;

/// Settings to choose among.
const SWEEP: &str = r#"
name = "sweep"
worlds = ["maze4"]
methods = ["xcscr"]
trials = 1
episodes = 3

[sweep]
"xcs.theta_ga" = [5, 25]
"#;
/// Processes that are started at the same time.
const AT_ONCE: usize = 12;

/// Exit codes and messages of processes that run at the same time.
fn at_once(desk: &Desk, words: impl Fn(usize) -> String) -> Vec<(Option<i32>, String)> {
    let begin = |number| desk.begin(&words(number));
    let children: Vec<_> = (0..AT_ONCE).map(begin).collect();
    let ended = children.into_iter().map(|child| {
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), said)
    });
    ended.collect()
}

#[test]
fn processes_that_plan_one_study_at_once_agree_on_its_plan_or_are_refused() {
    let desk = desk();
    desk.done("plan small.toml --tasks 8 --out alone");
    // The first rounds all want the same number of tasks, the others one of two.
    for (round, kinds) in [1, 1, 1, 1, 1, 2, 2, 2, 2, 2].into_iter().enumerate() {
        let out = format!("split{round}");
        let tasks = |number: usize| 8 + number % kinds;
        let ended = at_once(&desk, |number| {
            format!("plan small.toml --tasks {} --out {out}", tasks(number))
        });
        let plan = desk.read(&format!("{out}/study.json"));
        for (number, (code, said)) in ended.into_iter().enumerate() {
            let is_there = plan.contains(&format!("\"tasks\": {},", tasks(number)));
            assert_eq!(code, Some(if is_there { 0 } else { 73 }), "{said}");
        }
        let names = |name: &str| folder::names(&desk.path(name));
        assert_eq!(names(&out), names("alone"));
        let is_same = plan == desk.read("alone/study.json");
        assert!(
            is_same || kinds == 2,
            "another plan than that of one process"
        );
    }
}

#[test]
fn many_processes_that_search_in_one_folder_at_once_agree() {
    let desk = desk();
    desk.write("sweep.toml", SWEEP);
    let words = "tune sweep.toml --budget 4 --tasks 1 --out found";
    for (code, said) in at_once(&desk, |_| words.to_owned()) {
        assert_eq!(code, Some(75), "{said}");
        assert!(said.contains("the search waits for"), "{said}");
    }
    let whole = "tune sweep.toml --budget 4 --out whole --quiet";
    desk.done(whole);
    for (code, said) in at_once(&desk, |_| whole.to_owned()) {
        let is_busy = said.contains("is in use by process");
        assert!(code == Some(0) || code == Some(73) && is_busy, "{said}");
    }
    let text = desk.read("whole/search.json");
    desk.write("whole/search.json", "{}");
    desk.refused(whole, 73, "search.json was changed");
    assert_eq!(desk.read("whole/search.json"), "{}");
    fs::remove_file(desk.path("whole/search.json")).unwrap();
    desk.done(whole);
    assert_eq!(desk.read("whole/search.json"), text);
}

#[test]
fn scripts_are_written_anew_for_other_tasks_unless_they_were_changed_by_hand() {
    let desk = desk();
    let words = "submit small.toml --tasks 2 --time 1h --out split";
    desk.done(words);
    let array = "split/slurm/array.sh";
    let first = desk.read(array);
    desk.done("task split 1");
    desk.done(words);
    let second = desk.read(array);
    assert_ne!(first, second, "only a task is left");
    let submitted = desk.read("submitted");
    for name in ["array.sh", "merge.sh"] {
        let path = format!("split/slurm/{name}");
        let text = desk.read(&path);
        let mine = text.replacen("#SBATCH", "#SBATCH --mem=4G\n#SBATCH", 1);
        for altered in [mine.as_str(), "echo mine\n", ""] {
            desk.write(&path, altered);
            desk.refused(words, 73, &format!("{name} was changed"));
            assert_eq!(desk.read(&path), altered);
        }
        fs::remove_file(desk.path(&path)).unwrap();
    }
    let after = desk.read("submitted");
    assert_eq!(after, submitted, "a refused script was submitted");
    desk.done(words);
    assert_eq!(desk.read(array), second);
}

#[test]
fn a_link_to_another_folder_of_scripts_is_not_followed() {
    let desk = desk();
    desk.done("plan small.toml --tasks 2 --out split");
    fs::create_dir(desk.path("elsewhere")).unwrap();
    desk.write("elsewhere/merge.sh", "mine");
    symlink(desk.path("elsewhere"), desk.path("split/slurm")).unwrap();
    let words = "submit small.toml --time 1h --out split";
    desk.refused(words, 73, "slurm: it is a symbolic link");
    let there = folder::contents(&desk.path("elsewhere"));
    assert_eq!(there, [("merge.sh".to_owned(), b"mine".to_vec())]);
}

//! Studies in folders that other processes, or their users, write in as well.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Stdio;

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
    let spawn = |number| {
        let mut command = desk.command(&words(number));
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    };
    let children: Vec<_> = (0..AT_ONCE).map(spawn).collect();
    let ended = children.into_iter().map(|child| {
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), said)
    });
    ended.collect()
}

#[test]
fn many_processes_that_plan_one_study_at_once_all_succeed_and_leave_one_plan() {
    let desk = desk();
    desk.done("plan small.toml --tasks 8 --out alone");
    for round in 0..5 {
        let out = format!("split{round}");
        let words = format!("plan small.toml --tasks 8 --out {out}");
        for (code, said) in at_once(&desk, |_| words.clone()) {
            assert_eq!(code, Some(0), "{said}");
        }
        let [made, alone] = [out.as_str(), "alone"].map(|name| desk.path(name));
        assert_eq!(folder::names(&made), folder::names(&alone));
        let [made, alone] = [made, alone].map(|path| fs::read(path.join("plan.json")).unwrap());
        assert!(made == alone, "another plan than that of one process");
    }
}

#[test]
fn of_processes_that_split_a_study_differently_at_once_none_is_overruled_in_silence() {
    let desk = desk();
    for round in 0..5 {
        let out = format!("split{round}");
        let tasks = |number: usize| 2 + number % 2;
        let ended = at_once(&desk, |number| {
            format!("plan small.toml --tasks {} --out {out}", tasks(number))
        });
        let text = fs::read_to_string(desk.path(&out).join("plan.json")).unwrap();
        for (number, (code, said)) in ended.into_iter().enumerate() {
            let is_there = text.contains(&format!("\"tasks\": {},", tasks(number)));
            assert_eq!(code, Some(if is_there { 0 } else { 73 }), "{said}");
        }
    }
}

#[test]
fn many_processes_that_search_in_one_folder_at_once_agree() {
    let desk = desk();
    fs::write(desk.path("sweep.toml"), SWEEP).unwrap();
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
    let search = desk.path("whole/search.json");
    let (text, altered) = (fs::read(&search).unwrap(), "{}");
    fs::write(&search, altered).unwrap();
    let (_, said) = desk.ends(whole, 73);
    assert!(said.contains("search.json was changed"), "{said}");
    assert_eq!(fs::read_to_string(&search).unwrap(), altered);
    fs::remove_file(&search).unwrap();
    desk.done(whole);
    assert_eq!(fs::read(&search).unwrap(), text);
}

#[test]
fn scripts_are_written_anew_for_other_tasks_unless_they_were_changed_by_hand() {
    let desk = desk();
    let words = "submit small.toml --tasks 2 --time 1h --out split";
    desk.done(words);
    let array = desk.path("split/slurm/array.sh");
    let first = fs::read_to_string(&array).unwrap();
    desk.done("task split 1");
    desk.done(words);
    let second = fs::read_to_string(&array).unwrap();
    assert_ne!(first, second, "only a task is left");
    let submitted = fs::read_to_string(desk.path("submitted")).unwrap();
    for name in ["array.sh", "merge.sh"] {
        let path = desk.path("split/slurm").join(name);
        let text = fs::read_to_string(&path).unwrap();
        let mine = text.replacen("#SBATCH", "#SBATCH --mem=4G\n#SBATCH", 1);
        for altered in [mine.as_str(), "echo mine\n", ""] {
            fs::write(&path, altered).unwrap();
            let (_, said) = desk.ends(words, 73);
            assert!(said.contains(&format!("{name} was changed")), "{said}");
            assert_eq!(fs::read_to_string(&path).unwrap(), altered);
        }
        fs::remove_file(&path).unwrap();
    }
    let after = fs::read_to_string(desk.path("submitted")).unwrap();
    assert_eq!(after, submitted, "a refused script was submitted");
    desk.done(words);
    assert_eq!(fs::read_to_string(&array).unwrap(), second);
}

#[test]
fn a_link_to_another_folder_of_scripts_is_not_followed() {
    let desk = desk();
    desk.done("plan small.toml --tasks 2 --out split");
    fs::create_dir(desk.path("elsewhere")).unwrap();
    fs::write(desk.path("elsewhere/merge.sh"), "mine").unwrap();
    symlink(desk.path("elsewhere"), desk.path("split/slurm")).unwrap();
    let (_, said) = desk.ends("submit small.toml --time 1h --out split", 73);
    assert!(said.contains("slurm: it is a symbolic link"), "{said}");
    let there = folder::contents(&desk.path("elsewhere"));
    assert_eq!(there, [("merge.sh".to_owned(), b"mine".to_vec())]);
}

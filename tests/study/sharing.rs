//! Studies in folders that other processes, or their users, write in as well.

use crate::kit::folder;
use crate::study::desk::Desk;

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
    let desk = Desk::new();
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

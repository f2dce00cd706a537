//! Exported policies with a memory are compiled or run as their users would, and drive through whole
//! episodes as the learner does.

use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use xcscr::agent::{
    Agent, Choice, Chooser, EndCredit, Explorer, Frozen, Knowledge, Method, StepCredit,
};
use xcscr::arena::{ArenaKind, Outcome};
use xcscr::episode;
use xcscr::export::{Origin, Policy, Target};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Maze, Recipe};
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept, PredictionArray};

use super::exporting::{compile_c, fed, folder};
use crate::kit::trial::{maze, on_the_grid};

/// Stands for `no rule matches` in what the programs print.
const NONE: u8 = 255;

/// The likeliest state is compared every so many steps: that takes long.
const COMPARED_EVERY: u32 = 5;

/// Commands of five bytes: `r` resets; `p`, two bytes of percept, bumped, rewarded asks for an action and
/// the likeliest state; `a` and an action says that something else is done.
const C_MAIN: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    static struct xcscr_tracker tracker;
    uint8_t line[5];
    while (fread(line, 1, sizeof line, stdin) == sizeof line) {
        if (line[0] == 'r') {
            xcscr_reset(&tracker);
        } else if (line[0] == 'a') {
            tracker.action = (int8_t)line[1];
        } else {
            const uint16_t percept = (uint16_t)(line[1] | line[2] << 8);
            const int8_t action = xcscr_perceive(&tracker, percept, line[3], line[4]);
            const uint16_t likeliest = xcscr_likeliest(&tracker);
            putchar((uint8_t)action);
            putchar((uint8_t)(likeliest & 255));
            putchar((uint8_t)(likeliest >> 8));
            fflush(stdout);
        }
    }
    return 0;
}
"#;

const PYTHON_MAIN: &str = r#"
import sys
import policy
tracker = policy.Tracker()
while line := sys.stdin.buffer.read(5):
    if line[0] == ord("r"):
        tracker = policy.Tracker()
    elif line[0] == ord("a"):
        tracker.action = line[1]
    else:
        action = tracker.perceive(line[1] | line[2] << 8, line[3], line[4])
        likeliest = tracker.likeliest()
        action = 255 if action is None else action
        likeliest = 65535 if likeliest is None else likeliest
        sys.stdout.buffer.write(bytes([action, likeliest & 255, likeliest >> 8]))
        sys.stdout.buffer.flush()
"#;

/// Prints the sizes of the table of states and of a tracker.
const C_SIZES: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    struct xcscr_tracker tracker;
    xcscr_reset(&tracker);
    (void)xcscr_perceive(&tracker, 0, 0, 0);
    printf("%d %d\n", (int)sizeof xcscr_states, (int)sizeof tracker);
    return 0;
}
"#;

/// What was learned, and where.
struct Learned {
    plan: Plan,
    knowledge: Knowledge,
}

impl Learned {
    fn new(plan: Plan) -> Self {
        let trial = plan.run().unwrap();
        Self {
            plan: trial.plan().clone(),
            knowledge: trial.method().knowledge(),
        }
    }

    fn charted(&self) -> Charted {
        let Knowledge::Remembering { map, .. } = &self.knowledge else {
            panic!("no memory");
        };
        Charted {
            last_chart: map.spots.iter().map(|spot| spot.chart).max(),
            most_eaten: map.spots.iter().map(|spot| spot.eaten).max(),
            begins_in_one_place: map.begin.is_some(),
        }
    }

    fn text(&self, target: Target) -> String {
        let Plan { maze, config } = &self.plan;
        let (width, actions) = (config.sensor.width(maze), maze.action_count());
        let policy = Policy::new(&self.knowledge, width, actions, &[]).unwrap();
        let origin = Origin::new(&self.plan, &self.knowledge, true);
        target.text(&policy, &origin).unwrap()
    }

    /// Drives episodes from all starts, as often as asked, and each step in `chance` by chance.
    fn driven(&self, program: &mut Command, times: u32, chance: f64) -> Tally {
        let Plan { maze, config } = &self.plan;
        let limit = config.settings.reward.step_threshold;
        let frozen = Frozen::new(self.knowledge.clone(), maze.action_count(), limit);
        let mut driver = Driver::new(frozen, program);
        let mut arena = config.build_arena(maze).unwrap();
        let mut explorer = Explorer::new(chance, Stream::new(7, 0_u64));
        for number in 1..=times {
            for start in maze.start_cells() {
                let (arena, sensor) = (arena.as_mut(), config.sensor);
                let (episode, _) = episode::run(
                    number,
                    start,
                    arena,
                    sensor,
                    &mut driver,
                    &mut explorer,
                    &mut (),
                );
                driver.tally.reached += u32::from(episode.ending == episode::Ending::Goal);
                driver.tally.episodes += 1;
            }
        }
        driver.tally
    }
}

/// What is on the charts.
struct Charted {
    last_chart: Option<u8>,
    most_eaten: Option<u8>,
    begins_in_one_place: bool,
}

/// How driving went.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    episodes: u32,
    reached: u32,
    steps: u32,
    /// Steps in which the program chose what the learner does not rate best.
    differences: u32,
    /// Steps in which another state was likeliest for it.
    elsewhere: u32,
    /// Steps in which no rule matched.
    unknown: u32,
}

/// Follows an exported program, and compares it with the learner.
struct Driver {
    frozen: Frozen,
    program: Child,
    chosen: u8,
    felt: [bool; 2],
    tally: Tally,
}

impl Driver {
    fn new(frozen: Frozen, command: &mut Command) -> Self {
        let program = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut driver = Self {
            frozen,
            program,
            chosen: NONE,
            felt: [false; 2],
            tally: Tally::default(),
        };
        driver.say([b'r', 0, 0, 0, 0]);
        driver
    }

    fn say(&mut self, line: [u8; 5]) {
        let stdin = self.program.stdin.as_mut().unwrap();
        stdin.write_all(&line).unwrap();
        stdin.flush().unwrap();
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        drop(self.program.stdin.take());
        let _ = self.program.wait();
    }
}

impl Agent for Driver {
    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        let [low, high, ..] = percept.words()[0].to_le_bytes();
        let [bumped, rewarded] = self.felt.map(u8::from);
        self.say([b'p', low, high, bumped, rewarded]);
        let mut answer = [0; 3];
        self.program
            .stdout
            .as_mut()
            .unwrap()
            .read_exact(&mut answer)
            .unwrap();
        let [chosen, low, high] = answer;
        self.chosen = chosen;
        let worth = self.frozen.consider(percept);
        if self.tally.steps.is_multiple_of(COMPARED_EVERY) {
            let there = likeliest(&self.frozen);
            self.tally.elsewhere += u32::from(there != u16::from_le_bytes([low, high]));
        }
        let best = |action| worth.best_actions().any(|best| best.index() == action);
        let agrees = match self.chosen {
            NONE => worth.greatest().is_none(),
            chosen => best(usize::from(chosen)),
        };
        self.tally.steps += 1;
        self.tally.differences += u32::from(!agrees);
        self.tally.unknown += u32::from(self.chosen == NONE);
        worth
    }

    /// What the program chose, unless it has no answer or chance says otherwise.
    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (other, explores) = explorer.choose(worth);
        let chosen = Action::new(usize::from(self.chosen)).filter(|_| !explores);
        if chosen.is_none() {
            self.say([b'a', other.index() as u8, 0, 0, 0]);
        }
        Choice::new(chosen.unwrap_or(other), Chooser::Rules)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        self.felt = [
            matches!(outcome, Outcome::Collided { .. }),
            outcome.found() > 0.0,
        ];
        self.frozen.credit(action, outcome)
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        self.say([b'r', 0, 0, 0, 0]);
        self.frozen.finish(reached_goal)
    }

    fn step_threshold(&self) -> u32 {
        self.frozen.step_threshold()
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.frozen.worth(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.frozen.knowledge()
    }

    fn rule_count(&self) -> usize {
        self.frozen.rule_count()
    }
}

/// The likeliest state of a learner, the first of several, or the number of none.
fn likeliest(frozen: &Frozen) -> u16 {
    let json = serde_json::to_value(frozen).unwrap();
    let belief: Vec<(u16, f64)> =
        serde_json::from_value(json["tracker"]["belief"].clone()).unwrap();
    let better = |best: (u16, f64), one: (u16, f64)| if one.1 > best.1 { one } else { best };
    belief
        .into_iter()
        .reduce(better)
        .map_or(u16::MAX, |best| best.0)
}

/// A plan on the grid of a maze of one's own.
fn own(json: &str) -> Plan {
    let plan = Plan::new(Maze::from_json(json.as_bytes(), "own.json").unwrap());
    let plan = plan.method(Method::XcscrMemory).arena(ArenaKind::Grid);
    plan.sensor(Sensor::Neighbours).episodes(60).seed(3)
}

fn classic(world: &str) -> Plan {
    let mut plan = on_the_grid(&format!("classic/{world}"), Method::XcscrMemory);
    plan.config.settings.reward.step_threshold = 100;
    plan.episodes(60).seed(5)
}

/// A program made of a header.
fn compiled(folder: &Path, header: &str) -> Command {
    fs::write(folder.join("policy.h"), header).unwrap();
    fs::write(folder.join("main.c"), C_MAIN).unwrap();
    compile_c(folder);
    Command::new(folder.join("decide"))
}

/// Drives straight and with random steps, and finds no difference.
fn drives_alike(name: &str, learned: &Learned, program: &mut Command) {
    let straight = learned.driven(program, 1, 0.0);
    assert_eq!(straight.reached, straight.episodes, "{name}: {straight:?}");
    for tally in [straight, learned.driven(program, 8, 0.3)] {
        assert_eq!(tally.differences, 0, "{name}: {tally:?}");
        assert_eq!(tally.elsewhere, 0, "{name}: {tally:?}");
    }
}

fn interpreted(folder: &Path, module: &str) -> Command {
    fs::write(folder.join("policy.py"), module).unwrap();
    fs::write(folder.join("main.py"), PYTHON_MAIN).unwrap();
    let mut python = Command::new("python3");
    python.arg("main.py").current_dir(folder);
    python
}

/// What makes a program of an exported policy.
type Maker = fn(&Path, &str) -> Command;

const LANGUAGES: [(Target, Maker); 2] = [(Target::C99, compiled), (Target::Python, interpreted)];

#[test]
fn rules_with_a_memory_drive_as_the_learner_in_every_step_in_all_languages() {
    for world in [
        "maze7",
        "maze10",
        "woods101",
        "mazee1",
        "mazef4",
        "littman57",
        "sutton",
    ] {
        checked(world, classic(world));
    }
}

#[test]
fn control_a_rule_or_a_state_that_is_forged_is_found() {
    let (learned, folder) = (Learned::new(classic("maze7")), folder());
    let header = learned.text(Target::C99);
    let vote = "xcscr_vote(&votes, ";
    let at = header.rfind(vote).unwrap() + vote.len();
    let action = if header[at..].starts_with('0') {
        "1"
    } else {
        "0"
    };
    let rule = format!("{}{action}{}", &header[..at], &header[at + 1..]);
    let tally = learned.driven(&mut compiled(folder.path(), &rule), 4, 0.3);
    assert!(tally.differences > 0, "{tally:?}");
    let [first, second] =
        ["/* 0 */", "/* 1 */"].map(|end| header.lines().find(|line| line.ends_with(end)).unwrap());
    let state = header.replacen(second, first, 1);
    let tally = learned.driven(&mut compiled(folder.path(), &state), 4, 0.3);
    assert!(tally.elsewhere > 0, "{tally:?}");
}

#[test]
fn it_drives_so_where_moves_slip_percepts_are_misread_and_both() {
    for (world, slip, flips) in [
        ("woods101", 0.2, 0.0),
        ("mazef4", 0.1, 0.0),
        ("maze7", 0.0, 0.02),
        ("littman57", 0.0, 0.02),
        ("mazee1", 0.1, 0.02),
    ] {
        let mut plan = classic(world);
        plan.config.settings.arena.slip = slip;
        plan.config.settings.sensor.flips = flips;
        let learned = checked(&format!("{world}, slip {slip}, flips {flips}"), plan);
        let header = learned.text(Target::C99);
        assert!(header.contains("XCSCR_SLIP") || slip == 0.0, "{world}");
        assert!(header.contains("XCSCR_MISREAD") || flips == 0.0, "{world}");
    }
}

/// Learns, exports to all languages and drives, and returns what was learned.
fn checked(name: &str, plan: Plan) -> Learned {
    let learned = Learned::new(plan);
    for (target, program) in LANGUAGES {
        let folder = folder();
        let mut program = program(folder.path(), &learned.text(target));
        drives_alike(
            &format!("{name} in {}", target.name()),
            &learned,
            &mut program,
        );
    }
    learned
}

const PAID: [&str; 7] = [
    "##########",
    "#..#...#.#",
    "#*.....#.#",
    "#..#.#...#",
    "####.#.#.#",
    "#*...#G#*#",
    "##########",
];

#[test]
fn it_drives_so_where_cells_pay_by_themselves() {
    for (reward, slip, flips) in [(400.0, 0.0, 0.0), (400.0, 0.1, 0.0), (400.0, 0.0, 0.01)] {
        let mut plan = own(&format!(r#"{{ "rows": {PAID:?}, "reward": {reward} }}"#));
        plan.config.settings.arena.slip = slip;
        plan.config.settings.sensor.flips = flips;
        let name = format!("reward {reward}, slip {slip}, flips {flips}");
        let learned = checked(&name, plan);
        let eaten = learned.charted().most_eaten;
        assert!(eaten > Some(0), "{name}: no reward is on the chart");
    }
}

#[test]
fn it_drives_so_with_several_charts_and_where_all_episodes_begin_in_one_place() {
    let two = [
        "#########",
        "#...#...#",
        "#.#...#.#",
        "#.##.##.#",
        "#G#...#.#",
        "###.#.#.#",
        "#...#...#",
        "#.###.#G#",
        "#########",
    ];
    let learned = checked("two goals", own(&format!(r#"{{ "rows": {two:?} }}"#)));
    let last = learned.charted().last_chart;
    assert!(last > Some(0), "{last:?}: one chart");
    for flips in [0.0, 0.01] {
        let maze = "rooms-20-1".parse::<Recipe>().unwrap().maze().unwrap();
        let plan = Plan::new(maze).method(Method::XcscrMemory);
        let mut plan = plan
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Lidar)
            .episodes(12);
        plan.config.settings.sensor.flips = flips;
        let learned = checked(&format!("rooms, flips {flips}"), plan);
        assert!(learned.charted().begins_in_one_place, "flips {flips}");
    }
}

#[test]
fn it_drives_so_in_physics_with_all_senses_of_its_own() {
    let mut plan = Plan::new(maze("maze4")).method(Method::XcscrMemory);
    plan = plan
        .arena(ArenaKind::Physics)
        .sensor(Sensor::Lidar)
        .episodes(6);
    plan.config.settings.physics.noise = 3.0;
    checked("maze4 in physics", plan);
}

#[test]
fn the_header_tells_how_much_memory_a_tracker_takes() {
    for flips in [0.0, 0.02] {
        let mut plan = classic("maze7");
        plan.config.settings.sensor.flips = flips;
        let (learned, folder) = (Learned::new(plan), folder());
        let header = learned.text(Target::C99);
        fs::write(folder.path().join("policy.h"), &header).unwrap();
        fs::write(folder.path().join("main.c"), C_SIZES).unwrap();
        compile_c(folder.path());
        let sizes = fed(&mut Command::new(folder.path().join("decide")), Vec::new());
        let sizes = String::from_utf8(sizes).unwrap();
        let (constants, tracker) = sizes.trim().split_once(' ').unwrap();
        for told in [
            format!("together {constants} bytes of constants"),
            format!("and {tracker} bytes of memory"),
        ] {
            assert!(header.contains(&told), "flips {flips}: {told}");
        }
    }
}

#[test]
fn data_of_rules_with_a_memory_tell_what_they_look_at_and_json_has_the_charts() {
    let learned = Learned::new(classic("maze7"));
    let json: serde_json::Value = serde_json::from_str(&learned.text(Target::Json)).unwrap();
    let [rules, states] = [&json["rules"], &json["charts"]["states"]];
    assert_eq!(states.as_array().unwrap().len(), 9, "{states}");
    assert!(
        states[0]["next"]
            .as_array()
            .unwrap()
            .iter()
            .any(|next| next.is_null()),
        "{states}"
    );
    let places = |words: &str| words.contains("x >") || words.contains("x <=");
    let rules = rules.as_array().unwrap();
    assert!(
        rules
            .iter()
            .any(|rule| places(rule["if"].as_str().unwrap())),
        "{rules:?}"
    );
    for target in [Target::Csv, Target::Dot] {
        assert!(places(&learned.text(target)), "{}", target.name());
    }
}

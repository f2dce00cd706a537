//! Drives through whole episodes with an exported program, and compares it with the learner.

use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};

use xcscr::agent::{Agent, Choice, Chooser, EndCredit, Explorer, Frozen, Knowledge, StepCredit};
use xcscr::arena::Outcome;
use xcscr::episode;
use xcscr::export::{ExportError, Policy, Provenance, Target};
use xcscr::trial::Plan;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept, PredictionArray};

/// Stands for `no rule matches` in what the programs print.
const NONE: u8 = 255;
/// The likeliest state or place is compared every so many steps: that takes long.
const COMPARED_EVERY: u32 = 5;

/// What was learned, and where.
pub struct Learned {
    pub plan: Plan,
    pub knowledge: Knowledge,
}

impl Learned {
    pub fn new(plan: Plan) -> Self {
        let trial = plan.run().unwrap();
        Self {
            plan: trial.plan().clone(),
            knowledge: trial.method().knowledge(),
        }
    }

    pub fn mapped(&self) -> MappedCells {
        let Knowledge::Remembering { map, .. } = &self.knowledge else {
            panic!("no memory");
        };
        MappedCells {
            last_map: map.states.iter().map(|state| state.cell_map).max(),
            most_eaten: map.states.iter().map(|state| state.collected).max(),
            begins_in_one_place: map.begin.is_some(),
        }
    }

    pub fn policy(&self) -> Result<Policy, ExportError> {
        let Plan { maze, config } = &self.plan;
        let (width, actions) = (config.sensor.width(maze), maze.action_count());
        Policy::new(&self.knowledge, width, actions, &[])
    }

    pub fn text(&self, target: Target) -> String {
        let origin = Provenance::new(&self.plan, &self.knowledge, true);
        target.text(&self.policy().unwrap(), &origin)
    }

    /// Drives episodes from all starts, as often as asked, and each step in `chance` by chance.
    pub fn driven(&self, program: &mut Command, times: u32, chance: f64) -> Tally {
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

/// What is on the maps.
pub struct MappedCells {
    pub last_map: Option<u8>,
    pub most_eaten: Option<u8>,
    pub begins_in_one_place: bool,
}

/// How driving went.
#[derive(Debug, Default, Clone, Copy)]
pub struct Tally {
    pub episodes: u32,
    pub reached: u32,
    pub steps: u32,
    /// Steps in which the program chose what the learner does not rate best.
    pub differences: u32,
    /// Steps in which another state or place was likeliest for it.
    pub elsewhere: u32,
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
        driver.say(b'r', [0, 0], 0);
        driver
    }

    /// A command of eleven bytes.
    fn say(&mut self, command: u8, more: [u8; 2], percept: u64) {
        let stdin = self.program.stdin.as_mut().unwrap();
        let line = [&[command][..], &more, &percept.to_le_bytes()].concat();
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
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.say(b'p', self.felt.map(u8::from), percept.words()[0]);
        let mut answer = [0; 3];
        self.program
            .stdout
            .as_mut()
            .unwrap()
            .read_exact(&mut answer)
            .unwrap();
        let [chosen, low, high] = answer;
        self.chosen = chosen;
        let values = self.frozen.observe(percept);
        if self.tally.steps.is_multiple_of(COMPARED_EVERY) {
            let there = likeliest(&self.frozen);
            self.tally.elsewhere += u32::from(there != u16::from_le_bytes([low, high]));
        }
        let best = |action| values.best_actions().any(|best| best.index() == action);
        let agrees = match self.chosen {
            NONE => values.greatest().is_none(),
            chosen => best(usize::from(chosen)),
        };
        self.tally.steps += 1;
        self.tally.differences += u32::from(!agrees);
        values
    }

    /// What the program chose, unless it has no answer or chance says otherwise.
    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (other, explores) = explorer.choose(values);
        let chosen = Action::new(usize::from(self.chosen)).filter(|_| !explores);
        if chosen.is_none() {
            self.say(b'a', [other.index() as u8, 0], 0);
        }
        Choice::new(chosen.unwrap_or(other), Chooser::Rules)
    }

    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        self.felt = [
            matches!(outcome, Outcome::Collided { .. }),
            outcome.found() > 0.0,
        ];
        self.frozen.update(action, outcome)
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.say(b'r', [0, 0], 0);
        self.frozen.end_episode(reached_goal)
    }

    fn step_threshold(&self) -> u32 {
        self.frozen.step_threshold()
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.frozen.values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.frozen.knowledge()
    }

    fn rule_count(&self) -> usize {
        self.frozen.rule_count()
    }
}

/// The likeliest state or place of a learner, the first of several, or the number of none.
fn likeliest(frozen: &Frozen) -> u16 {
    let json = serde_json::to_value(frozen).unwrap();
    let belief = match frozen.knowledge().remembers() {
        true => &json["tracker"]["belief"],
        false => &json["belief"]["places"],
    };
    let belief: Vec<(Option<u16>, f64)> = serde_json::from_value(belief.clone()).unwrap();
    let better = |best: (_, f64), one: (_, f64)| if one.1 > best.1 { one } else { best };
    let best = belief.into_iter().reduce(better);
    best.and_then(|best| best.0).unwrap_or(u16::MAX)
}

/// Drives straight and with random steps, and finds no difference.
pub fn drives_alike(name: &str, learned: &Learned, program: &mut Command) {
    let straight = learned.driven(program, 1, 0.0);
    assert_eq!(straight.reached, straight.episodes, "{name}: {straight:?}");
    for tally in [straight, learned.driven(program, 8, 0.3)] {
        assert_eq!(tally.differences, 0, "{name}: {tally:?}");
        assert_eq!(tally.elsewhere, 0, "{name}: {tally:?}");
    }
}

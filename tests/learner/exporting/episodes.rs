//! Whole episodes of a learner with a map, retold to an exported program.

use xcscr::agent::{Agent, Explorer, Frozen};
use xcscr::arena::Outcome;
use xcscr::trial::Plan;
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

use super::program::{Program, Questions};
use crate::learned::Learned;

/// The likeliest state is compared every so many steps: that takes long.
const COMPARED_EVERY: usize = 5;

/// What a learner perceived in some episodes, and what it made of that in each step: the best actions, and
/// in some steps the likeliest state.
pub struct Drive {
    questions: Questions,
    expected: Vec<(Vec<usize>, Option<u16>)>,
}

/// The steps in which a program chose another action than the learner does, and those in which another state
/// was likeliest for it.
#[derive(Debug, Default, PartialEq)]
pub struct Differences {
    pub actions: usize,
    pub states: usize,
}

impl Drive {
    /// Drives from all starts, as often as asked, and each step in `chance` by chance. Without chance all
    /// episodes must end in a goal.
    pub fn new(learned: &Learned, times: u32, chance: f64) -> Self {
        let Plan { maze, config } = &learned.plan;
        let limit = config.settings.reward.step_threshold;
        let mut frozen = Frozen::new(learned.knowledge.clone(), maze.action_count(), limit);
        let mut arena = config.build_arena(maze).unwrap();
        let mut explorer = Explorer::new(chance, Stream::new(7, 0_u64));
        let (mut questions, mut expected) = (Questions::default(), Vec::new());
        for start in (0..times).flat_map(|_| maze.start_cells()) {
            arena.reset(start);
            questions.ask('r', &[]);
            let (mut felt, mut reached) = ([0, 0], false);
            for _ in 0..limit {
                let percept = config.sensor.perceive(&arena.view());
                let values = frozen.observe(&percept);
                questions.ask('t', &[percept.words()[0], felt[0], felt[1]]);
                let is_compared = expected.len().is_multiple_of(COMPARED_EVERY);
                let state = is_compared.then(|| likeliest(&frozen));
                let best: Vec<usize> = values.best_actions().map(Action::index).collect();
                let action = frozen.choose(&values, &mut explorer).action;
                // What the program chose by itself, it knows.
                if best != [action.index()] {
                    questions.ask('o', &[action.index() as u64]);
                }
                expected.push((best, state));
                let outcome = arena.act(action);
                frozen.update(action, outcome);
                let bumped = matches!(outcome, Outcome::Collided { .. });
                felt = [bumped, outcome.found() > 0.0].map(u64::from);
                reached = outcome == Outcome::ReachedGoal;
                if reached {
                    break;
                }
            }
            assert!(reached || chance > 0.0, "no goal from {start:?}");
            frozen.end_episode(reached);
        }
        Self {
            questions,
            expected,
        }
    }

    /// Asks a program the same, and compares its answers.
    pub fn differences(&self, program: &Program) -> Differences {
        let answers = program.answers(&self.questions);
        assert_eq!(answers.len(), self.expected.len());
        let mut found = Differences::default();
        for (answer, (best, likeliest)) in answers.iter().zip(&self.expected) {
            let (action, state) = answer.split_once(' ').unwrap();
            let agrees = match action.parse() {
                Ok(action) => best.contains(&action),
                Err(_) => best.is_empty(),
            };
            let is_there = likeliest.is_none_or(|likeliest| state.parse() == Ok(likeliest));
            found.actions += usize::from(!agrees);
            found.states += usize::from(!is_there);
        }
        found
    }
}

/// The likeliest state of a learner, the first of several, or the number of none.
fn likeliest(frozen: &Frozen) -> u16 {
    let json = serde_json::to_value(frozen).unwrap();
    let belief = json["tracker"]["belief"].clone();
    let belief: Vec<(Option<u16>, f64)> = serde_json::from_value(belief).unwrap();
    let better = |best: (_, f64), one: (_, f64)| if one.1 > best.1 { one } else { best };
    let best = belief.into_iter().reduce(better);
    best.and_then(|best| best.0).unwrap_or(u16::MAX)
}

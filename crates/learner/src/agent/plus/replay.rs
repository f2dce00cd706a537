//! Replay: imprinting (Alg. 4) with a plan in place of \[PS\], and guided covering.

use xcs::random::Stream;
use xcs::{Action, LabelledExample, LabelledExamples, Layout, MatchSet, Percept, Xcs};

/// The number of replayed updates after each step, and at the end of an episode for each percept in each round.
const UPDATES: usize = 30;
/// The number of known percepts that are checked after each step, in turn.
const CHECKS_PER_STEP: usize = 64;
/// The maximum number of rounds of replay at the end of an episode.
const REPLAY_ROUNDS: usize = 4;
/// The maximum number of rounds of guided covering after them. A correction can make another percept wrong, so that in
/// a maze of long corridors 4 rounds were too few.
const COVERING_ROUNDS: usize = 16;
/// The number of percepts that guided covering generalises at the end of an episode, whether they are decided rightly
/// or not. With fewer, more rules are needed: 17 in place of 14 in Maze5 with 2.
const GENERALISED: usize = 8;

/// The share of the way from the payoff of a failure to that of a success, above which a prediction is sure.
const SURE: f64 = 0.95;

/// Trains a classifier system to choose the best actions of a plan.
///
/// On a shortest path, every step has the full reward of a success (Eq. 8 with the length of the path as c). So the
/// payoff of a best action is the reward of a success, and that of any other action is the reward of a failure.
#[derive(Debug, Clone)]
pub struct Replay {
    params: ReplayParams,
    /// The known percepts with their best actions, by the number of the percept.
    examples: LabelledExamples,
    /// The numbers of the known percepts, in the order of their first appearance.
    known: Vec<usize>,
    /// The known percepts that were decided wrongly when they were last checked.
    wrong: Vec<usize>,
    /// The place in `known` of the percept that was checked last.
    checked: usize,
    match_set: MatchSet,
    stream: Stream,
}

/// Parameters of [`Replay`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayParams {
    /// False switches replay and guided covering off.
    pub replays: bool,
    /// True if guided covering adds rules.
    pub covers: bool,
    /// The payoff of a best action.
    pub success: f64,
    /// The payoff of any other action.
    pub failure: f64,
    /// The learning rate.
    pub beta: f64,
}

impl Replay {
    /// Creates a replay without known percepts. `layout` lists the numbers in a percept.
    pub fn new(params: ReplayParams, layout: Layout, stream: Stream) -> Self {
        Self {
            params,
            examples: LabelledExamples::new(layout),
            known: Vec::new(),
            wrong: Vec::new(),
            checked: 0,
            match_set: MatchSet::default(),
            stream,
        }
    }

    /// Adds percepts with their best actions, or changes the best actions.
    pub fn learn(&mut self, examples: Vec<(usize, LabelledExample)>) {
        for (number, example) in examples {
            if self.examples.get(number).is_none() {
                self.known.push(number);
            }
            self.examples.give(number, example);
        }
    }

    /// Replays updates after a step: in percepts that are decided wrongly, or else in any known percept. If the `next`
    /// percept is still decided wrongly, guided covering corrects it.
    pub fn after_step(&mut self, xcs: &mut Xcs, next: Option<&Percept>) {
        if self.is_idle() {
            return;
        }
        self.check_some(xcs);
        for _ in 0..UPDATES {
            let among = if self.wrong.is_empty() {
                &self.known
            } else {
                &self.wrong
            };
            if let Some(&number) = self.stream.choose(among) {
                self.replay_any_action(xcs, number);
            }
        }
        let is_next = |&&number: &&usize| {
            let example = self.examples.get(number);
            example.is_some_and(|example| Some(&example.percept) == next)
        };
        let next = self.wrong.iter().find(is_next).copied();
        if let Some(next) = next.filter(|&next| self.params.covers && !self.is_right(xcs, next)) {
            self.correct(xcs, next);
        }
    }

    /// Replays updates at the end of an episode until all known percepts are decided rightly, or the budget is spent.
    /// Then guided covering generalises some percepts, and corrects all that are still decided wrongly
    /// or not surely.
    pub fn after_episode(&mut self, xcs: &mut Xcs) {
        if self.is_idle() {
            return;
        }
        for _ in 0..REPLAY_ROUNDS {
            for number in self.check_all(xcs) {
                for _ in 0..UPDATES {
                    if !self.is_right(xcs, number) {
                        self.replay_any_action(xcs, number);
                    }
                }
            }
        }
        if !self.params.covers {
            return;
        }
        for _ in 0..GENERALISED {
            if let Some(&number) = self.stream.choose(&self.known) {
                self.generalise(xcs, number);
            }
        }
        for _ in 0..COVERING_ROUNDS {
            for number in self.known.clone() {
                if !self.is_sure(xcs, number) {
                    self.correct(xcs, number);
                }
            }
        }
    }

    /// Returns true if there is nothing to replay.
    fn is_idle(&self) -> bool {
        self.known.is_empty() || !self.params.replays
    }

    /// Checks the percepts that were wrong, and the next known percepts in turn.
    fn check_some(&mut self, xcs: &Xcs) {
        let mut wrong = std::mem::take(&mut self.wrong);
        wrong.retain(|&number| !self.is_right(xcs, number));
        for _ in 0..CHECKS_PER_STEP.min(self.known.len()) {
            self.checked = (self.checked + 1) % self.known.len();
            let number = self.known[self.checked];
            if !wrong.contains(&number) && !self.is_right(xcs, number) {
                wrong.push(number);
            }
        }
        self.wrong = wrong;
    }

    /// Checks all known percepts, and returns those that are decided wrongly.
    fn check_all(&mut self, xcs: &Xcs) -> Vec<usize> {
        let all = self.known.iter().copied();
        self.wrong = all.filter(|&number| !self.is_right(xcs, number)).collect();
        self.wrong.clone()
    }

    /// Returns true if the rules choose only best actions in a percept.
    fn is_right(&self, xcs: &Xcs, number: usize) -> bool {
        let example = self.examples.get(number);
        example.is_none_or(|example| example.agrees_with(&xcs.values(&example.percept)))
    }

    /// Returns true if the rules choose only best actions in a percept, and predict almost a success.
    fn is_sure(&self, xcs: &Xcs, number: usize) -> bool {
        let value = |example: &LabelledExample| xcs.values(&example.percept).greatest();
        let value = self.examples.get(number).and_then(value);
        let least = self.params.failure + SURE * (self.params.success - self.params.failure);
        self.is_right(xcs, number) && value.is_none_or(|value| value >= least)
    }

    /// Updates \[A\] of a percept and a random action toward its payoff (Alg. 4), and runs the GA there.
    fn replay_any_action(&mut self, xcs: &mut Xcs, number: usize) {
        let actions: Vec<Action> = Action::all(xcs.actions()).collect();
        let drawn = self.stream.choose(&actions).copied();
        if let Some((example, action)) = self.examples.get(number).copied().zip(drawn) {
            xcs.form_match_set(&example.percept, &mut self.match_set);
            let set = self.match_set.action_set(action);
            let set = set.expect("the match set was formed in the line before");
            xcs.update(&set, self.payoff(&example, action), self.params.beta);
            xcs.evolve(&set);
        }
    }

    fn payoff(&self, example: &LabelledExample, action: Action) -> f64 {
        match example.best[action.index()] {
            true => self.params.success,
            false => self.params.failure,
        }
    }

    /// Adds the most general correct rule for each best action of a percept.
    fn generalise(&mut self, xcs: &mut Xcs, number: usize) {
        if let Some(example) = self.examples.get(number).copied() {
            example
                .best_actions()
                .for_each(|action| self.cover(xcs, number, action));
        }
    }

    /// Adds the most general correct rule for each action of a percept, and updates the other rules there until they
    /// have lost their weight. After each update follows one in a random known percept. Without it, a general rule that
    /// is wrong in other percepts looks accurate after many updates in this one.
    fn correct(&mut self, xcs: &mut Xcs, number: usize) {
        let Some(example) = self.examples.get(number).copied() else {
            return;
        };
        Action::all(xcs.actions()).for_each(|action| self.cover(xcs, number, action));
        for _ in 0..UPDATES {
            if self.is_sure(xcs, number) {
                return;
            }
            self.update_all_actions(xcs, &example);
            let other = self.stream.choose(&self.known);
            let other = other.and_then(|&number| self.examples.get(number).copied());
            other
                .iter()
                .for_each(|other| self.update_all_actions(xcs, other));
        }
    }

    /// Updates the rules of every action in a percept toward their payoffs, without subsumption and without the GA.
    fn update_all_actions(&self, xcs: &mut Xcs, example: &LabelledExample) {
        for action in Action::all(xcs.actions()) {
            let set = xcs.matching_action_set(&example.percept, action);
            xcs.update_statistics(&set, self.payoff(example, action), self.params.beta);
        }
    }

    /// Guided covering: adds the most general rule for a percept and an action that no known percept contradicts.
    fn cover(&mut self, xcs: &mut Xcs, number: usize, action: Action) {
        let Some(example) = self.examples.get(number) else {
            return;
        };
        let is_best = example.best[action.index()];
        if let Some(condition) = self.examples.general_condition(number, action, is_best) {
            xcs.teach(condition, action, self.payoff(example, action));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::ByAction;
    use xcscr_robot::streams::StreamName;

    /// Teaches the 6-multiplexer as a decision between two actions, and returns the percepts that are decided rightly
    /// after an episode without steps.
    fn decided_rightly(params: ReplayParams) -> usize {
        let stream = |name| Stream::new(1, name);
        let xcs_params = xcs::Params {
            dont_care: 0.5,
            ..xcs::Params::default()
        };
        let mut xcs = Xcs::new(xcs_params, 2, stream(StreamName::Evolution));
        let mut replay = Replay::new(params, Layout::default(), stream(StreamName::Replay));
        let example = |number: usize| {
            let percept = xcs::Percept::from_word(number as u64, 6);
            let address = usize::from(percept.bit(0)) * 2 + usize::from(percept.bit(1));
            let mut best = ByAction::default();
            best[usize::from(percept.bit(2 + address))] = true;
            (number, LabelledExample { percept, best })
        };
        replay.learn((0..64).map(example).collect());
        replay.after_episode(&mut xcs);
        64 - replay.check_all(&xcs).len()
    }

    const PARAMS: ReplayParams = ReplayParams {
        replays: true,
        covers: true,
        success: 1000.0,
        failure: 0.0,
        beta: 0.2,
    };

    #[test]
    fn guided_covering_decides_every_known_percept_rightly_where_replay_alone_does_not() {
        assert_eq!(decided_rightly(PARAMS), 64);
        let without_covering = ReplayParams {
            covers: false,
            ..PARAMS
        };
        let alone = decided_rightly(without_covering);
        assert!((1..64).contains(&alone), "control: {alone} of 64");
        let without_replay = ReplayParams {
            replays: false,
            ..PARAMS
        };
        let off = decided_rightly(without_replay);
        assert_eq!(off, 0, "control: no replay");
    }
}

//! Repair: corrects the rules where experience contradicts them.
//!
//! While the rules decide, two events contradict them: a collision, and a place that the robot visits for the second time
//! in an episode. After each of them, and at the end of an episode in every percept that was visited, the rules are
//! compared with the plan of the model. Where they choose an action that the plan calls worse, guided covering adds the
//! most general rules that no known percept contradicts. After a failure, all known percepts are compared.

use std::collections::BTreeSet;

use crate::agent::{Params, Transition};
use xcs::random::Stream;
use xcs::{Action, LabelledExample, LabelledExamples, Layout, Xcs};
use xcscr_robot::arena::Outcome;
use xcscr_robot::world::Cell;

/// The maximum number of updates for the correction of a percept.
const UPDATES: usize = 30;
/// The maximum number of rounds of corrections at the end of an episode. A correction can make another percept wrong.
const ROUNDS: usize = 16;
/// The maximum number of corrections at the end of an episode, for each of its steps.
const CORRECTIONS: usize = 4;
/// The share of the way from the payoff of a failure to that of a success, above which a prediction is sure.
const SURE: f64 = 0.95;

/// Compares a classifier system with a plan, and corrects it.
///
/// On a shortest path, every step has the full reward of a success (Eq. 8 with the length of the path as c). So the
/// payoff of a best action is the reward of a success, and that of any other action is the reward of a failure.
#[derive(Debug, Clone)]
pub struct Repair {
    /// The payoff of a best action.
    success: f64,
    /// The payoff of any other action.
    failure: f64,
    /// The learning rate.
    beta: f64,
    /// The known percepts with their best actions, by the number of the percept.
    examples: LabelledExamples,
    /// The numbers of the known percepts, in the order of their first appearance.
    known: Vec<usize>,
    /// The numbers of the percepts that were visited in this episode.
    visited: BTreeSet<usize>,
    /// The places of this episode.
    places: BTreeSet<Cell>,
    /// The steps of this episode.
    steps: usize,
    /// The number of updates of rules, and of rules added.
    updates: u64,
    stream: Stream,
}

impl Repair {
    /// Creates a repair without known percepts. `layout` lists the numbers in a percept.
    pub fn new(rewards: &Params, layout: Layout, stream: Stream) -> Self {
        Self {
            success: rewards.goal,
            failure: rewards.failure,
            beta: rewards.beta_success,
            examples: LabelledExamples::new(layout),
            known: Vec::new(),
            visited: BTreeSet::new(),
            places: BTreeSet::new(),
            steps: 0,
            updates: 0,
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

    /// Notes a step from the percept with a number. Returns true if it contradicts the rules, which decided it: a
    /// collision, or a step from a place that was visited before.
    pub fn is_contradicted(&mut self, step: &Transition<'_>, number: usize) -> bool {
        self.steps += 1;
        let was_new = self.visited.insert(number);
        // Without places, percepts tell places apart.
        let is_second = step
            .place
            .map_or(!was_new, |place| !self.places.insert(place));
        is_second || matches!(step.outcome, Outcome::Collided { .. })
    }

    /// Corrects percepts that the rules decide wrongly.
    pub fn correct(&mut self, xcs: &mut Xcs, numbers: impl IntoIterator<Item = usize>) {
        for number in numbers {
            if !self.is_right(xcs, number) {
                self.correct_one(xcs, number);
            }
        }
    }

    /// Ends an episode: corrects the percepts that were visited, or after a failure all known ones, until the rules are
    /// sure in all of them, or the budget is spent, which grows with the steps of the episode.
    pub fn end_episode(&mut self, xcs: &mut Xcs, reached_goal: bool) {
        let visited = std::mem::take(&mut self.visited);
        self.places.clear();
        let numbers: Vec<usize> = match reached_goal {
            true => visited.into_iter().collect(),
            false => self.known.clone(),
        };
        let mut budget = CORRECTIONS * std::mem::take(&mut self.steps);
        for _ in 0..ROUNDS {
            let before = budget;
            for &number in &numbers {
                if budget > 0 && !self.is_sure(xcs, number) {
                    self.correct_one(xcs, number);
                    budget -= 1;
                }
            }
            if budget == before {
                return;
            }
        }
    }

    /// Returns true if the rules choose only best actions in a percept.
    fn is_right(&self, xcs: &Xcs, number: usize) -> bool {
        let example = self.examples.get(number);
        example.is_none_or(|example| example.agrees_with(&xcs.values(&example.percept)))
    }

    /// Returns true if the rules choose only best actions in a percept, and predict almost a success.
    fn is_sure(&self, xcs: &Xcs, number: usize) -> bool {
        let Some(example) = self.examples.get(number) else {
            return true;
        };
        let values = xcs.values(&example.percept);
        let least = self.failure + SURE * (self.success - self.failure);
        example.agrees_with(&values) && values.greatest().is_none_or(|value| value >= least)
    }

    /// Adds the most general correct rule for each action of a percept, and updates the other rules there until they
    /// have lost their weight. After each update follows one in a random known percept. Without it, a general rule that
    /// is wrong in other percepts looks accurate after many updates in this one.
    fn correct_one(&mut self, xcs: &mut Xcs, number: usize) {
        let Some(example) = self.examples.get(number).copied() else {
            return;
        };
        for action in Action::all(xcs.actions()) {
            let is_best = example.best[action.index()];
            let condition = self.examples.general_condition(number, action, is_best);
            if let Some(condition) = condition {
                xcs.teach(condition, action, self.payoff(&example, action));
                self.updates += 1;
            }
        }
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

    /// Returns the number of updates of rules so far, and of rules added.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// Updates the rules of every action in a percept toward their payoffs, without subsumption and without the GA.
    fn update_all_actions(&mut self, xcs: &mut Xcs, example: &LabelledExample) {
        for action in Action::all(xcs.actions()) {
            let set = xcs.matching_action_set(&example.percept, action);
            xcs.update_statistics(&set, self.payoff(example, action), self.beta);
            self.updates += 1;
        }
    }

    fn payoff(&self, example: &LabelledExample, action: Action) -> f64 {
        match example.best[action.index()] {
            true => self.success,
            false => self.failure,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::{ByAction, Percept};
    use xcscr_robot::streams::StreamName;

    const PERCEPTS: usize = 64;

    /// Knows the 6-multiplexer as a decision between two actions, and a classifier system without rules.
    fn multiplexer() -> (Repair, Xcs) {
        let stream = |name| Stream::new(1, name);
        let xcs = Xcs::new(xcs::Params::default(), 2, stream(StreamName::Evolution));
        let params = Params::default();
        let mut repair = Repair::new(&params, Layout::default(), stream(StreamName::Replay));
        let example = |number: usize| {
            let percept = Percept::from_word(number as u64, 6);
            let address = usize::from(percept.bit(0)) * 2 + usize::from(percept.bit(1));
            let mut best = ByAction::default();
            best[usize::from(percept.bit(2 + address))] = true;
            (number, LabelledExample { percept, best })
        };
        repair.learn((0..PERCEPTS).map(example).collect());
        (repair, xcs)
    }

    fn right(repair: &Repair, xcs: &Xcs) -> usize {
        let right = (0..PERCEPTS).filter(|&number| repair.is_right(xcs, number));
        right.count()
    }

    fn step(percept: &Percept, place: Cell, outcome: Outcome) -> Transition<'_> {
        Transition {
            percept,
            place: Some(place),
            action: Action::new(0).unwrap(),
            outcome,
            next: None,
        }
    }

    #[test]
    fn after_a_failure_every_known_percept_is_corrected_and_after_a_success_the_visited_ones() {
        let (mut repair, mut xcs) = multiplexer();
        assert_eq!(right(&repair, &xcs), 0, "control: there are no rules");
        repair.end_episode(&mut xcs, true);
        assert_eq!(right(&repair, &xcs), 0, "control: nothing was visited");
        let percept = Percept::from_word(7, 6);
        let place = Cell { col: 1, row: 1 };
        repair.is_contradicted(&step(&percept, place, Outcome::Moved), 7);
        repair.end_episode(&mut xcs, true);
        assert!(repair.is_right(&xcs, 7));
        let some = right(&repair, &xcs);
        assert!((1..PERCEPTS).contains(&some), "{some}");
        for number in 0..PERCEPTS {
            let percept = Percept::from_word(number as u64, 6);
            repair.is_contradicted(&step(&percept, place, Outcome::Moved), number);
        }
        repair.visited.clear();
        repair.end_episode(&mut xcs, false);
        assert_eq!(right(&repair, &xcs), PERCEPTS);
    }

    #[test]
    fn a_collision_and_a_second_visit_contradict_the_rules() {
        let (mut repair, mut xcs) = multiplexer();
        let percept = Percept::from_word(0, 6);
        let [a, b] = [1, 2].map(|col| Cell { col, row: 1 });
        let hit = Outcome::Collided { impulse_n_s: None };
        let mut contradicted =
            |place, outcome| repair.is_contradicted(&step(&percept, place, outcome), 0);
        let moved = Outcome::Moved;
        let found = [
            (a, moved),
            (b, moved),
            (a, moved),
            (Cell { col: 3, row: 1 }, hit),
        ]
        .map(|(place, outcome)| contradicted(place, outcome));
        assert_eq!(found, [false, false, true, true]);
        repair.end_episode(&mut xcs, true);
        let again = repair.is_contradicted(&step(&percept, a, moved), 0);
        assert!(!again, "in the next episode");
    }
}

//! Limits on updates per step, and waiting updates.

use crate::agent::model::transitions::Experience;
use crate::agent::planner::sweeping::*;
use xcs::Percept;
use xcs::random::Stream;
use xcscr_robot::streams::StreamName;

const PERCEPTS: usize = 200;

/// Takes random steps between percepts. Every pair leads anywhere, sometimes to a goal. Returns for
/// each step whether its pair was new, and how many values were updated.
fn updates_of_noise(steps: usize) -> (PlannedValues, Vec<(bool, usize)>) {
    let mut stream = Stream::new(1, StreamName::Exploration);
    let mut model = Transitions::default();
    let mut known = PlannedValues::new(4, &Params::default());
    let percept = |number: usize| Percept::from_word(number as u64, 8);
    let mut here = 0;
    let updates = (0..steps).map(|_| {
        let action = Action::new(stream.below(4)).unwrap();
        let there = Some(stream.below(PERCEPTS)).filter(|_| !stream.chance(0.02));
        let number = model.meet(&percept(here));
        let is_new = model.outcomes(number, action).tries() == 0;
        let reward = if there.is_none() { 999.0 } else { -1.0 };
        let step = Experience {
            percept: percept(here),
            action,
            reward,
            next: there.map(percept),
        };
        model.learn(&step, 1);
        let next = there.map(|next| model.meet(&percept(next)));
        known.learn(&model, (number, action), next);
        here = there.unwrap_or(0);
        let updated = known.touched.len();
        known.news(&model);
        (is_new, updated)
    });
    let updates = updates.collect();
    (known, updates)
}

#[test]
fn noise_updates_few_values_however_many_depend_on_them() {
    let steps = 1_500;
    let (known, updates) = updates_of_noise(steps);
    let all: usize = updates.iter().map(|&(_, updated)| updated).sum();
    let most = FIRST_UPDATES + (1 + UPDATES_PER_STEP) * steps;
    assert!(all <= most, "{all} of {most}");
    let odds = updates.iter().filter(|(is_new, _)| !is_new);
    let for_odds = odds.map(|&(_, updated)| updated).max().unwrap();
    assert_eq!(for_odds, 1 + UPDATES_FOR_ODDS);
    assert!(known.queue.len() <= MOST_ENTRIES * PERCEPTS);
    // Control: new pairs propagate to all dependent values.
    let most_at_once = updates.iter().map(|&(_, updated)| updated).max().unwrap();
    assert!(most_at_once > PERCEPTS, "{most_at_once}");
}

//! Value iteration over what is remembered.

use std::ops::Range;

use super::outcomes::{Outcome, mean};
use super::transitions::Transitions;
use xcs::{Action, MAX_ACTIONS};

/// Value iteration ends when no value changes by more than this, in units of reward ...
const PRECISION: f64 = 1e-9;
/// ... or after this many sweeps.
const MOST_SWEEPS: u32 = 1_000;

/// The value of each action, by the number of the percept.
#[derive(Debug)]
pub struct Values(Vec<[f64; MAX_ACTIONS]>);

impl Values {
    /// The values of a percept; `None` if it was not met when they were planned.
    pub fn get(&self, percept: usize) -> Option<[f64; MAX_ACTIONS]> {
        self.0.get(percept).copied()
    }
}

/// What is believed of a pair that is not known.
#[derive(Debug, Clone, Copy)]
pub enum Belief {
    /// Nothing but how likely it ends in a collision.
    Bumps(f64),
    /// The reward, and the number of the percept that follows.
    LeadsTo(f64, usize),
}

/// How values are planned: pairs that were tried `known_after` times by what followed them, all
/// others by what is believed of them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Planner {
    pub actions: usize,
    pub known_after: u32,
    pub gamma: f64,
    /// The reward of a collision.
    pub collision: f64,
}

/// Everything on which values depend, as it was when they were to be planned.
#[derive(Debug, Clone, Default)]
pub struct Problem {
    planner: Planner,
    /// How many percepts had been met.
    met: usize,
    /// In the order in which they are updated.
    open: Vec<Open>,
    /// What followed the open pairs that are known.
    seen: Vec<Outcome>,
    /// Percept and action of all other pairs, and how likely they end in a collision.
    unknown: Vec<(usize, usize, f64)>,
}

/// A pair whose value follows from those of others.
#[derive(Debug, Clone)]
struct Open {
    percept: usize,
    action: usize,
    leads_to: Leads,
}

/// What follows a pair.
#[derive(Debug, Clone)]
enum Leads {
    /// What was seen to follow: these of all outcomes.
    Seen(Range<usize>),
    /// The reward and the percept that are believed to follow.
    Believed(f64, usize),
}

/// Values while they are planned.
struct Draft {
    actions: usize,
    values: Vec<[f64; MAX_ACTIONS]>,
    /// The greatest value of each percept ...
    greatest: Vec<f64>,
    /// ... and the sweep that changed it last.
    changed: Vec<u32>,
    /// Counted from 1.
    sweep: u32,
}

impl Draft {
    /// Changes the value of a pair; gives by how much.
    fn set(&mut self, percept: usize, action: usize, value: f64) -> f64 {
        let row = &mut self.values[percept];
        let change = (value - row[action]).abs();
        if change > 0.0 {
            row[action] = value;
            let mut greatest = f64::NEG_INFINITY;
            for &value in &row[..self.actions] {
                greatest = greatest.max(value);
            }
            if greatest != self.greatest[percept] {
                self.greatest[percept] = greatest;
                self.changed[percept] = self.sweep;
            }
        }
        change
    }

    /// May the greatest value of a percept be another than when the pairs before it were updated
    /// last?
    fn is_fresh(&self, percept: usize) -> bool {
        self.sweep == 1 || self.changed[percept] + 1 >= self.sweep
    }
}

impl Planner {
    /// What is to be planned, with what is believed of pairs that are not known.
    pub fn problem(
        self,
        memory: &Transitions,
        believed: impl Fn(usize, Action) -> Belief,
    ) -> Problem {
        let mut problem = Problem {
            planner: self,
            met: memory.percepts().len(),
            ..Problem::default()
        };
        for percept in 0..problem.met {
            for action in Action::all(self.actions) {
                let outcomes = memory.outcomes(percept, action);
                if outcomes.tries() >= self.known_after {
                    let begin = problem.seen.len();
                    problem.seen.extend_from_slice(outcomes.all());
                    let seen = Leads::Seen(begin..problem.seen.len());
                    problem.add(percept, action, seen);
                    continue;
                }
                match believed(percept, action) {
                    Belief::LeadsTo(reward, to) => {
                        problem.add(percept, action, Leads::Believed(reward, to));
                    }
                    Belief::Bumps(bump) => problem.unknown.push((percept, action.index(), bump)),
                }
            }
        }
        // Backward in the order of discovery, because goals are found last.
        problem.open.reverse();
        problem
    }
}

impl Problem {
    fn add(&mut self, percept: usize, action: Action, leads_to: Leads) {
        self.open.push(Open {
            percept,
            action: action.index(),
            leads_to,
        });
    }

    /// The values, where a pair of which nothing is known is worth `unknown` unless it bumps.
    pub fn solve(&self, unknown: f64) -> Values {
        let mut draft = Draft {
            actions: self.planner.actions,
            values: vec![[0.0; MAX_ACTIONS]; self.met],
            greatest: vec![0.0; self.met],
            changed: vec![0; self.met],
            sweep: 0,
        };
        for &(percept, action, bump) in &self.unknown {
            let worth = (1.0 - bump) * unknown + bump * self.planner.collision;
            draft.set(percept, action, worth);
        }
        for _ in 0..MOST_SWEEPS {
            if self.sweep(&mut draft) < PRECISION {
                break;
            }
        }
        Values(draft.values)
    }

    /// Updates every pair by what followed it (Bellman's equation), or is believed to follow; gives
    /// the greatest change. A pair is skipped if it would get the value that it has.
    fn sweep(&self, draft: &mut Draft) -> f64 {
        draft.sweep += 1;
        let mut change: f64 = 0.0;
        for pair in &self.open {
            if let Some(value) = self.value(draft, &pair.leads_to) {
                change = change.max(draft.set(pair.percept, pair.action, value));
            }
        }
        change
    }

    /// The value of a pair; `None` if nothing has changed on which it depends.
    fn value(&self, draft: &Draft, leads_to: &Leads) -> Option<f64> {
        let gamma = self.planner.gamma;
        let after = |next: Option<usize>| next.map_or(0.0, |number| draft.greatest[number]);
        match *leads_to {
            Leads::Seen(ref range) => {
                let seen = &self.seen[range.clone()];
                let mut nexts = seen.iter().filter_map(|outcome| outcome.next);
                let is_fresh = draft.sweep == 1 || nexts.any(|next| draft.is_fresh(next));
                is_fresh.then(|| mean(seen, |o| o.reward + gamma * after(o.next)))
            }
            Leads::Believed(reward, to) => draft
                .is_fresh(to)
                .then(|| reward + gamma * draft.greatest[to]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::model::transitions::Transition;
    use crate::streams::StreamName;
    use xcs::Percept;
    use xcs::random::Stream;

    const PERCEPTS: usize = 40;
    const PLANNER: Planner = Planner {
        actions: 4,
        known_after: 1,
        gamma: 0.9,
        collision: -50.0,
    };

    /// Steps at random between so many percepts; each action leads on by its own width, and with
    /// noise also elsewhere.
    fn remembered(noise: f64, steps: usize) -> Transitions {
        let mut stream = Stream::new(1, StreamName::Exploration);
        let mut memory = Transitions::default();
        let percept = |number: usize| Percept::from_word(number as u64, 8);
        let mut here = 0;
        for _ in 0..steps {
            let action = stream.below(PLANNER.actions);
            let wide = if stream.chance(noise) {
                stream.below(7)
            } else {
                action
            };
            let there = (here + [1, 2, PERCEPTS - 1, 3][wide % 4]) % PERCEPTS;
            let is_goal = here == 0 && action == 0;
            memory.learn(
                &Transition {
                    percept: percept(here),
                    action: Action::new(action).unwrap(),
                    reward: if is_goal { 999.0 } else { -1.0 },
                    next: (!is_goal).then(|| percept(there)),
                },
                1,
            );
            here = if is_goal {
                stream.below(PERCEPTS)
            } else {
                there
            };
        }
        memory
    }

    /// Updates every pair in every sweep.
    fn without_skipping(problem: &Problem, unknown: f64) -> Vec<[f64; MAX_ACTIONS]> {
        let mut values = vec![[0.0; MAX_ACTIONS]; problem.met];
        for &(percept, action, bump) in &problem.unknown {
            values[percept][action] = (1.0 - bump) * unknown + bump * PLANNER.collision;
        }
        let (mut change, mut sweeps) = (f64::INFINITY, 0);
        while change >= PRECISION && sweeps < MOST_SWEEPS {
            (change, sweeps) = (0.0, sweeps + 1);
            for pair in &problem.open {
                let greatest =
                    |next: usize| values[next][..4].iter().copied().fold(f64::MIN, f64::max);
                let value = match pair.leads_to {
                    Leads::Seen(ref range) => mean(&problem.seen[range.clone()], |o| {
                        o.reward + PLANNER.gamma * o.next.map_or(0.0, greatest)
                    }),
                    Leads::Believed(reward, to) => reward + PLANNER.gamma * greatest(to),
                };
                let old = std::mem::replace(&mut values[pair.percept][pair.action], value);
                change = change.max((value - old).abs());
            }
        }
        values
    }

    #[test]
    fn skipping_what_has_not_changed_gives_the_values_of_all_sweeps_to_the_bit() {
        for (noise, steps) in [(0.0, 60), (0.0, 400), (0.2, 400)] {
            let memory = remembered(noise, steps);
            let problem = PLANNER.problem(&memory, |percept, action| match percept % 3 {
                0 => Belief::LeadsTo(-1.0, (percept + action.index()) % memory.percepts().len()),
                _ => Belief::Bumps(f64::from(percept as u32 % 4) / 4.0),
            });
            for unknown in [1000.0, -1e9] {
                let all = without_skipping(&problem, unknown);
                assert_eq!(problem.solve(unknown).0, all, "{noise}, {steps}, {unknown}");
            }
        }
    }
}

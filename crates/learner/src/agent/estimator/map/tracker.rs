//! The state tracker: encodes the context that rules match. It consists of the percept, the likeliest
//! cell, the collected rewards and the last two steps.

use serde::Serialize;

use crate::agent::estimator::belief::Belief;
use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::place::{NEIGHBOURS, Surroundings, around};
use crate::agent::estimator::map::state_map::{MOST_PAYING, Map, sight};
use xcs::{Action, Classifier, Percept, Population};
use xcscr_robot::arena::Outcome;

/// The bits of the percept, which come first.
pub const PERCEPT_BITS: usize = 16;
/// The bits of a coordinate: bit k is set if the coordinate is greater than `k - FURTHEST`.
pub const COORDINATE_BITS: usize = 2 * FURTHEST as usize;
/// The bits of the map number.
pub const MAP_BITS: usize = 3;
/// With observation errors: the probability that the robot is mislocalised after a move.
pub const MISLOCALISED: f64 = 1e-3;
/// The probability that an episode does not begin where all earlier ones began.
pub const BEGUN_ELSEWHERE: f64 = 0.1;
/// The bits of a step of the window: presence, action, percept.
pub const STEP_BITS: usize = 1 + 3 + PERCEPT_BITS;
/// The number of steps of the window.
const WINDOW: usize = 2;
/// All bits of a context.
pub const CONTEXT_BITS: usize =
    PERCEPT_BITS + 2 * COORDINATE_BITS + MAP_BITS + MOST_PAYING + WINDOW * STEP_BITS;

/// The ends of the percept and of the cell. Rules match later bits only if the earlier ones do not
/// suffice.
pub const PARTS: &[usize] = &[PERCEPT_BITS, PLACE_END];
/// The end of the cell with its collected rewards.
const PLACE_END: usize = CONTEXT_BITS - WINDOW * STEP_BITS;

const _: () = assert!(CONTEXT_BITS <= xcs::MAX_PERCEPT_BITS);

/// The feedback of an action, apart from the next percept.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Felt {
    /// True if the robot bumped, and stayed in its cell.
    pub bumped: bool,
    /// True if the robot collected an auxiliary reward.
    pub rewarded: bool,
}

impl From<Outcome> for Felt {
    fn from(outcome: Outcome) -> Self {
        Self {
            bumped: matches!(outcome, Outcome::Collided { .. }),
            rewarded: outcome.found() > 0.0,
        }
    }
}

/// The history of an episode, as far as it is needed.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tracker {
    belief: Belief,
    /// The current percept; with observation errors, the expected percept of the likeliest state.
    now: Option<Percept>,
    /// The last percepts and actions, the latest last.
    window: [Option<(Percept, Action)>; WINDOW],
    /// The last action and its feedback.
    acted: Option<(Action, Felt)>,
    /// The number of rewards collected.
    found: u32,
}

impl Tracker {
    /// Returns the current belief.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Creates a tracker at the beginning of an episode.
    pub fn begun(belief: Belief) -> Self {
        Self {
            belief,
            ..Self::default()
        }
    }

    /// Creates a tracker for an episode that begins with a percept.
    pub fn at_start(map: &Map, percept: &Percept) -> Self {
        let mut tracker = Self::default();
        tracker.perceive(map, percept);
        tracker
    }

    /// Creates a tracker in a known state, before any action.
    pub fn standing(map: &Map, state: u32) -> Self {
        let found = map.states[state as usize].collected.count_ones();
        let mut tracker = Self {
            found,
            ..Self::begun(Belief::even([state]))
        };
        tracker.perceive_rightly(map, map.pomdp.percept(state));
        tracker
    }

    /// Updates the belief with a percept, of which the first sixteen bits count.
    pub fn perceive(&mut self, map: &Map, percept: &Percept) {
        if let (None, Some(begin)) = (self.now, map.begin) {
            self.belief = map.first_belief(begin);
        }
        match map.observation_error > 0.0 {
            true => self.perceive_noisy(map, percept),
            false => self.perceive_rightly(map, percept),
        }
    }

    /// Updates the belief with a noisy percept, weighted by its likelihood in each state. The expected
    /// percept of the likeliest state becomes the current percept.
    fn perceive_noisy(&mut self, map: &Map, percept: &Percept) {
        let acted = self.acted.take();
        if acted.is_some_and(|(_, felt)| felt.rewarded) {
            self.found = (self.found + 1).min(map.rewards());
        }
        let (expected, mislocalised) = match acted {
            Some((action, felt)) => {
                let possible = |from, to| map.unfelt || (from == to) == felt.bumped;
                let expected = self.belief.after(&map.pomdp, action, possible);
                (expected, MISLOCALISED)
            }
            None => (std::mem::take(&mut self.belief), BEGUN_ELSEWHERE),
        };
        let (seen, found) = (around(percept), self.found);
        let mut likely = [1.0; NEIGHBOURS.len() + 2];
        (1..likely.len())
            .for_each(|errors| likely[errors] = likely[errors - 1] * map.observation_error);
        let fits = |state: u32| {
            let map_state = &map.states[state as usize];
            let wrong = usize::from(map_state.collected.count_ones() != found);
            likely[mismatches(map, state, &seen) + wrong]
        };
        let anywhere = map.pomdp.states() as u32;
        self.belief = Belief::weighed(&expected, mislocalised, anywhere, fits);
        let there = self.belief.likeliest().map(|(state, _)| {
            let there = map.pomdp.percept(state);
            Percept::from_word(there.words()[0], PERCEPT_BITS)
        });
        self.now =
            Some(there.unwrap_or_else(|| Percept::from_word(percept.words()[0], PERCEPT_BITS)));
    }

    /// Updates the belief with a percept that is treated as correct.
    pub fn perceive_rightly(&mut self, map: &Map, percept: &Percept) {
        let percept = Percept::from_word(percept.words()[0], PERCEPT_BITS);
        let acted = self.acted.take();
        let after = acted.and_then(|(action, felt)| {
            let found = felt.rewarded;
            // An unexpected or missing reward still carries information about the robot's cell.
            let counts = [
                self.found + u32::from(found),
                self.found + u32::from(!found),
            ];
            let after = |found: u32| {
                let look = map.pomdp.look_of(&sight(&percept, found));
                let fits = |_, next| Some(map.pomdp.look(next)) == look;
                (found, self.belief.after(&map.pomdp, action, fits))
            };
            counts
                .map(after)
                .into_iter()
                .find(|(_, after)| !after.is_empty())
        });
        let begun = || {
            let look = map.pomdp.look_of(&sight(&percept, self.found));
            let fits = |state: &(u32, f64)| Some(map.pomdp.look(state.0)) == look;
            let known = !self.belief.is_empty() && self.belief.states().iter().all(fits);
            (acted.is_none() && known).then(|| (self.found, self.belief.clone()))
        };
        let relocalised = || {
            let found = acted.is_some_and(|(_, felt)| felt.rewarded);
            let found = (self.found + u32::from(found)).min(map.rewards());
            (found, relocalised(map, &percept, found))
        };
        (self.found, self.belief) = after.or_else(begun).unwrap_or_else(relocalised);
        self.now = Some(percept);
    }

    /// Records an action on the current percept, and its feedback.
    pub fn act(&mut self, action: Action, felt: Felt) {
        if let Some(percept) = self.now {
            self.window.rotate_left(1);
            self.window[WINDOW - 1] = Some((percept, action));
        }
        self.acted = Some((action, felt));
    }

    /// Returns the context that rules match, as bits.
    pub fn context(&self, map: &Map) -> Percept {
        let percept = self.now.unwrap_or(Percept::from_word(0, PERCEPT_BITS));
        let map_state = self
            .belief
            .likeliest()
            .map(|(state, _)| map.states[state as usize]);
        let map_state = map_state.unwrap_or_default();
        let mut context = percept
            .followed_by(&unary(map_state.place.east))
            .followed_by(&unary(map_state.place.north))
            .followed_by(&Percept::from_word(map_state.cell_map.into(), MAP_BITS))
            .followed_by(&Percept::from_word(map_state.collected.into(), MOST_PAYING));
        for step in self.window.iter().rev() {
            context = context.followed_by(&step_bits(*step));
        }
        context
    }
}

/// The part of a context that rules may match.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// The percept and the likeliest cell with its collected rewards.
    Place,
    /// In addition, the last two steps.
    Steps,
}

impl View {
    /// Returns the views that rules on a map may have, the narrowest first.
    pub fn fit_for(map: &Map) -> &'static [Self] {
        match map.observation_error > 0.0 {
            true => &[Self::Place, Self::Steps],
            false => &[Self::Steps],
        }
    }

    /// Returns the number of bits of a context that are visible.
    fn bits(self) -> usize {
        match self {
            Self::Place => PLACE_END,
            Self::Steps => CONTEXT_BITS,
        }
    }

    /// Returns the rules that match only visible bits.
    pub fn part_of(self, rules: &Population) -> Population {
        let beyond = |rule: &Classifier| {
            (self.bits()..CONTEXT_BITS).any(|bit| rule.condition.allele(bit).is_some())
        };
        let part = rules.rules().iter().filter(|rule| !beyond(rule)).copied();
        let part = part.collect::<Vec<_>>().try_into();
        part.expect("part of a valid population is valid")
    }

    /// Returns the context with all invisible bits set to zero.
    pub fn of(self, context: &Percept) -> Percept {
        let seen = self.bits();
        let bits = (0..CONTEXT_BITS).map(|bit| bit < seen && context.bit(bit));
        Percept::from_bits(bits).expect("as many bits as before")
    }
}

/// Encodes a coordinate in unary: its difference from the least coordinate.
fn unary(coordinate: i16) -> Percept {
    let ones = i32::from(coordinate) + i32::from(FURTHEST);
    let word = |ones: i32| match ones.clamp(0, 64) as u32 {
        0 => 0,
        ones => u64::MAX >> (64 - ones),
    };
    let high = Percept::from_word(word(ones - 64), COORDINATE_BITS - 64);
    Percept::from_word(word(ones), 64).followed_by(&high)
}

fn step_bits(step: Option<(Percept, Action)>) -> Percept {
    let bits = step.map_or(0, |(percept, action)| {
        1 | (action.index() as u64) << 1 | percept.words()[0] << 4
    });
    Percept::from_word(bits, STEP_BITS)
}

/// Returns the uniform belief over the states with this percept and number of rewards. If there are none,
/// returns it over the states with the most similar percept.
fn relocalised(map: &Map, percept: &Percept, found: u32) -> Belief {
    let pomdp = &map.pomdp;
    if let Some(look) = pomdp.look_of(&sight(percept, found)) {
        return Belief::even(pomdp.aliased(look));
    }
    let seen = around(percept);
    let mismatches = |state: u32| mismatches(map, state, &seen);
    let states = 0..pomdp.states() as u32;
    let states = states.filter(|&state| map.states[state as usize].collected.count_ones() == found);
    let least = states.clone().map(mismatches).min();
    match least {
        Some(least) => Belief::even(states.filter(|&state| mismatches(state) == least)),
        None => Belief::default(),
    }
}

/// Returns the number of cells in which a percept differs from the percept of a state.
fn mismatches(map: &Map, state: u32, seen: &Surroundings) -> usize {
    let there = around(map.pomdp.percept(state));
    (0..NEIGHBOURS.len())
        .filter(|&at| there[at] != seen[at])
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::place::Place;
    use crate::agent::estimator::map::state_map::MapState;
    use crate::agent::model::pomdp::Pomdp;

    /// Three aliased cells: the action bumps in the first, and leads from the second to the third.
    fn aliased(unfelt: bool) -> Map {
        let seen = [sight(&Percept::from_word(0, PERCEPT_BITS), 0); 3];
        let map_state = |east| MapState {
            place: Place::new(east, 1),
            ..MapState::default()
        };
        Map {
            pomdp: Pomdp::new(1, 0.0, &seen, |state, _| [0, 2, 2][state]),
            states: [0, 1, 2].map(map_state).into(),
            observation_error: 0.02,
            begin: None,
            unfelt,
        }
    }

    /// Returns the likely states of a robot that was in the first or second cell, with or without a bump.
    fn likely(map: &Map, bumped: bool) -> Vec<u32> {
        let mut tracker = Tracker::begun(Belief::even([0, 1]));
        tracker.perceive(map, &Percept::from_word(0, PERCEPT_BITS));
        let rewarded = false;
        tracker.act(Action::new(0).unwrap(), Felt { bumped, rewarded });
        tracker.perceive(map, &Percept::from_word(0, PERCEPT_BITS));
        let states = tracker.belief().states().iter();
        let likely = states.filter(|(_, weight)| *weight > 0.1);
        likely.map(|(state, _)| *state).collect()
    }

    #[test]
    fn a_bump_distinguishes_two_aliased_cells_if_the_robot_has_a_bumper() {
        let map = aliased(false);
        assert_eq!([likely(&map, true), likely(&map, false)], [[0], [2]]);
        let map = aliased(true);
        assert_eq!(likely(&map, true), [0, 2]);
        assert_eq!(likely(&map, false), [0, 2]);
    }

    /// Two states with different percepts. In the second, `rewards` rewards are collected.
    fn paying(rewards: u32, observation_error: f64) -> Map {
        let look = |word, found| sight(&Percept::from_word(word, PERCEPT_BITS), found);
        let map_state = |collected| MapState {
            collected,
            ..MapState::default()
        };
        Map {
            pomdp: Pomdp::new(1, 0.0, &[look(0, 0), look(1, rewards)], |_, _| 1),
            states: vec![map_state(0), map_state((1 << rewards) - 1)],
            observation_error,
            begin: None,
            unfelt: false,
        }
    }

    /// Returns the number of rewards counted after a step with a reward and an unknown percept.
    fn counted(map: &Map) -> u32 {
        let mut tracker = Tracker::begun(Belief::even([0]));
        tracker.perceive(map, &Percept::from_word(0, PERCEPT_BITS));
        let (bumped, rewarded) = (false, true);
        tracker.act(Action::new(0).unwrap(), Felt { bumped, rewarded });
        tracker.perceive(map, &Percept::from_word(0b1111, PERCEPT_BITS));
        tracker.found
    }

    #[test]
    fn a_reward_on_a_step_that_mislocalises_counts_if_the_map_has_one() {
        for observation_error in [0.0, 0.02] {
            assert_eq!(
                counted(&paying(1, observation_error)),
                1,
                "{observation_error}"
            );
            assert_eq!(
                counted(&paying(0, observation_error)),
                0,
                "no reward on the map, {observation_error}"
            );
        }
    }
}

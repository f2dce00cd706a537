//! What a rule looks at: the percept, the likeliest place on the map, what was found there, and the
//! last two steps.

use serde::Serialize;

use crate::agent::estimator::belief::Belief;
use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::place::{NEIGHBOURS, Surroundings, around};
use crate::agent::estimator::map::state_map::{MOST_PAYING, Map, sight};
use xcs::{Action, Classifier, Percept, Population};
use xcscr_robot::arena::Outcome;

/// The bits of the percept that come first.
pub const PERCEPT_BITS: usize = 16;
/// The bits of a coordinate: bit k says that it is greater than `k - FURTHEST`.
pub const COORDINATE_BITS: usize = 2 * FURTHEST as usize;
/// The bits of a map's number.
pub const MAP_BITS: usize = 3;
/// Where cells are misread: the probability that the robot is not where its moves should have led it.
pub const MISLOCALISED: f64 = 1e-3;
/// The same for the place in which episodes always began so far.
pub const BEGUN_ELSEWHERE: f64 = 0.1;
/// The bits of a step of the window: was there one, its action, its percept.
pub const STEP_BITS: usize = 1 + 3 + PERCEPT_BITS;
/// The steps of the window.
const WINDOW: usize = 2;
/// All bits of a context.
pub const CONTEXT_BITS: usize =
    PERCEPT_BITS + 2 * COORDINATE_BITS + MAP_BITS + MOST_PAYING + WINDOW * STEP_BITS;

/// Where the percept and the place end: rules look at what comes after only where that does not suffice.
pub const PARTS: &[usize] = &[PERCEPT_BITS, PLACE_END];
/// Where the place ends, with what was found there.
const PLACE_END: usize = CONTEXT_BITS - WINDOW * STEP_BITS;

const _: () = assert!(CONTEXT_BITS <= xcs::MAX_PERCEPT_BITS);

/// What came of an action, beside what is perceived after it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Felt {
    /// Did the robot bump, and stay where it was?
    pub bumped: bool,
    /// Did it find an auxiliary reward?
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

/// What was perceived and done so far in an episode, as far as it matters.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tracker {
    belief: Belief,
    /// What is perceived now; where cells are misread, what should be in the likeliest place.
    now: Option<Percept>,
    /// What was perceived and done, the latest last.
    window: [Option<(Percept, Action)>; WINDOW],
    /// What was done last, and what came of it.
    acted: Option<(Action, Felt)>,
    /// How many rewards of the map were found.
    found: u32,
}

impl Tracker {
    /// What is believed.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// At the beginning of an episode, with this belief.
    pub fn begun(belief: Belief) -> Self {
        Self {
            belief,
            ..Self::default()
        }
    }

    /// In a state of which it is sure, before anything was done.
    pub fn standing(map: &Map, state: u32) -> Self {
        let found = map.states[state as usize].collected.count_ones();
        let mut tracker = Self {
            found,
            ..Self::begun(Belief::even([state]))
        };
        tracker.perceive_rightly(map, map.pomdp.percept(state));
        tracker
    }

    /// Perceives; the percept's first sixteen bits count.
    pub fn perceive(&mut self, map: &Map, percept: &Percept) {
        if let (None, Some(begin)) = (self.now, map.begin) {
            self.belief = map.first_belief(begin);
        }
        match map.observation_error > 0.0 {
            true => self.perceive_doubtingly(map, percept),
            false => self.perceive_rightly(map, percept),
        }
    }

    /// Perceives what may be misread: weighs where the robot may be by how well what it perceives
    /// fits there, and takes for perceived what should be perceived in the likeliest place.
    fn perceive_doubtingly(&mut self, map: &Map, percept: &Percept) {
        let acted = self.acted.take();
        if acted.is_some_and(|(_, felt)| felt.rewarded) {
            self.found = (self.found + 1).min(map.rewards());
        }
        let (expected, mislocalised) = match acted {
            Some((action, felt)) => {
                let stayed = (!map.unfelt).then_some(felt.bumped);
                let expected = self.belief.expected(&map.pomdp, action, stayed);
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
            likely[strange(map, state, &seen) + wrong]
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

    /// Perceives what is taken for right.
    pub fn perceive_rightly(&mut self, map: &Map, percept: &Percept) {
        let percept = Percept::from_word(percept.words()[0], PERCEPT_BITS);
        let acted = self.acted.take();
        let after = acted.and_then(|(action, felt)| {
            let found = felt.rewarded;
            // A reward that was not predicted, or did not come, still tells where the robot is.
            let counts = [
                self.found + u32::from(found),
                self.found + u32::from(!found),
            ];
            let after = |found: u32| {
                let sight = sight(&percept, found);
                (found, self.belief.after(&map.pomdp, action, &sight))
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
        let lost = || {
            let found = acted.is_some_and(|(_, felt)| felt.rewarded);
            let found = (self.found + u32::from(found)).min(map.rewards());
            (found, lost(map, &percept, found))
        };
        (self.found, self.belief) = after.or_else(begun).unwrap_or_else(lost);
        self.now = Some(percept);
    }

    /// Acts on what was perceived.
    pub fn act(&mut self, action: Action, felt: Felt) {
        if let Some(percept) = self.now {
            self.window.rotate_left(1);
            self.window[WINDOW - 1] = Some((percept, action));
        }
        self.acted = Some((action, felt));
    }

    /// All that rules look at, as bits.
    pub fn context(&self, map: &Map) -> Percept {
        let percept = self.now.unwrap_or(Percept::from_word(0, PERCEPT_BITS));
        let map_state = self
            .belief
            .likeliest()
            .map(|(state, _)| map.states[state as usize]);
        let map_state = map_state.unwrap_or_default();
        let mut context = percept
            .followed_by(&above(map_state.place.east))
            .followed_by(&above(map_state.place.north))
            .followed_by(&Percept::from_word(map_state.cell_map.into(), MAP_BITS))
            .followed_by(&Percept::from_word(map_state.collected.into(), MOST_PAYING));
        for step in self.window.iter().rev() {
            context = context.followed_by(&step_bits(*step));
        }
        context
    }
}

/// How much of a context rules may look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// The percept and the likeliest place, with what was found there.
    Place,
    /// And the last two steps.
    Steps,
}

impl View {
    /// Those that rules on a map may have, the narrowest first.
    pub fn fit_for(map: &Map) -> &'static [Self] {
        match map.observation_error > 0.0 {
            true => &[Self::Place, Self::Steps],
            false => &[Self::Steps],
        }
    }

    /// How many bits of a context it is.
    fn bits(self) -> usize {
        match self {
            Self::Place => PLACE_END,
            Self::Steps => CONTEXT_BITS,
        }
    }

    /// The rules that look at no more than this.
    pub fn part_of(self, rules: &Population) -> Population {
        let beyond = |rule: &Classifier| {
            (self.bits()..CONTEXT_BITS).any(|bit| rule.condition.allele(bit).is_some())
        };
        let part = rules.rules().iter().filter(|rule| !beyond(rule)).copied();
        let part = part.collect::<Vec<_>>().try_into();
        part.expect("part of a sound population is sound")
    }

    /// Of this context what rules look at, with zeros for all else.
    pub fn of(self, context: &Percept) -> Percept {
        let seen = self.bits();
        let bits = (0..CONTEXT_BITS).map(|bit| bit < seen && context.bit(bit));
        Percept::from_bits(bits).expect("as many bits as before")
    }
}

/// A coordinate in unary: as many ones as it is greater than the least one.
fn above(coordinate: i16) -> Percept {
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

/// Everywhere where it looks like this when so many rewards were found, or else as much like this as
/// anywhere.
fn lost(map: &Map, percept: &Percept, found: u32) -> Belief {
    let pomdp = &map.pomdp;
    if let Some(look) = pomdp.look_of(&sight(percept, found)) {
        return Belief::even(pomdp.alike(look));
    }
    let seen = around(percept);
    let strange = |state: u32| strange(map, state, &seen);
    let states = 0..pomdp.states() as u32;
    let states = states.filter(|&state| map.states[state as usize].collected.count_ones() == found);
    let least = states.clone().map(strange).min();
    match least {
        Some(least) => Belief::even(states.filter(|&state| strange(state) == least)),
        None => Belief::default(),
    }
}

/// In how many cells what is seen is not what should be seen in a state.
fn strange(map: &Map, state: u32, seen: &Surroundings) -> usize {
    let there = around(map.pomdp.percept(state));
    (0..NEIGHBOURS.len())
        .filter(|&at| there[at] != seen[at])
        .count()
}

/// The value that a condition demands of an allele; `None` for a don't-care.
type Alleles<'a> = &'a dyn Fn(usize) -> Option<bool>;

/// What a condition on a context demands beside the percept, such as `x > 2`; `seen` has the words for
/// a percept, and none where nothing is demanded of it.
pub fn words(alleles: Alleles<'_>, seen: &dyn Fn(Alleles<'_>) -> Option<String>) -> Vec<String> {
    let east = PERCEPT_BITS;
    let north = east + COORDINATE_BITS;
    let cell_map = north + COORDINATE_BITS;
    let collected = cell_map + MAP_BITS;
    let window = collected + MOST_PAYING;
    let mut words = coordinate_words("x", east, alleles);
    words.extend(coordinate_words("y", north, alleles));
    let part = |name: &str, range: std::ops::Range<usize>| {
        let state = |at| alleles(at).map_or('#', |bit| if bit { '1' } else { '0' });
        let bits: String = range.map(state).collect();
        bits.contains(['0', '1']).then(|| format!("{name} {bits}"))
    };
    words.extend(part("map", cell_map..collected));
    words.extend(part("rewards found", collected..window));
    for (step, ago) in ["last step", "step before"].into_iter().enumerate() {
        let from = window + step * STEP_BITS;
        words.extend(part(&format!("{ago} taken"), from..from + 1));
        words.extend(part(&format!("{ago} action"), from + 1..from + 4));
        let demands = seen(&|at| alleles(from + 4 + at));
        words.extend(demands.map(|words| format!("{ago} saw {}", words.replace(", ", " and "))));
    }
    words
}

/// The limits of a coordinate, counted from the goal: bit k demands more than `k - FURTHEST`, or not.
fn coordinate_words(name: &str, from: usize, alleles: Alleles<'_>) -> Vec<String> {
    let limit = |bit: usize| bit as i16 - FURTHEST as i16;
    let demands =
        |value| (0..COORDINATE_BITS).filter(move |&bit| alleles(from + bit) == Some(value));
    let least = demands(true)
        .max()
        .map(|bit| format!("{name} > {}", limit(bit)));
    let most = demands(false)
        .min()
        .map(|bit| format!("{name} <= {}", limit(bit)));
    least.into_iter().chain(most).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::place::Place;
    use crate::agent::estimator::map::state_map::MapState;
    use crate::agent::model::pomdp::Pomdp;

    /// Three places that look alike: the action bumps in the first, and leads from the second to the third.
    fn alike(unfelt: bool) -> Map {
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

    /// Where a robot may be that was in the first or in the second place, and bumped or did not.
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
    fn a_bump_tells_two_places_apart_that_look_alike_unless_it_is_not_felt() {
        let map = alike(false);
        assert_eq!([likely(&map, true), likely(&map, false)], [[0], [2]]);
        let map = alike(true);
        assert_eq!(likely(&map, true), [0, 2]);
        assert_eq!(likely(&map, false), [0, 2]);
    }

    /// Two states that look different, in the second of which `rewards` rewards were found.
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

    /// How many rewards are counted after one was found on a step that led to an unknown percept.
    fn counted(map: &Map) -> u32 {
        let mut tracker = Tracker::begun(Belief::even([0]));
        tracker.perceive(map, &Percept::from_word(0, PERCEPT_BITS));
        let (bumped, rewarded) = (false, true);
        tracker.act(Action::new(0).unwrap(), Felt { bumped, rewarded });
        tracker.perceive(map, &Percept::from_word(0b1111, PERCEPT_BITS));
        tracker.found
    }

    #[test]
    fn a_reward_on_the_step_that_gets_lost_counts_if_the_map_knows_one() {
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

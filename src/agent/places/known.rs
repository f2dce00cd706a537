//! Known places: what each of them looks like, and what came of each action there.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::power;
use xcs::{Action, Percept};

/// The weight of what was never seen to come of an action, in tries.
pub const OPEN: f64 = 0.25;
/// Of an action of which nothing is known: the chance that it bumps, and that it ends in a goal.
const BUMPS: f64 = 0.3;
const ENDS: f64 = 0.05;
/// The chance that any action leads to one certain place that was never seen before.
const NEVER_SEEN: f64 = 1e-2;
/// Bits that count as flipped, of so many, before any was seen.
const PRIOR: [f64; 2] = [1.0, 200.0];
/// Misread percepts differ from right ones in at most so many bits, where that is looked up.
pub const NEAR: u32 = 2;
/// Counts in files lie below this, so that there is room to count on.
const MOST_COUNTED: u32 = u32::MAX / 4;

/// What came of an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Came {
    /// The robot came to the place of this number, or thinks so.
    To(usize),
    /// It bumped, and stayed. That is felt.
    Bumped,
    /// The episode ended in a goal.
    Goal,
}

/// What came of an action in a place, and how often.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Follow {
    action: Action,
    came: Came,
    count: u32,
}

/// A place: all cells that look alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    percept: Percept,
    visits: u32,
    begins: u32,
    follows: Vec<Follow>,
}

/// The places as they stand in files.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    places: Vec<Place>,
    flipped: u32,
    shown: u32,
}

/// All places that were met, numbered in the order of meeting.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Written")]
pub struct Places {
    places: Vec<Place>,
    /// Bits of percepts that differed from those of their places, and all.
    flipped: u32,
    shown: u32,
    #[serde(skip_serializing)]
    numbers: BTreeMap<Percept, usize>,
    /// All visits, and all beginnings.
    #[serde(skip_serializing)]
    visits: u64,
    #[serde(skip_serializing)]
    begins: u64,
}

impl From<Written> for Places {
    fn from(written: Written) -> Self {
        let Written {
            places,
            flipped,
            shown,
        } = written;
        let numbers = places.iter().enumerate();
        Self {
            numbers: numbers.map(|(number, it)| (it.percept, number)).collect(),
            visits: places.iter().map(|it| u64::from(it.visits)).sum(),
            begins: places.iter().map(|it| u64::from(it.begins)).sum(),
            places,
            flipped,
            shown,
        }
    }
}

/// In how many bits two percepts differ.
pub fn distance(one: &Percept, other: &Percept) -> u32 {
    let words = one.words().iter().zip(other.words());
    words.map(|(one, other)| (one ^ other).count_ones()).sum()
}

fn change(count: &mut u32, adds: bool) {
    *count = match adds {
        true => count.saturating_add(1),
        false => count.saturating_sub(1),
    };
}

impl Places {
    /// How many places were met.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Was none met?
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The number of the place that looks like this, if it was ever met.
    pub fn number(&self, percept: &Percept) -> Option<usize> {
        self.numbers.get(percept).copied()
    }

    /// The number of the place that looks like this, which is met now if it never was.
    pub fn meet(&mut self, percept: &Percept) -> usize {
        let next = self.places.len();
        let number = *self.numbers.entry(*percept).or_insert(next);
        if number == next {
            self.places.push(Place {
                percept: *percept,
                visits: 0,
                begins: 0,
                follows: Vec::new(),
            });
        }
        number
    }

    /// Forgets places with at most so many visits; gives the new number of each place.
    pub fn forget(&mut self, visits: u32) -> Vec<Option<usize>> {
        let mut kept = 0;
        let number = |it: &Place| {
            let keeps = it.visits > visits;
            kept += usize::from(keeps);
            keeps.then(|| kept - 1)
        };
        let numbers: Vec<Option<usize>> = self.places.iter().map(number).collect();
        let Self {
            places,
            flipped,
            shown,
            ..
        } = std::mem::take(self);
        let mut places: Vec<Place> = places.into_iter().filter(|it| it.visits > visits).collect();
        for place in &mut places {
            place.follows.retain_mut(|follow| match &mut follow.came {
                Came::To(next) => {
                    let number = numbers.get(*next).copied().flatten();
                    *next = number.unwrap_or_default();
                    number.is_some()
                }
                Came::Bumped | Came::Goal => true,
            });
        }
        *self = Written {
            places,
            flipped,
            shown,
        }
        .into();
        numbers
    }

    /// What a place looks like.
    pub fn percept(&self, place: usize) -> &Percept {
        &self.places[place].percept
    }

    /// How often the robot was there, as far as is believed now.
    pub fn visits(&self, place: usize) -> u32 {
        self.places[place].visits
    }

    /// The probability that a bit flips.
    pub fn rate(&self) -> f64 {
        let flipped = f64::from(self.flipped) + PRIOR[0];
        (flipped / (f64::from(self.shown) + PRIOR[1])).min(0.25)
    }

    /// How likely this is to be seen in a place, beside what looks like the place itself.
    pub fn look(&self, place: usize, seen: &Percept) -> f64 {
        self.misreading(distance(self.percept(place), seen))
    }

    /// How likely it is that so many certain bits flip and no others, beside that none does.
    pub fn misreading(&self, bits: u32) -> f64 {
        let rate = self.rate();
        power(rate / (1.0 - rate), bits)
    }

    /// Counts a visit in which this was seen, or takes it back.
    pub fn visit(&mut self, place: usize, seen: &Percept, adds: bool) {
        let bits = distance(self.percept(place), seen);
        (0..bits).for_each(|_| change(&mut self.flipped, adds));
        let width = seen.width() as u32;
        self.shown = match adds {
            true => self.shown.saturating_add(width),
            false => self.shown.saturating_sub(width),
        };
        change(&mut self.places[place].visits, adds);
        self.visits = match adds {
            true => self.visits + 1,
            false => self.visits.saturating_sub(1),
        };
    }

    /// Counts that an episode began in a place, or takes it back.
    pub fn begin(&mut self, place: usize, adds: bool) {
        change(&mut self.places[place].begins, adds);
        self.begins = match adds {
            true => self.begins + 1,
            false => self.begins.saturating_sub(1),
        };
    }

    /// Counts what came of an action, or takes it back.
    pub fn count(&mut self, place: usize, action: Action, came: Came, adds: bool) {
        let follows = &mut self.places[place].follows;
        let known = follows
            .iter_mut()
            .find(|it| it.action == action && it.came == came);
        match known {
            Some(follow) => change(&mut follow.count, adds),
            None if adds => follows.push(Follow {
                action,
                came,
                count: 1,
            }),
            None => {}
        }
        if !adds {
            follows.retain(|it| it.count > 0);
        }
    }

    /// How often this came of an action, and how often that was tried.
    pub fn tally(&self, place: usize, action: Action, came: Came) -> [u32; 2] {
        let mut tally = [0; 2];
        for follow in self.follows(place, action) {
            tally[0] += if follow.came == came { follow.count } else { 0 };
            tally[1] += follow.count;
        }
        tally
    }

    fn follows(&self, place: usize, action: Action) -> impl Iterator<Item = &Follow> {
        let follows = self.places[place].follows.iter();
        follows.filter(move |it| it.action == action)
    }

    /// The places to which an action led.
    pub fn successors(&self, place: usize, action: Action) -> impl Iterator<Item = usize> {
        let follows = self.follows(place, action);
        follows.filter_map(|it| match it.came {
            Came::To(next) => Some(next),
            _ => None,
        })
    }

    /// Where an action led in more than half of its tries.
    pub fn usual(&self, place: usize, action: Action) -> Option<usize> {
        let mut successors = self.successors(place, action);
        successors.find(|&next| {
            let [count, tries] = self.tally(place, action, Came::To(next));
            2 * count > tries
        })
    }

    /// The places where episodes began.
    pub fn beginnings(&self) -> impl Iterator<Item = usize> {
        let places = self.places.iter().enumerate();
        places
            .filter(|(_, it)| it.begins > 0)
            .map(|(number, _)| number)
    }

    /// How often episodes began in a place, and anywhere.
    pub fn begun(&self, place: usize) -> [u64; 2] {
        [self.places[place].begins.into(), self.begins]
    }

    /// Places in which the robot was, and that look nearly like this.
    pub fn near(&self, seen: &Percept) -> impl Iterator<Item = usize> {
        let places = self.places.iter().enumerate();
        places
            .filter(|(_, it)| it.visits > 0 && distance(&it.percept, seen) <= NEAR)
            .map(|(number, _)| number)
    }

    /// The share of visits that a place has; `None`: one that was never seen.
    fn share(&self, place: Option<usize>) -> f64 {
        let visits = place.map_or(0, |place| self.places[place].visits);
        match visits {
            0 => NEVER_SEEN,
            _ => (f64::from(visits) / self.visits as f64).max(NEVER_SEEN),
        }
    }

    /// The weight of what comes of an action although it never did, in tries.
    pub fn open(&self, came: Option<Came>) -> f64 {
        OPEN * self.anyhow(came)
    }

    fn anyhow(&self, came: Option<Came>) -> f64 {
        match came {
            Some(Came::Bumped) => BUMPS,
            Some(Came::Goal) => ENDS,
            Some(Came::To(place)) => (1.0 - BUMPS - ENDS) * self.share(Some(place)),
            None => (1.0 - BUMPS - ENDS) * self.share(None),
        }
    }

    /// The chance of what comes of an action; `None` stands for a place that was never met.
    pub fn chance(&self, place: Option<usize>, action: Action, came: Option<Came>) -> f64 {
        let [count, tries] = match (place, came) {
            (Some(place), Some(came)) => self.tally(place, action, came),
            (Some(place), None) => {
                let tries = self.follows(place, action).map(|it| it.count).sum();
                [0, tries]
            }
            (None, _) => [0; 2],
        };
        (f64::from(count) + self.open(came)) / (f64::from(tries) + OPEN)
    }

    /// The chance that an episode begins in a place; `None`: in one that was never met.
    pub fn chance_to_begin(&self, place: Option<usize>) -> f64 {
        let begins = place.map_or(0, |place| self.places[place].begins);
        (f64::from(begins) + OPEN * self.share(place)) / (self.begins as f64 + OPEN)
    }

    /// Can places, which percepts of `width` bits tell, and actions be like this?
    pub fn is_sound(&self, width: Option<usize>, actions: usize) -> bool {
        let met = self.len();
        let follows = |it: &Follow| {
            it.action.index() < actions
                && (1..MOST_COUNTED).contains(&it.count)
                && !matches!(it.came, Came::To(place) if place >= met)
        };
        let place = |it: &Place| {
            width.is_none_or(|width| it.percept.width() == width)
                && it.visits < MOST_COUNTED
                && it.begins < MOST_COUNTED
                && it.follows.iter().all(follows)
                && it.follows.iter().map(|it| u64::from(it.count)).sum::<u64>()
                    < MOST_COUNTED.into()
        };
        self.numbers.len() == met
            && self.flipped.max(self.shown) < MOST_COUNTED
            && self.places.iter().all(place)
    }
}

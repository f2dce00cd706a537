//! Candidates for rules that foretell a collision, and the evidence for and against them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use xcs::Condition;
use xcs::Percept;

/// Percepts wider than this get candidates of one allele only; there would be too many of two.
const WIDEST_FOR_PAIRS: usize = 64;
/// A candidate is dropped when fewer of its forecasts than this came true.
const LEAST_ACCURACY: f64 = 0.9;
/// The power with which weight grows with the share of bumps that were foretold.
const EMPHASIS: i32 = 8;
/// Counts in files lie below this, so that there is room to count on.
const MOST_COUNTED: u32 = u32::MAX / 4;

/// Percepts in which an action bumped, and in which it moved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::agent) struct Tally {
    pub hits: u32,
    pub misses: u32,
}

impl Tally {
    fn is_accurate(self) -> bool {
        let all = f64::from(self.hits + self.misses);
        self.hits > 0 && f64::from(self.hits) >= LEAST_ACCURACY * all
    }

    fn add(&mut self, verdict: Option<bool>) {
        match verdict {
            Some(true) => self.hits += 1,
            Some(false) => self.misses += 1,
            None => {}
        }
    }

    fn take_back(&mut self, verdict: Option<bool>) {
        match verdict {
            Some(true) => self.hits = self.hits.saturating_sub(1),
            Some(false) => self.misses = self.misses.saturating_sub(1),
            None => {}
        }
    }

    pub fn is_sound(self) -> bool {
        self.hits <= MOST_COUNTED && self.misses <= MOST_COUNTED
    }
}

/// A condition that may foretell a collision.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::agent) struct Candidate {
    pub condition: Condition,
    /// All that speaks for and against it, here and where it was brought from.
    pub tally: Tally,
}

/// What is known of the collisions of one action, or of all in the same frame.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(in crate::agent) struct Bumps {
    /// In each percept, how often the action bumped (hits) and moved (misses).
    evidence: BTreeMap<Percept, Tally>,
    candidates: Vec<Candidate>,
    /// Counts the changes of forecasts.
    version: u64,
}

impl Bumps {
    /// The candidates.
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// Takes a candidate from another world.
    pub fn bring(&mut self, condition: Condition, tally: Tally) {
        self.candidates.push(Candidate { condition, tally });
    }

    /// Is there room in the counts of a memory from a file?
    pub fn is_sound(&self) -> bool {
        let evidence = self.evidence.values().all(|tally| tally.is_sound());
        let mut candidates = self.candidates.iter();
        evidence && candidates.all(|c| c.tally.is_sound())
    }

    /// Learns that the action bumped or moved; true if that changes a forecast.
    pub fn learn(&mut self, percept: &Percept, bumped: bool) -> bool {
        let tally = self.evidence.entry(*percept).or_default();
        let before = verdict(*tally);
        match bumped {
            true => tally.hits += 1,
            false => tally.misses += 1,
        }
        let after = verdict(*tally);
        let changes = after != before && self.judge(percept, before, after);
        self.version += u64::from(changes);
        changes
    }

    /// Another number after each change of a forecast.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The most bumps that a candidate foretold.
    pub fn most_hits(&self) -> u32 {
        let hits = self.candidates.iter().map(|c| c.tally.hits);
        hits.max().unwrap_or(0)
    }

    /// The weight of the candidates that foretell a bump in a percept, and of all; one with `best`
    /// hits weighs 1.
    pub fn votes(&self, percept: &Percept, best: u32) -> [f64; 2] {
        let mut votes = [0.0; 2];
        for candidate in &self.candidates {
            let weight = (f64::from(candidate.tally.hits) / f64::from(best)).powi(EMPHASIS);
            votes[1] += weight;
            if candidate.condition.matches(percept) {
                votes[0] += weight;
            }
        }
        votes
    }

    /// Judges the candidates anew after the verdict on a percept has changed; true if that changes
    /// a forecast.
    fn judge(&mut self, changed: &Percept, before: Option<bool>, after: Option<bool>) -> bool {
        let mut changes = false;
        for candidate in &mut self.candidates {
            if candidate.condition.matches(changed) {
                candidate.tally.take_back(before);
                candidate.tally.add(after);
                changes |= before == Some(true) || after == Some(true);
            }
        }
        let mut foretold = self.candidates.iter().map(|c| c.condition);
        if after == Some(true) && !foretold.any(|condition| condition.matches(changed)) {
            let new = conditions(changed).map(|condition| self.candidate(condition));
            self.candidates.extend(new.collect::<Vec<_>>());
            changes = true;
        }
        let candidates = self.candidates.len();
        self.candidates
            .retain(|candidate| candidate.tally.is_accurate());
        changes || self.candidates.len() < candidates
    }

    /// A candidate with all that speaks for and against it.
    fn candidate(&self, condition: Condition) -> Candidate {
        let mut tally = Tally::default();
        let covered = self
            .evidence
            .iter()
            .filter(|(percept, _)| condition.matches(percept));
        covered.for_each(|(_, &one)| tally.add(verdict(one)));
        Candidate { condition, tally }
    }
}

/// Does a percept count as one where the action bumps? `None` where nothing is known.
fn verdict(Tally { hits, misses }: Tally) -> Option<bool> {
    (hits + misses > 0).then_some(hits > misses)
}

/// All conditions of one or two alleles that match a percept.
fn conditions(percept: &Percept) -> impl Iterator<Item = Condition> {
    let width = percept.width();
    let second = move |first| match width > WIDEST_FOR_PAIRS {
        true => first..first + 1,
        false => first..width,
    };
    let pairs = (0..width).flat_map(move |first| second(first).map(move |second| [first, second]));
    let percept = *percept;
    pairs.map(move |alleles| Condition::of_alleles(&percept, alleles))
}

//! Candidates for rules that foretell a collision, and the evidence for and against them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::coverage::Coverage;
use super::tally::{Tally, verdict};
use xcs::Condition;
use xcs::Percept;

/// The power with which weight grows with the share of bumps that were foretold.
const EMPHASIS: i32 = 8;

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
    /// The evidence once more, by condition; counted when the first candidates are made.
    #[serde(skip)]
    coverage: Option<Coverage>,
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
        if let Some(coverage) = self.coverage.as_mut().filter(|_| after != before) {
            coverage.change(percept, before, after);
        }
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
            let width = changed.width();
            let coverage = self
                .coverage
                .get_or_insert_with(|| Coverage::of(width, &self.evidence));
            let new = coverage.conditions(changed);
            let new = new.map(|(condition, tally)| Candidate { condition, tally });
            self.candidates.extend(new);
            changes = true;
        }
        let candidates = self.candidates.len();
        self.candidates
            .retain(|candidate| candidate.tally.is_accurate());
        changes || self.candidates.len() < candidates
    }
}

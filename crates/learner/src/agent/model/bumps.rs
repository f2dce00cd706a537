//! Candidates for rules that foretell a collision, and the evidence for and against them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::model::coverage::Coverage;
use crate::agent::model::tally::{Tally, verdict};
use crate::agent::power;
use xcs::Condition;
use xcs::Percept;

/// The power with which weight grows with the share of bumps that were predicted.
const EMPHASIS: u32 = 8;

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
    /// By how much bumps or moves must be ahead in a percept to count.
    margin: u32,
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
        let before = verdict(*tally, self.margin);
        match bumped {
            true => tally.hits += 1,
            false => tally.misses += 1,
        }
        let after = verdict(*tally, self.margin);
        if let Some(coverage) = self.coverage.as_mut().filter(|_| after != before) {
            coverage.change(percept, before, after);
        }
        let changes = after != before && self.judge(percept, before, after);
        self.version += u64::from(changes);
        changes
    }

    /// Judges everything anew, because bumps or moves must be ahead by another margin now to count.
    pub fn demand(&mut self, margin: u32) {
        let before = std::mem::replace(&mut self.margin, margin);
        if before == margin {
            return;
        }
        self.version += 1;
        self.coverage = None;
        let evidence = self.evidence.clone();
        for (percept, &tally) in &evidence {
            self.recount(percept, verdict(tally, before), verdict(tally, margin));
        }
        for (percept, _) in evidence
            .iter()
            .filter(|(_, tally)| verdict(**tally, margin) == Some(true))
        {
            self.predict(percept);
        }
        self.drop_inaccurate();
    }

    /// Another number after each change of a forecast.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The most bumps that a candidate predicted.
    pub fn most_hits(&self) -> u32 {
        let hits = self.candidates.iter().map(|c| c.tally.hits);
        hits.max().unwrap_or(0)
    }

    /// The weight of the candidates that foretell a bump in a percept, and of all; one with `best`
    /// hits weighs 1.
    pub fn votes(&self, percept: &Percept, best: u32) -> [f64; 2] {
        let mut votes = [0.0; 2];
        for candidate in &self.candidates {
            let weight = power(f64::from(candidate.tally.hits) / f64::from(best), EMPHASIS);
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
        let recounted = self.recount(changed, before, after);
        let predicted = after == Some(true) && self.predict(changed);
        self.drop_inaccurate() || recounted || predicted
    }

    /// Counts the verdict on a percept anew; true if that may change a forecast.
    fn recount(&mut self, changed: &Percept, before: Option<bool>, after: Option<bool>) -> bool {
        let mut changes = false;
        for candidate in &mut self.candidates {
            if candidate.condition.matches(changed) {
                candidate.tally.take_back(before);
                candidate.tally.add(after);
                changes |= before == Some(true) || after == Some(true);
            }
        }
        changes
    }

    /// Makes candidates for a percept in which the action bumps; false if it is predicted already.
    fn predict(&mut self, percept: &Percept) -> bool {
        let mut predicted = self.candidates.iter().map(|c| c.condition);
        if predicted.any(|condition| condition.matches(percept)) {
            return false;
        }
        let Self {
            evidence,
            margin,
            coverage,
            ..
        } = self;
        let coverage =
            coverage.get_or_insert_with(|| Coverage::of(percept.width(), evidence, *margin));
        let new = coverage.conditions(percept);
        let new = new.map(|(condition, tally)| Candidate { condition, tally });
        self.candidates.extend(new);
        true
    }

    /// Drops the candidates that were wrong too often; true if there are any.
    fn drop_inaccurate(&mut self) -> bool {
        let before = self.candidates.len();
        self.candidates
            .retain(|candidate| candidate.tally.is_accurate());
        self.candidates.len() < before
    }
}

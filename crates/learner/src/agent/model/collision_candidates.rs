//! Candidate rules that predict a collision, and the evidence for and against them.

use std::collections::BTreeMap;

use crate::agent::model::power::power;
use crate::agent::model::tally::{Tally, verdict};
use xcs::{Condition, Layout, Percept};

/// The exponent of a candidate's weight as a function of its share of predicted bumps.
const EMPHASIS: u32 = 8;

/// The maximum number of parts of percepts with candidates of two parts. Larger ones would have too many pairs.
const WIDEST_FOR_PAIRS: usize = 64;

/// A condition that may predict a collision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::agent) struct Candidate {
    pub condition: Condition,
    /// All evidence for and against it, here and in earlier worlds.
    pub tally: Tally,
}

/// The collision model of one action, or of all actions in a common frame.
#[derive(Debug, Clone, Default)]
pub(in crate::agent) struct CollisionCandidates {
    /// By percept, how often the action bumped (hits) and moved (misses).
    evidence: BTreeMap<Percept, Tally>,
    candidates: Vec<Candidate>,
    /// The number of changes of forecasts.
    version: u64,
    /// The lead of bumps or moves in a percept that is required for a verdict.
    margin: u32,
}

impl CollisionCandidates {
    /// Returns the candidates.
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// Adds a candidate from another world.
    pub fn warm_start(&mut self, condition: Condition, tally: Tally) {
        self.candidates.push(Candidate { condition, tally });
    }

    /// Learns that the action bumped or moved in a percept with this layout. Returns true if a forecast
    /// changes.
    pub fn learn(&mut self, percept: &Percept, bumped: bool, layout: &Layout) -> bool {
        let tally = self.evidence.entry(*percept).or_default();
        let before = verdict(*tally, self.margin);
        match bumped {
            true => tally.hits += 1,
            false => tally.misses += 1,
        }
        let after = verdict(*tally, self.margin);
        let changes = after != before && self.re_evaluate(percept, [before, after], layout);
        self.version += u64::from(changes);
        changes
    }

    /// Sets the lead that is required for a verdict, and re-evaluates everything.
    pub fn set_margin(&mut self, margin: u32, layout: &Layout) {
        let before = std::mem::replace(&mut self.margin, margin);
        if before == margin {
            return;
        }
        self.version += 1;
        let evidence = self.evidence.clone();
        for (percept, &tally) in &evidence {
            self.recount(percept, verdict(tally, before), verdict(tally, margin));
        }
        for (percept, _) in evidence
            .iter()
            .filter(|(_, tally)| verdict(**tally, margin) == Some(true))
        {
            self.add_candidates(percept, layout);
        }
        self.drop_inaccurate();
    }

    /// Returns a number that changes with the forecasts.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Returns the greatest number of bumps that a candidate predicted.
    pub fn most_hits(&self) -> u32 {
        let hits = self.candidates.iter().map(|c| c.tally.hits);
        hits.max().unwrap_or(0)
    }

    /// Returns the weight of the candidates that predict a bump in a percept, and of all candidates. A
    /// candidate with `best` hits has weight 1.
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

    /// Re-evaluates the candidates after the verdict on a percept has changed. Returns true if a forecast
    /// changes.
    fn re_evaluate(
        &mut self,
        changed: &Percept,
        [before, after]: [Option<bool>; 2],
        layout: &Layout,
    ) -> bool {
        let recounted = self.recount(changed, before, after);
        let added = after == Some(true) && self.add_candidates(changed, layout);
        self.drop_inaccurate() || recounted || added
    }

    /// Recounts the verdict on a percept. Returns true if a forecast may change.
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

    /// Creates candidates for a percept in which the action bumps. Returns false if the bump is already
    /// predicted.
    fn add_candidates(&mut self, percept: &Percept, layout: &Layout) -> bool {
        let mut predicted = self.candidates.iter().map(|c| c.condition);
        if predicted.any(|condition| condition.matches(percept)) {
            return false;
        }
        let old = self.candidates.len();
        let parts = layout.parts(percept.width());
        let new = pairs(&parts).map(|parts| Candidate {
            condition: layout.requiring_parts(percept, parts),
            tally: Tally::default(),
        });
        self.candidates.extend(new);
        for (met, &tally) in &self.evidence {
            let verdict = verdict(tally, self.margin);
            let new = self.candidates[old..].iter_mut();
            new.filter(|candidate| candidate.condition.matches(met))
                .for_each(|candidate| candidate.tally.add(verdict));
        }
        true
    }

    /// Drops inaccurate candidates. Returns true if there were any.
    fn drop_inaccurate(&mut self) -> bool {
        let before = self.candidates.len();
        self.candidates
            .retain(|candidate| candidate.tally.is_accurate());
        self.candidates.len() < before
    }
}

/// Returns all pairs of parts, including each part with itself.
fn pairs(parts: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    let second = move |first| match parts.len() > WIDEST_FOR_PAIRS {
        true => &parts[first..=first],
        false => &parts[first..],
    };
    let first = parts.iter().enumerate();
    first.flat_map(move |(at, &first)| second(at).iter().map(move |&second| [first, second]))
}

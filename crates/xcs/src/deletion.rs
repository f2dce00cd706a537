//! Deletion votes, cached in blocks so that a deletion does not visit every rule.

use super::classifier::Classifier;
use super::params::Params;

/// Rules per block: few, because a learning step changes rules throughout the population, and each
/// change requires summing its block again.
const BLOCK: usize = 16;

/// The greatest raised vote. A fitness near 0 would make it, and the sum of all votes, infinite.
const MOST_VOTE: f64 = 1e280;

/// Cached deletion votes of \[P\] and their sums, by position.
///
/// A rule's vote is `as * num * eam`, where eam is 1 outside XCSAM. An experienced rule whose mean
/// fitness `F / num` is below the cut `delta * mean F` is unfit. Its vote is raised by
/// `mean F / (F / num)` (Butz and Wilson 2001, DELETION VOTE).
///
/// All cached values are pure functions of the rules in a block and of which of them are unfit.
/// Rounding errors therefore do not accumulate from step to step.
#[derive(Debug, Clone, Default)]
pub(super) struct DeletionVotes {
    blocks: Vec<Block>,
}

/// The cached values of some rules, and the sums over them.
#[derive(Debug, Clone)]
struct Block {
    /// One bit per rule that was added, changed or removed since the last refresh.
    dirty: u16,
    rules: [WeightedRule; BLOCK],
    fitness: f64,
    /// The votes of the rules that are not unfit.
    plain: f64,
    /// The votes of the unfit rules, before multiplication by the mean fitness.
    raised: f64,
    /// The sums of votes are valid for cuts above this value,
    cut_above: f64,
    /// up to and including this value.
    cut_up_to: f64,
}

/// The cached values of one rule. An empty position has no vote.
#[derive(Debug, Clone, Copy)]
struct WeightedRule {
    fitness: f64,
    /// `F / num` of an experienced rule; infinite for other rules, which are never unfit.
    mean: f64,
    /// `as * num * eam`.
    plain: f64,
    /// `as * num * eam / (F / num)`, without the factor of the mean fitness.
    raised: f64,
}

const NO_RULE: WeightedRule = WeightedRule {
    fitness: 0.0,
    mean: f64::INFINITY,
    plain: 0.0,
    raised: 0.0,
};

const EMPTY: Block = Block {
    dirty: 0,
    rules: [NO_RULE; BLOCK],
    fitness: 0.0,
    plain: 0.0,
    raised: 0.0,
    cut_above: f64::NEG_INFINITY,
    cut_up_to: f64::INFINITY,
};

impl DeletionVotes {
    /// Marks the rule at `position` as added, changed or removed.
    #[inline]
    pub fn touch(&mut self, position: usize) {
        let block = position / BLOCK;
        if block >= self.blocks.len() {
            self.blocks.resize(block + 1, EMPTY);
        }
        self.blocks[block].dirty |= 1 << (position % BLOCK);
    }

    /// Returns the position of the rule selected by a roulette ball at `ball` (in `[0, 1)`).
    /// Requires at least one rule.
    pub fn roulette<C>(
        &mut self,
        rules: &[Classifier<C>],
        micro: u32,
        params: &Params,
        ball: f64,
    ) -> usize {
        self.blocks.truncate(rules.len().div_ceil(BLOCK));
        for (block, rules) in self.blocks.iter_mut().zip(rules.chunks(BLOCK)) {
            if block.dirty != 0 {
                block.refresh(rules, params);
            }
        }
        let fitness: f64 = self.blocks.iter().map(|block| block.fitness).sum();
        let mean_fitness = fitness / f64::from(micro);
        let cut = params.delta * mean_fitness;
        for block in &mut self.blocks {
            if !(cut > block.cut_above && cut <= block.cut_up_to) {
                block.sum_votes(cut);
            }
        }
        let votes = |block: &Block| block.plain + block.raised * mean_fitness;
        let mut left = ball * self.blocks.iter().map(votes).sum::<f64>();
        let at = stop(self.blocks.iter().map(votes), &mut left);
        let of_rule = |rule: &WeightedRule| match rule.mean < cut {
            true => rule.raised * mean_fitness,
            false => rule.plain,
        };
        let at = at * BLOCK + stop(self.blocks[at].rules.iter().map(of_rule), &mut left);
        at.min(rules.len() - 1)
    }
}

/// Returns the index of the vote that exhausts `left`, or of the last vote. `left` is reduced by
/// all votes before it.
fn stop(votes: impl Iterator<Item = f64>, left: &mut f64) -> usize {
    let mut last = 0;
    for (at, vote) in votes.enumerate() {
        last = at;
        if *left < vote {
            break;
        }
        *left -= vote;
    }
    last
}

impl Block {
    /// Updates the rules that changed. `rules` are the rules of the block.
    fn refresh<C>(&mut self, rules: &[Classifier<C>], params: &Params) {
        while self.dirty != 0 {
            let at = self.dirty.trailing_zeros() as usize;
            self.dirty &= self.dirty - 1;
            let values = |rule| WeightedRule::of(rule, params);
            self.rules[at] = rules.get(at).map_or(NO_RULE, values);
        }
        self.fitness = self.rules.iter().map(|rule| rule.fitness).sum();
        // The sums of votes are valid for no cut.
        (self.cut_above, self.cut_up_to) = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Sums the votes for a cut, and finds the other cuts for which the sums hold.
    fn sum_votes(&mut self, cut: f64) {
        (self.plain, self.raised) = (0.0, 0.0);
        (self.cut_above, self.cut_up_to) = (EMPTY.cut_above, EMPTY.cut_up_to);
        for rule in &self.rules {
            // Not `max` and `min`, which handle NaN and take twice as long.
            if rule.mean < cut {
                self.raised += rule.raised;
                if rule.mean > self.cut_above {
                    self.cut_above = rule.mean;
                }
            } else {
                self.plain += rule.plain;
                if rule.mean < self.cut_up_to {
                    self.cut_up_to = rule.mean;
                }
            }
        }
    }
}

impl WeightedRule {
    fn of<C>(rule: &Classifier<C>, params: &Params) -> Self {
        let numerosity = f64::from(rule.numerosity);
        let mean = rule.fitness / numerosity;
        let plain = rule.set_size * numerosity * f64::from(rule.eam);
        let is_experienced = rule.experience > params.theta_del;
        Self {
            fitness: rule.fitness,
            mean: if is_experienced { mean } else { f64::INFINITY },
            plain,
            raised: (plain / mean).min(MOST_VOTE),
        }
    }
}

#[cfg(test)]
mod tests;

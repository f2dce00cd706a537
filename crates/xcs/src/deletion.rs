//! Deletion votes, cached in blocks so that a deletion does not visit every rule.

use super::classifier::Classifier;
use super::params::Params;

/// Rules per block. Blocks are small, because a learning step changes rules throughout the
/// population, and each change requires summing its block again.
const BLOCK: usize = 8;
/// Blocks per group. The roulette visits groups first, and recomputes only groups that changed.
const GROUP: usize = 8;

/// The greatest raised vote. A fitness near 0 would make it, and the sum of all votes, infinite.
const MOST_VOTE: f64 = 1e280;

const _: () = assert!(BLOCK * GROUP == 64, "one bit of `Group::dirty` per rule");

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
    groups: Vec<Group>,
}

#[derive(Debug, Clone)]
struct Group {
    /// One bit per rule that was added, changed or removed since the last refresh.
    dirty: u64,
    sums: Sums,
    blocks: [Sums; GROUP],
    votes: [[WeightedRule; BLOCK]; GROUP],
}

/// Sums over several rules.
#[derive(Debug, Clone, Copy)]
struct Sums {
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

const NO_RULES: Sums = Sums {
    fitness: 0.0,
    plain: 0.0,
    raised: 0.0,
    cut_above: f64::NEG_INFINITY,
    cut_up_to: f64::INFINITY,
};

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

const EMPTY: Group = Group {
    dirty: 0,
    sums: NO_RULES,
    blocks: [NO_RULES; GROUP],
    votes: [[NO_RULE; BLOCK]; GROUP],
};

impl DeletionVotes {
    /// Marks the rule at `position` as added, changed or removed.
    #[inline]
    pub fn touch(&mut self, position: usize) {
        let group = position / (BLOCK * GROUP);
        if group >= self.groups.len() {
            self.groups.resize(group + 1, EMPTY);
        }
        self.groups[group].dirty |= 1 << (position % (BLOCK * GROUP));
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
        let in_group = BLOCK * GROUP;
        self.groups.truncate(rules.len().div_ceil(in_group));
        for (group, rules) in self.groups.iter_mut().zip(rules.chunks(in_group)) {
            if group.dirty != 0 {
                group.refresh(rules, params);
            }
        }
        let fitness: f64 = self.groups.iter().map(|group| group.sums.fitness).sum();
        let mean_fitness = fitness / f64::from(micro);
        let cut = params.delta * mean_fitness;
        for group in &mut self.groups {
            if !group.sums.hold_for(cut) {
                group.sum_votes(cut);
            }
        }
        let votes = |group: &Group| group.sums.votes(mean_fitness);
        let mut left = ball * self.groups.iter().map(votes).sum::<f64>();
        let at = stop(self.groups.iter().map(votes), &mut left);
        let at = at * in_group + self.groups[at].walk(cut, mean_fitness, left);
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

impl Group {
    /// Updates the rules that changed. `rules` are the rules of the group.
    fn refresh<C>(&mut self, rules: &[Classifier<C>], params: &Params) {
        while self.dirty != 0 {
            let at = self.dirty.trailing_zeros() as usize;
            self.dirty &= self.dirty - 1;
            let vote = |rule| WeightedRule::of(rule, params);
            self.votes[at / BLOCK][at % BLOCK] = rules.get(at).map_or(NO_RULE, vote);
            self.blocks[at / BLOCK].invalidate();
        }
        for (block, votes) in self.blocks.iter_mut().zip(&self.votes) {
            if !block.is_valid() {
                block.fitness = votes.iter().map(|vote| vote.fitness).sum();
            }
        }
        self.sums.fitness = self.blocks.iter().map(|block| block.fitness).sum();
        self.sums.invalidate();
    }

    /// Sums the votes for a cut, in the blocks whose sums are invalid for it.
    fn sum_votes(&mut self, cut: f64) {
        let mut all = Sums {
            fitness: self.sums.fitness,
            ..NO_RULES
        };
        for (block, votes) in self.blocks.iter_mut().zip(&self.votes) {
            if !block.hold_for(cut) {
                block.sum_votes(votes, cut);
            }
            all.plain += block.plain;
            all.raised += block.raised;
            all.narrow(block.cut_above, block.cut_up_to);
        }
        self.sums = all;
    }

    /// Returns the position of the vote that exhausts `left`.
    fn walk(&self, cut: f64, mean_fitness: f64, mut left: f64) -> usize {
        let blocks = self.blocks.iter().map(|block| block.votes(mean_fitness));
        let block = stop(blocks, &mut left);
        let votes = self.votes[block].iter().map(|vote| {
            if vote.mean < cut {
                vote.raised * mean_fitness
            } else {
                vote.plain
            }
        });
        block * BLOCK + stop(votes, &mut left)
    }
}

impl Sums {
    fn votes(&self, mean_fitness: f64) -> f64 {
        self.plain + self.raised * mean_fitness
    }

    fn hold_for(&self, cut: f64) -> bool {
        cut > self.cut_above && cut <= self.cut_up_to
    }

    fn is_valid(&self) -> bool {
        self.cut_above < self.cut_up_to
    }

    /// Marks the sums of votes as valid for no cut.
    fn invalidate(&mut self) {
        (self.cut_above, self.cut_up_to) = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Restricts the validity of the sums of votes to cuts above `above` and up to `up_to`.
    fn narrow(&mut self, above: f64, up_to: f64) {
        // Not `max` and `min`, which handle NaN and take twice as long.
        if above > self.cut_above {
            self.cut_above = above;
        }
        if up_to < self.cut_up_to {
            self.cut_up_to = up_to;
        }
    }

    /// Sums the votes of a block for a cut.
    fn sum_votes(&mut self, votes: &[WeightedRule; BLOCK], cut: f64) {
        let fitness = self.fitness;
        *self = Self {
            fitness,
            ..NO_RULES
        };
        for vote in votes {
            if vote.mean < cut {
                self.raised += vote.raised;
                self.narrow(vote.mean, f64::INFINITY);
            } else {
                self.plain += vote.plain;
                self.narrow(f64::NEG_INFINITY, vote.mean);
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

//! Deletion votes, kept up to date in blocks so that a deletion need not look at every rule.

use super::classifier::Classifier;
use super::params::Params;

/// Rules per block; as many as `Block::dirty` has bits. Small, because a learning step changes
/// rules all over the population, and each change costs summing up its block again.
const BLOCK: usize = 8;
/// Blocks per group, over which the roulette runs first.
const GROUP: usize = 16;

/// Cached deletion votes of \[P\] and their sums, by position.
///
/// A rule's vote is `as * num`; an experienced rule whose mean fitness `F / num` lies below the
/// cut `delta * mean F` is unfit, and its vote is raised by `mean F / (F / num)` (Butz and Wilson
/// 2001, DELETION VOTE). All cached figures are pure functions of the rules in a block and of
/// which of them are unfit, so they carry no rounding errors from one step to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct DeletionVotes {
    blocks: Vec<Block>,
    votes: Vec<[Vote; BLOCK]>,
    /// The votes of each group in the latest roulette.
    groups: Vec<f64>,
}

/// What is known of [`BLOCK`] rules together.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    /// One bit per rule that was added, changed or removed.
    dirty: u8,
    fitness: f64,
    /// The votes of the rules that are not unfit.
    plain: f64,
    /// The votes of the unfit rules, before multiplication by the mean fitness.
    raised: f64,
    /// The sums of votes hold for cuts above this, and
    cut_above: f64,
    /// up to this.
    cut_up_to: f64,
}

/// What is known of one rule; where there is none, nothing votes.
#[derive(Debug, Clone, Copy)]
struct Vote {
    fitness: f64,
    /// `F / num` of an experienced rule; infinite for others, which are never unfit.
    mean: f64,
    /// `as * num`.
    plain: f64,
    /// `as * num / (F / num)`, still to be multiplied by the mean fitness.
    raised: f64,
}

const NO_RULE: Vote = Vote {
    fitness: 0.0,
    mean: f64::INFINITY,
    plain: 0.0,
    raised: 0.0,
};

impl DeletionVotes {
    /// Notes that the rule at `position` was added, changed or removed.
    pub fn touch(&mut self, position: usize) {
        let block = position / BLOCK;
        if block >= self.blocks.len() {
            self.blocks.resize(block + 1, Block::default());
            self.votes.resize(block + 1, [NO_RULE; BLOCK]);
        }
        self.blocks[block].dirty |= 1 << (position % BLOCK);
    }

    /// The position of the rule on which a roulette ball at `ball` (in `[0, 1)`) comes to rest.
    /// There is at least one rule.
    pub fn roulette(
        &mut self,
        rules: &[Classifier],
        micro: u32,
        params: &Params,
        ball: f64,
    ) -> usize {
        let mean_fitness = self.refresh(rules, params) / f64::from(micro);
        let cut = params.delta * mean_fitness;
        let total = self.sum_groups(cut, mean_fitness);
        let at = self.walk(cut, mean_fitness, ball * total);
        at.min(rules.len() - 1)
    }

    /// Brings everything up to date but the sums of votes; returns the sum of all fitness.
    fn refresh(&mut self, rules: &[Classifier], params: &Params) -> f64 {
        let blocks = rules.len().div_ceil(BLOCK);
        self.blocks.truncate(blocks);
        self.votes.truncate(blocks);
        let mut total = 0.0;
        for (at, (block, votes)) in self.blocks.iter_mut().zip(&mut self.votes).enumerate() {
            if block.dirty != 0 {
                block.refresh(votes, &rules[at * BLOCK..], params);
            }
            total += block.fitness;
        }
        total
    }

    /// Sums up the votes under a cut, block by block and group by group.
    fn sum_groups(&mut self, cut: f64, mean_fitness: f64) -> f64 {
        self.groups.clear();
        let groups = self.blocks.chunks_mut(GROUP).zip(self.votes.chunks(GROUP));
        for (blocks, votes) in groups {
            let mut sum = 0.0;
            for (block, votes) in blocks.iter_mut().zip(votes) {
                if cut <= block.cut_above || cut > block.cut_up_to {
                    block.sum_votes(votes, cut);
                }
                sum += block.votes(mean_fitness);
            }
            self.groups.push(sum);
        }
        self.groups.iter().sum()
    }

    /// Walks along the votes until `left` is used up: by groups, by blocks, by rules.
    fn walk(&self, cut: f64, mean_fitness: f64, mut left: f64) -> usize {
        let group = stop(self.groups.iter().copied(), &mut left);
        let blocks = self.blocks[group * GROUP..].iter().take(GROUP);
        let block = group * GROUP + stop(blocks.map(|block| block.votes(mean_fitness)), &mut left);
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

/// The number of the vote at which `left` is used up, or of the last one; what was left before it
/// stays in `left`.
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
    fn votes(&self, mean_fitness: f64) -> f64 {
        self.plain + self.raised * mean_fitness
    }

    /// Looks at the rules that changed; `rules` begins with the rules of the block.
    fn refresh(&mut self, votes: &mut [Vote; BLOCK], rules: &[Classifier], params: &Params) {
        while self.dirty != 0 {
            let at = self.dirty.trailing_zeros() as usize;
            self.dirty &= self.dirty - 1;
            let vote = |rule| Vote::of(rule, params);
            votes[at] = rules.get(at).map_or(NO_RULE, vote);
        }
        self.fitness = votes.iter().map(|vote| vote.fitness).sum();
        // No cut lies there, so the votes will be summed up again.
        (self.cut_above, self.cut_up_to) = (f64::INFINITY, f64::NEG_INFINITY);
    }

    /// Sums up the votes under a cut, and notes for which other cuts the sums hold.
    fn sum_votes(&mut self, votes: &[Vote; BLOCK], cut: f64) {
        (self.plain, self.raised) = (0.0, 0.0);
        (self.cut_above, self.cut_up_to) = (f64::NEG_INFINITY, f64::INFINITY);
        for vote in votes {
            if vote.mean < cut {
                self.raised += vote.raised;
                if vote.mean > self.cut_above {
                    self.cut_above = vote.mean;
                }
            } else {
                self.plain += vote.plain;
                if vote.mean < self.cut_up_to {
                    self.cut_up_to = vote.mean;
                }
            }
        }
    }
}

impl Vote {
    fn of(rule: &Classifier, params: &Params) -> Self {
        let numerosity = f64::from(rule.numerosity);
        let mean = rule.fitness / numerosity;
        let plain = rule.set_size * numerosity;
        let is_experienced = rule.experience > u64::from(params.theta_del);
        Self {
            fitness: rule.fitness,
            mean: if is_experienced { mean } else { f64::INFINITY },
            plain,
            raised: plain / mean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Action;

    fn rule(set_size: f64, fitness: f64, numerosity: u32, experience: u64) -> Classifier {
        let params = Params::default();
        let action = Action::new(0).unwrap();
        Classifier {
            set_size,
            fitness,
            numerosity,
            experience,
            ..Classifier::new("#".parse().unwrap(), action, 0, &params)
        }
    }

    /// The roulette as Butz and Wilson write it, over every rule.
    fn plain_roulette(rules: &[Classifier], params: &Params, ball: f64) -> usize {
        let micro: u32 = rules.iter().map(|r| r.numerosity).sum();
        let mean = rules.iter().map(|r| r.fitness).sum::<f64>() / f64::from(micro);
        let vote = |r: &Classifier| {
            let own = r.fitness / f64::from(r.numerosity);
            let vote = r.set_size * f64::from(r.numerosity);
            if r.experience > 20 && own < params.delta * mean {
                vote * mean / own
            } else {
                vote
            }
        };
        let mut left = ball * rules.iter().map(vote).sum::<f64>();
        let stops = |r: &Classifier| {
            left -= vote(r);
            left < 0.0
        };
        rules.iter().position(stops).unwrap_or(rules.len() - 1)
    }

    #[test]
    fn an_experienced_rule_of_low_fitness_is_more_likely_to_go() {
        // Mean fitness (0.999 + 0.001) / 2 = 0.5, cut 0.05. Votes: 10, and 10 * 0.5 / 0.001 = 5000.
        let rules = [rule(10.0, 0.999, 1, 21), rule(10.0, 0.001, 1, 21)];
        let mut votes = DeletionVotes::default();
        votes.touch(0);
        let mut at = |ball| votes.roulette(&rules, 2, &Params::default(), ball);
        assert_eq!([at(0.0), at(9.9 / 5010.0), at(10.1 / 5010.0)], [0, 0, 1]);
    }

    #[test]
    fn a_young_rule_of_low_fitness_is_spared() {
        let rules = [rule(10.0, 0.999, 1, 21), rule(10.0, 0.001, 1, 20)];
        let mut votes = DeletionVotes::default();
        votes.touch(0);
        let mut at = |ball| votes.roulette(&rules, 2, &Params::default(), ball);
        assert_eq!([at(0.49), at(0.51)], [0, 1]);
    }

    #[test]
    fn the_cached_roulette_stops_where_the_plain_one_does() {
        use crate::random::{Stream, StreamName};
        let mut stream = Stream::new(7, StreamName::Evolution);
        let params = Params::default();
        let random_rule = |s: &mut Stream| {
            rule(
                1.0 + 50.0 * s.unit(),
                s.unit().powi(6) + 1e-9,
                1 + s.below(4) as u32,
                s.below(60) as u64,
            )
        };
        let mut rules: Vec<_> = (0..300).map(|_| random_rule(&mut stream)).collect();
        let mut votes = DeletionVotes::default();
        (0..300).for_each(|i| votes.touch(i));
        for round in 0..5_000 {
            let changed = stream.below(300);
            rules[changed] = random_rule(&mut stream);
            votes.touch(changed);
            let micro = rules.iter().map(|r| r.numerosity).sum();
            let ball = stream.unit();
            assert_eq!(
                votes.roulette(&rules, micro, &params, ball),
                plain_roulette(&rules, &params, ball),
                "round {round}, ball {ball}"
            );
        }
    }
}

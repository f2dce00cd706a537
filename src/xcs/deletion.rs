//! Deletion votes, kept up to date in blocks so that a deletion need not look at every rule.

use super::classifier::Classifier;
use super::params::Params;

/// Rules per block. Small, because a learning step changes rules all over the population, and
/// each change costs summing up its block again.
const BLOCK: usize = 16;

/// Cached sums over the deletion votes of \[P\], by position.
///
/// A rule's vote is `as * num`; an experienced rule whose mean fitness `F / num` lies below the
/// cut `delta * mean F` is unfit, and its vote is raised by `mean F / (F / num)` (Butz and Wilson
/// 2001, DELETION VOTE). All cached figures are pure functions of the rules in a block and of
/// which of them are unfit, so they carry no rounding errors from one step to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct DeletionVotes {
    blocks: Vec<Block>,
}

#[derive(Debug, Clone, Copy)]
struct Block {
    dirty: bool,
    fitness: f64,
    /// The votes of the rules that are not unfit.
    plain: f64,
    /// The votes of the unfit rules, before multiplication by the mean fitness.
    raised: f64,
    /// The classes hold for cuts above this, and
    cut_above: f64,
    /// up to this.
    cut_up_to: f64,
}

const DIRTY: Block = Block {
    dirty: true,
    fitness: 0.0,
    plain: 0.0,
    raised: 0.0,
    cut_above: 0.0,
    cut_up_to: 0.0,
};

impl DeletionVotes {
    /// Notes that the rule at `position` was added or changed.
    pub fn touch(&mut self, position: usize) {
        let block = position / BLOCK;
        if block >= self.blocks.len() {
            self.blocks.resize(block + 1, DIRTY);
        }
        self.blocks[block].dirty = true;
    }

    /// Forgets the blocks beyond `rules` rules.
    pub fn truncate(&mut self, rules: usize) {
        self.blocks.truncate(rules.div_ceil(BLOCK));
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
        for (block, rules) in self.blocks.iter_mut().zip(rules.chunks(BLOCK)) {
            if block.dirty {
                block.fitness = rules.iter().map(|rule| rule.fitness).sum();
            }
        }
        let mean_fitness = self.blocks.iter().map(|b| b.fitness).sum::<f64>() / f64::from(micro);
        let cut = params.delta * mean_fitness;
        for (block, rules) in self.blocks.iter_mut().zip(rules.chunks(BLOCK)) {
            if block.dirty || cut <= block.cut_above || cut > block.cut_up_to {
                block.sum_votes(rules, cut, params);
            }
        }
        let total: f64 = self.blocks.iter().map(|b| b.votes(mean_fitness)).sum();
        self.walk(rules, params, mean_fitness, ball * total)
    }

    /// Walks along the votes until `left` is used up.
    fn walk(
        &self,
        rules: &[Classifier],
        params: &Params,
        mean_fitness: f64,
        mut left: f64,
    ) -> usize {
        let mut block = 0;
        while block + 1 < self.blocks.len() && left >= self.blocks[block].votes(mean_fitness) {
            left -= self.blocks[block].votes(mean_fitness);
            block += 1;
        }
        let last = (block * BLOCK + BLOCK).min(rules.len()) - 1;
        let cut = params.delta * mean_fitness;
        let stops = |rule: &Classifier| {
            left -= match vote(rule, cut, params) {
                Vote::Plain(plain) => plain,
                Vote::Raised(raised) => raised * mean_fitness,
            };
            left < 0.0
        };
        let found = rules[block * BLOCK..=last].iter().position(stops);
        found.map_or(last, |at| block * BLOCK + at)
    }
}

impl Block {
    fn votes(&self, mean_fitness: f64) -> f64 {
        self.plain + self.raised * mean_fitness
    }

    fn sum_votes(&mut self, rules: &[Classifier], cut: f64, params: &Params) {
        *self = Self {
            dirty: false,
            fitness: self.fitness,
            plain: 0.0,
            raised: 0.0,
            cut_above: f64::NEG_INFINITY,
            cut_up_to: f64::INFINITY,
        };
        for rule in rules {
            let mean = rule.fitness / f64::from(rule.numerosity);
            match vote(rule, cut, params) {
                Vote::Plain(plain) => {
                    self.plain += plain;
                    if is_experienced(rule, params) {
                        self.cut_up_to = self.cut_up_to.min(mean);
                    }
                }
                Vote::Raised(raised) => {
                    self.raised += raised;
                    self.cut_above = self.cut_above.max(mean);
                }
            }
        }
    }
}

/// The vote of a rule.
enum Vote {
    /// `as * num`.
    Plain(f64),
    /// `as * num / (F / num)` of an unfit rule, still to be multiplied by the mean fitness.
    Raised(f64),
}

fn vote(rule: &Classifier, cut: f64, params: &Params) -> Vote {
    let numerosity = f64::from(rule.numerosity);
    let plain = rule.set_size * numerosity;
    let mean = rule.fitness / numerosity;
    if is_experienced(rule, params) && mean < cut {
        Vote::Raised(plain / mean)
    } else {
        Vote::Plain(plain)
    }
}

fn is_experienced(rule: &Classifier, params: &Params) -> bool {
    rule.experience > u64::from(params.theta_del)
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

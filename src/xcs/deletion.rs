//! Deletion votes, kept up to date in blocks so that a deletion need not look at every rule.

use super::classifier::Classifier;
use super::params::Params;

/// Rules per block; as many as `Block::dirty` has bits. Larger blocks cost more to sum up again
/// when one of their rules changes, smaller ones make the roulette longer; 32 was best at N 2000.
const BLOCK: usize = 32;
/// Sums run in so many lanes, because additions that wait for each other are slow.
const LANES: usize = 4;

type Column = [f64; BLOCK];

/// Cached deletion votes of \[P\] and their sums, by position.
///
/// A rule's vote is `as * num`; an experienced rule whose mean fitness `F / num` lies below the
/// cut `delta * mean F` is unfit, and its vote is raised by `mean F / (F / num)` (Butz and Wilson
/// 2001, DELETION VOTE). All cached figures are pure functions of the rules in a block and of
/// which of them are unfit, so they carry no rounding errors from one step to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct DeletionVotes {
    blocks: Vec<Block>,
}

/// The votes of [`BLOCK`] rules, in columns; places without a rule have no fitness and no vote.
#[derive(Debug, Clone)]
struct Block {
    /// One bit per rule that was added, changed or removed.
    dirty: u32,
    fitness_sum: f64,
    /// Sums over the votes that are not raised, and over those that are, before multiplication
    /// by the mean fitness.
    votes: (f64, f64),
    /// The sums hold for cuts above the first and up to the second of these.
    cuts: (f64, f64),
    fitness: Column,
    /// `F / num` of experienced rules; infinite for the others, which are never unfit.
    mean: Column,
    /// `as * num`.
    plain: Column,
    /// `as * num / (F / num)`.
    raised: Column,
}

const EMPTY: Block = Block {
    dirty: 0,
    fitness_sum: 0.0,
    votes: (0.0, 0.0),
    cuts: (0.0, 0.0),
    fitness: [0.0; BLOCK],
    mean: [f64::INFINITY; BLOCK],
    plain: [0.0; BLOCK],
    raised: [0.0; BLOCK],
};

impl DeletionVotes {
    /// Notes that the rule at `position` was added, changed or removed.
    pub fn touch(&mut self, position: usize) {
        let block = position / BLOCK;
        if block >= self.blocks.len() {
            self.blocks.resize(block + 1, EMPTY);
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
        self.blocks.truncate(rules.len().div_ceil(BLOCK));
        for (block, rules) in self.blocks.iter_mut().zip(rules.chunks(BLOCK)) {
            block.refresh(rules, params);
        }
        let fitness: f64 = self.blocks.iter().map(|block| block.fitness_sum).sum();
        let mean_fitness = fitness / f64::from(micro);
        let cut = params.delta * mean_fitness;
        let mut total = 0.0;
        for block in &mut self.blocks {
            if cut <= block.cuts.0 || cut > block.cuts.1 {
                block.sum_votes(cut);
            }
            total += block.vote(mean_fitness);
        }
        let at = self.walk(cut, mean_fitness, ball * total);
        at.min(rules.len() - 1)
    }

    /// Walks along the votes until `left` is used up.
    fn walk(&self, cut: f64, mean_fitness: f64, mut left: f64) -> usize {
        let mut at = 0;
        while at + 1 < self.blocks.len() && left >= self.blocks[at].vote(mean_fitness) {
            left -= self.blocks[at].vote(mean_fitness);
            at += 1;
        }
        let block = &self.blocks[at];
        let stops = |&rule: &usize| {
            left -= if block.mean[rule] < cut {
                block.raised[rule] * mean_fitness
            } else {
                block.plain[rule]
            };
            left < 0.0
        };
        at * BLOCK + (0..BLOCK).find(stops).unwrap_or(BLOCK - 1)
    }
}

impl Block {
    fn vote(&self, mean_fitness: f64) -> f64 {
        self.votes.0 + self.votes.1 * mean_fitness
    }

    /// Brings the columns up to date; `rules` are the rules of the block.
    fn refresh(&mut self, rules: &[Classifier], params: &Params) {
        if self.dirty == 0 {
            return;
        }
        while self.dirty != 0 {
            let at = self.dirty.trailing_zeros() as usize;
            self.dirty &= self.dirty - 1;
            self.set(at, rules.get(at), params);
        }
        let (lanes, _) = self.fitness.as_chunks::<LANES>();
        let sums = lanes.iter().fold([0.0; LANES], |sums, lane| {
            std::array::from_fn(|i| sums[i] + lane[i])
        });
        self.fitness_sum = sums.iter().sum();
        // No cut lies between these, so the votes will be summed up again.
        self.cuts = (f64::INFINITY, f64::NEG_INFINITY);
    }

    fn set(&mut self, at: usize, rule: Option<&Classifier>, params: &Params) {
        let Some(rule) = rule else {
            self.fitness[at] = 0.0;
            self.mean[at] = f64::INFINITY;
            self.plain[at] = 0.0;
            return;
        };
        let numerosity = f64::from(rule.numerosity);
        let mean = rule.fitness / numerosity;
        let is_experienced = rule.experience > u64::from(params.theta_del);
        self.fitness[at] = rule.fitness;
        self.mean[at] = if is_experienced { mean } else { f64::INFINITY };
        self.plain[at] = rule.set_size * numerosity;
        self.raised[at] = self.plain[at] / mean;
    }

    /// Sums up the votes under a cut, and notes up to which other cuts the sums hold.
    fn sum_votes(&mut self, cut: f64) {
        let (mut plain, mut raised) = ([0.0; LANES], [0.0; LANES]);
        let (mut above, mut up_to) = ([f64::NEG_INFINITY; LANES], [f64::INFINITY; LANES]);
        for from in (0..BLOCK).step_by(LANES) {
            for lane in 0..LANES {
                let (at, mean) = (from + lane, self.mean[from + lane]);
                let is_unfit = mean < cut;
                plain[lane] += if is_unfit { 0.0 } else { self.plain[at] };
                raised[lane] += if is_unfit { self.raised[at] } else { 0.0 };
                let (low, high) = if is_unfit {
                    (mean, f64::INFINITY)
                } else {
                    (f64::NEG_INFINITY, mean)
                };
                above[lane] = if low > above[lane] { low } else { above[lane] };
                up_to[lane] = if high < up_to[lane] { high } else { up_to[lane] };
            }
        }
        self.votes = (plain.iter().sum(), raised.iter().sum());
        self.cuts = (
            above.into_iter().fold(f64::NEG_INFINITY, f64::max),
            up_to.into_iter().fold(f64::INFINITY, f64::min),
        );
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

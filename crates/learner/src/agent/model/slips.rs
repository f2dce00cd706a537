//! How often moves slip, as far as is seen, and what that means for what is believed.
//!
//! A move that slips does what another action would have done. So what an action does is what mostly
//! came of it, and what else came says how often moves slip: one number, which all pairs tell together.

use serde::{Deserialize, Serialize};

/// Moves slip if pairs that bump have moved, or the other way round, so often, and in such a share of
/// what was tried: in places that merely look alike, walls are seen.
const LEAST_EVIDENCE: u32 = 3;
const LEAST_SHARE: f64 = 0.003;
/// What came mostly is believed when it is so many times as likely as that only slips have come.
const CERTAIN: f64 = 50.0;
/// ... but after so much of a lead at the latest.
const LONGEST_LEAD: u32 = 8;
/// More came of a pair than slips explain if it is more than they make expect by so many deviations, and
/// one more.
const DEVIATIONS: f64 = 4.0;
/// An estimate that differs by less than this share of it is no news.
const SAME: f64 = 0.1;

/// Returns how likely each other action is when a move slips with probability `slip`: another action than the chosen one is
/// executed, each of the others with the same chance. This is what `arena.slip` means, and what all of the learner means
/// by slip.
pub fn each_other(slip: f64, actions: usize) -> f64 {
    slip / actions.saturating_sub(1).max(1) as f64
}

/// The share of moves that slip.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Slips {
    share: f64,
}

/// What speaks for slips.
#[derive(Debug, Clone, Copy, Default)]
pub struct Evidence {
    /// All tries.
    pub all: u32,
    /// Tries of pairs that sometimes bump and sometimes move on, the rarer ones.
    pub mixed: u32,
    /// Tries of pairs that mostly move on ...
    pub moves: u32,
    /// ... and those of them of which something else came.
    pub odd: u32,
}

impl Evidence {
    /// The share of moves that slip.
    pub fn slips(self) -> Slips {
        let share = |part: u32, all: u32| f64::from(part) / f64::from(all.max(1));
        let is_clear = self.mixed >= LEAST_EVIDENCE && share(self.mixed, self.all) >= LEAST_SHARE;
        match is_clear {
            true => Slips {
                share: share(self.odd, self.moves),
            },
            false => Slips::default(),
        }
    }
}

impl Slips {
    /// Do any moves slip?
    pub fn any(self) -> bool {
        self.share > 0.0
    }

    /// By how many tries what mostly came of a pair must be ahead of anything else to be believed.
    pub fn lead(self) -> u32 {
        if !self.any() {
            return 1;
        }
        let odds = (1.0 - self.share) / self.share;
        let mut certainty = odds;
        let mut lead = 1;
        while certainty < CERTAIN && lead < LONGEST_LEAD {
            certainty *= odds;
            lead += 1;
        }
        lead
    }

    /// Do slips explain that of so many tries of a pair so many were odd? If not, it is a pair of several
    /// places that look alike.
    pub fn explain(self, odd: u32, tries: u32) -> bool {
        let tries = f64::from(tries);
        let expected = self.share * tries;
        let deviation = (expected * self.intended()).sqrt();
        f64::from(odd) <= expected + DEVIATIONS * deviation + 1.0
    }

    /// The share of moves that do what was chosen.
    pub fn intended(self) -> f64 {
        1.0 - self.share
    }

    /// What is left of a promise after a step that is tried until it does not slip.
    pub fn discount(self, gamma: f64) -> f64 {
        self.intended() * gamma / (1.0 - self.share * gamma)
    }

    /// What a percept is value of whose actions these are the values, those left out that leave the
    /// robot where it is or of which nothing is known: the best one is chosen, and at a slip each
    /// of the others is as likely. Who is left where he was chooses again.
    pub fn value(self, values: &[Option<f64>], gamma: f64) -> f64 {
        let known = || values.iter().flatten();
        let best = known().copied().fold(0.0, f64::max);
        if best == 0.0 {
            return 0.0;
        }
        let others = known().sum::<f64>() - best;
        let stays = values.len() - known().count();
        let each = each_other(self.share, values.len());
        (self.intended() * best + each * others) / (1.0 - each * gamma * stays as f64)
    }

    /// Is another estimate practically the same?
    pub fn is_like(self, other: Self) -> bool {
        self.any() == other.any()
            && (self.share - other.share).abs() <= SAME * self.share.max(other.share)
    }

    /// Can that be?
    pub fn is_sound(self) -> bool {
        (0.0..=1.0).contains(&self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slips(share: f64) -> Slips {
        Slips { share }
    }

    #[test]
    fn the_more_moves_slip_the_more_tries_it_takes_to_believe_what_a_pair_does() {
        let leads = [0.0, 0.01, 0.05, 0.1, 0.25, 0.6].map(|share| slips(share).lead());
        assert_eq!(leads, [1, 1, 2, 2, 4, 8]);
    }

    #[test]
    fn pairs_with_several_outcomes_tell_of_slips_only_if_some_bump_and_move_on() {
        let evidence = Evidence {
            all: 100,
            mixed: 5,
            moves: 60,
            odd: 12,
        };
        assert_eq!(evidence.slips(), slips(0.2));
        let control = Evidence {
            mixed: 0,
            ..evidence
        };
        assert!(!control.slips().any(), "places that look alike");
    }

    #[test]
    fn slips_explain_some_odd_outcomes_and_not_half_of_many() {
        let explained =
            [5, 12, 13, 50].map(|odd| slips(0.25).explain(odd, if odd < 50 { 20 } else { 100 }));
        assert_eq!(explained, [true, true, true, false]);
        assert!(!slips(0.05).explain(10, 20), "few slip");
    }

    /// A corridor in which one step leads to a goal worth 1 and the others nowhere: by the equation
    /// of Bellman, iterated.
    #[test]
    fn who_is_left_where_he_was_chooses_again() {
        let mut iterated = 0.0;
        for _ in 0..1_000 {
            iterated = 0.7 * 1.0 + 0.1 * 0.5 + 0.2 * 0.9 * iterated;
        }
        let value = slips(0.3).value(&[Some(1.0), None, Some(0.5), None], 0.9);
        assert!((value - iterated).abs() < 1e-12, "{value} {iterated}");
        assert_eq!(slips(0.3).value(&[None, Some(0.0)], 0.9), 0.0);
    }
}

//! Estimates how often moves slip, and how much evidence is needed as a result.
//!
//! A slip has the effect of another action. So the most frequent outcome of a pair is its effect, and the
//! rarer outcomes show how often moves slip. This is one number, estimated from all pairs.

use xcscr_robot::world::each_other;

/// Moves slip if pairs that bump have also moved, or vice versa, at least this often and in this share of
/// all tries. Cells that are merely aliased are ruled out, because walls are visible.
const LEAST_EVIDENCE: u32 = 3;
const LEAST_SHARE: f64 = 0.003;
/// The most frequent outcome is accepted if it is this many times as likely as a series of slips ...
const CERTAIN: f64 = 50.0;
/// ... but after this lead at the latest.
const LONGEST_LEAD: u32 = 8;
/// Slips do not explain the rarer outcomes of a pair if these exceed the expected number by this many
/// standard deviations, plus one.
const DEVIATIONS: f64 = 4.0;
/// The relative difference below which two estimates count as equal.
const SAME: f64 = 0.1;

/// The share of moves that slip.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slips {
    share: f64,
}

/// The evidence of slips.
#[derive(Debug, Clone, Copy, Default)]
pub struct Evidence {
    /// The number of all tries.
    pub all: u32,
    /// The number of the rarer tries of pairs that sometimes bump and sometimes move.
    pub mixed: u32,
    /// The number of tries of pairs that mostly move ...
    pub moves: u32,
    /// ... and of those among them with another outcome.
    pub odd: u32,
}

impl Evidence {
    /// Returns the share of moves that slip.
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
    /// Returns true if any moves slip.
    pub fn any(self) -> bool {
        self.share > 0.0
    }

    /// Returns the lead that the most frequent outcome of a pair needs to be accepted.
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

    /// Returns true if slips explain `odd` rarer outcomes in `tries` tries of a pair. If they do not,
    /// several cells share the pair's percept.
    pub fn explain(self, odd: u32, tries: u32) -> bool {
        let tries = f64::from(tries);
        let expected = self.share * tries;
        let deviation = (expected * self.intended()).sqrt();
        f64::from(odd) <= expected + DEVIATIONS * deviation + 1.0
    }

    /// Returns the share of moves that execute the chosen action.
    pub fn intended(self) -> f64 {
        1.0 - self.share
    }

    /// Returns the discount of an optimistic value over a step that is repeated until it does not slip.
    pub fn discount(self, gamma: f64) -> f64 {
        self.intended() * gamma / (1.0 - self.share * gamma)
    }

    /// Returns the value of a percept from the values of its actions. `None` marks actions that leave the
    /// robot in place or are unknown. The best action is chosen, and a slip executes each other one with
    /// equal probability. A robot left in place chooses again.
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

    /// Returns true if another estimate is practically the same.
    pub fn is_like(self, other: Self) -> bool {
        self.any() == other.any()
            && (self.share - other.share).abs() <= SAME * self.share.max(other.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slips(share: f64) -> Slips {
        Slips { share }
    }

    #[test]
    fn the_more_moves_slip_the_greater_the_required_lead() {
        let leads = [0.0, 0.01, 0.05, 0.1, 0.25, 0.6].map(|share| slips(share).lead());
        assert_eq!(leads, [1, 1, 2, 2, 4, 8]);
    }

    #[test]
    fn several_outcomes_are_evidence_of_slips_only_if_some_pairs_bump_and_move() {
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
        assert!(!control.slips().any(), "aliased cells");
    }

    #[test]
    fn slips_explain_some_odd_outcomes_and_not_half_of_many() {
        let explained =
            [5, 12, 13, 50].map(|odd| slips(0.25).explain(odd, if odd < 50 { 20 } else { 100 }));
        assert_eq!(explained, [true, true, true, false]);
        assert!(!slips(0.05).explain(10, 20), "few slip");
    }

    /// A corridor in which one step leads to a goal with value 1 and the others nowhere, by iterating the
    /// Bellman equation.
    #[test]
    fn a_robot_left_in_place_chooses_again() {
        let mut iterated = 0.0;
        for _ in 0..1_000 {
            iterated = 0.7 * 1.0 + 0.1 * 0.5 + 0.2 * 0.9 * iterated;
        }
        let value = slips(0.3).value(&[Some(1.0), None, Some(0.5), None], 0.9);
        assert!((value - iterated).abs() < 1e-12, "{value} {iterated}");
        assert_eq!(slips(0.3).value(&[None, Some(0.0)], 0.9), 0.0);
    }
}

//! Noticing that the wheels slip.
//!
//! Wheels that slip turn the robot less, or longer, than they count, and the gyro tells at once. Along
//! its way both wheels may spin alike. Then two accounts of where the robot is drift apart: that of the
//! wheels, and that of a floor which cannot speed the robot up so fast. The beams decide between them,
//! by a sequential test (Wald 1945).

use serde::{Deserialize, Serialize};

use crate::{EstimatorParams, STEP_S};

/// Steps after a bump in which wheels slip on any floor.
const AFTER_BUMP: u32 = 10;
/// More deviations than this of what the wheels roll are no noise.
const DEVIATIONS: f64 = 3.0;

/// Accounts that lie nearer to each other than this, in metres, are the same ...
const SAME: f64 = 0.03;
/// ... and with these odds (a logarithm) one of them is right. Beams share the errors of the pose and of
/// the range's scale, so they say less than as many independent ones: with half of it, at noise 3,
/// one in a thousand moves on a floor with grip was held for slippery.
const DECIDED: f64 = 16.0;

/// What the robot remembers of slipping.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Slip {
    /// For so many steps the floor is still held for slippery.
    slippery: u32,
    /// For so many steps slipping says nothing about the floor.
    bumped: u32,
    /// By how much the robot is behind what it believes if the wheels spin, along its heading, in
    /// metres.
    lag: f64,
    /// The logarithm of the odds that they do.
    odds: f64,
}

/// What the beams say about wheels that may spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// They do, and the robot is so many metres behind.
    Spun(f64),
    /// They do not.
    Rolled,
}

/// Steps for which slip is remembered.
fn remembered_steps(params: &EstimatorParams) -> u32 {
    (params.slip_s / STEP_S).round() as u32
}

impl Slip {
    /// Is the floor held for slippery?
    pub(super) fn is_noticed(&self) -> bool {
        self.slippery > 0
    }

    /// One step: by how much each wheel rolled otherwise than the gyro's turn says, and the
    /// deviation of that, in metres.
    pub(super) fn step(
        &mut self,
        disagreement: f64,
        deviation: f64,
        bumped: bool,
        params: &EstimatorParams,
    ) {
        self.slippery = self.slippery.saturating_sub(1);
        self.bumped = self.bumped.saturating_sub(1);
        if bumped {
            self.bumped = AFTER_BUMP;
        }
        let usual = params.slip_mps * STEP_S + DEVIATIONS * deviation;
        if self.bumped == 0 && disagreement.abs() > usual {
            self.slippery = remembered_steps(params);
        }
    }

    /// One step: by how much the wheels rolled farther than a slippery floor lets the robot move.
    pub(super) fn roll(&mut self, excess: f64, bumped: bool) {
        if bumped {
            self.forget_lag();
        } else if !self.is_noticed() {
            self.shift_lag(excess);
        }
        if excess == 0.0 && self.lag.abs() < SAME {
            self.forget_lag();
        }
    }

    /// By how many metres the robot is behind what it believes if the wheels spin; `None` while
    /// that makes no difference.
    pub(super) fn lag(&self) -> Option<f64> {
        (self.lag.abs() >= SAME).then_some(self.lag)
    }

    /// What the robot believes was corrected by so much along its heading; the other account stays.
    pub(super) fn correct(&mut self, along: f64) {
        if self.lag != 0.0 {
            self.shift_lag(along);
        }
    }

    /// Wheels that brake too hard are another account than wheels that speed up too hard: what the
    /// beams said for the one does not speak for the other.
    fn shift_lag(&mut self, by: f64) {
        let before = self.lag;
        self.lag += by;
        if before * self.lag < 0.0 {
            self.odds = 0.0;
        }
    }

    /// A beam fits better, by this logarithm of a likelihood ratio, if the wheels spin.
    pub(super) fn weigh(&mut self, evidence: f64, params: &EstimatorParams) -> Option<Verdict> {
        self.odds += evidence;
        if self.odds.abs() < DECIDED {
            return None;
        }
        let verdict = if self.odds > 0.0 {
            self.slippery = remembered_steps(params);
            Verdict::Spun(self.lag)
        } else {
            Verdict::Rolled
        };
        self.forget_lag();
        Some(verdict)
    }

    fn forget_lag(&mut self) {
        (self.lag, self.odds) = (0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps for which slip is noticed when it is remembered for so long.
    fn noticed_steps(slip_s: f64) -> u32 {
        let params = EstimatorParams {
            slip_s,
            ..EstimatorParams::default()
        };
        let mut slip = Slip::default();
        slip.step(0.1, 0.0, false, &params);
        let mut steps = 0;
        while slip.is_noticed() {
            slip.step(0.0, 0.0, false, &params);
            steps += 1;
        }
        steps
    }

    #[test]
    fn the_time_for_which_slip_is_remembered_is_a_whole_number_of_steps() {
        assert_eq!([0.6, 0.15, 2.0, 0.0].map(noticed_steps), [12, 3, 40, 0]);
    }

    /// After steps with these disagreements, without noise; `bump` is the number of a step.
    fn notices(disagreements: &[f64], bump: Option<usize>) -> bool {
        let (mut slip, params) = (Slip::default(), EstimatorParams::default());
        for (number, &disagreement) in disagreements.iter().enumerate() {
            slip.step(disagreement, 0.0, bump == Some(number), &params);
        }
        slip.is_noticed()
    }

    #[test]
    fn slip_is_noticed_and_forgotten_after_a_while() {
        assert!(notices(&[0.0, 0.02], None));
        assert!(!notices(&[0.0, 0.009], None), "less than the setting");
        let mut long_ago = vec![0.02];
        long_ago.extend([0.0; 40]);
        assert!(notices(&long_ago[..40], None) && !notices(&long_ago, None));
    }

    #[test]
    fn after_a_bump_wheels_slip_on_any_floor() {
        assert!(!notices(&[0.0, 0.02], Some(0)));
        let mut later = vec![0.0; 10];
        later.push(0.02);
        assert!(notices(&later, Some(0)));
    }

    #[test]
    fn what_the_noise_of_the_wheels_explains_is_no_slip() {
        let (mut slip, params) = (Slip::default(), EstimatorParams::default());
        slip.step(0.039, 0.01, false, &params);
        assert!(!slip.is_noticed());
        slip.step(0.041, 0.01, false, &params);
        assert!(slip.is_noticed());
    }

    #[test]
    fn beams_decide_whether_wheels_that_spin_alike_left_the_robot_behind() {
        let params = EstimatorParams::default();
        let mut slip = Slip::default();
        slip.roll(0.1, false);
        assert_eq!(slip.lag(), Some(0.1));
        assert_eq!(slip.weigh(15.0, &params), None, "not yet");
        assert_eq!(slip.weigh(2.0, &params), Some(Verdict::Spun(0.1)));
        assert!(slip.is_noticed() && slip.lag().is_none());
        let mut slip = Slip::default();
        slip.roll(0.1, false);
        assert_eq!(slip.weigh(-17.0, &params), Some(Verdict::Rolled));
        assert!(!slip.is_noticed() && slip.lag().is_none());
    }

    #[test]
    fn what_spoke_for_wheels_that_speed_up_too_hard_does_not_speak_for_wheels_that_brake_too_hard()
    {
        let params = EstimatorParams::default();
        let weighed_after = |by: f64| {
            let mut slip = Slip::default();
            slip.roll(0.1, false);
            assert_eq!(slip.weigh(15.0, &params), None);
            slip.roll(by, false);
            slip.weigh(2.0, &params)
        };
        assert_eq!(weighed_after(-0.2), None, "the lag has changed its sign");
        assert_eq!(
            weighed_after(-0.05),
            Some(Verdict::Spun(0.05)),
            "the control"
        );
    }

    #[test]
    fn a_lag_that_makes_no_difference_is_forgotten() {
        let mut slip = Slip::default();
        slip.roll(0.02, false);
        assert_eq!(slip.lag(), None);
        slip.roll(0.0, false);
        slip.roll(0.02, false);
        assert_eq!(slip.lag(), None, "it does not add up");
        slip.roll(0.02, false);
        assert_eq!(slip.lag(), Some(0.04));
        slip.correct(0.02);
        assert_eq!(slip.lag(), Some(0.06), "the other account stays");
        slip.roll(0.02, true);
        assert_eq!(slip.lag(), None, "a wall stopped it");
    }
}

//! Wheel-slip detection.
//!
//! Slipping wheels turn the robot less, or longer, than they count, and the gyro shows this at
//! once. When driving straight, both wheels may spin alike. Then two hypotheses about the position
//! drift apart: the position by the wheels, and the position on a floor with limited grip. A
//! sequential test (Wald 1945) on the beams decides between them.

use crate::{EstimatorParams, STEP_S};

/// The number of steps after a bump in which wheels slip on any floor.
const AFTER_BUMP: u32 = 10;
/// The number of deviations of the wheel noise above which a disagreement counts as slip.
const DEVIATIONS: f64 = 3.0;

/// The distance in metres below which the two hypotheses are the same ...
const SAME: f64 = 0.03;
/// ... and the log odds at which one of them is accepted. Beams share the errors of the pose and of
/// the range's scale, so they are worth less than independent ones. With half of this threshold, at
/// noise 3, one in a thousand moves on a floor with grip was treated as slippery.
const DECIDED: f64 = 16.0;

/// The state of the wheel-slip detector.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WheelSlip {
    /// The number of steps for which the floor is still treated as slippery.
    slippery: u32,
    /// The number of steps for which slip gives no information about the floor.
    bumped: u32,
    /// The distance by which the robot is behind its estimated position if the wheels spin, along
    /// its heading, in metres.
    lag: f64,
    /// The log odds that the wheels spin.
    odds: f64,
}

/// The result of the sequential test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// The wheels spun, and the robot is this far behind, in metres.
    Spun(f64),
    /// The wheels did not spin.
    Rolled,
}

/// Returns the number of steps for which slip is remembered.
fn remembered_steps(params: &EstimatorParams) -> u32 {
    (params.slip_s / STEP_S).round() as u32
}

impl WheelSlip {
    /// Returns true if the floor is treated as slippery.
    pub(super) fn is_detected(&self) -> bool {
        self.slippery > 0
    }

    /// Processes one step: the distance by which each wheel's count differs from the gyro's turn,
    /// and its deviation, in metres.
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

    /// Processes one step: the distance that the wheels rolled farther than a slippery floor lets
    /// the robot move.
    pub(super) fn roll(&mut self, excess: f64, bumped: bool) {
        if bumped {
            self.forget_lag();
        } else if !self.is_detected() {
            self.shift_lag(excess);
        }
        if excess == 0.0 && self.lag.abs() < SAME {
            self.forget_lag();
        }
    }

    /// Returns the distance in metres by which the robot is behind its estimated position if the
    /// wheels spin. Returns `None` while the two hypotheses are the same.
    pub(super) fn lag(&self) -> Option<f64> {
        (self.lag.abs() >= SAME).then_some(self.lag)
    }

    /// Accounts for a correction of the estimated position along the heading. The other hypothesis
    /// stays.
    pub(super) fn correct(&mut self, along: f64) {
        if self.lag != 0.0 {
            self.shift_lag(along);
        }
    }

    /// Changes the lag. Wheels that brake too hard are another hypothesis than wheels that
    /// accelerate too hard, so the evidence starts again when the sign changes.
    fn shift_lag(&mut self, by: f64) {
        let before = self.lag;
        self.lag += by;
        if before * self.lag < 0.0 {
            self.odds = 0.0;
        }
    }

    /// Adds the evidence of a beam: the log likelihood ratio of wheels that spin to wheels that
    /// roll.
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

    /// Returns the number of steps for which slip stays detected when it is remembered for
    /// `slip_s`.
    fn detected_steps(slip_s: f64) -> u32 {
        let params = EstimatorParams {
            slip_s,
            ..EstimatorParams::default()
        };
        let mut slip = WheelSlip::default();
        slip.step(0.1, 0.0, false, &params);
        let mut steps = 0;
        while slip.is_detected() {
            slip.step(0.0, 0.0, false, &params);
            steps += 1;
        }
        steps
    }

    #[test]
    fn the_time_for_which_slip_is_remembered_is_a_whole_number_of_steps() {
        assert_eq!([0.6, 0.15, 2.0, 0.0].map(detected_steps), [12, 3, 40, 0]);
    }

    /// Returns whether slip is detected after steps with these disagreements, without noise. `bump`
    /// is the number of a step.
    fn detects(disagreements: &[f64], bump: Option<usize>) -> bool {
        let (mut slip, params) = (WheelSlip::default(), EstimatorParams::default());
        for (number, &disagreement) in disagreements.iter().enumerate() {
            slip.step(disagreement, 0.0, bump == Some(number), &params);
        }
        slip.is_detected()
    }

    #[test]
    fn slip_is_detected_and_expires_after_a_while() {
        assert!(detects(&[0.0, 0.02], None));
        assert!(detects(&[0.0, -0.02], None), "to the other side");
        assert!(!detects(&[0.0, 0.009], None), "less than the setting");
        let mut long_ago = vec![0.02];
        long_ago.extend([0.0; 40]);
        assert!(detects(&long_ago[..40], None) && !detects(&long_ago, None));
    }

    #[test]
    fn after_a_bump_wheels_slip_on_any_floor() {
        assert!(!detects(&[0.0, 0.02], Some(0)));
        let mut later = vec![0.0; 10];
        later.push(0.02);
        assert!(detects(&later, Some(0)));
    }

    #[test]
    fn disagreement_within_the_wheel_noise_is_not_slip() {
        let (mut slip, params) = (WheelSlip::default(), EstimatorParams::default());
        slip.step(0.039, 0.01, false, &params);
        assert!(!slip.is_detected());
        slip.step(0.041, 0.01, false, &params);
        assert!(slip.is_detected());
    }

    #[test]
    fn beams_decide_whether_wheels_that_spin_alike_put_the_robot_behind() {
        let params = EstimatorParams::default();
        let mut slip = WheelSlip::default();
        slip.roll(0.1, false);
        assert_eq!(slip.lag(), Some(0.1));
        assert_eq!(slip.weigh(15.0, &params), None, "not yet");
        assert_eq!(slip.weigh(2.0, &params), Some(Verdict::Spun(0.1)));
        assert!(slip.is_detected() && slip.lag().is_none());
        let mut slip = WheelSlip::default();
        slip.roll(0.1, false);
        assert_eq!(slip.weigh(-17.0, &params), Some(Verdict::Rolled));
        assert!(!slip.is_detected() && slip.lag().is_none());
    }

    #[test]
    fn evidence_for_accelerating_too_hard_is_not_evidence_for_braking_too_hard() {
        let params = EstimatorParams::default();
        let weighed_after = |by: f64| {
            let mut slip = WheelSlip::default();
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
    fn a_negligible_lag_is_dropped() {
        let mut slip = WheelSlip::default();
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

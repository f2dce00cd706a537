//! Noticing that the wheels slip.
//!
//! Wheels that slip turn the robot less, or longer, than they count, and the gyro tells. Along its way
//! nothing does at once: there is no accelerometer, and the beams come late. But who slips when it
//! speeds up also slips when it turns, and every way begins with a turn or with holding the heading.

use serde::{Deserialize, Serialize};

use crate::{EstimatorParams, STEP_S};

/// Steps after a bump in which wheels slip on any floor.
const AFTER_BUMP: u32 = 10;
/// More deviations than this of what the wheels roll are no noise.
const DEVIATIONS: f64 = 2.0;

/// What the robot remembers of slipping; all of it in steps.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Slip {
    /// For so long the floor is still held for slippery.
    slippery: u32,
    /// For so long slipping says nothing about the floor.
    bumped: u32,
}

impl Slip {
    /// Is the floor held for slippery?
    pub(super) fn is_noticed(&self) -> bool {
        self.slippery > 0
    }

    /// One step: by how much each wheel rolled otherwise than the gyro's turn says, and the
    /// deviation of that, in cells.
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
            self.slippery = (params.slip_s / STEP_S) as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        slip.step(0.02, 0.01, false, &params);
        assert!(!slip.is_noticed());
        slip.step(0.04, 0.01, false, &params);
        assert!(slip.is_noticed());
    }
}

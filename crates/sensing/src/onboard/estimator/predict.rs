//! Motion prediction from wheels and gyro.

use nalgebra::{UnitComplex, Vector2};

use super::{
    BIAS, BUMP_SLIDE, Estimator, GYRO, HEADING, LAG, LastStep, ROLL, STATES, WHEELS, X, Y,
};
use crate::onboard::angle::{ahead, rotation, square};
use crate::{Readings, STEP_S};

/// The deviation by which the scale of the gyro may change in a step.
const GYRO_WALK: f64 = 1e-5;

/// How much the robot may slip, as deviations.
#[derive(Clone, Copy)]
struct Shares {
    /// Along the heading: a share of the distance that the wheels roll too far for a slippery
    /// floor.
    along: f64,
    /// Sideways: a share of the driven distance times the turned angle.
    sideways: f64,
}

/// The shares while slip is detected ...
const DETECTED: Shares = Shares {
    along: 0.6,
    sideways: 0.6,
};
/// ... while it was detected recently, because the floor may be slippery elsewhere ...
const WARY: Shares = Shares {
    along: 0.4,
    sideways: 0.3,
};
/// ... and otherwise. In long corridors no beam gives the position along the corridor, and larger
/// shares would add up.
const TRUSTING: Shares = Shares {
    along: 0.0,
    sideways: 0.0,
};
/// The number of steps for which slip counts as recent: 10 s.
const WARY_STEPS: u32 = 200;

/// The motion of one step.
struct Motion {
    turned_rad: f64,
    /// The gyro's turn without its bias; 0 without a gyro.
    gyro_rad: f64,
    /// The mean distance that the wheels counted; half of it where a wall holds the robot.
    rolled: f64,
    /// The distance along the heading if the floor is slippery.
    held: f64,
    /// The estimated distance along the heading: `held`, or the distance that the wheels rolled.
    forward: f64,
    /// The distance by which a wheel's count differs from the gyro's turn.
    slipped: f64,
    /// The variance along the heading due to wheels that may spin.
    spun: f64,
    /// The distance that the wheels have rolled too far, since they started to.
    excess: f64,
    /// How much the robot may slip.
    shares: Shares,
    /// True if a bumper closed, and the filter takes that into account.
    bumped: bool,
    has_gyro: bool,
}

impl Estimator {
    /// Moves the state by the readings of wheels and gyro.
    pub(super) fn predict(&mut self, readings: &Readings<'_>) {
        let motion = self.motion(readings);
        let half = rotation(motion.turned_rad / 2.0);
        let middle = self.filter.pose.rotation * half;
        let way = middle * Vector2::new(motion.forward, 0.0);
        self.filter.pose.translation.vector += way;
        self.filter.pose.rotation = UnitComplex::new_normalize((middle * half).into_inner());
        let changed = motion.rolled - self.filter.last.rolled;
        self.filter.last = LastStep {
            way,
            turned_rad: motion.turned_rad,
            forward: motion.forward,
            rolled: motion.rolled,
            held: motion.held,
            excess: motion.excess,
        };
        self.carry_covariance(&motion, ahead(middle), way);
        self.spread_covariance(&motion, ahead(middle), changed);
    }

    /// Computes the motion from wheels and gyro, and tests for wheel slip.
    fn motion(&mut self, readings: &Readings<'_>) -> Motion {
        let [left, right] = readings.rolled_m;
        let base = self.assumed.wheel_base_m;
        let by_wheels = (right - left) / base;
        let gyro_rad = readings
            .turned_rad
            .map(|measured| measured - self.filter.bias * STEP_S);
        let turned_rad = gyro_rad.map_or(by_wheels, |measured| (1.0 + self.filter.gyro) * measured);
        let touches = readings.bumped.contains(&true);
        let bumped = self.params.bump_inflation && touches;
        // Wheels slip where a wall holds the robot: it moved by something between nothing and all.
        let rolled = (left + right) / 2.0 / if bumped { 2.0 } else { 1.0 };
        // A slipping wheel turns the robot less than it counts, and the distance is wrong by the
        // same amount.
        let slipped = (by_wheels - turned_rad) * base / 2.0;
        let deviation = self.assumed.wheel_share * left.abs().max(right.abs());
        let by_rolling = (1.0 + self.filter.wheels + self.filter.roll) * rolled;
        let held = self.held(by_rolling, touches);
        let slip = &mut self.filter.slip;
        // Counting whole ticks alone makes the wheels disagree by less than a tick.
        let disagreement = (slipped.abs() - self.assumed.tick_m).max(0.0);
        slip.step(disagreement, deviation, touches, &self.params);
        slip.roll(by_rolling - held, touches);
        let detected = slip.is_detected();
        self.filter.wary = if detected {
            WARY_STEPS
        } else {
            self.filter.wary.saturating_sub(1)
        };
        let (forward, shares) = match (detected, self.filter.wary) {
            (true, _) => (held, DETECTED),
            (false, 1..) => (by_rolling, WARY),
            (false, 0) => (by_rolling, TRUSTING),
        };
        let (spun, excess) = self.spun(by_rolling - held, shares.along);
        Motion {
            turned_rad,
            gyro_rad: gyro_rad.unwrap_or(0.0),
            rolled,
            held,
            forward,
            spun,
            excess,
            shares,
            slipped,
            bumped,
            has_gyro: readings.turned_rad.is_some(),
        }
    }

    /// Returns the variance along the heading due to wheels that roll `excess` too far for a
    /// slippery floor, and the total excess since they started to. The whole excess has one cause,
    /// so deviations add up, and not variances.
    fn spun(&self, excess: f64, share: f64) -> (f64, f64) {
        let before = self.filter.last.excess;
        let goes_on = excess * before > 0.0;
        let total = if goes_on { before + excess } else { excess };
        let known = if goes_on { square(before) } else { 0.0 };
        (square(share) * (square(total) - known).max(0.0), total)
    }

    /// Returns the distance along the heading if the floor is slippery. Even if the wheels spin,
    /// the floor can accelerate or brake the robot only within its grip. A wall has no such limit.
    fn held(&self, by_rolling: f64, bumped: bool) -> f64 {
        let last = self.filter.last.held;
        // Counting whole ticks alone changes the distance from step to step by less than two ticks.
        let most = self.assumed.slippery_grip_m.max(2.0 * self.assumed.tick_m);
        if bumped {
            by_rolling
        } else {
            by_rolling.clamp(last - most, last + most)
        }
    }

    /// Updates the covariance by a motion without noise.
    fn carry_covariance(&mut self, motion: &Motion, direction: Vector2<f64>, way: Vector2<f64>) {
        // The Jacobian of the motion without its diagonal of ones, times a column or a row.
        let drift = if motion.has_gyro {
            -(1.0 + self.filter.gyro) * STEP_S
        } else {
            0.0
        };
        let moves = |state: [f64; STATES]| {
            let scale = state[WHEELS] + state[ROLL];
            [
                scale * motion.rolled * direction.x - state[HEADING] * way.y,
                scale * motion.rolled * direction.y + state[HEADING] * way.x,
                drift * state[BIAS] + motion.gyro_rad * state[GYRO],
            ]
        };
        let covariance = &mut self.filter.covariance;
        for at in 0..STATES {
            let moved = moves(covariance.column(at).into_owned().data.0[0]);
            (0..3).for_each(|row| covariance[(row, at)] += moved[row]);
        }
        for at in 0..STATES {
            let moved = moves(covariance.row(at).transpose().data.0[0]);
            (0..3).for_each(|column| covariance[(at, column)] += moved[column]);
        }
        covariance.fill_lower_triangle_with_upper_triangle();
    }

    /// Adds the noise of a motion whose distance differs by `changed` from the step before.
    fn spread_covariance(&mut self, motion: &Motion, direction: Vector2<f64>, changed: f64) {
        let assumed = &self.assumed;
        let along = square(assumed.roll_share * motion.rolled)
            + square(0.25 * motion.slipped)
            + square(LAG * changed)
            + motion.spun
            + square(assumed.tick_m) / 12.0
            + 1e-8;
        // The sideways noise of a robot that turns while it drives.
        let skid = square(motion.shares.sideways * motion.forward * motion.turned_rad);
        let slide = if motion.bumped {
            square(motion.rolled) + square(BUMP_SLIDE)
        } else {
            0.0
        };
        let turn = if motion.has_gyro {
            square(assumed.turn_rad)
        } else {
            let arc = motion.rolled / assumed.wheel_base_m;
            square(assumed.wheel_share) * (square(motion.turned_rad) + square(arc))
                + square(assumed.tick_m / assumed.wheel_base_m) / 3.0
        };
        let covariance = &mut self.filter.covariance;
        // Splits the noise into a part for both directions, and the rest along the heading.
        let (slide, along) = (slide + skid, along - skid);
        covariance[(X, X)] += along * square(direction.x) + slide + 1e-8;
        covariance[(Y, Y)] += along * square(direction.y) + slide + 1e-8;
        covariance[(X, Y)] += along * direction.x * direction.y;
        covariance[(Y, X)] += along * direction.x * direction.y;
        covariance[(HEADING, HEADING)] += turn;
        covariance[(BIAS, BIAS)] += square(assumed.bias_walk);
        covariance[(GYRO, GYRO)] += square(GYRO_WALK);
    }
}

//! How the robot moved in a step, by what wheels and gyro tell.

use nalgebra::{UnitComplex, Vector2};

use super::{
    BIAS, BUMP_SLIDE, Estimator, HEADING, LAG, LastStep, ROLL, SPIN, STATES, WHEELS, X, Y,
};
use crate::onboard::angle::{ahead, rotation, square};
use crate::{Readings, STEP_S};

/// The motion of one step.
struct Motion {
    turned_rad: f64,
    /// What the wheels counted, in the mean; half of it where a wall holds the robot.
    rolled: f64,
    /// How far it moved along its heading by the wheels ...
    by_rolling: f64,
    /// ... and if the floor is slippery.
    held: f64,
    /// Which of both it believes.
    forward: f64,
    /// By how much a wheel rolled otherwise than the gyro's turn says.
    slipped: f64,
    /// A bumper closed, and the filter minds.
    bumped: bool,
    has_gyro: bool,
}

impl Estimator {
    /// Moves by what wheels and gyro tell.
    pub(super) fn predict(&mut self, readings: &Readings<'_>) {
        let motion = self.motion(readings);
        let half = rotation(motion.turned_rad / 2.0);
        let middle = self.belief.pose.rotation * half;
        let way = middle * Vector2::new(motion.forward, 0.0);
        self.belief.pose.translation.vector += way;
        self.belief.pose.rotation = UnitComplex::new_normalize((middle * half).into_inner());
        let changed = motion.rolled - self.belief.last.rolled;
        self.belief.last = LastStep {
            way,
            turned_rad: motion.turned_rad,
            forward: motion.forward,
            rolled: motion.rolled,
            held: motion.held,
        };
        self.carry_covariance(&motion, ahead(middle), way);
        self.spread_covariance(&motion, ahead(middle), changed);
    }

    /// What wheels and gyro tell, and whether they show that the wheels slip.
    fn motion(&mut self, readings: &Readings<'_>) -> Motion {
        let [left, right] = readings.rolled_m;
        let base = self.assumed.wheel_base_m;
        let by_wheels = (right - left) / base;
        let bias_rad = self.belief.bias * STEP_S;
        let turned_rad = readings
            .turned_rad
            .map_or(by_wheels, |told| told - bias_rad);
        let touches = readings.bumped.contains(&true);
        let bumped = self.params.bump_inflation && touches;
        // Wheels slip where a wall holds the robot: it moved by something between nothing and all.
        let rolled = (left + right) / 2.0 / if bumped { 2.0 } else { 1.0 };
        // A wheel that slips turns the robot less than it counts: then the way is wrong by as much.
        let slipped = (by_wheels - turned_rad) * base / 2.0;
        let deviation = self.assumed.wheel_share * left.abs().max(right.abs());
        let by_rolling = (1.0 + self.belief.wheels + self.belief.roll) * rolled;
        let held = self.held(by_rolling, touches);
        let slip = &mut self.belief.slip;
        slip.step(slipped, deviation, touches, &self.params);
        slip.roll(by_rolling - held, touches);
        let forward = if slip.is_noticed() { held } else { by_rolling };
        Motion {
            turned_rad,
            rolled,
            by_rolling,
            held,
            forward,
            slipped,
            bumped,
            has_gyro: readings.turned_rad.is_some(),
        }
    }

    /// How far it moves along its heading if the floor is slippery: however fast the wheels spin, the
    /// floor cannot speed it up or slow it down more than by its grip. A wall can.
    fn held(&self, by_rolling: f64, bumped: bool) -> f64 {
        let (last, most) = (self.belief.last.held, self.assumed.slippery_grip_m);
        if bumped {
            by_rolling
        } else {
            by_rolling.clamp(last - most, last + most)
        }
    }

    /// The covariance after a motion without noise.
    fn carry_covariance(&mut self, motion: &Motion, direction: Vector2<f64>, way: Vector2<f64>) {
        // The Jacobian of the motion without its diagonal of ones, times a column or a row.
        let drift = if motion.has_gyro { -STEP_S } else { 0.0 };
        let moves = |heading: f64, scale: f64, bias: f64| {
            [
                scale * motion.rolled * direction.x - heading * way.y,
                scale * motion.rolled * direction.y + heading * way.x,
                drift * bias,
            ]
        };
        let covariance = &mut self.belief.covariance;
        for at in 0..STATES {
            let column = covariance.column(at);
            let moved = moves(column[HEADING], column[WHEELS] + column[ROLL], column[BIAS]);
            (0..3).for_each(|row| covariance[(row, at)] += moved[row]);
        }
        for at in 0..STATES {
            let row = covariance.row(at);
            let moved = moves(row[HEADING], row[WHEELS] + row[ROLL], row[BIAS]);
            (0..3).for_each(|column| covariance[(at, column)] += moved[column]);
        }
    }

    /// Adds the noise of a motion, which differs by `changed` from that of the step before.
    fn spread_covariance(&mut self, motion: &Motion, direction: Vector2<f64>, changed: f64) {
        let assumed = &self.assumed;
        let along = square(assumed.roll_share * motion.rolled)
            + square(0.25 * motion.slipped)
            + square(LAG * changed)
            + square(SPIN * (motion.by_rolling - motion.forward))
            + 1e-8;
        let slide = if motion.bumped {
            square(motion.rolled) + square(BUMP_SLIDE)
        } else {
            0.0
        };
        let turn = if motion.has_gyro {
            square(assumed.turn_share * motion.turned_rad) + square(assumed.turn_rad)
        } else {
            let arc = motion.rolled / assumed.wheel_base_m;
            square(assumed.wheel_share) * (square(motion.turned_rad) + square(arc))
        };
        let covariance = &mut self.belief.covariance;
        covariance[(X, X)] += along * square(direction.x) + slide + 1e-8;
        covariance[(Y, Y)] += along * square(direction.y) + slide + 1e-8;
        covariance[(X, Y)] += along * direction.x * direction.y;
        covariance[(Y, X)] += along * direction.x * direction.y;
        covariance[(HEADING, HEADING)] += turn;
    }
}

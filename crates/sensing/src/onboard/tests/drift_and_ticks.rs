//! Sensors with scale errors, drift and ticks, and sensors with more beams than the filter uses.

use super::*;

/// Returns the final heading error in radians of a robot that turns to and fro in the middle of a
/// cell. Its gyro measures 3 % too much and drifts.
fn heading_error(gyro_scale: f64, gyro_walk_radps: f64, drift_radps2: f64) -> f64 {
    let mut robot = robot();
    robot.noise = 3.0;
    robot.gyro.scale = gyro_scale;
    robot.estimator.gyro_walk_radps = gyro_walk_radps;
    let mut estimator = Estimator::new(&robot);
    estimator.put_down(at(0.5, 0.5), PUT_DOWN);
    let (mut heading, mut bias_rad) = (0.0, 0.0);
    for step in 0..4_000 {
        // Quarter turns with rests, more of them to the left.
        let turned = if step % 10 < 5 {
            0.1 * std::f64::consts::PI
        } else {
            0.0
        };
        let turned = if step % 60 < 20 { -turned } else { turned };
        heading += turned;
        bias_rad += drift_radps2 * STEP_S * STEP_S;
        let half = 0.2 * turned;
        // Beams to the four walls of the cell when the robot rests.
        let rests = step % 10 >= 5;
        let axis = |quarter: u32| f64::from(quarter) * std::f64::consts::FRAC_PI_2 - heading + 0.3;
        let beams: Vec<Return> = (0..if rests { 8 } else { 0 })
            .map(|number| {
                let offset = if number % 2 == 0 { 0.0 } else { -0.6 };
                let (y, x) = libm::sincos(axis(number / 2) + offset);
                beam(x, y, 0.5 / libm::cos(0.3))
            })
            .collect();
        estimator.step(&readings([-half, half], turned * 1.03 + bias_rad, &beams));
    }
    let (y, x) = libm::sincos(heading);
    let truth = UnitComplex::new_unchecked(Complex::new(x, y));
    (estimator.pose().rotation * truth.inverse()).angle().abs()
}

#[test]
fn scale_and_drift_of_the_gyro_are_estimated() {
    let walk = robot().estimator.gyro_walk_radps;
    let errors =
        [(0.0, 0.01), (0.0002, 0.02)].map(|(drift, most)| (heading_error(0.01, walk, drift), most));
    assert!(
        errors.iter().all(|(error, most)| error < most),
        "{errors:?}"
    );
    let without = heading_error(0.01, 0.0, 0.0002);
    assert!(without > 2.0 * errors[1].0, "control: {without} {errors:?}");
}

#[test]
fn the_covariance_is_exactly_symmetric() {
    let mut estimator = estimator(0.5, 0.5);
    for step in 0..200 {
        let beams = [
            beam(0.8, 0.6, 0.62),
            beam(-0.6, 0.8, 0.63),
            beam(1.0, 0.0, 0.51),
        ];
        let turned = if step % 20 < 10 { 0.1 } else { -0.1 };
        estimator.step(&readings([0.001, 0.002], turned, &beams));
        let covariance = estimator.covariance();
        assert_eq!(covariance, covariance.transpose(), "step {step}");
    }
}

/// Returns true if a robot with such ticks detects slip although it rolls without slip.
fn slips_by_counting(tick_m: f64, counted: bool) -> bool {
    let mut robot = robot();
    robot.noise = 0.0;
    robot.encoders.tick_m = tick_m;
    let mut onboard = Onboard::new(&robot);
    onboard.put_down(at(0.5, 0.5));
    let (mut speeds, mut rolled, mut reported) = ([0.0_f64; 2], [0.0_f64; 2], [0.0_f64; 2]);
    let mut slipped = false;
    for step in 0..2_000 {
        let wanted = match step / 40 % 4 {
            0 => [0.033, 0.031],
            1 => [0.01, 0.047],
            2 => [-0.02, -0.024],
            _ => [0.0, 0.0],
        };
        let mut readings = [0.0; 2];
        for side in [0, 1] {
            let change: f64 = wanted[side] - speeds[side];
            speeds[side] += change.clamp(-0.007, 0.007);
            rolled[side] += speeds[side];
            let counted_m = (rolled[side] / tick_m).floor() * tick_m;
            let now = if counted { counted_m } else { rolled[side] };
            readings[side] = now - std::mem::replace(&mut reported[side], now);
        }
        let turned = (speeds[1] - speeds[0]) / 0.4;
        onboard.step(&super::readings(readings, turned, &[]));
        slipped |= onboard.slips();
    }
    slipped
}

#[test]
fn counting_in_ticks_alone_is_never_detected_as_slip() {
    for tick_m in [0.0005, 0.001, 0.008, 0.02, 0.05] {
        assert!(!slips_by_counting(tick_m, true), "{tick_m}");
    }
    assert!(!slips_by_counting(0.001, false), "control: exact counts");
}

#[test]
fn the_onboard_computer_uses_every_nth_beam_of_a_turn() {
    let after = |every: u32, numbers: &[u32]| {
        let mut robot = robot();
        robot.estimator.use_every_nth_beam = every;
        let mut onboard = Onboard::new(&robot);
        onboard.put_down(at(0.5, 0.5));
        let ahead = |&number: &u32| Return {
            number,
            ..beam(1.0, 0.0, 2.47)
        };
        let beams: Vec<Return> = numbers.iter().map(ahead).collect();
        onboard.step(&readings([0.0; 2], 0.0, &beams));
        (onboard.estimate().0, onboard.surroundings().clone())
    };
    let all = after(1, &[0, 1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(after(4, &[0, 1, 2, 3, 4, 5, 6, 7, 8]), after(1, &[0, 4, 8]));
    assert_ne!(after(4, &[0, 1, 2, 3, 4, 5, 6, 7, 8]), all, "control");
}

mod drift_and_ticks;

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex, Vector2};

use super::estimator::Estimator;
use super::mapper;
use super::*;
use crate::{
    BumperParams, EncoderParams, EstimatorParams, FaultParams, GyroParams, LidarParams, Return,
    STEP_S,
};

/// Returns the default robot of the physics arena.
fn robot() -> RobotParams {
    RobotParams {
        noise: 1.0,
        cell_size_m: 1.0,
        wheel_base_m: 0.4,
        careful_acceleration_mps2: 2.9,
        wheel_bias: 0.05,
        wheel_noise: 0.05,
        lidar: LidarParams::default(),
        encoders: EncoderParams::default(),
        gyro: GyroParams::default(),
        bumper: BumperParams::default(),
        estimator: EstimatorParams::default(),
        faults: FaultParams::default(),
    }
}

/// Returns the readings of one step without a bump or a marker.
fn readings(rolled: [f64; 2], turned_rad: f64, beams: &[Return]) -> Readings<'_> {
    Readings {
        rolled_m: rolled,
        turned_rad: Some(turned_rad),
        told: None,
        bumped: [false; 2],
        over_marker: false,
        beams,
    }
}

fn at(x: f64, y: f64) -> Isometry2<f64> {
    Isometry2::from_parts(Translation2::new(x, y), UnitComplex::identity())
}

fn estimator(x: f64, y: f64) -> Estimator {
    let mut estimator = Estimator::new(&robot());
    estimator.put_down(at(x, y), PUT_DOWN);
    estimator
}

/// Returns a beam at the end of a step, in the direction of the unit vector (x, y).
fn beam(x: f64, y: f64, range: f64) -> Return {
    Return {
        number: 0,
        moment: 1.0,
        bearing: UnitComplex::new_unchecked(Complex::new(x, y)),
        range_m: Some(range),
    }
}

#[test]
fn a_straight_drive_adds_up_and_increases_the_variance_along_the_path() {
    let mut estimator = estimator(0.5, 0.5);
    for _ in 0..10 {
        estimator.step(&readings([0.05, 0.05], 0.0, &[]));
    }
    let pose = estimator.pose();
    assert!((pose.translation.vector - Vector2::new(1.0, 0.5)).norm() < 1e-12);
    assert!((estimator.speeds().0 - 1.0).abs() < 1e-12, "m/s");
    // The wheels' scale of 3 % alone contributes 1.5 cm over half a metre; the start contributes 1
    // cm.
    let covariance = estimator.covariance();
    assert!(
        covariance[(0, 0)] > 0.015_f64.powi(2) + 1e-4,
        "{covariance}"
    );
    // Across the heading, an error of 0.01 rad contributes 5 mm.
    let across = 1e-4 + 0.005_f64.powi(2);
    assert!(
        (covariance[(1, 1)] / across - 1.0).abs() < 0.15,
        "{covariance}"
    );
}

#[test]
fn a_quarter_turn_by_the_gyro_ends_facing_north() {
    let mut estimator = estimator(0.5, 0.5);
    let step_rad = std::f64::consts::FRAC_PI_2 / 5.0;
    for _ in 0..5 {
        let half_base = 0.2 * step_rad;
        estimator.step(&readings([-half_base, half_base], step_rad, &[]));
    }
    let pose = estimator.pose();
    assert!((pose.rotation.im - 1.0).abs() < 1e-12 && pose.rotation.re.abs() < 1e-12);
    assert!((pose.translation.vector - Vector2::new(0.5, 0.5)).norm() < 1e-12);
}

#[test]
fn without_a_gyro_the_wheels_give_the_turn() {
    let mut estimator = estimator(0.5, 0.5);
    let without_gyro = Readings {
        turned_rad: None,
        ..readings([-0.02, 0.02], 0.0, &[])
    };
    estimator.step(&without_gyro);
    let turned = estimator.pose().rotation.im;
    assert!(
        (turned - libm::sin(0.1)).abs() < 1e-12,
        "0.04 over a base of 0.4: {turned}"
    );
}

#[test]
fn a_bump_halves_the_distance_and_increases_the_variance() {
    // The distance and variance added by a step at full speed, after a first step without a bump.
    let added = |bumped: bool| {
        let mut estimator = estimator(0.5, 0.5);
        estimator.step(&readings([0.06, 0.06], 0.0, &[]));
        let before = estimator.covariance()[(0, 0)];
        let step = Readings {
            bumped: [bumped, false],
            ..readings([0.06, 0.06], 0.0, &[])
        };
        estimator.step(&step);
        let x = estimator.pose().translation.x;
        (x - 0.56, estimator.covariance()[(0, 0)] - before)
    };
    let (way, variance) = added(true);
    assert!((way - 0.03).abs() < 1e-12, "{way}");
    assert!(variance > 0.03_f64.powi(2) + 0.02_f64.powi(2), "{variance}");
    let (way, variance) = added(false);
    assert!(
        (way - 0.06).abs() < 1e-12 && variance < 1e-4,
        "control: {variance}"
    );
}

#[test]
fn wheels_that_speed_up_may_slip() {
    let mut estimator = estimator(0.5, 0.5);
    let mut added = |rolled: f64| {
        let before = estimator.covariance()[(0, 0)];
        estimator.step(&readings([rolled; 2], 0.0, &[]));
        estimator.covariance()[(0, 0)] - before
    };
    let (speeding_up, steady) = (added(0.06), added(0.06));
    assert!(
        speeding_up > 0.03_f64.powi(2),
        "half of the change: {speeding_up}"
    );
    assert!(steady < 1e-4, "control: {steady}");
}

/// The estimated position is x = 0.5, and a beam to the east comes back after 1.47. The wall is on
/// a line, so it must be at 2, and the robot at about 0.53.
#[test]
fn a_beam_moves_the_estimate_by_the_gain_calculated_by_hand() {
    let mut estimator = estimator(0.5, 0.5);
    estimator.step(&readings([0.0; 2], 0.0, &[beam(1.0, 0.0, 1.47)]));
    // With caution 1.2: 1.2 cm and 1.2 % of the range, and a scale of ranges of 1.2 %. The step
    // itself adds 1e-8 twice, and the quantisation error of ticks of 1 mm.
    let prior = 1e-4 + 2e-8 + 1e-6 / 12.0;
    let measured = (0.012_f64 + 0.012 * 1.47).powi(2) + (0.012_f64 * 1.47).powi(2);
    let gain = prior / (prior + measured);
    let pose = estimator.pose();
    assert!(
        (pose.translation.x - (0.5 + gain * 0.03)).abs() < 1e-9,
        "{pose}, gain {gain}"
    );
    assert!(
        (pose.translation.y - 0.5).abs() < 1e-12,
        "nothing is said about y"
    );
    let posterior = estimator.covariance()[(0, 0)];
    assert!((posterior - (1.0 - gain) * prior).abs() < 1e-12);
}

#[test]
fn a_beam_into_a_corner_or_off_every_line_is_rejected() {
    for (x, y, range) in [(0.6, 0.8, 2.5), (1.0, 0.0, 1.1)] {
        let mut estimator = estimator(0.5, 0.0);
        estimator.step(&readings([0.0; 2], 0.0, &[beam(x, y, range)]));
        let pose = estimator.pose();
        assert_eq!(
            [pose.translation.x, pose.translation.y],
            [0.5, 0.0],
            "{x} {y} {range}"
        );
    }
}

/// Returns the variance along the path after a straight step of a robot that was put down.
fn variance_after(slips: bool) -> f64 {
    let mut estimator = estimator(0.5, 0.5);
    if slips {
        estimator.step(&readings([0.2, -0.2], 0.0, &[]));
        assert!(estimator.slips(), "control");
    }
    estimator.put_down(at(0.5, 0.5), PUT_DOWN);
    estimator.step(&readings([0.05, 0.05], 0.0, &[]));
    estimator.covariance()[(0, 0)]
}

#[test]
fn slip_before_the_robot_was_put_down_does_not_make_it_uncertain() {
    let (after_slip, usual) = (variance_after(true), variance_after(false));
    assert!(after_slip < 1.01 * usual, "{after_slip}, {usual}");
}

/// Four beams along x show that the robot is at 0.7 and not at 0.5.
fn after_disagreeing_beams(batch_check: bool, steps: usize) -> Estimator {
    let mut robot = robot();
    robot.estimator.batch_check = batch_check;
    let mut estimator = Estimator::new(&robot);
    estimator.put_down(at(0.5, 0.5), PUT_DOWN);
    let beams = [beam(1.0, 0.0, 1.3), beam(-1.0, 0.0, 1.7)];
    for _ in 0..steps {
        estimator.step(&readings([0.0; 2], 0.0, &beams));
    }
    estimator
}

#[test]
fn several_disagreeing_beams_inflate_the_covariance_along_their_axis() {
    let mut found = after_disagreeing_beams(true, 1);
    assert_eq!(found.pose().translation.x, 0.5, "two may be outliers");
    found = after_disagreeing_beams(true, 3);
    let moved = found.pose().translation.x;
    assert!(moved > 0.65, "all say that it stands at 0.7: {moved}");
    assert!(found.covariance()[(1, 1)] < 2e-4, "along y none disagrees");
    let sure = after_disagreeing_beams(false, 4);
    let stayed = sure.pose().translation.x;
    assert!(stayed == 0.5 && sure.covariance()[(0, 0)] < 2e-4, "control");
}

/// Returns the position error of a robot that rolls 20 % less than its wheels count, in a corridor
/// with a wall ahead.
fn error_of_a_slow_robot(wheel_bias: f64) -> f64 {
    let mut robot = robot();
    robot.noise = 3.0;
    robot.wheel_bias = wheel_bias;
    let mut estimator = Estimator::new(&robot);
    estimator.put_down(at(0.5, 0.5), PUT_DOWN);
    estimator.begin_action();
    for step in 1..=15 {
        let true_x = 0.5 + 0.056 * f64::from(step);
        let ahead = [beam(1.0, 0.0, 4.0 - true_x)];
        estimator.step(&readings([0.07, 0.07], 0.0, &ahead));
    }
    estimator.pose().translation.x - (0.5 + 0.056 * 15.0)
}

#[test]
fn a_wheel_bias_that_lasts_an_action_is_estimated() {
    let (error, control) = (error_of_a_slow_robot(0.05), error_of_a_slow_robot(0.0));
    assert!(error.abs() < 0.07, "of 0.21 without beams: {error}");
    assert!(
        control > 1.3 * error,
        "control: {control} instead of {error}"
    );
}

/// Returns the estimated position, the true position and whether slip was detected. The robot turns
/// back in a corridor and then sees the wall ahead. Both wheels accelerate with 7.4 metres per
/// square second, the robot with what the floor allows.
fn after_turning_back(floor: f64) -> (f64, f64, bool) {
    let mut estimator = estimator(1.5, 0.5);
    estimator.begin_action();
    let (mut true_x, mut speeds) = (1.5, [-0.03_f64; 2]);
    for step in 1..=24 {
        for (speed, most) in speeds.iter_mut().zip([7.4, floor]) {
            *speed = (*speed + most * STEP_S * STEP_S).min(0.07);
        }
        let [rolled, moved] = speeds;
        true_x += moved;
        let ahead = [-0.06, -0.02, 0.02, 0.06].map(|across| beam(1.0, across, 6.0 - true_x));
        let seen = if step > 14 { &ahead[..] } else { &[] };
        estimator.step(&readings([rolled, rolled], 0.0, seen));
    }
    (estimator.pose().translation.x, true_x, estimator.slips())
}

#[test]
fn beams_detect_wheels_that_spin_alike() {
    let (x, true_x, slips) = after_turning_back(2.9);
    assert!(
        slips && (x - true_x).abs() < 0.05,
        "{x} instead of {true_x}"
    );
    let (x, true_x, slips) = after_turning_back(7.4);
    assert!(!slips, "control: on a floor with grip");
    assert!(
        (x - true_x).abs() < 0.02,
        "control: {x} instead of {true_x}"
    );
}

#[test]
fn each_action_begins_with_an_unknown_wheel_bias() {
    let mut estimator = estimator(0.5, 0.5);
    estimator.begin_action();
    for step in 1..=10 {
        let ahead = [beam(1.0, 0.0, 3.5 - 0.05 * f64::from(step))];
        estimator.step(&readings([0.056, 0.056], 0.0, &ahead));
    }
    let mut learned = estimator.clone();
    estimator.begin_action();
    assert_ne!(learned.filter(), estimator.filter());
    let way = |estimator: &mut Estimator| {
        let before = estimator.pose().translation.x;
        estimator.step(&readings([0.05, 0.05], 0.0, &[]));
        estimator.pose().translation.x - before
    };
    let after = way(&mut estimator);
    assert!(
        way(&mut learned) < after,
        "within the action it knew better"
    );
}

/// Marks a beam of a robot in the middle of a cell, heading east.
fn mark(map: &mut Surroundings, beam: &Return) {
    let ray = estimator(0.5, 0.5).ray(beam, UnitComplex::identity());
    mapper::mark(map, &ray, 1.0, [0.12, 3.0]);
}

#[test]
fn a_beam_marks_free_cells_and_the_wall_that_it_ends_in() {
    let mut map = Surroundings::unknown([0, 0]);
    for _ in 0..3 {
        mark(&mut map, &beam(1.0, 0.0, 2.52));
        mark(&mut map, &beam(0.0, 1.0, 0.49));
    }
    assert!(map.is_free(1, 0) && map.is_free(2, 0) && !map.is_free(3, 0));
    assert!(!map.is_free(0, 1));
    assert!(!map.is_free(-1, 0), "nothing was seen there");
    map.stand_in([2, 0]);
    assert!(
        map.is_free(-1, 0) && !map.is_free(1, 0),
        "as seen from there"
    );
}

#[test]
fn a_beam_that_hits_something_too_near_is_evidence_for_a_wall_and_does_not_move_the_estimate() {
    let close = estimator(0.12, 0.5);
    let ray = |beam: &Return| close.ray(beam, UnitComplex::identity());
    let mut map = Surroundings::unknown([0, 0]);
    let mark = |map: &mut Surroundings, beam: &Return, nearest_m: f64| {
        mapper::mark(map, &ray(beam), 1.0, [nearest_m, 3.0]);
    };
    // Outliers alone would make the wall free.
    for _ in 0..3 {
        mark(&mut map, &beam(-1.0, 0.0, 3.12), 0.15);
    }
    assert!(map.is_free(-1, 0), "control");
    for _ in 0..3 {
        mark(&mut map, &beam(-1.0, 0.0, f64::NEG_INFINITY), 0.15);
    }
    assert!(!map.is_free(-1, 0));
    let mut sensed = close.clone();
    sensed.step(&readings(
        [0.0; 2],
        0.0,
        &[beam(-1.0, 0.0, f64::NEG_INFINITY)],
    ));
    let mut blind = close.clone();
    blind.step(&readings([0.0; 2], 0.0, &[]));
    assert_eq!(sensed.filter(), blind.filter());
}

#[test]
fn a_beam_that_ends_between_lines_is_no_evidence_and_a_dropout_is_weak_evidence() {
    let mut map = Surroundings::unknown([0, 0]);
    let lost = Return {
        range_m: None,
        ..beam(0.0, 1.0, 0.0)
    };
    for _ in 0..3 {
        mark(&mut map, &beam(1.0, 0.0, 1.0));
        mark(&mut map, &lost);
    }
    assert!(!map.is_free(1, 0) && !map.is_free(0, 1));
    (0..2).for_each(|_| mark(&mut map, &lost));
    assert!(map.is_free(0, 1), "five are as good as two that came back");
}

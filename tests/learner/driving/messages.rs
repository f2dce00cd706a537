//! Messages with impossible values: each is a named fault, and the robot rests.

use nalgebra::{Isometry2, UnitComplex, Vector2};

use super::*;

/// Odometry with an impossible value.
fn spoilt(number: usize, odometry: &mut Odometry) {
    let (pose, speeds) = (&mut odometry.pose, &mut odometry.speeds);
    match number {
        0 => pose.translation.x = f64::INFINITY,
        1 => pose.translation.y = f64::NAN,
        2 => pose.rotation = UnitComplex::new_unchecked(nalgebra::Complex::new(f64::NAN, 0.0)),
        3 => speeds.forward_mps = f64::NEG_INFINITY,
        4 => speeds.turn_radps = f64::NAN,
        5 => speeds.forward_mps = 40.0,
        6 => speeds.turn_radps = -100.0,
        7 => pose.translation.x += 5.0,
        _ => *pose *= Isometry2::new(Vector2::zeros(), 3.0),
    }
}

#[test]
fn every_impossible_value_of_odometry_stops_the_robot_while_it_lasts() {
    for number in 0..9 {
        let mut rig = Rig::maze4();
        let tamper = |readings: &mut Readings| {
            for odometry in &mut readings.odometry {
                spoilt(number, odometry);
            }
        };
        let expected = match number {
            0..5 => "invalid-odometry",
            _ => "impossible-odometry",
        };
        let (steps, reported) = rig.steps_to_rest(tamper);
        assert_eq!((steps, reported), (1, vec![expected]), "value {number}");
        assert_eq!(rig.tick(tamper).command, Speeds::REST, "value {number}");
        assert!(rig.after(2).is_empty(), "control: value {number}");
        assert_eq!(drive(&mut rig).0.phase, Phase::AtGoal, "value {number}");
    }
}

#[test]
fn every_impossible_value_of_the_gyro_stops_the_robot_while_it_lasts() {
    let values = [f64::NAN, f64::INFINITY, -1e9];
    let tampers = values.map(|value| (value, 0, "invalid-imu"));
    let late = (0.0, 3_000_000_000, "clocks-disagree");
    for (value, by_ns, expected) in tampers.into_iter().chain([late]) {
        let mut rig = Rig::maze4();
        let (steps, reported) = rig.steps_to_rest(|readings| {
            for imu in &mut readings.imu {
                imu.turn_radps += value;
                imu.stamp_ns += by_ns;
            }
        });
        assert_eq!((steps, reported), (1, vec![expected]));
        assert!(rig.after(2).is_empty(), "control");
        assert_eq!(drive(&mut rig).0.phase, Phase::AtGoal);
    }
}

#[test]
fn stamps_of_another_century_do_not_delay_the_driver() {
    let century_ns = 3_000_000_000_000_000_000;
    let mut rig = Rig::maze4();
    rig.until_it_drives();
    let step = rig.tick(|readings| {
        readings.odometry[0].stamp_ns += century_ns;
        for imu in &mut readings.imu {
            imu.stamp_ns += century_ns;
        }
    });
    let names: Vec<_> = step.faults.iter().map(Fault::name).collect();
    assert_eq!(names, ["clock-jumped", "clocks-disagree"]);
    assert_eq!(step.command, Speeds::REST);
    assert_eq!(
        step.phase,
        Phase::Driving,
        "it has not processed the century"
    );
}

#[test]
fn a_scan_that_is_older_than_half_a_second_is_refused() {
    let mut rig = Rig::maze4();
    let late = |readings: &mut Readings| {
        for odometry in &mut readings.odometry {
            odometry.stamp_ns += 10_000_000_000;
        }
        for scan in &mut readings.scans {
            scan.stamp_ns += 9_400_000_000;
        }
        readings.imu.clear();
    };
    for _ in 0..40 {
        let step = rig.tick(late);
        assert_eq!(step.command, Speeds::REST, "{step:?}");
        assert_eq!(step.phase, Phase::Waiting, "{step:?}");
    }
    let names: Vec<_> = rig.tick(late).faults.iter().map(Fault::name).collect();
    assert!(names.contains(&"clocks-disagree"), "{names:?}");
}

#[test]
fn odometry_that_is_not_of_simulated_time_is_refused() {
    let mut rig = Rig::maze4();
    for number in 0..20 {
        let step = rig.tick(|readings| {
            readings.clock_ns = Some(readings.odometry[0].stamp_ns + 5_000_000_000);
        });
        let names: Vec<_> = step.faults.iter().map(Fault::name).collect();
        assert!(names.contains(&"clocks-disagree"), "{number}: {names:?}");
    }
}

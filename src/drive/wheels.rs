//! The wheels, by the angles of their joints.

use super::checks::{FASTER, MOST_WAY_NS, STEP_M, of_stamps};
use super::fault::Fault;
use super::readings::{JointAngles, Readings};

const SECOND_NS: f64 = 1e9;
/// The maximum age of the joints in nanoseconds.
const AGE_NS: u64 = 150_000_000;

/// The joints of the wheels.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheels {
    /// The names of the left and the right joint.
    pub joints: [String; 2],
    /// The radius of the wheels in metres.
    pub radius_m: f64,
}

/// Takes in the angles of the joints.
#[derive(Debug)]
pub struct WheelWatch {
    wheels: Wheels,
    /// The largest possible speed of a wheel.
    fastest_mps: f64,
    begun_ns: Option<u64>,
    /// The time of the last arrival, its stamp, and the ways of the wheels that were accepted last.
    last: Option<(u64, u64, [f64; 2])>,
    fault: Option<Fault>,
}

/// The ways of the wheels at a time: nanoseconds, and metres.
pub type Rolled = (u64, [f64; 2]);

impl WheelWatch {
    /// Creates a receiver for a robot whose wheels roll at most at this speed in m/s.
    pub fn new(wheels: Wheels, max_mps: f64) -> Self {
        Self {
            wheels,
            fastest_mps: FASTER * max_mps,
            begun_ns: None,
            last: None,
            fault: None,
        }
    }

    /// Takes in the angles that arrived until `steady_ns`, a clock that never jumps. `odometry_ns` is the
    /// stamp of the newest odometry.
    pub fn step(
        &mut self,
        steady_ns: u64,
        readings: &Readings,
        odometry_ns: Option<u64>,
    ) -> (Vec<Rolled>, Vec<Fault>) {
        let begun_ns = *self.begun_ns.get_or_insert(steady_ns);
        let mut all = Vec::new();
        // Other nodes publish other joints.
        let has_wheel = |joints: &&JointAngles| {
            let mut names = joints.names.iter();
            names.any(|name| self.wheels.joints.contains(name))
        };
        let joints: Vec<_> = readings.joints.iter().filter(has_wheel).collect();
        for joints in joints {
            let Some(odometry_ns) = odometry_ns else {
                continue;
            };
            match self.rolled(joints, odometry_ns) {
                Ok(rolled_m) => {
                    self.fault = None;
                    let is_newer = self
                        .last
                        .is_none_or(|(_, at_ns, _)| joints.stamp_ns > at_ns);
                    if is_newer {
                        all.push((joints.stamp_ns, rolled_m));
                        self.last = Some((steady_ns, joints.stamp_ns, rolled_m));
                    }
                }
                Err(fault) => {
                    if matches!(fault, Fault::InvalidJoints { .. }) {
                        // The time that a jump has lasted does not make it possible.
                        self.last = self
                            .last
                            .map(|(at, _, rolled)| (at, joints.stamp_ns, rolled));
                    }
                    self.fault = Some(fault);
                }
            }
        }
        let since_ns = self.last.map_or(begun_ns, |(arrived_ns, ..)| arrived_ns);
        let age_ns = steady_ns.saturating_sub(since_ns);
        let is_old = self.last.is_none() || age_ns > AGE_NS;
        let old = is_old.then(|| Fault::NoJoints(age_ns as f64 / SECOND_NS));
        (all, old.into_iter().chain(self.fault.clone()).collect())
    }

    /// Returns the ways of the wheels in metres.
    fn rolled(&self, joints: &JointAngles, odometry_ns: u64) -> Result<[f64; 2], Fault> {
        let topics = ["/joint_states", "/odom"];
        if let Some(fault) = of_stamps(topics, joints.stamp_ns, odometry_ns) {
            return Err(fault);
        }
        let mut rolled_m = [0.0; 2];
        for (wheel, name) in self.wheels.joints.iter().enumerate() {
            let number = joints.names.iter().position(|found| found == name);
            let angle_rad = number.and_then(|number| joints.angles_rad.get(number));
            let angle_rad = angle_rad.copied().unwrap_or(f64::NAN);
            rolled_m[wheel] = self.wheels.radius_m * angle_rad;
            let before_m = self.last.map(|(_, at_ns, before)| (at_ns, before[wheel]));
            let most_m = before_m.map_or(f64::MAX, |(at_ns, _)| {
                let passed_ns = joints.stamp_ns.saturating_sub(at_ns).min(MOST_WAY_NS);
                STEP_M + passed_ns as f64 / SECOND_NS * self.fastest_mps
            });
            let way_m = rolled_m[wheel] - before_m.map_or(0.0, |(_, before_m)| before_m);
            if !(0.0..=most_m).contains(&way_m.abs()) {
                return Err(Fault::InvalidJoints {
                    joint: name.clone(),
                    angle_rad,
                });
            }
        }
        Ok(rolled_m)
    }
}

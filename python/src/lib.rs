//! The Python module `xcscr._native`: the robot, its recordings, trials and studies of the learners, and XCS on its own.

mod agent;
mod external;
mod learner;
mod plan;
mod process;
mod recording;
mod robot;
mod robots;
mod study;
mod trial;
mod wheels;

use pyo3::prelude::*;

/// The native part of the `xcscr` package.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::agent::Agent;
    #[pymodule_export]
    use super::recording::{Recording, verify_recording};
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::robots::Robots;
    #[pymodule_export]
    use super::study::{Study, run_study};
    #[pymodule_export]
    use super::trial::{Trained, train};
    #[pymodule_export]
    use super::wheels::Wheels;

    use super::*;

    /// Returns the names of the bundled worlds.
    #[pyfunction]
    fn bundled_worlds() -> Vec<&'static str> {
        xcscr_robot::world::bundled_worlds().collect()
    }

    /// Returns the names of the methods.
    #[pyfunction]
    fn methods() -> Vec<&'static str> {
        let all = xcscr_learner::agent::Method::ALL.iter();
        all.map(|method| method.name()).collect()
    }

    /// Returns the names of the sensors.
    #[pyfunction]
    fn sensors() -> Vec<&'static str> {
        let all = xcscr_robot::sensor::Sensor::ALL.iter();
        all.map(|sensor| sensor.name()).collect()
    }
}

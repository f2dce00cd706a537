//! The state of the driver as a message of `diagnostic_msgs`, as `rqt_robot_monitor` shows it.

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::drive::messages::{Header, header};
use crate::drive::{DriverStep, Fault, Phase};

/// The longest time between two messages.
const PERIOD: Duration = Duration::from_secs(1);

/// `diagnostic_msgs/msg/DiagnosticArray`.
#[derive(Debug, Clone, Serialize)]
pub struct DiagnosticArray {
    header: Header,
    status: Vec<DiagnosticStatus>,
}

/// `diagnostic_msgs/msg/DiagnosticStatus`.
#[derive(Debug, Clone, Serialize)]
struct DiagnosticStatus {
    level: u8,
    name: &'static str,
    message: String,
    hardware_id: &'static str,
    values: Vec<KeyValue>,
}

/// `diagnostic_msgs/msg/KeyValue`.
#[derive(Debug, Clone, Serialize)]
struct KeyValue {
    key: &'static str,
    value: String,
}

/// Reports the state when it changes, and once a second.
#[derive(Debug, Default)]
pub struct Diagnostics {
    /// The time of the last message, the phase, and the names of the faults.
    last: Option<(Instant, Phase, Vec<&'static str>)>,
    decisions: u32,
}

impl Diagnostics {
    /// Returns the message about a step, if one is due.
    pub fn of(&mut self, time_ns: u64, step: &DriverStep) -> Option<DiagnosticArray> {
        self.decisions += u32::from(step.decision.is_some());
        let faults: Vec<_> = step.faults.iter().map(Fault::name).collect();
        let is_old = |last: &(Instant, Phase, Vec<&str>)| {
            last.0.elapsed() >= PERIOD || last.1 != step.phase || last.2 != faults
        };
        if !self.last.as_ref().is_none_or(is_old) {
            return None;
        }
        let phase = <&str>::from(step.phase);
        let words: Vec<String> = step.faults.iter().map(Fault::to_string).collect();
        // The levels of the definition: OK, WARN and ERROR.
        let (level, message) = match (step.phase, words.is_empty()) {
            (_, false) => (2, words.join("; ")),
            (Phase::Waiting | Phase::OutOfSteps, true) => (1, phase.to_owned()),
            _ => (0, phase.to_owned()),
        };
        let values = [
            ("phase", phase.to_owned()),
            ("faults", faults.join(" ")),
            ("decisions", self.decisions.to_string()),
        ];
        self.last = Some((Instant::now(), step.phase, faults));
        Some(DiagnosticArray {
            header: header(time_ns, ""),
            status: vec![DiagnosticStatus {
                level,
                name: "xcscr_driver: drive",
                message,
                hardware_id: "",
                values: values.map(|(key, value)| KeyValue { key, value }).to_vec(),
            }],
        })
    }
}

//! Moves messages of an episode to the clock of the highlights recording.

use std::collections::BTreeMap;

use foxglove::messages::FrameTransforms;

use crate::record::topics::{Topic, WellKnown, nanoseconds, timestamp};

/// The minimum time between two poses of a frame on the clock of the highlights recording.
const POSE_PERIOD_NS: u64 = 50_000_000;

/// The mapping of a time span to a shorter or equal span of the highlights recording.
#[derive(Debug, Clone, Copy)]
pub struct Tempo {
    /// The start on the original clock.
    pub from_ns: u64,
    /// The original duration.
    pub length_ns: u64,
    /// The start in the highlights recording.
    pub begin_ns: u64,
    /// The duration in the highlights recording; at most the original duration.
    pub shown_ns: u64,
    /// The episode number in the highlights recording, if it differs from the original.
    pub episode: Option<u32>,
}

impl Tempo {
    /// Converts a time to the clock of the highlights recording.
    pub fn at(&self, time_ns: u64) -> u64 {
        let since = u128::from(time_ns.saturating_sub(self.from_ns).min(self.length_ns));
        let shown = since * u128::from(self.shown_ns) / u128::from(self.length_ns.max(1));
        self.begin_ns + shown as u64
    }

    /// Returns the speed-up factor.
    pub fn speed(&self) -> f64 {
        self.length_ns as f64 / self.shown_ns.max(1) as f64
    }

    /// Returns the end in the highlights recording.
    pub fn end_ns(&self) -> u64 {
        self.begin_ns + self.shown_ns
    }
}

/// Returns the message at its new time; `Err` describes its fault.
pub fn retimed(topic: Topic, data: &[u8], tempo: &Tempo) -> Result<Vec<u8>, String> {
    let Some(mut message) = WellKnown::decode(topic, data)? else {
        return match tempo.episode {
            Some(episode) => renumbered(data, episode).map_err(|fault| fault.to_string()),
            None => Ok(data.to_vec()),
        };
    };
    for time in message.times() {
        *time = timestamp(tempo.at(nanoseconds(*time)));
    }
    match &mut message {
        WellKnown::Frames(frames) => thin_out(frames),
        WellKnown::Log(line) if tempo.episode.is_some() => {
            line.message = line.message.replacen("episode 1 ", "the last drive ", 1);
        }
        _ => {}
    }
    Ok(message.encode())
}

/// Returns a JSON message with another episode number.
fn renumbered(data: &[u8], episode: u32) -> serde_json::Result<Vec<u8>> {
    let mut fields: serde_json::Map<String, serde_json::Value> = serde_json::from_slice(data)?;
    if let Some(number) = fields.get_mut("episode") {
        *number = episode.into();
    }
    serde_json::to_vec(&fields)
}

/// Removes poses that are too close in time. The last one of each frame stays.
fn thin_out(message: &mut FrameTransforms) {
    let numbered = message.transforms.iter().enumerate();
    let last: BTreeMap<String, usize> = numbered
        .map(|(at, frame)| (frame.child_frame_id.clone(), at))
        .collect();
    let mut kept_ns: BTreeMap<String, u64> = BTreeMap::new();
    let mut at = 0..;
    message.transforms.retain(|frame| {
        let now_ns = frame.timestamp.map_or(0, nanoseconds);
        let is_last = last.get(&frame.child_frame_id) == at.next().as_ref();
        let before = kept_ns.get(&frame.child_frame_id);
        let is_due = before.is_none_or(|before| now_ns >= before + POSE_PERIOD_NS);
        if is_due {
            kept_ns.insert(frame.child_frame_id.clone(), now_ns);
        }
        is_due || is_last
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_span_is_moved_and_shortened_and_keeps_its_order() {
        let tempo = Tempo {
            from_ns: 100,
            length_ns: 40,
            begin_ns: 7,
            shown_ns: 10,
            episode: None,
        };
        assert_eq!([100, 102, 120, 140].map(|at| tempo.at(at)), [7, 7, 12, 17]);
        assert_eq!((tempo.end_ns(), tempo.speed()), (17, 4.0));
    }

    #[test]
    fn a_message_of_the_last_drive_has_the_number_of_the_episodes_before_it() {
        let message = renumbered(br#"{"episode":1,"step":3,"values":[0.5]}"#, 180).unwrap();
        assert_eq!(message, br#"{"episode":180,"step":3,"values":[0.5]}"#);
        assert_eq!(renumbered(br#"{"x":1}"#, 180).unwrap(), br#"{"x":1}"#);
        assert!(renumbered(b"[1]", 180).is_err());
    }
}

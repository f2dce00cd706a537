//! The encoders: the rolled distance of the wheels in ticks.

use crate::EncoderParams;
use xcs::random::Stream;

/// Counts ticks of both wheels. A wheel is slightly larger or smaller than its nominal size.
#[derive(Debug, Clone)]
pub(super) struct Encoders {
    tick: f64,
    scale: [f64; 2],
    /// Ticks since the reset.
    ticks: [i64; 2],
}

impl Encoders {
    /// Creates the encoders of the robot with `stream`, at a noise level.
    pub(super) fn new(params: &EncoderParams, level: f64, mut stream: Stream) -> Self {
        let mut scale = || 1.0 + level * params.scale * stream.normal();
        Self {
            tick: params.tick_m,
            scale: [scale(), scale()],
            ticks: [0; 2],
        }
    }

    /// Resets the counts.
    pub(super) fn reset(&mut self) {
        self.ticks = [0; 2];
    }

    /// Returns the rolled distances since the last reading, given the total distances `travel`.
    pub(super) fn read(&mut self, travel: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|side| {
            let ticks = (travel[side] * self.scale[side] / self.tick).floor() as i64;
            let new = ticks - std::mem::replace(&mut self.ticks[side], ticks);
            new as f64 * self.tick
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoders(level: f64) -> Encoders {
        Encoders::new(&EncoderParams::default(), level, Stream::new(1, 9_u64))
    }

    #[test]
    fn whole_ticks_are_counted_and_the_rest_is_kept_for_later() {
        let mut encoders = encoders(0.0);
        let read = [0.0014, 0.0028, 0.0042].map(|way| encoders.read([way, -way])[0]);
        assert_eq!(read, [0.001, 0.001, 0.002]);
    }

    #[test]
    fn backward_counts_backward() {
        let mut encoders = encoders(0.0);
        encoders.read([0.5, 0.5]);
        assert_eq!(encoders.read([0.4995, 0.5]), [-0.001, 0.0]);
    }

    #[test]
    fn the_scale_of_a_wheel_belongs_to_the_robot() {
        let read = |level| encoders(level).read([100.0, 100.0]);
        assert_eq!(read(0.0), [100.0, 100.0]);
        assert_eq!(read(1.0), read(1.0));
        let [left, right] = read(1.0);
        assert!(
            left != right && (left - 100.0).abs() < 12.0,
            "{left} {right}"
        );
    }
}

//! The beams of the lidar as whole turns.

use std::f64::consts::TAU;

use super::messages::LaserScan;
use crate::arena::{Beam, LidarParams};
use crate::record::topics::scan::angle;

/// Gathers beams until the lidar has turned round.
pub struct Turns {
    lidar: LidarParams,
    range_max_m: f64,
    turn: Option<Turn>,
}

/// A turn that is not over.
struct Turn {
    /// When its first beam was due.
    begin_ns: u64,
    /// The number of its last beam.
    last: usize,
    /// By the number of a beam, counted from ahead: infinity where nothing came back (REP 117), not a
    /// number where no beam was sent.
    ranges: Vec<f32>,
}

impl Turns {
    /// Of such a lidar, which sees as far as `range_max_m` metres.
    pub fn new(lidar: LidarParams, range_max_m: f64) -> Self {
        Self {
            lidar,
            range_max_m,
            turn: None,
        }
    }

    /// Adds a beam; gives the turn before it when it begins a new one, and its own when it ends one.
    pub fn beam(&mut self, beam: &Beam) -> Option<LaserScan> {
        let beams = self.lidar.beams as usize;
        let apart_rad = TAU / beams as f64;
        let number = (angle(beam.bearing) / apart_rad).round() as usize % beams;
        let over = match &self.turn {
            Some(turn) if number < turn.last => self.end(),
            _ => None,
        };
        let apart_ns = 1e9 / (self.lidar.rate_hz * beams as f64);
        let since_ns = (number as f64 * apart_ns).round() as u64;
        let turn = self.turn.get_or_insert_with(|| Turn {
            begin_ns: beam.time_ns.saturating_sub(since_ns),
            last: number,
            ranges: vec![f32::NAN; beams],
        });
        turn.last = number;
        turn.ranges[number] = beam.range_m.map_or(f32::INFINITY, |range_m| range_m as f32);
        match over {
            None if number + 1 == beams => self.end(),
            over => over,
        }
    }

    /// Ends a turn, also one that lacks beams.
    pub fn end(&mut self) -> Option<LaserScan> {
        let Turn {
            begin_ns, ranges, ..
        } = self.turn.take()?;
        Some(LaserScan::new(
            begin_ns,
            &self.lidar,
            self.range_max_m,
            ranges,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, UnitComplex};

    /// Turns of a lidar with four beams, five times a second: a beam every 50 ms.
    fn turns() -> Turns {
        let lidar = LidarParams {
            beams: 4,
            ..LidarParams::default()
        };
        Turns::new(lidar, 8.0)
    }

    fn beam(number: u64, range_m: Option<f64>) -> Beam {
        let (sine, cosine) = libm::sincos(number as f64 * TAU / 4.0);
        Beam {
            time_ns: number * 50_000_000,
            bearing: UnitComplex::new_unchecked(Complex::new(cosine, sine)),
            range_m,
        }
    }

    fn ranges(scan: Option<LaserScan>) -> Option<Vec<String>> {
        let show = |range: &f32| range.to_string();
        scan.map(|scan| scan.ranges.iter().map(show).collect())
    }

    #[test]
    fn a_turn_ends_with_its_last_beam_and_where_beams_are_missing_nothing_is_claimed() {
        let mut turns = turns();
        let mut sent = |number, range_m| ranges(turns.beam(&beam(number, range_m)));
        // The first turn begins in the middle; of the second the last beam is lost.
        assert_eq!(sent(2, Some(1.5)), None);
        assert_eq!(sent(3, None).unwrap(), ["NaN", "NaN", "1.5", "inf"]);
        assert_eq!([sent(4, Some(1.0)), sent(6, Some(3.0))], [None, None]);
        assert_eq!(sent(8, None).unwrap(), ["1", "NaN", "3", "NaN"]);
        assert_eq!(ranges(turns.end()).unwrap(), ["inf", "NaN", "NaN", "NaN"]);
        assert!(turns.end().is_none());
    }
}

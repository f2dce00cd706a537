//! Groups the beams of the lidar into whole turns.

use std::f64::consts::TAU;

use crate::arena::{Beam, LidarParams};
use crate::drive::Scan;
use crate::record::topics::scan::angle;

/// Collects beams into turns.
pub struct Turns {
    lidar: LidarParams,
    turn: Option<Turn>,
}

/// An unfinished turn.
struct Turn {
    /// The time of its first beam.
    begin_ns: u64,
    /// The number of its last beam.
    last: usize,
    /// The ranges by beam number, counted from straight ahead. Infinity means no echo, and minus
    /// infinity an echo that is too near (REP 117). NaN means that no beam was sent.
    ranges_m: Vec<f64>,
}

impl Turns {
    /// Creates an empty group.
    pub fn new(lidar: LidarParams) -> Self {
        Self { lidar, turn: None }
    }

    /// Adds a beam. Returns the previous turn if the beam starts a new turn, or its own turn if the beam is the
    /// last one.
    pub fn beam(&mut self, beam: &Beam) -> Option<Scan> {
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
            ranges_m: vec![f64::NAN; beams],
        });
        turn.last = number;
        turn.ranges_m[number] = beam.range_m.unwrap_or(f64::INFINITY);
        match over {
            None if number + 1 == beams => self.end(),
            over => over,
        }
    }

    /// Ends the current turn, even if beams are missing.
    pub fn end(&mut self) -> Option<Scan> {
        let turn = self.turn.take()?;
        Some(Scan::of_turn(turn.begin_ns, &self.lidar, turn.ranges_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, UnitComplex};

    /// Returns the turns of a lidar with four beams, five times a second: a beam every 50 ms.
    fn turns() -> Turns {
        let lidar = LidarParams {
            beams: 4,
            ..LidarParams::default()
        };
        Turns::new(lidar)
    }

    fn beam(number: u64, range_m: Option<f64>) -> Beam {
        let (sine, cosine) = libm::sincos(number as f64 * TAU / 4.0);
        Beam {
            time_ns: number * 50_000_000,
            bearing: UnitComplex::new_unchecked(Complex::new(cosine, sine)),
            range_m,
        }
    }

    fn ranges(scan: Option<Scan>) -> Option<Vec<String>> {
        let show = |range: &f64| range.to_string();
        scan.map(|scan| scan.ranges_m.iter().map(show).collect())
    }

    #[test]
    fn a_turn_ends_with_its_last_beam_and_missing_beams_are_not_a_number() {
        let mut turns = turns();
        let mut sent = |number, range_m| ranges(turns.beam(&beam(number, range_m)));
        // The first turn begins in the middle; the last beam of the second is missing.
        assert_eq!(sent(2, Some(1.5)), None);
        assert_eq!(sent(3, None).unwrap(), ["NaN", "NaN", "1.5", "inf"]);
        let too_near = Some(f64::NEG_INFINITY);
        assert_eq!([sent(4, Some(1.0)), sent(6, too_near)], [None, None]);
        assert_eq!(sent(8, None).unwrap(), ["1", "NaN", "-inf", "NaN"]);
        assert_eq!(ranges(turns.end()).unwrap(), ["inf", "NaN", "NaN", "NaN"]);
        assert!(turns.end().is_none());
    }
}

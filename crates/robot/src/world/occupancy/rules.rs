//! The meaning of the pixels of a map, by the rules of Nav2's map server (`map_io`) in ROS 2
//! Humble.

use super::Occupancy;

/// The values of free, occupied and unknown cells in messages of type `nav_msgs/OccupancyGrid`.
const FREE: i8 = 0;
const OCCUPIED: i8 = 100;
pub(super) const UNKNOWN: i8 = -1;
/// The full level of a channel.
const FULL: u32 = 65_535;
/// The grey level with which Nav2 saves unknown cells.
const SAVED_UNKNOWN: u32 = 205 * 257;

/// The interpretation of grey levels (Nav2's `MapMode`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mode {
    /// Free, occupied or unknown, by two thresholds.
    Trinary,
    /// Like `Trinary`, with intermediate values between the thresholds.
    Scale,
    /// The grey level is the occupancy in percent; above 100, unknown.
    Raw,
}

/// A pixel of an image, each channel from 0 to 65535.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pixel {
    /// The sum of red, green and blue.
    pub colours: u32,
    /// The opacity, in images that have one.
    pub alpha: Option<u32>,
}

impl Pixel {
    /// Returns the grey level from 0 to 255.
    pub fn grey(self) -> u8 {
        ((self.colours / 3 + 128) / 257) as u8
    }
}

/// Mode and thresholds of a map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    pub mode: Mode,
    pub negate: bool,
    pub occupied_thresh: f64,
    pub free_thresh: f64,
}

impl Rules {
    /// Returns the value of a pixel: 0 free, 100 occupied, -1 unknown, or between 0 and 100.
    pub fn value(&self, pixel: Pixel) -> i8 {
        let (sum, channels) = match (self.mode, pixel.alpha) {
            (Mode::Trinary, Some(alpha)) => (pixel.colours + alpha, 4.0),
            _ => (pixel.colours, 3.0),
        };
        // The order of the operations is the same as in Nav2, because it decides at a threshold.
        let shade = f64::from(sum) / channels / f64::from(FULL);
        let occupied = if self.negate { shade } else { 1.0 - shade };
        match self.mode {
            Mode::Raw => match (shade * 255.0).round() {
                percent if percent <= 100.0 => percent as i8,
                _ => UNKNOWN,
            },
            Mode::Scale if pixel.alpha.is_some_and(|alpha| alpha < FULL) => UNKNOWN,
            _ if self.occupied_thresh < occupied => OCCUPIED,
            _ if occupied < self.free_thresh => FREE,
            Mode::Trinary => UNKNOWN,
            Mode::Scale => {
                let share =
                    (occupied - self.free_thresh) / (self.occupied_thresh - self.free_thresh);
                (share * 100.0).round_ties_even() as i8
            }
        }
    }

    /// Returns true if releases of Nav2 after Humble interpret the pixel differently. Their
    /// thresholds are inclusive, they round grey levels to 8 bits and compare in single precision,
    /// and pixels that are not opaque are unknown.
    pub fn is_disputed(&self, pixel: Pixel) -> bool {
        if self.mode == Mode::Raw {
            return false;
        }
        let shade = f32::from(pixel.grey()) / 255.0;
        let occupied = if self.negate { shade } else { 1.0 - shade };
        let later = match () {
            () if pixel.alpha.is_some_and(|alpha| alpha < FULL) => Occupancy::Unknown,
            () if occupied <= self.free_thresh as f32 => Occupancy::Free,
            () if occupied >= self.occupied_thresh as f32 => Occupancy::Occupied,
            () => Occupancy::Unknown,
        };
        later != self.occupancy(self.value(pixel))
    }

    /// Returns true if a pixel counts as free but has the grey level of unknown ones.
    pub fn is_unknown_as_free(&self, pixel: Pixel) -> bool {
        self.mode != Mode::Raw && pixel.colours == 3 * SAVED_UNKNOWN && self.value(pixel) == FREE
    }

    /// Returns the occupancy for a value. Intermediate values of the mode `scale` are unknown;
    /// percentages of the mode `raw` are compared with the thresholds.
    pub fn occupancy(&self, value: i8) -> Occupancy {
        let percent = f64::from(value) / 100.0;
        match value {
            FREE => Occupancy::Free,
            OCCUPIED => Occupancy::Occupied,
            _ if self.mode != Mode::Raw || value == UNKNOWN => Occupancy::Unknown,
            _ if self.occupied_thresh < percent => Occupancy::Occupied,
            _ if percent < self.free_thresh => Occupancy::Free,
            _ => Occupancy::Unknown,
        }
    }
}

//! Exported source code that converts a pose to a percept: the grid in the map frame, the robot's
//! dimensions, and percepts from a map or from a scan.
//!
//! The parts that are the same in every export are files of source code in this folder. They are
//! placed after constants that come from the plan.

use std::fmt::Write;

use super::Provenance;
use crate::sensor::Sensor;

/// The most cells between the robot and the cell in which its scan began: it moves by one cell, and
/// its estimate may jump by another.
const MOVES: usize = 2;

/// The code that is the same in every export to a language.
struct Code {
    frame: &'static str,
    neighbours: &'static str,
    lidar: &'static str,
    strides: &'static str,
    around: &'static str,
    ranges: &'static str,
    beams: &'static str,
    scan: &'static str,
}

const C: Code = Code {
    frame: include_str!("frame.h"),
    neighbours: include_str!("neighbours.h"),
    lidar: include_str!("lidar.h"),
    strides: include_str!("strides.h"),
    around: include_str!("around.h"),
    ranges: include_str!("ranges.h"),
    beams: include_str!("beams.h"),
    scan: include_str!("scan.h"),
};

const RUST: Code = Code {
    frame: include_str!("frame.rs"),
    neighbours: include_str!("neighbours.rs"),
    lidar: include_str!("lidar.rs"),
    strides: include_str!("strides.rs"),
    around: include_str!("around.rs"),
    ranges: include_str!("ranges.rs"),
    beams: include_str!("beams.rs"),
    scan: include_str!("scan.rs"),
};

const PYTHON: Code = Code {
    frame: include_str!("frame.py"),
    neighbours: include_str!("neighbours.py"),
    lidar: include_str!("lidar.py"),
    strides: include_str!("strides.py"),
    around: include_str!("around.py"),
    ranges: include_str!("ranges.py"),
    beams: include_str!("beams.py"),
    scan: include_str!("scan.py"),
};

impl Code {
    /// Returns the parts that a sensor needs.
    fn of(&self, sensor: Sensor) -> String {
        let ring: &[&str] = match sensor {
            Sensor::Neighbours | Sensor::Position | Sensor::NeighboursPosition => {
                &[self.neighbours]
            }
            Sensor::Lidar | Sensor::LidarPosition => &[self.lidar, self.around],
            Sensor::LidarRanges => &[self.lidar, self.strides, self.ranges],
            Sensor::LidarBeams => &[self.lidar, self.strides, self.beams],
        };
        let scan = reach(sensor).map_or("", |_| self.scan);
        [self.frame, &ring.concat(), scan].concat()
    }
}

/// Returns how many cells in each direction a scan stores; `None` for percepts that no scan shows.
fn reach(sensor: Sensor) -> Option<usize> {
    let looked_at = match sensor {
        Sensor::Neighbours | Sensor::Position | Sensor::NeighboursPosition => return None,
        Sensor::Lidar | Sensor::LidarPosition => 1,
        Sensor::LidarRanges => 3,
        Sensor::LidarBeams => 7,
    };
    Some(looked_at + MOVES)
}

/// The representation of percepts that the policy takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// Bytes; in Python a string of 0 and 1.
    Bytes,
    /// A 16-bit number.
    Number,
}

impl Form {
    /// Returns the declarations in C.
    fn c99(self) -> &'static str {
        match self {
            Self::Bytes => {
                "\n/* A percept is an array of XCSCR_PERCEPT_BYTES of these. */\ntypedef uint8_t xcscr_word;\n\
                 #define XCSCR_WORD_BITS 8\n#define XCSCR_WORDS XCSCR_PERCEPT_BYTES\n"
            }
            Self::Number => {
                "\n/* A percept is one of these. */\ntypedef uint16_t xcscr_word;\n\
                 #define XCSCR_WORD_BITS 16\n#define XCSCR_WORDS 1\n"
            }
        }
    }

    /// Returns the declarations in Rust.
    fn rust(self) -> &'static str {
        match self {
            Self::Bytes => include_str!("bytes.rs"),
            Self::Number => include_str!("number.rs"),
        }
    }
}

/// The value of a constant.
#[derive(Debug, Clone, Copy)]
enum Value {
    Real(f64),
    /// An integer, and its type in Rust.
    Whole(usize, &'static str),
    Flag(bool),
}

/// A constant: its name, its value and its description.
type Constant = (&'static str, Value, &'static str);

/// Returns all constants of an export.
fn constants(provenance: &Provenance) -> Vec<Constant> {
    use Value::{Flag, Real, Whole};
    let (maze, sensor) = (provenance.maze(), provenance.sensor());
    let corner = maze.origin();
    let [of_column, of_row] = sensor.place_bits(maze);
    let ring = sensor.width(maze) - of_column - of_row;
    let mut all = vec![
        ("CELL_SIZE_M", Real(maze.cell_size_m()), "edge of a cell, m"),
        (
            "COLUMNS",
            Whole(maze.width().into(), "u16"),
            "cells from west to east",
        ),
        (
            "ROWS",
            Whole(maze.height().into(), "u16"),
            "cells from north to south",
        ),
        ("WRAPS", Flag(maze.wraps()), "whether the edges join"),
        (
            "ORIGIN_X_M",
            Real(corner.x_m),
            "south-western corner in the map frame, m",
        ),
        (
            "ORIGIN_Y_M",
            Real(corner.y_m),
            "south-western corner in the map frame, m",
        ),
        (
            "ORIGIN_COSINE",
            Real(libm::cos(corner.yaw_rad)),
            "cosine of the grid's yaw in the map frame",
        ),
        (
            "ORIGIN_SINE",
            Real(libm::sin(corner.yaw_rad)),
            "sine of the grid's yaw in the map frame",
        ),
    ];
    if let Some(robot) = provenance.robot() {
        all.extend([
            (
                "ROBOT_RADIUS_M",
                Real(robot.radius_m),
                "radius of the robot, m",
            ),
            (
                "WHEEL_BASE_M",
                Real(robot.wheel_base_m),
                "distance between the wheels, m",
            ),
            (
                "MAX_SPEED_MPS",
                Real(robot.max_speed_mps),
                "maximum speed of the robot, m/s",
            ),
            (
                "MAX_TURN_RADPS",
                Real(robot.max_turn_radps),
                "maximum turn rate of the robot, rad/s",
            ),
        ]);
    }
    all.extend([
        (
            "RING_BITS",
            Whole(ring, "usize"),
            "bits of a percept that show cells around",
        ),
        (
            "COLUMN_BITS",
            Whole(of_column, "usize"),
            "bits that show the column",
        ),
        ("ROW_BITS", Whole(of_row, "usize"), "bits that show the row"),
    ]);
    if let Some(reach) = reach(sensor) {
        let [nearest_m, lost_m] = provenance.assumed_ranges_m();
        all.extend([
            (
                "SCAN_REACH",
                Whole(reach, "i32"),
                "cells that a scan covers in each direction",
            ),
            (
                "SCAN_NEAREST_M",
                Real(nearest_m),
                "shortest range that the lidar measures, m",
            ),
            (
                "SCAN_LOST_RANGE_M",
                Real(lost_m),
                "assumed range of a beam that does not come back, m",
            ),
        ]);
    }
    all
}

/// Returns the section of a C99 header.
pub(super) fn c99(provenance: &Provenance, form: Form) -> String {
    let mut text = String::from("\n/* The world, the robot and the percept. */\n");
    for (name, value, what) in constants(provenance) {
        let value = match value {
            Value::Real(value) if value.is_sign_negative() => format!("({value:?})"),
            Value::Real(value) => format!("{value:?}"),
            Value::Whole(value, _) => value.to_string(),
            Value::Flag(value) => u8::from(value).to_string(),
        };
        let _ = writeln!(text, "#define XCSCR_{name} {value} /* {what} */");
    }
    text + form.c99() + &C.of(provenance.sensor())
}

/// Returns the section of a Rust module.
pub(super) fn rust(provenance: &Provenance, form: Form) -> String {
    let mut text = String::from("\n// The world, the robot and the percept.\n");
    for (name, value, what) in constants(provenance) {
        let typed = match value {
            Value::Real(value) => format!("f64 = {value:?}"),
            Value::Whole(value, kind) => format!("{kind} = {value}"),
            Value::Flag(value) => format!("bool = {value}"),
        };
        let _ = writeln!(text, "/// {what}\npub const {name}: {typed};");
    }
    text + form.rust() + &RUST.of(provenance.sensor())
}

/// Returns the section of a Python module. The module must import `math`.
pub(super) fn python(provenance: &Provenance, form: Form) -> String {
    let mut text = String::from("\n\n# The world, the robot and the percept.\n");
    let form = (
        "PERCEPT_IS_NUMBER",
        Value::Flag(form == Form::Number),
        "or a string of 0 and 1",
    );
    for (name, value, what) in constants(provenance).into_iter().chain([form]) {
        let value = match value {
            Value::Real(value) => format!("{value:?}"),
            Value::Whole(value, _) => value.to_string(),
            Value::Flag(true) => "True".to_owned(),
            Value::Flag(false) => "False".to_owned(),
        };
        let _ = writeln!(text, "{name} = {value}  # {what}");
    }
    text + &PYTHON.of(provenance.sensor())
}

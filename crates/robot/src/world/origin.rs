//! The pose of a grid in the frame of a map.

use nalgebra::{Complex, Isometry2, Point2, Translation2, UnitComplex};
use serde::{Deserialize, Serialize};

use super::error::Fault;

/// The largest coordinate, in metres: more than the coordinates of any projected map of the Earth.
const MOST_M: f64 = 1e8;
/// The largest yaw, in radians: a whole turn. A yaw in degrees is refused, unless it is small.
const MOST_RAD: f64 = std::f64::consts::TAU;

/// The pose of the lower left (south-western) corner of a grid in the map frame; the default is the
/// map frame itself.
///
/// In files it is an array `[x_m, y_m, yaw_rad]`, like `origin` in the YAML file of a ROS map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
pub struct Origin {
    /// Position along the x axis of the map frame, in metres.
    pub x_m: f64,
    /// Position along the y axis of the map frame, in metres.
    pub y_m: f64,
    /// Angle from the x axis of the map frame to the lower edge of the grid, counterclockwise, in
    /// radians.
    pub yaw_rad: f64,
}

impl Origin {
    /// Returns the pose of the grid frame in the map frame.
    pub(super) fn pose(&self) -> Isometry2<f64> {
        let (sine, cosine) = libm::sincos(self.yaw_rad);
        Isometry2::from_parts(
            Translation2::new(self.x_m, self.y_m),
            UnitComplex::new_unchecked(Complex::new(cosine, sine)),
        )
    }

    /// Converts a point from the grid frame, whose origin is this corner, to the map frame; both in
    /// metres.
    pub fn to_map(&self, point_m: Point2<f64>) -> Point2<f64> {
        self.pose() * point_m
    }

    /// Converts a point from the map frame to the grid frame, whose origin is this corner; both in
    /// metres.
    pub fn to_grid(&self, point_m: Point2<f64>) -> Point2<f64> {
        self.pose().inverse_transform_point(&point_m)
    }

    /// Returns the pose of another corner, given in the grid frame, in metres.
    pub(super) fn moved(self, corner_m: Point2<f64>) -> Self {
        let corner = self.to_map(corner_m);
        Self {
            x_m: corner.x,
            y_m: corner.y,
            ..self
        }
    }

    /// Returns the pose in the map frame of a pose that is given in the grid frame. Its yaw is from
    /// -pi to pi if the sum would be more than a turn.
    pub(super) fn followed_by(self, pose: Self) -> Self {
        let yaw_rad = self.yaw_rad + pose.yaw_rad;
        Self {
            yaw_rad: match yaw_rad.abs() > MOST_RAD {
                true => libm::remainder(yaw_rad, MOST_RAD),
                false => yaw_rad,
            },
            ..self.moved(Point2::new(pose.x_m, pose.y_m))
        }
    }

    /// Returns an error text if the numbers are out of range.
    pub(super) fn fault(&self) -> Option<String> {
        let is_within =
            self.x_m.abs() <= MOST_M && self.y_m.abs() <= MOST_M && self.yaw_rad.abs() <= MOST_RAD;
        (!is_within).then(|| {
            format!(
                "x and y must be from -{MOST_M} to {MOST_M} metres, and the yaw from \
                 -{MOST_RAD} to {MOST_RAD} radians"
            )
        })
    }

    /// Checks the key `origin` of a world file.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let help = "`origin` is the pose of the lower left corner of the grid in the map frame; leave it out for [0, 0, 0]";
        self.fault().map_or(Ok(()), |fault| {
            let numbers = <[f64; 3]>::from(*self);
            Err(Fault::new(
                format!("`origin` is {numbers:?}: {fault}"),
                help,
            ))
        })
    }
}

impl From<[f64; 3]> for Origin {
    fn from([x_m, y_m, yaw_rad]: [f64; 3]) -> Self {
        Self { x_m, y_m, yaw_rad }
    }
}

impl From<Origin> for [f64; 3] {
    fn from(origin: Origin) -> Self {
        [origin.x_m, origin.y_m, origin.yaw_rad]
    }
}

#[cfg(test)]
mod tests {
    use super::Origin;
    use crate::world::Maze;
    use nalgebra::Point2;

    fn maze(origin: &str) -> Result<Maze, String> {
        let text = format!(r######"{{ "rows": ["####", "#SG#", "####"]{origin} }}"######);
        Maze::from_json(text.as_bytes(), "placed.json").map_err(|error| error.to_string())
    }

    #[test]
    fn an_origin_is_read_and_written_as_the_same_numbers() {
        for numbers in [
            "[-10.0, 0.1, 0.7853981633974483]",
            "[0, 0, -1e-300]",
            "[4e6, 1e-9, 0]",
        ] {
            let first = maze(&format!(r#", "origin": {numbers}"#)).unwrap();
            let wanted: [f64; 3] = serde_json::from_str(numbers).unwrap();
            assert_eq!(<[f64; 3]>::from(first.origin()), wanted);
            let again = Maze::from_json(first.to_json().as_bytes(), "again.json").unwrap();
            assert_eq!(again, first, "{numbers}");
        }
        let plain = maze("").unwrap();
        assert_eq!(plain.origin(), Origin::default());
        assert!(!plain.to_json().contains("origin"));
    }

    #[test]
    fn an_invalid_pose_is_refused_with_the_cause() {
        for (numbers, fault) in [
            ("[0, 0]", "an array of length 3"),
            ("[0, 0, 0, 0]", "trailing"),
            (r#"[0, 0, "north"]"#, "expected f64"),
            ("7", "an array of length 3"),
            ("[1e9, 0, 0]", "from -100000000 to 100000000 metres"),
            ("[0, 0, 1e999]", "out of range"),
            ("[0, 0, 11]", "radians"),
        ] {
            let message = maze(&format!(r#", "origin": {numbers}"#)).unwrap_err();
            assert!(message.contains(fault), "{numbers}: {message}");
            assert!(message.starts_with("placed.json:"), "{message}");
        }
    }

    #[test]
    fn a_point_goes_to_the_map_frame_and_back() {
        let origin = Origin::from([5.0, 1.0, std::f64::consts::FRAC_PI_2]);
        let there = origin.to_map(Point2::new(2.0, 1.0));
        assert!((there - Point2::new(4.0, 3.0)).norm() < 1e-12, "{there}");
        let back = origin.to_grid(there);
        assert!((back - Point2::new(2.0, 1.0)).norm() < 1e-12, "{back}");
        // Without a yaw, only the sum is rounded.
        let straight = Origin::from([0.1, -0.1, 0.0]).to_map(Point2::new(0.0, 0.0));
        assert_eq!([straight.x, straight.y], [0.1, -0.1]);
    }
}

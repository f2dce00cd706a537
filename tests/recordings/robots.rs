//! Recordings of a robot profile: speeds and ranges are those of the robot.

use std::fs;

use foxglove::Decode;
use foxglove::messages::{FrameTransform, FrameTransforms, LaserScan};
use xcscr::record::reader::Recording;

use crate::kit::desk::Desk;
use crate::kit::messages::on;

fn time_s(frame: &FrameTransform) -> f64 {
    let stamp = frame.timestamp.unwrap();
    f64::from(stamp.sec()) + f64::from(stamp.nsec()) / 1e9
}

/// The highest speed in `/tf` in m/s, and the shortest and the longest range in `/scan` in metres, in the
/// recording of an episode.
fn extremes(recording: &Recording) -> (f64, [f64; 2]) {
    let (mut speed_mps, mut ranges_m) = (0.0_f64, [f64::INFINITY, 0.0]);
    let mut before: Option<FrameTransform> = None;
    for message in on(recording, "/tf") {
        let frames = FrameTransforms::decode(message.data.as_slice()).unwrap();
        let robot = |frame: &FrameTransform| frame.child_frame_id == "base_link_true";
        for frame in frames.transforms.into_iter().filter(robot) {
            if let Some(before) = before.replace(frame.clone()) {
                let seconds = time_s(&frame) - time_s(&before);
                let [a, b] = [before, frame].map(|frame| frame.translation.unwrap());
                if seconds > 0.0 {
                    speed_mps = speed_mps.max((b.x - a.x).hypot(b.y - a.y) / seconds);
                }
            }
        }
    }
    for message in on(recording, "/scan") {
        let scan = LaserScan::decode(message.data.as_slice()).unwrap();
        for range in scan.ranges.into_iter().filter(|range| range.is_finite()) {
            ranges_m = [ranges_m[0].min(range), ranges_m[1].max(range)];
        }
    }
    (speed_mps, ranges_m)
}

/// The same of an episode of a robot in Maze4 with cells of `cell_size_m`.
fn recorded(robot: &str, cell_size_m: f64) -> (f64, [f64; 2]) {
    let desk = Desk::new();
    let text = fs::read_to_string("worlds/maze4.json").unwrap();
    let size = format!("\"cell_size_m\": {cell_size_m}");
    desk.write("maze4.json", text.replace("\"cell_size_m\": 1.0", &size));
    let train = "train @maze4.json --out @run --episodes 1 --record beams";
    desk.ok(&format!("{train} --robot {robot}"));
    extremes(&desk.recording("run/ep-0001.mcap"))
}

#[test]
fn speeds_and_ranges_in_recordings_are_within_the_profile_whatever_the_size_of_cells() {
    // Top speed in m/s, nearest and farthest range in m.
    for (robot, cell_size_m, top_mps, [nearest_m, farthest_m]) in [
        ("turtlebot3-burger", 0.5, 0.22, [0.12, 3.5]),
        ("turtlebot3-burger", 1.0, 0.22, [0.12, 3.5]),
        ("default", 1.0, 1.4, [0.12, 8.0]),
        ("default", 2.0, 1.4, [0.12, 8.0]),
    ] {
        let (speed_mps, ranges_m) = recorded(robot, cell_size_m);
        let what = format!("{robot}, cells of {cell_size_m} m: {speed_mps} m/s, {ranges_m:?} m");
        // The floor moves a wheel by its noise more than it counts (5 % for an action, 5 % for a step), and
        // a recorded coordinate is a multiple of 1/1024 m.
        assert!(speed_mps < 1.2 * top_mps + 0.03, "{what}");
        assert!(speed_mps > 0.8 * top_mps, "control: {what}");
        // Recorded as single precision.
        assert!(
            ranges_m[0] > nearest_m - 1e-3 && ranges_m[1] < farthest_m + 1e-3,
            "{what}"
        );
        assert!(ranges_m[1] > 1.5, "control: {what}");
    }
}

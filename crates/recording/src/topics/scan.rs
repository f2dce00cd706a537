//! `/scan`: the measurements of the lidar beams.

use std::f64::consts::TAU;

use foxglove::messages::LaserScan;

use super::rounded;
use super::scene::{ROBOT, place, timestamp};
use xcscr_robot::arena::{Beam, Sensed, View};

/// Returns the scans of a move, oldest first, each with the time of its first beam.
///
/// One scan has the beams of one physics step. A whole turn takes so long that the motion of a
/// turning robot would distort it. The robot stands still while it looks around before an episode:
/// those beams form one scan, with the start time of the episode.
pub(crate) fn scans(view: &View<'_>, is_begin: bool) -> Vec<(u64, LaserScan)> {
    let Some(Sensed { beams, .. }) = view.sensed else {
        return Vec::new();
    };
    if is_begin {
        let now_ns = view.now().time_ns;
        return scan(beams, now_ns).into_iter().collect();
    }
    let steps = view.trace.windows(2);
    let of_step = steps.filter_map(|step| {
        let (from_ns, to_ns) = (step[0].time_ns, step[1].time_ns);
        let first = beams.partition_point(|beam| beam.time_ns < from_ns);
        let end = beams.partition_point(|beam| beam.time_ns < to_ns);
        let sent_ns = beams.get(first)?.time_ns;
        scan(&beams[first..end], sent_ns)
    });
    of_step.collect()
}

/// Creates a scan of neighbouring beams at `time_ns`; `None` without beams.
fn scan(beams: &[Beam], time_ns: u64) -> Option<(u64, LaserScan)> {
    let [first, ..] = beams else {
        return None;
    };
    let between = |pair: &[Beam]| angle(pair[0].bearing.inverse() * pair[1].bearing);
    let apart_rad = beams.windows(2).next().map_or(0.0, between);
    let start_rad = angle(first.bearing);
    let message = LaserScan {
        timestamp: Some(timestamp(time_ns)),
        frame_id: ROBOT.to_owned(),
        pose: Some(place(0.0, 0.0, 0.0)),
        start_angle: rounded(start_rad),
        end_angle: rounded(start_rad + apart_rad * (beams.len() - 1) as f64),
        ranges: beams.iter().map(range).collect(),
        intensities: Vec::new(),
    };
    Some((time_ns, message))
}

/// Returns the range in the ROS convention (REP 117): infinity without an echo, minus infinity if
/// the echo is too near.
fn range(beam: &Beam) -> f64 {
    beam.range_m.map_or(f64::INFINITY, rounded)
}

/// Returns the angle of a rotation in radians, from 0 to a full turn.
pub(crate) fn angle(rotation: nalgebra::UnitComplex<f64>) -> f64 {
    let angle_rad = libm::atan2(rotation.im, rotation.re);
    if angle_rad < 0.0 {
        angle_rad + TAU
    } else {
        angle_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, UnitComplex};

    /// Returns beam `number` of eight in a turn.
    fn beam(number: u32, range_m: Option<f64>) -> Beam {
        let (sine, cosine) = libm::sincos(f64::from(number) * TAU / 8.0);
        Beam {
            time_ns: u64::from(number) * 10,
            bearing: UnitComplex::new_unchecked(Complex::new(cosine, sine)),
            range_m,
        }
    }

    #[test]
    fn a_scan_across_the_heading_goes_on_beyond_a_full_turn() {
        let beams = [beam(6, Some(1.5)), beam(7, None), beam(0, Some(2.0))];
        let (time_ns, scan) = scan(&beams, 60).unwrap();
        assert_eq!(time_ns, 60);
        assert!((scan.start_angle - 0.75 * TAU).abs() < 1e-3, "{scan:?}");
        assert!((scan.end_angle - TAU).abs() < 1e-3, "{scan:?}");
        assert_eq!(scan.ranges, [1.5, f64::INFINITY, 2.0]);
    }

    #[test]
    fn no_beams_make_no_scan_and_one_beam_makes_one_of_a_point() {
        assert!(scan(&[], 0).is_none());
        let (_, single) = scan(&[beam(2, Some(1.0))], 0).unwrap();
        assert_eq!(single.start_angle, single.end_angle);
    }
}

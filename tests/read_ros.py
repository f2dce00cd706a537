#!/usr/bin/env python3
"""Reads a recording for ROS 2 with a reader that is not ours, and holds it against its world and ROS.

    read_ros.py RECORDING WORLD    (needs: pip install mcap mcap-ros2-support pyyaml)
"""

import json
import math
import sys

import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

TYPES = {
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/odom": "nav_msgs/msg/Odometry",
    "/pose": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/ground_truth/odom": "nav_msgs/msg/Odometry",
}
# Of rmw: how long the messages of a publisher live.
TRANSIENT_LOCAL, VOLATILE = 1, 2
SCAN = ["angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max"]


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def planar(position, turn):
    """x, y and heading; anything else would lift the robot off its floor."""
    assert position.z == turn.x == turn.y == 0 and abs(math.hypot(turn.z, turn.w) - 1) < 1e-9
    return position.x, position.y, 2 * math.atan2(turn.z, turn.w)


def after(a, b):
    """Pose b, which is given in the frame of pose a, in the frame of a's parent."""
    sine, cosine = math.sin(a[2]), math.cos(a[2])
    return a[0] + cosine * b[0] - sine * b[1], a[1] + sine * b[0] + cosine * b[1], a[2] + b[2]


def same(a, b, tolerance=1e-9):
    turn = math.remainder(a[2] - b[2], math.tau)
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(turn)) < tolerance


def in_grid(at, origin):
    """A point of the map frame in the frame of the grid, whose lower left corner has the pose `origin`."""
    x, y, sine, cosine = at.x - origin[0], at.y - origin[1], math.sin(origin[2]), math.cos(origin[2])
    return cosine * x + sine * y, cosine * y - sine * x


def check_scan(scan, constants):
    """Whole turns with the same constants."""
    now = [getattr(scan, name) for name in SCAN]
    assert now == constants.setdefault("scan", now), (now, constants)
    assert scan.header.frame_id == "base_scan"
    beams = len(scan.ranges)
    assert math.isclose(beams * scan.angle_increment, math.tau, rel_tol=1e-6), "no whole turn"
    assert math.isclose(scan.angle_min + (beams - 1) * scan.angle_increment, scan.angle_max, rel_tol=1e-6)
    assert math.isclose(beams * scan.time_increment, scan.scan_time, rel_tol=1e-6)
    assert 0 < scan.range_min < scan.range_max
    for r in scan.ranges:
        assert math.isnan(r) or math.isinf(r) or 0.99 * scan.range_min <= r <= 1.01 * scan.range_max, r
    return any(math.isnan(r) for r in scan.ranges)


def main(path, world):
    world = json.load(open(world))
    origin = world.get("origin", [0, 0, 0])
    walls = [[letter == "#" for letter in row] for row in reversed(world["rows"])]
    counts = dict.fromkeys(TYPES, 0)
    parents, constants, poses, odometry = {}, {}, {}, {}
    last_ns, partial, drift_m, size = 0, 0, 0.0, None
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for channel in reader.get_summary().channels.values():
            (qos,) = yaml.safe_load(channel.metadata["offered_qos_profiles"])
            is_latched = channel.topic in ("/map", "/tf_static")
            assert qos["durability"] == (TRANSIENT_LOCAL if is_latched else VOLATILE), channel.topic
            assert qos["reliability"] == qos["history"] == 1, qos
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            topic, now_ns = channel.topic, message.log_time
            assert schema.name == TYPES[topic], (topic, schema.name)
            assert last_ns <= now_ns, "messages out of the order of time"
            counts[topic], last_ns = counts[topic] + 1, now_ns
            if topic in ("/tf", "/tf_static"):
                frames = {}
                for t in decoded.transforms:
                    parent, child = t.header.frame_id, t.child_frame_id
                    assert parents.setdefault(child, parent) == parent, "a frame with two parents"
                    assert nanoseconds(t.header.stamp) == now_ns
                    frames[child] = planar(t.transform.translation, t.transform.rotation)
                if topic == "/tf":
                    odometry[now_ns] = frames["base_link"]
                    poses[now_ns] = after(frames["odom"], frames["base_link"])
                continue
            stamp_ns = nanoseconds(decoded.header.stamp)
            if topic == "/map":
                size, corner = decoded.info.resolution, decoded.info.origin
                assert same(planar(corner.position, corner.orientation), origin), "another origin"
                assert (decoded.info.width, decoded.info.height) == (len(walls[0]), len(walls))
                wanted = [100 if wall else 0 for row in walls for wall in row]
                assert list(decoded.data) == wanted, "walls of another world"
            elif topic == "/odom":
                assert (decoded.header.frame_id, decoded.child_frame_id) == ("odom", "base_link")
                assert stamp_ns == now_ns
                at = planar(decoded.pose.pose.position, decoded.pose.pose.orientation)
                assert same(at, odometry[now_ns]), "/odom and /tf differ"
                speed = decoded.twist.twist.linear.x
                before = constants.get("odom", at)
                assert math.dist(at[:2], before[:2]) < 0.5 * size, "odometry jumps"
                assert abs(speed) < 3, speed
                constants["odom"] = at
            elif topic == "/pose":
                assert decoded.header.frame_id == "map" and stamp_ns == now_ns
                at = planar(decoded.pose.pose.position, decoded.pose.pose.orientation)
                assert same(at, poses[now_ns]), "/pose and /tf differ"
                variances = [decoded.pose.covariance[7 * i] for i in (0, 1, 5)]
                assert all(0 < variance < 1 for variance in variances), variances
            elif topic == "/ground_truth/odom":
                assert (decoded.header.frame_id, decoded.child_frame_id) == ("map", "base_link_true")
                at = decoded.pose.pose.position
                x, y = in_grid(at, origin)
                assert x > 0 and y > 0 and not walls[int(y / size)][int(x / size)], "in a wall"
                drift_m = max(drift_m, math.dist((at.x, at.y), poses[now_ns][:2]))
            else:
                partial += check_scan(decoded, constants)
                turn_ns = decoded.scan_time * 1e9
                assert 0 <= now_ns - stamp_ns <= 1.05 * turn_ns, (now_ns, stamp_ns)
    assert parents == {"odom": "map", "base_link": "odom", "base_scan": "base_link"}, parents
    assert all(counts.values()), counts
    assert counts["/map"] == counts["/tf_static"] == 1
    print(path, counts, f"partial turns {partial}, greatest error of the estimate {drift_m:.3f} m")


main(*sys.argv[1:])

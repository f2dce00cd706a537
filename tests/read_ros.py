#!/usr/bin/env python3
"""Reads a recording for ROS 2 with a reader that is not ours, and holds it against its world.

    read_ros.py RECORDING WORLD    (needs: pip install mcap mcap-ros2-support)
"""

import json
import math
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

TYPES = {
    "/tf": "tf2_msgs/msg/TFMessage",
    "/odom": "nav_msgs/msg/Odometry",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/map": "nav_msgs/msg/OccupancyGrid",
}


def main(path, world):
    rows = json.load(open(world))["rows"]
    walls = [[letter == "#" for letter in row] for row in reversed(rows)]
    counts = dict.fromkeys(TYPES, 0)
    poses = {}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema.name == TYPES[channel.topic], (channel.topic, schema.name)
            counts[channel.topic] += 1
            if channel.topic == "/map":
                size = decoded.info.resolution
                assert (decoded.info.width, decoded.info.height) == (len(walls[0]), len(walls))
                wanted = [100 if wall else 0 for row in walls for wall in row]
                assert list(decoded.data) == wanted, "walls of another world"
            elif channel.topic == "/tf":
                frames = {t.child_frame_id: t for t in decoded.transforms}
                truth = frames["base_link_true"].transform.translation
                assert not walls[int(truth.y / size)][int(truth.x / size)], "in a wall"
                poses[message.log_time] = frames["base_link"].transform
            elif channel.topic == "/odom":
                pose, stamp = decoded.pose.pose, decoded.header.stamp
                assert stamp.sec * 10**9 + stamp.nanosec == message.log_time
                at = poses[message.log_time].translation
                assert (pose.position.x, pose.position.y) == (at.x, at.y)
                turn = pose.orientation
                assert abs(math.hypot(turn.z, turn.w) - 1) < 1e-9 and turn.x == turn.y == 0
                variances = [decoded.pose.covariance[7 * i] for i in (0, 1, 5)]
                assert all(0 < variance < 1 for variance in variances), variances
            else:
                beams = len(decoded.ranges) - 1
                end = decoded.angle_min + decoded.angle_increment * beams
                assert math.isclose(end, decoded.angle_max, abs_tol=1e-3)
                assert all(0 <= r <= 1.1 * decoded.range_max or math.isinf(r) for r in decoded.ranges)
    assert all(counts.values()), counts
    print(path, counts)


main(*sys.argv[1:])

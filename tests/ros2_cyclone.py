"""Nodes on bare CycloneDDS, for `tests/ros2_live.py`. Without arguments, a robot: passes the messages of the namespace /raw on, and commands back.

With the argument `localise`, a stand-in for AMCL: publishes the transform from map to odom by the true pose, with an error.
"""
import cmath
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float32, float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class Imu(IdlStruct, typename="sensor_msgs::msg::dds_::Imu_"):
    header: Header
    orientation: Quaternion
    orientation_covariance: array[float64, 9]
    angular_velocity: Vector3
    angular_velocity_covariance: array[float64, 9]
    linear_acceleration: Vector3
    linear_acceleration_covariance: array[float64, 9]


@dataclass
class LaserScan(IdlStruct, typename="sensor_msgs::msg::dds_::LaserScan_"):
    header: Header
    angle_min: float32
    angle_max: float32
    angle_increment: float32
    time_increment: float32
    scan_time: float32
    range_min: float32
    range_max: float32
    ranges: sequence[float32]
    intensities: sequence[float32]


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


participant = DomainParticipant(0)
qos = Qos(Policy.History.KeepLast(32))


def reader_of(kind, name):
    return DataReader(participant, Topic(participant, name, kind), qos)


def writer_of(kind, name):
    return DataWriter(participant, Topic(participant, name, kind))


def taken(reader):
    return [message for message in reader.take(32) if isinstance(message, IdlStruct)]


def pose_of(message):
    """Returns the position and the direction of the heading as complex numbers."""
    pose = message.pose.pose
    half = complex(pose.orientation.w, pose.orientation.z)
    return complex(pose.position.x, pose.position.y), half * half


def localise():
    truths, odometry = reader_of(Odometry, "rt/ground_truth/odom"), reader_of(Odometry, "rt/odom")
    writer = writer_of(TFMessage, "rt/tf")
    by_stamp = {}
    off, turned = 0.03 - 0.02j, cmath.rect(1, 0.02)
    while True:
        for message in taken(odometry):
            by_stamp[message.header.stamp.sec, message.header.stamp.nanosec] = pose_of(message)
        for message in taken(truths):
            stamp = message.header.stamp
            if (stamp.sec, stamp.nanosec) not in by_stamp:
                continue
            at, heading = by_stamp.pop((stamp.sec, stamp.nanosec))
            true_at, true_heading = pose_of(message)
            turn = true_heading * turned / heading
            place = true_at + off - turn * at
            half = cmath.sqrt(turn)
            transform = Transform(Vector3(place.real, place.imag, 0.0), Quaternion(0.0, 0.0, half.imag, half.real))
            writer.write(TFMessage([TransformStamped(Header(stamp, "map"), "odom", transform)]))
        time.sleep(0.001)


def pass_on():
    pairs = []
    for kind, source, target in [
        (LaserScan, "rt/raw/scan", "rt/scan"),
        (Odometry, "rt/raw/odom", "rt/odom"),
        (Imu, "rt/raw/imu", "rt/imu"),
        (Twist, "rt/cmd_vel", "rt/raw/cmd_vel"),
    ]:
        pairs.append((reader_of(kind, source), writer_of(kind, target)))
    while True:
        for reader, writer in pairs:
            for message in taken(reader):
                writer.write(message)
        time.sleep(0.001)


localise() if sys.argv[1:] == ["localise"] else pass_on()

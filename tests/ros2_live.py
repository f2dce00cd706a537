#!/usr/bin/env python3
"""Drives over ROS 2 with rclpy on the other side, on loopback only. Needs root for a network namespace of its own.

    pip install 'ros-kilted-rclpy[fastrtps]' ros-kilted-sensor-msgs ros-kilted-nav-msgs ros-kilted-geometry-msgs cyclonedds
    tests/ros2_live.py XCSCR [DRIVES [PART...]]

XCSCR is a program built with `--features ros2`; a PART is one of the functions of `PARTS`. Prints one line for each claim, and a table of the injected faults.
"""
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INSIDE = "XCSCR_ROS2_LIVE"

if os.environ.get(INSIDE) is None:
    network = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo"
    again = ["sh", "-c", f'{network} && exec "$@"', "sh", sys.executable, *sys.argv]
    os.environ[INSIDE] = "1"
    os.execvp("unshare", ["unshare", "-n", *again])

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan

LASTING = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
XCSCR = sys.argv[1]
DRIVES = int(sys.argv[2]) if len(sys.argv) > 2 else 5
failures = []


def claim(holds, text):
    print("ok  " if holds else "FAIL", text, flush=True)
    if not holds:
        failures.append(text)


class Program:
    """A program whose output is kept."""

    def __init__(self, *arguments):
        self.file = tempfile.TemporaryFile(mode="w+")
        command = [str(argument) for argument in arguments]
        self.process = subprocess.Popen(command, stdout=self.file, stderr=subprocess.STDOUT)

    def end(self, with_signal=signal.SIGINT, patience=10):
        if self.process.poll() is None:
            self.process.send_signal(with_signal)
        return self.wait(patience)

    def wait(self, patience):
        try:
            return self.process.wait(patience)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return None

    def said(self):
        self.file.seek(0)
        return self.file.read()


def simulate(*arguments):
    return Program(XCSCR, "simulate", "maze4", "--ros2", *arguments)


def drive(run, *arguments):
    return Program(XCSCR, "drive", run, "--ros2", "--sim-time", "--force", *arguments)


class Peer:
    """A node whose callbacks run in a thread."""

    def __init__(self, name, **options):
        self.node = rclpy.create_node(name, **options)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.thread = threading.Thread(target=self.executor.spin, daemon=True)
        self.thread.start()

    def close(self):
        self.executor.shutdown()
        self.thread.join(2)
        self.node.destroy_node()


class Listener(Peer):
    """Keeps the last message of each topic."""

    def __init__(self):
        super().__init__("listener", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.last = {}
        topics = [("clock", Clock, 10), ("scan", LaserScan, 10), ("odom", Odometry, 10), ("imu", Imu, 10)]
        topics += [("map", OccupancyGrid, LASTING), ("ground_truth/odom", Odometry, 10)]
        for topic, kind, qos in topics:
            keep = lambda message, topic=topic: self.last.__setitem__(topic, message)
            self.node.create_subscription(kind, topic, keep, qos)

    def has(self, *topics, patience=10):
        until = time.monotonic() + patience
        while time.monotonic() < until:
            if all(topic in self.last for topic in topics):
                return True
            time.sleep(0.05)
        return False

    def at(self):
        position = self.last["ground_truth/odom"].pose.pose.position
        return position.x, position.y


def robot_for_others(_):
    robot = simulate()
    time.sleep(1)
    listener = Listener()
    listener.has("ground_truth/odom")
    claim(listener.has("clock", "scan", "odom", "imu", "map"), "rclpy hears /clock, /scan, /odom, /imu, and /map late")
    grid = listener.last.get("map")
    claim(grid is not None and grid.info.width == 8 and sum(cell > 50 for cell in grid.data) > 30, "/map has the walls")
    seconds = listener.node.get_clock().now().nanoseconds * 1e-9
    claim(0 < seconds < 1000, f"use_sim_time works: the time is {seconds:.2f} s")
    before = listener.at()
    wanderer = Program(sys.executable, ROOT / "examples/drive_simulated_robot.py")
    time.sleep(6)
    moved = math.dist(before, listener.at())
    wanderer.end()
    time.sleep(1.2)
    rest = listener.at()
    time.sleep(0.5)
    claim(moved > 0.3, f"ten lines of rclpy move it: {moved:.2f} m")
    claim(math.dist(rest, listener.at()) < 0.01, "it stops when the commands cease")
    listener.close()
    claim(robot.end() == 0, "Ctrl-C ends it")


def by_cyclone(_):
    """A publisher of bare CycloneDDS, without ROS."""
    script = """
import time
from dataclasses import dataclass
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float
    y: float
    z: float

@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3
    angular: Vector3

participant = DomainParticipant(0)
writer = DataWriter(participant, Topic(participant, "rt/cmd_vel", Twist))
for _ in range(60):
    writer.write(Twist(Vector3(0.0, 0.0, 0.0), Vector3(0.0, 0.0, 0.5)))
    time.sleep(0.05)
"""
    robot = simulate()
    listener = Listener()
    listener.has("odom")
    cyclone = Program(sys.executable, "-c", script)
    fastest = 0.0
    for _ in range(40):
        time.sleep(0.1)
        fastest = max(fastest, listener.last["odom"].twist.twist.angular.z)
    code = cyclone.wait(10)
    claim(fastest > 0.3, f"bare CycloneDDS turns it: {fastest:.2f} rad/s (exit code {code})")
    if fastest <= 0.3:
        print(cyclone.said())
    listener.close()
    robot.end()


class Relay(Peer):
    """The robot of the namespace /raw, whose messages are spoilt on the way."""

    def __init__(self, cmd_vel=10):
        super().__init__("relay")
        make = self.node.create_publisher
        self.out = {"scan": make(LaserScan, "scan", 10), "odom": make(Odometry, "odom", 10), "imu": make(Imu, "imu", 10)}
        self.command = make(Twist, "raw/cmd_vel", 10)
        self.spoil = {}
        self.commands = []
        for topic, kind in [("scan", LaserScan), ("odom", Odometry), ("imu", Imu)]:
            self.node.create_subscription(kind, f"raw/{topic}", lambda message, topic=topic: self.send(topic, message), 10)
        self.node.create_subscription(Twist, "cmd_vel", self.commanded, cmd_vel)

    def send(self, topic, message):
        spoil = self.spoil.get(topic, lambda message: message)
        message = spoil(message)
        if message is not None:
            self.out[topic].publish(message)

    def commanded(self, twist):
        self.commands.append((time.monotonic(), twist.linear.x, twist.angular.z))
        self.command.publish(twist)

    def until_it_moves(self, patience=20):
        until = time.monotonic() + patience
        while time.monotonic() < until:
            if len([1 for _, forward, _ in self.commands[-8:] if abs(forward) > 0.2]) == 8:
                return True
            time.sleep(0.01)
        return False

    def rests_after(self, began, patience=2.0):
        """Seconds until the first command of rest after which none moves for half a second."""
        time.sleep(patience)
        moving = [at for at, forward, turn in self.commands if at > began and (forward or turn)]
        rests = [at for at, forward, turn in self.commands if at > max(moving, default=began) and not (forward or turn)]
        return rests[0] - began if rests else None


def changed(**fields):
    def change(message):
        for name, value in fields.items():
            part, *path = name.split("__")
            holder = message
            for step in [part, *path][:-1]:
                holder = getattr(holder, step)
            setattr(holder, [part, *path][-1], value)
        return message

    return change


def not_a_number(scan):
    scan.ranges = [math.nan] * len(scan.ranges)
    return scan


def earlier(message):
    message.header.stamp.sec -= 2
    return message


def another_publisher(relay):
    relay.other = relay.node.create_publisher(Twist, "cmd_vel", 10)


def another_type(relay):
    # A participant of its own, because one participant cannot have two types of a topic.
    context = rclpy.Context()
    rclpy.init(context=context)
    relay.other = rclpy.create_node("other", context=context)
    relay.publisher = relay.other.create_publisher(Twist, "odom", 10)


FAULTS = [
    ("scans cease", "no-scans", {"scan": lambda _: None}, "no scan on"),
    ("odometry ceases", "no-odometry", {"odom": lambda _: None}, "no odometry on"),
    ("ranges are NaN", "invalid-ranges", {"scan": not_a_number}, "are not a number"),
    ("a pose is NaN", "invalid-odometry", {"odom": changed(pose__pose__position__x=math.nan)}, "is not a number"),
    ("/odom in the frame map", "wrong-frame", {"odom": changed(header__frame_id="map")}, "in the frame `map`"),
    ("/scan in the frame camera", "wrong-frame", {"scan": changed(header__frame_id="camera")}, "in the frame `camera`"),
    ("another lidar", "wrong-lidar", {"scan": changed(range_max=3.5)}, "another lidar"),
    ("stamps jump back 2 s", "clock-jumped", {"odom": earlier}, "jumped by"),
    ("another node on /cmd_vel", "other-publisher", another_publisher, "another node publishes"),
    ("Twist on /odom", "wrong-qos", another_type, "its type is"),
]


def faults(run):
    print("\nfault                        stops after  said")
    for name, _, spoil, words in FAULTS:
        robot = simulate("--namespace", "raw")
        relay = Relay()
        driver = drive(run)
        moves = relay.until_it_moves()
        began = time.monotonic()
        if callable(spoil):
            spoil(relay)
        else:
            relay.spoil = spoil
        stopped = relay.rests_after(began)
        driver.end()
        said = [line.strip() for line in driver.said().splitlines() if "stops:" in line and words in line]
        shown = "never" if stopped is None else f"{1000 * stopped:.0f} ms"
        print(f"{name:<28} {shown:>11}  {said[0] if said else '-'}")
        claim(moves and stopped is not None and stopped < 0.7 and said, name)
        relay.close()
        robot.end()


def quality_of_service(run):
    robot = simulate("--namespace", "raw")
    relay = Relay(cmd_vel=LASTING)
    driver = drive(run)
    time.sleep(3)
    driver.end()
    claim("incompatible quality of service: the subscriber differs in Durability" in driver.said(), "a robot that cannot hear")
    claim(not any(forward for _, forward, _ in relay.commands), "nothing moves then")
    relay.close()
    robot.end()


def ends(run):
    for name, with_signal in [("Ctrl-C", signal.SIGINT), ("SIGTERM", signal.SIGTERM), ("SIGKILL", signal.SIGKILL)]:
        robot = simulate("--namespace", "raw")
        relay = Relay()
        driver = drive(run)
        moves = relay.until_it_moves()
        began = time.monotonic()
        code = driver.end(with_signal)
        if with_signal == signal.SIGKILL:
            speeds = []
            keep = lambda odometry: speeds.append((time.monotonic(), odometry.twist.twist.linear.x))
            relay.node.create_subscription(Odometry, "raw/odom", keep, 10)
            time.sleep(2)
            last = max((at for at, speed in speeds if abs(speed) > 0.02), default=began)
            claim(moves and speeds and last - began < 1.0, f"{name}: the robot's own time-out stops it in {last - began:.2f} s")
        else:
            stopped = relay.rests_after(began)
            claim(moves and stopped is not None and stopped < 0.15, f"{name}: rest after {1000 * (stopped or 9):.0f} ms, exit code {code}")
        relay.close()
        robot.end()


def mislocalised(run):
    robot = simulate()
    driver = drive(run, "--start", "6.5,5.5,0")
    code = driver.wait(20)
    claim(code == 1 and "mislocalised" in driver.said(), "a robot that stands elsewhere is mislocalised")
    claim(" 1  cell" not in driver.said(), "and does not begin to move")
    robot.end()


def refused(run):
    driver = drive(run, "--robot", "turtlebot3-burger")
    claim(driver.wait(10) == 65 and "another robot" in driver.said(), "a policy for another robot is refused")


def drives(run):
    """Drives to the goal, and decides again by the recordings without ROS."""
    reached, decisions, same, slowest = 0, 0, 0, []
    for seed in range(1, DRIVES + 1):
        robot = simulate("--seed", seed, "--realtime-factor", "4")
        bag = Path(run) / f"drive{seed}.mcap"
        driver = drive(run, "--out", bag)
        code = driver.wait(120)
        said = driver.said()
        reached += code == 0
        latency = re.search(r"(\d+) decisions; .*p99 ([\d.]+) ms", said)
        if latency:
            decisions += int(latency[1])
            slowest.append(float(latency[2]))
        if code != 0:
            print(f"seed {seed}: code {code}\n{said}")
        again = subprocess.run([XCSCR, "drive", run, "--bag", bag], capture_output=True, text=True)
        found = re.search(r"(\d+) of (\d+) decisions are", again.stdout)
        same += int(found[1]) if found else 0
        robot.end()
    claim(reached == DRIVES, f"{reached} of {DRIVES} drives reach the goal")
    claim(same == decisions > 0, f"{same} of {decisions} decisions are the same without ROS")
    slowest.sort()
    print(f"     p99 of the time from scan to command, median of the drives: {slowest[len(slowest) // 2]:.2f} ms, worst {slowest[-1]:.2f} ms")


PARTS = [robot_for_others, by_cyclone, refused, mislocalised, drives, ends, quality_of_service, faults]


def main():
    with tempfile.TemporaryDirectory() as work:
        run = Path(work) / "run"
        subprocess.run([XCSCR, "train", "maze4", "--quiet", "--out", run], check=True, stdout=subprocess.DEVNULL)
        rclpy.init()
        for part in PARTS:
            if part.__name__ in (sys.argv[3:] or [part.__name__]):
                part(run)
        rclpy.shutdown()
    print(f"{len(failures)} claims failed" if failures else "all claims hold")
    sys.exit(bool(failures))


main()

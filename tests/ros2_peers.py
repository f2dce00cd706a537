"""The other side of `tests/ros2_live.py`: programs, and ROS 2 nodes in rclpy."""
import math
import signal
import subprocess
import tempfile
import threading
import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan

LASTING = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Program:
    """A program whose output is kept."""

    def __init__(self, *arguments, **options):
        self.file = tempfile.TemporaryFile(mode="w+")
        command = [str(argument) for argument in arguments]
        self.process = subprocess.Popen(command, stdout=self.file, stderr=subprocess.STDOUT, **options)

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

    def memory_kb(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))


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


class Relay(Peer):
    """The robot of the namespace /raw, whose messages can be spoilt on the way."""

    def __init__(self, cmd_vel=10, stamped=False):
        super().__init__("relay")
        make = self.node.create_publisher
        self.out = {"scan": make(LaserScan, "scan", 10), "odom": make(Odometry, "odom", 10), "imu": make(Imu, "imu", 10)}
        self.command = make(Twist, "raw/cmd_vel", 10)
        self.spoil = {}
        self.commands = []
        for topic, kind in [("scan", LaserScan), ("odom", Odometry), ("imu", Imu)]:
            self.node.create_subscription(kind, f"raw/{topic}", lambda message, topic=topic: self.send(topic, message), 10)
        if stamped:
            self.node.create_subscription(TwistStamped, "cmd_vel", lambda message: self.commanded(message.twist), cmd_vel)
        else:
            self.node.create_subscription(Twist, "cmd_vel", self.commanded, cmd_vel)

    def send(self, topic, message):
        spoil = self.spoil.get(topic, lambda message: message)
        message = spoil(message)
        if message is not None:
            self.out[topic].publish(message)

    def commanded(self, twist):
        self.commands.append((time.time(), twist.linear.x, twist.angular.z))
        self.command.publish(twist)

    def until_it_moves(self, patience=20):
        until = time.monotonic() + patience
        while time.monotonic() < until:
            if len([1 for _, forward, _ in self.commands[-8:] if abs(forward) > 0.2]) == 8:
                return True
            time.sleep(0.01)
        return False

    def rests_after(self, began, patience=2.0):
        """Seconds from `began` until the first of the last commands, all of which are rest; `None` if the last one moves."""
        time.sleep(patience)
        moving = [at for at, forward, turn in self.commands if at > began and (forward or turn)]
        rests = [at for at, forward, turn in self.commands if at > max(moving, default=began) and not (forward or turn)]
        return rests[0] - began if rests else None


def changed(**fields):
    """Returns a function that sets fields of a message, whose names are joined by `__`."""

    def change(message):
        for name, value in fields.items():
            *path, last = name.split("__")
            holder = message
            for step in path:
                holder = getattr(holder, step)
            setattr(holder, last, value)
        return message

    return change


def not_a_number(scan):
    scan.ranges = [math.nan] * len(scan.ranges)
    return scan


def turned(scan):
    scan.angle_min += math.pi / 2
    return scan


def later(seconds):
    """Returns a function that adds to the stamp of a message."""

    def change(message):
        stamp = message.header.stamp
        nanoseconds = stamp.sec * 10**9 + stamp.nanosec + round(seconds * 1e9)
        stamp.sec, stamp.nanosec = divmod(max(nanoseconds, 0), 10**9)
        return message

    return change


def no_echo_is_zero(scan):
    scan.ranges = [0.0 if math.isinf(beam) else beam for beam in scan.ranges]
    return scan


def like_the_lds_01(scan):
    """Lists the beams from the last to the first, with the stamp of the last one, and 0 where nothing came back."""
    last = len(scan.ranges) - 1
    later(last * scan.time_increment)(scan)
    scan.angle_min += last * scan.angle_increment
    scan.angle_increment = -scan.angle_increment
    scan.ranges = scan.ranges[::-1]
    return no_echo_is_zero(scan)


def another_publisher(relay, _):
    relay.other = relay.node.create_publisher(Twist, "cmd_vel", 10)


def another_type(relay, _):
    # A participant of its own, because one participant cannot have two types of a topic.
    context = rclpy.Context()
    rclpy.init(context=context)
    relay.other = rclpy.create_node("other", context=context)
    relay.publisher = relay.other.create_publisher(Twist, "odom", 10)


def stand_still(_, robot):
    robot.process.send_signal(signal.SIGSTOP)

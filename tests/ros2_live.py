#!/usr/bin/env python3
"""Drives over ROS 2 with rclpy on the other side, on loopback only. Needs root for a network namespace of its own.

    pip install 'ros-kilted-rclpy[fastrtps]' ros-kilted-sensor-msgs ros-kilted-nav-msgs ros-kilted-geometry-msgs ros-kilted-diagnostic-msgs cyclonedds rosbags
    tests/ros2_live.py XCSCR [DRIVES [PART...]]

XCSCR is a program built with `--features ros2`. A PART is one of the functions of `PARTS`, or `hour`. Prints one line for each claim, and a table of the injected faults.
"""
import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
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
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, LaserScan

from ros2_peers import LASTING, Listener, Peer, Program, Relay
from ros2_peers import another_publisher, another_type, changed, later, like_the_lds_01, no_echo_is_zero, not_a_number, stand_still, turned

XCSCR = Path(sys.argv[1]).resolve()
DRIVES = int(sys.argv[2]) if len(sys.argv) > 2 else 5
MINUTES = 60
BURGER = ("--robot", "turtlebot3-burger")
# The relay does not pass static transforms on.
LASER = ("--laser", "0,0,0")
failures = []


def claim(holds, text):
    print("ok  " if holds else "FAIL", text, flush=True)
    if not holds:
        failures.append(text)


def train(run, world, *arguments):
    if not run.exists():
        command = [XCSCR, "train", world, "--quiet", "--out", run, *arguments]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return run


def simulate(*arguments, world="maze4"):
    return Program(XCSCR, "simulate", world, "--ros2", *arguments)


def drive(run, *arguments):
    return Program(XCSCR, "drive", run, "--ros2", "--sim-time", "--force", *LASER, *arguments)


def repeated(run, bag, *arguments):
    """Decides again by a recording, without ROS. Returns the number of the same decisions, and the output."""
    again = subprocess.run([XCSCR, "drive", run, "--bag", bag, *LASER, *arguments], capture_output=True, text=True)
    found = re.search(r"(\d+) of (\d+) decisions are", again.stdout)
    return int(found[1]) if found else 0, again.stdout


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


def conventions(run):
    """Remapping, a file of parameters, diagnostics, and another localiser in place of AMCL."""
    parameters = run.with_name("drive.yaml")
    parameters.write_text("/**/xcscr_driver:\n  ros__parameters:\n    use_sim_time: true\n    localise: tf\n")
    robot = simulate("--remap", "scan:=/front/scan")
    listener = Peer("listener")
    states = []
    keep = lambda message: states.extend((status.level, status.message) for status in message.status)
    listener.node.create_subscription(DiagnosticArray, "/diagnostics", keep, 50)
    names = ["-r", "scan:=/front/scan"]
    follow = lambda: Program(XCSCR, "drive", run, "--ros2", "--force", "--ros-args", "--params-file", parameters, *names)
    driver = follow()
    time.sleep(4)
    driver.end()
    said = driver.said()
    claim("no transform from map to odom" in said and " 1  cell" not in said, "without the localiser it does not move")
    levels = {level[0] if isinstance(level, bytes) else level for level, _ in states}
    claim(levels and 0 not in levels, f"and /diagnostics has the levels {sorted(levels)}")
    states.clear()
    localiser = Program(sys.executable, ROOT / "tests/ros2_cyclone.py", "localise")
    driver = follow()
    code = driver.wait(60)
    claim(code == 0, f"a drive to the goal by the poses of another localiser, with a remapped scan (exit code {code})")
    if code != 0:
        print(driver.said(), localiser.said())
    words = list(dict.fromkeys(message for _, message in states))
    claim("at-goal" in words, f"/diagnostics: {words}")
    localiser.end(signal.SIGTERM)
    listener.close()
    robot.end()


def by_cyclone(run):
    """The driver and the simulated robot, with bare CycloneDDS between them and nothing of ROS."""
    robot = simulate("--namespace", "raw")
    cyclone = Program(sys.executable, ROOT / "tests/ros2_cyclone.py")
    driver = drive(run)
    code = driver.wait(60)
    claim(code == 0, f"a drive to the goal through bare CycloneDDS (exit code {code})")
    if code != 0:
        print(driver.said(), cyclone.said())
    cyclone.end(signal.SIGTERM)
    robot.end()


def stamped(run):
    robot = simulate("--namespace", "raw")
    relay = Relay(stamped=True)
    code = drive(run, "--stamped").wait(60)
    claim(code == 0 and len(relay.commands) > 100, f"a drive to the goal by TwistStamped (exit code {code})")
    relay.close()
    robot.end()
    robot = simulate("--stamped")
    code = drive(run, "--stamped").wait(60)
    claim(code == 0, f"the same without rclpy in between (exit code {code})")
    robot.end()


def lds_01(run):
    """A TurtleBot3 whose scans are those of the driver of the LDS-01: the profile has their order."""
    burger = train(run.with_name("burger"), "maze4", *BURGER)
    for arguments, expected in [([], 0), (["--scan-order", "forward"], None)]:
        robot = simulate("--namespace", "raw", *BURGER)
        relay = Relay()
        relay.spoil = {"scan": no_echo_is_zero}
        driver = drive(burger, *BURGER, *arguments)
        code = driver.wait(10 if arguments else 180)
        said = driver.said()
        driver.end()
        name = " ".join(arguments) or "no option"
        claim(code == expected, f"scans of the LDS-01 with {name}: exit code {code}")
        if arguments:
            claim("pass --scan-order reversed" in said and not any(forward for _, forward, _ in relay.commands), "and the fault names the option")
        relay.close()
        robot.end()


def foreign_bag(run):
    """Decides by a bag that was recorded by rclpy and written by the library `rosbags`."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_JAZZY)
    folder = run.with_name("foreign")
    robot = simulate()
    recorder = Peer("recorder")
    messages = []
    for topic, kind in [("scan", LaserScan), ("odom", Odometry), ("imu", Imu)]:
        keep = lambda message, topic=topic: messages.append((topic, time.time_ns(), message))
        recorder.node.create_subscription(kind, topic, keep, 50, raw=True)
    time.sleep(1)
    driver = drive(run)
    driver.wait(60)
    recorder.close()
    robot.end()
    kinds = {"scan": "LaserScan", "odom": "Odometry", "imu": "Imu"}
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        packages = {"odom": "nav_msgs"}
        name = lambda topic: f"{packages.get(topic, 'sensor_msgs')}/msg/{kinds[topic]}"
        topics = {topic: writer.add_connection(f"/{topic}", name(topic), typestore=types) for topic in kinds}
        for topic, at, message in messages:
            writer.write(topics[topic], at, message)
    _, output = repeated(run, folder / "foreign.mcap")
    steps = lambda text: re.findall(r"^ *\d+  (cell \S+ \w+)", text, re.MULTILINE)
    live, again = steps(driver.said()), steps(output)
    claim(len(live) > 5 and again[: len(live)] == live, f"a bag of rosbags gives the {len(live)} decisions of the drive")
    if again[: len(live)] != live:
        print(live, output)


FAULTS = [
    ("scans cease", "no-scans", {"scan": lambda _: None}, "no scan on"),
    ("odometry ceases", "no-odometry", {"odom": lambda _: None}, "no odometry on"),
    ("the simulation stands still", "no-clock", stand_still, "no time on /clock"),
    ("stamps jump back 2 s", "clocks-disagree", {"odom": later(-2)}, "off the stamps of /clock"),
    ("scans are stamped 5 s late", "clock-jumped", {"scan": later(5)}, "jumped by"),
    ("scans of the LDS-01", "scan-ahead", {"scan": like_the_lds_01}, "--scan-order reversed"),
    ("ranges are NaN", "invalid-ranges", {"scan": not_a_number}, "are not a number"),
    ("a pose is NaN", "invalid-odometry", {"odom": changed(pose__pose__position__x=math.nan)}, "is not a number"),
    ("/odom in the frame map", "wrong-frame", {"odom": changed(header__frame_id="map")}, "in the frame `map`"),
    ("/scan in the frame camera", "wrong-frame", {"scan": changed(header__frame_id="camera")}, "in the frame `camera`"),
    ("another lidar", "wrong-lidar", {"scan": changed(range_max=2.5)}, "range_max"),
    ("Twist on /odom", "wrong-qos", another_type, "its type is"),
    ("another node on /cmd_vel", "other-publisher", another_publisher, "another node publishes"),
    ("the lidar turns by 90 degrees", "mislocalised", {"scan": turned}, "mislocalised"),
]
# The faults that need more than one scan or message to show.
SLOW_S = {"no-clock": 1.3, "mislocalised": 1.3}


def faults(run):
    print(f"\n{'injected':<30}{'fault':<17}{'stops after':>12}  said")
    for name, fault, spoil, words in FAULTS:
        robot = simulate("--namespace", "raw")
        relay = Relay()
        driver = drive(run)
        moves = relay.until_it_moves()
        began = time.time()
        if callable(spoil):
            spoil(relay, robot)
        else:
            relay.spoil = spoil
        stopped = relay.rests_after(began)
        robot.process.send_signal(signal.SIGCONT)
        driver.end()
        said = [line.strip() for line in driver.said().splitlines() if "stops:" in line and words in line]
        shown = "never" if stopped is None else f"{1000 * stopped:.0f} ms"
        print(f"{name:<30}{fault:<17}{shown:>12}  {said[0] if said else '-'}")
        claim(moves and stopped is not None and stopped < SLOW_S.get(fault, 0.7) and said, name)
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
        began = time.time()
        code = driver.end(with_signal)
        if with_signal == signal.SIGKILL:
            speeds = []
            keep = lambda odometry: speeds.append((time.time(), odometry.twist.twist.linear.x))
            relay.node.create_subscription(Odometry, "raw/odom", keep, 10)
            time.sleep(2)
            last = max((at for at, speed in speeds if abs(speed) > 0.02), default=began)
            claim(moves and speeds and last - began < 1.0, f"{name}: the robot's own time-out stops it in {last - began:.2f} s")
        else:
            stopped = relay.rests_after(began)
            claim(moves and stopped is not None and stopped < 0.15, f"{name}: rest after {1000 * (stopped or 9):.0f} ms, exit code {code}")
        relay.close()
        robot.end()


def panic(run):
    robot = simulate("--namespace", "raw")
    relay = Relay()
    cargo = ["cargo", "test", "--locked", "--features", "ros2", "--test", "ros2_panic", "--", "--ignored", "--nocapture"]
    driver = Program(*cargo, env={**os.environ, "XCSCR_RUN": run, "RUST_BACKTRACE": "0"}, cwd=ROOT)
    code = driver.wait(600)
    at = re.search(r"panics at ([\d.]+)", driver.said())
    began = float(at[1]) if at else time.time()
    moves = any(forward > 0.2 for when, forward, _ in relay.commands if began - 0.2 < when < began)
    stopped = relay.rests_after(began)
    claim(code == 0 and moves and stopped is not None and stopped < 0.15, f"an injected panic: rest after {1000 * (stopped or 9):.0f} ms")
    if code != 0:
        print(driver.said())
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
    driver = drive(run, *BURGER)
    claim(driver.wait(10) == 65 and "a different robot" in driver.said(), "a policy for another robot is refused")


def drives(run, world="maze4", factor=4, robot_of=()):
    """Drives to the goal, and decides again by the recordings without ROS."""
    reached, decisions, same, slowest = 0, 0, 0, []
    for seed in range(1, DRIVES + 1):
        robot = simulate("--seed", seed, "--realtime-factor", factor, *robot_of, world=world)
        bag = run.with_name("drive.mcap")
        driver = drive(run, *robot_of, "--out", bag)
        code = driver.wait(200)
        said = driver.said()
        reached += code == 0
        latency = re.search(r"(\d+) decisions; .*p99 ([\d.]+) ms", said)
        if latency:
            decisions += int(latency[1])
            slowest.append(float(latency[2]))
        if code != 0:
            print(f"seed {seed}: code {code}\n{said}")
        same += repeated(run, bag, *robot_of)[0]
        robot.end()
    claim(reached == DRIVES, f"{reached} of {DRIVES} drives reach the goal in {Path(world).stem}, at {factor} times real time")
    claim(same == decisions > 0, f"{same} of {decisions} decisions are the same without ROS")
    slowest.sort()
    print(f"     p99 of the time from scan to command, median of the drives: {slowest[len(slowest) // 2]:.2f} ms, worst {slowest[-1]:.2f} ms")


def office_drives(run):
    """A TurtleBot3 in an office that was converted from a ROS map."""
    folder = run.parent
    draw = ["cargo", "run", "--quiet", "--locked", "--example", "draw_office_map", "--", folder]
    subprocess.run(draw, check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
    ends_at = ["--cell", "0.5", "--start=2,9", "--goal=14,12.5"]
    office = folder / "office.json"
    subprocess.run([XCSCR, "world", "convert", folder / "office.yaml", *ends_at, "-o", office], check=True, capture_output=True)
    drives(train(folder / "office", office, *BURGER), office, 10, BURGER)


def hour(run):
    """Wanders through a hall for an hour of real time, four times as fast, because nothing is known there."""
    rows = ["############"] + ["#....#.....#"] * 2 + ["#..........#", "#....#.....#", "##.###.#####", "############", "########SG##", "############"]
    hall = run.with_name("hall.json")
    hall.write_text(json.dumps({"name": "hall", "cell_size_m": 1.0, "moves": 4, "rows": rows}))
    lost = train(run.with_name("lost"), hall, "--method", "q-learning", "--episodes", "3", "--set", "reward.step_threshold=1000000")
    start = ["--start", "2.5,5.5,0"]
    robot = simulate("--realtime-factor", "4", *start, world=hall)
    bag = run.with_name("hour.mcap")
    driver = drive(lost, "--out", bag, *start)
    memory = []
    for minute in range(MINUTES):
        time.sleep(60)
        memory.append((robot.memory_kb(), driver.memory_kb()))
        print(f"     {minute + 1:>2} min: simulate {memory[-1][0]} kB, drive {memory[-1][1]} kB", flush=True)
    code = driver.end()
    print("    ", next(line for line in driver.said().splitlines() if "latency" in line))
    (robot_from, driver_from), (robot_to, driver_to) = memory[min(5, MINUTES - 1)], memory[-1]
    claim(code == 75 and robot_to - robot_from < 1024 and driver_to - driver_from < 1024, f"{MINUTES} minutes without growth of memory")
    same, output = repeated(lost, bag, *start)
    claim(same > 0, output.splitlines()[-1])
    robot.end()


PARTS = [robot_for_others, by_cyclone, conventions, refused, mislocalised, drives, office_drives, stamped, lds_01, foreign_bag, ends, panic, quality_of_service, faults]


def main():
    with tempfile.TemporaryDirectory() as work:
        run = train(Path(work) / "run", "maze4")
        rclpy.init()
        for part in [*PARTS, hour]:
            if part.__name__ in (sys.argv[3:] or [part.__name__ for part in PARTS]):
                part(run)
        rclpy.shutdown()
    print(f"{len(failures)} claims failed" if failures else "all claims hold")
    sys.exit(bool(failures))


main()

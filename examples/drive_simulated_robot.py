"""Drives the robot of `xcscr simulate maze4 --ros2` from rclpy: turns away from walls, otherwise drives straight on.

    pip install 'ros-kilted-rclpy[fastrtps]' ros-kilted-sensor-msgs ros-kilted-geometry-msgs
"""
import rclpy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan

rclpy.init()
node = rclpy.create_node("wanderer")
velocity = node.create_publisher(Twist, "cmd_vel", 1)

def scanned(scan):
    command = Twist()
    is_free = min(scan.ranges[-4:] + scan.ranges[:5]) > 0.5
    command.linear.x, command.angular.z = (0.4, 0.0) if is_free else (0.0, 0.8)
    velocity.publish(command)

node.create_subscription(LaserScan, "scan", scanned, 1)
rclpy.spin(node)

"""Lets a policy drive a robot, or with `world:=WORLD` a simulated one. `xcscr` must be on the PATH."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    config = PathJoinSubstitution([FindPackageShare("xcscr_ros"), "config", "drive.yaml"])
    arguments = [
        DeclareLaunchArgument("run", description="folder of the run whose policy drives"),
        DeclareLaunchArgument("robot", default_value="turtlebot3-burger", description="profile or TOML file"),
        DeclareLaunchArgument("params_file", default_value=config, description="options of drive"),
        DeclareLaunchArgument("scan_topic", default_value="scan", description="topic of the lidar"),
        DeclareLaunchArgument("world", default_value="", description="world of the simulated robot; empty for a real one"),
    ]
    run, robot, world = (LaunchConfiguration(name) for name in ("run", "robot", "world"))
    is_simulated = PythonExpression(["'", world, "' != ''"])
    simulate = Node(
        executable="xcscr",
        name="xcscr_robot",
        arguments=["simulate", world, "--ros2", "--robot", robot],
        condition=IfCondition(is_simulated),
        output="screen",
    )
    drive = Node(
        executable="xcscr",
        name="xcscr_driver",
        arguments=["drive", run, "--ros2", "--force"],
        parameters=[LaunchConfiguration("params_file"), {"robot": robot, "use_sim_time": is_simulated}],
        remappings=[("scan", LaunchConfiguration("scan_topic"))],
        output="screen",
        on_exit=Shutdown(),
    )
    return LaunchDescription([*arguments, simulate, drive])

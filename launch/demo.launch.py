# SPDX-License-Identifier: Apache-2.0
"""Starts a robot and the gateway. The robot is simulated: put your own node in its place."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Start the robot, and the gateway with the arguments of its own launch file."""
    robot = Node(package="ros2_json_gateway", executable="sim", output="screen")
    gateway = Path(__file__).with_name("gateway.launch.py")
    return LaunchDescription(
        [robot, IncludeLaunchDescription(PythonLaunchDescriptionSource(str(gateway)))]
    )

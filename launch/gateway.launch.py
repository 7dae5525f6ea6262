# SPDX-License-Identifier: Apache-2.0
"""Starts the gateway. An argument that is not given leaves its setting to the other sources."""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

# with the flag that takes the value
ARGUMENTS = {
    "port": ("--port=", "TCP port (9090)"),
    "lan": ("--set=lan=", "true: listen on all networks, for clients with a token"),
    "namespace": ("--namespace=", "namespace of the gateway's nodes, such as /robot1"),
    "config": ("--config=", "TOML file of settings"),
    "log_level": ("--log-level=", "debug, info, warning or error"),
}


def gateway(context: LaunchContext) -> list[Node]:
    """Return the gateway's process, with a flag for each argument that is given."""
    values = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    flags = [ARGUMENTS[name][0] + value for name, value in values.items() if value]
    return [Node(package="ros2_json_gateway", executable="serve", arguments=flags, output="screen")]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, and start the gateway."""
    declared = [
        DeclareLaunchArgument(name, default_value="", description=text)
        for name, (_, text) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=gateway)])

# SPDX-License-Identifier: Apache-2.0
"""A process that tries what a gateway needs of ROS: ``python -m gateway.sources.rclpy.probe``.

It prints a line of JSON after each step. ROS may end this process at any of them, and then the
lines before show how far it came.
"""

import json
import sys
import time
from collections.abc import Sequence
from typing import Final

NAME: Final = "ros2_gateway_doctor"
PERIOD_S: Final = 0.1
SETTLE_S: Final = 0.5  # after the first node, the others of the robot come


def run(wait_s: float) -> None:
    """Try each step. Wait for nodes of other programs for at most *wait_s*."""
    import numpy as np

    _tell(numpy=np.__version__)
    import rclpy

    _tell(rclpy=rclpy.__file__)
    from rclpy.utilities import get_rmw_implementation_identifier
    from sensor_msgs.msg import LaserScan

    # this loads the part in C, which is compiled for one generation of NumPy
    LaserScan.__class__.__import_type_support__()
    _tell(messages=True)
    _tell(middleware=get_rmw_implementation_identifier())
    _tell(nodes=_nodes(wait_s))


def _nodes(wait_s: float) -> Sequence[str]:
    from rclpy.context import Context
    from rclpy.node import Node

    from gateway.sources.rclpy import fast_dds
    from gateway.sources.rclpy.profile import full_name

    context = Context()
    context.init(args=["--ros-args", "--disable-stdout-logs", "--disable-external-lib-logs"])
    with fast_dds.profile():
        node = Node(NAME, context=context, enable_rosout=False, start_parameter_services=False)
    end_s = time.monotonic() + wait_s
    found: set[str] = set()
    while time.monotonic() < end_s:
        pairs = node.get_node_names_and_namespaces()
        others = {full_name(namespace, name) for name, namespace in pairs if name != NAME}
        if others and not found:
            end_s = min(end_s, time.monotonic() + SETTLE_S)
        found |= others
        time.sleep(PERIOD_S)
    node.destroy_node()
    context.try_shutdown()
    return sorted(found)


def _tell(**step: object) -> None:
    sys.stdout.write(f"{json.dumps(step)}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    run(float(sys.argv[1]))

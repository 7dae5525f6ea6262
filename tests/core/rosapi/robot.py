# SPDX-License-Identifier: Apache-2.0
"""Nodes with parameters, by plain rclpy, each in a separate context."""

from typing import Any, Final

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from gateway.sources.rclpy.executor import ExecutorThread
from tests.sources.nodes import open_node

NAMES: Final = [
    "anything",
    "calibration",
    "camera.fps",
    "camera.name",
    "firmware",
    "flags",
    "gains",
    "labels",
    "later",
    "speed",
    "steps",
    "use_sim_time",
    "verbose",
]


class NodeWithParameters:
    """A node that is spun by a thread, or, *silent*, by nobody."""

    def __init__(self, name: str, *, silent: bool = False, **options: Any) -> None:
        self._context = Context()
        self._context.init(args=["--ros-args", "--disable-stdout-logs"])
        self.node = open_node(name, self._context, **options)
        self._executor = None
        if not silent:
            self._executor = ExecutorThread(self._context, standard=True)
            self._executor.add_node(self.node)

    def value(self, name: str) -> Any:
        """Return what the node itself holds."""
        return self.node.get_parameter(name).value

    def close(self) -> None:
        if self._executor is not None:
            self._executor.close()
        self.node.destroy_node()
        self._context.try_shutdown()
        self._context.destroy()


def declare(node: Node) -> None:
    """Declare a parameter of each kind."""
    node.declare_parameter("verbose", value=False)
    node.declare_parameter(
        "speed",
        0.5,
        ParameterDescriptor(
            description="metres a second",
            floating_point_range=[FloatingPointRange(from_value=0.0, to_value=2.0, step=0.0)],
        ),
    )
    node.declare_parameter(
        "camera.fps",
        30,
        ParameterDescriptor(integer_range=[IntegerRange(from_value=1, to_value=60, step=1)]),
    )
    node.declare_parameter("camera.name", "front")
    node.declare_parameter("firmware", "1.2", ParameterDescriptor(read_only=True))
    node.declare_parameter("gains", [0.1, float("nan")])
    node.declare_parameter("steps", [1, 2])
    node.declare_parameter("flags", [True, False])
    node.declare_parameter("labels", ["a", "b"])
    node.declare_parameter("calibration", [b"\x00", b"\xff"])
    node.declare_parameter("later", Parameter.Type.DOUBLE)  # without a value
    node.declare_parameter("anything", 1, ParameterDescriptor(dynamic_typing=True))

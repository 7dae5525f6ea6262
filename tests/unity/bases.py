# SPDX-License-Identifier: Apache-2.0
"""Robot bases by plain rclpy: what they take as commands, and what they say that they heard."""

from typing import Any, Final

from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node
from std_msgs.msg import Int64, String

STAMPED: Final = "/stamped"  # takes TwistStamped alone, as bases do that ship since Jazzy
CHANGING: Final = "/changing"  # takes what NAME/takes says


class Base:
    """Takes commands of a type on NAME/cmd_vel, and publishes each as Twist on NAME/heard.

    NAME/takes says which types the bases of that name take from then on: "Twist", "TwistStamped",
    both with a space between, or "". The seconds of stamps are on NAME/stamp. It ends with the
    node. Of one name there is one base in a DDS participant, which knows a topic by one type.
    """

    def __init__(self, node: Node, name: str, command: type[Twist | TwistStamped]) -> None:
        self._node = node
        self._name = name
        self._command = command
        self._heard = node.create_publisher(Twist, f"{name}/heard", 10)
        self._stamp = node.create_publisher(Int64, f"{name}/stamp", 10)
        self._subscription: Any = None
        node.create_subscription(String, f"{name}/takes", self._change, 10)

    def take(self, wanted: bool = True) -> None:
        """Take commands from now on, or none."""
        if wanted and self._subscription is None:
            self._subscription = self._node.create_subscription(
                self._command, f"{self._name}/cmd_vel", self._hear, 10
            )
        elif not wanted and self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _change(self, takes: String) -> None:
        self.take(self._command.__name__ in takes.data.split())

    def _hear(self, command: Twist | TwistStamped) -> None:
        if isinstance(command, TwistStamped):
            self._stamp.publish(Int64(data=command.header.stamp.sec))
            command = command.twist
        self._heard.publish(command)

# SPDX-License-Identifier: Apache-2.0
"""The operator's options for the gateway's part in ROS."""

from dataclasses import dataclass
from typing import Literal

Taking = Literal["auto", "eventfd", "executor"]


@dataclass(frozen=True, slots=True)
class RosOptions:
    """The operator's options for the gateway's nodes."""

    node_prefix: str = "ros2_gateway"
    namespace: str = "/"  # of the nodes; topics do not move
    domain_id: int | None = None  # None: the environment's ROS_DOMAIN_ID
    use_sim_time: bool = False
    max_entities: int = 256  # ~100 KB of DDS each, an action 500; discovery traffic for every node
    arguments: tuple[str, ...] = ()  # as ROS takes them: ("--ros-args", "-r", "a:=b")
    taking: Taking = "auto"  # how samples come to the loop, see `gateway.ros.samples`

    @property
    def guard_node(self) -> str:
        """The full name of the guard process' node; ROS hides such names: it has an underscore."""
        return f"{self.namespace.rstrip('/')}/_{self.node_prefix}_guard"

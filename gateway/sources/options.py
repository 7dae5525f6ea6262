# SPDX-License-Identifier: Apache-2.0
"""The operator's options for the gateway's part in ROS."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from gateway.sources.source import RosError

ZENOH_RMW: Final = "rmw_zenoh_cpp"  # for RMW_IMPLEMENTATION


@dataclass(frozen=True, slots=True)
class RosOptions:
    """The operator's options for the gateway's nodes."""

    node_prefix: str = "ros2_gateway"
    namespace: str = "/"  # of the nodes. Topics do not move
    domain_id: int | None = None  # None: the environment's ROS_DOMAIN_ID
    use_sim_time: bool = False
    max_entities: int = 1280  # ~180 KB of DDS each, an action 500. See `gateway.config.limits`
    reserved_entities: int = 16  # of these, for publishers of reserved topics
    reserved_topics: tuple[str, ...] = ("/cmd_vel",)
    arguments: tuple[str, ...] = ()  # as ROS takes them: ("--ros-args", "-r", "a:=b")
    asks_nodes: bool = True  # for definitions that are not installed here

    @property
    def guard_node(self) -> str:
        """The full name of the guard process' node. ROS hides such names: it has an underscore."""
        return f"{self.namespace.rstrip('/')}/_{self.node_prefix}_guard"

    @property
    def hidden_nodes(self) -> Mapping[str, str]:
        """The nodes that clients do not see. Each has one with its publishers instead, or none."""
        before = f"{self.namespace.rstrip('/')}/"
        prefix = self.node_prefix
        return {self.guard_node: "", f"{before}_{prefix}_commands": f"{before}{prefix}_publishers"}


def check_room(open_entities: int, options: RosOptions, *, is_reserved: bool) -> None:
    """Check that one more entity may be opened. *is_reserved*: a publisher of a reserved topic.

    Raises:
        RosError: ``limit_exceeded``.
    """
    most = options.max_entities
    kept = min(options.reserved_entities, most // 4)  # of few, others also need some
    is_full = open_entities >= most
    if is_full or (open_entities >= most - kept and not is_reserved):
        reserve = "" if is_full else f", of which {kept} are kept for command topics"
        text = f"at most {most} ROS entities{reserve}: end some, or raise limits.max_ros_entities"
        raise RosError("limit_exceeded", text)

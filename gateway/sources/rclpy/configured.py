# SPDX-License-Identifier: Apache-2.0
"""The source that the gateway serves by default: ROS 2 as the configuration asks for it."""

import contextlib
from collections.abc import AsyncIterator
from importlib.util import find_spec

from gateway.config.model import Config
from gateway.errors import RosStartError
from gateway.guard.supervisor import GuardProcess
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.sources.source import Ros, RosError
from schemas.installed import InstalledDefinitions


@contextlib.asynccontextmanager
async def open_source(config: Config, definitions: InstalledDefinitions) -> AsyncIterator[Ros]:
    """Take part in ROS on the running loop, until the context ends.

    Raises:
        RosMissingError: rclpy is missing.
        RosStartError: ROS does not start.
    """
    # a check whether ROS takes such types costs CPU time, and is useless if all are installed
    packages = definitions.packages_in_folders()
    makes_types = any(find_spec(package) is None for package in packages)
    async with contextlib.AsyncExitStack() as stack:
        opening = open_ros(
            ros_options(config), definitions, makes_types=makes_types, guard=guard_of(config)
        )
        try:
            ros = await stack.enter_async_context(opening)
        except RosError as error:
            text = str(error).strip()
            is_peer = "resolve peer" in text  # as Fast DDS says it
            remedy = ". Correct its name in ROS_STATIC_PEERS, or remove it" if is_peer else ""
            raise RosStartError(f"ROS: {text}{remedy}") from error
        yield ros


def ros_options(config: Config) -> RosOptions:
    """Return what the configuration says of the gateway's nodes."""
    return RosOptions(
        node_prefix=config.ros.node_prefix,
        namespace=config.ros.namespace,
        domain_id=config.ros.domain_id,
        use_sim_time=config.ros.use_sim_time,
        max_entities=config.limits.max_ros_entities,
        reserved_topics=config.control.topics,
        reserved_entities=config.limits.reserved_ros_entities,
        asks_nodes=config.types.ask_nodes,
    )


def guard_of(config: Config) -> GuardProcess:
    """Return the guard, which is still to be started."""
    namespace, _, name = ros_options(config).guard_node.rpartition("/")
    node = {"name": name, "namespace": namespace or "/", "domain_id": config.ros.domain_id}
    return GuardProcess(
        "gateway.sources.rclpy.stand_alone:StandAlone", node, deadline_s=config.control.deadline_s
    )

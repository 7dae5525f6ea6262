# SPDX-License-Identifier: Apache-2.0
"""One robot behind a router, as a source of a relay."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Final

from gateway.config.model import Config
from gateway.relay.robot_watch import namespace_of
from gateway.sources.options import RosOptions
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.port import ZenohSource
from gateway.sources.zenoh.session import open_session
from schemas.installed import InstalledDefinitions

_PUBLISH: Final = (
    "set relays_publish = true in the file of the router, and let uplink.role of the robot publish"
)


@contextlib.asynccontextmanager
async def open_robot_source(
    zenoh_options: ZenohOptions, config: Config, definitions: InstalledDefinitions, robot: str
) -> AsyncIterator[ZenohSource]:
    """Take part in the ROS of a robot's namespace, until the context ends.

    Raises:
        RosStartError: the router cannot be reached.
    """
    within = replace(zenoh_options, namespace=namespace_of(robot))
    session = await asyncio.to_thread(open_session, within)
    options = RosOptions(
        node_prefix=f"relay_{session.info.zid()}",  # each relay has its own
        namespace=config.ros.namespace,
        domain_id=0,  # of all uplinks
        use_sim_time=config.ros.use_sim_time,
        max_entities=config.limits.max_ros_entities,
        reserved_topics=config.control.topics,
        reserved_entities=config.limits.reserved_ros_entities,
        asks_nodes=config.types.ask_nodes,
    )
    with contextlib.closing(ZenohSource(session, options, definitions)) as source:
        source.publishing.refuse_unheard(_PUBLISH)
        yield source

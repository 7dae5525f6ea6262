# SPDX-License-Identifier: Apache-2.0
"""How the gateway takes part in ROS: what an operator may decide, and the way in.

Importing this needs no rclpy, opening does.
"""

import contextlib
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Literal

from gateway.errors import RosMissingError
from gateway.ports import Ros

Taking = Literal["auto", "eventfd", "executor"]


@dataclass(frozen=True, slots=True)
class RosOptions:
    """What an operator may decide about the gateway's nodes."""

    node_prefix: str = "gateway"
    namespace: str = "/"  # of the nodes; topics do not move
    domain_id: int | None = None  # None: the environment's ROS_DOMAIN_ID
    use_sim_time: bool = False
    max_entities: int = 256  # each costs DDS ~100 KB and every participant a discovery entry
    arguments: tuple[str, ...] = ()  # as ROS takes them: ("--ros-args", "-r", "a:=b")
    taking: Taking = "auto"  # how samples come to the loop, see `gateway.ros.samples`


@contextlib.asynccontextmanager
async def open_ros(options: RosOptions | None = None) -> AsyncIterator[Ros]:
    """Take part in ROS on the running loop, until the context ends, however it ends.

    Several at once and one after another are fine. Starting blocks the loop for some tenths of a
    second, ending for some hundredths: DDS opens and closes its sockets and threads.

    Raises:
        RosMissingError: rclpy cannot be imported.
        RosError: ROS refuses the options.
    """
    try:
        import rclpy  # noqa: F401
    except ImportError as error:
        raise RosMissingError(str(error)) from error
    from gateway.ros.port import RclpyRos

    ros = RclpyRos(RosOptions() if options is None else options)
    try:
        yield ros
    finally:
        ros.close()

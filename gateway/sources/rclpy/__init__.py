# SPDX-License-Identifier: Apache-2.0
"""ROS 2 through rclpy. Only this and the simulated robot import rclpy.

Importing this needs no rclpy, opening does.

The map is docs/contributing/architecture.md.
"""

import contextlib
from collections.abc import AsyncIterator

from gateway.errors import RosMissingError
from gateway.guard.supervisor import GuardProcess
from gateway.sources.options import RosOptions
from gateway.sources.rclpy.shared_memory import check_room, remove_abandoned_segments
from gateway.sources.source import Ros
from schemas.installed import InstalledDefinitions

__all__ = ["RosOptions", "open_ros"]


@contextlib.asynccontextmanager
async def open_ros(
    options: RosOptions | None = None,
    definitions: InstalledDefinitions | None = None,
    *,
    makes_types: bool = False,
    guard: GuardProcess | None = None,
) -> AsyncIterator[Ros]:
    """Take part in ROS on the running loop, until the context ends, however it ends.

    With *definitions*, publishers and subscribers that have another definition of a type are
    reported, and servers that have one are not called. If it *makes_types*, types that are defined
    and not installed can be used at once, see `MessageClasses.make_types`.

    The *guard* ends with the context. Without one, nobody drives.

    Several at once and one after another are fine. Starting blocks the loop for some tenths of a
    second, ending for some hundredths: DDS opens and closes its sockets and threads.

    Raises:
        RosMissingError: rclpy cannot be imported.
        RosError: ROS refuses the options.
    """
    remove_abandoned_segments()
    check_room()  # before rclpy: its tracing ends the process by SIGBUS without room
    try:
        import rclpy  # noqa: F401
    except ImportError as error:
        raise RosMissingError(str(error)) from error
    from gateway.sources.rclpy.message_classes import MessageClasses

    classes = MessageClasses(definitions)
    async with contextlib.AsyncExitStack() as undo:
        undo.push_async_callback(classes.close)
        if makes_types:
            classes.begin_trial()  # it runs while the rest is imported and DDS opens its sockets
        from gateway.sources.rclpy.port import RclpyRos

        ros = RclpyRos(RosOptions() if options is None else options, classes, guard)
        undo.callback(ros.close)
        if guard is not None:
            undo.push_async_exit(guard)
        if makes_types:
            await classes.make_types()
        yield ros

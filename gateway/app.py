# SPDX-License-Identifier: Apache-2.0
"""The composition root: builds the parts, owns signals and shutdown."""

import asyncio
import logging
import signal
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AsyncExitStack, contextmanager
from importlib.metadata import version
from typing import Final

from gateway.codec.image import confine_to_calling_thread
from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.errors import BindError, ConfigError
from gateway.guard.supervisor import GuardProcess
from gateway.memory import exempt_from_collection, keep_large_blocks
from gateway.ports import LogLevel, Ros, RosError
from gateway.ros import RosOptions, open_ros
from gateway.rosapi import interfaces_prefix
from gateway.router.router import Router
from gateway.server.server import Server
from schemas.installed import InstalledDefinitions, installed_prefixes
from schemas.table import Table

logger = logging.getLogger("gateway")


Announce = Callable[[str, str], None]


def run(config: Config, *, announce: Announce) -> int:
    """Serve until SIGINT or SIGTERM; return the exit code.

    Once clients can connect, *announce* gets lines that say where, for people, and the address to
    use on this machine.

    Raises:
        BindError: the address or port cannot be listened on.
        ConfigError: ROS refuses its part of the configuration.
        RosMissingError: there is no rclpy.
    """
    with asyncio.Runner(loop_factory=_loop_factory()) as runner:
        return runner.run(_serve(config, announce))


async def _serve(config: Config, announce: Announce) -> int:
    keep_large_blocks()
    confine_to_calling_thread()
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stop.set)
    async with AsyncExitStack() as stack:
        ros = await _open_ros(stack, config)
        stack.enter_context(_logging_to(ros))
        workers = stack.enter_context(_workers(config.images.workers))
        guard = await stack.enter_async_context(_guard(config))
        router = Router(
            ros,
            Types(InstalledDefinitions([*installed_prefixes(), interfaces_prefix()])),
            Table.load(),
            limits=config.limits,
            workers=workers,
            version=version("ros2-json-gateway"),
            control=config.control,
            guard=guard,
        )
        stack.callback(router.close)
        server = Server(
            router,
            limits=config.limits,
            path=config.path,
            allowed_origins=config.allowed_origins,
            version=version("ros2-json-gateway"),
        )
        addresses = await _listen(stack, server, config)
        lines = list(_address_lines(addresses, config.path))
        exempt_from_collection()
        announce("\n".join(lines), _own_url(addresses, config.path))
        guard.start()  # last: nobody waits for it to listen
        await stop.wait()
        router.stop_robots()  # first: closing the connections takes up to a second
        logger.info("shutting down")
    return 0


async def _open_ros(stack: AsyncExitStack, config: Config) -> Ros:
    try:
        return await stack.enter_async_context(open_ros(_ros_options(config)))
    except RosError as error:
        raise ConfigError(f"ROS: {error}") from error


def _guard(config: Config) -> GuardProcess:
    namespace, _, name = _ros_options(config).guard_node.rpartition("/")
    return GuardProcess(
        name,
        namespace or "/",
        config.ros.domain_id,
        deadline_s=config.control.deadline_s,
    )


async def _listen(stack: AsyncExitStack, server: Server, config: Config) -> list[tuple[str, int]]:
    try:
        return await stack.enter_async_context(server.listening(config.host, config.port))
    except OSError as error:
        raise BindError(config.host, config.port, error) from error


def _loop_factory() -> Callable[[], asyncio.AbstractEventLoop] | None:
    """Return uvloop's if it is installed (extra `fast`): less CPU time per message."""
    try:
        import uvloop
    except ImportError:
        return None
    factory: Callable[[], asyncio.AbstractEventLoop] = uvloop.new_event_loop
    return factory


def _ros_options(config: Config) -> RosOptions:
    return RosOptions(
        node_prefix=config.ros.node_prefix,
        namespace=config.ros.namespace,
        domain_id=config.ros.domain_id,
        use_sim_time=config.ros.use_sim_time,
        max_entities=config.limits.max_ros_entities,
    )


@contextmanager
def _workers(count: int) -> Iterator[ThreadPoolExecutor]:
    """Lend threads for pictures; at the end, running jobs finish and the others never start."""
    workers = ThreadPoolExecutor(count, thread_name_prefix="picture")
    try:
        yield workers
    finally:
        workers.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _logging_to(ros: Ros) -> Iterator[None]:
    """Send the gateway's own log to /rosout as well."""
    handler = _RosoutHandler(ros, asyncio.get_running_loop())
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)


class _RosoutHandler(logging.Handler):
    def __init__(self, ros: Ros, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__(logging.INFO)
        self._ros = ros
        self._loop = loop

    def emit(self, record: logging.LogRecord) -> None:
        text = f"{record.name}: {record.getMessage()}"
        self._loop.call_soon_threadsafe(
            self._ros.log, _ROS_LEVELS.get(record.levelno, "info"), text
        )


_ROS_LEVELS: Final[dict[int, LogLevel]] = {
    logging.WARNING: "warning",
    logging.ERROR: "error",
    logging.CRITICAL: "error",
}


EVERYWHERE: Final = frozenset({"0.0.0.0", "::"})  # noqa: S104  # for messages, not binding


def _address_lines(addresses: list[tuple[str, int]], path: str) -> Iterator[str]:
    """Yield where to connect: with an address that can be typed into a headset, if there is one."""
    if not EVERYWHERE.isdisjoint(host for host, _ in addresses):
        port = addresses[0][1]
        yield f"listening on every network of this machine, port {port}"
        yield f"  on this machine   {_own_url(addresses, path)}"
        for address in _own_addresses():
            yield f"  from a headset    ws://{address}:{port}{path}"
        return
    for host, port in addresses:
        shown = f"[{host}]" if ":" in host else host
        yield f"listening on ws://{shown}:{port}{path}"


def _own_url(addresses: list[tuple[str, int]], path: str) -> str:
    """Return the address that a person on this machine types."""
    host, port = addresses[0]
    if host in EVERYWHERE or host == "127.0.0.1":
        return f"ws://localhost:{port}{path}"
    return f"ws://{f'[{host}]' if ':' in host else host}:{port}{path}"


def _own_addresses() -> list[str]:
    """Return this machine's address on its default route, if it has one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # connecting a datagram socket sends nothing: it asks the routing table
            probe.connect(("192.0.2.1", 9))
        except OSError:
            return []
        return [probe.getsockname()[0]]

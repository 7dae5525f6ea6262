# SPDX-License-Identifier: Apache-2.0
"""The composition root of ``ros2-gateway relay``: many robots on one port."""

import asyncio
import logging
import os
import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from functools import partial
from importlib.metadata import version
from typing import Any, Final

from gateway.access.permissions import Policy
from gateway.access.tokens import Tokens
from gateway.app import (
    Announce,
    handle_signals,
    image_workers,
    listen_ports,
    listening_as,
    loop_factory,
    reload_whenever,
)
from gateway.backports import Runner
from gateway.codec.image import confine_to_calling_thread
from gateway.config.model import Config
from gateway.config.zenoh import Endpoint
from gateway.definitions import known_definitions
from gateway.faults import Fault
from gateway.forced_end import forced_end
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.loop_errors import LoopErrors
from gateway.memory import exempt_from_collection, keep_large_blocks, returning_free_memory
from gateway.relay.driving import RemoteCommands
from gateway.relay.robot_source import open_robot_source
from gateway.relay.robot_watch import RobotWatch
from gateway.relay.robots import Robots
from gateway.relay.zenoh_link import ZenohRobotLink
from gateway.security import open_security
from gateway.service_manager import reporting_to_systemd
from gateway.serving import Common, FindFaults, ServedRobot, common_parts, serving
from gateway.sources.zenoh.access import link_settings
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.session import open_session
from gateway.transport.connection import Connection
from gateway.transport.health import Health
from gateway.transport.robot_paths import RobotPaths
from gateway.transport.static_files import PAGES, StaticFiles

logger = logging.getLogger("gateway")

_REMEDY: Final = "start the router (ros2-gateway router), and check its address and the firewall"


def run(
    config: Config,
    endpoint: Endpoint,
    *,
    announce: Announce,
    load: Callable[[], Config],
    was_interrupted: Callable[[], bool],
) -> int:
    """Serve the robots behind a Zenoh router until a signal. See `gateway.app.run`.

    Raises:
        BindError: the address or port cannot be listened on.
        ConfigError: the configuration contradicts itself, or a file is unusable.
        RosStartError: the router cannot be reached.
    """
    keep_large_blocks()
    confine_to_calling_thread()
    options = ZenohOptions(
        endpoint,
        overrides=config.relay.settings,
        settings=link_settings(config.relay, "relay"),
        section="relay",
        given_by="the address of the router, or relay.settings",
        remedy=_REMEDY,
    )
    with Runner(loop_factory=loop_factory()) as runner:
        return runner.run(_serve(config, options, announce, load, was_interrupted))


class _Relay:
    """The health of a relay as a whole."""

    def __init__(self) -> None:
        self._started_s = time.monotonic()
        self.find_faults: list[FindFaults] = []
        self._is_draining = False

    def drain(self) -> None:
        """Say from now on that new clients go elsewhere."""
        self._is_draining = True

    def health(self) -> Health:
        """Return what is wrong with the relay."""
        faults = [fault for find in self.find_faults for fault in find()]
        if self._is_draining:
            faults.append(Fault("not ready", "the relay is shutting down: connect to another one"))
        return Health(tuple(faults))

    def details(self, robots: Callable[[], Mapping[str, Any]]) -> Mapping[str, Any]:
        """Return more about it."""
        uptime_s = round(time.monotonic() - self._started_s, 1)
        return {"version": version("ros2-json-gateway"), "uptime_s": uptime_s, "robots": robots()}


async def _serve(
    config: Config,
    options: ZenohOptions,
    announce: Announce,
    load: Callable[[], Config],
    was_interrupted: Callable[[], bool],
) -> int:
    asyncio.get_running_loop().set_exception_handler(LoopErrors())
    stop, hung_up = asyncio.Event(), asyncio.Event()
    handle_signals(stop, hung_up, was_interrupted)
    async with AsyncExitStack() as stack:
        end_by_force = stack.enter_context(forced_end())
        security = stack.enter_context(open_security(config))
        session = await asyncio.to_thread(open_session, options)
        files = StaticFiles.read(PAGES)
        workers = stack.enter_context(image_workers(config.images.workers))
        common = common_parts(config, security, workers, files, (RosbridgeFront,))
        relay = _Relay()
        paths = RobotPaths(
            common.connections,
            files,
            security.rules,
            relay.health,
            lambda: relay.details(robots.details),
        )
        robots = Robots(partial(_open_robot, common, options), paths, config.relay.max_robots)
        stack.push_async_callback(robots.close)
        watch = RobotWatch(session, robots.note)
        stack.callback(watch.close)
        relay.find_faults += [watch.faults, robots.faults, security.audit_faults]

        def tick(now_s: float, late_s: float) -> None:
            for robot in robots.served():
                robot.server.tick(now_s, late_s)

        make = partial(Connection, paths)
        ports = listen_ports(config, security)
        addresses, *encrypted = await stack.enter_async_context(
            common.connections.listening(security.posture.hosts, ports, make, tick)
        )

        def reload(tokens: Tokens, policy: Policy) -> None:
            security.authentication.replace(tokens, policy)
            for robot in robots.served():
                robot.server.reload(tokens, policy)

        reloading = asyncio.create_task(reload_whenever(hung_up, load, security, [reload]))
        stack.callback(reloading.cancel)
        exempt_from_collection()
        stack.enter_context(returning_free_memory())
        tls_port = encrypted[0][0][1] if encrypted else None
        announce(listening_as(config, security, addresses, tls_port))()
        stack.enter_context(reporting_to_systemd(os.environ))
        await stop.wait()
        await _drain(relay, stop, config.relay.drain_s)
        end_by_force()
        for robot in robots.served():
            robot.router.stop_robots()  # first: closing the connections takes up to a second
        logger.info("shutting down")
    return 0


async def _drain(relay: _Relay, stop: asyncio.Event, drain_s: float) -> None:
    """Let the load balancer see that this relay ends. A second signal ends it at once."""
    relay.drain()
    if drain_s == 0:
        return
    logger.info("draining for %g s", drain_s)
    stop.clear()
    timer = asyncio.get_running_loop().call_later(drain_s, stop.set)
    await stop.wait()
    timer.cancel()


@asynccontextmanager
async def _open_robot(
    common: Common, options: ZenohOptions, name: str, find_faults: FindFaults
) -> AsyncIterator[ServedRobot]:
    """Serve one robot at its path. Its types are its own."""
    # in a thread, because files take time that viewers of other robots need
    paths = common.config.types.paths
    definitions = await asyncio.to_thread(known_definitions, paths, "types.paths")
    async with open_robot_source(options, common.config, definitions, name) as source:
        open_link = partial(ZenohRobotLink, source.session.zenoh)
        drive = partial(RemoteCommands, common.config.control.topics, open_link)
        faults, base = [find_faults], f"/{name}"
        with serving(source, definitions, common, faults, base, drive) as served:
            yield served

# SPDX-License-Identifier: Apache-2.0
"""The composition root: builds the parts, owns signals and shutdown."""

import asyncio
import logging
import os
import secrets
import signal
import socket
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractAsyncContextManager, AsyncExitStack, contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Final

from gateway.access.permissions import Policy
from gateway.access.posture import Posture
from gateway.access.tokens import Tokens
from gateway.backports import Runner
from gateway.codec.image import confine_to_calling_thread
from gateway.config.model import Config
from gateway.definitions import known_definitions
from gateway.diagnostics import publishing
from gateway.ending_signals import ENDING
from gateway.errors import ConfigError
from gateway.forced_end import forced_end
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.log_fields import counted
from gateway.loop_errors import LoopErrors
from gateway.memory import exempt_from_collection, keep_large_blocks, returning_free_memory
from gateway.rosout import logging_to_rosout
from gateway.security import Security, open_security
from gateway.service_manager import reporting_to_systemd
from gateway.serving import FindFaults, OpenFront, common_parts, serving
from gateway.source_tasks import SourceTasks, unless
from gateway.sources.source import Source
from gateway.transport.lan_discovery import MAX_PATH, FoundGateway, answering_questions
from gateway.transport.listening import ListenPort
from gateway.transport.static_files import PAGES, StaticFiles
from gateway.uplink.configured import uplink_of
from schemas.installed import InstalledDefinitions

logger = logging.getLogger("gateway")

_STANDARD_STREAMS: Final = (0, 1, 2)


@dataclass(frozen=True, slots=True)
class Listening:
    """The data that people need to connect."""

    addresses: Sequence[tuple[str, int]]
    path: str
    posture: Posture
    tokens: Path
    new_token: str | None
    certificate: str | None
    tls_port: int | None = None  # if TLS has a separate port
    token_in: Path | None = None  # the file with the new token, if it is not to be shown

    @property
    def port(self) -> int:
        """The port, the same on all addresses."""
        return self.addresses[0][1]

    @property
    def is_encrypted(self) -> bool:
        """True if clients need ``wss://`` on `port`."""
        return self.certificate is not None and self.tls_port is None


OpenSource = Callable[[Config, InstalledDefinitions], AbstractAsyncContextManager[Source]]
Announce = Callable[[Listening], Callable[[], None]]


def run(
    config: Config,
    *,
    announce: Announce,
    load: Callable[[], Config],
    open_source: OpenSource | None = None,
    open_fronts: Sequence[OpenFront] = (),
    was_interrupted: Callable[[], bool] = lambda: False,
) -> int:
    """Serve until one of the `ENDING` signals. Return the exit code.

    Once clients can connect, *announce* gets the addresses. It returns a function, which is called
    once clients can drive. On SIGHUP, *load* returns the new configuration, whose tokens and
    permissions take effect. If a standard stream was a terminal that is closed now, SIGHUP ends the
    gateway instead. *open_fronts* make fronts in addition to rosbridge's.

    Raises:
        KeyboardInterrupt: the process *was_interrupted* before it handled signals itself.
        BindError: the address or port cannot be listened on.
        ConfigError: two fronts exclude each other.
        RosMissingError: rclpy is missing.
        RosStartError: ROS does not start.
    """
    if open_source is None:
        from gateway.sources.rclpy.configured import open_source as open_rclpy

        open_source = open_rclpy
    keep_large_blocks()
    confine_to_calling_thread()
    with Runner(loop_factory=loop_factory()) as runner:
        return runner.run(
            _serve(
                config,
                announce,
                load,
                open_source,
                (RosbridgeFront, *open_fronts),
                was_interrupted,
            )
        )


async def _serve(
    config: Config,
    announce: Announce,
    load: Callable[[], Config],
    open_source: OpenSource,
    open_fronts: Sequence[OpenFront],
    was_interrupted: Callable[[], bool],
) -> int:
    asyncio.get_running_loop().set_exception_handler(LoopErrors())
    stop, hung_up = asyncio.Event(), asyncio.Event()
    handle_signals(stop, hung_up, was_interrupted)
    async with AsyncExitStack() as stack:
        end_by_force = stack.enter_context(forced_end())
        security = stack.enter_context(open_security(config))
        definitions = known_definitions(config.types.paths, "types.paths")
        tasks = SourceTasks()
        opening = stack.enter_async_context(open_source(config, definitions))
        source = await unless(stop, tasks.watch(opening))
        if source is None:
            end_by_force()
            return 0
        workers = stack.enter_context(image_workers(config.images.workers))
        files = StaticFiles.read(PAGES)
        common = common_parts(config, security, workers, files, open_fronts)
        find_faults: list[FindFaults] = [tasks.faults]
        robot = stack.enter_context(serving(source, definitions, common, find_faults))
        ros, server = robot.ros, robot.server
        stack.enter_context(logging_to_rosout(ros.diagnosis))
        uplink = await stack.enter_async_context(uplink_of(robot.router, robot.types, config))
        find_faults.append(uplink.faults)
        addresses, *encrypted = await stack.enter_async_context(
            server.listening(security.posture.hosts, *listen_ports(config, security))
        )
        apply = (server.reload, lambda _, policy: uplink.reload(policy))
        reloading = asyncio.create_task(reload_whenever(hung_up, load, security, apply))
        stack.callback(reloading.cancel)
        tls_port = encrypted[0][0][1] if encrypted else None
        stack.enter_context(_discoverable(config, security, addresses[0][1], tls_port))
        exempt_from_collection()
        stack.enter_context(returning_free_memory())
        invite = announce(listening_as(config, security, addresses, tls_port))
        if ros.publishing.guard is not None:
            ros.publishing.guard.start()  # last: nobody waits for it to listen
        ready = stack.enter_context(reporting_to_systemd(os.environ))
        stack.enter_context(robot.start.inviting(invite, ready))
        if config.ros.diagnostics and source.publishing is not None:
            what = (robot.types, server.summary, config.ros.node_prefix)
            stack.enter_context(publishing(source.publishing, source.now_ns, *what))
        await stop.wait()
        end_by_force()
        robot.router.stop_robots()  # first: closing the connections takes up to a second
        logger.info("shutting down")
    return 0


def listen_ports(config: Config, security: Security) -> Sequence[ListenPort]:
    """Return the ports to listen on."""
    if config.tls.port is None:
        return [ListenPort(config.port, security.tls)]
    return [ListenPort(config.port), ListenPort(config.tls.port, security.tls)]


def listening_as(
    config: Config, security: Security, addresses: Sequence[tuple[str, int]], tls_port: int | None
) -> Listening:
    """Return what people need."""
    return Listening(
        addresses=addresses,
        path=config.path,
        posture=security.posture,
        tokens=security.token_path,
        new_token=security.new_token,
        certificate=config.tls.cert,
        tls_port=tls_port,
    )


@contextmanager
def _discoverable(
    config: Config, security: Security, port: int, tls_port: int | None
) -> Iterator[None]:
    # Elsewhere than on all networks, the address that a client would take from the answer is wrong.
    is_right = "0.0.0.0" in security.posture.hosts and len(config.path) <= MAX_PATH  # noqa: S104
    if not (config.discoverable and is_right):
        yield
        return
    itself = FoundGateway(
        id=secrets.token_hex(8),
        name=socket.gethostname().partition(".")[0],
        port=port,
        path=config.path,
        is_encrypted=security.tls is not None and tls_port is None,
        tls_port=tls_port,
        needs_token=security.posture.needs_token,
        version=version("ros2-json-gateway"),
    )
    with answering_questions(itself):
        yield


def handle_signals(
    stop: asyncio.Event,
    hung_up: asyncio.Event,
    was_interrupted: Callable[[], bool],
) -> None:
    """Set *stop* when the process must end, and *hung_up* when it must reload."""
    loop = asyncio.get_running_loop()
    if sys.platform == "win32":  # its event loop handles none, and none means to reload
        for number in ENDING:
            signal.signal(number, lambda *_: loop.call_soon_threadsafe(stop.set))
        return
    for number in ENDING:
        loop.add_signal_handler(number, stop.set)
    is_kept = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN  # by nohup
    terminals = [] if is_kept else [number for number in _STANDARD_STREAMS if _is_terminal(number)]

    def hang_up() -> None:
        # SIGHUP also means that the terminal was closed: then the gateway ends
        gone = any(not _is_terminal(number) for number in terminals)
        (stop if gone else hung_up).set()

    loop.add_signal_handler(signal.SIGHUP, hang_up)
    if was_interrupted():  # and nobody noticed: what is raised in a destructor is only printed
        raise KeyboardInterrupt


def _is_terminal(descriptor: int) -> bool:
    try:
        os.tcgetpgrp(descriptor)
    except OSError:
        return False
    return True


async def reload_whenever(
    hung_up: asyncio.Event,
    load: Callable[[], Config],
    security: Security,
    apply: Iterable[Callable[[Tokens, Policy], None]],
) -> None:
    """Reload tokens, permissions, and certificate. After an error the old ones stay."""
    while True:
        await hung_up.wait()
        hung_up.clear()
        try:
            # in a thread: files may be on a disk that hangs
            tokens, policy = await asyncio.to_thread(lambda: security.reload(load()))
        except ConfigError as error:
            logger.error("not reloaded, the old configuration stays: %s", "; ".join(error.problems))
            security.audit.record("reload", successful=False)
            continue
        for each in apply:
            each(tokens, policy)
        security.audit.record("reload", successful=True, tokens=len(tokens.known))
        logger.info("reloaded permissions and %s", counted(len(tokens.known), "token"))


def loop_factory() -> Callable[[], asyncio.AbstractEventLoop] | None:
    """Return uvloop's if it is installed (extra `fast`): less CPU time per message."""
    try:
        import uvloop
    except ImportError:
        return None
    factory: Callable[[], asyncio.AbstractEventLoop] = uvloop.new_event_loop
    return factory


@contextmanager
def image_workers(count: int) -> Iterator[ThreadPoolExecutor]:
    """Lend threads for pictures. At the end, running jobs finish and the others never start."""
    workers = ThreadPoolExecutor(count, thread_name_prefix="picture")
    try:
        yield workers
    finally:
        workers.shutdown(wait=True, cancel_futures=True)

# SPDX-License-Identifier: Apache-2.0
"""The composition root: builds the parts, owns signals and shutdown."""

import asyncio
import errno
import logging
import math
import os
import secrets
import signal
import socket
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractAsyncContextManager, AsyncExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

from gateway.access.posture import Posture
from gateway.backports import Runner
from gateway.codec.image import confine_to_calling_thread
from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.core.missing_parts import complete
from gateway.core.router import Router
from gateway.definitions import known_definitions
from gateway.diagnostics import publishing
from gateway.ending_signals import ENDING
from gateway.errors import ConfigError, system_reason
from gateway.faults import Fault
from gateway.fronts.pictures.front import Pictures
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.log_fields import counted, text_of
from gateway.log_rate import LogRate
from gateway.memory import exempt_from_collection, keep_large_blocks, returning_free_memory
from gateway.security import Security, open_security
from gateway.service_manager import reporting_to_systemd
from gateway.sources.rclpy.configured import open_source as open_rclpy
from gateway.sources.source import Diagnosis, LogLevel, Source
from gateway.start import Start
from gateway.transport.admission import Admission
from gateway.transport.front import Front, Fronts
from gateway.transport.lan_discovery import MAX_PATH, FoundGateway, answering_questions
from gateway.transport.listening import ListenPort
from gateway.transport.server import Server
from gateway.transport.static_files import PAGES, StaticFiles
from schemas.installed import InstalledDefinitions
from schemas.table import Table

logger = logging.getLogger("gateway")

_STANDARD_STREAMS: Final = (0, 1, 2)
SHUTDOWN_S: Final = 1.8  # of the 2 s that there are
WARN_AGAIN_S: Final = 10.0


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
OpenFront = Callable[[Router], Front]
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
        ConfigError: the source refuses its part of the configuration, or two fronts exclude each
            other.
        RosMissingError: rclpy is missing.
    """
    with Runner(loop_factory=_loop_factory()) as runner:
        return runner.run(
            _serve(
                config,
                announce,
                load,
                open_source or open_rclpy,
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
    keep_large_blocks()
    confine_to_calling_thread()
    asyncio.get_running_loop().set_exception_handler(_LoopErrors())
    stop, hung_up = asyncio.Event(), asyncio.Event()
    _handle_signals(stop, hung_up, was_interrupted)
    async with AsyncExitStack() as stack:
        end_by_force = stack.enter_context(_forced_end())
        security = stack.enter_context(open_security(config))
        definitions = known_definitions(config.types.paths, "types.paths")
        source = await stack.enter_async_context(open_source(config, definitions))
        ros = complete(source)
        stack.enter_context(_logging_to(ros.diagnosis))
        workers = stack.enter_context(_workers(config.images.workers))
        types = Types(definitions)
        router = Router(
            ros,
            types,
            Table.load(),
            limits=config.limits,
            workers=workers,
            version=version("ros2-json-gateway"),
            audit=security.audit,
            control=config.control,
            image_format=config.images.default_format,
        )
        stack.callback(router.close)
        start = Start(router.control)
        server = Server(
            router,
            Fronts(*(open_front(router) for open_front in open_fronts)),
            Pictures(router),
            limits=config.limits,
            path=config.path,
            files=StaticFiles.read(PAGES, config.path),
            trusted_proxies=config.trusted_proxies,
            web_rules=security.rules,
            admission=partial(Admission, security.authentication, config.access, security.audit),
            version=version("ros2-json-gateway"),
            find_faults=lambda: (*ros.diagnosis.faults(), *_others(security, start)),
        )
        ports = [ListenPort(config.port, security.tls)]
        if config.tls.port is not None:
            ports = [ListenPort(config.port), ListenPort(config.tls.port, security.tls)]
        addresses, *encrypted = await stack.enter_async_context(
            server.listening(security.posture.hosts, *ports)
        )
        reloading = asyncio.create_task(_reload_whenever(hung_up, load, security, server))
        stack.callback(reloading.cancel)
        tls_port = encrypted[0][0][1] if encrypted else None
        stack.enter_context(_discoverable(config, security, addresses[0][1], tls_port))
        exempt_from_collection()
        stack.enter_context(returning_free_memory())
        invite = announce(_listening(config, security, addresses, tls_port))
        if ros.publishing.guard is not None:
            ros.publishing.guard.start()  # last: nobody waits for it to listen
        ready = stack.enter_context(reporting_to_systemd(os.environ))
        stack.enter_context(start.inviting(invite, ready))
        if config.ros.diagnostics and source.publishing is not None:
            name = config.ros.node_prefix
            reporting = publishing(source.publishing, source.now_ns, types, server.summary, name)
            stack.enter_context(reporting)
        await stop.wait()
        end_by_force()
        router.stop_robots()  # first: closing the connections takes up to a second
        logger.info("shutting down")
    return 0


def _others(security: Security, start: Start) -> Sequence[Fault]:
    return (*security.audit_faults(), *start.faults())


def _listening(
    config: Config, security: Security, addresses: Sequence[tuple[str, int]], tls_port: int | None
) -> Listening:
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


def _handle_signals(
    stop: asyncio.Event,
    hung_up: asyncio.Event,
    was_interrupted: Callable[[], bool],
) -> None:
    """Set *stop* when the process must end, and *hung_up* when it must reload."""
    loop = asyncio.get_running_loop()
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


async def _reload_whenever(
    hung_up: asyncio.Event, load: Callable[[], Config], security: Security, server: Server
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
        server.reload(tokens, policy)
        security.audit.record("reload", successful=True, tokens=len(tokens.known))
        logger.info("reloaded permissions and %s", counted(len(tokens.known), "token"))


def _loop_factory() -> Callable[[], asyncio.AbstractEventLoop] | None:
    """Return uvloop's if it is installed (extra `fast`): less CPU time per message."""
    try:
        import uvloop
    except ImportError:
        return None
    factory: Callable[[], asyncio.AbstractEventLoop] = uvloop.new_event_loop
    return factory


class _LoopErrors:
    """Reports what nobody awaits.

    While no descriptor is left, asyncio tries a hundred times a second to accept a client. It tries
    once more a second later, and raises ValueError if its server was closed.
    """

    def __init__(self) -> None:
        self._warned_s = -math.inf

    def __call__(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if isinstance(error, ValueError) and "_start_serving" in context.get("message", ""):
            return
        if not isinstance(error, OSError) or error.errno not in {errno.EMFILE, errno.ENFILE}:
            loop.default_exception_handler(context)
        elif loop.time() - self._warned_s > WARN_AGAIN_S:
            self._warned_s = loop.time()
            logger.warning(
                "no client can connect, %s: allow more, for example with `ulimit -n`",
                system_reason(error),
            )


@contextmanager
def _forced_end() -> Iterator[Callable[[], None]]:
    """Lend a function that ends the process after `SHUTDOWN_S`, unless this context ends before.

    A service manager that sends SIGTERM sends SIGKILL later, and a library may wait for long.
    """

    def end() -> None:
        logger.error("shutdown has taken %g s, ending by force", SHUTDOWN_S)
        os._exit(1)

    timer = threading.Timer(SHUTDOWN_S, end)
    timer.daemon = True
    yield timer.start
    timer.cancel()


@contextmanager
def _workers(count: int) -> Iterator[ThreadPoolExecutor]:
    """Lend threads for pictures. At the end, running jobs finish and the others never start."""
    workers = ThreadPoolExecutor(count, thread_name_prefix="picture")
    try:
        yield workers
    finally:
        workers.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _logging_to(ros: Diagnosis) -> Iterator[None]:
    """Send the gateway's own log to /rosout as well."""
    handler = _RosoutHandler(ros, asyncio.get_running_loop())
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)


class _RosoutHandler(logging.Handler):
    def __init__(self, ros: Diagnosis, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__(logging.INFO)
        self._ros = ros
        self._loop = loop
        self._rate = LogRate()
        self.addFilter(self._rate)

    def emit(self, record: logging.LogRecord) -> None:
        for each in (*self._rate.overdue(), record):
            self._log(each)

    def _log(self, record: logging.LogRecord) -> None:
        text = f"{record.name}: {text_of(record)}"
        self._loop.call_soon_threadsafe(
            self._ros.log, _ROS_LEVELS.get(record.levelno, "info"), text
        )


_ROS_LEVELS: Final[dict[int, LogLevel]] = {
    logging.WARNING: "warning",
    logging.ERROR: "error",
    logging.CRITICAL: "error",
}

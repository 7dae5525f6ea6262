# SPDX-License-Identifier: Apache-2.0
"""The parts that serve one robot: its core, the fronts, and the server of its clients."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.metadata import version

from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.core.commands.interface import OpenCommands
from gateway.core.missing_parts import complete
from gateway.core.router import Router
from gateway.faults import Fault
from gateway.fronts.pictures.front import Pictures
from gateway.recording.record_requests import recording
from gateway.security import Security
from gateway.sources.source import Ros, Source
from gateway.start import Start
from gateway.transport.admission import Admission
from gateway.transport.connections import Connections
from gateway.transport.front import Front, Fronts, checked_front
from gateway.transport.server import MakeAdmission, Server
from gateway.transport.static_files import StaticFiles
from schemas.installed import InstalledDefinitions
from schemas.table import Table

OpenFront = Callable[[Router], Front]
FindFaults = Callable[[], Sequence[Fault]]


@dataclass(frozen=True, slots=True)
class Common:
    """The parts of this process that all of its robots share."""

    config: Config
    security: Security
    workers: Executor  # for images
    files: StaticFiles
    connections: Connections
    admission: MakeAdmission
    open_fronts: Sequence[OpenFront]


def common_parts(
    config: Config,
    security: Security,
    workers: Executor,
    files: StaticFiles,
    open_fronts: Sequence[OpenFront],
) -> Common:
    """Return the parts, with one admission for all connections."""
    connections = Connections(config.limits)
    admission = Admission(
        security.authentication,
        config.access,
        security.audit,
        connections.room_for,
        security.rules,
    )
    return Common(config, security, workers, files, connections, lambda *_: admission, open_fronts)


@dataclass(frozen=True, slots=True)
class ServedRobot:
    """A robot, and what serves it."""

    ros: Ros
    types: Types
    router: Router
    server: Server
    start: Start


@contextmanager
def serving(
    source: Source,
    definitions: InstalledDefinitions,
    common: Common,
    find_faults: Sequence[FindFaults],
    base: str = "",
    open_commands: OpenCommands | None = None,
) -> Iterator[ServedRobot]:
    """Lend what serves a robot, which nobody can reach yet. At the end the robot stops.

    *find_faults* find those of other parts. *base* comes before every path of the robot. Without
    *open_commands*, this process drives the robot itself.

    Raises:
        ConfigError: the source lacks a method, or two fronts exclude each other.
    """
    config, security = common.config, common.security
    ros, types = complete(source), Types(definitions)
    router = Router(
        ros,
        types,
        Table.load(),
        limits=config.limits,
        workers=common.workers,
        version=version("ros2-json-gateway"),
        audit=security.audit,
        control=config.control,
        image_format=config.images.default_format,
        open_commands=open_commands,
    )
    with ExitStack() as stack:
        stack.callback(router.close)
        router.introspection.keep_log(types)
        recorder = stack.enter_context(recording(router, types, config.recording, security.audit))
        start = Start(router.control)
        server = Server(
            router,
            Fronts(*(checked_front(each(router), router) for each in common.open_fronts)),
            Pictures(router),
            limits=config.limits,
            path=config.path,
            files=common.files.at(base, config.path),
            trusted_proxies=config.trusted_proxies,
            web_rules=security.rules,
            admission=common.admission,
            version=version("ros2-json-gateway"),
            find_faults=lambda: (
                *(*ros.diagnosis.faults(), *recorder.faults(), *start.faults()),
                *(fault for find in find_faults for fault in find()),
                *security.audit_faults(),
            ),
            connections=common.connections,
            base=base,
        )
        yield ServedRobot(ros, types, router, server, start)

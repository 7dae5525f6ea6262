# SPDX-License-Identifier: Apache-2.0
"""The measured servers: the gateway, or any other server of the rosbridge protocol."""

import contextlib
import shlex
import socket
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from benchmarks.errors import BenchmarkError
from benchmarks.processes import Process, running, wait_until

Limits = Mapping[str, int]

_START_S: Final = 5.0

# for scenarios that measure speed, not the limits that protect a robot's network
NO_INBOUND_LIMITS: Final[Limits] = {
    "client_time_share": 1,
    "address_time_share": 1,
    "frames_per_s": 0,
}


@dataclass(frozen=True)
class MeasuredServer:
    """A server and its command. Without a command it is the gateway."""

    name: str = "gateway"
    command: tuple[str, ...] = ()
    port: int = 0

    @contextlib.contextmanager
    def running_in(self, network: tuple[str, ...], host: str) -> Iterator[tuple[str, Process]]:
        """Run it in another network, which a command enters, until the end. Yield as `running`.

        Another server is to listen on all addresses there.
        """
        if not self.command:
            open_to_all = ("--host", host, "--no-auth", "--anyone-may-drive")
            command = (*network, *gateway_command(0), *open_to_all)
            with running(self.name, *command) as process:
                yield process.line_with(r"ws://\d\S+"), process
            return
        with running(self.name, *network, *self.command) as process:
            time.sleep(_START_S)  # its port cannot be asked from here
            yield f"ws://{host}:{self.port}", process

    @contextlib.contextmanager
    def running(self, limits: Limits | None = None) -> Iterator[tuple[str, Process]]:
        """Run it until the end. Yield its URL and its process once it accepts connections.

        *limits* are the limits that a scenario raises, by the names of the gateway's configuration.
        Another server starts unchanged.
        """
        if not self.command:
            with running(self.name, *gateway_command(0, limits)) as process:
                yield process.line_with(r"ws://\S+"), process
            return
        require_free(self.port)
        with running(self.name, *self.command) as process:
            wait_until(
                lambda: not process.is_running() or is_taken(self.port),
                f"{self.name} accepts connections at port {self.port}",
            )
            if not process.is_running():
                raise BenchmarkError(f"{self.name} has ended at once: {shlex.join(self.command)}")
            yield f"ws://127.0.0.1:{self.port}", process


def gateway_command(port: int, limits: Limits | None = None) -> list[str]:
    """Return the command line of the gateway."""
    options = [f"--set=limits.{key}={value}" for key, value in (limits or {}).items()]
    return [
        *(sys.executable, "-m", "gateway", "serve", "--port", str(port)),
        *("--log-level", "warning", *options),
    ]


def require_free(port: int) -> None:
    """Raise BenchmarkError if something listens there already: it would be measured instead."""
    if is_taken(port):
        raise BenchmarkError(f"port {port} is taken, by something that would be measured instead")


def is_taken(port: int) -> bool:
    """Return whether something accepts connections there."""
    with socket.socket() as probe:
        probe.settimeout(1)
        return probe.connect_ex(("127.0.0.1", port)) == 0


def free_port() -> int:
    """Return a port that is free now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])

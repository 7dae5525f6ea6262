# SPDX-License-Identifier: Apache-2.0
"""Errors with causes outside this program, each with a sentence for its operator."""

import errno
import socket
from typing import Final

_BIND_REASONS: Final = {
    errno.EADDRINUSE: "the port is in use: end the program that has it (`ss -ltnp` names it), or"
    " choose another one with --port or --tls-port",
    errno.EACCES: "ports below 1024 need privileges: choose another one with --port or --tls-port",
    errno.EADDRNOTAVAIL: "no interface of this machine has that address: choose one that"
    " `ip -br address` lists, use --lan for all of them, or leave out --host for this machine only",
    errno.EAFNOSUPPORT: "this machine has no such address family: choose another address with"
    " --host",
}
_NO_HOST: Final = (
    "no address has that host name: choose one of this machine's with --host, or --lan"
)

_HOW_TO_GET_ROS: Final = """\
rclpy cannot be imported ({reason}). There are two ways to get it:
  with pip (x86-64 Linux, CPython 3.10 to 3.14):  pip install '.[ros]'  in the source tree
  with a ROS 2 installation:                      source /opt/ros/jazzy/setup.bash
    and run in that distribution's own Python, or a venv of it made with --system-site-packages"""


HOW_TO_GET_RECORDINGS: Final = (
    "install the packages that read and write recordings, with pip install '.[record]' in the"
    " source tree"
)

HOW_TO_GET_ZENOH: Final = (
    "install the packages that speak Zenoh, with pip install '.[zenoh]' in the source tree"
)


def system_reason(error: OSError) -> str:
    """Return the words of the operating system for an error, without the path."""
    return (error.strerror or str(error)).lower()


class GatewayError(Exception):
    """Raised as one of its subclasses. The text is for people and needs no traceback."""


class ConfigError(GatewayError):
    """Raised when the configuration is wrong. ``problems`` has one sentence for each mistake."""

    def __init__(self, *problems: str) -> None:
        super().__init__("\n".join(problems))
        self.problems = problems


class UsageError(GatewayError):
    """Raised when an argument of a command names nothing that exists."""


class BindError(GatewayError):
    """Raised when the server cannot listen on the configured address."""

    def __init__(self, host: str, port: int, cause: OSError) -> None:
        reason = _BIND_REASONS.get(cause.errno or 0) or cause.strerror or str(cause)
        if isinstance(cause, socket.gaierror):  # its numbers are not those of errno
            reason = _NO_HOST
        where = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
        super().__init__(f"cannot listen on {where}, {reason}")


class RosMissingError(GatewayError):
    """Raised when rclpy cannot be imported."""

    def __init__(self, reason: str = "no module named rclpy") -> None:
        super().__init__(_HOW_TO_GET_ROS.format(reason=reason))


class RosStartError(GatewayError):
    """Raised when ROS does not start. The machine may let it start later."""


class RobotDiedError(GatewayError):
    """Raised when the simulated robot of the demonstration ends by itself."""

    def __init__(self, exit_code: int) -> None:
        how = f"signal {-exit_code}" if exit_code < 0 else f"exit code {exit_code}"
        super().__init__(f"the simulated robot ended by itself with {how}")

# SPDX-License-Identifier: Apache-2.0
"""The environment variables that ROS itself reads, checked before it does.

If ROS does not understand a value, it uses another one, with at most a line in its output. If it
cannot load its middleware, it ends the process.
"""

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from gateway.config.domain_id import DOMAIN_ID_EXPECTATION, is_domain_id
from gateway.errors import ConfigError, RosMissingError

_RANGES: Final = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_PEER: Final = re.compile(r"[0-9A-Za-z.:_%-]{1,255}")  # rmw keeps so many characters

# 33 are open at rest, and a few more during the start.
MIN_OPEN_FILES: Final = 48

# Loading the middleware takes a quarter of a second, and longer on a busy machine. A check that is
# not over by then must not keep a gateway from starting.
_LOADING_S: Final = 60
_LOAD: Final = "try:\n import rclpy\nexcept ImportError:\n pass"  # that is reported elsewhere


def use_ros(domain_id: int | None) -> None:
    """Have ROS use this domain, or the environment's, and check what else it reads from there.

    Raises:
        ConfigError: a variable has a value that ROS does not know, or middleware cannot be loaded.
    """
    if domain_id is not None:
        os.environ["ROS_DOMAIN_ID"] = str(domain_id)
    problems = [*_few_open_files(), *_wrong_domain(), *wrong_discovery(), *_missing_middleware()]
    if problems:
        raise ConfigError(*problems)


def require_rclpy() -> None:
    """Check that rclpy is there, without importing it.

    Raises:
        RosMissingError: it is not.
    """
    if find_spec("rclpy") is None:
        raise RosMissingError


@contextmanager
def ros_imports() -> Iterator[None]:
    """Report what to do if an import of ROS fails."""
    try:
        yield
    except ImportError as error:
        raise RosMissingError(str(error)) from error


def _given(variable: str) -> str:
    return os.environ.get(variable, "")  # empty is unset, as to ROS


def _few_open_files() -> Iterator[str]:
    if sys.platform == "win32":
        return  # nobody serves ROS there
    import resource

    allowed, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if 0 <= allowed < MIN_OPEN_FILES:
        yield (
            f"this process may open {allowed} files, but it needs {MIN_OPEN_FILES}, and one more"
            " for each client and ROS entity: allow more, for example by `ulimit -n 1024`"
        )


def _wrong_domain() -> Iterator[str]:
    given = _given("ROS_DOMAIN_ID")
    if given and not is_domain_id(given):
        yield f"ROS_DOMAIN_ID: got {given!r}, expected {DOMAIN_ID_EXPECTATION}"


def wrong_discovery() -> Iterator[str]:
    """Yield a sentence for each variable about discovery that ROS would not understand."""
    given = _given("ROS_AUTOMATIC_DISCOVERY_RANGE")
    if given not in {"", *_RANGES}:
        text = f"{', '.join(_RANGES[:-1])} or {_RANGES[-1]}, or unset it for {_RANGES[0]}"
        yield f"ROS_AUTOMATIC_DISCOVERY_RANGE: got {given!r}, expected {text}"
    given = _given("ROS_LOCALHOST_ONLY")
    if given not in {"", "0", "1"}:
        yield (
            f"ROS_LOCALHOST_ONLY: got {given!r}, expected 0 or 1: better"
            " unset it, and use ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
        )
    given = _given("ROS_STATIC_PEERS")
    if not all(_PEER.fullmatch(peer) for peer in given.split(";") if peer):
        yield (
            f"ROS_STATIC_PEERS: got {given!r}, expected host names or addresses, separated by"
            " semicolons and without spaces, such as `'192.168.1.7;robot.lan'`"
        )


def _missing_middleware() -> Iterator[str]:
    """Try it in a separate process, because rcl ends a process that cannot load its middleware."""
    given = _given("RMW_IMPLEMENTATION")
    if not given:
        return
    import subprocess

    try:
        finished = subprocess.run(
            [sys.executable, "-c", _LOAD], capture_output=True, timeout=_LOADING_S, check=False
        )
    except subprocess.TimeoutExpired:
        return
    if finished.returncode:
        installed = " or ".join(installed_middleware()) or "none is installed"
        yield (
            f"RMW_IMPLEMENTATION: got {given!r}, which ROS cannot load here, expected {installed}:"
            " unset it for the default, or install that package"
        )


def installed_middleware() -> list[str]:
    """Return the names for RMW_IMPLEMENTATION that are installed."""
    prefixes = [*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix]
    index = "share/ament_index/resource_index/rmw_typesupport"
    found = {
        path.name for prefix in prefixes if prefix for path in Path(prefix, index).glob("rmw_*")
    }
    return sorted(found - {"rmw_implementation"})  # which only chooses one of the others

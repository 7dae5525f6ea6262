# SPDX-License-Identifier: Apache-2.0
"""The machine that is checked: its configuration, its environment, and a probe of its ROS."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from gateway.access_files import token_path
from gateway.config.model import Config
from gateway.sources.options import ZENOH_RMW

DISCOVERY_S: Final = 3  # for the first node of the robot: discovery takes 0.2 s, and more by Wi-Fi


@dataclass(frozen=True, slots=True)
class Probed:
    """The steps that a probe of ROS has taken, and why it ended before the last."""

    steps: Mapping[str, Any]
    reason: str = ""  # empty: it came to its end
    said: str = ""  # on standard error
    is_late: bool = False


@dataclass
class Machine:
    """The things that several checks look at. *timeout_s* is for each check."""

    config: Config
    environment: Mapping[str, str]
    timeout_s: float
    began_s: float = field(default_factory=lambda: time.time() - time.monotonic())
    _lock: threading.Lock = field(default_factory=threading.Lock)

    @property
    def domain(self) -> str:
        """The DDS domain of the gateway."""
        configured = self.config.ros.domain_id
        given = self.environment.get("ROS_DOMAIN_ID", "") or "0"
        return given if configured is None else str(configured)

    @property
    def uses_zenoh(self) -> bool:
        """True if ROS goes through Zenoh's router here: it has no DDS, and no discovery."""
        return self.environment.get("RMW_IMPLEMENTATION") == ZENOH_RMW

    @property
    def tokens(self) -> Path:
        """The token file."""
        return token_path(self.config)

    @property
    def folders(self) -> Sequence[Path]:
        """The directories in which the gateway and ROS write."""
        audit = self.config.audit.file
        more = [] if audit is None else [Path(audit).parent]
        return sorted({self.tokens.parent, self.ros_logs, *more})

    @property
    def ros_logs(self) -> Path:
        """The directory in which ROS writes its logs."""
        home = self.environment.get("ROS_HOME") or Path.home() / ".ros"
        return Path(self.environment.get("ROS_LOG_DIR") or Path(home) / "log")

    def probed(self) -> Probed:
        """Return what the probe of ROS has found. It runs once, for all checks."""
        with self._lock:
            return self._probed

    @cached_property
    def _probed(self) -> Probed:
        command = [sys.executable, "-m", "gateway.sources.rclpy.probe", str(DISCOVERY_S)]
        environment = {**os.environ, **self.environment, "ROS_DOMAIN_ID": self.domain}
        try:
            done = subprocess.run(
                command,
                env=environment,
                capture_output=True,
                text=True,
                timeout=self.timeout_s,
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            printed = error.stdout or b""
            text = printed if isinstance(printed, str) else printed.decode()
            reason = f"it did not end within {self.timeout_s:g} s"
            return Probed(_steps(text), reason, is_late=True)
        return Probed(_steps(done.stdout), _reason(done), done.stderr)


def existing(path: Path) -> Path:
    """Return a path, or the nearest of its parents that exists."""
    while not os.path.lexists(path) and path != path.parent:
        path = path.parent
    return path


def _steps(printed: str) -> Mapping[str, Any]:
    steps: dict[str, Any] = {}
    for line in printed.splitlines():
        if line.startswith("{"):
            steps |= json.loads(line)
    return steps


def _reason(done: "subprocess.CompletedProcess[str]") -> str:
    if done.returncode < 0:
        return f"it was killed by {signal.Signals(-done.returncode).name}"
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        return lines[-1] if lines else f"it ended with code {done.returncode}"
    return ""

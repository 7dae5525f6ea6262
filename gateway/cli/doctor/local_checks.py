# SPDX-License-Identifier: Apache-2.0
"""The checks of this machine, by their names."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Final

from gateway.access.posture import posture_of
from gateway.cli.doctor import machine_checks, ros_checks
from gateway.cli.doctor.finding import Check, Finding, Note, Result, Results
from gateway.cli.doctor.machine import Machine
from gateway.cli.doctor.ports import ports
from gateway.cli.doctor.uplink import uplink
from gateway.config.model import Config
from gateway.config.settings import Loaded, load
from gateway.errors import ConfigError

CHECKS: Final[Mapping[str, Callable[[Machine], Results]]] = {
    "domain": ros_checks.domain,
    "middleware": ros_checks.middleware,
    "numpy": ros_checks.numpy,
    "DDS profile": ros_checks.dds_profile,
    "discovery": ros_checks.discovery,
    "shared memory": machine_checks.shared_memory,
    "permissions": machine_checks.permissions,
    "ports": ports,
    "uplink": uplink,
    "clock": machine_checks.clock,
    "disk": machine_checks.disk,
}


def local_checks(
    file: Path | None, environment: Mapping[str, str], timeout_s: float
) -> dict[str, Check]:
    """Return the checks. If the configuration is wrong, the others use the defaults."""
    loaded, results = _configuration(file, environment)
    machine = Machine(loaded.config, environment, timeout_s)
    checks = {name: partial(check, machine) for name, check in CHECKS.items()}
    return {"configuration": lambda: iter(results), **checks}


def _configuration(
    file: Path | None, environment: Mapping[str, str]
) -> tuple[Loaded, list[Result]]:
    try:
        loaded = load(environment=environment, file=file)
    except ConfigError as error:
        return Loaded(Config(), {}), [_finding(problem) for problem in error.problems]
    try:
        posture_of(loaded.config)
    except ConfigError as error:
        problems = loaded.located(error).problems
        return Loaded(Config(), {}), [_finding(problem) for problem in problems]
    files = ", ".join(map(str, loaded.files)) or "no configuration file"
    return loaded, [Note(f"reads {files}")]


def _finding(problem: str) -> Finding:
    why = "The gateway does not start with a wrong configuration"
    return Finding("error", problem, why, "Correct it, and run `ros2-gateway check-config`")

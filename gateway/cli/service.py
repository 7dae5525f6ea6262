# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway install-service`: a unit of systemd that starts at boot."""

import os
import pwd
import shlex
import subprocess
import sys
import sysconfig
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from gateway.errors import RosMissingError, UsageError, system_reason

UNIT: Final = Path("/etc/systemd/system/ros2-gateway.service")
SETUPS: Final = Path("/opt/ros")
_SYSTEMD_RUNS: Final = Path("/run/systemd/system")  # sd_booted(3)
_TOKENS: Final = "/var/lib/ros2-gateway/tokens.json"

# By these, the ROS of a shell finds its robot.
_ROS_VARIABLES: Final = (
    "ROS_DOMAIN_ID",
    "RMW_IMPLEMENTATION",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ROS_LOCALHOST_ONLY",
    "ROS_DISCOVERY_SERVER",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "CYCLONEDDS_URI",
    "ZENOH_SESSION_CONFIG_URI",
)

_TEMPLATE: Final = Path(__file__).with_name("ros2-gateway.service")


@dataclass(frozen=True, slots=True)
class Unit:
    """The command that the unit starts, and its user."""

    user: str
    setups: Sequence[Path]
    arguments: Sequence[str]  # of `ros2-gateway serve`
    variables: Mapping[str, str]

    @property
    def text(self) -> str:
        """The text of the unit."""
        setups = [f"source {shlex.quote(str(setup))}" for setup in self.setups]
        serve = shlex.join([*_gateway(), "serve", *self.arguments])
        variables = {"ROS_DOMAIN_ID": "0", **self.variables}
        environment = " ".join(_quoted(f"{name}={text}") for name, text in variables.items())
        return _TEMPLATE.read_text(encoding="utf-8").format(
            user=self.user,
            environment=f"Environment={environment}",
            command=_quoted(" && ".join([*setups, f"exec {serve}"]), is_command=True),
        )


def unit_of(
    user: str | None,
    setups: Sequence[Path],
    environment: Mapping[str, str],
    *,
    config: Path | None = None,
    lan: bool = False,
) -> Unit:
    """Return the unit of a user. Without *user* it is the one that called sudo.

    Raises:
        UsageError: the user is unknown or not named, or a file is missing.
        RosMissingError: ROS is not installed.
    """
    name = user or environment.get("SUDO_USER", "")
    if not name:
        raise UsageError("no user is named: add --user with the user that runs your ROS nodes")
    try:
        pwd.getpwnam(name)
    except KeyError:
        raise UsageError(
            f"this computer has no user {name!r}: name the user that runs your ROS nodes"
        ) from None
    if config is not None and not config.is_file():
        raise UsageError(f"--config: no file {config}: name a TOML file")
    arguments = [] if config is None else ["--config", str(config.absolute())]
    if lan:
        arguments.append("--lan")
    variables = {key: environment[key] for key in _ROS_VARIABLES if environment.get(key)}
    return Unit(name, _found_setups(setups), arguments, variables)


def install(wanted: Unit) -> Iterator[str]:
    """Write the unit, and enable and start it. Yield a line for each thing that was done.

    Raises:
        UsageError: this process is not root's, the user cannot run the gateway, or systemd refuses.
    """
    if os.geteuid() != 0:
        raise UsageError("only root may write a unit: run it with sudo, or look by --dry-run")
    _check_reach(wanted.user)
    try:
        UNIT.write_text(wanted.text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"cannot write {UNIT}, {system_reason(error)}") from error
    yield f"wrote {UNIT}"
    if _SYSTEMD_RUNS.is_dir():
        for command in (["daemon-reload"], ["enable", UNIT.name], ["restart", UNIT.name]):
            _systemctl(*command)
        yield "started it, also at each boot"
    else:
        yield f"systemd does not run here. To start it, run: systemctl enable --now {UNIT.stem}"
    yield f"its log:    journalctl -u {UNIT.stem} -f"
    if "--lan" in wanted.arguments:
        yield f"its token:  cat {Path(_TOKENS).with_name('first-token')}"
    create = shlex.join([*_gateway(), "token", "--file", _TOKENS, "create", "NAME"])
    yield f"another:    sudo -u {wanted.user} {create}"


def _gateway() -> Sequence[str]:
    """Return the command of this installation."""
    script = Path(sysconfig.get_path("scripts"), "ros2-gateway")
    return [str(script)] if script.is_file() else [sys.executable, "-m", "gateway"]


def _found_setups(given: Sequence[Path]) -> Sequence[Path]:
    for setup in given:
        if not setup.is_file():
            raise UsageError(f"--setup: no file {setup}: name the setup.bash of ROS or a workspace")
    if given:
        return [setup.absolute() for setup in given]
    rclpy = find_spec("rclpy")
    if rclpy is not None and Path(str(rclpy.origin)).is_relative_to(sys.prefix):
        return []  # from wheels, in this environment
    found = sorted(SETUPS.glob("*/setup.bash"))
    if not found:
        raise RosMissingError
    if len(found) > 1:
        names = ", ".join(map(str, found))
        raise UsageError(f"several ROS are installed ({names}): choose one by --setup")
    return found


def _check_reach(user: str) -> None:
    """Check that a user can run this installation. Root's home is closed to others."""
    command = ["runuser", "-u", user, "--", *_gateway(), "--version"]
    tried = subprocess.run(command, capture_output=True, text=True, check=False, cwd="/")
    if tried.returncode:
        reason = (tried.stderr.strip() or "no reason given").splitlines()[-1]
        raise UsageError(
            f"{user} cannot run {shlex.join(_gateway())} ({reason}): install the gateway where"
            f" {user} may read it"
        )


def _systemctl(*arguments: str) -> None:
    done = subprocess.run(["systemctl", *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip() or f"status {done.returncode}").splitlines()[0]
        raise UsageError(
            f"systemctl {' '.join(arguments)} failed ({reason}): look at journalctl -u {UNIT.stem}"
        )


def _quoted(text: str, *, is_command: bool = False) -> str:
    """Return a word of a unit. A `%` is a specifier there, and a `$` a variable of a command."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%")
    return f'"{escaped.replace("$", "$$") if is_command else escaped}"'

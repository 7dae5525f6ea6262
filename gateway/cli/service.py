# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway install-service`: a unit of systemd that starts at boot."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Final, NamedTuple

from gateway.access.posture import posture_of
from gateway.cli.tokens import FIRST_TOKEN, create_command, own_command
from gateway.config.files import FOLDER
from gateway.config.reference import example
from gateway.config.settings import Loaded
from gateway.errors import RosMissingError, UsageError, system_reason

UNIT: Final = Path("/etc/systemd/system/ros2-gateway.service")
CONFIG: Final = FOLDER / "config.toml"
SETUPS: Final = Path("/opt/ros")
_SYSTEMD_RUNS: Final = Path("/run/systemd/system")  # sd_booted(3)
TOKENS: Final = Path("/var/lib/ros2-gateway/tokens.json")
RELOAD: Final = f"sudo systemctl reload {UNIT.stem}"

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

_VARIABLE: Final = re.compile(r'"([A-Z_]+)=([^"]*)"')
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
        serve = shlex.join([*own_command(), "serve", *self.arguments])
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
    if sys.platform == "win32":
        raise UsageError("systemd runs only on Linux: run install-service on the robot")
    import pwd

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


class InstalledService(NamedTuple):
    """The user and the environment of the service of this machine."""

    user: str
    variables: Mapping[str, str]


def installed_service() -> InstalledService | None:
    """Return the service that `install` has written, ``None`` before that."""
    try:
        text = UNIT.read_text(encoding="utf-8")
    except OSError:
        return None
    user = re.search(r"^User=(.+)$", text, re.MULTILINE)
    return InstalledService(user[1] if user else "root", dict(_VARIABLE.findall(text)))


def install(wanted: Unit, loaded: Loaded) -> Iterator[str]:
    """Write the unit, and enable and start it. Yield a line for each thing that was done.

    *loaded* is the configuration that the service will have.

    Raises:
        UsageError: this process is not root's, the user cannot run the gateway, or systemd refuses.
    """
    if os.geteuid() != 0:
        raise UsageError("only root may write a unit: run it with sudo, or look by --dry-run")
    needs_token = posture_of(loaded.config).needs_token
    _check_reach(wanted.user, loaded.files)
    _write(UNIT, wanted.text)
    yield f"wrote {UNIT}"
    if not CONFIG.exists():
        CONFIG.parent.mkdir(parents=True, exist_ok=True)
        _write(CONFIG, example())
        yield f"wrote {CONFIG}, in which every setting is a comment"
    if _SYSTEMD_RUNS.is_dir():
        for command in (["daemon-reload"], ["enable", UNIT.name], ["restart", UNIT.name]):
            _systemctl(*command)
        yield "started it, also at each boot"
    else:
        yield f"systemd does not run here. To start it, run: systemctl enable --now {UNIT.stem}"
    yield f"its log:    journalctl -u {UNIT.stem} -f"
    tokens = Path(loaded.config.access.token_file or TOKENS)
    if needs_token:
        yield f"its token:  sudo cat {tokens.with_name(FIRST_TOKEN)}"
    yield f"another:    {create_command(tokens, wanted.user)}, then {RELOAD}"


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"cannot write {path}, {system_reason(error)}") from error


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


def _check_reach(user: str, files: Sequence[Path]) -> None:
    """Check that a user can run this installation, and read the files of its configuration."""
    run = ["runuser", "-u", user, "--"]
    for file in files:
        if subprocess.run([*run, "test", "-r", file], check=False, cwd="/").returncode:
            raise UsageError(f"{user} cannot read {file}: run chmod a+r {file}, as for its folders")
    command = [*run, *own_command(), "--version"]  # root's home is closed to others
    tried = subprocess.run(command, capture_output=True, text=True, check=False, cwd="/")
    if tried.returncode:
        reason = (tried.stderr.strip() or "no reason given").splitlines()[-1]
        raise UsageError(
            f"{user} cannot run {shlex.join(own_command())} ({reason}): install the gateway where"
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

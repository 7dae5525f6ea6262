# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway token`: make, list and revoke the tokens of clients."""

import logging
import os
import re
import shlex
import sys
import sysconfig
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, TextIO

from gateway.access import token_file
from gateway.access.tokens import is_name, make_token
from gateway.access_files import now_text
from gateway.config.access import Role
from gateway.errors import UsageError, system_reason

if TYPE_CHECKING:
    from gateway.app import Listening

FIRST_TOKEN: Final = "first-token"  # noqa: S105  # the name of a file, beside the token file

_CGROUP: Final = Path("/proc/self/cgroup")
_UNIT: Final = re.compile(r"/([^/\n]+)\.service$", re.MULTILINE)

logger = logging.getLogger("gateway")


def create(path: Path, name: str, role: Role) -> str:
    """Make a token, keep its hash, and return the token.

    Raises:
        UsageError: the name is taken or not one, or the file is unusable.
    """
    if not is_name(name):
        raise UsageError(
            f"got name {name!r}, expected letters, digits and . _ -, at most 64, no sign first"
        )
    text, token = make_token(name, role, now_text())
    token_file.change(path, lambda tokens: tokens.added(token))
    return text


def revoke(path: Path, name: str) -> None:
    """Forget a token.

    Raises:
        UsageError: no token has that name, or the file is unusable.
    """
    token_file.change(path, lambda tokens: tokens.without(name))


def listed(path: Path) -> Iterator[str]:
    """Yield a line for each token: its name, its role, and when it was made.

    Raises:
        UsageError: the file is unusable.
    """
    tokens = token_file.read(path)
    width = max((len(token.name) for token in tokens.known), default=0)
    for token in tokens.known:
        yield f"{token.name:{width}}  {token.role:8}  {token.created}"


def how_to_add(path: Path, environment: Mapping[str, str]) -> str:
    """Return the commands by which a person in a shell adds a token to this running gateway.

    A service has another environment than that shell, so the command names its file and its user.
    """
    if not environment.get("NOTIFY_SOCKET"):
        others_file = [] if path == token_file.default_path(environment) else ["--file", str(path)]
        command = shlex.join(["ros2-gateway", "token", *others_file, "create", "NAME"])
        return f"{command} --role viewer, then kill -HUP {os.getpid()}"
    import pwd

    user = pwd.getpwuid(os.geteuid()).pw_name
    found = _UNIT.search(_CGROUP.read_text(encoding="utf-8"))
    apply = f"systemctl reload {found[1]}" if found else f"kill -HUP {os.getpid()}"
    return f"{create_command(path, user)}, then sudo {apply}"


def create_command(path: Path, user: str) -> str:
    """Return the command that adds a token to the file of a service, which runs as *user*."""
    create = ["token", "--file", str(path), "create", "NAME", "--role", "viewer"]
    return f"sudo -u {user} {shlex.join([*own_command(), *create])}"


def own_command() -> Sequence[str]:
    """Return the command of this installation, which `PATH` need not have."""
    script = Path(sysconfig.get_path("scripts"), "ros2-gateway")
    return [str(script)] if script.is_file() else [sys.executable, "-m", "gateway"]


def kept_from_logs(listening: "Listening", stdout: TextIO) -> "Listening":
    """Put a new token into a file if *stdout* is not a terminal: it may be a log that others read.

    If the file cannot be written, nobody learns the token.
    """
    if listening.new_token is None or stdout.isatty():
        return listening
    path = listening.tokens.with_name(FIRST_TOKEN)
    try:
        token_file.replace(path, f"{listening.new_token}\n".encode())
    except OSError as error:
        another = how_to_add(listening.tokens, os.environ)
        why = f"cannot write {path}, {system_reason(error)}, so nobody knows the new token"
        logger.warning("%s: make room or write access, then make another by %s", why, another)
        return replace(listening, new_token=None)
    logger.info("the token of a new operator is in %s", path)
    return replace(listening, new_token=None, token_in=path)

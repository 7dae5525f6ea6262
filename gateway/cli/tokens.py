# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway token`: make, list and revoke the tokens of clients."""

import logging
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, TextIO

from gateway.access import token_file
from gateway.access.tokens import is_name, make_token
from gateway.access_files import now_text
from gateway.config.access import Role
from gateway.errors import UsageError

if TYPE_CHECKING:
    from gateway.app import Listening

FIRST_TOKEN: Final = "first-token"  # noqa: S105  # the name of a file, beside the token file

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


def kept_from_logs(listening: "Listening", stdout: TextIO) -> "Listening":
    """Put a new token into a file if *stdout* is not a terminal: it may be a log that others read.

    If the file cannot be written, the token is still shown, because it would be lost otherwise.
    """
    if listening.new_token is None or stdout.isatty():
        return listening
    path = listening.tokens.with_name(FIRST_TOKEN)
    try:
        token_file.replace(path, f"{listening.new_token}\n".encode())
    except OSError:
        return listening
    logger.info("the token of a new operator is in %s", path)
    return replace(listening, new_token=None, token_in=path)

# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway token`: make, list and revoke the tokens of clients."""

from collections.abc import Iterator
from pathlib import Path

from gateway.access import token_file
from gateway.access.tokens import TokenFileError, is_name, make_token
from gateway.access_files import now_text
from gateway.config.access import Role
from gateway.errors import UsageError


def create(path: Path, name: str, role: Role) -> str:
    """Make a token and keep its hash; return the token.

    Raises:
        UsageError: the name is taken or not one, or the file is unusable.
    """
    if not is_name(name):
        raise UsageError(
            f"got name {name!r}, expected letters, digits and . _ -, at most 64, no sign first"
        )
    text, token = make_token(name, role, now_text())
    try:
        token_file.change(path, lambda tokens: tokens.added(token))
    except TokenFileError as error:
        raise UsageError(str(error)) from error
    return text


def revoke(path: Path, name: str) -> None:
    """Forget a token.

    Raises:
        UsageError: no token has that name, or the file is unusable.
    """
    try:
        token_file.change(path, lambda tokens: tokens.without(name))
    except TokenFileError as error:
        raise UsageError(str(error)) from error


def listed(path: Path) -> Iterator[str]:
    """Yield a line for each token: its name, its role, and when it was made.

    Raises:
        UsageError: the file is unusable.
    """
    try:
        tokens = token_file.read(path)
    except TokenFileError as error:
        raise UsageError(str(error)) from error
    width = max((len(token.name) for token in tokens.known), default=0)
    for token in tokens.known:
        yield f"{token.name:{width}}  {token.role:8}  {token.created}"

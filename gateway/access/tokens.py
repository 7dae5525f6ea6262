# SPDX-License-Identifier: Apache-2.0
"""Tokens: how they are made, what of them is kept, and how they are compared.

A token has 256 random bits, so nobody can find it by trying. A plain hash of it is as good as a
slow one, because slow hashes only help with passwords that people choose.
"""

import hashlib
import hmac
import json
import re
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from gateway.config.access import Role
from gateway.config.secrets import TOKEN_PREFIX
from gateway.errors import UsageError

_RANDOM_BYTES: Final = 32
MAX_TOKEN_CHARACTERS: Final = 256  # no token of this gateway is longer, so none is hashed
MAX_TOKENS: Final = 1000  # each is compared: 0.3 ms in all
NAME_PATTERN: Final = r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}"


class TokenFileError(UsageError):
    """Raised when a token file, or a change of it, is impossible. The text says what is wrong."""


class Token(BaseModel):
    """Everything that is known of a token, except the token."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    name: Annotated[str, StringConstraints(pattern=rf"^{NAME_PATTERN}$")]
    role: Role
    created: Annotated[str, StringConstraints(max_length=40)]
    sha256: Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]

    @property
    def digest(self) -> bytes:
        """The SHA-256 of the token."""
        return bytes.fromhex(self.sha256)


class _TokenFile(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    version: Literal[1] = 1
    tokens: Annotated[tuple[Token, ...], Field(strict=False, max_length=MAX_TOKENS)] = ()


@dataclass(frozen=True)
class Tokens:
    """The tokens that are valid. Names and hashes are unique."""

    known: tuple[Token, ...] = ()

    def find(self, token: str) -> Token | None:
        """Return what is known of a client's token. Each token takes the same time."""
        if len(token) > MAX_TOKEN_CHARACTERS:
            return None
        digest = digest_of(token)
        found = None
        for each in self.known:
            if hmac.compare_digest(each.digest, digest):
                found = each
        return found

    def named(self, name: str) -> Token | None:
        """Return the token of a name."""
        return next((each for each in self.known if each.name == name), None)

    def with_digest(self, digest: bytes) -> Token | None:
        """Return the token with a hash."""
        return next((each for each in self.known if each.digest == digest), None)

    def added(self, token: Token) -> "Tokens":
        """Return these and one more.

        Raises:
            TokenFileError: there is one of that name, or there are too many.
        """
        if self.named(token.name) is not None:
            raise TokenFileError(f"a token named {token.name} exists already: choose another name")
        if len(self.known) >= MAX_TOKENS:
            raise TokenFileError(f"there are {MAX_TOKENS} tokens already: revoke one")
        return Tokens((*self.known, token))

    def without(self, name: str) -> "Tokens":
        """Return these without the one of that name.

        Raises:
            TokenFileError: no token has that name.
        """
        if self.named(name) is None:
            raise TokenFileError(f"no token is named {name}: see `ros2-gateway token list`")
        return Tokens(tuple(each for each in self.known if each.name != name))


def make_token(name: str, role: Role, created: str) -> tuple[str, Token]:
    """Make a token, and return it, to be shown once, and what to keep of it."""
    token = TOKEN_PREFIX + secrets.token_urlsafe(_RANDOM_BYTES)
    return token, Token(name=name, role=role, created=created, sha256=digest_of(token).hex())


def digest_of(token: str) -> bytes:
    """Return the SHA-256 of a token, of any text at all."""
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).digest()


def is_name(text: str) -> bool:
    """Return whether a token may have this name."""
    return re.fullmatch(NAME_PATTERN, text) is not None


def to_json(tokens: Tokens) -> bytes:
    """Write the text of a token file."""
    file = _TokenFile(tokens=tokens.known).model_dump()
    return json.dumps(file, indent=2).encode() + b"\n"


def from_json(data: bytes) -> Tokens:
    """Read the text of a token file.

    Raises:
        TokenFileError: it is not one.
    """
    try:
        file = _TokenFile.model_validate_json(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"])) or "the text"
        raise TokenFileError(f"{place}: {first['msg'].lower()}") from error
    for what, values in (
        ("name", [each.name for each in file.tokens]),
        ("hash", [each.sha256 for each in file.tokens]),
    ):
        if twice := _first_twice(values):
            raise TokenFileError(f"two tokens have the {what} {twice}")
    return Tokens(file.tokens)


def _first_twice(values: Iterable[str]) -> str | None:
    seen: set[str] = set()
    for value in values:
        if value in seen:
            return value
        seen.add(value)
    return None

# SPDX-License-Identifier: Apache-2.0
"""The places in a handshake where a token may be, and where it must not."""

from collections.abc import Sequence
from typing import Final
from urllib.parse import parse_qsl, urlsplit

# Browsers cannot set headers, so pages send a token by offering two subprotocols: this one, which
# the gateway confirms, and `bearer.TOKEN`, which it never repeats.
SUBPROTOCOL: Final = "ros2-gateway"
_BEARER_SUBPROTOCOL: Final = "bearer."
_BEARER_SCHEME: Final = "bearer"

_URL_KEYS: Final = frozenset({"token", "access_token", "auth", "auth_token", "bearer", "api_key"})

NOT_IN_URLS: Final = (
    "a token must not be in the address, because addresses are stored in logs: send it as"
    " `Authorization: Bearer TOKEN`, as subprotocols `ros2-gateway, bearer.TOKEN`, or as the first"
    ' frame {"op":"auth","token":"TOKEN"}'
)


class CredentialsError(ValueError):
    """Raised when a handshake's credentials contradict themselves, or are in the wrong place."""


def token_in(authorization: Sequence[str], subprotocols: Sequence[str]) -> str | None:
    """Return the token of a handshake, if there is one.

    *authorization* are the values of that header, *subprotocols* those that the client offers.

    Raises:
        CredentialsError: the header is not a bearer token, or there are several tokens.
    """
    found = {_of_header(value) for value in authorization}
    found |= {
        each.removeprefix(_BEARER_SUBPROTOCOL)
        for each in subprotocols
        if each.startswith(_BEARER_SUBPROTOCOL)
    }
    if len(found) > 1:
        raise CredentialsError("more than one token")
    return found.pop() if found else None


def check_target(target: str) -> None:
    """Refuse a request target with a token in its query.

    Raises:
        CredentialsError: it has one.
    """
    query = urlsplit(target).query
    if query and any(key.lower() in _URL_KEYS for key, _ in parse_qsl(query, True)):
        raise CredentialsError(NOT_IN_URLS)


def _of_header(value: str) -> str:
    scheme, _, token = value.strip().partition(" ")
    token = token.strip()
    if scheme.lower() != _BEARER_SCHEME or not token:
        raise CredentialsError("expected `Authorization: Bearer TOKEN`")
    return token

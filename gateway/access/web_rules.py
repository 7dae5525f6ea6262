# SPDX-License-Identifier: Apache-2.0
"""Rules for browsers: the names that the gateway answers to, the pages that may connect.

Browsers let every page open WebSockets to every address, also to localhost. Without these rules any
web site could drive the robot of a visitor. The rule for `Host` covers names that a web site points
here after its page is loaded (DNS rebinding).
"""

import ipaddress
import re
from collections.abc import Iterable, Sequence
from typing import Final, Literal
from urllib.parse import urlsplit

from gateway.access.posture import is_loopback

ANY: Final = "*"
NO_ORIGIN: Final = "null"  # browsers send it for pages from disk and for sandboxed frames
MAX_LOGGED_ORIGINS: Final = 64  # an attacker can make up any number of names
MAX_ORIGIN_CHARACTERS: Final = 128
_DEFAULT_PORTS: Final = {"http": 80, "https": 443}
# as browsers write it: a name such as localhost.evil.example can belong to anybody
_LOOPBACK_ORIGIN: Final = re.compile(r"https?://(localhost|127\.0\.0\.1|\[::1\])(:[0-9]{1,5})?")

Standing = Literal["trusted", "local", "foreign"]
"""The trust in a page: like a program, like the role `page`, or none."""


class WebRules:
    """The rules for `Host` and `Origin`.

    *own_names* are this machine's, *allowed_hosts* further names under which it is reached,
    *allowed_origins* exact origins such as ``https://ui.example``, ``null``, or ``*`` for all.
    With *allows_local*, pages of other servers on this machine may connect. Use it only if no
    other machine reaches the gateway, because a page of its `localhost` would look the same.
    """

    def __init__(
        self,
        own_names: Iterable[str],
        allowed_hosts: Sequence[str] = (),
        allowed_origins: Sequence[str] = (),
        *,
        allows_local: bool = False,
    ) -> None:
        self._names = {name.lower().rstrip(".") for name in (*own_names, *allowed_hosts)}
        self._any_host = ANY in allowed_hosts
        self._allowed_hosts = tuple(allowed_hosts)
        self._allowed_origins = tuple(allowed_origins)
        self._allows_local = allows_local
        self._logged: set[str] = set()

    def is_own_host(self, host: str) -> bool:
        """Return whether the value of a `Host` header is an address, or a name of this machine.

        Raises:
            ValueError: it is neither a name nor an address.
        """
        name = _name_in(host)
        if not name:
            raise ValueError("no host")
        if self._any_host or name.rstrip(".") in self._names:
            return True
        try:
            ipaddress.ip_address(name)
        except ValueError:
            return False
        return True

    def standing(self, origin: str | None, host: str, *, is_encrypted: bool) -> Standing:
        """Return how far a page is trusted. A program has no *origin*.

        Raises:
            ValueError: *origin* is malformed.
        """
        if origin is None or ANY in self._allowed_origins or origin in self._allowed_origins:
            return "trusted"
        if self._is_own(origin, host, is_encrypted=is_encrypted):
            return "trusted"
        # a proxy that passes `Host` on may pass requests of another machine's localhost
        is_local = _LOOPBACK_ORIGIN.fullmatch(origin) and is_loopback(_name_in(host))
        return "local" if self._allows_local and is_local else "foreign"

    def _is_own(self, origin: str, host: str, *, is_encrypted: bool) -> bool:
        """Return whether a page is the gateway's own.

        Its host *and port* must be those of the request, whose `Host` is one of ours: another
        server on this machine is not the gateway. If the gateway encrypts, the page must as well,
        because anybody on the network can change an unencrypted page. If the gateway does not
        encrypt, the page may, because a proxy can do it.
        """
        parsed = urlsplit(origin)
        if is_encrypted and parsed.scheme != "https":
            return False
        default = _DEFAULT_PORTS.get(parsed.scheme)
        own = urlsplit(f"//{host}")
        return (
            default is not None
            and parsed.hostname is not None
            and (parsed.hostname, parsed.port or default) == (own.hostname, own.port or default)
        )

    def setting_for(self, origin: str) -> str:
        """Return the setting that allows a page, in addition to those that are allowed."""
        origins = ",".join((*self._allowed_origins, origin))
        return f"--set 'allowed_origins={origins}'"

    def setting_for_host(self, name: str) -> str:
        """Return the setting that allows a name, in addition to those that are allowed."""
        return f"--set 'allowed_hosts={','.join((*self._allowed_hosts, name))}'"

    def first_refusal(self, origin: str) -> bool:
        """Return whether an origin or a name is refused for the first time, as far as is known."""
        if origin in self._logged or len(self._logged) >= MAX_LOGGED_ORIGINS:
            return False
        self._logged.add(origin)
        return True

    @property
    def is_last_logged(self) -> bool:
        """True if no further origin will be remembered."""
        return len(self._logged) >= MAX_LOGGED_ORIGINS


def _name_in(host: str) -> str:
    return urlsplit(f"//{host}").hostname or ""


def is_plain(origin: str) -> bool:
    """Return whether an origin can be shown, and given as a setting."""
    return (
        len(origin) <= MAX_ORIGIN_CHARACTERS
        and origin.isascii()
        and origin.isprintable()
        and not set(origin) & set(" ,'\"\\")
    )

# SPDX-License-Identifier: Apache-2.0
"""The openness of the gateway: where it listens, and who needs a token."""

import ipaddress
from dataclasses import dataclass
from typing import Final

from gateway.config.access import Role
from gateway.config.model import Config
from gateway.errors import ConfigError

EVERYWHERE: Final = ("0.0.0.0", "::")  # noqa: S104  # what `--lan` asks for
LOOPBACKS: Final = ("127.0.0.1", "::1")  # `localhost` is one of them, as the client's system has it


@dataclass(frozen=True, slots=True)
class Posture:
    """The addresses to listen on, and the role of clients without a token."""

    hosts: tuple[str, ...]
    is_open: bool  # other machines can connect
    anonymous_role: Role | None  # None: every client needs a token

    @property
    def needs_token(self) -> bool:
        """True if every client needs a token."""
        return self.anonymous_role is None


def posture_of(config: Config) -> Posture:
    """Return the posture that a configuration asks for.

    If `lan` or an address opens the gateway to other machines, it asks for tokens.

    Raises:
        ConfigError: the configuration contradicts itself.
    """
    names_host = "host" in config.model_fields_set
    if config.lan and names_host and is_loopback(config.host):
        raise ConfigError(
            f"lan: got true, but host is {config.host}, which only this machine reaches:"
            " leave one of them out"
        )
    if config.tls.port is not None and config.tls.port == config.port != 0:
        raise ConfigError(f"tls.port: {config.port} is the plain port already: choose another")
    by_default = EVERYWHERE if config.lan else LOOPBACKS
    hosts = (config.host,) if names_host else by_default
    is_open = config.lan or not is_loopback(config.host)
    access = config.access
    asked = access.authentication
    if asked == "token" or (asked == "auto" and is_open):
        if access.anonymous_role is not None:
            raise ConfigError(
                "access.anonymous_role: got a role, but every client needs a token:"
                " add --no-auth to let clients in without one"
            )
        return Posture(hosts, is_open, None)
    default: Role = "viewer" if is_open else "admin"
    return Posture(hosts, is_open, access.anonymous_role or default)


def is_loopback(host: str) -> bool:
    """Return whether only this machine can reach an address. A name may point anywhere."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.partition("%")[0]).is_loopback
    except ValueError:
        return False

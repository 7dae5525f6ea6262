# SPDX-License-Identifier: Apache-2.0
"""The file of a router: who may connect, and as what."""

import json
from pathlib import Path
from typing import Annotated, Final

from pydantic import Field, StringConstraints, ValidationError, model_validator
from typing_extensions import Self

from gateway.config.section import Section
from gateway.config.zenoh import Endpoint, RobotName
from gateway.errors import ConfigError, system_reason
from schemas.backports import tomllib

MIN_PASSWORD: Final = 12  # characters: nothing limits the number of attempts

Password = Annotated[
    str,
    StringConstraints(pattern=r"^[^\s:]+$", min_length=MIN_PASSWORD, max_length=200),
    Field(json_schema_extra={"expected": "a password without blanks and colons"}),
]


class ByCertificate(Section):
    """A robot or relay that signs in with a certificate of TLS."""

    certificate: Annotated[str, StringConstraints(min_length=1, max_length=200)] = Field(
        description="Common name in the certificate, which `client_ca` has signed."
    )


Credentials = Password | ByCertificate


class RouterConfig(Section):
    """The router: where it listens, its certificate, and who may connect."""

    listen: tuple[Endpoint, ...] = ("tcp/127.0.0.1:7447",)
    cert: str | None = None
    key: str | None = None
    client_ca: str | None = None
    relays_publish: bool = False  # on topics of robots, also in the name of their nodes
    robots: dict[RobotName, Credentials] = Field(default_factory=dict)
    relays: dict[RobotName, Credentials] = Field(default_factory=dict)

    @property
    def passwords(self) -> dict[str, str]:
        """The passwords by name."""
        named = {**self.robots, **self.relays}
        return {name: each for name, each in named.items() if isinstance(each, str)}

    @property
    def is_open(self) -> bool:
        """True if everybody who reaches the router may do everything."""
        return not (self.robots or self.relays)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        both = sorted(self.robots.keys() & self.relays.keys())
        if both:
            raise ValueError(f"{both[0]} is a robot and a relay: give each its own name")
        if (self.cert is None) != (self.key is None):
            raise ValueError("cert and key belong together: set both")
        if self.cert is None and any(each.startswith("tls/") for each in self.listen):
            raise ValueError("cert and key are missing, which tls/ needs: set both")
        named = (*self.robots.values(), *self.relays.values())
        certified = any(isinstance(each, ByCertificate) for each in named)
        if certified and self.client_ca is None:
            raise ValueError("client_ca is missing, which certificates of others need: set it")
        if certified and self.passwords:
            raise ValueError("some have passwords and some certificates: use one of both for all")
        return self


def read_router_file(path: Path) -> RouterConfig:
    """Read a file. Names of other files in it are relative to it.

    Raises:
        ConfigError: it cannot be read, or is wrong. The text contains no password.
    """
    try:
        given = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"--config: {path} cannot be read, {system_reason(error)}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: {error}: correct it") from error
    for name in ("cert", "key", "client_ca"):
        if isinstance(given.get(name), str):
            given[name] = str(path.parent / Path(given[name]).expanduser())
    return checked(given, str(path))


def checked(given: dict[str, object], source: str) -> RouterConfig:
    """Return what is given as a configuration.

    Raises:
        ConfigError: it is wrong. The text begins with its *source*, and contains no password.
    """
    try:
        # as JSON, which has no tuples
        return RouterConfig.model_validate_json(json.dumps(given, default=str))
    except ValidationError as error:
        problems = [
            f"{source}: {'.'.join(map(str, each['loc'][:2]))}: {each['msg']}".replace(": : ", ": ")
            for each in error.errors(include_input=False, include_url=False)
        ]
        raise ConfigError(*problems) from None

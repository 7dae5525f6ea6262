# SPDX-License-Identifier: Apache-2.0
"""The keys of topics and services in rmw_zenoh: ``domain/name/type/hash``.

Nothing of this package's wire format needs a session: text and bytes come in, values go out.
Anything that a peer sends parses, or raises `WireError`.
"""

import re
from typing import Final, NamedTuple

# Humble has no hashes of types, and this in their place
NO_TYPE_HASH: Final = "TypeHashNotSupported"
# Names have at most 247 characters, types rarely 100. A key has one of each
MAX_KEY_CHARACTERS: Final = 2048

_TYPE: Final = re.compile(
    r"([a-z][a-z0-9_]*)::(msg|srv|action)::dds_::([A-Z][A-Za-z0-9]*(?:_[A-Z][A-Za-z]+)*)_",
    re.ASCII,
)
_NAME: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:/[A-Za-z_][A-Za-z0-9_]*)*", re.ASCII)
_HASH: Final = re.compile(r"RIHS01_[0-9a-f]{64}", re.ASCII)


class WireError(ValueError):
    """Raised when a peer sends what rmw_zenoh does not. The text says what."""


class DataKey(NamedTuple):
    """The key under which the samples of a topic go, and the requests of a service."""

    domain_id: int
    name: str  # with its leading slash
    type_name: str  # pkg/msg/Name
    type_hash: str  # `NO_TYPE_HASH` of Humble

    @property
    def text(self) -> str:
        """The key. See also `parse_key`."""
        parts = (self.name.strip("/"), dds_type(self.type_name), self.type_hash)
        return "/".join((str(self.domain_id), *parts))


def parse_key(text: str) -> DataKey:
    """Return what a data key says.

    Raises:
        WireError: it is another key.
    """
    if len(text) > MAX_KEY_CHARACTERS:
        raise WireError(f"key has {len(text)} characters, at most {MAX_KEY_CHARACTERS}")
    domain, _, rest = text.partition("/")
    name, *of_type = rest.rsplit("/", 2)
    if len(of_type) != 2 or not _NAME.fullmatch(name):
        raise WireError(f"not a key of ROS: {text[:120]!r}")
    type_name, type_hash = of_type
    return DataKey(
        number(domain, "domain"), f"/{name}", ros_type(type_name), checked_hash(type_hash)
    )


def dds_type(type_name: str) -> str:
    """Return rmw's form of ``pkg/msg/Name``: ``pkg::msg::dds_::Name_``."""
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def ros_type(dds_name: str) -> str:
    """Return ``pkg/msg/Name`` for rmw's form of it, also of ``pkg/action/Name_SendGoal``.

    Raises:
        WireError: the text is something else.
    """
    match = _TYPE.fullmatch(dds_name)
    if match is None:
        raise WireError(f"not a type of ROS: {dds_name[:80]!r}")
    return "/".join(match.groups())


def checked_hash(text: str) -> str:
    """Return the hash of a type, or what Humble has in its place.

    Raises:
        WireError: it is neither.
    """
    if text != NO_TYPE_HASH and not _HASH.fullmatch(text):
        raise WireError(f"not the hash of a type: {text[:80]!r}")
    return text


def number(text: str, noun: str) -> int:
    """Return a number that fits in 64 bits.

    Raises:
        WireError: it is something else.
    """
    if not 0 < len(text) <= 20 or not (text.isascii() and text.isdecimal()):
        raise WireError(f"{noun} is not a number: {text[:20]!r}")
    return int(text)

# SPDX-License-Identifier: Apache-2.0
"""The profile of an endpoint as the tokens of rmw_zenoh have it, such as ``::,10:,:,:,,``.

The fields are reliability, durability, history and depth, deadline, lifespan, and liveliness with
its lease, as the numbers of rmw. A field that has rmw_zenoh's default is empty. Before April 2025,
durability had another default: the two forms cannot be told apart, so the newer one counts.
"""

from dataclasses import dataclass
from typing import Final

from gateway.sources.source import Durability, History, Qos, Reliability
from gateway.sources.zenoh.keys import WireError, number

DEFAULT_DEPTH: Final = 42
_FIELDS: Final = 6
_NS_PER_S: Final = 1_000_000_000
_FOREVER_NS: Final = 2**63 - 1
_BEST_EFFORT: Final = "2"
_TRANSIENT_LOCAL: Final = "1"
_KEEP_ALL: Final = "2"
_MANUAL: Final = "3"


@dataclass(frozen=True, slots=True)
class TokenQos:
    """The profile of an endpoint. Times are nanoseconds, ``None`` is forever."""

    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    history: History = "keep_last"
    depth: int = DEFAULT_DEPTH
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    is_manual: bool = False  # of liveliness
    lease_ns: int | None = None


def parse_qos(text: str) -> TokenQos:
    """Parse the text of a profile. Later versions may append fields.

    Raises:
        WireError: it is something else.
    """
    fields = text.split(":")
    if len(fields) < _FIELDS:
        raise WireError(f"QoS has {len(fields)} fields, at least {_FIELDS}: {text[:80]!r}")
    reliability, durability, history, deadline, lifespan, liveliness = fields[:_FIELDS]
    kept = _split(history, 2)
    kind, *lease = _split(liveliness, 3)
    for each in (reliability, durability, kept[0], kind):
        number(each or "0", "QoS")
    return TokenQos(
        "best_effort" if reliability == _BEST_EFFORT else "reliable",
        # "best available" keeps nothing for those who come later
        "transient_local" if durability == _TRANSIENT_LOCAL else "volatile",
        "keep_all" if kept[0] == _KEEP_ALL else "keep_last",
        number(kept[1], "depth") if kept[1] else DEFAULT_DEPTH,
        _duration(_split(deadline, 2)),
        _duration(_split(lifespan, 2)),
        kind == _MANUAL,
        _duration(lease),
    )


def qos_text(qos: Qos) -> str:
    """Return the text of a complete profile of this gateway."""
    depth = "" if qos.depth in {None, DEFAULT_DEPTH} else str(qos.depth)
    return ":".join(
        (
            _BEST_EFFORT if qos.reliability == "best_effort" else "",
            _TRANSIENT_LOCAL if qos.durability == "transient_local" else "",
            f"{_KEEP_ALL if qos.history == 'keep_all' else ''},{depth}",
            _duration_text(qos.deadline_ns),
            _duration_text(qos.lifespan_ns),
            f",{_duration_text(qos.lease_ns)}",
        )
    )


def _split(text: str, parts: int) -> list[str]:
    found = text.split(",")
    if len(found) != parts:
        raise WireError(f"QoS has {len(found)} numbers in place of {parts}: {text[:80]!r}")
    return found


def _duration(parts: list[str]) -> int | None:
    if not all(parts):  # both are empty if it is forever
        return None
    seconds, nanoseconds = (number(each, "duration") for each in parts)
    total = seconds * _NS_PER_S + nanoseconds
    return total if total < _FOREVER_NS else None


def _duration_text(nanoseconds: int | None) -> str:
    if nanoseconds is None or nanoseconds >= _FOREVER_NS:
        return ","
    return ",".join(map(str, divmod(nanoseconds, _NS_PER_S)))

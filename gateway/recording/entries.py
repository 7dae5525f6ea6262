# SPDX-License-Identifier: Apache-2.0
"""The contents of a recording, before they are in a file."""

import glob
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

from gateway.codec.cdr import Cdr
from gateway.sources.source import Qos

ACTIVE: Final = ".active"  # the end of the name of an incomplete file

_UNLIMITED: Final = {"sec": 9223372036, "nsec": 854775807}  # as rmw has it
_DEFAULT_DEPTH: Final = 10  # of ROS 2: discovery does not tell the publishers'


@dataclass(frozen=True, eq=False)
class RecordedTopic:
    """A topic of a recording, which is one channel of each file."""

    name: str
    type_name: str
    schema: str  # the definitions of the type and of all that it nests
    type_hash: str
    qos: str  # a list with the offered profiles, in JSON, which is YAML


class RecordedMessage(NamedTuple):
    """A message, and when it came. Times are nanoseconds of the system clock."""

    received_ns: int
    published_ns: int
    topic: RecordedTopic
    cdr: Cdr


class RecordedNote(NamedTuple):
    """A metadata record. Names are unique in a recording."""

    name: str
    values: dict[str, str]


def incomplete(directory: Path) -> list[Path]:
    """Return the files in the recordings of a directory whose writers have not completed them."""
    # pathlib raises an error if a recording is removed at the same time
    names = glob.glob(f"*/*.mcap{ACTIVE}", root_dir=directory)  # noqa: PTH207
    return sorted(directory / name for name in names)


def qos_text(offers: Sequence[Qos]) -> str:
    """Write a profile for each publisher, as rosbag2 does."""
    return json.dumps([_profile(each) for each in offers])


def _profile(offer: Qos) -> dict[str, Any]:
    """Return a profile. With fewer fields, it would be an error in readers."""
    return {
        "history": offer.history or "keep_last",  # discovery does not tell
        "depth": offer.depth or _DEFAULT_DEPTH,
        "reliability": offer.reliability or "reliable",
        "durability": offer.durability or "volatile",
        "deadline": _duration(offer.deadline_ns),
        "lifespan": _duration(offer.lifespan_ns),
        "liveliness": "manual_by_topic" if offer.is_manual else "automatic",
        "liveliness_lease_duration": _duration(offer.lease_ns),
        "avoid_ros_namespace_conventions": False,
    }


def _duration(duration_ns: int | None) -> dict[str, Any]:
    if duration_ns is None:
        return _UNLIMITED
    return dict(zip(("sec", "nsec"), divmod(duration_ns, 1_000_000_000), strict=True))

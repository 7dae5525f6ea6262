# SPDX-License-Identifier: Apache-2.0
"""The parts that a source may lack. All of them are refused here, one sentence for each."""

from collections.abc import Sequence
from typing import Any, Final, Literal, cast

from typing_extensions import Never

from gateway.faults import Fault
from gateway.sources.source import LogLevel, Ros, RosError, Source

Part = Literal["publishing", "services", "actions", "guard"]

_WHY: Final[dict[Part, str]] = {
    "publishing": "it takes no messages from clients: connect to a gateway whose source does",
    "services": "it carries no calls: connect to a gateway whose source does",
    "actions": "it carries no goals: connect to a gateway whose source does",
    "guard": "nothing would stop the robot if the gateway failed: drive by a gateway that has one",
}


def refuse_part(part: Part) -> Never:
    """Refuse a request to a missing part.

    Raises:
        RosError: ``not_found``, always.
    """
    raise RosError("not_found", f"this source has no {part}: {_WHY[part]}")


def complete(source: Source) -> Ros:
    """Return a source with all parts. Requests to a missing one are refused."""
    parts = (source.publishing, source.services, source.actions, source.diagnosis)
    return cast("Ros", _Completed(source) if None in parts else source)


def require(part: object) -> None:
    """Refuse a request early, before it fails for another reason.

    Raises:
        RosError: the source does not have this part.
    """
    if isinstance(part, Missing):
        refuse_part(part.part)


class Missing:
    """Stands in for a part, and refuses every request to it."""

    guard: Final = None

    def __init__(self, part: Part) -> None:
        self.part: Final = part

    def __getattr__(self, _: str) -> Never:
        refuse_part(self.part)


class _NoDiagnosis:
    def log(self, _: LogLevel, __: str) -> None:
        """There is no /rosout."""

    def faults(self) -> Sequence[Fault]:
        return ()

    def shared_names(self) -> Sequence[str]:
        return ()

    def entity_count(self) -> int:
        return 0


class _Completed:
    def __init__(self, source: Source) -> None:
        self._source = source
        self.publishing = source.publishing or Missing("publishing")
        self.services = source.services or Missing("services")
        self.actions = source.actions or Missing("actions")
        self.diagnosis = source.diagnosis or _NoDiagnosis()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._source, name)

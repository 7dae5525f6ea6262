# SPDX-License-Identifier: Apache-2.0
"""The parts that a source may lack. All of them are refused here, one sentence for each."""

from collections.abc import Sequence
from typing import Any, Final, Literal, cast

from typing_extensions import Never

from gateway.faults import Fault
from gateway.interfaces import check_interface
from gateway.sources.actions import Actions
from gateway.sources.guard import Guard
from gateway.sources.services import Services
from gateway.sources.source import Diagnosis, LogLevel, Publishing, Ros, RosError, Source

Part = Literal["publishing", "services", "actions", "guard"]

_WHY: Final[dict[Part, str]] = {
    "publishing": "it takes no messages from clients: connect to a gateway whose source does",
    "services": "it carries no calls: connect to a gateway whose source does",
    "actions": "it carries no goals: connect to a gateway whose source does",
    "guard": "nothing would stop the robot if the gateway failed: drive by a gateway that has one",
}


def refuse_part(part: Part, refusal: str | None = None) -> Never:
    """Refuse a request to a missing part. *refusal* is what the source says to all of them.

    Raises:
        RosError: ``not_found``, always.
    """
    raise RosError("not_found", refusal or f"this source has no {part}: {_WHY[part]}")


def complete(source: Source) -> Ros:
    """Return a source with all parts. Requests to a missing one are refused.

    Raises:
        ConfigError: the source, or a part that it has, lacks a method.
    """
    check_interface("source", source, Source)
    parts = (source.publishing, source.services, source.actions, source.diagnosis)
    guard = source.publishing and source.publishing.guard
    for part, interface in zip(
        (*parts, guard), (Publishing, Services, Actions, Diagnosis, Guard), strict=True
    ):
        if part is not None:
            check_interface("source", part, interface)
    return cast("Ros", _Completed(source) if None in parts else source)


def require(part: object) -> None:
    """Refuse a request early, before it fails for another reason.

    Raises:
        RosError: the source does not have this part.
    """
    if isinstance(part, Missing):
        refuse_part(part.part, part.refusal)


class Missing:
    """Stands in for a part, and refuses every request to it."""

    guard: Final = None

    def __init__(self, part: Part, refusal: str | None = None) -> None:
        self.part: Final = part
        self.refusal: Final = refusal

    def __getattr__(self, _: str) -> Never:
        refuse_part(self.part, self.refusal)


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
        self.publishing = source.publishing or Missing("publishing", source.refusal)
        self.services = source.services or Missing("services", source.refusal)
        self.actions = source.actions or Missing("actions", source.refusal)
        self.diagnosis = source.diagnosis or _NoDiagnosis()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._source, name)

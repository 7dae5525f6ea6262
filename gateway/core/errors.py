# SPDX-License-Identifier: Apache-2.0
"""Clients' errors, as exceptions that become `status` frames."""

from collections.abc import Mapping
from typing import ClassVar, Final, Literal

Level = Literal["none", "error", "warning", "info"]
SEVERITY: Final[Mapping[Level, int]] = {"none": 0, "error": 1, "warning": 2, "info": 3}

# docs/reference/errors.md explains each
StatusCode = Literal[
    "bad_json",
    "bad_request",
    "unknown_op",
    "bad_name",
    "bad_type",
    "type_conflict",
    "not_found",
    "invalid_value",
    "forbidden",
    "limit_exceeded",
    "timeout",
    "internal",
    "tripped",
    "not_lease_holder",
    "stale_command",
    "already_provided",
    "qos_incompatible",
    "deadline_missed",
    "liveliness_lost",
    "messages_lost",
    "publisher_gone",
    "stale",
    "fresh",
]


class ProtocolError(Exception):
    """A client's request cannot be carried out.

    ``code`` is for programs, the text for people: subject, value, limit, unit. The *level* is that
    of the `status` that answers the request.
    """

    level: ClassVar[Level] = "error"

    def __init__(self, code: StatusCode, reason: str) -> None:
        super().__init__(reason)
        self.code: StatusCode = code


def over_limit(limit: int, what: str, setting: str) -> ProtocolError:
    """Return the refusal of one more than a setting of `gateway.config.limits` allows."""
    text = f"at most {limit} {what}: end one, or raise limits.{setting}"
    return ProtocolError("limit_exceeded", text)


class NothingThereError(ProtocolError):
    """A client ends or answers what it does not have, or no longer.

    That is a warning, as in rosbridge's specification: who ends something twice is not wrong.
    """

    level = "warning"

    def __init__(self, reason: str) -> None:
        super().__init__("not_found", reason)


def unknown_topic(topic: str) -> str:
    """Return the reason for a topic that is absent or, which a client must not notice, hidden."""
    return f"topic {topic} is not known: name its type by `type`, or advertise it"

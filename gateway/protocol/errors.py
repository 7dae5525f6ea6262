# SPDX-License-Identifier: Apache-2.0
"""Clients' errors, as exceptions that become `status` frames."""

from typing import ClassVar, Literal

Level = Literal["none", "error", "warning", "info"]

StatusCode = Literal[
    "bad_json",  # not UTF-8, neither JSON nor CBOR, too deep, duplicate keys
    "bad_request",  # JSON, but not an operation: a field is missing or of another kind
    "unknown_op",
    "bad_name",
    "bad_type",
    "type_conflict",  # the type contradicts that of the topic
    "qos_incompatible",
    "deadline_missed",  # no message came within the deadline that was asked for
    "liveliness_lost",  # a publisher gave no sign of life within its lease
    "messages_lost",  # on the way to the gateway
    "publisher_gone",  # a node publishes no longer
    "not_found",
    "already_provided",  # a ROS node answers calls of the same name
    "forbidden",  # the client's role may not do this, or the client has yet to authenticate
    "limit_exceeded",
    "invalid_value",  # the message does not fit its type
    "stale",  # a topic is silent for longer than the subscription allows
    "fresh",  # and is heard again
    "stale_command",  # it came later than others of the connection
    "not_lease_holder",  # another client drives
    "tripped",  # the robot was stopped, and has to be told to stop before it moves again
    "timeout",  # nobody answered in time
    "internal",
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

# SPDX-License-Identifier: Apache-2.0
"""The rules of command topics that hold wherever the drive is, here or at another gateway."""

from collections.abc import Iterable, Iterator

from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.names import TopicName, resolve_topic
from gateway.core.requests import Advertise
from gateway.core.session import Session
from gateway.drive.twist_cdr import COMMAND_TYPES


def check_type(name: TopicName, message_type: MessageType) -> None:
    """Refuse a type that moves no robot.

    Raises:
        ProtocolError: ``type_conflict``.
    """
    if message_type.name not in COMMAND_TYPES:
        raise ProtocolError(
            "type_conflict",
            f"topic {name} moves a robot and needs {' or '.join(COMMAND_TYPES)}, not"
            f" {message_type.name} (setting control.topics)",
        )


def named_topic(session: Session, requested: str | None, topics: Iterable[TopicName]) -> TopicName:
    """Return a command topic by its name, or the only one that the client sees.

    Raises:
        ProtocolError: the topic is missing, or the client must name one.
    """
    visible = list(filter(session.sees, topics))
    names = ", ".join(visible) or "none"
    if requested is None:
        match visible:
            case [only]:
                return only
        raise ProtocolError("bad_request", f"topic: name one of {names}")
    name = resolve_topic(requested, session.limits.max_name_characters)
    if name not in visible:
        raise ProtocolError("not_found", f"{name} is not a command topic: use one of {names}")
    return name


def say_what_is_ignored(session: Session, request: Advertise) -> None:
    """Warn a client of the options that a command topic does not have."""
    for ignored in _ignored(request):
        text = f"{ignored} is ignored: a command topic stores no message for later subscribers"
        session.warn(ProtocolError("bad_request", text), request)


def _ignored(request: Advertise) -> Iterator[str]:
    if request.latch:
        yield "latch"
    if request.qos is not None and request.qos.durability == "transient_local":
        yield "durability transient_local"

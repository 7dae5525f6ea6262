# SPDX-License-Identifier: Apache-2.0
"""Services and actions that clients provide: who else provides them, and how one fails."""

from collections.abc import Iterable, Sequence
from typing import Final

from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.requests import Request
from gateway.core.session import Session
from gateway.sources.graph import ServerInfo

MAX_NAMED: Final = 4  # nodes of one name. A text for people
# Fields of responses and results that are for people, in the order in which they are tried.
_TEXT_FIELDS: Final = ("message", "status_message", "error_message", "error_string", "reason")


def check_takeover(
    successor: Session, former: Session, name: str, type_name: str, former_type: str
) -> None:
    """Let a client take over a service or an action. From another client only with the same type.

    A client that reconnects must not be locked out by the connection that it lost. But a caller
    must not meet a different type after a takeover.

    Raises:
        ProtocolError: another client provides it with another type.
    """
    if former is not successor and former_type != type_name:
        text = f"{name} is provided by another client, as {former_type}"
        raise ProtocolError("type_conflict", text)


def nodes_of(name: str, servers: Iterable[ServerInfo]) -> Sequence[str]:
    """Return the ROS nodes that provide a service or an action."""
    return next((each.nodes for each in servers if each.name == name), ())


def warn_of_others(session: Session, subject: str, nodes: Sequence[str], request: Request) -> None:
    """Warn a client that ROS nodes provide the same: which of them answers is left to chance."""
    if not nodes:
        return
    # a client that may not see a node does not get its name
    seen = [node for node in nodes if session.sees(node)][:MAX_NAMED]
    who = " and ".join(seen) or "a ROS node"
    text = f"{subject} is also provided by {who}, so both answer each call: choose another name"
    session.warn(ProtocolError("already_provided", text), request)


def failure(message_type: MessageType, reason: str) -> bytes:
    """Return the response, or the result, that best reports a failure.

    A ROS service cannot fail. It can only not answer, and then its caller waits forever. So all
    fields have their defaults, which makes ``success`` false, and *reason* is in a text field.
    """
    texts = {each.name for each in message_type.definition.fields if str(each.type) == "string"}
    field = next((name for name in _TEXT_FIELDS if name in texts), None)
    values = {} if field is None else {field: reason}
    return message_type.encode(values, now_ns=0)

# SPDX-License-Identifier: Apache-2.0
"""Services and actions that a client provides, and also another client or a ROS node."""

from collections.abc import Iterable, Sequence
from typing import Final

from gateway.core.errors import ProtocolError
from gateway.core.requests import Request
from gateway.core.session import Session
from gateway.sources.graph import ServerInfo

MAX_NAMED: Final = 4  # nodes of one name. A text for people


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

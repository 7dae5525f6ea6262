# SPDX-License-Identifier: Apache-2.0
"""The takeover of a client's service or action by another client."""

from gateway.protocol.errors import ProtocolError
from gateway.protocol.session import Session


def check_takeover(
    successor: Session, former: Session, name: str, type_name: str, former_type: str
) -> None:
    """Let a client take over a service or an action; from another client only with the same type.

    A client that reconnects must not be locked out by the connection that it lost. But a caller
    must not meet a different type after a takeover.

    Raises:
        ProtocolError: another client provides it with another type.
    """
    if former is not successor and former_type != type_name:
        text = f"{name} is provided by another client, as {former_type}"
        raise ProtocolError("type_conflict", text)

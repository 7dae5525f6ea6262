# SPDX-License-Identifier: Apache-2.0
"""Who may take over what a client provides."""

from gateway.protocol.errors import ProtocolError
from gateway.protocol.session import Session


def check_takeover(
    successor: Session, former: Session, name: str, type_name: str, former_type: str
) -> None:
    """Let a client take over a service or an action, from another one only with the same type.

    A client that has lost its connection and is back must not find its place taken by the
    connection that it lost; but who calls must not find another type of a sudden.

    Raises:
        ProtocolError: another client provides it with another type.
    """
    if former is not successor and former_type != type_name:
        text = f"{name} is provided by another client, as {former_type}"
        raise ProtocolError("type_conflict", text)

# SPDX-License-Identifier: Apache-2.0
"""What ROS is told where a client that provides something does not deliver."""

from typing import Final

from gateway.codec.types import MessageType

# Fields of responses and results that are for people, in the order in which they are tried.
_WORDS: Final = ("message", "status_message", "error_message", "error_string", "reason")


def failure(message_type: MessageType, reason: str) -> bytes:
    """Return the response, or the result, that says best that there is none.

    A ROS service cannot fail, only not answer, and then its caller waits for ever. So all fields
    have their defaults, which makes ``success`` false, and *reason* goes where people look.
    """
    texts = {each.name for each in message_type.definition.fields if str(each.type) == "string"}
    words = next((name for name in _WORDS if name in texts), None)
    values = {} if words is None else {words: reason}
    return message_type.encode(message_type.validate(values, now_ns=0))

# SPDX-License-Identifier: Apache-2.0
"""The responses and results for ROS if the client that provides a service or action fails."""

from typing import Final

from gateway.codec.types import MessageType

# Fields of responses and results that are for people, in the order in which they are tried.
_TEXT_FIELDS: Final = ("message", "status_message", "error_message", "error_string", "reason")


def failure(message_type: MessageType, reason: str) -> bytes:
    """Return the response, or the result, that best reports a failure.

    A ROS service cannot fail. It can only not answer, and then its caller waits forever. So all
    fields have their defaults, which makes ``success`` false, and *reason* is in a text field.
    """
    texts = {each.name for each in message_type.definition.fields if str(each.type) == "string"}
    field = next((name for name in _TEXT_FIELDS if name in texts), None)
    values = {} if field is None else {field: reason}
    return message_type.encode(values, now_ns=0)

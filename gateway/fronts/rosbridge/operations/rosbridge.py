# SPDX-License-Identifier: Apache-2.0
"""The operations of rosbridge, and the keys that its clients send with each.

Every other operation and every other key of a model is this gateway's own. The keys include those
that only newer servers read, and those that clients send although no server reads them.
"""

from collections.abc import Mapping
from typing import Final

# Of the connection, with any operation. ROS# sends a `fragment_size` with most.
_ANY: Final = "op id fragment_size message_intervall png"

_OPERATIONS: Final = {
    "advertise": "topic type latch queue_size qos",
    "unadvertise": "topic",
    "publish": "topic msg type latch queue_size qos",  # people who write JSON by hand send a type
    "subscribe": "topic type throttle_rate queue_length compression qos",
    "unsubscribe": "topic",
    "call_service": "service args type timeout compression",
    "advertise_service": "service type",
    "unadvertise_service": "service",
    "service_response": "service values result",
    "send_action_goal": "action action_type args feedback compression",
    "cancel_action_goal": "action",
    "advertise_action": "action type",
    "unadvertise_action": "action",
    "action_feedback": "action values",
    "action_result": "action values status result",
    "fragment": "data num total",
    "set_level": "level",
    "auth": "mac client dest rand t level end",
}

KEYS: Final[Mapping[str, frozenset[str]]] = {
    op: frozenset(f"{_ANY} {keys}".split()) for op, keys in _OPERATIONS.items()
}
"""The keys of each operation of rosbridge, by its name."""

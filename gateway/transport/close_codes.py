# SPDX-License-Identifier: Apache-2.0
"""The codes with which the gateway closes a WebSocket: RFC 6455, 7.4, and its own from 4000 on."""

from collections.abc import Mapping
from typing import Final

from gateway.core.errors import Explanation

GOING_AWAY: Final = 1001
PROTOCOL_ERROR: Final = 1002
INVALID_DATA: Final = 1007
POLICY_VIOLATION: Final = 1008
MESSAGE_TOO_BIG: Final = 1009
INTERNAL_ERROR: Final = 1011
OVER_CAPACITY: Final = 1013
UNAUTHENTICATED: Final = 4401
ROLE_REMOVED: Final = 4403
SLOW_CONSUMER: Final = 4503

EXPLANATIONS: Final[Mapping[int, Explanation]] = {
    GOING_AWAY: Explanation(
        "The gateway ends the connection in good order.",
        "The gateway shuts down, or the permissions of your role have changed.",
        "Connect again.",
    ),
    PROTOCOL_ERROR: Explanation(
        "A frame breaks the WebSocket protocol (RFC 6455).",
        "It has no mask, a reserved bit is set, or a control frame is too long.",
        "Correct the WebSocket library of the client, or use another one.",
    ),
    INVALID_DATA: Explanation(
        "A text frame is not UTF-8. A `status` (`bad_json`) comes first.",
        "The client sends another encoding or binary data as text.",
        "Send text as UTF-8, and CBOR in binary frames.",
    ),
    POLICY_VIOLATION: Explanation(
        "The client sent too much of something.",
        "Too many frames per second (`limits.frames_per_s`), too many wrong tokens, or too many"
        " operations without a token.",
        "Send less, and send a valid token before anything else.",
    ),
    MESSAGE_TOO_BIG: Explanation(
        "A message is too large. A `status` (`limit_exceeded`) comes first.",
        "It exceeds `limits.max_message_bytes`, or `access.unauthenticated_message_bytes` before"
        " the token.",
        "Send smaller messages, send the token first, or raise the setting.",
    ),
    INTERNAL_ERROR: Explanation(
        "The gateway has failed for this connection. Other clients are not affected.",
        "A fault in the gateway.",
        "Read the gateway's log, then connect again.",
    ),
    OVER_CAPACITY: Explanation(
        "There are too many clients.",
        "`limits.max_clients`, `limits.max_clients_per_address`, or `access.max_unauthenticated`"
        " is reached.",
        "Close connections that you do not need, or raise the setting that the reason names.",
    ),
    UNAUTHENTICATED: Explanation(
        "The client has no valid token.",
        "No token came in time (`access.auth_timeout_s`), it is wrong, or it was revoked.",
        "Do not connect again with the same token. Ask the robot's administrator for a new one.",
    ),
    ROLE_REMOVED: Explanation(
        "The token has another role now.",
        "The administrator changed the role of your token.",
        "Connect again. The new role applies.",
    ),
    SLOW_CONSUMER: Explanation(
        "The client reads too slowly.",
        "Over half of `limits.send_queue_bytes` waited for `limits.slow_consumer_s`, or answers"
        " alone fill the queue. One answer, however large, never causes it.",
        "Read faster, or ask for less by `throttle_rate`, `fields`, or CBOR.",
    ),
}

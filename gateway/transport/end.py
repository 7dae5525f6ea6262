# SPDX-License-Identifier: Apache-2.0
"""The end of a connection: its cause, and the counts until then."""

import logging
from dataclasses import dataclass
from typing import Final, Literal

from websockets.http11 import Response
from websockets.server import ServerProtocol

from gateway.codec.error_text import truncate
from gateway.transport.close_codes import (
    GOING_AWAY,
    INTERNAL_ERROR,
    INVALID_DATA,
    MESSAGE_TOO_BIG,
    OVER_CAPACITY,
    POLICY_VIOLATION,
    PROTOCOL_ERROR,
    ROLE_REMOVED,
    SLOW_CONSUMER,
    UNAUTHENTICATED,
)

By = Literal["client", "gateway", "network"]

# A closed set, so that they can be counted.
Reason = Literal[
    "closed",  # by the client, with any code
    "lost",  # without a closing handshake: killed, reset, out of reach
    "http",  # a page or the health was sent
    "handshake",  # no WebSocket began
    "going_away",  # the gateway shuts down, or the permissions have changed
    "over_capacity",
    "unauthenticated",
    "role_removed",
    "slow_consumer",
    "send_timeout",  # the client accepts no data
    "abuse",  # more frames or pings, or refused operations, than are allowed
    "protocol_error",
    "invalid_data",
    "message_too_big",
    "internal_error",
]

_REASONS: Final[dict[int, Reason]] = {
    GOING_AWAY: "going_away",
    PROTOCOL_ERROR: "protocol_error",
    INVALID_DATA: "invalid_data",
    POLICY_VIOLATION: "abuse",
    MESSAGE_TOO_BIG: "message_too_big",
    INTERNAL_ERROR: "internal_error",
    OVER_CAPACITY: "over_capacity",
    UNAUTHENTICATED: "unauthenticated",
    ROLE_REMOVED: "role_removed",
    SLOW_CONSUMER: "slow_consumer",
}
_LEVELS: Final[dict[Reason, int]] = {
    "http": logging.DEBUG,  # health is asked for every few seconds
    "unauthenticated": logging.WARNING,
    "abuse": logging.WARNING,
    "send_timeout": logging.WARNING,
}

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class EndCause:
    """The cause of an end: a word to count, and a text to read."""

    by: By
    reason: Reason
    text: str
    code: int | None = None  # of the close frame, or of an HTTP response


# a viewer of images has closed its side
LOOKED_AWAY: Final = EndCause("client", "http", "it does not show images any more", 200)


@dataclass(frozen=True, slots=True)
class ConnectionEnd:
    """A connection that is over."""

    client: str  # address and number
    cause: EndCause
    lasted_s: float
    bytes_in: int
    messages_in: int = 0
    frames_out: int = 0

    def log(self) -> None:
        """Write its line in the log."""
        cause = self.cause
        logger.log(
            _LEVELS.get(cause.reason, logging.INFO),
            "ended by the %s after %.1f s: %s",
            cause.by,
            self.lasted_s,
            truncate(cause.text if cause.code is None else f"{cause.code} {cause.text}".rstrip()),
            extra={
                "client": self.client,
                "reason": cause.reason,
                "by": cause.by,
                "code": cause.code,
                "lasted_s": round(self.lasted_s, 3),
                "bytes_in": self.bytes_in,
                "messages_in": self.messages_in,
                "frames_out": self.frames_out,
            },
        )


def closed_by_gateway(code: int, text: str) -> EndCause:
    """Return the cause of an end by a closing handshake that the gateway began."""
    return EndCause("gateway", _REASONS.get(code, "protocol_error"), text, code)


def answered(status: int, text: str) -> EndCause:
    """Return the cause of an end by an HTTP response that begins no WebSocket."""
    return EndCause("gateway", "http" if status < 400 else "handshake", text, status)


def answered_with(response: Response) -> EndCause | None:
    """Return the cause of an end by this response, or ``None`` if a WebSocket begins."""
    status = response.status_code
    if status == 101:
        return None
    is_page = status < 400
    text = response.reason_phrase if is_page else (response.body or b"").decode().partition("\n")[0]
    return answered(status, text)


def ended_elsewhere(
    protocol: ServerProtocol, error: Exception | None, *, was_open: bool, is_silent: bool
) -> EndCause:
    """Return the cause of an end that the connection did not cause itself.

    *was_open*: it was a WebSocket. *is_silent*: the peer has sent nothing. *error*: of the socket.
    """
    if protocol.close_rcvd is not None:
        return EndCause("client", "closed", protocol.close_rcvd.reason, protocol.close_rcvd.code)
    if protocol.close_sent is not None:  # `websockets` has found an invalid frame
        return closed_by_gateway(protocol.close_sent.code, protocol.close_sent.reason)
    text = ((error.strerror if isinstance(error, OSError) else None) or str(error)).lower()
    if was_open:
        return EndCause("network", "lost", "no closing handshake" if error is None else text)
    refusal = protocol.handshake_exc
    if refusal is not None and not isinstance(refusal.__cause__, EOFError):
        return EndCause("gateway", "handshake", f"its request is too large: {refusal}")
    if error is not None:
        return EndCause("network", "handshake", text)
    sent = "nothing" if is_silent else "no whole request"
    return EndCause("client", "handshake", f"it has sent {sent}")

# SPDX-License-Identifier: Apache-2.0
"""Checks of an open client: is its connection alive, and does it accept data?

A client that answers no ping may stand at a breakpoint, so pings decide nothing. Its kernel
acknowledges accepted data, and reports that it accepts none if the client does not read.
"""

from dataclasses import dataclass
from typing import Final, Protocol

from gateway.config.limits import Limits
from gateway.core.outbox import Outbox
from gateway.transport.close_codes import SLOW_CONSUMER
from gateway.transport.end import EndCause
from gateway.transport.link import Reading

# Time for a hole in the radio. While nothing is on the way, the kernel asks and judges by itself:
# see `gateway.transport.tcp_info`.
DEAD_LINK_S: Final = 10.0
# The time between two readings of the kernel, which take 3 us each.
LOOK_S: Final = 1.0


class WayOut(Protocol):
    """The way of bytes to a client."""

    is_paused: bool  # the socket or the link is full

    def read(self) -> Reading:
        """Return what is known of it now."""


@dataclass(frozen=True, slots=True)
class SendPing:
    """A verdict: send a ping, to measure the round trip and to keep proxies from hanging up."""


@dataclass(frozen=True, slots=True)
class Close:
    """A verdict: close with this code and reason."""

    code: int
    reason: str


# `Why` cuts the connection for this cause: a closing handshake would wait behind unsent data.
Verdict = SendPing | Close | EndCause
PING: Final = SendPing()


class KeepAlive:
    """The times of one open connection. `check` is called every now and then."""

    def __init__(self, limits: Limits, now_s: float) -> None:
        self._limits = limits
        self._looked_s = now_s
        self._stuck_s: float | None = None  # the time since which nothing on the way is accepted
        self._acked_bytes = 0
        self._backlog_s: float | None = None
        self._pinged_s = now_s
        self._unanswered_s: float | None = None  # when the oldest ping left that has no answer
        self.round_trip_s: float | None = None  # of the newest ping that was answered

    def ponged(self, now_s: float) -> None:
        """Note that the client has answered."""
        if self._unanswered_s is not None:
            self.round_trip_s = now_s - self._unanswered_s
            self._unanswered_s = None

    def check(self, now_s: float, outbox: Outbox, way: WayOut) -> Verdict | None:
        """Return the action to take."""
        return (
            self._check_link(now_s, way)
            or self._check_backlog(now_s, outbox, way)
            or self._check_ping(now_s, way)
        )

    def _check_link(self, now_s: float, way: WayOut) -> EndCause | None:
        if now_s - self._looked_s < LOOK_S:
            return None
        self._looked_s = now_s
        reading = way.read()
        acked_bytes, self._acked_bytes = self._acked_bytes, reading.acked_bytes
        if reading.unanswered_s > DEAD_LINK_S:
            return EndCause("network", "lost", f"nothing acknowledged for {DEAD_LINK_S:g} s")
        if not reading.on_the_way_bytes:
            self._stuck_s = None
        elif self._stuck_s is None or reading.acked_bytes > acked_bytes:
            self._stuck_s = now_s
        elif now_s - self._stuck_s > self._limits.send_deadline_s:
            text = f"it accepted nothing for {self._limits.send_deadline_s:g} s"
            return EndCause("gateway", "send_timeout", text)
        return None

    def _check_backlog(self, now_s: float, outbox: Outbox, way: WayOut) -> Close | None:
        if outbox.overflowed:
            return Close(SLOW_CONSUMER, "slow consumer: answers alone exceed the send queue")
        if not way.is_paused or outbox.excess <= outbox.max_bytes // 2:
            # If the socket accepts bytes, the queue waits for us, such as for an encoder.
            self._backlog_s = None
        elif self._backlog_s is None:
            self._backlog_s = now_s
        elif now_s - self._backlog_s > self._limits.slow_consumer_s:
            return Close(
                SLOW_CONSUMER,
                f"slow consumer: over half of {outbox.max_bytes} bytes waiting"
                f" for {self._limits.slow_consumer_s:g} s",
            )
        return None

    def _check_ping(self, now_s: float, way: WayOut) -> SendPing | None:
        if way.is_paused or now_s - self._pinged_s < self._limits.ping_interval_s:
            return None
        self._pinged_s = now_s
        if self._unanswered_s is None:
            self._unanswered_s = now_s
        return PING

# SPDX-License-Identifier: Apache-2.0
"""Judgement of an open client by time: is it there, does it take what it is sent, and fast enough?

The library's own keep-alive misses a client that is frozen while it is being streamed to.
"""

from dataclasses import dataclass
from typing import Final

from gateway.config.limits import Limits
from gateway.protocol.outbox import Outbox
from gateway.server.close_codes import HEARTBEAT_TIMEOUT, SLOW_CONSUMER


@dataclass(frozen=True, slots=True)
class Sending:
    """The way out of a connection, as it is now."""

    outbox: Outbox
    taken_bytes: int | None  # while socket or link are full: grows as the client takes something


@dataclass(frozen=True, slots=True)
class SendPing:
    """A verdict: ask the client whether it is there."""


@dataclass(frozen=True, slots=True)
class Close:
    """A verdict: close with this code and reason."""

    code: int
    reason: str


@dataclass(frozen=True, slots=True)
class Abort:
    """A verdict: cut off, as a closing handshake would wait behind what is not taken."""

    reason: str


Verdict = SendPing | Close | Abort
PING: Final = SendPing()


class KeepAlive:
    """The times of one open connection; `check` is called every now and then."""

    def __init__(self, limits: Limits, now_s: float) -> None:
        self._limits = limits
        self._heard_s = now_s
        self._pinged_s: float | None = None
        self._progress_s = now_s
        self._taken_bytes = 0
        self._crowded_s: float | None = None

    def heard(self, now_s: float) -> None:
        """Note that the client has sent something."""
        self._heard_s = now_s
        self._pinged_s = None

    def blocked(self, now_s: float) -> None:
        """Note that the socket is full from now on."""
        self._progress_s = now_s

    def check(self, now_s: float, sending: Sending, *, is_read: bool) -> Verdict | None:
        """Return what is to be done with the client; *is_read* is false while we do not read it."""
        return (
            self._check_progress(now_s, sending)
            or self._check_backlog(now_s, sending)
            or self._check_silence(now_s, is_read=is_read)
        )

    def _check_progress(self, now_s: float, sending: Sending) -> Verdict | None:
        if sending.taken_bytes is None:
            self._progress_s = now_s
            return None
        taken_bytes, self._taken_bytes = self._taken_bytes, sending.taken_bytes
        if sending.taken_bytes > taken_bytes:
            self._progress_s = now_s
            if self._pinged_s is not None:
                self._pinged_s = now_s  # our ping is still behind the bytes being taken
        elif now_s - self._progress_s > self._limits.send_deadline_s:
            return Abort(f"took nothing for {self._limits.send_deadline_s:g} s")
        return None

    def _check_backlog(self, now_s: float, sending: Sending) -> Verdict | None:
        outbox = sending.outbox
        if outbox.overflowed:
            return Close(SLOW_CONSUMER, "slow consumer: answers alone exceed the send queue")
        if sending.taken_bytes is None or outbox.excess <= outbox.max_bytes // 2:
            # While the socket takes bytes, the queue waits for us: a picture being encoded, say.
            self._crowded_s = None
        elif self._crowded_s is None:
            self._crowded_s = now_s
        elif now_s - self._crowded_s > self._limits.slow_consumer_s:
            return Close(
                SLOW_CONSUMER,
                f"slow consumer: over half of {outbox.max_bytes} bytes waiting"
                f" for {self._limits.slow_consumer_s:g} s",
            )
        return None

    def _check_silence(self, now_s: float, *, is_read: bool) -> Verdict | None:
        if not is_read:  # a pong could not be read
            self._heard_s, self._pinged_s = now_s, None
        elif self._pinged_s is None:
            if now_s - self._heard_s > self._limits.ping_interval_s:
                self._pinged_s = now_s
                return PING
        elif now_s - self._pinged_s > self._limits.ping_timeout_s:
            return Close(HEARTBEAT_TIMEOUT, f"no pong within {self._limits.ping_timeout_s:g} s")
        return None

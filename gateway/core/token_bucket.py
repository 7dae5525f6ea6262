# SPDX-License-Identifier: Apache-2.0
"""A token bucket: a limit of events per second, with room for bursts."""


class TokenBucket:
    """Allow *per_s* events a second on average and *burst* at once. 0 a second allows all."""

    __slots__ = ("_burst", "_last_ns", "_per_ns", "_tokens")

    def __init__(self, per_s: float, burst: int, now_ns: int) -> None:
        self._per_ns = per_s / 1e9
        self._burst = float(burst)
        self._tokens = float(burst)
        self._last_ns = now_ns

    def allow(self, now_ns: int) -> bool:
        """Take one token if there is one."""
        if not self._per_ns:
            return True
        tokens = self._tokens + (now_ns - self._last_ns) * self._per_ns
        self._last_ns = now_ns
        if tokens < 1:
            self._tokens = tokens
            return False
        self._tokens = min(tokens, self._burst) - 1
        return True

# SPDX-License-Identifier: Apache-2.0
"""Reports of topics that fall silent and are heard again, to the clients that ask for them.

A publisher that is killed stays in the ROS graph for about 20 s, so only the age of the newest
sample shows that it is gone.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from gateway.core.errors import StatusCode
from gateway.core.topics.subscription import Subscription

# A report comes a tick or two late: half of the shortest `stale_after_ms`. A tick takes 1 ms with
# 2,048 subscriptions.
TICK_S: Final = 0.05


@dataclass(slots=True)
class _Watched:
    heard_ns: int  # when the newest sample came that is known of, or the watch began
    is_suspected: bool = False  # it was silent for too long at the last look
    is_stale: bool = False  # and that was reported


class SilenceWatch:
    """Compares times that topics note anyway, at each tick: a sample costs nothing more.

    *heard_ns* returns when the newest sample of a subscription's topic came, 0 if none did. There
    is no tick while nobody asks. Runs on the event loop's thread.
    """

    def __init__(self, heard_ns: Callable[[Subscription], int]) -> None:
        self._heard_ns = heard_ns
        self._watched: dict[Subscription, _Watched] = {}
        self._timer: asyncio.TimerHandle | None = None

    def follow(self, subscription: Subscription) -> None:
        """Begin or end to watch a subscription, as its options say now."""
        if subscription.options.stale_after_ns is None:
            self.forget(subscription)
        elif subscription not in self._watched:
            self._watched[subscription] = _Watched(time.monotonic_ns())
            if self._timer is None:
                self._schedule()

    def forget(self, subscription: Subscription) -> None:
        """Stop watching a subscription. Others are ignored."""
        self._watched.pop(subscription, None)
        if not self._watched and self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _schedule(self) -> None:
        self._timer = asyncio.get_running_loop().call_later(TICK_S, self._tick)

    def _tick(self) -> None:
        self._schedule()
        now_ns = time.monotonic_ns()
        for subscription, watched in list(self._watched.items()):
            self._look(subscription, watched, now_ns)

    def _look(self, subscription: Subscription, watched: _Watched, now_ns: int) -> None:
        newest_ns = self._heard_ns(subscription)
        if newest_ns > watched.heard_ns:
            silent_ns = newest_ns - watched.heard_ns
            was_stale = watched.is_stale
            watched.heard_ns = newest_ns
            watched.is_suspected = watched.is_stale = False
            if was_stale:
                _report(subscription, "fresh", f"messages again, after {silent_ns / 1e9:.1f} s")
            return
        age_ns = now_ns - watched.heard_ns
        if watched.is_stale or age_ns < (subscription.options.stale_after_ns or 0):
            return
        if watched.is_suspected:
            watched.is_stale = True
            _report(subscription, "stale", f"no message for {age_ns / 1e9:.1f} s")
        # Only at the second look: if the event loop has stood still, the samples that came are
        # taken between the two.
        watched.is_suspected = True


def _report(subscription: Subscription, code: StatusCode, text: str) -> None:
    """Send a status whatever `set_level` says, as the client has asked for it."""
    asked = [each for each in subscription.requests.values() if each.stale_after_ms is not None]
    request = asked[-1] if asked else replace(subscription.newest_request, id=None)
    subscription.session.alert(code, f"topic {subscription.topic_name}: {text}", request)

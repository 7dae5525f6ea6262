# SPDX-License-Identifier: Apache-2.0
"""Refusals of a router with access control, which are silent at the side that it refuses.

A second session with the same rights, open for a moment, shows whether the router passes on what
the first one has declared.
"""

import asyncio
import logging
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

import zenoh

from gateway.errors import RosStartError
from gateway.faults import Fault
from gateway.sources.zenoh.inbox import LoopWaker
from gateway.sources.zenoh.publishing import ZenohPublisher
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.subscriptions import ZenohSubscription

# A robot's first sample, and the matching of publishers, take less.
CHECK_S: Final = 10.0
# A token or a subscription takes milliseconds to come back from the router.
BACK_S: Final = 2.0
LOOK_S: Final = 0.02
MAX_TRIED: Final = 64  # subscriptions at once. The others have their turn later
_NODE: Final = "/_ros2_gateway_probe"
_REMEDY: Final = "in the access control of the Zenoh router, allow the gateway to"

_logger = logging.getLogger(__name__)


class Refusals:
    """Looks from time to time. *open_again* opens a session as the first one was opened."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        session: ZenohSession,
        open_again: Callable[[], Any],
        is_listed: Callable[[str], bool],
        subscriptions: Mapping[ZenohSubscription, None],
        publishers: Mapping[ZenohPublisher, None],
    ) -> None:
        self._loop, self._session, self._open_again = loop, session, open_again
        self._is_listed = is_listed
        self._subscriptions, self._publishers = subscriptions, publishers
        self._hides_tokens: bool | None = None  # before the first look
        self._refused: frozenset[str] = frozenset()  # keys
        self._passed: frozenset[str] = frozenset()
        self._logged: frozenset[str] = frozenset()
        self._waker = LoopWaker(loop, self._look_later)
        self._timer = loop.call_later(CHECK_S, self._look)

    def faults(self) -> Iterator[Fault]:
        """Yield the refusals that are known now."""
        if self._hides_tokens:
            text = (
                "the Zenoh router hides the nodes of the robot from the gateway, or those of the"
                f" gateway from the robot: {_REMEDY} declare and watch tokens below @ros2_lv"
            )
            yield Fault("degraded", text)
        if refused := self._refused & self._suspects().keys():
            text = f"the Zenoh router keeps messages of topics from passing ({len(refused)})"
            yield Fault("degraded", f"{text}: {_REMEDY} declare subscriptions, and to hear of them")

    def close(self) -> None:
        """End it. A look that is under way ends soon."""
        self._timer.cancel()
        self._waker.close()

    def _suspects(self) -> dict[str, str]:
        """Return what may be refused, by keys to try: silent subscriptions, and publishers."""
        now_s = time.monotonic()
        silent = {
            each.probe_key: f"subscription to {each.topic}"
            for each in self._subscriptions
            if not each.has_heard and now_s - each.since_s >= CHECK_S and each.matching()
        }
        named = {
            each.key.text: f"publisher of {each.key.name}"
            for each in self._publishers
            if each.has_subscribers
        }
        return silent | named

    def _look(self) -> None:
        suspects = self._suspects()
        self._passed &= suspects.keys()
        names = frozenset(suspects[key] for key in self._refused & suspects.keys())
        for each in sorted(names - self._logged):
            _logger.warning("the access control of the Zenoh router refuses the %s", each)
        self._logged = names
        tried = [key for key in suspects if key not in self._passed][:MAX_TRIED]
        is_due = tried or self._hides_tokens is not False
        if is_due and self._session.is_connected:
            name = "zenoh_refusals"
            threading.Thread(target=self._try, args=(tried,), name=name, daemon=True).start()
        else:
            self._look_later()

    def _look_later(self) -> None:
        self._timer = self._loop.call_later(CHECK_S, self._look)

    def _try(self, keys: list[str]) -> None:  # on its own thread
        try:
            second = ZenohSession(self._open_again(), self._session.domain_id)
        except (RosStartError, zenoh.ZError):  # the router has gone: a fault that is known
            self._waker.wake()
            return
        try:
            node = second.add_node(_NODE)
            publishers = {each: second.zenoh.declare_publisher(each) for each in keys}
            is_listed, refused = False, set(publishers)
            until_s = time.monotonic() + BACK_S
            while (refused or not is_listed) and time.monotonic() < until_s:
                time.sleep(LOOK_S)
                is_listed = self._is_listed(node.text)
                refused = {key for key in refused if not publishers[key].matching_status.matching}
            self._hides_tokens, self._refused = not is_listed, frozenset(refused)
            self._passed |= frozenset(keys) - refused
        finally:
            second.close()
            self._waker.wake()

# SPDX-License-Identifier: Apache-2.0
"""The events of all topics in use, for the clients that watch them."""

import time
from dataclasses import dataclass
from typing import Final

from gateway.core.errors import ProtocolError
from gateway.core.requests import Events
from gateway.core.session import Session
from gateway.core.token_bucket import TokenBucket
from gateway.sources.source import TopicEvent

# A robot that shuts down is some hundred events at once. A topic that flaps must not fill the queue
# of who only watches.
PER_S: Final = 20.0
MAX_AT_ONCE: Final = 256
# Several clients may hear of the same thing, each on its own subscription.
SAME_NS: Final = 1_000_000_000


@dataclass(slots=True)
class _Watcher:
    """One client, which neither sees nor pays for what happens on topics that are hidden."""

    request_id: str | int | None
    bucket: TokenBucket
    skipped: int = 0


class TopicEvents:
    """Sends what happens on each topic to the watchers that may see the topic."""

    def __init__(self) -> None:
        self._watching: dict[Session, _Watcher] = {}
        self._sent: dict[tuple[str, TopicEvent], int] = {}  # when, the oldest first

    def watch(self, session: Session, request: Events) -> None:
        """Begin or end to send the events to a client, and say so."""
        if request.watch:
            bucket = TokenBucket(PER_S, MAX_AT_ONCE, time.monotonic_ns())
            watcher = self._watching.setdefault(session, _Watcher(request.id, bucket))
            watcher.request_id = request.id
        else:
            self._watching.pop(session, None)
        session.answer("events", request.id, watch=request.watch)

    def report(self, topic: str, event: TopicEvent) -> None:
        """Send an event. Those beyond a watcher's rate are counted in the next one that it gets."""
        now_ns = time.monotonic_ns()
        if not self._watching or self._is_repeated(topic, event, now_ns):
            return
        for session, watcher in self._watching.items():
            if not session.sees(topic):
                continue
            if not watcher.bucket.allow(now_ns):
                watcher.skipped += 1
                continue
            more = {"skipped": watcher.skipped} if watcher.skipped else {}
            watcher.skipped = 0
            text = event.for_who(session.sees).text
            session.answer(
                "event", watcher.request_id, topic=topic, code=event.code, msg=text, **more
            )

    def _is_repeated(self, topic: str, event: TopicEvent, now_ns: int) -> bool:
        sent = self._sent
        while sent and now_ns - next(iter(sent.values())) >= SAME_NS:
            del sent[next(iter(sent))]
        is_repeated = (topic, event) in sent
        if not is_repeated and len(sent) < MAX_AT_ONCE:
            sent[topic, event] = now_ns
        return is_repeated

    def leave(self, session: Session) -> None:
        """Send nothing more to a client."""
        self._watching.pop(session, None)


def warning(event: TopicEvent, session: Session) -> ProtocolError:
    """Return an event as the client gets it in a `status`."""
    return ProtocolError(event.code, event.for_who(session.sees).text)

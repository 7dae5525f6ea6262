# SPDX-License-Identifier: Apache-2.0
"""The samples of a turn to many clients: the loop whose length is the number of clients."""

from collections.abc import Sequence
from typing import Final, Protocol

from gateway.core.entries import NOT_READY, Entry, Frame
from gateway.core.topics.subscription import Subscription

# More goes by the queues: no socket has room for it, and what a queue drops is not to be encoded.
MAX_BATCH_BYTES: Final = 64 * 1024


class Shared(Protocol):
    """One sample, or several in a row, as many clients get them."""

    def frame(self) -> Frame:
        """Return the bytes. If they cannot be written at once, the samples go by the queues."""


class Batch:
    """The samples of one turn, which are one write for each client."""

    def __init__(self, entries: Sequence[Entry]) -> None:
        self._entries = entries

    def frame(self) -> Frame:
        """Return the frames in a row, `NOT_READY` if the samples have to go one by one."""
        if sum(entry.size for entry in self._entries) > MAX_BATCH_BYTES:
            return NOT_READY
        frames: list[bytes] = []
        for entry in self._entries:
            frame = entry.frame()
            if not isinstance(frame, bytes):
                return NOT_READY
            frames.append(frame)
        return b"".join(frames)


def write_directly(
    shared: Shared, subscriptions: Sequence[Subscription], count: int = 1
) -> Sequence[Subscription]:
    """Write *count* samples to all who share their frames and can take them now.

    Return the others.

    It does the same as `Subscription.offer` without a throttle, if nothing that is ready waits and
    the link has room. It saves the calls and looks at few objects of a client, because finding
    these in memory is the cost of a further client.
    """
    others: list[Subscription] = []
    frames: bytes | None = None
    size = 0
    for subscription in subscriptions:
        session = subscription.session
        outbox = session.outbox
        socket = outbox.socket
        queue = subscription.queue
        if (
            socket is None
            or outbox.may_have_ready
            or queue.size
            or socket.room_bytes <= 0
            or not subscription.is_direct
            or session.reads_ascii_only
            or count > queue.depth  # there newer ones take the place of older ones
        ):
            others.append(subscription)
            continue
        try:
            if frames is None:
                made = shared.frame()
                if not isinstance(made, bytes):  # a worker encodes it, it is large, or cannot be
                    return subscriptions
                frames, size = made, len(made)
            if socket.room_bytes < size:
                socket.look()
            if socket.room_bytes < size:
                others.append(subscription)
                continue
            write = socket.write  # `socket.write(frames)` would look for a method first
            write(frames)
        except Exception:  # noqa: BLE001  # its connection will meet it, too, and ends by it
            others.append(subscription)
            continue
        socket.room_bytes -= size  # not as it was before: to write may have filled the socket
        subscription.offered += count
        queue.sent += count
        queue.sent_bytes += size
    return others

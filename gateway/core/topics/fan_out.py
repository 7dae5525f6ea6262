# SPDX-License-Identifier: Apache-2.0
"""One sample to many clients: the loop whose length is the number of clients."""

from collections.abc import Sequence

from gateway.core.entries import Entry
from gateway.core.topics.subscription import Subscription


def write_directly(entry: Entry, subscriptions: Sequence[Subscription]) -> Sequence[Subscription]:
    """Write a sample to all who share its frame and can take it now. Return the others.

    It does the same as `Subscription.offer` without a throttle, if nothing waits and the link has
    room. It saves the calls and looks at few objects of a client, because finding these in memory
    is the cost of a further client.
    """
    others: list[Subscription] = []
    frame: bytes | None = None
    size = 0
    for subscription in subscriptions:
        session = subscription.session
        outbox = session.outbox
        socket = outbox.socket
        if (
            socket is None
            or outbox.size
            or socket.room_bytes <= 0
            or not subscription.is_direct
            or session.reads_ascii_only
        ):
            others.append(subscription)
            continue
        try:
            if frame is None:
                made = entry.frame()
                if not isinstance(made, bytes):  # a worker encodes it, it is large, or cannot be
                    return subscriptions
                frame, size = made, len(made)
            if socket.room_bytes < size:
                others.append(subscription)
                continue
            write = socket.write  # `socket.write(frame)` would look for a method first
            write(frame)
        except Exception:  # noqa: BLE001  # its connection will meet it, too, and ends by it
            others.append(subscription)
            continue
        socket.room_bytes -= size  # not as it was before: to write may have filled the socket
        subscription.offered += 1
        queue = subscription.queue
        queue.sent += 1
        queue.sent_bytes += size
    return others

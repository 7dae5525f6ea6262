# SPDX-License-Identifier: Apache-2.0
"""One sample to many clients: the loop whose length is the number of clients."""

from collections.abc import Sequence

from gateway.protocol.outbox import Entry
from gateway.router.topics.subscription import Subscription


def write_at_once(entry: Entry, subscriptions: Sequence[Subscription]) -> Sequence[Subscription]:
    """Write a sample to all who share its frame and have nothing waiting; return the others.

    It does what `Subscription.offer` and all below it do, without their calls, and looks at few of
    the objects of a client: to find these in memory is what a further one costs.
    """
    others: list[Subscription] = []
    frame: bytes | None = None
    size = 0
    for subscription in subscriptions:
        outbox = subscription.outbox
        paced = outbox.paced
        if (
            paced is None
            or outbox.size
            or paced.room_bytes <= 0
            or not subscription.is_plain
            or subscription.session.is_ros_sharp
        ):
            others.append(subscription)
            continue
        try:
            if frame is None:
                made = entry.frame()
                if not isinstance(made, bytes):  # a worker encodes it, it is large, or cannot be
                    return subscriptions
                frame, size = made, len(made)
            room_bytes = paced.room_bytes - size
            if room_bytes < 0:
                others.append(subscription)
                continue
            write = paced.write  # a call of an attribute that is no method takes twice as long
            write(frame)
        except Exception:  # noqa: BLE001  # its connection will meet it, too, and ends by it
            others.append(subscription)
            continue
        paced.room_bytes = room_bytes
        subscription.offered += 1
        queue = subscription.queue
        queue.sent += 1
        queue.sent_bytes += size
    return others

# SPDX-License-Identifier: Apache-2.0
"""Translation of the quality of service in clients' requests to that of ROS."""

from dataclasses import replace
from typing import Final

from gateway.codec.types import MessageType
from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.core.requests import Advertise
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.sources.source import BRIEF_LIFESPAN_NS, MAX_TAKES_PER_TURN, Qos

# The depth of a publisher of messages that may be large, such as pictures of 10 MB: DDS does not
# free their memory before the publisher ends.
LARGE_DEPTH: Final = 10


def subscribed(options: SubscriptionOptions, message_type: MessageType) -> Qos:
    """Return the request of a subscription.

    If the depth is left open, DDS keeps so many small messages that a burst is complete. Large ones
    would fill the memory, and they should make room for newer ones.
    """
    asked = options.qos
    if asked.depth is not None:
        return asked
    depth: int | None = MAX_QUEUE_DEPTH
    if message_type.may_be_large:
        wanted = min(options.queue_length or 0, MAX_QUEUE_DEPTH)
        depth = wanted if wanted > MAX_TAKES_PER_TURN else None
    return replace(asked, depth=depth)


def offered(request: Advertise, message_type: MessageType) -> Qos:
    """Return the offer of a publisher: `qos` if given, else one from latch and queue_size."""
    asked = request.qos or Qos()
    if request.latch:
        # a latched topic of ROS 1: the last message, for all later subscribers
        durability = asked.durability or "transient_local"
        return replace(asked, durability=durability, depth=asked.depth or 1)
    usual = LARGE_DEPTH if message_type.may_be_large else None
    asked = replace(asked, depth=asked.depth or request.queue_size or usual)
    lifespan_ns = asked.lifespan_ns or BRIEF_LIFESPAN_NS
    if asked.durability is None and lifespan_ns <= BRIEF_LIFESPAN_NS:
        # Subscribers that ask for transient local also match it, and nothing old reaches them.
        return replace(asked, durability="transient_local", lifespan_ns=lifespan_ns)
    return asked

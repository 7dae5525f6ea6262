# SPDX-License-Identifier: Apache-2.0
"""One feed by itself."""

from unittest.mock import Mock

import pytest

from gateway.codec.errors import CodecError
from gateway.ports import Qos, Sample
from gateway.router.topics.encoding import RenditionKey
from gateway.router.topics.latch import Latch
from gateway.router.topics.topic import Feed, FeedKey


class BrokenLatch(Latch):
    def newest(self, count: int) -> list[tuple[int, Sample]]:
        raise CodecError("it cannot be told")


def test_a_stream_that_cannot_get_what_is_latched_is_not_fed():
    feed = Feed(FeedKey("/map", "std_msgs/msg/String", Qos()), Mock(), BrokenLatch())
    with pytest.raises(CodecError):
        feed.join(Mock(), RenditionKey("/map", None, None), replay=True)
    assert feed.is_idle

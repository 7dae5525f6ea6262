# SPDX-License-Identifier: Apache-2.0
"""The time of sending goes into every sample, and comes out of both receivers' messages."""

import json

import pytest
from rclpy.serialization import deserialize_message

from benchmarks.samples import SAMPLES, message_type
from gateway.codec import cbor
from gateway.codec.image import ImageOptions
from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

NOW_NS = 1_795_280_256_507_552_000  # whole microseconds: a Twist carries no more

TYPES = Types(InstalledDefinitions())


def frame(name: str, cdr: bytes) -> bytes:
    codec = TYPES.get(message_type(name))
    if SAMPLES[name].compression == "cbor-raw":
        return cbor.dumps({"secs": 1, "nsecs": 2, "bytes": cdr})
    if message_type(name) == "sensor_msgs/msg/Image":
        return picture_renderer(codec, ImageOptions())(cdr).json()
    return dumps(codec.decode(cdr))


@pytest.mark.parametrize("name", SAMPLES)
def test_the_time_of_sending_is_read_from_messages_and_from_frames(name):
    sample = SAMPLES[name]
    cdr = sample.cdr()
    sample.clockwork.write(cdr, NOW_NS)
    message = deserialize_message(bytes(cdr), type(sample.make()))
    assert sample.clockwork.read(message) == NOW_NS
    compact = frame(name, bytes(cdr))
    texts = [compact]
    if compact.startswith(b"{"):
        texts.append(json.dumps(json.loads(compact)).encode())  # as Python spaces it
    for text in texts:
        found = sample.clockwork.pattern.search(text)
        assert found is not None
        assert sample.clockwork.parse(found) == NOW_NS

# SPDX-License-Identifier: Apache-2.0
"""The time of sending goes into every sample, and comes out of both receivers' messages."""

import pytest
from rclpy.serialization import deserialize_message

from benchmarks.samples import SAMPLES
from gateway.codec.image import ImageOptions
from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

NOW_NS = 1_795_280_256_507_552_000  # whole microseconds: a Twist carries no more

TYPES = Types(InstalledDefinitions())


def frame(name: str, cdr: bytes) -> bytes:
    message_class = type(SAMPLES[name].make())
    message_type = TYPES.get(
        f"{message_class.__module__.split('.')[0]}/msg/{message_class.__name__}"
    )
    if message_class.__name__ == "Image":
        return picture_renderer(message_type, ImageOptions())(cdr)
    return dumps(message_type.decode(cdr))


@pytest.mark.parametrize("name", SAMPLES)
def test_the_time_of_sending_is_read_from_messages_and_from_frames(name):
    sample = SAMPLES[name]
    cdr = sample.cdr()
    sample.clockwork.write(cdr, NOW_NS)
    message = deserialize_message(bytes(cdr), type(sample.make()))
    assert sample.clockwork.read(message) == NOW_NS
    found = sample.clockwork.pattern.search(frame(name, bytes(cdr)))
    assert found is not None
    assert sample.clockwork.parse(found) == NOW_NS

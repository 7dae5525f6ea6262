# SPDX-License-Identifier: Apache-2.0
"""The robot's topics are those of a robot, and the times of sending are found at all clients."""

import pytest
from rclpy.serialization import serialize_message

from benchmarks.robot import AGED, CAMERAS, LATCHED, ODOMETRY, PICTURE_OPTIONS, ROBOT, clockwork
from benchmarks.samples import HEADER
from gateway.codec.image import ImageOptions
from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

NOW_NS = 1_795_280_256_507_552_123

TYPES = Types(InstalledDefinitions())


def stamped(name):
    cdr = bytearray(serialize_message(ROBOT[name].make()))
    HEADER.write(cdr, NOW_NS)
    return bytes(cdr)


def test_it_has_20_topics_with_cameras_and_what_is_latched():
    assert len(ROBOT) == 20
    assert set(AGED) <= set(ROBOT)
    assert {"map", "tf_static"} <= {n for n, one in ROBOT.items() if one.rate_hz == LATCHED}


def test_the_gateway_reads_each_message():
    for topic in ROBOT.values():
        codec = TYPES.get(topic.type_name())
        assert codec.decode(bytes(serialize_message(topic.make())))


@pytest.mark.parametrize("options", PICTURE_OPTIONS)
def test_the_time_of_sending_is_found_in_pictures_and_in_odometry(options):
    odometry, images = (TYPES.get(ROBOT[name].type_name()) for name in (ODOMETRY, CAMERAS[0]))
    is_cbor = "compression" in PICTURE_OPTIONS[options]
    render = picture_renderer(images, ImageOptions())
    frames = {
        ODOMETRY: dumps(odometry.decode(stamped(ODOMETRY))),
    }
    for name in CAMERAS:
        picture = render(stamped(name))
        frames[name] = picture.cbor() if is_cbor else picture.json()
    for name, frame in frames.items():
        one = clockwork(options, name)
        found = one.pattern.search(frame)
        assert found is not None
        assert one.parse(found) == NOW_NS

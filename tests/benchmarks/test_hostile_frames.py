# SPDX-License-Identifier: Apache-2.0
"""The frames are what a client may send: the gateway reads them, and most reach ROS."""

import pytest

from benchmarks.bombs import Bomb, bombs
from benchmarks.hostile_frames import plain_frames
from gateway.codec import cbor_reader
from gateway.codec.cdr.misfits import TooManyFieldsError
from gateway.codec.error_text import JsonError
from gateway.codec.json import loads
from gateway.codec.types import Types
from gateway.config.limits import Limits
from schemas.installed import InstalledDefinitions

DEFINITIONS = InstalledDefinitions()
MARKERS = "visualization_msgs/msg/MarkerArray"


@pytest.fixture(scope="module")
def types():
    return Types(DEFINITIONS)


def of_markers() -> list[Bomb]:
    return [bomb for bomb in bombs(DEFINITIONS) if bomb.type_name == MARKERS]


def test_the_search_looks_at_every_type_with_messages_in_an_array():
    found = {bomb.type_name for bomb in bombs(DEFINITIONS)}
    assert {MARKERS, "nav_msgs/msg/Path", "trajectory_msgs/msg/JointTrajectory"} <= found
    assert "geometry_msgs/msg/Twist" not in found
    templates = {bomb.template for bomb in of_markers()}
    assert '{"markers":[@]}' in templates
    assert '{"markers":[{"points":[@]}]}' in templates


def test_the_smaller_frame_is_the_most_that_is_encoded(types):
    encode = types.get(MARKERS).encode
    for bomb in of_markers():
        for count in bomb.counts():
            value = loads(bomb.frame(count).data)["msg"]
            if count > min(bomb.counts()):
                with pytest.raises(TooManyFieldsError):
                    encode(value, 0)
            else:
                assert encode(value, 0)


def test_no_frame_is_longer_than_a_client_may_send():
    for frame in plain_frames():
        assert len(frame.data) <= Limits().max_message_bytes
        try:
            (cbor_reader.loads if frame.name.startswith("CBOR") else loads)(frame.data)
        except JsonError:
            refused = {"unfinished arrays", "a duplicate among many", "too wide"}
            refused |= {f"nothing but {marks}" for marks in ("backslashes", "quotes", "colons")}
            is_meant = frame.name in refused or frame.name.endswith("then a mistake")
            assert is_meant

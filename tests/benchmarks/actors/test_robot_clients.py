# SPDX-License-Identifier: Apache-2.0
"""Messages count for the topic that they are of, and a client is complete when it has all."""

import json

import pytest
from rclpy.serialization import serialize_message

from benchmarks.actors.robot_clients import RobotMessages
from benchmarks.robot import ODOMETRY, ROBOT
from benchmarks.samples import HEADER, topic
from gateway.codec import cbor
from gateway.codec.json import dumps
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

NOW_NS = 1_795_280_256_507_552_123

TYPES = Types(InstalledDefinitions())


def publish(name, message):
    return {"op": "publish", "topic": topic(name), "msg": message}


def write_compact(frame):
    return json.dumps(frame, separators=(",", ":")).encode()


def write_with_spaces(frame):
    return json.dumps(frame).encode()


@pytest.mark.parametrize("write", [write_compact, write_with_spaces, cbor.dumps])
def test_a_message_counts_for_its_topic_and_a_status_for_none(write):
    messages = RobotMessages("default")
    for count, name in enumerate(ROBOT, 1):
        messages.note(1, write(publish(name, {"data": "x"})), NOW_NS)
        assert messages.count()[name] == 1
        assert sum(messages.count().values()) == count
    status = {"op": "status", "level": "warning", "msg": f"topic {topic('scan')}: publishes much"}
    messages.note(1, write(status), NOW_NS)
    assert sum(messages.count().values()) == len(ROBOT)


def test_a_client_is_complete_when_it_has_a_message_of_every_topic():
    messages = RobotMessages("default")
    first, *others = ROBOT
    for client in (1, 2):
        for name in others:
            messages.note(client, write_compact(publish(name, {})), NOW_NS)
    assert messages.complete() == 0
    messages.note(2, write_compact(publish(first, {})), NOW_NS)
    assert messages.complete() == 1
    messages.clear()
    assert messages.complete() == 1
    assert not any(messages.count().values())


def test_the_age_of_odometry_is_recorded_by_each_client():
    decode = TYPES.get(ROBOT[ODOMETRY].type_name()).decode
    cdr = bytearray(serialize_message(ROBOT[ODOMETRY].make()))
    HEADER.write(cdr, NOW_NS)
    message = decode(bytes(cdr))
    messages = RobotMessages("cbor")
    for client in (1, 2):
        frame = b'{"op":"publish","topic":"%s","msg":%s}' % (
            topic(ODOMETRY).encode(),
            dumps(message),
        )
        messages.note(client, frame, NOW_NS + 2_000_000)
    report = messages.report()
    assert report[ODOMETRY]["count"] == 2
    assert report[ODOMETRY]["p50_ms"] == 2

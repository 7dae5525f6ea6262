# SPDX-License-Identifier: Apache-2.0
"""Examples are real: each is encoded, and a client may paste it."""

import json

import pytest

from gateway.codec.types import Types
from gateway.core.introspection.examples import MAX_CHARACTERS, example
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.core.conftest import Bench

DEFINITIONS = InstalledDefinitions()
TYPES = Types(DEFINITIONS)


@pytest.mark.parametrize("row", Table.load().rows, ids=lambda row: row.name)
async def test_the_example_of_each_row_of_the_table_is_published_as_it_is(bench: Bench, row):
    client = bench.client()
    heard = []
    bench.ros.add_subscription(f"/example/{row.name}", row.name, heard.extend)
    client.send(op="describe", type=row.number)
    (described,) = client.frames
    client.send(**described["example"])
    assert client.frames == [described]
    await bench.settle()
    assert len(heard) == 1


async def test_the_examples_of_two_types_are_accepted_one_after_the_other(bench: Bench):
    client = bench.client()
    for type_name in ("std_msgs/String", "geometry_msgs/Twist", "std_msgs/String"):
        client.send(op="describe", type=type_name)
        client.send(**client.frames[-1]["example"])
    assert [frame["op"] for frame in client.frames] == ["describe"] * 3


def test_the_example_of_each_installed_message_is_encoded_and_short():
    names = DEFINITIONS.names()
    assert len(names) > 150
    for name in names:
        message_type = TYPES.get(name)
        values = example(message_type.definition, DEFINITIONS)
        message_type.encode(json.loads(json.dumps(values)), now_ns=0)
        assert len(json.dumps(values, separators=(",", ":"))) <= MAX_CHARACTERS


@pytest.mark.parametrize("kind", ["srv", "action"])
def test_the_example_of_each_request_and_goal_is_encoded(kind):
    for name in DEFINITIONS.names(kind=kind):
        found = TYPES.service(name).request if kind == "srv" else TYPES.action(name).goal
        found.encode(example(found.definition, DEFINITIONS), now_ns=0, root="args")


def test_an_example_shows_the_fields_and_leaves_out_what_is_long():
    assert example(DEFINITIONS.get("geometry_msgs/msg/PoseWithCovarianceStamped"), DEFINITIONS) == {
        "header": {"stamp": "now", "frame_id": ""},
        "pose": {
            "pose": {
                "position": {"x": 0.0, "y": 0.0, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            }
        },
    }
    imu = example(DEFINITIONS.get("sensor_msgs/msg/Imu"), DEFINITIONS)
    assert imu["orientation_covariance"] == [0.0] * 9
    assert example(DEFINITIONS.get("test_msgs/msg/Arrays"), DEFINITIONS) == {}

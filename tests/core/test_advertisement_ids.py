# SPDX-License-Identifier: Apache-2.0
"""Programs that advertise a topic again and again, by a new id each time."""

import pytest

from tests.core.conftest import Bench


@pytest.mark.parametrize(
    ("topic", "type_name"), [("/chatter", "std_msgs/String"), ("/cmd_vel", "geometry_msgs/Twist")]
)
async def test_the_newest_1024_ids_of_an_advertisement_are_remembered(
    bench: Bench, topic: str, type_name: str
):
    client = bench.client()
    for number in range(1026):
        client.send(op="advertise", id=f"a{number}", topic=topic, type=type_name)
    client.send(op="unadvertise", id="a1", topic=topic)
    (status,) = client.of("status")
    assert "not advertised" in status["msg"]
    for number in range(2, 1025):
        client.send(op="unadvertise", id=f"a{number}", topic=topic)
    assert len(bench.ros.publishers) == 1
    client.send(op="unadvertise", id="a1025", topic=topic)
    await bench.settle()
    assert len(bench.ros.publishers) == 0
    assert len(client.of("status")) == 1

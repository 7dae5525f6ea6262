# SPDX-License-Identifier: Apache-2.0
"""Topics, both ways."""

import pytest
from geometry_msgs.msg import Twist, Vector3
from std_msgs.msg import String

from tests.client import eventually
from tests.clients.driver import Connection
from tests.clients.robot import LATCHED, Robot

STRING = "std_msgs/String"

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def test_messages_of_a_robot_reach_a_client(client: Connection, robot: Robot):
    topic = client.own("out")
    robot.publish(topic, String(data="grüße"))
    await client.subscribe(topic, STRING)
    assert await client.next("message", topic) == {"data": "grüße"}


async def test_messages_of_a_client_reach_a_robot(client: Connection, robot: Robot):
    topic = client.own("in")
    heard = robot.hear(Twist, topic)
    await client.is_awaited(topic)
    message = {"linear": {"x": 0.26}, "angular": {"z": -1.82}}
    await client.publish(topic, "geometry_msgs/Twist", message)
    await eventually(lambda: bool(heard))
    assert heard == [Twist(linear=Vector3(x=0.26), angular=Vector3(z=-1.82))]


async def test_a_topic_comes_back_as_the_client_spells_it(client: Connection, robot: Robot):
    topic = client.own("out")
    relative = topic.removeprefix("/")
    robot.publish(topic, String(data="here"))
    await client.subscribe(relative, STRING)
    assert await client.next("message", relative) == {"data": "here"}


async def test_unsubscribing_ends_the_subscription_in_ros(client: Connection, robot: Robot):
    topic = client.own("out")
    robot.publish(topic, String(data="once"))
    await client.subscribe(topic, STRING)
    await client.next("message", topic)
    await eventually(lambda: robot.node.count_subscribers(topic) == 1)
    await client.do("unsubscribe", topic=topic)
    await eventually(lambda: robot.node.count_subscribers(topic) == 0)


async def test_a_latched_message_reaches_a_robot_that_comes_later(client: Connection, robot: Robot):
    topic = client.own("latched")
    await client.publish(topic, STRING, {"data": "map"}, latch=True)
    await eventually(lambda: robot.knows_topic(topic))
    heard = robot.hear(String, topic, LATCHED)
    await eventually(lambda: heard == [String(data="map")])


async def test_a_topic_is_gone_from_the_graph_after_unadvertise(client: Connection, robot: Robot):
    topic = client.own("in")
    await client.do("advertise", topic=topic, type_name=STRING)
    await eventually(lambda: robot.knows_topic(topic))
    await client.do("unadvertise", topic=topic)
    await eventually(lambda: not robot.knows_topic(topic))


async def test_a_throttled_topic_delivers_its_newest_message(client: Connection, robot: Robot):
    topic = client.own("fast")
    await client.subscribe(topic, STRING, throttle_rate=50)
    robot.publish(topic, *(String(data=str(number)) for number in range(10)))
    while await client.next("message", topic) != {"data": "9"}:
        pass

# SPDX-License-Identifier: Apache-2.0
"""The questions that the libraries ask about the graph, the types and the time."""

import time

import pytest
from sensor_msgs.msg import BatteryState
from std_msgs.msg import String
from std_srvs.srv import SetBool

from tests.client import TIMEOUT_S
from tests.clients.driver import (
    ROSLIB_1,
    ROSLIB_2,
    ROSLIBPY_1,
    ROSLIBPY_2,
    ROSLIBPY_2_ASYNCIO,
    Connection,
)
from tests.clients.robot import Robot, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

in_javascript = pytest.mark.parametrize("library", [ROSLIB_1, ROSLIB_2], ids=str, indirect=True)
in_python = pytest.mark.parametrize(
    "library", [ROSLIBPY_1, ROSLIBPY_2, ROSLIBPY_2_ASYNCIO], ids=str, indirect=True
)


async def test_a_topic_is_listed_with_its_type(client: Connection, robot: Robot):
    topic = client.own("battery")
    robot.publish(topic, BatteryState())

    async def is_listed() -> bool:
        found = await client.ask("get_topics")
        if not client.library.is_javascript:
            return topic in found
        types = dict(zip(found["topics"], found["types"], strict=True))
        return types.get(topic) == "sensor_msgs/msg/BatteryState"

    await until(is_listed)
    assert await client.ask("get_topic_type", topic) == "sensor_msgs/msg/BatteryState"


async def test_a_topic_is_listed_once_its_client_has_advertised_it(client: Connection):
    topic = client.own("in")
    await client.do("advertise", topic=topic, type_name="std_msgs/String")
    found = await client.ask("get_topics")
    assert topic in (found["topics"] if client.library.is_javascript else found)


@pytest.mark.parametrize("type_name", ["sensor_msgs/BatteryState", "sensor_msgs/msg/BatteryState"])
async def test_topics_are_found_by_their_type(client: Connection, robot: Robot, type_name: str):
    topic = client.own("battery")
    robot.publish(topic, BatteryState())

    async def is_found() -> bool:
        return topic in await client.ask("get_topics_for_type", type_name)

    await until(is_found)


async def test_a_topic_that_is_not_there_has_no_type(client: Connection):
    assert await client.ask("get_topic_type", client.own("nowhere")) == ""


async def test_a_service_is_listed_with_its_type(client: Connection, robot: Robot):
    service = client.own("switch")
    robot.serve(SetBool, service, lambda _, response: response)

    async def is_listed() -> bool:
        return service in await client.ask("get_services")

    await until(is_listed)
    assert await client.ask("get_service_type", service) == "std_srvs/srv/SetBool"
    assert service in await client.ask("get_services_for_type", "std_srvs/srv/SetBool")


async def test_an_action_is_listed(client: Connection, robot: Robot):
    action = client.own("fibonacci")
    robot.provide_fibonacci(action)

    async def is_listed() -> bool:
        return action in await client.ask("get_action_servers")

    await until(is_listed)


async def test_a_node_is_listed_with_what_it_does(client: Connection, robot: Robot):
    spoken, heard, service = client.own("out"), client.own("in"), client.own("switch")
    robot.publish(spoken, String())
    robot.hear(String, heard)
    robot.serve(SetBool, service, lambda _, response: response)

    async def is_known() -> bool:
        found = await client.ask("get_node_details", "/robot")
        return (
            spoken in found["publishing"]
            and heard in found["subscribing"]
            and service in found["services"]
        )

    await until(is_known)
    assert "/robot" in await client.ask("get_nodes")


async def test_a_message_is_described(client: Connection):
    details = await client.ask("get_message_details", "geometry_msgs/TwistStamped")
    typedefs = details if client.library.is_javascript else details["typedefs"]
    assert typedefs[0]["type"].endswith("TwistStamped")
    assert typedefs[0]["fieldnames"] == ["header", "twist"]
    assert typedefs[0]["fieldarraylen"] == [-1, -1]


@in_javascript
async def test_a_description_decodes_to_the_nesting_of_the_message(client: Connection):
    typedefs = await client.ask("get_message_details", "geometry_msgs/TwistStamped")
    vector = {"x": "double", "y": "double", "z": "double"}
    assert await client.do("decode_type_defs", typedefs=typedefs) == {
        "header": {"stamp": {"sec": "int32", "nanosec": "uint32"}, "frame_id": "string"},
        "twist": {"linear": vector, "angular": vector},
    }


async def test_a_service_is_described(client: Connection):
    request = await client.ask("get_service_request_details", "std_srvs/SetBool")
    assert request["typedefs"][0]["fieldnames"] == ["data"]
    response = await client.ask("get_service_response_details", "std_srvs/SetBool")
    assert response["typedefs"][0]["fieldnames"] == ["success", "message"]


@in_javascript
async def test_topics_are_listed_with_the_text_of_their_types(client: Connection, robot: Robot):
    topic = client.own("out")
    robot.publish(topic, String())

    async def is_listed() -> bool:
        found = await client.ask("get_topics_and_raw_types")
        texts = dict(zip(found["topics"], found["typedefs_full_text"], strict=True))
        return "string data" in texts.get(topic, "")

    await until(is_listed)


@pytest.mark.parametrize("library", [ROSLIB_2], ids=str, indirect=True)
async def test_a_topic_names_its_publishers(client: Connection, robot: Robot):
    topic = client.own("out")
    robot.publish(topic, String())

    async def is_named() -> bool:
        found = await client.do("publishers", topic=topic, type_name="std_msgs/String")
        return bool(found == ["/robot"])

    await until(is_named)


@in_python
async def test_the_time_is_that_of_ros(client: Connection):
    found = await client.ask("get_time")
    assert found["secs"] == pytest.approx(time.time(), abs=TIMEOUT_S)


async def test_the_version_of_ros_is_told(client: Connection):
    answer = await client.call("/rosapi/get_ros_version", "rosapi/GetROSVersion", {})
    assert answer == {"version": 2, "distro": "jazzy"}

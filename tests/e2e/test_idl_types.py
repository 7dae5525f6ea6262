# SPDX-License-Identifier: Apache-2.0
"""Types whose package has `.idl` files alone, through real DDS and a gateway's process."""

from collections.abc import AsyncIterator, Iterator
from typing import Any

import pytest
import pytest_asyncio
from rclpy.action import ActionServer, GoalResponse

from schemas.installed import InstalledDefinitions
from tests import interfaces
from tests.client import Client, Frame, client, eventually
from tests.e2e.both_ways import BothWays
from tests.e2e.discovery import until_discovered
from tests.gateway_process import gateway_process
from tests.messages import ros_class
from tests.sources.outside import Outside
from tests.sources.outside_services import until_known

DEFINITIONS = InstalledDefinitions()
TRACK = "idl_msgs/msg/Track"
MEASURE = "idl_msgs/srv/Measure"
SWEEP = "idl_msgs/action/Sweep"

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.skipif(not DEFINITIONS.names(["idl_msgs"]), reason=interfaces.HOW),
]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def speaker() -> AsyncIterator[Client]:
    async with gateway_process("serve") as gateway, client(gateway.url) as speaker:
        yield speaker


@pytest.fixture(scope="module")
def outside() -> Iterator[Outside]:
    outside = Outside("robot")
    yield outside
    outside.close()


async def answer(speaker: Client, op: str) -> Frame:
    return await speaker.receive(lambda frame: frame["op"] == op)


@pytest.mark.parametrize("seed", range(2))
async def test_messages_of_a_robot_reach_a_client(seed: int, speaker: Client, outside: Outside):
    await BothWays(TRACK, speaker, outside).to_a_client(seed)


@pytest.mark.parametrize("seed", range(2))
async def test_messages_of_a_client_reach_a_robot(seed: int, speaker: Client, outside: Outside):
    await BothWays(TRACK, speaker, outside).to_a_robot(seed)


async def test_a_field_that_a_client_leaves_out_takes_the_default_of_the_file(
    speaker: Client, outside: Outside
):
    heard: list[Any] = []
    topic = "/in/defaults"
    subscription = outside.node.create_subscription(ros_class(TRACK), topic, heard.append, 10)
    await until_discovered(speaker, "subscribers", topic)
    await speaker.send(op="publish", topic=topic, type=TRACK, msg={})
    await eventually(lambda: len(heard) == 1)
    assert heard[0] == ros_class(TRACK)()
    assert (heard[0].kind, list(heard[0].bits)) == ("person", [1, 2, 3])
    await speaker.send(op="unadvertise", topic=topic)
    outside.node.destroy_subscription(subscription)


async def test_a_service_is_called(speaker: Client, outside: Outside):
    def measure(request: Any, response: Any) -> Any:
        until_known(outside.node, "/measure")
        response.area = request.box.width * request.box.height * request.scale
        return response

    service = outside.node.create_service(ros_class(MEASURE), "/measure", measure)
    await until_discovered(speaker, "service_type", "/measure")
    await speaker.send(
        op="call_service",
        service="/measure",
        type=MEASURE,
        args={"box": {"width": 3, "height": 4}},
        timeout=60,
    )
    frame = await answer(speaker, "service_response")
    assert (frame["result"], frame["values"]) == (True, {"area": 24.0})
    outside.node.destroy_service(service)


async def test_an_action_is_executed(speaker: Client, outside: Outside):
    def accept(goal: Any) -> GoalResponse:
        until_known(outside.node, "/sweep/_action/send_goal", "/sweep/_action/get_result")
        return GoalResponse.ACCEPT

    def sweep(goal: Any) -> Any:
        feedback = ros_class(f"{SWEEP}_Feedback")(step=goal.request.steps)
        goal.publish_feedback(feedback)
        goal.succeed()
        return ros_class(f"{SWEEP}_Result")(ranges=[0.5] * goal.request.steps)

    server = ActionServer(outside.node, ros_class(SWEEP), "/sweep", sweep, goal_callback=accept)
    await until_discovered(speaker, "action_type", "/sweep")
    await speaker.send(
        op="send_action_goal",
        id="s",
        action="/sweep",
        action_type=SWEEP,
        args={"steps": 3},
        feedback=True,
    )
    assert (await answer(speaker, "action_feedback"))["values"] == {"step": 3}
    frame = await answer(speaker, "action_result")
    assert (frame["result"], frame["values"]) == (True, {"ranges": [0.5, 0.5, 0.5]})
    server.destroy()


async def test_clients_are_told_the_definition_as_of_a_msg_file(speaker: Client):
    await speaker.send(op="describe", id=1, type=TRACK)
    frame = await answer(speaker, "describe")
    assert frame["type_hash"].startswith("RIHS01_")
    assert "uint8 BY_CAMERA=1\n" in frame["definition"]
    assert "# How fast it is. [m/s]\nfloat64 speed\n" in frame["definition"]
    assert frame["schema"]["properties"]["speed"]["description"] == "How fast it is. [m/s]"
    await speaker.send(op="describe", id=2, type=MEASURE)
    frame = await answer(speaker, "describe")
    assert frame["definition"].count("---\n") == 1
    assert list(frame["schema"]["properties"]) == ["request", "response"]


async def test_rosapi_knows_the_types(speaker: Client):
    await speaker.send(
        op="call_service", service="/rosapi/message_details", args={"type": "idl_msgs/msg/Track"}
    )
    told = (await answer(speaker, "service_response"))["values"]["typedefs"]
    assert [each["type"] for each in told][:2] == ["idl_msgs/Track", "idl_msgs/Nothing"]
    types = dict(zip(told[0]["fieldnames"], told[0]["fieldtypes"], strict=True))
    assert (types["boxes"], types["share"], types["flags"]) == ("idl_msgs/Box", "float", "octet")
    assert dict(zip(told[0]["constnames"], told[0]["constvalues"], strict=True))["NORTH"] == "-12"
    await speaker.send(op="call_service", service="/rosapi/interfaces")
    known = (await answer(speaker, "service_response"))["values"]["interfaces"]
    assert {TRACK, MEASURE, SWEEP} <= set(known)

# SPDX-License-Identifier: Apache-2.0
"""A gateway without the packages that a robot has, which knows their definitions from a folder."""

import asyncio
import contextlib
import shutil
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from rclpy.action import ActionServer, GoalResponse
from rclpy.serialization import deserialize_message

from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests import interfaces
from tests.client import Client, client, eventually
from tests.e2e.both_ways import LATCHED, BothWays, unless_keyed
from tests.e2e.discovery import until_discovered
from tests.gateway_process import gateway_process
from tests.messages import Plain, RandomMessages, ros_class, to_json, to_ros
from tests.sources.outside import Outside
from tests.sources.outside_services import arrived, until_known

DEFINITIONS = InstalledDefinitions()
TRACK = "idl_msgs/msg/Track"
TF = "tf2_msgs/msg/TFMessage"
RECALL = "idl_msgs/srv/Recall"
FOLLOW = "idl_msgs/action/Follow"
RETRY_S = 5  # much longer than an answer takes
PARTS = ("Goal", "Result", "Feedback")
TYPES = Types(DEFINITIONS)
MESSAGES = [pytest.param(TRACK, marks=unless_keyed), TF]
WITHOUT_PACKAGES = ("env", "-u", "PYTHONPATH", "-u", "AMENT_PREFIX_PATH")

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.skipif(not DEFINITIONS.names(["idl_msgs", "tf2_msgs"]), reason=interfaces.HOW),
]


def plain(name: str, seed: int) -> Plain:
    return RandomMessages(DEFINITIONS, seed).message(name)


def real(name: str, values: Plain) -> Any:
    """Return a message of the package."""
    return to_ros(DEFINITIONS.get(name), DEFINITIONS, values)


def as_bytes(name: str, values: Any) -> bytes:
    """Return CDR: a float32 is written as short as it may be."""
    return TYPES.get(name).encode(values, 0)


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def speaker() -> AsyncIterator[Client]:
    folder = ("--set", f"types.paths={interfaces.FOLDER}")
    async with (
        gateway_process("serve", *folder, before=WITHOUT_PACKAGES) as gateway,
        client(gateway.url) as speaker,
    ):
        yield speaker


@pytest.fixture(scope="module")
def outside() -> Iterator[Outside]:
    outside = Outside("robot")
    yield outside
    outside.close()


@pytest.mark.parametrize("name", MESSAGES)
@pytest.mark.parametrize("seed", range(2))
async def test_messages_of_a_robot_reach_a_client(
    seed: int, name: str, speaker: Client, outside: Outside
):
    await BothWays(name, speaker, outside).to_a_client(seed)


@pytest.mark.parametrize("name", MESSAGES)
@pytest.mark.parametrize("seed", range(2))
async def test_messages_of_a_client_reach_a_robot(
    seed: int, name: str, speaker: Client, outside: Outside
):
    await BothWays(name, speaker, outside).to_a_robot(seed)


async def test_transforms_are_heard_without_their_package(outside: Outside):
    transform = {
        "header": {"frame_id": "map"},
        "child_frame_id": "robot",
        "transform": {"translation": {"x": 1.5}, "rotation": {"w": 1.0}},
    }
    publisher = outside.node.create_publisher(ros_class(TF), "/tf_static", LATCHED)
    publisher.publish(Types(DEFINITIONS).get(TF).encode({"transforms": [transform]}, 0))
    async with (
        gateway_process("serve", before=WITHOUT_PACKAGES) as gateway,
        client(gateway.url) as speaker,
    ):
        await speaker.send(
            op="lookup_transform", id=1, target_frame="map", source_frame="robot", timeout=60
        )
        frame = await speaker.receive(lambda frame: frame.get("id") == 1)
        assert frame["transform"]["transform"]["translation"]["x"] == 1.5
    outside.node.destroy_publisher(publisher)


async def test_such_types_are_described(speaker: Client):
    await speaker.send(op="describe", id=1, type=TRACK)
    frame = await speaker.receive(lambda frame: frame.get("id") == 1)
    assert frame["type_hash"] == DEFINITIONS.get(TRACK).type_hash
    assert "float64 speed\n" in frame["definition"]
    for name in (RECALL, FOLLOW):
        await speaker.send(op="describe", id=2, type=name)
        frame = await speaker.receive(lambda frame: frame.get("id") == 2)
        assert frame["type_hash"] == DEFINITIONS.interface(name).type_hash is not None


@pytest.mark.parametrize("seed", range(2))
async def test_a_robot_serves_a_client(seed: int, speaker: Client, outside: Outside):
    args, values = plain(f"{RECALL}_Request", seed), plain(f"{RECALL}_Response", seed)
    heard: list[Any] = []

    def recall(request: Any, _: Any) -> Any:
        until_known(outside.node, "/recall")
        heard.append(request)
        return real(f"{RECALL}_Response", values)

    service = outside.node.create_service(ros_class(RECALL), "/recall", recall)
    await until_discovered(speaker, "service_type", "/recall")
    await speaker.send(op="call_service", service="/recall", args=to_json(args), timeout=60)
    frame = await speaker.receive(lambda frame: frame["op"] == "service_response")
    assert frame["result"], frame
    assert as_bytes(f"{RECALL}_Response", frame["values"]) == as_bytes(
        f"{RECALL}_Response", to_json(values)
    )
    assert heard == [real(f"{RECALL}_Request", args)]
    outside.node.destroy_service(service)


@pytest.mark.parametrize("seed", range(2))
async def test_a_client_serves_a_robot(seed: int, speaker: Client, outside: Outside):
    args, values = plain(f"{RECALL}_Request", seed), plain(f"{RECALL}_Response", seed)
    await speaker.send(op="advertise_service", service="/remember", type=RECALL)
    assert await speaker.sync() == []
    client = outside.node.create_client(ros_class(RECALL), "/remember")
    await eventually(client.service_is_ready)
    await until_discovered(speaker, "service_providers", RECALL)
    request = real(f"{RECALL}_Request", args)
    response = None
    while response is None:  # lost if the gateway has not discovered the client yet
        calling = asyncio.ensure_future(arrived(client.call_async(request)))
        try:
            frame = await speaker.receive(lambda frame: frame["op"] == "call_service", RETRY_S)
        except TimeoutError:  # or if DDS has not matched both yet
            calling.cancel()
            continue
        assert as_bytes(f"{RECALL}_Request", frame["args"]) == as_bytes(
            f"{RECALL}_Request", to_json(args)
        )
        answer = {"service": "/remember", "id": frame["id"], "values": to_json(values)}
        await speaker.send(op="service_response", result=True, **answer)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(RETRY_S):
                response = await calling
    assert response == real(f"{RECALL}_Response", values)
    await speaker.send(op="unadvertise_service", service="/remember")
    outside.node.destroy_client(client)


@pytest.mark.parametrize("seed", range(2))
async def test_a_robot_executes_the_goal_of_a_client(seed: int, speaker: Client, outside: Outside):
    goal, result, feedback = (plain(f"{FOLLOW}_{part}", seed) for part in PARTS)
    heard: list[Any] = []

    def accept(request: Any) -> GoalResponse:
        until_known(outside.node, "/follow/_action/send_goal", "/follow/_action/get_result")
        heard.append(request)
        return GoalResponse.ACCEPT

    def follow(handle: Any) -> Any:
        handle.publish_feedback(real(f"{FOLLOW}_Feedback", feedback))
        handle.succeed()
        return real(f"{FOLLOW}_Result", result)

    server = ActionServer(outside.node, ros_class(FOLLOW), "/follow", follow, goal_callback=accept)
    await until_discovered(speaker, "action_type", "/follow")
    order = {"action": "/follow", "action_type": FOLLOW, "args": to_json(goal)}
    await speaker.send(op="send_action_goal", id="f", feedback=True, **order)
    for op, part, sent in (("feedback", "Feedback", feedback), ("result", "Result", result)):
        frame = await speaker.receive(lambda frame, op=op: frame["op"] == f"action_{op}")
        name = f"{FOLLOW}_{part}"
        assert as_bytes(name, frame["values"]) == as_bytes(name, to_json(sent))
    assert (frame["result"], frame["status"]) == (True, 4)
    assert heard == [real(f"{FOLLOW}_Goal", goal)]
    server.destroy()


@pytest.mark.parametrize("seed", range(2))
async def test_a_client_executes_the_goal_of_a_robot(seed: int, speaker: Client, outside: Outside):
    goal, result, feedback = (plain(f"{FOLLOW}_{part}", seed) for part in PARTS)
    await speaker.send(op="advertise_action", action="/lead", type=FOLLOW)
    assert await speaker.sync() == []
    client = outside.add_action_client("/lead", FOLLOW)
    told: list[bytes] = []
    request = as_bytes(f"{FOLLOW}_Goal", to_json(goal))
    sending = asyncio.ensure_future(client.send_goal(request, told.append))
    frame = await speaker.receive(lambda frame: frame["op"] == "send_action_goal")
    assert as_bytes(f"{FOLLOW}_Goal", frame["args"]) == request
    of_goal = {"action": "/lead", "id": frame["id"]}
    accepted = await sending
    await speaker.send(op="action_feedback", values=to_json(feedback), **of_goal)
    await eventually(lambda: len(told) == 1)
    await speaker.send(op="action_result", values=to_json(result), status=4, result=True, **of_goal)
    ended = await accepted.result()
    assert ended.status == 4
    for name, cdr, sent in (("Feedback", told[0], feedback), ("Result", ended.cdr, result)):
        part = f"{FOLLOW}_{name}"
        assert deserialize_message(cdr, ros_class(part)) == real(part, sent)
    await speaker.send(op="unadvertise_action", action="/lead")
    client.close()


async def test_the_hashes_of_a_service_are_those_of_the_package(speaker: Client, outside: Outside):
    await speaker.send(op="advertise_service", service="/remember", type=RECALL)
    node = outside.node

    def hashes() -> set[str]:
        found = [
            *node.get_subscriptions_info_by_topic("rq/rememberRequest", no_mangle=True),
            *node.get_publishers_info_by_topic("rr/rememberReply", no_mangle=True),
        ]
        return {str(each.topic_type_hash) for each in found}

    parts = DEFINITIONS.interface(RECALL).parts.values()
    await eventually(lambda: hashes() == {part.type_hash for part in parts})
    await speaker.send(op="unadvertise_service", service="/remember")


async def test_a_service_of_an_unknown_type_is_refused_in_words(speaker: Client):
    await speaker.send(op="advertise_service", id=2, service="/measure", type="idl_msgs/srv/None")
    frame = await speaker.receive(lambda frame: frame.get("id") == 2)
    assert (frame["code"], frame["level"]) == ("bad_type", "error")


@pytest.fixture
def with_another_box(tmp_path: Path) -> tuple[str, ...]:
    """The options of a gateway to which a message that Track nests is another than to the robot."""
    shutil.copytree(interfaces.FOLDER / "idl_msgs", tmp_path / "idl_msgs")
    box = tmp_path / "idl_msgs/msg/Box.idl"
    box.write_text(box.read_text().replace("float width", "double width"))
    return "--set", f"types.paths={tmp_path}", "--set", "types.ask_nodes=false"


@unless_keyed
async def test_a_robot_with_another_definition_is_told_of(
    with_another_box: tuple[str, ...], outside: Outside
):
    publisher = outside.node.create_publisher(ros_class(TRACK), "/other", LATCHED)
    heard = outside.node.create_subscription(ros_class(TRACK), "/others", print, 10)
    async with (
        gateway_process("serve", *with_another_box, before=WITHOUT_PACKAGES) as gateway,
        client(gateway.url) as speaker,
    ):
        await speaker.send(op="subscribe", id="s", topic="/other", type=TRACK)
        await speaker.send(op="advertise", id="a", topic="/others", type=TRACK)
        told = set()  # in the order in which the robot's entities are discovered
        for _ in range(2):
            status = await speaker.status()
            assert (status["code"], status["level"]) == ("type_conflict", "warning")
            told.add(status["msg"].partition(", so ")[0])
        assert told == {
            f"topic {topic}: /robot has another definition of {TRACK} than this gateway"
            for topic in ("/other", "/others")
        }
    outside.node.destroy_publisher(publisher)
    outside.node.destroy_subscription(heard)


async def test_a_service_with_another_definition_is_not_called(
    with_another_box: tuple[str, ...], outside: Outside
):
    service = outside.node.create_service(ros_class(RECALL), "/recalls", print)
    async with (
        gateway_process("serve", *with_another_box, before=WITHOUT_PACKAGES) as gateway,
        client(gateway.url) as speaker,
    ):
        await until_discovered(speaker, "service_type", "/recalls")
        await speaker.send(op="call_service", id="c", service="/recalls", timeout=60)
        frame = await speaker.receive(lambda frame: frame.get("id") == "c")
        assert frame["result"] is False
        assert frame["values"].startswith(
            f"service /recalls: its server has another definition of {RECALL} than this gateway"
        )
    outside.node.destroy_service(service)

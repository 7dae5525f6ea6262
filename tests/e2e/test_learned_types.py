# SPDX-License-Identifier: Apache-2.0
"""A gateway without the packages that a robot has, and without a folder: it asks the robot."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio

from gateway.codec.types import Types
from gateway.sources.rclpy.made_types import classes as made_types
from gateway.sources.rclpy.made_types.classes import MadeTypes
from schemas.installed import InstalledDefinitions
from tests import interfaces
from tests.cli.test_main import ros2_gateway
from tests.client import Client, client, eventually
from tests.e2e.both_ways import LATCHED, BothWays, unless_keyed
from tests.e2e.discovery import until_discovered
from tests.e2e.test_types_not_installed import TRACK, WITHOUT_PACKAGES
from tests.gateway_process import GatewayProcess, gateway_process
from tests.messages import ros_class
from tests.sources.outside import Outside

pytestmark = pytest.mark.asyncio(loop_scope="module")
needs_packages = pytest.mark.skipif(
    not InstalledDefinitions().names(["idl_msgs"]), reason=interfaces.HOW
)


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def gateway() -> AsyncIterator[GatewayProcess]:
    async with gateway_process("serve", before=WITHOUT_PACKAGES) as gateway:
        yield gateway


@pytest_asyncio.fixture(loop_scope="module")
async def speaker(gateway: GatewayProcess) -> AsyncIterator[Client]:
    async with client(gateway.url) as speaker:
        yield speaker


@pytest.fixture(scope="module")
def outside() -> Iterator[Outside]:
    with contextlib.closing(Outside("robot")) as outside:
        yield outside


class Robot:
    """A node with types that exist nowhere else, whose definitions it tells as rclpy has it."""

    def __init__(self, folder: Path, *, answers: bool = True) -> None:
        self._folder = folder / "my_msgs" / "msg"
        self._folder.mkdir(parents=True, exist_ok=True)
        self.outside = Outside("own_robot", answers=answers)
        self._made = MadeTypes()

    def publish(self, topic: str, name: str, message: Any, **texts: str) -> None:
        """Publish a message of a type, after the definitions of these types are written."""
        for each, text in texts.items():
            (self._folder / f"{each}.msg").write_text(text)
        definitions = InstalledDefinitions(None, [self._folder.parents[1]])
        made = self._made.get(definitions.get(name), definitions)
        publisher = self.outside.node.create_publisher(made, topic, LATCHED)
        publisher.publish(Types(definitions).get(name).encode(message, 0))

    def close(self) -> None:
        self.outside.close()


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[Robot]:
    with contextlib.closing(Robot(tmp_path)) as robot:
        yield robot


async def test_a_topic_of_a_type_that_comes_with_the_gateway_works_both_ways(speaker: Client):
    hypothesis = {"hypothesis": {"class_id": "cup", "score": 0.75}}
    sent = {"results": [hypothesis], "id": "7", "bbox": {"size_x": 1.5}}
    about = {"topic": "/detections", "type": "vision_msgs/msg/Detection2DArray"}
    await speaker.send(op="subscribe", **about)
    await speaker.send(op="advertise", qos={"durability": "transient_local"}, **about)
    await speaker.send(op="publish", msg={"detections": [sent]}, **about)
    (heard,) = (await speaker.message("/detections"))["detections"]
    assert heard["results"][0]["hypothesis"] == hypothesis["hypothesis"]
    assert (heard["id"], heard["bbox"]["size_x"]) == ("7", 1.5)


@needs_packages
@unless_keyed
@pytest.mark.parametrize("seed", range(2))
async def test_messages_of_a_robot_reach_a_client(seed: int, speaker: Client, outside: Outside):
    await BothWays(TRACK, speaker, outside).to_a_client(seed)


@needs_packages
@unless_keyed
@pytest.mark.parametrize("seed", range(2))
async def test_messages_of_a_client_reach_a_robot(seed: int, speaker: Client, outside: Outside):
    publisher = outside.node.create_publisher(ros_class(TRACK), "/track", LATCHED)
    await until_described(speaker, TRACK)
    await BothWays(TRACK, speaker, outside).to_a_robot(seed)
    outside.node.destroy_publisher(publisher)


async def until_described(speaker: Client, type_name: str) -> None:
    """Wait until a type is learned."""
    is_known = False
    while not is_known:
        await speaker.send(op="describe", id="known", type=type_name)
        frame = await speaker.receive(lambda frame: frame.get("id") == "known")
        is_known = frame["op"] == "describe"


async def test_clients_code_is_generated_of_what_a_robot_tells(
    gateway: GatewayProcess, speaker: Client, robot: Robot
):
    valve = "uint8 position\nSeat seat\n"
    message = {"position": 3, "seat": {"width": 1.5}}
    robot.publish("/valve", "my_msgs/msg/Valve", message, Valve=valve, Seat="float32 width\n")
    await speaker.send(op="subscribe", topic="/valve")
    assert await speaker.message("/valve") == message
    command = ("generate", "typescript", "/valve", "--from", gateway.url, "--timeout", "100")
    finished = await asyncio.to_thread(ros2_gateway, *command)
    assert (finished.returncode, finished.stderr) == (0, "")
    assert "    position: number;\n" in finished.stdout
    assert "    seat: Seat;\n" in finished.stdout
    assert "    width: number | null;\n" in finished.stdout


async def test_clients_read_the_definition_as_it_was_written(speaker: Client, robot: Robot):
    text = "# a lamp\nuint8 RED=1\nuint8 colour  # of the light\nBulb[<=2] bulbs\n"
    bulb = "wstring<=5 maker\nfloat32 power\n"
    message = {"colour": 1, "bulbs": [{"maker": "ÄÖ", "power": 2.5}]}
    robot.publish("/lamp", "my_msgs/msg/Lamp", message, Lamp=text, Bulb=bulb)
    await speaker.send(op="subscribe", topic="/lamp")
    assert await speaker.message("/lamp") == message
    await speaker.send(op="describe", id="d", type="my_msgs/msg/Lamp")
    frame = await speaker.receive(lambda frame: frame.get("id") == "d")
    assert frame["type_hash"] == robot_hash(robot, "/lamp")
    assert frame["definition"] == "uint8 colour\nmy_msgs/msg/Bulb[<=2] bulbs\n"  # has no source
    await speaker.send(
        op="call_service", service="/rosapi/message_details", id="m", args={"type": "my_msgs/Lamp"}
    )
    frame = await speaker.receive(lambda frame: frame.get("id") == "m")
    assert [each["type"] for each in frame["values"]["typedefs"]] == [
        "my_msgs/Lamp",
        "my_msgs/Bulb",
    ]


async def test_a_definition_that_changes_is_followed(speaker: Client, tmp_path: Path):
    name = "my_msgs/msg/Changing"
    with contextlib.closing(Robot(tmp_path)) as former:
        former.publish("/changing", name, {"on": True}, Changing="bool on\n")
        await speaker.send(op="subscribe", topic="/changing")
        assert await speaker.message("/changing") == {"on": True}
        await speaker.send(op="advertise", topic="/wanted", type=name)
        assert await speaker.sync() == []
    with contextlib.closing(Robot(tmp_path)) as later:
        message = {"brightness": 0.5, "on": True}
        later.publish("/changing", name, message, Changing="float64 brightness\nbool on\n")
        frame = await speaker.receive(
            lambda frame: frame["op"] == "publish" and frame["msg"] == message
        )
        assert frame["topic"] == "/changing"
        # messages of the client also have the new definition
        expected = {robot_hash(later, "/changing")}
        await eventually(lambda: robot_hashes(later, "/wanted") == expected)


async def test_a_robot_that_lies_is_not_believed(speaker: Client, robot: Robot, monkeypatch):
    monkeypatch.setattr(made_types, "type_hash", lambda *_: f"RIHS01_{'ab' * 32}")
    robot.publish("/liar", "my_msgs/msg/Lie", {"on": True}, Lie="bool on\n")
    await speaker.send(op="subscribe", topic="/liar")
    # before, the node's service may not be known yet
    status = await speaker.receive(lambda frame: " says: " in frame.get("msg", ""))
    assert status["code"] == "bad_type"
    assert status["msg"] == (
        "type: no definition of my_msgs/msg/Lie is installed, and a node that has it says: the"
        " definition of my_msgs/msg/Lie has another hash than the type: install its package, or"
        " name a folder that has the definition in types.paths, waiting for /liar to change"
    )


async def test_a_robot_that_does_not_answer_is_told_of(speaker: Client, tmp_path: Path):
    with contextlib.closing(Robot(tmp_path, answers=False)) as robot:
        robot.publish("/silent", "my_msgs/msg/Silent", {"on": True}, Silent="bool on\n")
        await speaker.send(op="subscribe", topic="/silent")
        status = await speaker.receive(lambda frame: frame.get("code") == "bad_type")
        assert "and a node that has it has not answered within 5 s: " in status["msg"]


async def test_a_setting_keeps_nodes_from_being_asked(robot: Robot):
    robot.publish("/unasked", "my_msgs/msg/Unasked", {"on": True}, Unasked="bool on\n")
    unasked = ("--set", "types.ask_nodes=false")
    async with gateway_process("serve", *unasked) as gateway, client(gateway.url) as speaker:
        await until_discovered(speaker, "publishers", "/unasked")
        await speaker.send(op="subscribe", topic="/unasked")
        status = await speaker.status()
        assert status["msg"].startswith(
            "type: no definition of my_msgs/msg/Unasked is installed: install its package, or"
            " name a folder that has the definition in types.paths"
        )


def robot_hashes(robot: Robot, topic: str) -> set[str]:
    found = robot.outside.node.get_publishers_info_by_topic(topic)
    return {str(each.topic_type_hash) for each in found}


def robot_hash(robot: Robot, topic: str) -> str:
    (found,) = robot_hashes(robot, topic)
    return found

# SPDX-License-Identifier: Apache-2.0
"""A gateway without the packages that a robot has, which knows their definitions from a folder."""

import shutil
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio

from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests import interfaces
from tests.client import Client, client
from tests.e2e.both_ways import LATCHED, BothWays
from tests.gateway_process import gateway_process
from tests.messages import ros_class
from tests.ros.outside import Outside

DEFINITIONS = InstalledDefinitions()
TRACK = "idl_msgs/msg/Track"
TF = "tf2_msgs/msg/TFMessage"
WITHOUT_PACKAGES = ("env", "-u", "PYTHONPATH", "-u", "AMENT_PREFIX_PATH")

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.skipif(not DEFINITIONS.names(["idl_msgs", "tf2_msgs"]), reason=interfaces.HOW),
]


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


@pytest.mark.parametrize("seed", range(3))
async def test_what_a_robot_publishes_reaches_a_client(
    seed: int, speaker: Client, outside: Outside
):
    await BothWays(TRACK, speaker, outside).to_a_client(seed)


@pytest.mark.parametrize("seed", range(3))
async def test_what_a_client_publishes_reaches_a_robot(
    seed: int, speaker: Client, outside: Outside
):
    await BothWays(TRACK, speaker, outside).to_a_robot(seed)


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


async def test_services_of_such_types_are_refused_in_words(speaker: Client):
    await speaker.send(
        op="advertise_service", id=2, service="/measure", type="idl_msgs/srv/Measure"
    )
    frame = await speaker.receive(lambda frame: frame.get("id") == 2)
    assert (frame["code"], frame["level"]) == ("bad_type", "error")
    assert frame["msg"] == "no ROS package idl_msgs is installed here (idl_msgs/srv/Measure)"


async def test_a_robot_with_another_definition_is_told_of(tmp_path: Path, outside: Outside):
    shutil.copytree(interfaces.FOLDER / "idl_msgs", tmp_path / "idl_msgs")
    box = tmp_path / "idl_msgs/msg/Box.idl"  # which Track nests
    box.write_text(box.read_text().replace("float width", "double width"))
    folder = ("--set", f"types.paths={tmp_path}")
    publisher = outside.node.create_publisher(ros_class(TRACK), "/other", LATCHED)
    heard = outside.node.create_subscription(ros_class(TRACK), "/others", print, 10)
    async with (
        gateway_process("serve", *folder, before=WITHOUT_PACKAGES) as gateway,
        client(gateway.url) as speaker,
    ):
        await speaker.send(op="subscribe", id="s", topic="/other", type=TRACK)
        await speaker.send(op="advertise", id="a", topic="/others", type=TRACK)
        for topic in ("/other", "/others"):
            status = await speaker.status()
            assert (status["code"], status["level"]) == ("type_conflict", "warning")
            assert status["msg"].startswith(
                f"topic {topic}: /robot has another definition of {TRACK} than this gateway"
            )
    outside.node.destroy_publisher(publisher)
    outside.node.destroy_subscription(heard)

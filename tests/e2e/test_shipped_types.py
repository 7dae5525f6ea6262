# SPDX-License-Identifier: Apache-2.0
"""Types whose definition comes with the gateway, where PyPI's wheels are all that is installed."""

import tomllib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio

from tests.client import Client, client
from tests.e2e.test_types_not_installed import WITHOUT_PACKAGES
from tests.gateway_process import gateway_process

pytestmark = pytest.mark.asyncio(loop_scope="module")

DETECTIONS = "vision_msgs/msg/Detection2DArray"
HASHES = Path(__file__).parents[1] / "schemas/published_hashes.toml"


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def speaker() -> AsyncIterator[Client]:
    async with (
        gateway_process("serve", before=WITHOUT_PACKAGES) as gateway,
        client(gateway.url) as speaker,
    ):
        yield speaker


async def rosapi(speaker: Client, service: str, **args: Any) -> Any:
    await speaker.send(op="call_service", id=service, service=f"/rosapi/{service}", args=args)
    response = await speaker.receive(
        lambda frame: (frame["op"], frame.get("id")) == ("service_response", service)
    )
    assert response["result"], response
    return response["values"]


async def test_a_topic_of_such_a_type_works_both_ways(speaker: Client):
    hypothesis = {"hypothesis": {"class_id": "cup", "score": 0.75}}
    sent = {"results": [hypothesis], "id": "7", "bbox": {"size_x": 1.5}}
    about = {"topic": "/detections", "type": DETECTIONS}
    await speaker.send(op="subscribe", **about)
    await speaker.send(op="advertise", qos={"durability": "transient_local"}, **about)
    await speaker.send(op="publish", msg={"detections": [sent]}, **about)
    (heard,) = (await speaker.message("/detections"))["detections"]
    assert heard["results"][0]["hypothesis"] == hypothesis["hypothesis"]
    assert (heard["id"], heard["bbox"]["size_x"]) == ("7", 1.5)


async def test_it_is_described_with_the_hash_that_robots_have(speaker: Client):
    await speaker.send(op="describe", id="d", type=DETECTIONS)
    described = await speaker.receive(lambda frame: frame.get("id") == "d")
    hashes = tomllib.loads(HASHES.read_text("utf-8"))["vision_msgs"]
    assert described["type_hash"] == f"RIHS01_{hashes['msg/Detection2DArray']}"
    assert "detections" in described["schema"]["properties"]


async def test_rosapi_knows_it(speaker: Client):
    details = await rosapi(speaker, "message_details", type=DETECTIONS)
    assert details["typedefs"][0]["fieldnames"] == ["header", "detections"]
    known = (await rosapi(speaker, "interfaces"))["interfaces"]
    assert {DETECTIONS, "nav2_msgs/action/NavigateToPose"} <= set(known)

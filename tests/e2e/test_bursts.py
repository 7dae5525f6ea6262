# SPDX-License-Identifier: Apache-2.0
"""Messages that a node publishes back to back, while the gateway does something else.

The publisher is in the gateway's own process: nothing is taken until all are published.
"""

from collections.abc import AsyncIterator
from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.sources.source import Publisher, Qos
from schemas.installed import InstalledDefinitions
from tests.client import Client, Frame, client
from tests.gateway_here import gateway_here
from tests.sources.outside import Outside

ODOMETRY = "nav_msgs/msg/Odometry"
STRING = "std_msgs/msg/String"
TYPES = Types(InstalledDefinitions())
BURST = 500
DEEP = Qos(depth=1000)


@pytest.fixture
async def url() -> AsyncIterator[str]:
    async with gateway_here(Limits()) as url:
        yield url


def cdr(type_name: str, text: str) -> bytes:
    value = {"data": text} if type_name == STRING else {"child_frame_id": text}
    return TYPES.get(type_name).encode(value, now_ns=0)


async def begin(listener: Client, publisher: Publisher, type_name: str) -> Frame:
    """Publish until something arrives, and return the frame of the last of it."""

    def is_matched() -> bool:
        publisher.publish(cdr(type_name, "first"))
        return any(frame["op"] == "publish" for frame in listener.seen)

    while not is_matched():
        await listener.sync()
    publisher.publish(cdr(type_name, "begin"))
    return await listener.receive(lambda frame: "begin" in str(frame))


def burst(publisher: Publisher, type_name: str) -> None:
    for number in range(BURST):
        publisher.publish(cdr(type_name, str(number)))


@pytest.mark.parametrize("type_name", [ODOMETRY, STRING])
async def test_a_burst_of_small_messages_is_complete(url: str, outside: Outside, type_name: str):
    async with client(url) as listener:
        publisher = outside.add_publisher("/t", type_name, DEEP)
        await listener.send(op="subscribe", topic="/t", type=type_name)
        await begin(listener, publisher, type_name)
        burst(publisher, type_name)
        texts = []
        for _ in range(BURST):
            message: dict[str, Any] = await listener.message("/t")
            texts.append(message["data" if type_name == STRING else "child_frame_id"])
        assert texts == [str(number) for number in range(BURST)]


async def test_losses_of_a_burst_are_counted_and_told(url: str, outside: Outside):
    async with client(url) as listener:
        publisher = outside.add_publisher("/t", STRING, DEEP)
        await listener.send(op="subscribe", topic="/t", type=STRING, qos={"depth": 5}, meta=True)
        before = (await begin(listener, publisher, STRING))["dropped"]
        burst(publisher, STRING)
        frames = []
        while not frames or frames[-1]["msg"]["data"] != str(BURST - 1):
            frames.append(await listener.receive(lambda frame: frame["op"] == "publish"))
        assert frames[-1]["dropped"] - before == BURST - len(frames) > 0
        told = await listener.receive(lambda frame: frame.get("code") == "messages_lost")
        assert told["level"] == "warning"
        assert told["msg"].endswith(
            'messages were lost on the way here; ask for "depth":10 in "qos",'
            " or have it publish less"
        )

# SPDX-License-Identifier: Apache-2.0
"""The lines of ``/rosout`` that clients get who connect later."""

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, ViewerConfig
from gateway.core.introspection.kept_log import LOG, MAX_LINE_BYTES, MAX_LINES, MAX_LOG_BYTES
from tests.client import eventually
from tests.core.conftest import Bench, Socketless


async def say(bench: Bench, *said: str) -> None:
    publisher = bench.ros.add_publisher("/rosout", LOG)
    for text in said:
        publisher.publish(bench.cdr(LOG, level=30, name="base", msg=text))
    await eventually(lambda: texts(bench.client())[-1:] == [said[-1]])


def texts(client: Socketless) -> list[str]:
    client.send(op="log", id="l")
    return [line["msg"] for line in client.of("log")[-1]["lines"]]


async def test_a_later_client_gets_the_lines_in_their_order(bench: Bench) -> None:
    assert texts(bench.client()) == []
    bench.router.introspection.keep_log(bench.types)
    await say(bench, "one", "two")
    assert bench.router.counts()["ros_entities"] == 0  # of clients
    client = bench.client()
    assert texts(client) == ["one", "two"]
    assert (
        client.of("log")[-1]["lines"][0] | {"level": 30, "name": "base"}
        == (client.of("log")[-1]["lines"][0])
    )


async def test_the_newest_thousand_lines_are_kept(bench: Bench) -> None:
    bench.router.introspection.keep_log(bench.types)
    await say(bench, *map(str, range(MAX_LINES + 5)))
    kept = texts(bench.client())
    assert (len(kept), kept[0], kept[-1]) == (1000, "5", "1004")


async def test_long_lines_take_the_place_of_others_within_a_limit(bench: Bench) -> None:
    bench.router.introspection.keep_log(bench.types)
    long = "x" * (15 * 1024)
    await say(bench, *[long] * 20, "x" * (16 * 1024), "the last")
    kept = texts(bench.client())
    assert (MAX_LOG_BYTES, MAX_LINE_BYTES) == (256 * 1024, 16 * 1024)
    assert kept == [long] * 17 + ["the last"]


async def test_an_invalid_message_is_left_out(bench: Bench) -> None:
    bench.router.introspection.keep_log(bench.types)
    bench.ros.add_publisher("/rosout", LOG).publish(b"\0\1\0\0")
    await say(bench, "one")
    assert texts(bench.client()) == ["one"]


@pytest.mark.parametrize("hidden", [True, False])
async def test_lines_need_the_permission_to_subscribe(bench: Bench, hidden: bool) -> None:
    viewer = ViewerConfig(deny_subscribe=("/rosout",)) if hidden else ViewerConfig(subscribe=())
    policy = Policy(AccessConfig(viewer=viewer))
    client = bench.client(identity=Identity("tablet", policy.of("viewer")))
    client.send(op="log")
    assert client.of("log") == []
    assert len(client.of("status")) == 1

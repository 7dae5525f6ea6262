# SPDX-License-Identifier: Apache-2.0
"""Recordings of the real rmw_zenoh, played to the source."""

import contextlib
from collections.abc import Iterator

import pytest

from gateway.codec.types import Types
from gateway.sources.options import RosOptions
from gateway.sources.source import Qos
from gateway.sources.zenoh.port import ZenohSource
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.sources.test_contract import Received
from tests.sources.zenoh.conftest import open_source_on
from tests.sources.zenoh.outside import Router
from tests.sources.zenoh.replay import Replay, expected

TYPES = Types(InstalledDefinitions())
RECORDED = RosOptions(domain_id=46)


@contextlib.contextmanager
def replayed(name: str) -> Iterator[tuple[ZenohSource, Replay]]:
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        source = stack.enter_context(open_source_on(router.address, RECORDED))
        yield source, stack.enter_context(contextlib.closing(Replay(router.address, name)))


@pytest.mark.parametrize(
    ("topic", "type_name", "reliability"),
    [
        ("/chatter", "std_msgs/msg/String", "reliable"),
        ("/odom", "nav_msgs/msg/Odometry", "best_effort"),
    ],
)
async def test_samples_of_the_real_one_arrive_with_their_values(topic, type_name, reliability):
    with replayed("1_talker") as (source, replay):
        await eventually(lambda: source.topic_types(topic) == (type_name,))
        received = Received()
        handle = source.subscribe(topic, type_name, Qos(), received.on_samples, received.on_event)
        await eventually(lambda: replay.is_matched(topic))
        lines = replay.play(topic)
        await eventually(lambda: len(received.cdrs) == len(lines))
        samples = [each for batch in received.batches for each in batch]
        assert [each.cdr.hex() for each in samples] == [line["payload"] for line in lines]
        assert [each.number for each in samples] == list(range(1, len(lines) + 1))
        codec = TYPES.get(type_name)
        values = [codec.decode(each.cdr) for each in samples]
        assert [holds(*pair) for pair in zip(values, expected("1_talker", topic), strict=True)]
        assert all(source.known.has_publisher(each.publisher) for each in samples)
        assert handle.qos.reliability == reliability
        await eventually(lambda: handle.publishers == 1)
        assert (handle.lost, received.reasons) == (0, [])


def holds(value: dict, said: dict) -> bool:
    """Check that a message has the values that its publisher wrote."""
    for name, each in said.items():
        if isinstance(each, dict):
            assert holds(value[name], each)
        elif isinstance(each, list):
            assert list(value[name]) == each
        else:
            assert value[name] == each
    return True


async def test_a_late_subscription_gets_what_the_real_one_has_kept():
    with replayed("2_latched") as (source, _):
        await eventually(lambda: source.topic_types("/kept") != ())
        received = Received()
        handle = source.subscribe(
            "/kept", "std_msgs/msg/String", Qos(), received.on_samples, received.on_event
        )
        await eventually(lambda: len(received.cdrs) == 3)
        codec = TYPES.get("std_msgs/msg/String")
        kept = [codec.decode(each)["data"] for each in received.cdrs]
        assert kept == ["kept 2", "kept 3", "kept 4"]
        assert handle.qos.durability == "transient_local"
        late: list[object] = []
        handle.join_late(late.extend)
        await eventually(lambda: len(late) == 3)


async def test_the_real_graph_is_the_graph():
    with replayed("7_names") as (source, _):
        await eventually(lambda: len(source.graph().nodes) > 6)
        graph = source.graph()
        own = {f"/ros2_gateway_{each}" for each in ("debug", "subscriptions", "publishers")}
        assert own < set(graph.nodes)
        assert {"/ns/sub/inner", "/cam2", "/node_with_under_scores"} < set(graph.nodes)
        services = {each.name for each in graph.services}
        assert "/ns/sub/inner/get_parameters" in services
        assert source.service_types("/ns/sub/inner/get_parameters") == (
            "rcl_interfaces/srv/GetParameters",
        )

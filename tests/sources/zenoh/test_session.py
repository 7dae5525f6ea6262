# SPDX-License-Identifier: Apache-2.0
"""The session with a robot's router, its faults, and what peers may send."""

import contextlib
import threading
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from gateway.errors import RosStartError
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh import token_changes
from gateway.sources.zenoh.keys import NO_TYPE_HASH
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.port import ZenohSource
from gateway.sources.zenoh.session import CLOSE_S, LEASE_MS, open_session
from tests.client import eventually
from tests.sources.test_contract import INT32, STRING, Received, number
from tests.sources.zenoh.conftest import open_robot, open_source_on
from tests.sources.zenoh.outside import Router, ZenohOutside, client, free_port

Pair = tuple[ZenohSource, ZenohOutside]


@pytest.fixture
async def pair() -> "Iterator[Pair]":
    with open_robot() as robot:
        yield robot


def subscribe(source: ZenohSource, topic: str, type_name: str = INT32) -> Received:
    received = Received()
    source.subscribe(topic, type_name, Qos(), received.on_samples, received.on_event)
    return received


def test_a_router_that_does_not_answer_is_named_with_what_to_do():
    address = f"tcp/127.0.0.1:{free_port()}"
    with pytest.raises(RosStartError, match=f"router {address} cannot be reached.*rmw_zenohd"):
        open_session(ZenohOptions(address))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (ZenohOptions("robot"), r"does not accept connect/endpoints=\[\"robot\"\].*--zenoh"),
        (ZenohOptions("tcp/robot:7447", "nothing/such=1"), "does not accept nothing/such=1"),
    ],
)
def test_settings_that_zenoh_does_not_know_are_named(options, words):
    with pytest.raises(RosStartError, match=words):
        open_session(options)


def test_overrides_come_last():
    with contextlib.closing(Router()) as router:
        overrides = 'namespace="gw/r1"; transport/link/tx/lease=3000 ;'
        open_session(ZenohOptions(router.address, overrides)).close()
    assert LEASE_MS == 2000


async def test_a_namespace_is_before_all_keys_and_hides_the_others():
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        inside = stack.enter_context(open_source_on(router.address, namespace="gw/r1"))
        outside = stack.enter_context(open_source_on(router.address))
        within = stack.enter_context(open_source_on(router.address, namespace="gw/r1"))
        received, missed = subscribe(within, "/count"), subscribe(outside, "/count")
        publisher = inside.publishing.advertise("/count", INT32, Qos(), lambda _: None)
        await eventually(lambda: within.known.offers("/count"))

        def has_arrived() -> bool:
            publisher.publish(number(7))
            return bool(received.cdrs)

        await eventually(has_arrived)
        assert not missed.cdrs
        assert not outside.known.offers("/count")


async def test_the_robot_comes_back_with_its_router():
    port = free_port()
    with contextlib.ExitStack() as stack:
        router = Router(port)
        stack.callback(lambda: router.close())
        world = stack.enter_context(contextlib.closing(ZenohOutside(router.address)))
        source = stack.enter_context(open_source_on(router.address))
        received = subscribe(source, "/count")
        publisher = world.add_publisher("/count", INT32)
        await eventually(lambda: source.topic_types("/count") == (INT32,))
        await eventually(lambda: not source.faults())
        router.close()
        await eventually(lambda: [each.severity for each in source.faults()] == ["not ready"])
        await eventually(lambda: source.graph().nodes[:1] != ("/outside",))
        router = Router(port)

        def is_back() -> bool:
            publisher.publish(number(7))
            return bool(received.cdrs) and not source.faults()

        await eventually(is_back)
        await eventually(lambda: "/outside" in source.graph().nodes)


async def test_another_definition_is_reported_and_its_samples_do_not_come(pair):
    source, world = pair
    received = subscribe(source, "/count")
    other = world.add_publisher("/count", INT32, None, "RIHS01_" + "0" * 64)
    same = world.add_publisher("/count", INT32)
    await eventually(lambda: bool(received.reasons))
    assert received.reasons[0].code == "type_conflict"
    assert received.reasons[0].problem == (
        "topic /count: /outside has another definition of std_msgs/msg/Int32 than this gateway,"
        " so its messages do not arrive"
    )

    def both() -> bool:
        other.publish(number(1))
        same.publish(number(2))
        return bool(received.cdrs)

    await eventually(both)
    assert set(received.cdrs) == {number(2)}


async def test_a_robot_of_humble_without_hashes_is_heard(pair):
    source, world = pair
    received = subscribe(source, "/count")
    publisher = world.add_publisher("/count", INT32, None, NO_TYPE_HASH)

    def arrives() -> bool:
        publisher.publish(number(1))
        return bool(received.cdrs)

    await eventually(arrives)
    assert received.reasons == []
    await eventually(lambda: source.distro == "humble")


async def test_nodes_of_humble_are_not_asked_for_definitions(pair):
    source, world = pair
    name = "far_msgs/msg/Lamp"
    world.add_publisher("/lamp", name, None, NO_TYPE_HASH)
    await eventually(lambda: source.topic_types("/lamp") == (name,))
    with pytest.raises(RosError, match="ROS 2 Humble have none to send: add its package"):
        await source.definitions(name)
    world.add_publisher("/count", INT32, None, NO_TYPE_HASH)
    await eventually(lambda: source.topic_types("/count") == (INT32,))
    assert await source.definitions(INT32) is None


async def test_a_domain_of_another_robot_is_not_seen(pair):
    source, world = pair
    token = world.token("NN", 99).replace("@ros2_lv/117/", "@ros2_lv/118/")
    held = world.session.liveliness().declare_token(token.replace("outside", "elsewhere"))
    near = world.session.liveliness().declare_token(world.token("NN", 98).replace("out", "in"))
    await eventually(lambda: "/inside" in source.graph().nodes)
    assert "/elsewhere" not in source.graph().nodes
    del held, near


async def test_samples_and_tokens_of_strangers_harm_nobody(pair, caplog):
    source, world = pair
    received = subscribe(source, "/count")
    publisher = world.add_publisher("/count", INT32)
    odd = ("a/b", "x/%%/$y", "0/0/0/MP/%/%/n/%t/not::a::type/h/::,:,:,:,,", "é/ü")
    held = []
    for each in odd:
        with contextlib.suppress(Exception):  # Zenoh refuses some of them itself
            held.append(world.session.liveliness().declare_token(f"@ros2_lv/117/{each}"))
    assert held
    key = str(publisher._publisher.key_expr)
    world.session.put(key, b"no attachment")
    world.session.put(key, b"a short one", attachment=b"\1" * 9)

    def arrives() -> bool:
        publisher.publish(number(1))
        return bool(received.cdrs)

    await eventually(arrives)
    await eventually(lambda: source._foreign.count == 2)
    assert set(received.cdrs) == {number(1)}
    assert "no node of ROS has published" in caplog.text


async def test_lost_samples_are_counted_for_each_publisher(pair):
    source, world = pair
    received = Received()
    handle = source.subscribe("/count", INT32, Qos(), received.on_samples, received.on_event)
    publishers = [world.add_publisher("/count", INT32) for _ in range(2)]

    def arrives() -> bool:
        for each in publishers:
            each.publish(number(0))
        return len({sample.publisher for batch in received.batches for sample in batch}) == 2

    await eventually(arrives)
    lost = handle.lost
    for _ in range(3):
        next(publishers[0]._numbers)
    for each in publishers:
        each.publish(number(5))
    await eventually(lambda: received.cdrs.count(number(5)) == 2)
    assert handle.lost - lost == 3


async def test_a_type_without_a_definition_is_bad(pair):
    source, _ = pair
    with pytest.raises(RosError) as caught:
        subscribe(source, "/count", "no_msgs/msg/Nothing")
    assert caught.value.code == "bad_type"
    assert source.entity_count() == 0


async def test_many_tokens_of_one_peer_leave_room_for_the_loop(pair):
    source, world = pair
    live = world.session.liveliness()
    held = [live.declare_token(world.token("NN", each).replace("outside", f"n{each}"))
            for each in range(100, 1100)]  # fmt: skip
    await eventually(lambda: len(source.graph().nodes) >= 1000)
    del held


async def test_a_session_of_a_stranger_may_see_the_gateway(pair):
    source, world = pair
    subscribe(source, "/chatter", STRING)
    seen: list[str] = []
    other = client(world.router)
    watch = other.liveliness().declare_subscriber(
        "@ros2_lv/117/**", lambda sample: seen.append(str(sample.key_expr)), history=True
    )
    await eventually(lambda: any("/MS/" in each and "%chatter" in each for each in seen))
    nodes = {each.rsplit("/", 1)[1] for each in seen if "/NN/" in each}
    assert {f"ros2_gateway_{each}" for each in ("debug", "subscriptions")} <= nodes
    watch.undeclare()
    other.close()


async def test_a_second_gateway_of_the_same_names_is_reported(pair):
    source, world = pair
    assert source.shared_names() == ()
    with open_source_on(world.router):
        await eventually(lambda: "/ros2_gateway_debug" in source.shared_names())
    await eventually(lambda: source.shared_names() == ())


async def test_tokens_that_were_left_out_are_read_once_there_is_room(pair, monkeypatch):
    source, world = pair
    monkeypatch.setattr(token_changes, "MAX_TOKENS", len(source._changes._known) + 60)
    live = world.session.liveliness()
    held = {
        f"/n{each}": live.declare_token(world.token("NN", each).replace("outside", f"n{each}"))
        for each in range(100, 200)
    }
    await eventually(lambda: source._changes.left_out > 0)
    await eventually(lambda: bool(source.graph().nodes) and not source._changes._waiting)
    known = [each for each in source.graph().nodes if each in held]
    for each in known:
        held.pop(each).undeclare()
    assert held
    await eventually(lambda: set(held) <= set(source.graph().nodes))
    assert source._changes.left_out == 0
    assert not [each for each in source.faults() if "left out" in each.text]


async def test_a_session_that_does_not_end_keeps_nobody(pair, monkeypatch):
    assert CLOSE_S == 0.5
    source, _ = pair
    released = threading.Event()
    monkeypatch.setattr(source.session, "zenoh", SimpleNamespace(close=released.wait))
    source.session.close()
    released.set()

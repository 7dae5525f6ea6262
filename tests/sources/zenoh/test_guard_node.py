# SPDX-License-Identifier: Apache-2.0
"""The guard's own session: whom its zeros reach, and which commands it expects to hear."""

from collections.abc import Iterator
from typing import Any

import pytest

from gateway.drive.twist_cdr import TWIST, encode
from gateway.drive.velocity import ZERO
from gateway.sources.source import Qos
from gateway.sources.zenoh import guard_node
from gateway.sources.zenoh.guard_node import ZenohGuardNode
from gateway.sources.zenoh.keys import NO_TYPE_HASH
from gateway.sources.zenoh.port import ZenohSource
from tests.client import eventually
from tests.sources.zenoh.conftest import OPTIONS, open_robot
from tests.sources.zenoh.outside import DOMAIN, hash_of
from tests.sources.zenoh.world import ZenohWorld

TOPIC = "/cmd_vel"
BURST = 300  # 40 KB, and so one batch
CDR = encode(TWIST, ZERO, 0, "")
Scene = tuple[ZenohSource, ZenohWorld, ZenohGuardNode]


@pytest.fixture
async def scene() -> "Iterator[Scene]":
    with open_robot() as (source, world):
        namespace, _, name = OPTIONS.guard_node.rpartition("/")
        commander = source.nodes["publishers"]
        arguments = (name, namespace or "/", DOMAIN, world.router, commander)
        with ZenohGuardNode(*arguments, {TWIST: hash_of(TWIST)}) as guard:
            yield source, world, guard


def command(source: ZenohSource) -> Any:
    return source.publishing.advertise(TOPIC, TWIST, Qos(depth=1), lambda _: None)


@pytest.mark.parametrize("a_hash", [None, NO_TYPE_HASH], ids=["Iron and later", "Humble"])
async def test_zeros_reach_the_robot_and_commands_are_heard(scene, a_hash):
    source, world, guard = scene
    heard: list[Any] = []
    _, _, gid = world.add_subscription(TOPIC, TWIST, heard.extend, a_hash=a_hash)
    await eventually(lambda: bool(source.publishing.readers(TOPIC)))
    publisher = guard.advertise(TOPIC, TWIST, 0)
    await eventually(lambda: guard.readers(TOPIC) == {gid.hex()})
    await eventually(lambda: publisher.is_acknowledged)
    publisher.publish(CDR)
    await eventually(lambda: len(heard) == 1)
    await eventually(lambda: len(source.known.offers(TOPIC)) == 1)  # the guard's
    commands = command(source)
    await eventually(lambda: bool(publisher.ends.commanders))

    def arrives() -> bool:
        commands.publish(CDR)
        return len(heard) > 1 and publisher._heard_s > 0

    await eventually(arrives)


async def test_the_first_command_of_a_drive_is_expected_and_so_after_the_topic_is_opened_again(
    scene,
):
    source, _, guard = scene
    for _ in range(2):
        commands, publisher = command(source), guard.advertise(TOPIC, TWIST, 0)
        await eventually(lambda each=publisher: bool(each.ends.commanders))
        guard.moves(TOPIC)

        def is_heard(own: Any = commands, each: Any = publisher) -> bool:
            own.publish(CDR)  # again: the way to the guard may not be known yet
            return each._heard_s > 0

        await eventually(is_heard)
        assert not guard.is_cut_off
        publisher.close()
        commands.close()
        await eventually(lambda: not source.known.offers(TOPIC))
    commands, publisher = command(source), guard.advertise(TOPIC, TWIST, 0)
    await eventually(lambda: bool(publisher.ends.commanders))
    guard.moves(TOPIC)  # and no command comes back
    await eventually(lambda: guard.is_cut_off)


async def test_of_a_burst_the_last_message_arrives(monkeypatch):
    # as in a router that is not given the processor while a link that was black catches up
    key = "transport/link/tx/queue/congestion_control/drop/wait_before_drop"
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", f"{key}=0")
    heard: list[Any] = []
    with open_robot() as (_, world):
        world.add_subscription(TOPIC, TWIST, heard.extend)
        arguments = ("burst", "/", DOMAIN, world.router, "/gateway", {TWIST: hash_of(TWIST)})
        with ZenohGuardNode(*arguments) as guard:
            publisher = guard.advertise(TOPIC, TWIST, 0)
            await eventually(lambda: bool(guard.readers(TOPIC)) and publisher.is_acknowledged)
            last = encode(TWIST, ZERO._replace(linear_x=1.0), 0, "")
            for cdr in [CDR] * BURST + [last]:
                publisher.publish(cdr)
            await eventually(lambda: bool(heard) and heard[-1].cdr == last)


async def test_of_the_tokens_of_a_robot_the_guard_keeps_some_of_its_topics(scene):
    _, world, guard = scene
    live = world.session.liveliness()
    publisher = guard.advertise(TOPIC, TWIST, 0)
    end = "geometry_msgs::msg::dds_::Twist_/TypeHashNotSupported/::,10:,:,:,,"
    kinds = [("MS", "%other"), ("MP", "%cmd_vel"), *[("MS", "%cmd_vel")] * 1100]
    held = [live.declare_token(f"{world.token(kind)}/{topic}/{end}") for kind, topic in kinds]
    await eventually(lambda: len(guard.readers(TOPIC)) == 1024)
    assert len(publisher.ends._known) == 1024 == guard_node.MAX_ENDPOINTS
    for each in held:
        each.undeclare()
    await eventually(lambda: not guard.readers(TOPIC))

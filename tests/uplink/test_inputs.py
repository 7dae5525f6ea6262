# SPDX-License-Identifier: Apache-2.0
"""Messages that relays publish for the robot."""

import logging

import pytest

from gateway.sources.source import Qos, Sample
from gateway.uplink import inputs
from tests.client import eventually
from tests.core.conftest import STRING, TWIST
from tests.uplink.conftest import Fleet, watched


async def test_messages_of_a_relay_reach_the_nodes_that_subscribe(fleet: Fleet):
    bench = fleet.bench
    heard: list[Sample] = []
    bench.ros.add_subscription("/goal", STRING, heard.extend)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/goal") == (STRING,))
    publisher = relay.publishing.advertise("/goal", STRING, Qos(), lambda _: None)
    await eventually(lambda: any(each.topic == "/goal" for each in bench.ros.publishers))
    cdr = bench.cdr(STRING, data="there")

    def has_come() -> bool:
        if not heard:
            publisher.publish(cdr)
        return bool(heard)

    await eventually(has_come)
    assert {each.cdr for each in heard} == {cdr}
    publisher.close()
    await eventually(lambda: not any(each.topic == "/goal" for each in bench.ros.publishers))


async def test_messages_of_a_relay_do_not_come_back_to_relays(fleet: Fleet):
    bench = fleet.bench
    bench.ros.add_subscription("/chatter", STRING, lambda _: None)
    own = bench.ros.add_publisher("/chatter", STRING)
    uplink = await fleet.offered()
    relay, other = fleet.relay(), fleet.relay("other")
    await eventually(lambda: relay.topic_types("/chatter") == (STRING,))
    received, _ = watched(other, "/chatter", STRING)
    assert uplink.link is not None
    link = uplink.link
    await eventually(lambda: link.topics.flowing == {"/chatter"})
    publisher = relay.publishing.advertise("/chatter", STRING, Qos(), lambda _: None)
    await eventually(lambda: "/chatter" in link.inputs._open)
    assert (inputs.MAX_WAITING_INPUTS, inputs.MAX_ECHOES) == (128, 256)
    first, last = bench.cdr(STRING, data="from a relay"), bench.cdr(STRING, data="last")

    def has_come() -> bool:
        if not received.cdrs:
            publisher.publish(first)
        return bool(received.cdrs)

    await eventually(has_come)
    count = len(link.inputs._open["/chatter"].echoes)
    await eventually(lambda: not link.inputs._open["/chatter"].echoes)
    own.publish(last)
    await eventually(lambda: last in received.cdrs)
    assert set(received.cdrs[:-1]) == {first}
    assert len(received.cdrs) <= 2 + count


@pytest.mark.parametrize(
    ("topic", "type_name", "role"),
    [
        ("/cmd_vel", TWIST, "operator"),
        ("/goal", STRING, "viewer"),
        ("/unheard", STRING, "operator"),
    ],
)
async def test_commands_and_messages_that_the_role_may_not_publish_stay_out(
    fleet: Fleet, topic: str, type_name: str, role: str
):
    bench = fleet.bench
    heard: list[Sample] = []
    for name, each in (("/cmd_vel", TWIST), ("/goal", STRING), ("/open", STRING)):
        bench.ros.add_subscription(name, each, heard.extend)
    uplink = await fleet.offered(role=role)
    relay = fleet.relay()
    publisher = relay.publishing.advertise(topic, type_name, Qos(), lambda _: None)
    publisher.publish(bench.cdr(type_name))
    assert uplink.link is not None
    link = uplink.link
    await eventually(lambda: bool(link.graph.published_by_others(topic)))
    await bench.settle()
    assert not link.inputs._open
    assert not heard
    assert not any(bench.ros.is_own(each.node) for each in bench.ros.publishers)


async def test_a_message_that_is_not_of_its_type_is_left_out(
    fleet: Fleet, caplog: pytest.LogCaptureFixture
):
    caplog.set_level(logging.WARNING)
    bench = fleet.bench
    heard: list[Sample] = []
    bench.ros.add_subscription("/goal", STRING, heard.extend)
    uplink = await fleet.offered()
    relay = fleet.relay()
    publisher = relay.publishing.advertise("/goal", STRING, Qos(), lambda _: None)
    assert uplink.link is not None
    link = uplink.link
    await eventually(lambda: "/goal" in link.inputs._open)

    def is_left_out() -> bool:
        publisher.publish(b"\0\1\0\0\xff\xff")
        return link.inputs._open["/goal"].left_out > 1

    await eventually(is_left_out)
    assert caplog.text.count("a relay sends a message that is left out") == 1
    assert not heard

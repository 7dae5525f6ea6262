# SPDX-License-Identifier: Apache-2.0
"""Robots of Humble, which show no hashes of types, and appear after the gateway has opened."""

import asyncio
from collections.abc import Sequence
from dataclasses import replace

import zenoh

from gateway.sources.source import Qos, Sample
from gateway.sources.zenoh.keys import NO_TYPE_HASH
from tests.client import eventually
from tests.sources.test_contract import INT32, number
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon, text_of
from tests.sources.zenoh.conftest import OPTIONS, open_robot
from tests.sources.zenoh.world import ZenohCaller

LATCHED = Qos("reliable", "transient_local", "keep_last", 1)


async def test_a_publisher_reaches_a_subscription_of_humble_that_comes_later():
    with open_robot() as (source, world):
        publisher = source.publishing.advertise("/count", INT32, Qos(), lambda _: None)
        heard: list[Sample] = []
        world.add_subscription("/count", INT32, heard.extend, None, NO_TYPE_HASH)
        await eventually(lambda: publisher.new_matches() == 1)

        def is_heard() -> bool:
            publisher.publish(number(1))
            return bool(heard)

        await eventually(is_heard)
        world.add_subscription("/count", INT32, lambda _: None)  # a guest from Jazzy
        await eventually(lambda: len(source.publishing.readers("/count")) == 2)
        assert publisher.key.type_hash == NO_TYPE_HASH


async def test_the_messages_that_a_latched_topic_keeps_reach_humble_too():
    with open_robot() as (source, world):
        publisher = source.publishing.advertise("/map", INT32, LATCHED, lambda _: None)
        for value in (1, 2):
            publisher.publish(number(value))
        heard: list[Sample] = []
        world.add_subscription("/map", INT32, heard.extend, LATCHED, NO_TYPE_HASH)
        await eventually(lambda: bool(heard))
        assert {each.cdr for each in heard} == {number(2)}


async def test_a_publisher_goes_back_to_hashes_if_only_those_are_there():
    with open_robot() as (source, world):
        publisher = source.publishing.advertise("/count", INT32, Qos(), lambda _: None)
        old = world.add_subscription("/count", INT32, lambda _: None, None, NO_TYPE_HASH)
        await eventually(lambda: publisher.key.type_hash == NO_TYPE_HASH)
        world.remove_subscription(old)
        heard: list[Sample] = []

        def hear(samples: Sequence[Sample]) -> None:
            heard.extend(samples)

        world.add_subscription("/count", INT32, hear)

        def is_heard() -> bool:
            publisher.publish(number(1))
            return bool(heard)

        await eventually(is_heard)


async def test_a_call_reaches_a_server_of_humble_that_comes_later():
    with open_robot() as (source, world):
        client = source.services.client("/arm", SET_BOOL)
        calling = asyncio.ensure_future(client.call(request(True)))
        world.add_service("/arm", SET_BOOL, echo, NO_TYPE_HASH)
        assert text_of(await soon(calling)) == "got True"


async def test_a_client_of_humble_that_comes_later_is_answered():
    with open_robot() as (source, world):
        source.services.serve("/arm", SET_BOOL, echo)
        client = world._keep(ZenohCaller(world, "/arm", SET_BOOL, NO_TYPE_HASH))
        assert text_of(await soon(client.call(request(True)))) == "got True"


async def test_commands_never_block_at_their_priority():
    with open_robot(replace(OPTIONS, reserved_topics=("/cmd_vel",))) as (source, _):
        keep_all = Qos("reliable", "volatile", "keep_all")
        opened = [
            source.publishing.advertise(topic, INT32, keep_all, lambda _: None)
            for topic in ("/cmd_vel", "/count")
        ]
        control = zenoh.CongestionControl
        assert [each._publisher.congestion_control for each in opened] == [
            control.DROP,
            control.BLOCK,
        ]

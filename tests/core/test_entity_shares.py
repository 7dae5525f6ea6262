# SPDX-License-Identifier: Apache-2.0
"""The shares of clients and addresses, in a gateway with 16 entities: 4 and 8."""

import gc
import weakref
from typing import Any

import pytest

from gateway.config.limits import Limits
from gateway.core.entity_shares import EntityShares
from tests.core.conftest import FIBONACCI, STRING, TRIGGER, Bench, Socketless

KINDS = "of all kinds together: end one, or raise limits.max_ros_entities"
PER_CLIENT = ("limit_exceeded", f"at most 4 ROS entities per client, {KINDS}")
PER_ADDRESS = ("limit_exceeded", f"at most 8 ROS entities per address, {KINDS}")


@pytest.fixture
def full(bench: Bench) -> Bench:
    bench.router._shares = EntityShares(Limits(max_ros_entities=16), bench.router._shares._parts)
    return bench


def fill(client: Socketless, name: str) -> None:
    """Use one entity of each kind that a client opens. None is refused."""
    client.send(op="subscribe", topic=f"/{name}", type=STRING)
    client.send(op="advertise", topic=f"/{name}", type=STRING)
    client.send(op="advertise_service", service=f"/{name}_service", type=TRIGGER)
    client.send(op="advertise_action", action=f"/{name}_action", type=FIBONACCI)
    assert client.statuses == []


FURTHER: list[dict[str, Any]] = [
    {"op": "subscribe", "topic": "/more", "type": STRING},
    {"op": "subscribe", "topic": "/unknown"},
    {"op": "advertise", "topic": "/more", "type": STRING},
    {"op": "publish", "topic": "/more", "type": STRING, "msg": {}},
    {"op": "advertise_service", "service": "/more", "type": TRIGGER},
    {"op": "advertise_action", "action": "/more", "type": FIBONACCI},
]


@pytest.mark.parametrize("operation", FURTHER, ids=lambda each: each["op"])
async def test_a_client_has_a_quarter_of_all_entities(full: Bench, operation: dict[str, Any]):
    client = full.client()
    fill(client, "a")
    client.send(**operation)
    assert client.statuses == [PER_CLIENT]


async def test_a_goal_beyond_the_share_gets_its_result(full: Bench):
    full.ros.add_action_server("/count", FIBONACCI, lambda goal: None, lambda goal: None)
    client = full.client()
    fill(client, "a")
    client.send(op="send_action_goal", id="g", action="/count", args={})
    (result,) = client.of("action_result")
    assert result["values"] == PER_CLIENT[1]


async def test_an_address_has_half_of_all_entities(full: Bench):
    for name in "ab":
        fill(full.client("10.0.0.1"), name)
    third = full.client("10.0.0.1")
    third.send(op="subscribe", topic="/more", type=STRING)
    assert third.statuses == [PER_ADDRESS]
    fill(full.client("10.0.0.2"), "c")


async def test_a_shared_entity_counts_for_each_client_that_uses_it(full: Bench):
    first = full.client("10.0.0.1")
    second = full.client("10.0.0.2")
    for number in range(4):
        first.send(op="subscribe", topic=f"/t{number}", type=STRING)
        second.send(op="subscribe", topic=f"/t{number}", type=STRING)
    assert full.ros.entity_count() == 4
    full.router.leave(first.session)  # it has opened what the second client uses
    second.send(op="advertise", topic="/more", type=STRING)
    assert second.statuses == [PER_CLIENT]


async def test_an_entity_that_is_given_back_may_be_used_again(full: Bench):
    client = full.client()
    fill(client, "a")
    client.send(op="unsubscribe", topic="/a")
    client.send(op="subscribe", topic="/more", type=STRING)
    client.send(op="subscribe", topic="/more", type=STRING, id="again")  # the same entity
    assert client.statuses == []
    full.router.leave(client.session)
    for name in "bc":
        fill(full.client(), name)


async def test_of_a_client_that_has_left_nothing_is_kept(full: Bench):
    client = full.client()
    fill(client, "a")
    session = weakref.ref(client.session)
    full.router.leave(client.session)
    await full.settle()  # an unfinished operation may refer to it
    del client
    gc.collect()
    assert session() is None

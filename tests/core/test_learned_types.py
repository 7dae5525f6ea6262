# SPDX-License-Identifier: Apache-2.0
"""Which node is asked for which type, how often, and who hears of it."""

import asyncio
from collections.abc import Mapping
from typing import Any

import pytest

from gateway.core import learned_types
from gateway.core.learned_types import LOOK_S
from gateway.sources import node_definitions
from gateway.sources.node_definitions import TypeHolder, _Silence
from gateway.sources.services import ServiceRequest
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions
from schemas.type_hash import computed_type_hash, type_description
from tests.client import TIMEOUT_S, eventually
from tests.clock import StoppedClock
from tests.core.conftest import Bench

SERVICE_TYPE = "type_description_interfaces/srv/GetTypeDescription"
LAMP = "my_msgs/msg/Lamp"
NOT_KNOWN = f"type: no definition of {LAMP} is installed, and "
NO_LAMP = f"{NOT_KNOWN}a node that has it "
REMEDY = ": install its package, or name a folder that has the definition in types.paths"


class Node:
    """Another node that publishes its own types, and answers when the test says so."""

    def __init__(self, bench: Bench, name: str = "/lamp", *, has_service: bool = True) -> None:
        self.bench = bench
        self.name = name
        self.requests: list[ServiceRequest] = []
        if has_service:
            self.serve()

    def serve(self) -> None:
        service = f"{self.name}/get_type_description"
        self.bench.ros.add_service(service, SERVICE_TYPE, self.requests.append, self.name)

    def publish(self, topic: str, type_name: str, text: str = "bool on\n") -> Any:
        definitions = InstalledDefinitions().with_told(
            {type_name: parse_definition(type_name, text)}
        )
        definition = definitions.get(type_name)
        self.bench.ros.hashes[type_name] = computed_type_hash(definition, definitions)
        self.answer = {
            "successful": True,
            "type_description": type_description(definition, definitions),
            "type_sources": [
                {"type_name": type_name, "encoding": "msg", "raw_file_contents": text}
            ],
        }
        return self.bench.ros.add_publisher(topic, type_name, node=self.name)

    async def is_asked(self, times: int = 1) -> dict[str, Any]:
        """Wait for a request, and return it."""
        await eventually(lambda: len(self.requests) >= times)
        assert len(self.requests) == times
        return self.bench.types.service(SERVICE_TYPE).request.decode(self.requests[-1].cdr)

    def respond(self, answer: Mapping[str, Any] | None = None, number: int = -1) -> None:
        encode = self.bench.types.service(SERVICE_TYPE).response.encode
        self.requests[number].answer(encode(answer or self.answer, 0))


REFUSAL = {"successful": False, "failure_reason": "not mine"}


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    monkeypatch.setattr(learned_types, "LOOK_S", 0.01)


async def changes(bench: Bench) -> None:
    """Let the graph change, and wait until all has been looked at, and who is to be is asked."""
    publisher = bench.ros.add_publisher("/change", "std_msgs/msg/Empty")
    await looked(bench)
    publisher.close()
    await looked(bench)


async def looked(bench: Bench) -> None:
    learned = bench.router._learned
    await eventually(lambda: not bench.ros._is_changing and learned._looking is None)
    await bench.settle()


async def test_a_node_is_asked_as_soon_as_its_topic_appears(bench: Bench):
    node = Node(bench)
    node.publish("/lamp", LAMP, "# lit\nbool on\nuint8 RED=1\n")
    assert await node.is_asked() == {
        "type_name": LAMP,
        "type_hash": bench.ros.hashes[LAMP],
        "include_type_sources": True,
    }
    node.respond()
    await eventually(lambda: LAMP in bench.types.definitions.told)
    client = bench.sender(op="describe", id=1, type=LAMP)
    assert client.frames[-1]["definition"] == "# lit\nbool on\nuint8 RED=1\n"
    await changes(bench)
    await node.is_asked()  # no more


async def test_a_subscription_waits_for_the_definition(bench: Bench):
    node = Node(bench)
    publisher = node.publish("/lamp", LAMP)
    client = bench.sender(op="set_level", level="info")
    client.send(op="subscribe", topic="/lamp")
    text = f"topic /lamp: the definition of {LAMP} is being asked for, waiting for it"
    assert client.of("status")[-1]["msg"] == text
    client.send(op="publish", topic="/lamp", msg={})
    status = client.of("status")[-1]
    assert status["level"] == "error"
    text = f"type: the definition of {LAMP} is being asked for: try again in a moment"
    assert status["msg"] == text
    await node.is_asked()
    node.respond()
    await eventually(lambda: bool(bench.ros.subscriptions))
    publisher.publish(bench.cdr(LAMP, on=True))
    await client.sees(1)
    assert client.messages == [{"on": True}]


async def test_a_node_that_has_yet_to_introduce_itself_is_waited_for(bench: Bench):
    node = Node(bench)
    node.publish("/lamp", LAMP).close()
    nameless = bench.ros.add_publisher("/lamp", LAMP, node="")
    client = bench.sender(op="subscribe", topic="/lamp")
    await changes(bench)
    assert (client.frames, node.requests) == ([], [])
    nameless.close()
    node.publish("/lamp", LAMP)
    await node.is_asked()
    node.respond()
    await eventually(lambda: bool(bench.ros.subscriptions))
    assert client.frames == []


async def test_a_waiting_client_hears_once_why_the_definition_is_missing(bench: Bench, monkeypatch):
    monkeypatch.setattr(node_definitions, "PAUSE_S", 0.5)
    node = Node(bench)
    node.publish("/lamp", LAMP)
    client = bench.sender(op="subscribe", topic="/lamp")
    await node.is_asked()
    node.respond(REFUSAL)
    await client.sees(1, "status")
    assert client.statuses == [
        ("bad_type", f"{NO_LAMP}says: not mine{REMEDY}, waiting for /lamp to change")
    ]
    await node.is_asked(2)  # after a while
    node.respond(REFUSAL)
    await node.is_asked(3)
    assert len(client.statuses) == 1
    node.respond()
    await eventually(lambda: bool(bench.ros.subscriptions))


async def test_a_node_that_said_no_is_left_alone_for_a_while(bench: Bench):
    node = Node(bench)
    node.publish("/lamp", LAMP)
    await node.is_asked()
    node.respond(REFUSAL)
    for _ in range(3):
        await changes(bench)
    await node.is_asked()
    client = bench.sender(op="subscribe", topic="/lamp")
    assert client.statuses == [("bad_type", f"{NO_LAMP}says: not mine{REMEDY}")]


async def test_a_node_may_offer_the_service_later(bench: Bench, monkeypatch):
    monkeypatch.setattr(node_definitions, "STARTING_S", 0.05)
    node = Node(bench, has_service=False)
    node.publish("/lamp", LAMP)
    await changes(bench)
    client = bench.sender(op="describe", id=1, type=LAMP)
    assert client.statuses[-1][1] == f"{NO_LAMP}does not offer get_type_description{REMEDY}"
    node.serve()
    await node.is_asked()


async def test_another_node_is_asked_if_one_does_not_know(bench: Bench):
    first, second = Node(bench, "/first"), Node(bench, "/second")
    for node in (first, second):
        node.publish("/lamp", LAMP)
    await first.is_asked()
    first.respond({"successful": True})  # an empty description
    await second.is_asked()
    second.respond()
    await eventually(lambda: LAMP in bench.types.definitions.told)


async def test_of_many_nodes_with_a_type_three_are_asked(bench: Bench, monkeypatch):
    monkeypatch.setattr(learned_types, "LOOK_S", TIMEOUT_S)
    nodes = [Node(bench, f"/node{number}") for number in range(5)]
    for node in nodes:
        node.publish("/lamp", LAMP)
    for node in nodes[:3]:
        await node.is_asked()
        node.respond(REFUSAL)
    await eventually(lambda: bool(nodes[3].requests) or not bench.router._learned._asking)
    assert [len(node.requests) for node in nodes] == [1, 1, 1, 0, 0]


async def test_a_node_that_has_not_answered_yet_is_named_so(bench: Bench):
    node = Node(bench)
    node.publish("/lamp", LAMP)
    await node.is_asked()
    client = bench.sender(op="describe", id=1, type=LAMP)
    assert client.statuses[-1][1] == f"{NOT_KNOWN}it is being asked for{REMEDY}"


async def test_a_node_that_does_not_answer_in_time_is_named_so(bench: Bench, monkeypatch):
    monkeypatch.setattr(node_definitions, "ANSWER_S", 0.05)
    node = Node(bench)
    node.publish("/lamp", LAMP)
    client = bench.client()

    def said() -> str:
        client.send(op="describe", id=1, type=LAMP)
        return client.statuses[-1][1]

    await eventually(lambda: "has not answered" in said())
    assert said() == f"{NO_LAMP}has not answered within 5 s{REMEDY}"


async def test_a_node_that_does_not_answer_is_left_alone_for_all_its_types(
    bench: Bench, monkeypatch
):
    silent, good = Node(bench, "/a_silent"), Node(bench, "/good")
    for number in range(20):
        silent.publish(f"/a{number}", f"my_msgs/msg/Lamp{number}")
    await eventually(lambda: len(silent.requests) == node_definitions.ASKED_AT_ONCE)
    good.publish("/lamp", LAMP)
    loop = asyncio.get_running_loop()
    real_time = loop.time
    monkeypatch.setattr(loop, "time", lambda: real_time() + node_definitions.ANSWER_S)
    await good.is_asked()
    assert len(silent.requests) == node_definitions.ASKED_AT_ONCE


async def test_the_first_of_two_definitions_in_use_stays(bench: Bench):
    node, other = Node(bench, "/first"), Node(bench, "/other")
    node.publish("/a", LAMP)
    await node.is_asked()
    node.respond()
    await eventually(lambda: LAMP in bench.types.definitions.told)
    first, second = bench.ros.hashes[LAMP], f"RIHS01_{'1' * 64}"
    holders = {"/a": [TypeHolder(node.name, first)], "/b": [TypeHolder(other.name, second)]}
    bench.ros.told._holders_on = lambda topic, _: holders.get(topic, [])
    bench.ros.add_publisher("/b", LAMP, node=other.name)
    await changes(bench)
    assert other.requests == []
    holders["/a"] = []  # until the first has gone
    await changes(bench)
    await other.is_asked()


async def test_few_are_asked_at_once(bench: Bench):
    node = Node(bench)
    for number in range(10):
        node.publish(f"/lamp{number}", f"my_msgs/msg/Lamp{number}")
    await changes(bench)
    assert len(node.requests) == node_definitions.ASKED_AT_ONCE
    node.respond(REFUSAL, 0)
    await eventually(lambda: len(node.requests) == node_definitions.ASKED_AT_ONCE + 1)


async def test_the_memory_of_who_said_no_is_bounded(bench: Bench, monkeypatch):
    monkeypatch.setattr(node_definitions, "PAUSE_S", 600)
    silent = bench.ros.told._silent
    node = Node(bench)
    for number in range(2):
        node.publish(f"/lamp{number}", f"my_msgs/msg/Lamp{number}")
        await node.is_asked(number + 1)
        node.respond(REFUSAL)
        await eventually(lambda: bool(silent) and not bench.router._learned._asking)
        # others have said no since
        silent.update({TypeHolder(f"/other{each}", ""): _Silence(1e9, "") for each in range(1023)})
    assert len(silent) == 1024
    await changes(bench)
    await eventually(lambda: len(node.requests) >= 3)  # the first is forgotten


async def test_types_that_are_learned_within_20_ms_are_told_of_once(bench: Bench, monkeypatch):
    monkeypatch.setattr(learned_types.LearnedTypes, "_tell", lambda self: None)
    loop = asyncio.get_running_loop()
    node = Node(bench)
    node.publish("/lamp", LAMP)
    await node.is_asked()
    before_s = loop.time()
    node.respond(REFUSAL)
    await eventually(lambda: bench.router._learned._telling is not None)
    telling = bench.router._learned._telling
    assert telling is not None
    assert before_s + 0.02 <= telling.when() <= loop.time() + 0.02


async def test_types_that_are_installed_or_no_messages_are_not_asked_for(bench: Bench):
    node = Node(bench)
    bench.ros.hashes["std_msgs/msg/String"] = f"RIHS01_{'0' * 64}"  # of another version
    bench.ros.add_publisher("/string", "std_msgs/msg/String", node=node.name)
    node.publish("/act/_action/feedback", "my_msgs/action/Act_FeedbackMessage")
    await changes(bench)
    assert node.requests == []


async def test_nothing_is_left_of_what_was_under_way(bench: Bench, monkeypatch):
    monkeypatch.setattr(learned_types, "LOOK_S", 100)
    monkeypatch.setattr(learned_types, "_TOLD_S", 0)
    told: list[object] = []
    monkeypatch.setattr(learned_types.LearnedTypes, "_tell", lambda self: told.append(self))
    before = asyncio.all_tasks()
    node = Node(bench)
    node.publish("/lamp", LAMP)
    await node.is_asked()
    assert asyncio.all_tasks() > before
    bench.router.close()
    bench.ros.told.close()
    await bench.settle()
    assert asyncio.all_tasks() <= before
    assert bench.ros.entity_count() == 0
    assert told == []


async def test_the_topics_are_looked_at_once_a_second_while_the_graph_changes(
    bench: Bench, monkeypatch
):
    monkeypatch.setattr(learned_types, "LOOK_S", LOOK_S)
    clock = StoppedClock(monkeypatch)
    looks: list[None] = []
    topics = bench.ros.topics
    monkeypatch.setattr(bench.ros, "topics", lambda: looks.append(None) or topics())
    for _ in range(100):
        bench.router._learned.on_graph_change()
        await clock.advance(0.101)
    assert len(looks) == pytest.approx(10, abs=1)


async def test_a_node_that_said_no_is_asked_again_after_30_s(bench: Bench, monkeypatch):
    node = Node(bench)
    clock = StoppedClock(monkeypatch)
    node.publish("/lamp", LAMP)
    await clock.advance(0)
    node.respond({"successful": False, "failure_reason": "x" * 10_000})
    await clock.advance(0)
    client = bench.sender(op="subscribe", topic="/lamp")
    assert client.statuses[0][1].count("x") == 200  # of its words
    for _ in range(29):
        bench.router._learned.on_graph_change()
        await clock.advance(1)
    assert len(node.requests) == 1
    await clock.advance(2)
    await clock.advance(0)
    assert len(node.requests) == 2


async def test_a_node_without_the_service_is_looked_at_again_after_2_s(bench: Bench, monkeypatch):
    node = Node(bench, has_service=False)
    clock = StoppedClock(monkeypatch)
    node.publish("/lamp", LAMP)
    await clock.advance(0)
    node.serve()
    await clock.advance(1.9)
    assert node.requests == []
    await clock.advance(0.2)
    await clock.advance(0)
    assert len(node.requests) == 1


async def test_a_definition_that_a_source_carries_is_followed_once(bench: Bench, monkeypatch):
    carried = {LAMP: parse_definition(LAMP, "bool on\n")}

    async def definitions(type_name: str) -> Any:
        return carried if type_name in carried else None

    monkeypatch.setattr(bench.ros, "definitions", definitions)
    node = Node(bench)
    publisher = node.publish("/lamp", LAMP)
    client = bench.sender(op="subscribe", topic="/lamp")
    await eventually(lambda: len(bench.ros.subscriptions) == 1)
    publisher.publish(bench.cdr(LAMP, on=True))
    await client.sees(1)
    revision = bench.types.definitions.revision
    await changes(bench)
    assert bench.types.definitions.revision == revision
    assert node.requests == []
    assert client.messages == [{"on": True}]

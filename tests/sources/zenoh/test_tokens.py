# SPDX-License-Identifier: Apache-2.0
"""The graph of a robot from its tokens."""

import asyncio
import logging
import time
from types import SimpleNamespace

import pytest

from gateway.sources.source import Qos
from gateway.sources.zenoh import heard_publishers, token_changes, token_graph
from gateway.sources.zenoh.heard_publishers import (
    GRACE_S,
    MAX_GAP,
    MAX_PUBLISHERS,
    RECENT_S,
    SampleNumbers,
    UnlistedPublishers,
)
from gateway.sources.zenoh.keys import MAX_KEY_CHARACTERS, NO_TYPE_HASH, DataKey
from gateway.sources.zenoh.token_changes import (
    MAX_LEFT_OUT,
    MAX_TOKENS,
    TOKENS_PER_TURN,
    TokenChanges,
)
from gateway.sources.zenoh.token_graph import MAX_NAMED_FAULTS, MAX_OF_NAME, TokenGraph
from gateway.sources.zenoh.tokens import NodeToken, endpoint_token, gid_of
from tests.client import eventually
from tests.sources.zenoh.recordings import tokens


def graph_of(*names: str) -> TokenGraph:
    graph = TokenGraph("ours")
    for name in names:
        graph.apply(dict.fromkeys(tokens(name), True))
    return graph


def test_the_graph_of_the_recorded_robot_has_its_nodes_topics_and_services():
    graph = graph_of("1_talker").whole()
    assert graph.nodes == ("/talker",)
    topics = {each.name: (each.types, each.publishers) for each in graph.topics}
    assert topics["/rosout"] == (("rcl_interfaces/msg/Log",), ("/talker",))
    assert topics["/chatter"] == (("std_msgs/msg/String",), ("/talker",))
    services = {each.name: each.nodes for each in graph.services}
    assert services["/talker/get_type_description"] == ("/talker",)
    assert graph.actions == ()


def test_tokens_that_go_take_with_them_all_that_they_brought():
    graph = graph_of("1_talker", "3_listener_qos", "7_names")
    for name in ("1_talker", "3_listener_qos", "7_names"):
        graph.apply(dict.fromkeys(tokens(name), False))
        graph.apply(dict.fromkeys(tokens(name), False))
    whole = graph.whole()
    assert (whole.topics, whole.nodes, whole.services, graph.topics()) == ((), (), (), {})
    assert graph.topic_types("/chatter") == ()


def test_an_action_is_known_by_its_services():
    graph = TokenGraph("ours")
    node = NodeToken(0, "abc", 0, "/arm")
    key = DataKey(0, "/fib/_action/send_goal", "test_msgs/action/Fibonacci_SendGoal", NO_TYPE_HASH)
    graph.add(endpoint_token(node, 1, "SS", key, Qos(depth=10)))
    [action] = graph.whole().actions
    assert (action.name, action.types, action.nodes) == (
        "/fib",
        ("test_msgs/action/Fibonacci",),
        ("/arm",),
    )
    assert graph.action_types("/fib") == action.types
    assert graph.whole().services == ()
    assert graph.is_humble


def test_a_guard_with_hashes_does_not_hide_that_a_robot_is_of_humble():
    graph = TokenGraph("ours")
    for name, type_hash in (
        ("/robot", NO_TYPE_HASH),
        ("/_ros2_gateway_guard", f"RIHS01_{'0' * 64}"),
    ):
        key = DataKey(0, "/cmd_vel", "geometry_msgs/msg/Twist", type_hash)
        graph.add(endpoint_token(NodeToken(0, "abc", 0, name), 1, "MP", key, Qos(depth=10)))
    assert graph.is_humble


def test_tokens_that_cannot_be_read_are_left_out_and_some_are_named(caplog):
    graph = graph_of("1_talker")
    before = graph.whole()
    with caplog.at_level(logging.WARNING):
        graph.apply({f"@ros2_lv/46/{each}": True for each in range(100)})
    assert graph.whole() == before
    assert graph.unread == 100
    assert len(caplog.records) == MAX_NAMED_FAULTS == 8


def test_endpoints_of_one_name_beyond_a_limit_are_left_out_until_others_go(monkeypatch):
    assert MAX_OF_NAME == 1024
    monkeypatch.setattr(token_graph, "MAX_OF_NAME", 10)
    graph, node = TokenGraph("ours"), NodeToken(0, "abc", 0, "/robot")
    key = DataKey(0, "/count", "std_msgs/msg/Int32", NO_TYPE_HASH)
    texts = [endpoint_token(node, each, "MP", key, Qos(depth=10)) for each in range(30)]
    graph.apply(dict.fromkeys(texts, True))
    assert len(graph.offers("/count")) == 10
    assert graph.has_too_many
    assert all(graph.has_publisher(gid_of(each)) for each in texts)
    graph.apply(dict.fromkeys(texts[:9] + texts[20:], False))
    assert len(graph.offers("/count")) == 10
    graph.apply(dict.fromkeys(texts[9:11], False))
    assert len(graph.offers("/count")) == 9
    assert not graph.has_too_many


class Changes:
    def __init__(self) -> None:
        self.parts: list[dict[str, bool]] = []
        self.changes = TokenChanges(asyncio.get_running_loop(), self.parts.append)

    @property
    def all(self) -> dict[str, bool]:
        return {token: there for part in self.parts for token, there in part.items()}


async def test_changes_reach_the_loop_in_parts_and_the_last_of_each_token_counts():
    seen = Changes()
    for index in range(300):
        seen.changes.put(f"t{index}", True)
    seen.changes.put("t7", False)
    await eventually(lambda: len(seen.all) == 300)
    assert [len(part) for part in seen.parts] == [TOKENS_PER_TURN, 128, 44]
    assert [token for token, there in seen.all.items() if not there] == ["t7"]
    seen.changes.put("unknown", False)
    seen.changes.put("t8", False)
    await eventually(lambda: len(seen.parts) == 4)
    assert seen.parts[-1] == {"t8": False}
    seen.changes.close()


async def test_of_a_million_tokens_some_are_known_and_the_others_are_counted(monkeypatch):
    assert MAX_TOKENS == 32_768
    monkeypatch.setattr(token_changes, "MAX_TOKENS", 100)
    seen = Changes()
    for index in range(1000):
        seen.changes.put(f"t{index}", True)
    await eventually(lambda: len(seen.all) == 100)
    assert seen.changes.left_out == 900
    for index in range(1000):
        seen.changes.put(f"t{index}", False)
    await eventually(lambda: not any(seen.all.values()))
    assert seen.changes.left_out == 0
    seen.changes.put("later", True)
    await eventually(lambda: "later" in seen.all)
    seen.changes.close()


async def test_tokens_without_end_are_followed_no_more(monkeypatch):
    assert MAX_LEFT_OUT == 32_768
    monkeypatch.setattr(token_changes, "MAX_TOKENS", 10)
    monkeypatch.setattr(token_changes, "MAX_LEFT_OUT", 20)
    seen, ended = Changes(), []
    seen.changes.watch(lambda _: SimpleNamespace(undeclare=lambda: ended.append(True)))
    for index in range(30):
        seen.changes.put(f"t{index}", True)
    await eventually(lambda: len(seen.all) == 10)
    assert (seen.changes.has_stopped, ended) == (False, [])
    seen.changes.put("one more", True)
    await eventually(lambda: seen.changes.has_stopped)
    assert ended == [True]
    seen.changes.put("t1", False)  # on its way already
    await eventually(lambda: not seen.all["t1"])
    seen.changes.close()


async def test_one_token_again_and_again_is_not_left_out_for_good(monkeypatch):
    monkeypatch.setattr(token_changes, "MAX_TOKENS", 4)
    seen = Changes()
    seen.changes.watch(lambda _: SimpleNamespace(undeclare=lambda: None))
    for token in ("a", "b", "c", "d", *"x" * 9):
        seen.changes.put(token, True)
    await eventually(lambda: len(seen.all) == 4)
    for token in "abcdx":
        seen.changes.put(token, False)
    await eventually(lambda: not any(seen.all.values()))
    assert seen.changes.left_out == 0
    seen.changes.close()


async def test_a_token_that_is_too_long_is_kept_as_a_short_one():
    seen = Changes()
    seen.changes.put("t" * 1_000_000, True)
    await eventually(lambda: len(seen.all) == 1)
    assert [len(each) for each in seen.all] == [MAX_KEY_CHARACTERS + 1]
    seen.changes.close()


async def test_a_part_that_fails_delays_none_of_the_others():
    loop, seen = asyncio.get_running_loop(), Changes()
    errors: list[object] = []
    loop.set_exception_handler(lambda _, context: errors.append(context))

    def fail_once(changes: dict[str, bool]) -> None:
        seen.parts.append(changes)
        if len(seen.parts) == 1:
            raise ZeroDivisionError

    changes = TokenChanges(loop, fail_once)
    for index in range(2 * TOKENS_PER_TURN):
        changes.put(f"t{index}", True)
    await eventually(lambda: len(seen.parts) == 2)
    assert len(errors) == 1
    changes.close()


def test_only_forward_gaps_of_one_publisher_count_as_lost():
    numbers = SampleNumbers()
    for gid, number in ((b"a", 5), (b"b", 1), (b"a", 6), (b"a", 9), (b"b", 2), (b"a", 8)):
        numbers.note(gid, number)
    assert numbers.lost == 2
    numbers.note(b"a", 10)  # the one before was overtaken
    assert numbers.lost == 2


def test_an_absurd_number_counts_no_sample_as_lost():
    assert MAX_GAP == 1_000_000
    numbers = SampleNumbers()
    for number in (1, MAX_GAP + 2, 2**63 - 1, 5, MAX_GAP + 6):
        numbers.note(b"a", number)
    assert numbers.lost == 2 * MAX_GAP
    numbers.note(b"a", 2 * MAX_GAP + 8)
    assert numbers.lost == 2 * MAX_GAP


def test_publishers_beyond_a_limit_are_forgotten():
    assert MAX_PUBLISHERS == 1024
    numbers = SampleNumbers()
    unlisted = UnlistedPublishers(lambda _: False)
    for index in range(2000):
        numbers.note(index.to_bytes(2, "big"), 1)
        unlisted.hear(index.to_bytes(2, "big"))
    assert len(numbers._next) == len(unlisted._heard_s) == 1024


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now_s = [1000.0]

    class Clock:
        monotonic = staticmethod(lambda: now_s[0])

    assert time.monotonic() > 0
    monkeypatch.setattr(heard_publishers, "time", Clock)
    return now_s


def test_publishers_without_a_token_are_a_fault_after_a_while(clock):
    assert (RECENT_S, GRACE_S) == (5.0, 10.0)
    listed = {b"a"}
    unlisted = UnlistedPublishers(listed.__contains__)
    for gid in (b"a", b"b"):
        unlisted.hear(gid)
    assert unlisted.count() == 0
    clock[0] += 9.9
    unlisted.hear(b"b")
    assert unlisted.count() == 0
    clock[0] += 0.2
    assert unlisted.count() == 1
    clock[0] += 5.0  # it is silent now
    assert unlisted.count() == 0
    unlisted.hear(b"b")
    assert unlisted.count() == 0
    clock[0] += 10.1
    unlisted.hear(b"b")
    listed.add(b"b")
    assert unlisted.count() == 0

# SPDX-License-Identifier: Apache-2.0
"""A client that speaks only rosbridge's protocol gets a `status` only for what it was refused.

rosbridge sends none at all, and its clients take one for the answer to something else.
"""

import logging
from typing import Any

import pytest

from gateway.fronts.rosbridge.operations import rosbridge
from gateway.sources.source import Sample, TopicEvent
from tests.client import eventually
from tests.core.conftest import FIBONACCI, SET_BOOL, STRING, Bench, Socketless, open_bench

NOTHING: list[str] = []
REFUSED = ["status error"]
RESPONSE = ["service_response"]
RESULT = ["action_result"]

# each operation, good and bad, and all that it may be answered by
CONVERSATION: list[tuple[dict[str, Any], list[str]]] = [
    ({"op": "advertise", "topic": "/out", "type": STRING, "latch": True}, NOTHING),
    ({"op": "advertise", "topic": "/out", "type": "std_msgs/Bool"}, REFUSED),
    ({"op": "advertise", "topic": "/x", "type": "std_msgs/Strng"}, REFUSED),
    ({"op": "advertise", "topic": "/no/../name", "type": STRING}, REFUSED),
    ({"op": "publish", "topic": "/out", "msg": {"data": "x"}, "latch": False}, NOTHING),
    ({"op": "publish", "topic": "/out", "type": STRING, "msg": {"data": "x"}}, NOTHING),
    ({"op": "publish", "topic": "/out", "msg": {"date": "x"}}, REFUSED),
    ({"op": "publish", "topic": "/nobody", "msg": {}}, REFUSED),
    ({"op": "unadvertise", "topic": "/out", "id": "other"}, NOTHING),
    ({"op": "unadvertise", "topic": "/out"}, NOTHING),
    ({"op": "unadvertise", "topic": "/out"}, NOTHING),
    ({"op": "unadvertise", "topic": "/cmd_vel"}, NOTHING),
    ({"op": "unadvertise", "topic": "a b"}, REFUSED),
    ({"op": "subscribe", "topic": "/in", "throttle_rate": 10, "queue_length": 1}, NOTHING),
    ({"op": "subscribe", "topic": "/in", "compression": "zip"}, NOTHING),
    ({"op": "subscribe", "topic": "/to_come"}, NOTHING),
    ({"op": "subscribe", "topic": "/in", "throttle_rate": "10"}, REFUSED),
    ({"op": "subscribe"}, REFUSED),
    ({"op": "unsubscribe", "topic": "/in", "id": "other"}, NOTHING),
    ({"op": "unsubscribe", "topic": "/in"}, NOTHING),
    ({"op": "unsubscribe", "topic": "/in"}, NOTHING),
    ({"op": "unsubscribe", "topic": "/tf2_web_republisher/feedback"}, NOTHING),
    ({"op": "call_service", "service": "/arm", "args": {"data": True}}, RESPONSE),
    ({"op": "call_service", "service": "/arm", "args": {"data": "on"}}, RESPONSE),
    ({"op": "call_service", "service": "/arm", "type": "std_srvs/Trigger"}, RESPONSE),
    ({"op": "call_service", "service": "/nobody"}, RESPONSE),
    ({"op": "call_service", "service": "/rosapi/topics", "args": {"x": 1}}, RESPONSE),
    ({"op": "call_service", "args": {}}, RESPONSE),
    ({"op": "advertise_service", "service": "/own", "type": SET_BOOL}, NOTHING),
    ({"op": "advertise_service", "service": "/own", "type": "SetBol"}, REFUSED),
    ({"op": "service_response", "service": "/own", "id": "1", "result": True}, NOTHING),
    ({"op": "service_response", "service": "/nobody", "id": "1"}, NOTHING),
    ({"op": "service_response", "id": "1"}, REFUSED),
    ({"op": "unadvertise_service", "service": "/own"}, NOTHING),
    ({"op": "unadvertise_service", "service": "/own"}, NOTHING),
    ({"op": "send_action_goal", "action": "/fib", "args": {"order": "x"}}, RESULT),
    ({"op": "send_action_goal", "action": "/nobody", "feedback": True}, RESULT),
    ({"op": "send_action_goal"}, RESULT),
    ({"op": "cancel_action_goal", "action": "/fib", "id": "over"}, NOTHING),
    ({"op": "cancel_action_goal", "action": "/fib"}, REFUSED),
    ({"op": "advertise_action", "action": "/own", "type": FIBONACCI}, NOTHING),
    ({"op": "advertise_action", "action": "/own"}, REFUSED),
    ({"op": "action_feedback", "action": "/own", "id": "over", "values": {}}, NOTHING),
    ({"op": "action_feedback", "action": "/own"}, REFUSED),
    ({"op": "action_result", "action": "/own", "id": "over", "result": True}, NOTHING),
    ({"op": "action_result", "action": "/own"}, REFUSED),
    ({"op": "unadvertise_action", "action": "/own"}, NOTHING),
    ({"op": "unadvertise_action", "action": "/own"}, NOTHING),
    ({"op": "fragment", "id": "f", "num": 0, "total": 2, "data": "{"}, NOTHING),
    ({"op": "fragment", "id": "f", "num": 5, "total": 2, "data": "{"}, REFUSED),
    ({"op": "auth", "mac": "x", "client": "x", "dest": "x", "rand": "x", "t": 1}, NOTHING),
    ({"op": "set_level", "level": "loud"}, REFUSED),
    ({"op": "subcribe", "topic": "/in"}, REFUSED),
    ({"topic": "/in"}, REFUSED),
    ({"op": "set_level", "level": "none"}, NOTHING),
    ({"op": "subscribe"}, NOTHING),
]


def kinds(client: Socketless, count: int) -> list[str]:
    """Return what has come after the first frames, and of each `status` its level."""
    news = [frame for frame in client.frames[count:] if frame["op"] != "publish"]
    return [f"{each['op']} {each['level']}" if "level" in each else each["op"] for each in news]


async def test_each_operation_of_rosbridge_is_answered_as_its_clients_expect(bench: Bench):
    done = bench.cdr(f"{SET_BOOL}_Response", success=True)
    bench.ros.add_publisher("/in", STRING)
    bench.ros.add_service("/arm", SET_BOOL, lambda request: request.answer(done))
    bench.ros.add_action_server("/fib", FIBONACCI, lambda goal: None, lambda goal: None)
    client = bench.client(level=None)
    got = []
    for operation, expected in CONVERSATION:
        count = len(client.frames)
        client.send(**operation)
        if expected:
            await eventually(lambda count=count: kinds(client, count))
        await bench.settle()
        got.append((operation, kinds(client, count)))
    assert got == CONVERSATION
    assert {operation.get("op") for operation, _ in CONVERSATION} >= rosbridge.KEYS.keys()


async def happen(bench: Bench, client: Socketless) -> None:
    """Let all come to pass that a client may be warned of, though it was refused nothing."""
    client.send(op="subscribe", topic="/t", type=STRING)
    client.send(op="advertise", topic="/out", type=STRING)
    client.send(op="advertise_service", service="/own", type=SET_BOOL)
    client.send(op="advertise_action", action="/own", type=FIBONACCI)
    publisher = bench.ros.add_publisher("/t", STRING)
    for each in ("qos_incompatible", "type_conflict", "messages_lost", "deadline_missed"):
        bench.ros.subscriptions[0].on_event(TopicEvent(each, f"topic /t: {each}"))
    await bench.settle()
    bench.ros.arrive(publisher, Sample(b"\x00\x01\x00\x00\xff", 0))
    publisher.close()
    other = bench.sender(op="advertise_service", service="/own", type=SET_BOOL)
    other.send(op="advertise_action", action="/own", type=FIBONACCI)
    await bench.settle()


async def test_events_of_its_topics_go_only_to_a_client_that_asks(
    bench: Bench, caplog: pytest.LogCaptureFixture
):
    caplog.set_level(logging.INFO, "gateway.fronts.rosbridge.session")
    old = bench.client(level=None)
    await happen(bench, old)
    assert kinds(old, 0) == NOTHING
    logged = [record.args for record in caplog.records]
    async with open_bench() as another:
        new = another.client()
        await happen(another, new)
    told = [(frame["msg"],) for frame in new.of("status")]
    assert len(told) >= 7
    assert {frame["level"] for frame in new.of("status")} == {"warning"}
    assert sorted(logged) == sorted(told)  # the log has each one that is not sent


@pytest.mark.parametrize(
    "shown",
    [
        {"op": "ping"},
        {"op": "graph"},
        {"op": "subscribe", "topic": "/in", "type": STRING, "fields": ["data"]},
        {"op": "subscribe", "topic": "/in", "type": STRING, "feilds": ["data"]},
        {"op": "subscribe", "topic": "/in", "type": STRING, "throtle_rate": 1000},
        {"op": "call_service", "service": "/nobody", "nonfinite": "string"},
        {"op": "call_service", "service": "/nobody", "arg": "x"},
    ],
    ids=lambda operation: "-".join(map(str, operation)),
)
async def test_warnings_begin_with_what_rosbridge_does_not_know(bench: Bench, shown: Any):
    client = bench.client(level=None)
    client.send(op="subscribe", topic="/before")
    assert not client.statuses
    client.send(**shown)
    client.send(op="subscribe", id="after", topic="/after")
    assert client.of("status")[-1]["id"] == "after"
    assert client.of("status")[-1]["code"] == "not_found"


async def test_the_text_help_begins_them_too(bench: Bench):
    client = bench.client(level=None)
    client.send_raw(b"help")
    client.send(op="unsubscribe", topic="/t")
    assert client.of("status")[-1]["level"] == "warning"


@pytest.mark.parametrize("level", ["none", "error"])
async def test_a_level_that_was_chosen_stays(bench: Bench, level: str):
    client = bench.client(level=None)
    client.send(op="set_level", level=level)
    client.send(op="subscribe", topic="/t", feilds=[], fields=[])
    client.send(op="unsubscribe", topic="/never")
    assert kinds(client, 0) == NOTHING

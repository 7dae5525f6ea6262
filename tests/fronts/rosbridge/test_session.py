# SPDX-License-Identifier: Apache-2.0
import json
from collections.abc import Generator

import cbor2
import pytest

from gateway.codec.json import in_one_go
from gateway.config.limits import Limits
from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.fragments import MAX_AGE_NS
from gateway.fronts.rosbridge.operations.actions import SendActionGoal
from gateway.fronts.rosbridge.operations.gateway import Ping
from gateway.fronts.rosbridge.operations.services import CallService
from gateway.fronts.rosbridge.operations.topics import ImageRequest, QosRequest, Subscribe
from tests.core.conftest import lone_session
from tests.wire import unpacked, websocket_frames

ROS_SHARP_FRAGMENT_SIZE = 2**31 - 1  # int.MaxValue in C#

LIMITS = Limits(max_message_bytes=2000)


class Client:
    def __init__(self, limits: Limits = LIMITS) -> None:
        self.session = lone_session(limits)

    def send(self, now_ns=0, **operation):
        return self.session.receive(json.dumps(operation).encode(), now_ns)

    @property
    def wires(self):
        return self.session.outbox.take(1 << 30)

    @property
    def answers(self):
        return [answer for wire in self.wires for answer in unpacked(wire)]

    def send_in_pieces(self, operation, size=20, fragment_id="f"):
        text = operation if isinstance(operation, str) else json.dumps(operation)
        parts = [text[start : start + size] for start in range(0, len(text), size)]
        return [
            self.send(op="fragment", id=fragment_id, num=num, total=len(parts), data=part)
            for num, part in enumerate(parts)
        ]


def answer_to(**operation):
    client = Client()
    client.send(**operation)
    (answer,) = client.answers
    return answer


CALL = {"op": "call_service", "id": "c", "service": "set_bool"}
GOAL = {"op": "send_action_goal", "id": "g", "action": "fibonacci"}


def response(values, **members):
    return {
        "op": "service_response",
        "service": "set_bool",
        "values": values,
        "result": False,
        "id": "c",
    } | members


def result(values):
    return {
        "op": "action_result",
        "action": "fibonacci",
        "values": values,
        "status": 0,
        "result": False,
        "id": "g",
    }


def test_a_call_that_cannot_be_parsed_gets_its_response():
    client = Client()
    assert client.send(**CALL, timeout="soon") is None
    assert client.answers == [response("timeout: expected a number, got 'soon'")]
    assert client.session.refused == 1


def test_a_goal_that_cannot_be_parsed_gets_its_result():
    client = Client()
    assert client.send(**GOAL, feedback="yes") is None
    assert client.answers == [result("feedback: expected true or false, got 'yes'")]


@pytest.mark.parametrize(
    ("operation", "answer_op"),
    [
        (CALL | {"service": 7}, "service_response"),
        ({"op": "call_service", "id": "c"}, "service_response"),
        ({"op": "send_action_goal", "id": "c"}, "action_result"),
    ],
)
def test_an_operation_without_a_name_is_also_answered(operation, answer_op):
    answer = answer_to(**operation)
    assert (answer["op"], answer["id"], answer["result"]) == (answer_op, "c", False)


def test_json_is_read_within_the_limits_of_the_client():
    client = Client(Limits(max_json_depth=3, max_json_items=8))
    assert client.send(op="ping", value=[[1, 2, 3, 4]]) is not None
    client.send(op="ping", value=[[[1]]])
    client.send(op="ping", value=[[1, 2, 3, 4, 5, 6]])
    assert [answer["msg"] for answer in client.answers] == [
        "JSON nests deeper than 3 levels; raise limits.max_json_depth",
        "JSON has over 8 items; send fewer, or raise limits.max_json_items",
    ]


def test_the_queue_of_a_client_is_bounded_by_its_limit():
    assert Client(Limits(send_queue_bytes=100_000)).session.outbox.max_bytes == 100_000


def test_the_id_and_the_name_of_an_unknown_operation_come_back_truncated():
    answer = answer_to(op="x" * 300, id="y" * 300)
    assert answer["id"] == "y" * 256
    assert f"op: '{'x' * 125}...' is unknown" in answer["msg"]


def test_refusing_an_operation_answers_it_in_its_own_way():
    client = Client()
    error = ProtocolError("not_found", "no such thing")
    client.session.refuse(error, CallService(service="set_bool", id="c").request())
    client.session.refuse(error, SendActionGoal(action="fibonacci", id="g").request())
    client.session.refuse(error, Subscribe(topic="/t", id=3).request())
    client.session.refuse(error)
    call, goal, subscribe, nothing = client.answers
    assert (call, goal) == (response("no such thing"), result("no such thing"))
    status = {"op": "status", "level": "error", "msg": "no such thing", "code": "not_found"}
    assert subscribe == status | {"id": 3, "request": "subscribe"}
    assert nothing == status


def test_a_response_comes_whatever_the_level_of_status_frames():
    client = Client()
    client.session.set_level("none")
    client.send(**CALL, timeout="soon")
    client.send(op="no_such")
    assert [answer["op"] for answer in client.answers] == ["service_response"]


def test_ros_sharp_gets_an_object_that_it_can_read_as_the_response():
    client = Client()
    client.send(**CALL, fragment_size=ROS_SHARP_FRAGMENT_SIZE, timeout="soon")
    client.send(**CALL, timeout="soon")
    client.send(**GOAL, feedback="yes")
    assert client.answers == [response({}), response({}), result({})]


def test_ros_sharp_gets_ascii_from_its_first_such_operation_on():
    client, other = Client(), Client()
    text = "größe \U0001f916"
    for one in (client, other):
        one.session.answer("pong", 1, value=text)
    assert not client.wires[0].isascii()
    client.send(op="subscribe", topic="/t", fragment_size=ROS_SHARP_FRAGMENT_SIZE)
    other.send(op="subscribe", topic="/t", fragment_size=ROS_SHARP_FRAGMENT_SIZE - 1)
    for one in (client, other):
        one.session.answer("pong", 1, value=text)
    (frame,) = websocket_frames(client.wires[0])
    assert bytes(frame.data) == rb'{"op":"pong","id":1,"value":"gr\u00f6\u00dfe \ud83e\udd16"}'
    assert text.encode() in other.wires[1]


def test_a_request_to_a_provider_is_ascii_before_anything_tells_that_it_is_ros_sharp():
    client = Client()
    client.session.pass_cancel("/größe", "1")
    (frame,) = websocket_frames(client.wires[0])
    assert bytes(frame.data) == rb'{"op":"cancel_action_goal","id":"1","action":"/gr\u00f6\u00dfe"}'


def test_an_operation_with_nulls_is_carried_out():
    client = Client()
    goal = client.send(**GOAL, args=None, feedback=None, keep=None, fragment_size=0)
    assert goal == SendActionGoal(action="fibonacci", id="g")
    assert client.answers == []


def test_a_message_that_is_refused_is_answered_once_and_holds_up_no_other():
    client = Client(Limits(max_message_bytes=2000))
    for number in range(8):
        client.send_in_pieces("x" * 5000, size=1000, fragment_id=number)
    assert [answer["id"] for answer in client.answers] == list(range(8))
    assert client.send_in_pieces({"op": "ping", "value": "x" * 50})[-1] is not None


def test_an_answer_is_cut_only_where_that_is_asked_for():
    client = Client()
    payload = json.dumps({"op": "service_response", "values": "x" * 300}).encode()
    client.session.send(payload)
    client.session.send(payload, 100)
    client.session.send(payload, 100)
    whole, *pieces = client.answers
    assert whole == json.loads(payload)
    ids = {piece["id"] for piece in pieces}
    assert len(ids) == 2
    for one in ids:
        data = "".join(piece["data"] for piece in pieces if piece["id"] == one)
        assert data == payload.decode()


def test_an_operation_in_pieces_is_carried_out_as_if_it_had_come_whole():
    client = Client()
    *before, operation = client.send_in_pieces({"op": "ping", "id": "p", "value": "größe"})
    assert set(before) == {None}
    assert operation == Ping(id="p", value="größe")
    assert client.answers == []


def test_an_error_in_the_whole_is_answered_with_its_id():
    client = Client()
    client.send_in_pieces(CALL | {"timeout": "soon"}, size=40)
    client.send_in_pieces("no JSON at all", size=10)
    call, no_json = client.answers
    assert call["op"] == "service_response"
    assert call["id"] == "c"
    assert (no_json["code"], no_json.get("id")) == ("bad_json", None)


def test_a_fragment_within_a_fragment_is_refused():
    client = Client()
    inner = {"op": "fragment", "id": "inner", "num": 0, "total": 1, "data": "{}"}
    assert set(client.send_in_pieces(inner)) == {None}
    (answer,) = client.answers
    assert (answer["code"], answer["id"]) == ("bad_request", "inner")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"num": -1}, "num: expected at least 0"),
        ({"num": 1, "total": 1}, "num: 1, expected less than 1"),
        ({"total": 0}, "total: expected at least 1"),
        ({"total": 3.066666}, "total: expected an integer"),
        ({"data": 7}, "data: expected a string"),
        ({"data": "x" * 2001}, "data: 2001 bytes so far"),
    ],
)
def test_a_malformed_fragment_is_answered_with_its_id(wrong, words):
    client = Client(Limits(max_message_bytes=2000))
    fragment = {"op": "fragment", "id": "f", "num": 0, "total": 2, "data": "x"} | wrong
    assert client.send(**fragment) is None
    (answer,) = client.answers
    assert (answer["op"], answer["id"]) == ("status", "f")
    assert words in answer["msg"]


def test_a_fragment_without_an_id_is_refused():
    client = Client()
    client.send(op="fragment", num=0, total=1, data="{}")
    assert [answer["msg"] for answer in client.answers] == ["id: missing"]


def test_an_incomplete_message_is_answered_when_the_next_one_comes():
    client = Client()
    client.send(op="fragment", id="f", num=0, total=2, data="{")
    client.send(op="ping", now_ns=MAX_AGE_NS + 1)
    (answer,) = client.answers
    assert (answer["id"], answer["code"]) == ("f", "limit_exceeded")
    assert answer["msg"] == "fragment: 1 of 2 pieces came within 60 s"


@pytest.mark.parametrize("op", ["pong", "PING", "Ping"])
def test_an_unknown_operation_is_answered_with_the_nearest_in_capitals_too(op):
    answer = answer_to(op=op)
    assert answer["msg"] == f"op: {op!r} is unknown; did you mean ping?"


@pytest.mark.parametrize(
    ("operation", "text"),
    [
        ({"op": "set_parameters", "values": []}, "values: expected an object, got an array"),
        ({"op": "set_parameters", "values": {}}, "values: expected at least 1 item, got 0"),
        ({"op": "get_parameters", "names": ["a", 5]}, "names.1: expected a string, got 5"),
        ({"op": "subscribe", "topic": "/a", "fields": [5]}, "fields.0: expected a string, got 5"),
        (
            {"op": "subscribe", "topic": "/a", "fields": ["b"] * 65},
            "fields: expected at most 64 items, got 65",
        ),
        (
            {"op": "subscribe", "topic": "/a", "qos": {"depth": "x"}},
            "qos.depth: expected an integer, got 'x'",
        ),
        (
            {"op": "subscribe", "topic": "/a", "image": {"format": "gif"}},
            "image.format: expected 'jpeg', 'png' or 'raw', got 'gif'",
        ),
        (
            {"op": "subscribe", "topic": "/a", "image": {"format": 5}},
            "image.format: expected 'jpeg', 'png' or 'raw', got 5",
        ),
        (
            {"op": "subscribe", "topic": "/a", "qos": {"x" * 300: 1}},
            f"qos.{'x' * 121}...: unknown; known are {', '.join(QosRequest.model_fields)}",
        ),
        (
            {"op": "subscribe", "topic": "/a", "image": {"width": 640, "format": 5}},
            "image.width: unknown; did you mean max_width?",
        ),
        (
            {"op": "advertise", "topic": "/a", "type": "b", "image": {"format": "png", "fmt": 1}},
            "image.fmt: unknown; known are format",
        ),
        (
            {"op": "subscribe", "topic": "/a", "qos": {"deadline": {"sec": 1}}},
            "qos.deadline.sec: unknown; did you mean secs?",
        ),
        (
            {"op": "subscribe", "topic": "/a", "qos": {"lifespan": {"secs": -1}}},
            "qos.lifespan.secs: expected at least 0, got -1",
        ),
        (
            {"op": "subscribe", "topic": "/a", "qos": {"deadline": [1]}},
            "qos.deadline: expected a number or an object or 'infinite', got an array",
        ),
        (
            {"op": "lookup_transform", "target_frame": "a", "source_frame": "b"}
            | {"time": {"secs": 1, "nsec": 2}},
            "time.nsec: unknown; known are sec, nanosec",
        ),
        (
            {"op": "subscribe", "topic": "/a", "image": {"max_width": 2, "max_widht": 1}},
            f"image.max_widht: unknown; known are {', '.join(ImageRequest.model_fields)}",
        ),
        (
            {"op": "subscribe", "topic": "/a", "image": {"depth_range_m": [2, 1]}},
            "image.depth_range_m: expected [nearest, farthest], in metres, the nearest first",
        ),
    ],
)
def test_an_error_names_its_place(operation, text):
    answer = answer_to(
        **{"node": "/a"} | operation if "parameters" in operation["op"] else operation
    )
    assert answer["msg"] == text


def test_a_text_of_over_64_kib_is_read_in_slices():
    for size in (64 * 1024, 64 * 1024 + 1):
        text = b'{"op":"ping"}'.ljust(size)
        assert isinstance(Client().session.receive(text, 0), Generator) is (size > 64 * 1024)


@pytest.mark.parametrize("name", ["op", "type", "topic", "id"])
def test_a_long_text_is_refused_before_it_is_compared_with_what_is_known(name):
    for length in (4096, 4097):
        client = Client(Limits())
        operation = {"op": "subscribe", "topic": "/t", name: "x" * length}
        reading = client.session.receive(json.dumps(operation).encode().ljust(64 * 1024 + 1), 0)
        in_one_go(reading)
        text = f"{name}: 4097 characters, at most 4096 are allowed: send a shorter text"
        assert (text in [answer["msg"] for answer in client.answers]) is (length > 4096)
    client = Client(Limits())
    client.session.receive(cbor2.dumps(operation | {name: "x" * 70_000}), 0)
    (answer,) = client.answers
    assert answer["msg"].startswith(f"{name}: 70000 characters, at most 4096 are allowed")


def test_the_value_of_a_ping_may_be_long():
    client = Client(Limits())
    ping = json.dumps({"op": "ping", "value": "x" * 70_000}).encode()
    assert isinstance(in_one_go(client.session.receive(ping, 0)), Ping)

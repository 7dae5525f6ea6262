# SPDX-License-Identifier: Apache-2.0
"""Numbers on the wire, both ways, also those that JSON does not have."""

import asyncio
import base64
import json
import math
import struct

import cv2
import numpy as np
import pytest

from tests.core.conftest import SCAN, Bench

BASIC = "test_msgs/srv/BasicTypes"
NESTED = "test_msgs/action/NestedMessage"
RANGES = '[0.1,Infinity,-Infinity,NaN,"Infinity",null]'
ASKED = {
    None: [0.1, None, None, None, None, None],
    "null": [0.1, None, None, None, None, None],
    "string": [0.1, "Infinity", "-Infinity", "NaN", "Infinity", "NaN"],
}


def publish(text: str) -> bytes:
    return f'{{"op":"publish","topic":"/scan","type":"{SCAN}","msg":{text}}}'.encode()


def text_in(picture: str) -> bytes:
    pixels = cv2.imdecode(np.frombuffer(base64.b64decode(picture), np.uint8), cv2.IMREAD_COLOR)
    return cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB).tobytes()


async def scans(bench: Bench, text: str, **options: object) -> list[bytes]:
    """Return the wire bytes that a subscriber gets of one message of another client."""
    listener, talker = bench.client(), bench.client()
    listener.send(op="subscribe", topic="/scan", type=SCAN, **options)
    await bench.settle()
    talker.send_raw(publish(text))
    await asyncio.wait_for(listener.sees(1), 10)
    assert not talker.statuses
    return listener.wires


@pytest.mark.parametrize("form", ASKED)
async def test_infinities_come_in_the_form_that_a_subscriber_asks_for(bench: Bench, form):
    wires = await scans(bench, f'{{"range_max":Infinity,"ranges":{RANGES}}}', nonfinite=form)
    msg = json.loads(wires[-1][wires[-1].index(b"{") :])["msg"]
    assert msg["ranges"] == ASKED[form]
    assert msg["range_max"] == (None if form in {None, "null"} else "Infinity")


async def test_tokens_are_what_python_reads(bench: Bench):
    (wire,) = await scans(bench, f'{{"ranges":{RANGES}}}', nonfinite="token")
    assert b'"ranges":[0.1,Infinity,-Infinity,NaN,Infinity,NaN]' in wire
    assert json.loads(wire[wire.index(b"{") :])["msg"]["ranges"][1] == math.inf


@pytest.mark.parametrize("form", ["string", "token"])
async def test_a_client_can_send_back_the_values_that_it_gets(bench: Bench, form):
    (wire,) = await scans(bench, f'{{"range_min":-Infinity,"ranges":{RANGES}}}', nonfinite=form)
    msg = wire[wire.index(b'"msg":') + 6 : -1].decode()
    listener, talker = bench.client(), bench.client()
    listener.send(op="subscribe", topic="/scan", type=SCAN, nonfinite=form, queue_length=1)
    await bench.settle()
    talker.send_raw(publish(msg))
    await listener.sees(1)
    assert listener.wires[-1].endswith(f'"msg":{msg}}}'.encode())


async def test_cbor_has_its_own_infinities(bench: Bench):
    (wire,) = await scans(bench, '{"range_max":Infinity}', compression="cbor", nonfinite="string")
    assert b"\xfb" + struct.pack(">d", math.inf) in wire
    assert b"Infinity" not in wire


async def test_png_has_them_in_its_text(bench: Bench):
    listener = bench.client()
    options = {"compression": "png", "nonfinite": "string"}
    listener.send(op="subscribe", topic="/scan", type=SCAN, **options)
    await bench.settle()
    bench.client().send_raw(publish('{"range_max":Infinity}'))
    (frame,) = await listener.sees(1, "png")
    assert b'"range_max":"Infinity"' in text_in(frame["data"])


async def test_the_newest_request_that_names_a_form_decides(bench: Bench):
    listener, talker = bench.client(), bench.client()
    for request, form in (("a", "token"), ("b", "string"), ("c", None)):
        listener.send(op="subscribe", id=request, topic="/scan", type=SCAN, nonfinite=form)
    await bench.settle()
    talker.send_raw(publish('{"range_max":Infinity}'))
    await listener.sees(1)
    assert listener.messages[0]["range_max"] == "Infinity"


async def test_an_unknown_form_is_refused(bench: Bench):
    client = bench.sender(op="subscribe", topic="/scan", nonfinite="nan")
    assert client.statuses[0][0] == "bad_request"
    assert client.statuses[0][1].startswith("nonfinite: expected 'null', 'string' or 'token'")


@pytest.mark.parametrize("token", ["NaN", "Infinity", "-Infinity"])
async def test_a_number_of_an_operation_itself_must_be_finite(bench: Bench, token):
    client = bench.client()
    client.send_raw(f'{{"op":"subscribe","topic":"/t","throttle_rate":{token}}}'.encode())
    client.send_raw(f'{{"op":"call_service","service":"/s","timeout":{token}}}'.encode())
    assert client.statuses == [
        ("bad_request", f"throttle_rate: expected a finite number, got {token}")
    ]
    (answer,) = client.of("service_response")
    assert answer["values"] == f"timeout: expected a finite number, got {token}"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('{"header":{"stamp":{"sec":NaN}}}', "msg.header.stamp.sec: expected an integer, got NaN"),
        ('{"header":{"stamp":{"sec":1.5}}}', "msg.header.stamp.sec: expected an integer, got 1.5"),
        ('{"header":{"frame_id":NaN}}', "msg.header.frame_id: expected a string, got NaN"),
        ('{"ranges":[1,"nan"]}', "msg.ranges[1]: expected a number, got a string"),
    ],
)
async def test_nonfinite_numbers_outside_of_floats_are_refused_with_the_path(
    bench: Bench, text, reason
):
    client = bench.client()
    client.send_raw(publish(text))
    assert client.statuses == [("invalid_value", reason)]


async def test_a_stamp_of_0_is_relayed_and_no_stamp_is_now(bench: Bench):
    (wire,) = await scans(bench, '{"header":{"stamp":{"sec":0,"nanosec":0}}}')
    assert b'"stamp":{"sec":0,"nanosec":0}' in wire
    (wire,) = await scans(bench, '{"header":{"stamp":{"sec":0.0,"nanosec":1e3}}}')
    assert b'"stamp":{"sec":0,"nanosec":1000}' in wire


async def test_a_stamp_is_an_object_or_now(bench: Bench):
    client = bench.client()
    client.send_raw(publish('{"header":{"stamp":0}}'))
    assert client.statuses == [("invalid_value", "msg.header.stamp: expected an object, got 0")]


async def test_responses_have_the_form_that_the_call_asks_for(bench: Bench):
    def answer(request):
        values = {"float32_value": math.inf, "float64_value": -math.inf}
        request.answer(bench.cdr(f"{BASIC}_Response", **values))

    bench.ros.add_service("/basic", BASIC, answer).on_request = answer
    client = bench.client()
    for form in ("null", "string"):
        client.send(op="call_service", service="/basic", id=form, nonfinite=form)
    null, string = await client.sees(2, "service_response")
    assert (null["values"]["float32_value"], null["values"]["float64_value"]) == (None, None)
    assert string["values"]["float32_value"] == "Infinity"
    assert string["values"]["float64_value"] == "-Infinity"


async def test_feedback_and_results_have_the_form_that_the_goal_asks_for(bench: Bench):
    server, client = bench.client(), bench.client()
    server.send(op="advertise_action", action="/nest", type=NESTED)
    await bench.settle()
    goal = {"op": "send_action_goal", "action": "/nest", "id": "g", "feedback": True}
    client.send(**goal, nonfinite="string", action_type=NESTED)
    (sent,) = await server.sees(1, "send_action_goal")
    values = {"nested_field": {"float64_value": "Infinity"}}
    about = {"action": "/nest", "id": sent["id"], "values": values}
    server.send(op="action_feedback", **about)
    (feedback,) = await client.sees(1, "action_feedback")
    server.send(op="action_result", **about, status=4)
    (result,) = await client.sees(1, "action_result")
    for frame in (feedback, result):
        assert frame["values"]["nested_field"]["float64_value"] == "Infinity"


async def test_ping_repeats_what_is_not_finite_as_null(bench: Bench):
    client = bench.client()
    client.send_raw(b'{"op":"ping","value":[NaN,1,Infinity]}')
    (pong,) = client.of("pong")
    assert pong["value"] == [None, 1, None]

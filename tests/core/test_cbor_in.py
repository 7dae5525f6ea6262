# SPDX-License-Identifier: Apache-2.0
"""Operations in CBOR: the same as in JSON, with octets as they are."""

import base64

import cbor2
import numpy as np
import pytest

from tests.core.conftest import SCAN, Bench, Socketless

OCTETS = "std_msgs/msg/UInt8MultiArray"


def send(client: Socketless, **operation: object) -> None:
    client.send_raw(cbor2.dumps(operation))


def ranges(numbers: np.ndarray) -> cbor2.CBORTag:
    return cbor2.CBORTag(85, numbers.astype("<f4").tobytes())  # RFC 8746: float32, little-endian


async def heard(bench: Bench, topic: str, type_name: str, msg: object) -> bytes:
    """Return the frame that a subscriber gets of another client's message, all in CBOR."""
    listener, talker = bench.client(), bench.client()
    send(listener, op="subscribe", topic=topic, type=type_name, compression="cbor")
    await bench.settle()
    send(talker, op="publish", topic=topic, type=type_name, msg=msg)
    await bench.settle()
    assert not talker.statuses
    return listener.wires[-1]


async def test_a_message_goes_in_as_it_comes_out(bench: Bench):
    numbers = np.array([0.5, np.inf, np.nan], np.float32)
    wire = await heard(bench, "/scan", SCAN, {"ranges": ranges(numbers), "range_max": 2.5})
    sent = cbor2.loads(wire[wire.index(b"\xa3") :])["msg"]
    assert sent["ranges"].value == numbers.tobytes()
    assert sent["range_max"] == 2.5
    assert await heard(bench, "/again", SCAN, sent)  # fits as it is


async def test_octets_need_no_base64(bench: Bench):
    octets = bytes(range(256))
    wire = await heard(bench, "/octets", OCTETS, {"data": octets})
    assert cbor2.loads(wire[wire.index(b"\xa3") :])["msg"]["data"] == octets


async def test_octets_where_a_text_belongs_are_refused_in_words(bench: Bench):
    client = bench.client()
    send(client, op="publish", topic="/s", type="std_msgs/String", msg={"data": b"octets"}, id=1)
    assert client.statuses == [("invalid_value", "msg.data: expected a string, got a byte string")]
    send(client, op="subscribe", topic=b"/odom", id=2)
    assert client.frames[-1]["id"] == 2
    assert client.statuses[-1] == ("bad_request", "topic: expected a string, got a byte string")


async def test_ping_returns_octets_as_base64(bench: Bench):
    client = bench.client()
    send(client, op="ping", value=[b"octets", ranges(np.array([0.5]))])
    (pong,) = client.of("pong")
    assert pong["value"] == [base64.b64encode(b"octets").decode(), [0.5]]


async def test_a_service_is_called_in_cbor(bench: Bench):
    client = bench.client()
    send(client, op="call_service", service="/rosapi/topic_type", args={"topic": "/odom"}, id=b"x")
    (refusal,) = client.of("service_response")
    assert refusal["values"].startswith("id: expected a string")
    send(client, op="call_service", service="/rosapi/topics", id=7)
    await client.sees_id(7)
    assert client.of("service_response")[-1]["result"] is True


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"\xa1\x62op", "frame is not CBOR that can be taken: it ends where an item is missing"),
        (b"\xbf\xff", "an item of indefinite length"),
        (b"\xa1\x62op\x01", "op: expected a string"),
        (b"\xa0", "op: missing"),
        (b"\xa1\x61v" + b"\x81" * 40 + b"\x01", "frame nests deeper than 32 levels"),
        (b"\x81\x01", "frame is not UTF-8 at offset 0: CBOR must begin with a map"),
    ],
)
async def test_invalid_cbor_is_refused_with_the_reason(bench: Bench, data, words):
    client = bench.client()
    client.send_raw(data)
    ((code, text),) = client.statuses
    assert words in text
    assert code == ("bad_request" if text.startswith("op") else "bad_json")

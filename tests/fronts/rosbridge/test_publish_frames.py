# SPDX-License-Identifier: Apache-2.0
import json

import cbor2
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from websockets.frames import Frame, Opcode

from gateway.codec import cbor
from gateway.codec.chunks import Chunks
from gateway.core.frames import Meta, PerClient, PublishFrames
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.transport.websocket_frames import BINARY, header, text_frame
from tests.wire import unpacked, websocket_frames

META = Meta(seq=7, received_ns=12_000_000_034, size=9, dropped=2)
META_MEMBERS = {"seq": 7, "received": {"sec": 12, "nanosec": 34}, "size": 9, "dropped": 2}
PUBLISH = {"op": "publish", "topic": "/odom", "msg": {"x": 1}}
BODIES = {"none": b'{"x":1}', "cbor": cbor.dumps({"x": 1}), "cbor-raw": cbor.dumps({"x": 1})}


def frames_of(compression: str, topic: str = "/odom") -> PublishFrames:
    return RosbridgeFraming.of(compression).frames(topic)


def own(meta: Meta | None = None, fragment_size: int | None = None, **more: bool) -> PerClient:
    return PerClient(7, RosbridgeFraming.of(fragment_size=fragment_size), meta, **more)


@pytest.mark.parametrize("compression", BODIES)
def test_the_message_stands_in_a_publish_frame(compression):
    body = BODIES[compression]
    assert unpacked(frames_of(compression).shared(body)) == [PUBLISH]
    assert unpacked(frames_of(compression).per_client(body, own())) == [PUBLISH]


@pytest.mark.parametrize("compression", [*BODIES, "png"])
@pytest.mark.parametrize("length", [0, 1, 90, 200, 70_000])
def test_the_message_can_be_taken_out_of_its_frame(compression, length):
    body = b"{" * length
    frames = frames_of(compression)
    assert frames.message(frames.shared(body)) == body


@pytest.mark.parametrize("compression", [*BODIES, "png"])
@pytest.mark.parametrize("length", [90, 70_000])
@pytest.mark.parametrize("asked", [None, own(), own(META), own(None, 99)])
def test_a_message_in_pieces_has_the_frame_of_a_whole_one(compression, length, asked):
    body = b"x" * length
    frames = frames_of(compression)
    pieces = Chunks.of([body[:7], memoryview(body)[7:]])
    if asked is None:
        assert bytes(frames.shared_chunks(pieces)) == frames.shared(body)
    else:
        assert bytes(frames.per_client_chunks(pieces, asked)) == frames.per_client(body, asked)


def test_json_in_pieces_is_escaped_where_that_is_asked_for():
    frames = frames_of("none", "/ödom")
    escaping = own(META, is_ascii=True)
    pieces = [b'{"text":"', "ü".encode(), b'"}']
    escaped = bytes(frames.per_client_chunks(Chunks.of(pieces), escaping))
    assert escaped == frames.per_client(b"".join(pieces), escaping)


@pytest.mark.parametrize("compression", BODIES)
def test_meta_comes_before_the_message(compression):
    wire = frames_of(compression).per_client(BODIES[compression], own(META))
    (frame,) = unpacked(wire)
    assert frame == PUBLISH | META_MEMBERS
    assert list(frame)[-1] == "msg"


@pytest.mark.parametrize(
    ("compression", "opcode"),
    [
        ("none", Opcode.TEXT),
        ("png", Opcode.TEXT),
        ("cbor", Opcode.BINARY),
        ("cbor-raw", Opcode.BINARY),
    ],
)
def test_only_cbor_comes_in_binary_frames(compression, opcode):
    (frame,) = websocket_frames(frames_of(compression).shared(b"\xa0"))
    assert frame.opcode is opcode


def test_a_picture_of_text_has_meta_next_to_it():
    png = frames_of("png")
    assert unpacked(png.shared(b"iVBO")) == [{"op": "png", "data": "iVBO"}]
    assert unpacked(png.per_client(b"iVBO", own(META))) == [
        {"op": "png", "data": "iVBO", **META_MEMBERS}
    ]


@pytest.mark.parametrize("compression", ["none", "png"])
def test_text_is_cut_where_that_is_asked_for(compression):
    body = b'"' + b"x" * 500 + b'"' if compression == "none" else b"x" * 500
    wire = frames_of(compression).per_client(body, own(META, 100))
    pieces = unpacked(wire)
    assert {piece["id"] for piece in pieces} == {"publish:/odom:7"}
    whole = json.loads("".join(piece["data"] for piece in pieces))
    assert whole["seq"] == 7
    assert "x" * 500 in whole.values()


@pytest.mark.parametrize("compression", ["cbor", "cbor-raw"])
def test_binary_frames_are_never_cut_or_escaped(compression):
    body = cbor.dumps({"text": "ü" * 300})
    wire = frames_of(compression).per_client(body, own(None, 64, is_ascii=True))
    (frame,) = websocket_frames(wire)
    assert cbor2.loads(frame.data)["msg"] == {"text": "ü" * 300}


def test_json_is_escaped_where_that_is_asked_for():
    body = '{"text":"ü\U0001f916"}'.encode()
    (frame,) = websocket_frames(frames_of("none", "/odom").per_client(body, own(is_ascii=True)))
    assert bytes(frame.data).isascii()
    assert json.loads(bytes(frame.data))["msg"] == {"text": "ü\U0001f916"}


@example(125)
@example(126)
@example(65_535)
@example(65_536)
@given(st.one_of(st.integers(0, 300), st.integers(65_500, 65_600)))
def test_frames_are_what_websockets_would_send(length):
    payload = b"x" * length
    assert text_frame(payload) == Frame(Opcode.TEXT, payload).serialize(mask=False)
    binary = header(BINARY, length) + payload
    assert binary == Frame(Opcode.BINARY, payload).serialize(mask=False)

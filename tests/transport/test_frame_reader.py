# SPDX-License-Identifier: Apache-2.0
"""Input is read as `websockets` reads it, in pieces of any size and with any mistake."""

import struct
from collections.abc import Callable, Sequence
from itertools import pairwise

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from websockets.frames import Frame, Opcode
from websockets.http11 import Request
from websockets.protocol import OPEN, Event
from websockets.server import ServerProtocol

from gateway.transport.frame_reader import FrameReader, MessageAssembly
from gateway.transport.http import new_protocol
from gateway.transport.inbound import CHUNK_BYTES

REQUEST = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
)
MAX_BYTES = 300
# sizes at which the head of a frame changes, or a message is too large
SIZES = (0, 1, 5, 125, 126, MAX_BYTES, MAX_BYTES + 1, 65_535, 65_536)


def frame(
    first: int, payload: bytes, *, is_masked: bool = True, length_bytes: int | None = None
) -> bytes:
    """Return a frame as it is sent. Its length takes 0, 2 or 8 bytes more, or as few as can be."""
    size = len(payload)
    if length_bytes is None:
        length_bytes = 0 if size < 126 else 2 if size < 1 << 16 else 8
    second = {0: min(size, 125), 2: 126, 8: 127}[length_bytes]
    length = {0: b"", 2: struct.pack(">H", size & 0xFFFF), 8: struct.pack(">Q", size)}[length_bytes]
    mask = b"mask" if is_masked else b""
    return bytes([first, second | (0x80 if is_masked else 0)]) + length + mask + payload


def digits(size: int) -> bytes:
    return (b"0123456789" * (size // 10 + 1))[:size]


TEXT = frame(0x81, b"whole")
BEGUN, ENDED = frame(0x01, b"begun"), frame(0x80, b"ended")
PING, CLOSE = frame(0x89, b""), frame(0x88, b"")

CONVERSATION = TEXT + BEGUN + PING + ENDED + TEXT + frame(0x82, digits(126))

payloads = st.one_of(st.sampled_from(SIZES).map(digits), st.just(TEXT))
messages = st.builds(frame, st.sampled_from([0x81, 0x82]), payloads)
others = st.builds(
    frame,
    st.one_of(st.sampled_from([0x01, 0x02, 0x00, 0x80, 0x89, 0x8A, 0x88]), st.integers(0, 255)),
    payloads,
    is_masked=st.sampled_from([True, True, True, False]),
    length_bytes=st.sampled_from([None, None, None, 0, 2, 8]),
)
streams = st.lists(st.one_of(messages, st.sampled_from([TEXT, BEGUN, ENDED, PING]), others))


def opened(max_bytes: int = MAX_BYTES) -> ServerProtocol:
    protocol = new_protocol(max_bytes, lambda _: None)
    protocol.receive_data(REQUEST)
    (request,) = protocol.events_received()
    assert isinstance(request, Request)
    protocol.send_response(protocol.accept(request))
    assert protocol.state is OPEN
    protocol.data_to_send()
    return protocol


class Alone:
    """What `websockets` reads."""

    def __init__(self, protocol: ServerProtocol) -> None:
        self._protocol = protocol

    def read(self, data: bytes) -> Sequence[Event]:
        self._protocol.receive_data(data)
        return self._protocol.events_received()


def seen(event: Event) -> tuple[Opcode, bytes, bool]:
    assert isinstance(event, Frame)
    assert type(event.opcode) is Opcode
    return event.opcode, bytes(event.data), event.fin


def read(
    new: Callable[[ServerProtocol], Alone | FrameReader], *pieces: bytes, closed_before: int = -1
) -> tuple[object, ...]:
    """Return all that comes of a stream, which may be closed from here before one of its pieces."""
    protocol = opened()
    reader = new(protocol)
    frames = []
    for number, piece in enumerate(pieces):
        if number == closed_before:
            protocol.send_close(1000)
        frames += map(seen, reader.read(piece))
    return frames, protocol.state, protocol.data_to_send(), repr(protocol.parser_exc)


@given(streams, st.lists(st.integers(0, 1 << 20), max_size=5))
@example([TEXT, TEXT], [len(TEXT) - 1])
@example([frame(0x81, TEXT), TEXT], [6])  # a message that contains another
@example([TEXT, CLOSE, TEXT], [len(TEXT + CLOSE)])
@example([BEGUN, TEXT, ENDED], [len(BEGUN)])
@example([BEGUN, PING, TEXT], [len(BEGUN), len(BEGUN + PING)])
@example([frame(0x81, digits(5), length_bytes=8), TEXT], [len(TEXT) + 8])
@example([TEXT, frame(0xC1, b"compressed"), TEXT], [len(TEXT)])
@example([frame(0x81, digits(100), is_masked=False)], [])
@example([frame(0x82, digits(MAX_BYTES)), frame(0x82, digits(MAX_BYTES + 1))], [])
def test_any_stream_in_any_pieces_is_read_as_by_websockets(frames: list[bytes], cuts: list[int]):
    stream = b"".join(frames) + TEXT  # so that it ends in no head
    places = [0, *sorted(cut % (len(stream) + 1) for cut in cuts), len(stream)]
    pieces = [stream[start:end] for start, end in pairwise(places)]
    assert read(FrameReader, *pieces) == read(Alone, stream)


@pytest.mark.parametrize("end", range(len(CONVERSATION)))
def test_input_while_closing_is_read_as_by_websockets(end: int):
    pieces = CONVERSATION[:end], CONVERSATION[end:] + CLOSE + TEXT
    ours = read(FrameReader, *pieces, closed_before=1)
    assert ours == read(Alone, *pieces, closed_before=1)


class Counted:
    """The input of `websockets`."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.protocol = opened(1 << 20)
        self.reader = FrameReader(self.protocol)
        self.given: list[bytes] = []
        receive = self.protocol.receive_data
        monkeypatch.setattr(self.protocol, "receive_data", lambda data: self._note(receive, data))

    def _note(self, receive, data: bytes) -> None:
        self.given.append(data)
        receive(data)

    def passed_on(self, data: bytes) -> list[bytes]:
        """Read *data*. Return what of it was left to `websockets`."""
        self.given.clear()
        self.reader.read(data)
        return self.given.copy()


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Counted:
    return Counted(monkeypatch)


def test_whole_messages_are_not_left_to_websockets(counted: Counted):
    plain = TEXT + frame(0x82, digits(MAX_BYTES)) + frame(0x81, b"")
    assert counted.passed_on(plain) == []
    assert counted.passed_on(plain + PING) == [PING]
    assert counted.passed_on(plain) == []


@pytest.mark.parametrize("size", SIZES)
def test_after_a_message_in_two_reads_the_next_is_not_left_to_it_either(counted: Counted, size):
    message = frame(0x82, digits(size))
    begin, end = message[:-1], message[-1:]
    assert counted.passed_on(TEXT + begin) == [begin]
    assert counted.passed_on(end) == [end]
    assert counted.passed_on(TEXT) == []


def test_after_a_message_in_several_frames_the_next_is_not_left_to_it_either(counted: Counted):
    assert counted.passed_on(BEGUN) == [BEGUN]
    assert counted.passed_on(ENDED) == [ENDED]
    assert counted.passed_on(TEXT) == []


def test_after_a_length_in_more_bytes_than_it_needs_the_next_is_not_left_to_it_either(counted):
    odd = frame(0x82, b"hello", length_bytes=8)
    assert counted.passed_on(odd + TEXT) == [odd]
    assert counted.passed_on(TEXT) == []


@pytest.mark.parametrize("size", [1, 60, 120, 700])
def test_only_frames_that_a_piece_cuts_are_left_to_websockets(counted: Counted, size: int):
    message = frame(0x81, digits(size))
    backlog = message * 1000
    for start in range(0, len(backlog), CHUNK_BYTES):
        given = counted.passed_on(backlog[start : start + CHUNK_BYTES])
        assert sum(map(len, given)) < 2 * len(message)


def test_a_whole_message_is_passed_on_with_its_kind():
    assembly = MessageAssembly()
    assert assembly.add(Frame(Opcode.TEXT, b"text")) == b"text"
    assert assembly.is_text
    assert assembly.add(Frame(Opcode.BINARY, b"octets")) == b"octets"
    assert not assembly.is_text


def test_fragments_are_joined_and_the_first_says_their_kind():
    assembly = MessageAssembly()
    assert assembly.add(Frame(Opcode.TEXT, b"a", fin=False)) is None
    assert assembly.add(Frame(Opcode.CONT, b"b", fin=False)) is None
    assert assembly.add(Frame(Opcode.CONT, b"c")) == b"abc"
    assert assembly.is_text
    assert assembly.add(Frame(Opcode.BINARY, b"", fin=False)) is None
    assert assembly.add(Frame(Opcode.CONT, b"d")) == b"d"
    assert not assembly.is_text


def test_a_whole_message_that_is_taken_ahead_leaves_the_fragments_around_it_as_they_are():
    assembly = MessageAssembly()
    assert assembly.add(Frame(Opcode.BINARY, b"a", fin=False)) is None
    assert assembly.add(Frame(Opcode.TEXT, b"text")) == b"text"
    assert assembly.is_text
    assert assembly.add(Frame(Opcode.CONT, b"b")) == b"ab"
    assert not assembly.is_text


def test_empty_fragments_are_not_kept():
    assembly = MessageAssembly()
    assembly.add(Frame(Opcode.TEXT, b"", fin=False))
    for _ in range(1000):
        assembly.add(Frame(Opcode.CONT, b"", fin=False))
    assert assembly._fragments == []
    assert assembly.add(Frame(Opcode.CONT, b"")) == b""

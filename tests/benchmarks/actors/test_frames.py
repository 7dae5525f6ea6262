# SPDX-License-Identifier: Apache-2.0
"""Frames are found wherever the bytes are cut, and go out as a library reads them."""

import pytest
from websockets.frames import Frame, Opcode
from websockets.protocol import Protocol
from websockets.server import ServerProtocol

from benchmarks.actors.frames import PING, TEXT, FrameWalker, client_frame

PAYLOADS = [b"", b"x", b"y" * 125, b"a" * 126, b"b" * 65_535, b"c" * 65_536, b"d" * 200_000]


def wire(opcode: Opcode, payload: bytes) -> bytes:
    return Frame(opcode, payload).serialize(mask=False)


def walk(walker: FrameWalker, data: bytes, step: int) -> list[tuple[int, bytes]]:
    frames = []
    for chunk in _cut(data, step):
        rest = chunk
        while rest:
            room = walker.room()
            size = min(len(rest), len(room))
            room[:size] = rest[:size]
            rest = rest[size:]
            frames += [(opcode, bytes(payload)) for opcode, payload in walker.received(size)]
    return frames


def _cut(data, step):
    return (data[i : i + step] for i in range(0, len(data), step))


@pytest.mark.parametrize("step", [1, 2, 3, 7, 1000, 65_536, 10**7])
def test_frames_of_all_kinds_and_lengths_are_found_wherever_the_bytes_are_cut(step):
    frames = [(TEXT, one) for one in PAYLOADS] + [(PING, b"2")]
    data = b"".join(wire(Opcode(opcode), one) for opcode, one in frames)
    assert walk(FrameWalker(16), data, step) == frames


def test_a_payload_stays_valid_while_further_room_is_made():
    walker = FrameWalker(64)
    data = wire(Opcode.TEXT, b"first") + wire(Opcode.TEXT, b"second")[:3]
    walker.room()[: len(data)] = data
    [(_, payload)] = walker.received(len(data))
    for _ in range(8):
        walker.room()[:1] = b"\0"
        list(walker.received(1))
    assert len(payload) == 5


@pytest.mark.parametrize("payload", PAYLOADS, ids=len)
def test_a_server_reads_what_goes_out(payload):
    server = ServerProtocol(max_size=None)
    server.state = server.state.OPEN
    server.parser = Protocol.parse(server)
    next(server.parser)
    server.receive_data(client_frame(TEXT, payload))
    [frame] = server.events_received()
    assert frame.opcode is Opcode.TEXT
    assert bytes(frame.data) == payload

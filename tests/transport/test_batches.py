# SPDX-License-Identifier: Apache-2.0
import asyncio
import socket

import pytest

from gateway.transport.batches import MOST_JOINED_BYTES, batch_writer

DEAF = [(3, 12, 0), (3, 12, 8), (3, 13, 0), (3, 13, 1)]
SOUND = [(3, 11, 7), (3, 12, 9), (3, 13, 2), (3, 14, 0)]


class Paused(asyncio.Protocol):
    is_paused = False

    def pause_writing(self):
        self.is_paused = True


@pytest.fixture
async def connected():
    ours, theirs = socket.socketpair()
    ours.setblocking(False)
    transport, protocol = await asyncio.get_running_loop().create_connection(Paused, sock=ours)
    yield transport, protocol, theirs
    transport.abort()
    theirs.close()


@pytest.mark.parametrize("version", [None, *DEAF])
async def test_a_full_socket_is_noticed(connected, version):
    transport, protocol, _ = connected
    write = batch_writer(transport, version) if version else batch_writer(transport)
    for _ in range(100):  # 10 MB, more than any socket accepts
        write([b"x" * 50_000, b"y" * 50_000])
    assert protocol.is_paused


@pytest.mark.parametrize("version", [*DEAF, *SOUND])
async def test_frames_arrive_whole_and_in_order(connected, version):
    transport, _, theirs = connected
    batch_writer(transport, version)([b"one ", b"two ", b"three"])
    assert theirs.recv(100) == b"one two three"


class Writer(asyncio.WriteTransport):
    """A transport that does not join, as those of uvloop and of newer versions of Python."""

    def __init__(self):
        super().__init__()
        self.written = []

    def write(self, data):
        self.written.append(data)

    def writelines(self, list_of_data):
        self.written += list_of_data


class Joiner(Writer):
    writelines = asyncio.WriteTransport.writelines


@pytest.mark.parametrize("version", SOUND)
def test_with_a_sound_writelines_nothing_is_copied(version):
    transport = Writer()
    assert batch_writer(transport, version) == transport.writelines


@pytest.mark.parametrize(
    ("transport", "version"), [(Writer(), DEAF[0]), (Joiner(), SOUND[0])], ids=["deaf", "joins"]
)
def test_only_a_few_frames_are_joined(transport, version):
    write = batch_writer(transport, version)
    few = [b"x" * (MOST_JOINED_BYTES - 1), b"y"]
    many = [b"header", *few]
    write(iter(few))
    assert transport.written == [b"".join(few)]
    write(iter(many))
    assert transport.written[1:] == many
    assert MOST_JOINED_BYTES == 262_144

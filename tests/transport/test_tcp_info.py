# SPDX-License-Identifier: Apache-2.0
"""The readings of the kernel for real connections."""

import fcntl
import socket
import struct
import sys
import termios
from collections.abc import Iterator
from contextlib import closing

import pytest

from gateway.transport.tcp_info import is_ended, read_tcp_info

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="other kernels do not say it")


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        far = socket.create_connection(server.getsockname())
        near, _ = server.accept()  # as the gateway does: it has acknowledged no SYN
    with closing(near), closing(far):
        yield near, far


def unacknowledged(sock: socket.socket) -> int:
    """Ask in another way (tcp(7), SIOCOUTQ)."""
    return int(struct.unpack("i", fcntl.ioctl(sock, termios.TIOCOUTQ, b"\0" * 4))[0])


def test_acknowledged_bytes_are_counted(pair):
    near, far = pair
    near.sendall(b"x" * 5000)
    far.recv(5000, socket.MSG_WAITALL)
    reading = read_tcp_info(near)
    assert (reading.acked_bytes, reading.on_the_way_bytes) == (5000, 0)
    assert 0 < reading.min_rtt_s < 60


def test_bytes_in_the_kernel_are_on_the_way(pair):
    near, far = pair
    near.setblocking(False)
    written = 0
    try:
        while True:
            written += near.send(b"x" * 65536)
    except BlockingIOError:
        pass
    reading = read_tcp_info(near)
    assert reading.on_the_way_bytes == unacknowledged(near) > 0
    assert reading.acked_bytes + reading.on_the_way_bytes == written
    while read_tcp_info(near).unanswered_s:  # its window is closed, and it has said so
        pass
    del far


def test_other_and_closed_sockets_have_no_reading(pair):
    near, _ = pair
    near.close()
    assert read_tcp_info(near) is None
    with closing(socket.socket(socket.AF_UNIX)) as local:
        assert read_tcp_info(local) is None
    assert read_tcp_info(None) is None


def test_of_an_old_kernel_nothing_is_known(pair):
    near, _ = pair

    class Old:
        def getsockopt(self, *_: int) -> bytes:
            return bytes(100)

        def fileno(self) -> int:
            return near.fileno()

    assert read_tcp_info(Old()) is None  # type: ignore[arg-type]  # as far as it is used


def test_a_peer_that_has_closed_is_noticed_behind_unread_data(pair):
    near, far = pair
    far.sendall(b"x" * 5000)
    assert not is_ended(near)
    far.shutdown(socket.SHUT_WR)
    while not is_ended(near):
        pass
    assert near.recv(5000, socket.MSG_WAITALL) == b"x" * 5000


def test_other_sockets_have_no_known_end():
    left, right = socket.socketpair()
    with closing(left), closing(right):
        assert not is_ended(left)
    assert not is_ended(None)

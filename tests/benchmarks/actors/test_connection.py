# SPDX-License-Identifier: Apache-2.0
"""A lean connection is a WebSocket client: a server that keeps the rules is content with it."""

import contextlib
import threading

import pytest
from websockets.sync.server import serve

from benchmarks.actors.connection import RawConnection
from tests.websocket_server import serving

TIMEOUT_S = 120


@contextlib.contextmanager
def connected(handler):
    with serving(handler) as url, RawConnection(url) as connection:
        connection.limit(TIMEOUT_S)
        yield connection


def receive(connection, count):
    payloads = []
    while len(payloads) < count:
        for payload in connection.receive():
            payloads.append(bytes(payload))
            if len(payloads) == count:
                break
    return payloads


def test_operations_arrive_and_payloads_come_back():
    def echo(socket):
        socket.send(socket.recv())

    with connected(echo) as connection:
        connection.send({"op": "x"})
        assert receive(connection, 1) == [b'{"op": "x"}']


def test_bytes_right_after_the_handshake_are_not_lost():
    with connected(lambda socket: [socket.send(str(i)) for i in range(50)]) as connection:
        assert receive(connection, 50) == [b"%d" % i for i in range(50)]


def test_pings_are_answered_and_are_not_payloads():
    def ping(socket):
        socket.send("before")
        socket.pong("unasked")
        answered = socket.ping("are you there?").wait(TIMEOUT_S)
        socket.send("answered" if answered else "silent")

    with connected(ping) as connection:
        assert receive(connection, 2) == [b"before", b"answered"]


def test_pings_are_answered_while_nobody_reads():
    answered = threading.Event()

    def ping(socket):
        socket.send("ignored")
        if socket.ping().wait(TIMEOUT_S):
            answered.set()

    with connected(ping) as connection:
        connection.answer_pings()
        assert answered.wait(TIMEOUT_S)


def test_the_end_of_the_connection_is_said_with_the_servers_reason():
    with (
        connected(lambda socket: socket.close(4503, "too slow")) as connection,
        pytest.raises(ConnectionError, match="too slow"),
    ):
        receive(connection, 1)


def test_stop_ends_a_wait():
    over = threading.Event()
    with connected(lambda _: over.wait(TIMEOUT_S)) as connection:
        threading.Timer(0.05, connection.stop).start()
        with pytest.raises(ConnectionError):
            receive(connection, 1)
        over.set()


def test_a_refused_handshake_is_an_error():
    with serve(
        lambda _: None, "127.0.0.1", 0, process_request=lambda c, _: c.respond(403, "no\n")
    ) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        with pytest.raises(ConnectionError, match="403"):
            RawConnection(f"ws://127.0.0.1:{server.socket.getsockname()[1]}")
        server.shutdown()
        thread.join()

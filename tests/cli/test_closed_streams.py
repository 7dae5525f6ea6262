# SPDX-License-Identifier: Apache-2.0
"""A parent that starts the gateway with a standard stream closed, as some supervisors do."""

import http.client
import signal
import socket
import subprocess
import sys
import time

import pytest

from tests.client import TIMEOUT_S


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


def is_served(port: int) -> bool:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=TIMEOUT_S)
    try:
        connection.request("GET", "/healthz/live")
        return connection.getresponse().status == 200
    except OSError:
        return False
    finally:
        connection.close()


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_gateway_serves_without_a_standard_stream(closed: str) -> None:
    port = free_port()
    command = f'exec "{sys.executable}" -m gateway serve --port {port} {closed}'
    with subprocess.Popen(["sh", "-c", command]) as gateway:
        end_s = time.monotonic() + TIMEOUT_S
        while not is_served(port):
            assert gateway.poll() is None
            assert time.monotonic() < end_s
            time.sleep(0.1)
        gateway.send_signal(signal.SIGTERM)
        assert gateway.wait(TIMEOUT_S) == 0

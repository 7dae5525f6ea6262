# SPDX-License-Identifier: Apache-2.0
"""The doctor asks a running gateway."""

import asyncio
import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from types import SimpleNamespace

import pytest

from gateway.cli.doctor import remote_checks
from gateway.cli.doctor.finding import Finding, Note
from gateway.cli.remote_connection import Gateway
from tests import dds_domain
from tests.cli.test_main import ros2_gateway
from tests.gateway_process import gateway_process

TIMEOUT = ("--timeout", "120")


async def doctor(*arguments: str, **environment: str):
    return await asyncio.to_thread(ros2_gateway, "doctor", *arguments, *TIMEOUT, **environment)


async def test_a_gateway_is_asked_for_its_health_its_clock_its_nodes_and_its_diagnosis():
    # nodes of other tests are not there
    async with gateway_process("serve", "--domain-id", str(dds_domain.claim())) as gateway:
        finished = await doctor("--from", gateway.url.replace("ws://", "http://"))
    lines = finished.stdout.splitlines()
    assert (finished.returncode, finished.stderr) == (0, "")
    assert lines[0].startswith("health          version ")
    assert any(line.startswith("ROS             the robot has ROS 2 ") for line in lines)
    assert any(line.startswith("clock           the clock of the robot differs") for line in lines)
    assert "discovery       WARNING: the gateway sees no node of a robot" in lines
    assert any("components of the gateway report" in line for line in lines)
    assert "run `ros2-gateway doctor` on the robot" in finished.stdout


async def test_a_gateway_that_needs_a_token_is_asked_with_the_one_in_a_file(
    tmp_path: Path, monkeypatch
):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    token = ros2_gateway("token", "create", "me", "--role", "viewer").stdout
    file = tmp_path / "token"
    file.touch(0o600)
    file.write_text(token)
    async with gateway_process("serve", "--set", "access.authentication=token") as gateway:
        without = await doctor("--from", gateway.url)
        named = await doctor("--from", gateway.url, "--token-file", str(file))
    assert without.returncode == 1
    assert "do:  Make a token on the robot by `token create`, and name its file" in without.stdout
    assert named.returncode == 0
    assert "components of the gateway report" in named.stdout


def test_an_address_where_no_gateway_answers_is_an_error_with_what_to_do():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    finished = ros2_gateway("doctor", "--from", f"ws://127.0.0.1:{port}")
    assert finished.returncode == 1
    what, why, advice, *_ = finished.stdout.splitlines()
    assert what == (
        f"health          ERROR: ws://127.0.0.1:{port} does not answer as a gateway"
        " (connection refused)"
    )
    assert why.strip().startswith("why: It does not run, listens only on its machine, or a ")
    assert advice.strip().startswith("do:  Start it with --lan")


def test_a_missing_port_and_a_wrong_address_are_named():
    finding = remote_checks._unreachable("ws://robot", OSError("x"))
    assert finding.advice == "Add the port of the gateway, such as ws://robot:9090"
    finished = ros2_gateway("doctor", "--from", "robot")
    assert finished.returncode == 2
    assert "--from: got 'robot', expected ws://HOST:PORT or wss://HOST:PORT" in finished.stderr


async def test_a_certificate_that_is_not_trusted_is_found_and_a_trusted_one_is_used(
    tmp_path: Path, monkeypatch
):
    pytest.importorskip("cryptography")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    ros2_gateway("cert")
    cert, key = (str(tmp_path / "ros2-gateway" / name) for name in ("cert.pem", "key.pem"))
    async with gateway_process("serve", "--tls-cert", cert, "--tls-key", key) as gateway:
        port = gateway.url.rpartition(":")[2].strip("/")
        refused = await doctor("--from", f"wss://localhost:{port}")
        plain = await doctor("--from", f"ws://localhost:{port}")
        trusted = await doctor("--from", f"https://localhost:{port}", "--ca", cert)
    assert (refused.returncode, plain.returncode, trusted.returncode) == (1, 1, 0)
    assert "do:  Name its cert.pem by --ca" in refused.stdout
    assert "why: Another program answers there, the port needs wss://" in plain.stdout
    assert "the robot has ROS 2 " in trusted.stdout


class Answers:
    """Stands for a connection to a gateway that is unlike the one of this machine."""

    def __init__(self, values: dict) -> None:
        self.values = values

    def ask(self, _: object) -> dict:
        return {"values": self.values}

    def first_message(self, *_: object) -> dict:
        return self.values


def results(name: str, values: dict) -> list[Finding | Note]:
    return list(remote_checks._answered(remote_checks.CHECKS[name], Answers(values)))


@pytest.mark.parametrize(
    ("apart_s", "round_trip_s", "is_found"),
    [(0.5, 0, False), (0.75, 0, True), (-3600, 0, True), (1.5, 2, False), (1.75, 2, True)],
)
def test_the_clock_of_a_robot_that_differs_is_found(apart_s, round_trip_s, is_found, monkeypatch):
    times_s = iter([1000.0, 1000.0 + round_trip_s])
    monkeypatch.setattr(remote_checks, "time", SimpleNamespace(time=lambda: next(times_s)))
    stamp_ns = round((1000 + round_trip_s / 2 + apart_s) * 1e9)
    stamp = {"sec": stamp_ns // 10**9, "nanosec": stamp_ns % 10**9}
    (result,) = results("clock", {"time": stamp})
    assert isinstance(result, Finding) == is_found
    assert (result.what if is_found else result.text).endswith(f"differs by {apart_s:+.1f} s")


def test_each_component_that_reports_a_problem_is_a_finding():
    status = [
        {"name": f"gw: {name}", "level": level, "message": "is so"}
        for level, name in enumerate(("event loop", "clients", "guard"))
    ]
    clients, guard, note = results("diagnosis", {"status": status})
    assert (clients.level, clients.what) == ("warning", "clients: is so")
    assert (guard.level, guard.what) == ("error", "guard: is so")
    assert note == Note("3 components of the gateway report")
    assert remote_checks._is_of_gateway({"status": status})
    assert not remote_checks._is_of_gateway({"status": status[1:]})


@pytest.mark.parametrize("name", remote_checks.CHECKS)
def test_an_answer_that_is_not_of_a_gateway_is_found(name):
    (finding,) = results(name, {})
    assert finding.what.startswith("the answer is not that of ros2-gateway (KeyError: ")


@contextmanager
def answering(status: int, page: str) -> Iterator[Gateway]:
    """Yield the address of a server that is not a gateway, or not of this version."""

    class Page(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(status)
            self.end_headers()
            self.wfile.write(page.encode())

        def log_message(self, *_: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Page)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield Gateway(f"ws://127.0.0.1:{server.server_port}")
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.parametrize(
    ("page", "reason"),
    [("nothing here", "404 Not Found, nothing here"), ("{}", "'status'"), ("{", "Expecting ")],
)
def test_a_server_that_is_not_a_gateway_is_found(page, reason):
    with answering(404, page) as server:
        (finding,) = remote_checks._health(server)
    assert finding.what.startswith(f"{server.url} does not answer as a gateway ({reason}")
    assert finding.why.startswith("Another program answers there")


def test_a_page_of_64_kib_is_read_and_no_longer_one():
    health = json.dumps({"status": "ok", "ready": True, "reasons": []})
    limit = 64 * 1024
    for size, results_of in ((limit, Note), (limit + 1, Finding)):
        with answering(200, health[:-1].ljust(size - 1) + "}") as server:
            (result,) = remote_checks._health(server)
        assert isinstance(result, results_of)


def test_a_reason_is_an_error_only_if_the_gateway_is_not_ready():
    for ready, level in ((True, "warning"), (False, "error")):
        health = {"status": "x", "ready": ready, "reasons": ["the guard is lost"], "version": "1"}
        with answering(200, json.dumps(health)) as server:
            note, finding = remote_checks._health(server)
        assert (note, finding.level) == (Note("version 1, x"), level)
        assert (finding.what, finding.why) == ("the guard is lost", "The gateway is x")

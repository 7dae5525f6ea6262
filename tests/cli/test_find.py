# SPDX-License-Identifier: Apache-2.0
"""Finding gateways from outside: a real gateway, and the real command."""

import contextlib
import itertools
import json
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from urllib.parse import urlsplit

import pytest

from gateway.cli import find
from gateway.cli.find import gateways, line
from gateway.transport.lan_discovery import FoundGateway, answer
from tests.cli.test_main import ros2_gateway
from tests.client import TIMEOUT_S, eventually
from tests.gateway_process import gateway_process

GATEWAY = FoundGateway("4f1d", "robot7", 9090, "/", False, None, True, "0.1.0")


@pytest.fixture
def answering() -> Iterator[socket.socket]:
    """A socket that answers nothing until a test does so."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as answering:
        answering.bind(("127.0.0.1", 0))
        answering.settimeout(TIMEOUT_S)
        yield answering


def answered(answering: socket.socket, *datagrams: bytes) -> list[tuple[str, FoundGateway]]:
    def answer_all() -> None:
        _, sender = answering.recvfrom(2048)
        for datagram in datagrams:
            answering.sendto(datagram, sender)

    thread = threading.Thread(target=answer_all)
    thread.start()
    try:
        return gateways(0.5, ("127.0.0.1",), answering.getsockname()[1])
    finally:
        thread.join()


def test_gateways_are_sorted_by_name_and_named_once(answering: socket.socket) -> None:
    other = replace(GATEWAY, id="5a", name="arm")
    found = answered(answering, answer(GATEWAY), b"garbage", answer(other), answer(GATEWAY))
    assert found == [("127.0.0.1", other), ("127.0.0.1", GATEWAY)]


def test_no_more_than_256_gateways_are_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    endless = (("10.0.0.7", replace(GATEWAY, id=str(number))) for number in itertools.count())
    monkeypatch.setattr(find, "_answers", lambda *_: endless)
    assert len(gateways(1.0)) == 256


def test_a_line_says_how_to_connect() -> None:
    assert line("10.0.0.7", GATEWAY) == (
        "robot7  ws://10.0.0.7:9090/  needs a token, version 0.1.0"
    )
    assert line("10.0.0.7", replace(GATEWAY, tls_port=9443, needs_token=False)) == (
        "robot7  ws://10.0.0.7:9090/ and wss://10.0.0.7:9443/  needs no token, version 0.1.0"
    )


def test_nobody_there_is_told_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    script = (
        "from gateway.cli import find, main\n"
        "find.gateways.__defaults__ = (('127.0.0.1',), 1)\n"
        "raise SystemExit(main.main(['find', '--wait', '0.1']))"
    )
    run = subprocess.run(
        [sys.executable, "-c", script],
        env=dict(os.environ),
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert (run.returncode, run.stdout) == (1, "")
    assert run.stderr.startswith("ros2-gateway: no gateway has answered: start one with --lan")


@pytest.mark.parametrize("wait", ["0", "-1", "nan", "soon"])
def test_a_wait_is_a_time(wait: str) -> None:
    refused = ros2_gateway("find", "--wait", wait)
    assert refused.returncode == 2
    assert "expected seconds above 0" in refused.stderr


@pytest.mark.parametrize("is_discoverable", [True, False])
async def test_a_gateway_on_all_networks_is_found_unless_it_hides(is_discoverable, tmp_path):
    settings = (f"discoverable={json.dumps(is_discoverable)}", f"access.token_file={tmp_path}/t")
    flags = ("--lan", *(part for each in settings for part in ("--set", each)))
    async with gateway_process("serve", *flags) as gateway:
        port = urlsplit(gateway.url).port

        def is_found() -> bool:
            return port in [each.port for _, each in gateways(0.5, ("127.255.255.255",))]

        if is_discoverable:
            await eventually(is_found)
        else:
            assert not is_found()


class Network:
    """A socket that gets some datagrams and nothing more. Time passes while it waits."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *datagrams: bytes) -> None:
        self.now_s = 0.0
        self.asked_s: list[float] = []
        self._datagrams = list(datagrams)
        self._timeout_s = 0.0
        monkeypatch.setattr(find.socket, "socket", lambda *_: contextlib.nullcontext(self))
        monkeypatch.setattr(find, "time", SimpleNamespace(monotonic=lambda: self.now_s))

    def setsockopt(self, *_: int) -> None: ...

    def settimeout(self, seconds: float) -> None:
        self._timeout_s = seconds

    def sendto(self, *_: object) -> None:
        self.asked_s.append(self.now_s)

    def recvfrom(self, size: int) -> tuple[bytes, tuple[str, int]]:
        if self._datagrams:
            return self._datagrams.pop(0)[:size], ("10.0.0.7", 9090)
        self.now_s += self._timeout_s
        raise TimeoutError


def test_a_gateway_that_has_not_answered_is_asked_again_every_400_ms(monkeypatch):
    network = Network(monkeypatch)
    assert gateways(2.0, ("10.0.0.255",)) == []
    assert network.asked_s == pytest.approx([0.0, 0.4, 0.8, 1.2, 1.6])


def test_an_answer_that_is_larger_than_a_packet_is_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    other = replace(GATEWAY, id="5a", name="arm")
    Network(monkeypatch, answer(GATEWAY).rjust(1401), answer(other).rjust(1400))
    assert gateways(2.0, ("10.0.0.255",)) == [("10.0.0.7", other)]

# SPDX-License-Identifier: Apache-2.0
import json
from dataclasses import replace

import pytest

from gateway.transport.lan_discovery import (
    QUESTION_BYTES,
    FoundGateway,
    answer,
    found,
    is_question,
    question,
)

GATEWAY = FoundGateway("4f1d", "robot7", 9090, "/", False, None, True, "0.1.0")


@pytest.mark.parametrize(
    "gateway", [GATEWAY, replace(GATEWAY, is_encrypted=True, path="/ros", tls_port=9091)]
)
def test_an_answer_can_be_read(gateway: FoundGateway) -> None:
    assert found(answer(gateway)) == gateway


def test_the_address_is_that_of_the_websocket() -> None:
    assert GATEWAY.url("10.0.0.7") == "ws://10.0.0.7:9090/"
    assert replace(GATEWAY, is_encrypted=True, path="/ros").url("r") == "wss://r:9090/ros"


def test_no_answer_is_longer_than_a_question() -> None:
    longest = FoundGateway(
        id="f" * 16,
        name="\u00e9" * 500,
        port=65535,
        path="/" + "p" * 199,
        is_encrypted=False,
        tls_port=65535,
        needs_token=False,
        version="10.10.10.dev10",
    )
    assert len(answer(longest)) <= QUESTION_BYTES == len(question())
    told = found(answer(longest))
    assert told.name == "?" * 63
    assert not is_question(question()[: QUESTION_BYTES - 1])


@pytest.mark.parametrize(
    "change",
    [
        {"op": "find_gateways"},
        {"port": "9090"},
        {"port": 0},
        {"port": 65536},
        {"name": "\x1b[2J"},
        {"path": None},
        {"tls": 1},
        {"tls_port": "9091"},
        {"tls_port": -5},
        {"port": True},
        {"path": "@evil.example:9090/"},
        {"name": "n" * 1100},
    ],
)
def test_other_datagrams_are_ignored(change: dict[str, object]) -> None:
    assert found(json.dumps(json.loads(answer(GATEWAY)) | change).encode()) is None


@pytest.mark.parametrize("datagram", [b"", b"{", b"[]", b"\xff" * 600, b"1" * 600])
def test_garbage_is_neither(datagram: bytes) -> None:
    assert not is_question(datagram)
    assert found(datagram) is None

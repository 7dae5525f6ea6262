# SPDX-License-Identifier: Apache-2.0
"""The causes why a router cannot be used. tests/uplink/test_tls.py has those of a real router."""

import contextlib
import socket
import threading
from collections.abc import Iterator

import pytest

from gateway.sources.zenoh import unusable as module
from gateway.sources.zenoh.unusable import Address, address_of, unusable
from tests.sources.zenoh.outside import Router, free_port


@contextlib.contextmanager
def answering(answer: bytes) -> Iterator[int]:
    """Run a program that answers each connection with the same bytes. Yield its port."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            with contextlib.suppress(OSError):
                while True:
                    link, _ = server.accept()
                    with link, contextlib.suppress(OSError):
                        link.recv(1024)
                        link.sendall(answer)

        thread = threading.Thread(target=serve)
        thread.start()
        yield server.getsockname()[1]
        server.shutdown(socket.SHUT_RDWR)
    thread.join()


@pytest.mark.parametrize(
    ("protocol", "answer", "what"),
    [
        ("tcp", b"HTTP/1.1 400 Bad Request\r\n\r\n", "is another program"),
        ("tcp", b"", "closes the connection without an answer"),
        ("tcp", b"\2\0\3\2", "has another version of Zenoh"),
        ("tcp", b"\2\0\3\0", "asks for a name and a password"),
        ("tcp", b"\x15\3\3\0\2\2\x32", "needs TLS"),
        ("tls", b"HTTP/1.1 400 Bad Request\r\n\r\n", "does not answer with TLS"),
        ("tls", b"", "does not answer with TLS"),
    ],
)
def test_the_answer_of_a_program_is_the_cause(protocol: str, answer: bytes, what: str):
    with answering(answer) as port:
        found = unusable(f"{protocol}/127.0.0.1:{port}", {}, "relay", "start it")
    assert found is not None
    assert found.what == what


def test_a_program_that_says_nothing_ends_the_question(monkeypatch: pytest.MonkeyPatch):
    assert module.STEP_S == 3
    monkeypatch.setattr(module, "STEP_S", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as server:
        for protocol, what in (("tcp", "does not answer, timed out"), ("tls", "with TLS")):
            address = f"{protocol}/127.0.0.1:{server.getsockname()[1]}"
            found = unusable(address, {}, "relay", "start it")
            assert found is not None
            assert what in found.what


def test_an_address_where_nothing_is_has_the_remedy_to_start_it():
    found = unusable(f"tcp/127.0.0.1:{free_port()}", {}, "relay", "start it")
    assert found == ("cannot be reached, connection refused", "start it")
    found = unusable("tcp/robot.invalid:7447", {}, "relay", "start it")
    assert found is not None
    assert "the name robot.invalid is not known" in found.what


def test_without_a_section_the_variable_of_zenoh_is_named():
    with answering(b"\2\0\3\0") as port:
        found = unusable(f"tcp/127.0.0.1:{port}", {}, "", "start it")
    assert found is not None
    assert found.remedy == "set transport/auth/usrpwd/user and transport/auth/usrpwd/password"


def test_nothing_is_wrong_with_an_open_router_or_is_known_of_other_protocols():
    with contextlib.closing(Router()) as router:
        assert unusable(router.address, {}, "relay", "start it") is None
    assert unusable("quic/127.0.0.1:1", {}, "relay", "start it") is None
    assert unusable("tcp/127.0.0.1", {}, "relay", "start it") is None


@pytest.mark.parametrize(
    ("endpoint", "address"),
    [
        ("tls/[::1]:7447", Address("tls", "::1", 7447)),
        ("tcp/robot:7447#iface=eth0", Address("tcp", "robot", 7447)),
        ("tcp/robot:70000", Address("tcp", "robot", None)),
    ],
)
def test_an_address_is_read(endpoint: str, address: Address):
    assert address_of(endpoint) == address

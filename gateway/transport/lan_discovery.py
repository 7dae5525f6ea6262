# SPDX-License-Identifier: Apache-2.0
"""The gateways of a network, as clients find them: the datagrams, and who answers.

A client broadcasts a question to a UDP port, and each gateway answers the client alone. Both are
JSON, and nobody vouches for either. A question has at least `QUESTION_BYTES` and an answer at most
as many: a question with a forged sender makes no gateway send a third party more than it has got.
"""

import asyncio
import contextlib
import logging
import socket
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import orjson

from gateway.errors import system_reason

logger = logging.getLogger(__name__)

PORT: Final = 9090  # of UDP, whatever the gateway's own port is
QUESTION_BYTES: Final = 512
MAX_BYTES: Final = 1400  # one packet of Ethernet
MAX_NAME: Final = 63  # characters, as many as a label of a host name has
MAX_PATH: Final = 200

# The loop looks at this many datagrams, and then at none for a while. Others that do not fit into
# the socket's buffer are lost, so a client asks more than once.
DATAGRAMS_PER_TURN: Final = 16
PAUSE_S: Final = 0.1
BUFFER_BYTES: Final = 32 * 1024

_QUESTION_OP: Final = "find_gateways"


@dataclass(frozen=True, slots=True)
class FoundGateway:
    """A gateway as it describes itself. Its address is the sender of the datagram."""

    id: str  # of one run of a gateway, which may be heard in several ways
    name: str  # of its machine
    port: int
    path: str
    is_encrypted: bool  # clients need wss:// on `port`
    tls_port: int | None  # for wss:// besides
    needs_token: bool
    version: str

    def url(self, host: str) -> str:
        """Return the address for a WebSocket client."""
        return f"{'wss' if self.is_encrypted else 'ws'}://{host}:{self.port}{self.path}"


def question() -> bytes:
    """Return the datagram that asks all gateways to answer."""
    return orjson.dumps({"op": _QUESTION_OP}).ljust(QUESTION_BYTES)


def is_question(datagram: bytes) -> bool:
    """Return whether a gateway answers a datagram."""
    return len(datagram) >= QUESTION_BYTES and _members(datagram).get("op") == _QUESTION_OP


def answer(gateway: FoundGateway) -> bytes:
    """Return the datagram that describes a gateway, whose path has `MAX_PATH` characters at most.

    It has at most `QUESTION_BYTES`.
    """
    return orjson.dumps(
        {
            "op": "gateway",
            "id": gateway.id,
            "name": gateway.name.encode("ascii", "replace")[:MAX_NAME].decode(),
            "port": gateway.port,
            "path": gateway.path,
            "tls": gateway.is_encrypted,
            "tls_port": gateway.tls_port,
            "token": gateway.needs_token,
            "version": gateway.version,
        }
    )


def found(datagram: bytes) -> FoundGateway | None:
    """Return the gateway that an answer describes. ``None`` for any other datagram."""
    match _members(datagram):
        case {
            "op": "gateway",
            "id": str(run),
            "name": str(name),
            "port": int(port),
            "path": str(path),
            "tls": bool(is_encrypted),
            "tls_port": int() | None as tls_port,
            "token": bool(needs_token),
            "version": str(version),
        } if (
            _is_port(port)
            and (tls_port is None or _is_port(tls_port))
            and all(map(_is_plain, (run, name, path, version)))
            and path.startswith("/")
        ):
            return FoundGateway(run, name, port, path, is_encrypted, tls_port, needs_token, version)
    return None


def _is_plain(text: str) -> bool:
    # nothing that a terminal obeys, and no longer than in an answer of a gateway
    return text.isascii() and text.isprintable() and len(text) <= MAX_PATH


def _is_port(number: int) -> bool:
    return number is not True and 0 < number < 65536  # bool is an int


def _members(datagram: bytes) -> dict[str, Any]:
    try:
        members = orjson.loads(datagram)
    except orjson.JSONDecodeError:
        return {}
    return members if isinstance(members, dict) else {}


class LanDiscovery:
    """A UDP socket on all of the machine's IPv4 addresses, which other gateways there share."""

    def __init__(self, answer: bytes, port: int = PORT) -> None:
        """Answer from now on, on the running loop.

        Raises:
            OSError: another program has the port.
        """
        self._answer = answer
        self._loop = asyncio.get_running_loop()
        self._resuming: asyncio.TimerHandle | None = None
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setblocking(False)
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
            self._socket.bind(("", port))
        except OSError:
            self._socket.close()
            raise
        self._resume()

    @property
    def port(self) -> int:
        """The port."""
        return int(self._socket.getsockname()[1])

    def answer_waiting(self) -> None:
        """Answer the questions that have arrived, up to `DATAGRAMS_PER_TURN` datagrams."""
        for _ in range(DATAGRAMS_PER_TURN):
            # the error of an earlier answer whose receiver has gone
            with contextlib.suppress(OSError):
                try:
                    datagram, sender = self._socket.recvfrom(MAX_BYTES)
                except BlockingIOError:
                    return
                if is_question(datagram):
                    self._socket.sendto(self._answer, sender)

    def close(self) -> None:
        """Answer no more."""
        if self._resuming is not None:
            self._resuming.cancel()
        self._loop.remove_reader(self._socket)
        self._socket.close()

    def _resume(self) -> None:
        self._resuming = None
        self._loop.add_reader(self._socket, self._read)

    def _read(self) -> None:
        self.answer_waiting()
        self._loop.remove_reader(self._socket)
        self._resuming = self._loop.call_later(PAUSE_S, self._resume)


@contextlib.contextmanager
def answering_questions(gateway: FoundGateway) -> Iterator[None]:
    """Let clients find a gateway in the context. If that is impossible, log it and go on."""
    try:
        discovery = LanDiscovery(answer(gateway))
    except OSError as error:
        logger.warning(
            "clients cannot find this gateway by themselves: UDP port %d, %s",
            *(PORT, system_reason(error)),
        )
        yield
        return
    with contextlib.closing(discovery):
        yield

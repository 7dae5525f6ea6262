# SPDX-License-Identifier: Apache-2.0
"""A connection to a running gateway for a command that asks it one thing after another.

It uses the asyncio client of `websockets`, although nothing here runs concurrently. The client for
threads reads and writes a TLS connection from two threads at once, which OpenSSL does not allow.
"""

import argparse
import json
import logging
import socket
import ssl
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus, InvalidURI
from websockets.frames import CloseCode
from websockets.uri import parse_uri

from gateway.access.tokens import MAX_TOKEN_CHARACTERS
from gateway.backports import Runner, timeout
from gateway.config.secrets import exposure
from gateway.config.settings import TOKEN_VARIABLE
from gateway.errors import GatewayError, UsageError, system_reason

# A definition has 256 KiB at most, and its schema, which comes along, several times as much.
MAX_ANSWER_BYTES: Final = 16 * 1024**2
DEFAULT_TIMEOUT_S: Final = 10.0
_MAX_REASON: Final = 300  # characters of a refusal in words
_BAD_ADDRESS: Final = "--from: got {!r}, expected ws://HOST:PORT or wss://HOST:PORT"
_SEND_TOKEN: Final = f". To send a token, use --token-file or {TOKEN_VARIABLE}"
_NEEDS_TOKEN: Final = frozenset({401, 403})

# websockets would write the other side's faults to it, with stacks
_silent = logging.getLogger(f"{__name__}.websockets")
_silent.disabled = True


@dataclass(frozen=True, slots=True)
class Gateway:
    """The address of a running gateway, and what is needed to ask it.

    *timeout_s* is for connecting, and for each answer.
    """

    url: str
    token: str | None = None
    ca: Path | None = None
    timeout_s: float = DEFAULT_TIMEOUT_S


def is_for_access(arguments: argparse.Namespace) -> bool:
    """Return whether there are arguments that only a running gateway needs."""
    return any((arguments.token_file, arguments.ca, arguments.timeout))


def gateway_of(arguments: argparse.Namespace, environment: Mapping[str, str]) -> Gateway:
    """Return the gateway that ``--from`` and the arguments for access name.

    Raises:
        UsageError: the file of the token cannot be read, or others can read it.
    """
    token = environment.get(TOKEN_VARIABLE)
    if arguments.token_file is not None:
        token = _token_in(arguments.token_file)
    timeout_s = arguments.timeout or DEFAULT_TIMEOUT_S
    return Gateway(arguments.source, token, arguments.ca, timeout_s)


def _token_in(path: Path) -> str:
    exposed = exposure(path)
    if exposed:
        raise UsageError(f"--token-file: {exposed}")
    try:
        with path.open("rb") as file:
            return file.read(MAX_TOKEN_CHARACTERS + 1).decode(errors="replace").strip()
    except OSError as error:
        raise UsageError(f"--token-file: cannot read {path}, {system_reason(error)}") from error


class RemoteConnection:
    """Asks questions and waits for the answer to each."""

    def __init__(self, socket_: ClientConnection, runner: Runner, gateway: Gateway) -> None:
        self._socket = socket_
        self._runner = runner
        self._gateway = gateway
        self._asked = 0

    def first_message(
        self, topic: str, is_wanted: Callable[[Mapping[str, Any]], bool]
    ) -> Mapping[str, Any]:
        """Subscribe to a topic and return the first wanted message.

        Raises:
            UsageError: the gateway refuses it, and the text says why.
            GatewayError: no such message comes in time, or the connection is lost.
        """

        def has_come(frame: Mapping[str, Any]) -> bool:
            is_of_topic = frame.get("op") == "publish" and frame.get("topic") == topic
            return is_of_topic and is_wanted(frame["msg"])

        frame = self.ask({"op": "subscribe", "topic": topic}, has_come)
        message: Mapping[str, Any] = frame["msg"]
        return message

    def ask(
        self,
        question: Mapping[str, object],
        is_answer: Callable[[Mapping[str, Any]], bool] = lambda _: False,
    ) -> dict[str, Any]:
        """Send an operation and return the frame that answers it, by its id or *is_answer*.

        Raises:
            UsageError: the gateway refuses it, and the text says why.
            GatewayError: no answer comes in time, or the connection is lost.
        """
        self._asked += 1
        try:
            answer = self._runner.run(self._answer({**question, "id": self._asked}, is_answer))
        except TimeoutError as error:
            waited = f"no answer within {self._gateway.timeout_s:g} s"
            hint = "raise --timeout, but rosbridge never answers this"
            raise self._failed(f"{waited}: {hint}") from error
        except ConnectionClosed as error:
            raise self._failed(_closing_words(error)) from error
        if answer.get("op") == "status":
            raise self._refused(answer.get("msg"), is_forbidden=answer.get("code") == "forbidden")
        if answer.get("result") is False:  # a service has no code for it
            raise self._refused(answer.get("values"), is_forbidden=True)
        return answer

    async def _answer(
        self, question: Mapping[str, object], is_answer: Callable[[Mapping[str, Any]], bool]
    ) -> dict[str, Any]:
        """Return the frame with the id of the question or the wanted one, and skip others."""
        async with timeout(self._gateway.timeout_s):
            await self._socket.send(json.dumps(question))
            while True:
                frame = await self._socket.recv()
                try:
                    value = json.loads(frame)
                except (ValueError, RecursionError) as error:
                    raise self._failed(
                        "its answer is not JSON: check that it is a gateway"
                    ) from error
                if isinstance(value, dict) and (value.get("id") == self._asked or is_answer(value)):
                    return value

    def _refused(self, reason: object, *, is_forbidden: bool) -> UsageError:
        words = _printable(str(reason))
        needs_token = is_forbidden and self._gateway.token is None
        hint = _SEND_TOKEN if needs_token else ""
        return UsageError(f"{self._gateway.url}: {words}{hint}")

    def _failed(self, reason: str) -> GatewayError:
        return GatewayError(f"{self._gateway.url}: {reason}")


@contextmanager
def connected(gateway: Gateway) -> Iterator[RemoteConnection]:
    """Connect to a gateway until the context ends.

    Raises:
        UsageError: the address is not that of a WebSocket, or the certificate cannot be read.
        GatewayError: nobody can be reached there, or the client is not let in.
    """
    with Runner() as runner:
        socket_ = runner.run(_opened(gateway))
        try:
            yield RemoteConnection(socket_, runner, gateway)
        finally:
            runner.run(socket_.close())


async def _opened(gateway: Gateway) -> ClientConnection:
    url = gateway.url
    if not url.startswith(("ws://", "wss://")):
        raise UsageError(_BAD_ADDRESS.format(url))
    tls, headers = tls_context(gateway), _headers(gateway)
    deadline_s = time.monotonic() + gateway.timeout_s
    try:
        uri = parse_uri(url)
        # asyncio would say of two addresses that refuse only that there were several errors
        connected_socket = socket.create_connection((uri.host, uri.port), gateway.timeout_s)
        return await connect(
            url,
            sock=connected_socket,
            ssl=tls,
            additional_headers=headers,
            open_timeout=max(0.0, deadline_s - time.monotonic()),
            ping_interval=None,  # each answer has a separate timeout
            close_timeout=1,
            max_size=MAX_ANSWER_BYTES,
            proxy=None,
            logger=_silent,
        )
    except TimeoutError as error:
        reason = f"no connection within {gateway.timeout_s:g} s: raise --timeout"
        raise GatewayError(f"{url}: {reason}") from error
    except InvalidStatus as error:
        raise GatewayError(f"{url}: {_refusal(error)}") from error
    except ssl.SSLCertVerificationError as error:
        reason = error.verify_message
        raise GatewayError(
            f"{url}: its certificate is not trusted, {reason}: name it, or the one that has signed "
            "it, by --ca"
        ) from error
    # AssertionError: of websockets, where nonsense comes without end
    except (OSError, InvalidHandshake, EOFError, AssertionError) as error:
        raise GatewayError(f"{url}: {_unreachable(error)}") from error
    except (InvalidURI, ValueError) as error:
        raise UsageError(_BAD_ADDRESS.format(url)) from error


def _headers(gateway: Gateway) -> dict[str, str]:
    token = gateway.token
    if token is None:
        return {}
    if not (token.isascii() and token.isprintable() and " " not in token):
        raise UsageError(
            f"--token-file, {TOKEN_VARIABLE}: a token has printable ASCII without spaces"
        )
    return {"Authorization": f"Bearer {token}"}


def tls_context(gateway: Gateway) -> ssl.SSLContext | None:
    """Return how to trust the certificate of a gateway, ``None`` without TLS.

    Raises:
        UsageError: the file of the certificate cannot be used, or is named without TLS.
    """
    if gateway.url.startswith("ws://"):
        if gateway.ca is not None:
            raise UsageError("--ca is for wss:// addresses")
        return None
    try:
        return ssl.create_default_context(cafile=gateway.ca)
    except OSError as error:
        is_ssl = isinstance(error, ssl.SSLError)
        reason = "not a certificate in PEM" if is_ssl else system_reason(error)
        raise UsageError(f"--ca: {gateway.ca}: {reason}") from error


def _refusal(error: InvalidStatus) -> str:
    status = error.response.status_code
    words = (error.response.body or b"").decode(errors="replace").strip()
    said = _printable(f"{status} {error.response.reason_phrase}")
    if words and "<" not in words:
        said += f", {_printable(words)}"
    hint = _SEND_TOKEN if status in _NEEDS_TOKEN else ""
    return f"the handshake is refused: {said}{hint}"


def _unreachable(error: Exception) -> str:
    if isinstance(error, socket.gaierror):
        return "no address has that host name"
    if isinstance(error, ConnectionRefusedError):
        return "connection refused: nothing listens there, is the gateway running?"
    if isinstance(error, ssl.SSLError):
        return f"no TLS there ({error.reason}): is it a ws:// address?"
    if isinstance(error, OSError):
        return system_reason(error)
    return _printable(f"no WebSocket there: {error}").removesuffix(": ")


def _printable(words: str) -> str:
    """Return words that may not come from a gateway, safe for a terminal: one short line."""
    return "".join(c if c.isprintable() else " " for c in words[:_MAX_REASON])


def _closing_words(error: ConnectionClosed) -> str:
    if error.sent is not None and error.sent.code == CloseCode.MESSAGE_TOO_BIG:
        return f"an answer has over {MAX_ANSWER_BYTES} bytes"
    if error.rcvd is not None:
        reason = _printable(error.rcvd.reason)
        return f"the connection was closed with {error.rcvd.code} {reason}".rstrip()
    return "the connection is lost"

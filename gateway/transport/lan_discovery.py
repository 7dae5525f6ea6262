# SPDX-License-Identifier: Apache-2.0
"""Answers clients that look for gateways on their network."""

import asyncio
import contextlib
import logging
import socket
from collections.abc import Iterator
from typing import Final

from gateway.errors import system_reason
from gateway.transport import discovery_packets

logger = logging.getLogger(__name__)

# The loop looks at this many datagrams, and then at none for a while. Others that do not fit into
# the socket's buffer are lost, so a client asks more than once.
DATAGRAMS_PER_TURN: Final = 16
PAUSE_S: Final = 0.1
BUFFER_BYTES: Final = 32 * 1024


class LanDiscovery:
    """A UDP socket on all of the machine's IPv4 addresses, which other gateways there share."""

    def __init__(self, answer: bytes, port: int = discovery_packets.PORT) -> None:
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
                    datagram, sender = self._socket.recvfrom(discovery_packets.MAX_BYTES)
                except BlockingIOError:
                    return
                if discovery_packets.is_question(datagram):
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
def answering_questions(gateway: discovery_packets.FoundGateway) -> Iterator[None]:
    """Let clients find a gateway in the context. If that is impossible, log it and go on."""
    try:
        discovery = LanDiscovery(discovery_packets.answer(gateway))
    except OSError as error:
        logger.warning(
            "clients cannot find this gateway by themselves: UDP port %d, %s",
            *(discovery_packets.PORT, system_reason(error)),
        )
        yield
        return
    with contextlib.closing(discovery):
        yield

# SPDX-License-Identifier: Apache-2.0
"""The ports of the server: on which addresses it listens, with TLS or without."""

import asyncio
import errno
import logging
import ssl
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from gateway.backports import tls_timeouts
from gateway.config.limits import Limits
from gateway.errors import BindError
from gateway.transport.tls_handshakes import log_failed_handshakes

logger = logging.getLogger(__name__)

# the errors of a machine without IPv6
_NO_SUCH_ADDRESS: Final = frozenset({errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT})


@dataclass(frozen=True, slots=True)
class ListenPort:
    """A port to listen on, 0 for any free one. With *tls* clients need ``wss://`` there."""

    port: int
    tls: ssl.SSLContext | None = None


async def listen(
    port: ListenPort,
    hosts: Sequence[str],
    make_connection: Callable[[], asyncio.BaseProtocol],
    limits: Limits,
    listeners: list[asyncio.Server],
) -> list[tuple[str, int]]:
    """Listen on a port, add its listeners to *listeners*, and return its addresses.

    Raises:
        BindError: the first address or the port cannot be listened on.
    """
    if port.tls is not None:
        log_failed_handshakes(port.tls)
    open_s = limits.open_timeout_s
    # no sooner than a connection ends by itself: until then a slow peer may take its page
    page_s = open_s + limits.send_deadline_s + limits.close_timeout_s
    addresses: list[tuple[str, int]] = []
    for host in hosts:
        number = addresses[0][1] if addresses else port.port
        try:
            listener = await asyncio.get_running_loop().create_server(
                make_connection,
                host,
                number,
                ssl=port.tls,
                **tls_timeouts(open_s, page_s) if port.tls else {},
            )
        except OSError as error:
            if not addresses:
                raise BindError(host, number, error) from error
            # Python 3.13 has no number for it
            lacks_it = error.errno is None or error.errno in _NO_SUCH_ADDRESS
            level = logging.DEBUG if lacks_it else logging.INFO
            logger.log(level, "not listening on %s: %s", host, error.strerror or error)
            continue
        listeners.append(listener)
        addresses += [sock.getsockname()[:2] for sock in listener.sockets]
    return addresses

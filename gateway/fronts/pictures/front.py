# SPDX-License-Identifier: Apache-2.0
"""Images of a topic over plain HTTP for an `<img>`: one, or one after the other.

Each viewer is a session of the router with one subscription. So it shares images with other
subscribers that have the same options, and a slow viewer gets only the newest image.
"""

import asyncio
import time
from collections.abc import Iterator
from typing import Final
from urllib.parse import urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from gateway.access.permissions import Identity
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.peer import Peer
from gateway.core.requests import Request as CoreRequest
from gateway.core.requests import Subscribe
from gateway.core.router import Router
from gateway.fronts.pictures.framing import JPEG_START
from gateway.fronts.pictures.requests import (
    PATHS,
    SNAPSHOT,
    VIEWER,
    PictureRequestError,
    picture_request,
    viewer_page,
)
from gateway.sources.source import RosError
from gateway.transport.front import HttpSession
from gateway.transport.http import page
from gateway.transport.http_connection import HttpConnection
from gateway.transport.static_files import method_of

# Each may hold one picture that waits, one that is encoded and one in the socket: with 16 pictures
# of VGA 30 MB. More people look at a robot by its pages.
MAX_VIEWERS: Final = 16
WAIT_S: Final = 5.0  # for the first picture: cameras of 1 Hz are slow ones

_JPEG: Final = "image/jpeg"
_HTML: Final = "text/html; charset=utf-8"
_POLICY: Final = "; ".join(("default-src 'none'", "img-src 'self'"))
_BOUNDARY: Final = "next-picture"
# Browsers show a picture when the boundary behind it has come, so it is sent along.
_DELIMITER: Final = f"\r\n--{_BOUNDARY}\r\n".encode()
_MULTIPART: Final = f"multipart/x-mixed-replace; boundary={_BOUNDARY}"

_STATUS: Final = {"not_found": 404, "forbidden": 403, "limit_exceeded": 503, "internal": 500}


class Viewer(HttpSession):
    """One request for pictures, until it is answered or its connection ends.

    The router wakes it by `flush`, and its connection calls `tick` with the time.
    """

    NOT_AUTHENTICATED = "send a token: Authorization: Bearer TOKEN"

    def __init__(
        self,
        pictures: "Pictures",
        protocol: ServerProtocol,
        request: Request,
        connection: HttpConnection,
        identity: Identity,
        address: str,
    ) -> None:
        peer = Peer(wake=self.flush, name=connection.name, address=address, identity=identity)
        super().__init__(pictures.core, peer)
        self._pictures = pictures
        self._protocol = protocol
        self._request = request
        self._connection = connection
        self._is_single = urlsplit(request.path).path == SNAPSHOT
        self._opened_s = time.monotonic()
        self._has_begun = False
        self._is_over = False
        self._flushing = False
        self._warning = ""
        self.topic = ""

    def flush(self) -> None:
        """Send the newest picture, if the socket takes it."""
        if self._flushing:
            return
        self._flushing = True  # encoding may report an error, which wakes us again
        try:
            outbox = self.outbox
            while outbox.size and not (self._is_over or self._connection.is_paused):
                frames = outbox.take(1)
                if not frames:
                    break
                for frame in frames:
                    self._take(bytes(frame))
        except Exception as bug:  # noqa: BLE001  # of one viewer's
            self._connection.fail(bug)
        finally:
            self._flushing = False

    def tick(self, now_s: float) -> None:
        """Give up waiting for the only picture. Let a stream wait on, with its head."""
        if self._has_begun or self._is_over or now_s - self._opened_s <= WAIT_S:
            return
        if self._is_single:
            reason = f": {self._warning}" if self._warning else ": check that its camera is running"
            self._refuse(504, f"no image of {self.topic} within {WAIT_S:g} s{reason}")
        else:
            self._begin()

    def end(self) -> None:
        """Send nothing any more."""
        self._is_over = True

    # Called by the core. It shows a warning as the reason why no picture comes.

    def send_refusal(self, error: ProtocolError, request: CoreRequest | None) -> None:
        """Answer a picture that cannot be made, and note everything else."""
        if self._is_over:
            return
        if error.code == "invalid_value":
            self._refuse(503, str(error))
        else:
            self._warning = str(error)

    def warn(self, error: ProtocolError, request: CoreRequest) -> None:
        """Do the same with a warning."""
        self.send_refusal(error, request)

    def inform(self, text: str, request: CoreRequest) -> None:
        """Show a picture instead."""

    def alert(self, code: StatusCode, text: str, request: CoreRequest) -> None:
        """Ask for none of it."""

    def is_stop(self, data: bytes) -> bool:
        """Receive no messages."""
        del data
        return False

    def _take(self, message: bytes) -> None:
        if message.startswith(JPEG_START):
            self._show(message)
        else:
            self._refuse(404, f"topic {self.topic} has no images any more")

    def _show(self, jpeg: bytes) -> None:
        if self._is_single:
            response = page(self._protocol, self._request, jpeg, _JPEG)
            response.headers.update(_headers(self._request))
            self._answer(response)
            return
        self._begin()
        head = f"Content-Type: {_JPEG}\r\nContent-Length: {len(jpeg)}\r\n\r\n".encode()
        self._connection.write(b"".join((head, jpeg, _DELIMITER)))

    def _begin(self) -> None:
        if self._has_begun:
            return
        self._has_begun = True
        headers = Headers()
        headers["Content-Type"] = _MULTIPART
        headers["Cache-Control"] = "no-store"
        headers["Connection"] = "close"
        headers.update(_headers(self._request))
        head = b"HTTP/1.1 200 OK\r\n" + headers.serialize()
        self._connection.write(head + _DELIMITER.lstrip())

    def _refuse(self, status: int, text: str) -> None:
        """Answer with the reason why there is no image, before the response begins."""
        if self._has_begun:
            return
        self._answer(self._protocol.reject(status, f"{text}\n"))

    def _answer(self, response: Response) -> None:
        """Send the only response. The subscription ends when its topic has woken the others."""
        self.end()
        asyncio.get_running_loop().call_soon(self._pictures.left, self._connection)
        self._connection.answer(response)


class Pictures:
    """The viewers of all topics, a limited number at a time."""

    paths: Final = PATHS

    def __init__(self, core: Router) -> None:
        self.core = core
        self._viewers: dict[HttpConnection, Viewer] = {}

    def __len__(self) -> int:
        """Count the requests that get pictures, or wait for one."""
        return len(self._viewers)

    def __contains__(self, connection: object) -> bool:
        """Return whether a connection gets pictures, or waits for one."""
        return connection in self._viewers

    def sessions(self) -> Iterator[tuple[HttpConnection, HttpSession]]:
        """Yield the connection and the session of each viewer."""
        yield from self._viewers.items()

    def respond(
        self,
        protocol: ServerProtocol,
        request: Request,
        connection: HttpConnection,
        identity: Identity,
        address: str,
    ) -> Response | None:
        """Begin to send images, or return a refusal."""
        try:
            asked = picture_request(request.path)
        except PictureRequestError as error:
            return protocol.reject(400, f"{error}\n")
        if urlsplit(request.path).path == VIEWER:
            response = page(protocol, request, viewer_page(request.path, asked.topic), _HTML)
            response.headers.update(_headers(request) | {"Content-Security-Policy": _POLICY})
            return response
        if method_of(request) == "HEAD":
            is_single = urlsplit(request.path).path == SNAPSHOT
            response = page(protocol, request, None, _JPEG if is_single else _MULTIPART)
            response.headers.update(_headers(request))
            return response
        if len(self._viewers) >= MAX_VIEWERS:
            text = f"busy: {MAX_VIEWERS} other viewers get images. Try again later, or use a page\n"
            return protocol.reject(503, text)
        viewer = Viewer(self, protocol, request, connection, identity, address)
        self.core.enter(viewer)
        self._viewers[connection] = viewer
        connection.show(viewer)
        return self._subscribe(protocol, viewer, connection, asked)

    def left(self, connection: HttpConnection) -> None:
        """End the viewer of a connection, if there is one."""
        viewer = self._viewers.pop(connection, None)
        if viewer is not None:
            viewer.end()
            self.core.leave(viewer)

    def _subscribe(
        self, protocol: ServerProtocol, viewer: Viewer, connection: HttpConnection, asked: Subscribe
    ) -> Response | None:
        viewer.topic = asked.topic
        try:
            viewer.topic = self.core.view(viewer, asked)
        except (ProtocolError, RosError) as error:
            self.left(connection)
            return protocol.reject(_STATUS.get(error.code, 400), f"{error}\n")
        except BaseException:
            self.left(connection)
            raise
        return None


def _headers(request: Request) -> dict[str, str]:
    """Return the headers by which pages of this host, and those that are allowed, get pictures.

    A foreign page's `<img>` sends no Origin: so browsers are told to give such a page nothing.
    Another origin, which was found to be allowed, is named so that ``crossorigin`` works.
    """
    headers = {
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Resource-Policy": "cross-origin" if _is_of_host(request) else "same-site",
        "Vary": "Origin, Referer",
    }
    if origin := request.headers.get("Origin"):
        headers["Access-Control-Allow-Origin"] = origin
    return headers


def _is_of_host(request: Request) -> bool:
    """Return whether a page of this host asks, on whatever port.

    Chromium takes two ports of one IP address for different sites. No page can set the Referer,
    and one that hides it is taken for foreign.
    """
    try:
        page_host = urlsplit(request.headers.get("Referer", "")).hostname
        return (
            page_host is not None and page_host == urlsplit(f"//{request.headers['Host']}").hostname
        )
    except (ValueError, LookupError):
        return False

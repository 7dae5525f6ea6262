# SPDX-License-Identifier: Apache-2.0
"""Plain HTTP on the WebSocket's port: health, and a page for people who open it in a browser."""

import ipaddress
import socket
from collections.abc import Callable, Mapping, Sequence
from typing import Any
from urllib.parse import urlsplit

import orjson
from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

_WELCOME = """\
This is ros2-json-gateway: ROS 2 topics as JSON over a WebSocket.

Connect a rosbridge client (roslibjs, roslibpy, ROS#), Unity or wscat to

    {address}

and send, for example,

    {{"op":"subscribe","topic":"/odom"}}

The gateway's health is at /healthz.
"""


class HttpFront:
    """Answers HTTP requests.

    *allowed_origins* are exact origins such as ``https://ui.example`` that may connect in addition
    to pages of the same host; ``*`` allows every page.
    """

    def __init__(
        self, path: str, allowed_origins: Sequence[str], health: Callable[[], Mapping[str, Any]]
    ) -> None:
        self._path = path
        self._allowed_origins = frozenset(allowed_origins)
        self._health = health

    def respond(self, protocol: ServerProtocol, request: Request) -> Response:
        """Return the response; its status is 101 if a WebSocket begins."""
        try:
            return self._respond(protocol, request)
        except (ValueError, LookupError):  # an invalid path or host, or a header twice
            return protocol.reject(400, "this request contradicts itself\n")

    def _respond(self, protocol: ServerProtocol, request: Request) -> Response:
        path = urlsplit(request.path).path
        if path == "/healthz":
            body = orjson.dumps(
                self._health(), option=orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE
            )
            return _page(protocol, request, body.decode(), "application/json")
        if path != self._path:
            response = protocol.reject(404, f"nothing here; the WebSocket is at {self._path}\n")
        elif request.headers.get("Upgrade") is None:
            host = request.headers.get("Host", "HOST:PORT")
            return _page(protocol, request, _WELCOME.format(address=f"ws://{host}{self._path}"))
        elif not self._is_allowed(request):
            response = protocol.reject(
                403,
                f"pages from {request.headers.get('Origin')} may not connect;"
                " the operator can allow them by allowed_origins\n",
            )
        else:
            response = protocol.accept(request)
        return response

    def _is_allowed(self, request: Request) -> bool:
        """Return whether a page may connect; a program sends no Origin and always may.

        Browsers let every page open WebSockets to everywhere, localhost included, so without
        this rule any web site could drive the robot of whoever visits it.
        """
        origin = request.headers.get("Origin")
        if origin is None or "*" in self._allowed_origins or origin in self._allowed_origins:
            return True
        host = urlsplit(f"//{request.headers.get('Host', '')}").hostname
        return host is not None and host == urlsplit(origin).hostname and _is_own_name(host)


def _is_own_name(host: str) -> bool:
    """Return whether a page's host is surely this machine: an address, or a name of its own.

    Any other name may belong to somebody else's page, which makes the name point here once the
    page is loaded (DNS rebinding).
    """
    own = socket.gethostname().lower()
    if host in {"localhost", own, f"{own}.local"}:
        return True
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def _page(
    protocol: ServerProtocol, request: Request, text: str, content_type: str = "text/plain"
) -> Response:
    response = protocol.reject(200, text)
    del response.headers["Content-Type"]
    response.headers["Content-Type"] = f"{content_type}; charset=utf-8"
    response.headers["Cache-Control"] = "no-store"
    if request.method == "HEAD":
        response.body = b""
    return response

# SPDX-License-Identifier: Apache-2.0
"""Several servers on one port: the path of a request says to which it goes."""

import html
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit, urlunsplit

from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from gateway.access.web_rules import WebRules
from gateway.transport.connection import Connection
from gateway.transport.connections import Connections
from gateway.transport.end import ConnectionEnd
from gateway.transport.front import ClientSession
from gateway.transport.health import Health
from gateway.transport.http import HttpFront, page, to_origin_form
from gateway.transport.http_connection import HttpConnection
from gateway.transport.server import Server
from gateway.transport.static_files import StaticFiles, is_browser

_PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark light">
<title>Robots - ROS 2 gateway</title>
<link rel="icon" href="/icon.svg">
<link rel="stylesheet" href="/style.css">
<main>
<h1>Robots</h1>
<ul>
{items}
</ul>
</main>
</html>
"""
_NOBODY: Final = "No robot is connected: start ros2-gateway serve --uplink on a robot."
_PATH: Final = re.compile(r"/+([^/]*)(/.*)?")


class RobotPaths:
    """Accepts the connections of a port, and hands each to the server of the robot it names.

    The first part of the path is the name. At the root, so is ``?robot=``.
    """

    def __init__(
        self,
        connections: Connections,
        files: StaticFiles,
        rules: WebRules,
        find_health: Callable[[], Health],
        details: Callable[[], Mapping[str, Any]],
    ) -> None:
        self.connections = connections
        self.servers: dict[str, Server] = {}
        asked = {"/": self._robots}
        self._http = HttpFront("/", files, rules, find_health, details, asked, "/ROBOT")

    def of(self, request: Request) -> "Server | RobotPaths":
        """Return the server that a request names, and let its path be as that server has it."""
        with suppress(ValueError, LookupError):  # which are answered here
            to_origin_form(request)
            target = urlsplit(request.path)
            name, rest = _named(target.path, target.query)
            server = self.servers.get(name)
            if server is not None:
                request.path = urlunsplit(("", "", rest, target.query, ""))
                return server
        return self

    def respond(
        self, connection: Connection, protocol: ServerProtocol, request: Request
    ) -> Response | None:
        """Answer a request that names no robot."""
        return self._http.respond(protocol, request, connection)

    def malformed(self, start: bytes) -> bytes:
        """Return the response to bytes that are not an HTTP request."""
        return self._http.malformed(start)

    def choose(self, offered: Sequence[str]) -> str | None:
        """Confirm no subprotocol: no WebSocket begins here."""
        del offered
        return None

    def left(
        self, connection: Connection, session: ClientSession | None, end: ConnectionEnd
    ) -> None:
        """Forget a connection that never came to a server."""
        del session
        self.connections.discard(connection)
        end.log()

    def _robots(
        self, protocol: ServerProtocol, request: Request, connection: HttpConnection
    ) -> Response | None:
        """List the robots."""
        del connection
        asked = parse_qs(urlsplit(request.path).query).get("robot")
        if asked or request.headers.get("Upgrade") is not None:
            return protocol.reject(404, f"{self._unknown(asked[-1] if asked else '')}\n")
        if not is_browser(request):
            lines = [f"/{name}/" for name in sorted(self.servers)] or [_NOBODY]
            return page(protocol, request, "".join(f"{line}\n" for line in lines).encode())
        items = [f'<li><a href="/{html.escape(name)}/">{name}</a></li>' for name in self.servers]
        body = _PAGE.format(items="\n".join(sorted(items)) or f"<li>{_NOBODY}</li>")
        return page(protocol, request, body.encode(), "text/html; charset=utf-8")

    def _unknown(self, name: str) -> str:
        what = f"no robot {name[:32]!a} is connected" if name else "no robot is named"
        return f"{what}: connect to /ROBOT/, with a robot that / lists"


def _named(path: str, query: str) -> tuple[str, str]:
    """Return the name in a path, and the path behind it."""
    found = _PATH.fullmatch(path)
    name, rest = found.groups() if found else ("", None)
    if not name:
        name = parse_qs(query).get("robot", [""])[-1]
    return name, rest or "/"

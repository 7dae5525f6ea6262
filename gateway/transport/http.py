# SPDX-License-Identifier: Apache-2.0
"""Plain HTTP on the WebSocket's port: health, metrics, and pages for people with a browser."""

from __future__ import annotations

import logging
import socket
from collections.abc import Callable, Mapping, Sequence
from http import HTTPStatus
from typing import Any, Final
from urllib.parse import urlsplit, urlunsplit

import orjson
from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.server import ServerProtocol
from websockets.typing import Subprotocol

from gateway.access.credentials import CredentialsError, check_target, token_in
from gateway.access.web_rules import NO_ORIGIN, WebRules, is_plain
from gateway.transport import health
from gateway.transport.health import Health
from gateway.transport.http_connection import AnswerLater, HttpConnection
from gateway.transport.static_files import (
    INDEX,
    StaticFiles,
    is_browser,
    method_of,
    moved,
    response_of,
)
from gateway.transport.url_options import UrlOptionError, url_options

logger = logging.getLogger(__name__)

_WELCOME = """\
This is ros2-json-gateway: ROS 2 topics as JSON over a WebSocket.

Connect a rosbridge client (roslibjs, roslibpy, ROS#), Unity or wscat to

    {address}

and send, for example,

    {{"op":"subscribe","topic":"/odom","throttle_rate":1000}}

or help, which shows lines for what is there.

The gateway's health is at /healthz, its metrics for Prometheus at /metrics.
Images for any page are at /stream?topic=/camera/image_raw and /snapshot.
"""
_VERSION: Final = "13"  # Sec-WebSocket-Version
_JSON: Final = "application/json; charset=utf-8"
# the path of rosbridge_suite for the versions of the protocol and of the server
_VERSIONS: Final = "/version"
_PROTOCOL: Final = {"major": 2, "minor": 0, "patch": 0}
_METHODS: Final = ("GET", "HEAD") if hasattr(Request, "method") else ("GET",)  # see `method_of`
_NOT_ALLOWED: Final = f"this method is not supported: use {' or '.join(_METHODS)}\n"
_ALLOWED: Final = ", ".join(_METHODS)
_FOREIGN_HOST: Final = (
    "this is not a name of this gateway: use its address, or have the operator add the name to"
    " allowed_hosts\n"
)
_OTHER_METHODS: Final = frozenset(
    {"HEAD", "POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT"}
).difference(_METHODS)


# of all headers together, names and values: enough for a browser with its cookies, and parsed
# within a millisecond
MAX_HEADER_CHARACTERS: Final = 16 * 1024


class HttpFront:
    """Answers HTTP requests."""

    def __init__(
        self,
        path: str,
        files: StaticFiles,
        rules: WebRules,
        find_health: Callable[[], Health],
        details: Callable[[], Mapping[str, Any]],
        answer_later: Mapping[str, AnswerLater],
        base: str = "",
    ) -> None:
        """*answer_later* is by path. *base* comes before every path, and requests come without."""
        self._path = path
        self._files = files
        self._rules = rules
        self._health = find_health
        self._details = details
        self._answer_later = answer_later
        self._base = base

    def respond(
        self, protocol: ServerProtocol, request: Request, connection: HttpConnection
    ) -> Response | None:
        """Return the response. Its status is 101 if a WebSocket begins.

        ``None`` means that *connection* gets it later.
        """
        try:
            return self._respond(protocol, request, connection)
        except (CredentialsError, UrlOptionError) as error:
            return protocol.reject(400, f"{error}\n")
        except (ValueError, LookupError):  # an invalid path or host, or a header twice
            return protocol.reject(
                400, "this request contradicts itself: send one valid path and one host\n"
            )

    def malformed(self, start: bytes) -> bytes:
        """Return the response to a request that `websockets` cannot parse.

        It cannot parse requests with a body, so the method decides.
        """
        method = start.split(b" ")[0].decode("latin-1")
        if method in _OTHER_METHODS:
            return _raw(405, "Method Not Allowed", _NOT_ALLOWED, f"Allow: {_ALLOWED}\r\n")
        return _raw(400, "Bad Request", "this is not an HTTP request\n")

    def _respond(
        self, protocol: ServerProtocol, request: Request, connection: HttpConnection
    ) -> Response | None:
        if sum(len(name) + len(value) for name, value in request.headers.raw_items()) > (
            MAX_HEADER_CHARACTERS
        ):
            return protocol.reject(
                431, f"the headers are too long: send at most {MAX_HEADER_CHARACTERS} characters\n"
            )
        host = to_origin_form(request)
        if not self._rules.is_own_host(host):
            self._log_foreign(host)
            return protocol.reject(421, _FOREIGN_HOST)
        if method_of(request) not in _METHODS:
            response = protocol.reject(405, _NOT_ALLOWED)
            response.headers["Allow"] = _ALLOWED
            return response
        path = urlsplit(request.path).path
        if told := self._told_to_all(protocol, request, path):
            return told
        if path in self._answer_later:
            check_target(request.path)
            return self._origin_refusal(protocol, request, connection) or self._answer_later[path](
                protocol, request, connection
            )
        if request.headers.get("Upgrade") is None and (
            found := self._page(protocol, request, connection)
        ):
            return found
        if path != self._path:
            return protocol.reject(
                404, f"nothing is at this path: connect the WebSocket to {self._base}{self._path}\n"
            )
        check_target(request.path)
        url_options(request.path)  # refuses an unknown one while there is a response for it
        token_in(
            request.headers.get_all("Authorization"), offered_subprotocols(request.headers)
        )  # refuses contradictions while there is a response to do it by
        return (
            self._origin_refusal(protocol, request, connection)
            or _version_refusal(protocol, request)
            or protocol.accept(request)
        )

    def _told_to_all(
        self, protocol: ServerProtocol, request: Request, path: str
    ) -> Response | None:
        """Return pages for everybody: the health, and the versions as in rosbridge."""
        if path == _VERSIONS:
            versions = {"protocol": _PROTOCOL, "server": self._details()["version"]}
            return page(protocol, request, orjson.dumps(versions), _JSON)
        if path not in health.PATHS:
            return None
        status, text = self._health().page(path, self._details)
        response = page(protocol, request, text.encode(), _JSON)
        response.status_code, response.reason_phrase = status, HTTPStatus(status).phrase
        return response

    def _page(
        self, protocol: ServerProtocol, request: Request, connection: HttpConnection
    ) -> Response | None:
        """Return a page or a part of one. Without HTML in `Accept`, the start page is a text."""
        path = urlsplit(request.path).path
        if path in {"/", self._path}:
            check_target(request.path)
            url_options(request.path)
            if not (is_browser(request) and self._files.find(INDEX)):
                scheme = "wss" if connection.is_encrypted else "ws"
                address = f"{scheme}://{request.headers['Host']}{self._base}{self._path}"
                return page(protocol, request, _WELCOME.format(address=address).encode())
            path = INDEX
        file = self._files.find(path) or self._files.find(f"{path}.html")
        if file is None and self._files.find(f"{path.rstrip('/')}.html"):
            # its relative addresses would fail
            return moved(protocol, request, f"{self._base}{path.rstrip('/')}")
        response = response_of(protocol, request, file) if file else None
        if response and (origin := request.headers.get("Origin")):
            self._share(response, origin, request.headers["Host"], connection)
        return response

    def _share(
        self, response: Response, origin: str, host: str, connection: HttpConnection
    ) -> None:
        """Let pages that may connect import the modules."""
        if self._rules.standing(origin, host, is_encrypted=connection.is_encrypted) != "foreign":
            response.headers["Access-Control-Allow-Origin"] = origin

    def _log_foreign(self, host: str) -> None:
        name = urlsplit(f"//{host}").hostname or ""
        if is_plain(name) and self._rules.first_refusal(name):
            setting = self._rules.setting_for_host(name)
            logger.warning("refused a request for host %s: to allow it, use  %s", name, setting)

    def _origin_refusal(
        self, protocol: ServerProtocol, request: Request, connection: HttpConnection
    ) -> Response | None:
        origin, host = request.headers.get("Origin"), request.headers["Host"]
        standing = self._rules.standing(origin, host, is_encrypted=connection.is_encrypted)
        if origin is None or standing != "foreign":
            return None
        shown = origin if is_plain(origin) else "this site"
        remedy = "to allow them, use"
        if origin == NO_ORIGIN:
            shown = f"origin {NO_ORIGIN} (a page on disk, or in a sandboxed frame of any web site)"
            remedy = "serve the page from a web server on this machine, or use"
        if is_plain(origin) and self._rules.first_refusal(origin):
            setting = self._rules.setting_for(origin)
            logger.warning("pages from %s may not connect: %s  %s", shown, remedy, setting)
            if self._rules.is_last_logged:
                logger.warning("the log does not show further origins and hosts that are refused")
        return protocol.reject(
            403,
            f"pages from {shown} may not connect: the operator can add them to allowed_origins\n",
        )


def to_origin_form(request: Request) -> str:
    """Let the target of a request be a path. Return its host.

    A target with a host is obeyed instead of the header (RFC 9112, 3.2.2), as proxies do.

    Raises:
        ValueError: it is neither a path nor the address of a web page or a WebSocket.
        LookupError: `Host` is missing, or there are two.
    """
    host = request.headers["Host"]
    target = urlsplit(request.path) if request.path[:1] != "/" else None
    if target is not None:
        if target.scheme not in {"http", "https", "ws", "wss"} or not target.netloc:
            raise ValueError("invalid target")
        del request.headers["Host"]
        host = request.headers["Host"] = target.netloc
        request.path = urlunsplit(("", "", target.path, target.query, ""))
    # two slashes would begin the name of a host
    request.path = f"/{request.path.lstrip('/')}"
    return host


def _version_refusal(protocol: ServerProtocol, request: Request) -> Response | None:
    """Refuse drafts of the WebSocket protocol. RFC 6455 4.4 has the header of the answer."""
    version = request.headers.get("Sec-WebSocket-Version", "")
    if version in {"", _VERSION}:  # a request without is refused by `websockets`
        return None
    text = f"unknown version of the WebSocket protocol: use version {_VERSION} (RFC 6455)\n"
    response = protocol.reject(HTTPStatus.UPGRADE_REQUIRED, text)
    response.headers["Upgrade"] = "websocket"
    response.headers["Sec-WebSocket-Version"] = _VERSION
    return response


def own_names() -> list[str]:
    """Return the names that certainly belong to this machine.

    Another name may belong to a hostile page, whose name points here after the page is loaded
    (DNS rebinding).
    """
    own = socket.gethostname().lower()
    short = own.partition(".")[0]
    return ["localhost", own, short, f"{short}.local"]


def offered_subprotocols(headers: Headers) -> list[str]:
    """Return the subprotocols that a client offers."""
    values = ",".join(headers.get_all("Sec-WebSocket-Protocol"))
    return [each.strip() for each in values.split(",") if each.strip()]


def new_protocol(
    max_message_bytes: int, choose: Callable[[Sequence[str]], str | None]
) -> ServerProtocol:
    """Return the protocol of a connection. It logs nothing, because the gateway logs itself.

    *choose* confirms one of the subprotocols that a client offers, or none of them.
    """
    quiet = logging.getLogger(f"{__name__}.websockets")
    quiet.setLevel(logging.ERROR)

    def select(_: ServerProtocol, offered: Sequence[Subprotocol]) -> Subprotocol | None:
        chosen = choose(offered)
        return None if chosen is None else Subprotocol(chosen)

    return ServerProtocol(max_size=max_message_bytes, select_subprotocol=select, logger=quiet)


def _raw(status: int, phrase: str, text: str, headers: str = "") -> bytes:
    return (
        f"HTTP/1.1 {status} {phrase}\r\n{headers}Connection: close\r\n"
        f"Content-Type: text/plain; charset=utf-8\r\nContent-Length: {len(text)}\r\n\r\n{text}"
    ).encode("ascii")


def page(
    protocol: ServerProtocol,
    request: Request,
    body: bytes | None,
    content_type: str = "text/plain; charset=utf-8",
) -> Response:
    """Return a page that is not cached, or only its head if there is no *body*."""
    response = protocol.reject(200, "")
    headers = response.headers
    del headers["Content-Type"], headers["Content-Length"]
    headers["Content-Type"] = content_type
    headers["Cache-Control"] = "no-store"
    if body is not None:
        headers["Content-Length"] = str(len(body))
        if method_of(request) != "HEAD":
            response.body = body
    return response


def unauthenticated(protocol: ServerProtocol, error: Exception) -> Response:
    """Return the response to a request whose token is missing or wrong."""
    response = protocol.reject(401, f"{error}\n")
    response.headers["WWW-Authenticate"] = "Bearer"
    return response

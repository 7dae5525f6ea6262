# SPDX-License-Identifier: Apache-2.0
"""The files of the pages: read and compressed once, at the start, and served from memory.

They are the same for everybody and contain no data of the robot. A page gets its data over its
WebSocket, which may need a token.
"""

import gzip
import hashlib
import html
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

PAGES: Final = Path(__file__).parents[1] / "fronts/pages"
INDEX: Final = "/index.html"

# Only files of these types are served.
_TYPES: Final = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".ts": "text/plain; charset=utf-8",  # types of modules, for editors
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".webmanifest": "application/manifest+json",
}
# Nothing from elsewhere, nothing inline, and in nobody else's frame.
_POLICY: Final = "; ".join(
    [
        "default-src 'self'",
        "img-src 'self' data: blob:",
        "manifest-src 'self'",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'self'",
    ]
)
_HEADERS: Final = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",  # kept, and asked for by its ETag each time
    "Vary": "Accept, Accept-Encoding, Origin",
}


@dataclass(frozen=True, slots=True)
class StaticFile:
    """One file as it is sent, plain and compressed by gzip."""

    content_type: str
    body: bytes
    compressed: bytes
    etag: str

    @classmethod
    def of(cls, content_type: str, body: bytes) -> "StaticFile":
        """Compress a file and name its content."""
        digest = hashlib.sha256(body).hexdigest()[:32]
        return cls(content_type, body, gzip.compress(body, mtime=0), f'"{digest}"')


class StaticFiles:
    """The files of a folder by their path below it, such as ``/debug/main.js``."""

    def __init__(self, files: Mapping[str, StaticFile], pages: Mapping[str, bytes]) -> None:
        """*pages* are the ones whose content depends on the place. See `at`."""
        self._files = files
        self._pages = pages

    @classmethod
    def read(cls, root: Path, websocket_path: str = "/") -> "StaticFiles":
        """Read a folder. Its pages learn where the WebSocket is."""
        files, pages = {}, {}
        for path in sorted(root.rglob("*")):
            if content_type := _TYPES.get(path.suffix):
                body = path.read_bytes()
                name = f"/{path.relative_to(root).as_posix()}"
                if path.suffix == ".html":
                    pages[name] = body
                else:
                    files[name] = StaticFile.of(content_type, body)
        return cls(files, pages).at("", websocket_path)

    def at(self, base: str, websocket_path: str) -> "StaticFiles":
        """Return the files for a place where *base* comes before every path."""
        places = {b"{{base}}": base, b"{{websocket_path}}": base + websocket_path}
        filled = {}
        for name, page in self._pages.items():
            for place, path in places.items():
                page = page.replace(place, html.escape(path).encode())
            filled[name] = StaticFile.of(_TYPES[".html"], page)
        return StaticFiles({**self._files, **filled}, self._pages)

    def find(self, path: str) -> StaticFile | None:
        """Return a file by its path, which is looked up and never opened."""
        return self._files.get(path)


NO_FILES: Final = StaticFiles({}, {})


def response_of(protocol: ServerProtocol, request: Request, file: StaticFile) -> Response:
    """Return a file as the response: compressed if that is taken, 304 if it is known there."""
    response = protocol.reject(HTTPStatus.OK, "")
    headers = response.headers
    del headers["Content-Type"], headers["Content-Length"]
    headers.update(_HEADERS)
    headers["ETag"] = file.etag
    known = ",".join(request.headers.get_all("If-None-Match"))
    if file.etag in {each.strip().removeprefix("W/") for each in known.split(",")}:
        response.status_code = HTTPStatus.NOT_MODIFIED.value
        response.reason_phrase = HTTPStatus.NOT_MODIFIED.phrase
        return response
    body = file.body
    if _takes_gzip(request):
        body = file.compressed
        headers["Content-Encoding"] = "gzip"
    headers["Content-Type"] = file.content_type
    headers["Content-Length"] = str(len(body))
    if method_of(request) != "HEAD":
        response.body = body
    return response


def method_of(request: Request) -> str:
    """Return the method. `websockets` 16, the last for Python 3.10, reads GET requests only."""
    method: str = getattr(request, "method", "GET")
    return method


def moved(protocol: ServerProtocol, request: Request, path: str) -> Response:
    """Return where a file is that was asked for by another path."""
    query = urlsplit(request.path).query
    response = protocol.reject(HTTPStatus.PERMANENT_REDIRECT, f"it is at {path}\n")
    response.headers["Location"] = f"{path}?{query}" if query else path
    return response


def is_browser(request: Request) -> bool:
    """Return whether a page is wanted rather than a text, as curl and wscat show it."""
    return any("text/html" in each for each in request.headers.get_all("Accept"))


def _takes_gzip(request: Request) -> bool:
    offered = ",".join(request.headers.get_all("Accept-Encoding"))
    codings = {
        name.strip(): rest.replace(" ", "")
        for name, _, rest in (each.partition(";") for each in offered.split(","))
    }
    return "gzip" in codings and codings["gzip"] not in {"q=0", "q=0.0", "q=0.00", "q=0.000"}

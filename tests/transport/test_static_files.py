# SPDX-License-Identifier: Apache-2.0
"""The files of the pages over HTTP: the served files, and the headers for browsers."""

import asyncio
import gzip
import re
from dataclasses import dataclass
from email.message import Message
from email.parser import BytesParser
from pathlib import Path

import pytest

from gateway.transport.static_files import PAGES, StaticFiles
from tests.transport.needs import needs_websockets_17

HTML = "Accept: text/html,application/xhtml+xml"
GZIP = "Accept-Encoding: br, gzip;q=0.8"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".ts": "text/plain; charset=utf-8",
    ".png": "image/png",
    ".webmanifest": "application/manifest+json",
}
SOURCES = sorted(path for path in PAGES.rglob("*") if path.suffix in TYPES)
OWN = [
    path
    for path in SOURCES
    if path.parent.name != "vendor" and path.suffix in {".html", ".css", ".js"}
]


@dataclass(frozen=True)
class Sent:
    """A response as it came."""

    status: int
    headers: Message
    body: bytes


async def get(port: int, path: str, *headers: str, method: str = "GET") -> Sent:
    """Ask for a path as it is written."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    lines = [f"{method} {path} HTTP/1.1", "Host: localhost", *headers, "", ""]
    writer.write("\r\n".join(lines).encode())
    head, _, body = (await reader.read()).partition(b"\r\n\r\n")
    writer.close()
    first, _, rest = head.partition(b"\r\n")
    return Sent(int(first.split()[1]), BytesParser().parsebytes(rest), body)


@pytest.fixture(scope="module")
def files() -> StaticFiles:
    return StaticFiles.read(PAGES, "/")


async def test_a_browser_gets_a_page_and_others_a_text(serve, files):
    async with serve(files=files) as served:
        page = await get(served.port, "/", HTML)
        assert (page.status, page.headers["content-type"]) == (200, "text/html; charset=utf-8")
        assert b'<meta name="websocket-path" content="/">' in page.body
        text = await get(served.port, "/")
        assert text.headers["content-type"] == "text/plain; charset=utf-8"
        assert b"Connect a rosbridge client" in text.body


async def test_a_page_is_named_without_its_ending(serve, files):
    async with serve(files=files) as served:
        page = await get(served.port, "/drive", HTML)
        assert b">Drive - ROS 2 gateway</title>" in page.body


@pytest.mark.parametrize(("path", "to"), [("/drive/", "/drive"), ("/lab/?map=/m", "/lab?map=/m")])
async def test_a_page_that_is_named_as_a_folder_is_moved(serve, files, path: str, to: str):
    async with serve(files=files) as served:
        answer = await get(served.port, path, HTML)
        assert (answer.status, answer.headers["location"]) == (308, to)
        assert (await get(served.port, "/nothing/", HTML)).status == 404


async def test_without_pages_a_browser_gets_the_text(serve):
    async with serve() as served:
        page = await get(served.port, "/", HTML)
        assert page.headers["content-type"] == "text/plain; charset=utf-8"


@pytest.fixture(scope="module")
def files_of_another_path() -> StaticFiles:
    return StaticFiles.read(PAGES, "/ros")


@pytest.mark.parametrize("path", ["/", "/ros"])
async def test_the_page_knows_where_the_websocket_is(serve, files_of_another_path, path):
    async with serve(path="/ros", files=files_of_another_path) as served:
        page = await get(served.port, path, HTML)
        assert b'<meta name="websocket-path" content="/ros">' in page.body


def test_a_path_of_the_websocket_adds_no_markup(tmp_path: Path):
    (tmp_path / "index.html").write_text('<meta content="{{websocket_path}}">')
    file = StaticFiles.read(tmp_path, '/"><script>').find("/index.html")
    assert file.body == b'<meta content="/&quot;&gt;&lt;script&gt;">'


async def test_every_file_is_served_with_its_type_and_the_policy(serve, files):
    async with serve(files=files) as served:
        for path in SOURCES:
            sent = await get(served.port, f"/{path.relative_to(PAGES).as_posix()}")
            assert sent.status == 200
            assert sent.headers["content-type"] == TYPES[path.suffix]
            assert sent.headers["x-content-type-options"] == "nosniff"
            policy = sent.headers["content-security-policy"]
            assert policy.startswith("default-src 'self'; ")
            assert "manifest-src 'self'" in policy
            assert "unsafe" not in policy
            assert "ws" not in policy  # no page connects elsewhere


@pytest.mark.parametrize(
    ("origin", "is_shared"),
    [
        ("https://ui.example", True),
        ("http://localhost:8000", True),  # may connect to watch
        ("https://other.example", False),
        ("null", False),
    ],
)
async def test_modules_are_shared_with_pages_that_may_connect(serve, files, origin, is_shared):
    async with serve(
        files=files, allowed_origins=("https://ui.example",), allows_local=True
    ) as served:
        sent = await get(served.port, "/shared/gateway.js", f"Origin: {origin}")
        assert sent.status == 200
        assert sent.headers["access-control-allow-origin"] == (origin if is_shared else None)
        assert "Origin" in sent.headers["vary"]


async def test_a_cached_file_is_not_sent_again(serve, files):
    async with serve(files=files) as served:
        first = await get(served.port, "/style.css")
        tag = first.headers["etag"]
        for known in (tag, f'"other", W/{tag}'):
            again = await get(served.port, "/style.css", f"If-None-Match: {known}")
            assert (again.status, again.body) == (304, b"")
            assert again.headers["etag"] == tag
        other = await get(served.port, "/style.css", 'If-None-Match: "other"')
        assert (other.status, other.body) == (200, first.body)


@pytest.mark.parametrize(
    ("header", "is_compressed"),
    [
        (GZIP, True),
        ("Accept-Encoding: gzip", True),
        ("Accept-Encoding: gzip; q=0", False),
        ("Accept-Encoding: br", False),
        ("Accept-Encoding:", False),
    ],
)
async def test_it_is_compressed_for_browsers_that_accept_gzip(serve, files, header, is_compressed):
    async with serve(files=files) as served:
        sent = await get(served.port, "/style.css", header)
        assert ("content-encoding" in sent.headers) is is_compressed
        assert sent.headers["vary"] == "Accept, Accept-Encoding, Origin"
        body = gzip.decompress(sent.body) if is_compressed else sent.body
        assert body == (PAGES / "style.css").read_bytes()


@needs_websockets_17
async def test_head_has_the_length_and_no_body(serve, files):
    async with serve(files=files) as served:
        sent = await get(served.port, "/style.css", method="HEAD")
        assert (sent.status, sent.body) == (200, b"")
        assert int(sent.headers["content-length"]) == (PAGES / "style.css").stat().st_size


@pytest.mark.parametrize(
    "path",
    [
        "/debug",
        "/debug/",
        "/vendor/uplot.LICENSE",
        "/../app.py",
        "/debug/../../app.py",
        "/%2e%2e/app.py",
        "/style.css/",
    ],
)
async def test_nothing_else_is_served(serve, files, path):
    async with serve(files=files) as served:
        assert (await get(served.port, path)).status in {400, 404}


async def test_a_token_in_the_address_is_refused_here_too(serve, files):
    async with serve(files=files) as served:
        sent = await get(served.port, "/?token=r2g_x", HTML)
        assert sent.status == 400


def test_no_page_asks_for_anything_from_elsewhere_or_has_code_in_its_markup():
    code = r"innerHTML|insertAdjacentHTML|document\.write|\beval\(|\bon\w+=\"|\bstyle="
    for path in OWN:
        text = path.read_text("utf-8")
        assert "SPDX-License-Identifier: Apache-2.0" in text, path
        assert not re.search(rf"https?://(?!www\.w3\.org/)|{code}", text), path

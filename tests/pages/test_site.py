# SPDX-License-Identifier: Apache-2.0
"""The site that `make site` builds: all links hold, and nothing comes from another host."""

import functools
import http.server
import importlib.util
import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

ROOT = Path(__file__).parents[2]
MERMAID = Path(sys.prefix) / "clients/mermaid-11.17.2"
BUILD_S = 300
# a page loads these by itself. Only a reader follows a link
LOADED = re.compile(r"<(?:script|img|iframe|source|link)\b[^>]*?\b(?:src|href)=\"?([^\"\s>]+)")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if importlib.util.find_spec("material") is None:
        pytest.skip("mkdocs-material is not installed: run make site")
    if not MERMAID.exists():
        pytest.skip("mermaid is not installed: run make site")
    folder = tmp_path_factory.mktemp("site")
    built = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", folder],
        cwd=ROOT,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        timeout=BUILD_S,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    return folder


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            """Say nothing."""

    handler = functools.partial(Handler, directory=site)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def test_no_page_loads_anything_from_another_host(site: Path):
    pages = list(site.rglob("*.html"))
    loaded = [url for page in pages for url in LOADED.findall(page.read_text("utf-8"))]
    assert loaded
    assert [url for url in loaded if urlsplit(url).netloc] == []


@pytest.mark.asyncio(loop_scope="package")
async def test_diagrams_are_drawn_and_the_search_finds_a_page(open_page, address: str):
    async with open_page(f"{address}/contributing/architecture/") as page:
        drawn = page.locator("div.mermaid").first
        await drawn.wait_for()
        # The theme draws into a closed shadow root, so only the size shows the diagram.
        box = await drawn.bounding_box()
        assert box["height"] > 100
        # The theme listens for keys, and not for changes of the text.
        await page.locator("input.md-search__input").press_sequentially("GatewayClient")
        # While the word is typed, the first result is another one.
        await page.locator(".md-search-result__item:first-child a[href*='unity/']").first.wait_for()

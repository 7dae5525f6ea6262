# SPDX-License-Identifier: Apache-2.0
"""Pictures by plain HTTP in a real browser, next to the simulated robot."""

import http.server
import threading
from functools import partial

import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.pages.conftest import page_address

pytestmark = pytest.mark.asyncio(loop_scope="package")

SHOW = """address => {
    const shown = document.createElement("img");
    shown.id = "shown";
    shown.src = address;
    document.body.append(shown);
}"""
# the width of a picture, 0 if the browser does not show it
LOAD = """async address => {
    const shown = new Image();
    shown.src = address;
    await shown.decode().catch(() => null);
    return shown.naturalWidth;
}"""
HAS_PICTURE = "() => document.getElementById('shown').naturalWidth === 160"
# of what moves: until a later picture differs from the one that was drawn before
CHANGES = """() => {
    const shown = document.getElementById("shown");
    const copy = new OffscreenCanvas(shown.naturalWidth, shown.naturalHeight).getContext("2d");
    copy.drawImage(shown, 0, 0);
    const { data } = copy.getImageData(0, 0, shown.naturalWidth, shown.naturalHeight);
    const text = data.join();
    window.first ??= text;
    return text !== window.first;
}"""


async def test_an_img_of_a_page_shows_a_stream(demo, open_page):
    async with client(demo.url) as speaker:
        await until_it_can_be_driven(speaker)
        async with open_page(f"{page_address(demo)}drive") as page:
            await page.evaluate(SHOW, "/stream?topic=/camera/image_raw&width=160&fps=10")
            await page.wait_for_function(HAS_PICTURE)
            await speaker.send(op="publish", topic="/cmd_vel", msg={"angular": {"z": 0.5}})
            await page.wait_for_function(CHANGES)


async def test_an_img_of_a_page_shows_a_snapshot(demo, open_page):
    async with open_page(f"{page_address(demo)}drive") as page:
        await page.evaluate(SHOW, "/snapshot?topic=/camera/image_raw&width=160")
        await page.wait_for_function(HAS_PICTURE)


@pytest.fixture
def elsewhere(tmp_path):
    """Return the port of another server on this machine, with an empty page."""
    (tmp_path / "index.html").write_text("<!doctype html><title>elsewhere</title>")
    handler = partial(QuietHandler, directory=tmp_path)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.server_port
        server.shutdown()
        thread.join()


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    """Serves a folder, and writes no log."""

    def log_message(self, *_):
        """Write nothing."""


@pytest.mark.parametrize(("host", "shows"), [("127.0.0.1", True), ("localhost", False)])
async def test_pages_of_the_same_host_get_pictures_and_foreign_ones_none(
    demo, browser, elsewhere, host, shows
):
    context = await browser.new_context()
    page = await context.new_page()
    await page.goto(f"http://{host}:{elsewhere}/")
    gateway = page_address(demo)
    assert "//127.0.0.1:" in gateway
    found = await page.evaluate(LOAD, f"{gateway}snapshot?topic=/camera/image_raw&width=160")
    assert found == (160 if shows else 0)
    await context.close()

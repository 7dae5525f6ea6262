# SPDX-License-Identifier: Apache-2.0
"""A real browser on the pages of a real gateway with the simulated robot."""

import asyncio
import contextlib
import functools
import http.server
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import pytest_asyncio

from tests import dds_domain
from tests.client import Client, client
from tests.demonstration import demonstration, until_it_can_be_driven
from tests.gateway_process import GatewayProcess, gateway_process
from tests.pages.patient_demo import PATIENT

TIMEOUT_S = 120  # a busy machine starts a browser for a while
HAS_CHROMIUM = Path("/usr/lib/chromium/chromium-headless-shell").exists()
CHROMIUM = Path(__file__).with_name("chromium.sh")
DESK = {"width": 1280, "height": 800}
OWN_TOPICS = {"/diagnostics", "/parameter_events", "/rosout"}  # of a gateway
HOW = "no browser: run tools/make-browser.sh as root, and pip install playwright"

# a card that gets what `take` and `says` give it. Time passes when `drawn` draws it
ALONE = """async ({ view, type = "std_msgs/msg/Float64", types = [type], ...others }) => {
    const { fields = [], settings = {} } = others;
    const { TopicCard } = await import("/debug/cards/topic_card.js");
    window.now = 1000;
    performance.now = () => now;
    window.subscriptions = [];
    window.takes = {}; // by topic
    window.hear = {};
    const gateway = {
        graph: {
            typeOf: () => types[0],
            topics: new Map([["/x", { types, publishers: ["/talker"] }]]),
        },
        isOpen: true,
        on: (name, take) => { hear[name] = take; return () => {}; },
        throttleOf: () => 0,
        subscribe: (topic, options, take, says) => {
            subscriptions.push(options);
            window.take = takes[topic] = (message) => take(message, 9, "{}", 0);
            window.says = says;
            return () => {};
        },
    };
    const shown = { topic: "/x", view, fields, rate: 0, settings };
    window.gateway = gateway;
    window.alone = new TopicCard(gateway, shown, { changed() {}, open() {} });
    document.getElementById("cards").append(alone.element);
    window.drawn = () => { now += 100; alone.draw(now); alone.tick(); };
    window.press = (name) => alone.element.querySelector(`[aria-label="${name}"]`).click();
}"""
NO_CLIPBOARD = """
    window.copied = [];
    const writeText = async (text) => copied.push(text);
    Object.defineProperty(navigator, "clipboard", { value: { writeText } });
"""

OpenPage = Callable[..., AbstractAsyncContextManager["Page"]]  # noqa: F821  # of playwright


@pytest_asyncio.fixture(scope="package", loop_scope="package")
async def browser():
    if not HAS_CHROMIUM:
        pytest.skip(HOW)
    playwright = pytest.importorskip("playwright.async_api", reason=HOW)
    async with playwright.async_playwright() as driver:
        # as root Chromium has no sandbox, and it sees nothing but our own pages
        arguments = ["--no-sandbox", "--disable-dev-shm-usage"]
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield browser
        await browser.close()


@pytest.fixture(scope="module")
def nowhere() -> tuple[str, str]:
    """The options of a gateway in a DDS domain without a robot."""
    return "--domain-id", str(dds_domain.claim())


@pytest_asyncio.fixture(scope="package", loop_scope="package")
async def lonely_gateway() -> AsyncIterator[GatewayProcess]:
    """A gateway without a robot."""
    async with gateway_process("serve", "--domain-id", str(dds_domain.claim())) as gateway:
        yield gateway


@pytest_asyncio.fixture(loop_scope="package")
async def served(lonely_gateway: GatewayProcess) -> GatewayProcess:
    """Return the gateway without a robot once nothing is left of the test before."""
    async with client(lonely_gateway.url) as looking, asyncio.timeout(TIMEOUT_S):
        names = {"left"}
        while names - OWN_TOPICS:
            await looking.send(op="graph")
            graph = await looking.receive(lambda frame: frame["op"] == "graph")
            names = {each["name"] for kind in ("topics", "actions") for each in graph[kind]}
            names |= {each["name"] for each in graph["services"] if "debug" not in each["name"]}
    return lonely_gateway


@pytest_asyncio.fixture(scope="module", loop_scope="package")
async def evaluate(browser, lonely_gateway):
    """Return a function that runs a script next to the pages' modules, which it may import."""
    page = await browser.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    await page.goto(f"{page_address(lonely_gateway)}style.css")
    yield page.evaluate
    await page.close()
    assert wrong == []


@functools.cache
def robots_domain() -> int:
    """Return a DDS domain of these robots alone: other tests' robots drive by /cmd_vel as well."""
    return dds_domain.claim()


@pytest_asyncio.fixture(scope="module", loop_scope="package")
async def demo() -> AsyncIterator[GatewayProcess]:
    apart = ("env", f"ROS_DOMAIN_ID={robots_domain()}")
    demo = demonstration(*PATIENT, module="tests.pages.patient_demo", before=apart)
    async with demo as gateway:
        yield gateway


@pytest_asyncio.fixture(loop_scope="package")
async def speaker(demo: GatewayProcess) -> AsyncIterator[Client]:
    """Another client of the demonstration, whose robot can be driven."""
    async with client(demo.url) as speaker:
        await until_it_can_be_driven(speaker)
        yield speaker


class _FileHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Say nothing."""


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """A folder that a web server of this machine serves, and the address of that."""
    handler = functools.partial(_FileHandler, directory=tmp_path)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield tmp_path, f"http://localhost:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


def page_address(gateway: GatewayProcess) -> str:
    """Return where a gateway's pages are."""
    return gateway.url.replace("ws://", "http://")


@pytest.fixture
def open_page(browser) -> OpenPage:
    """Return a function that opens a page, which must stay without an error until it is closed.

    The script runs before those of the page.
    """

    @contextlib.asynccontextmanager
    async def open_it(address: str, viewport=DESK, script="", **options):
        wrong: list[str] = []
        context = await browser.new_context(viewport=viewport, **options)
        await context.add_init_script(script)
        page = await context.new_page()
        page.set_default_timeout(TIMEOUT_S * 1000)
        page.on("pageerror", lambda error: wrong.append(f"raised: {error}"))
        # the driver's own word on WebGL without a GPU
        page.on(
            "console",
            lambda line: (
                "GPU stall due to ReadPixels" in line.text
                or wrong.append(f"{line.type}: {line.text}")
            ),
        )
        host = urlsplit(address).netloc
        page.on(
            "request",
            # a blank page goes elsewhere later, and is not watched
            lambda each: (
                not host or urlsplit(each.url).netloc in {host, ""} or wrong.append(each.url)
            ),
        )
        page.wrong = wrong
        try:
            await page.goto(address)
            yield page
        finally:  # or it would go on drawing next to all later tests
            await context.close()
        assert wrong == []

    return open_it


@pytest.fixture
def open_card(open_page, served):
    """Return a function that opens a page with one card, which is fed by hand."""

    @contextlib.asynccontextmanager
    async def open_it(view: str, **shown):
        address = page_address(served) + "#card=none"  # which is said, and leaves the place empty
        async with open_page(address, script=NO_CLIPBOARD) as page:
            await page.wait_for_selector("#cards > .empty")
            await page.evaluate(ALONE, {"view": view, **shown})
            yield page

    return open_it


async def saved(page, press) -> tuple[str, str]:
    """Return the name and the text of the file that a page saves once something is pressed."""
    async with page.expect_download() as expected:
        await press
    download = await expected.value
    return download.suggested_filename, text_of(await download.path())


def text_of(path: Path) -> str:
    return Path(path).read_text(encoding="utf-8")


class Line:
    """The connections of a page to its gateway, which can be cut, and mended."""

    def __init__(self) -> None:
        self._routes: list[WebSocketRoute] = []  # noqa: F821  # of playwright
        self._is_cut = False

    async def take(self, route) -> None:
        """Let a new connection through, or not."""
        if self._is_cut:
            await route.close()
            return
        route.connect_to_server()
        self._routes.append(route)

    async def cut(self) -> None:
        """End all connections. New ones end at once."""
        self._is_cut = True
        for route in self._routes:
            await route.close()
        self._routes.clear()

    def mend(self) -> None:
        """Let new connections through."""
        self._is_cut = False


@contextlib.asynccontextmanager
async def severable(page) -> AsyncIterator[Line]:
    """Stand between a page that is blank yet and its gateway."""
    line = Line()
    await page.route_web_socket("**/*", line.take)
    yield line

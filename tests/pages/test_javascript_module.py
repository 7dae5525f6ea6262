# SPDX-License-Identifier: Apache-2.0
"""The JavaScript module in another page: the example of the docs, in a real browser."""

from urllib.parse import urlsplit

import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.doc_blocks import texts
from tests.pages.conftest import page_address

HOW_TO = "how-to/javascript-module.md"

pytestmark = pytest.mark.asyncio(loop_scope="package")


def serve(files, gateway) -> None:
    """Write the page of the docs, for a gateway of another port."""
    (html,) = texts(HOW_TO, "html")
    assert html.count("9090") == 1
    (files / "index.html").write_text(html.replace("9090", str(urlsplit(gateway.url).port)))
    (files / "favicon.ico").touch()


@pytest.fixture
def example(demo, folder):
    """Return the address of the example."""
    files, address = folder
    serve(files, demo)
    return address


async def test_the_example_shows_calls_and_stops(demo, example, browser):
    context = await browser.new_context()
    page = await context.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda line: wrong.append(line.text))
    async with client(demo.url) as person:
        await until_it_can_be_driven(person)
        await page.goto(example)
        await page.wait_for_function("() => state.textContent.startsWith('open')")
        await page.wait_for_function("() => x.textContent.endsWith(' m')")
        await page.wait_for_function("() => Number(topics.textContent) > 5")
        await page.click("#reset")
        await page.wait_for_function("() => error.textContent === 'The robot is at its start.'")
        await person.send(op="control", topic="/cmd_vel", watch=True)
        await person.send(
            op="publish",
            topic="/cmd_vel",
            type="geometry_msgs/msg/Twist",
            msg={"angular": {"z": 0.1}},
        )
        await person.receive(lambda frame: frame.get("state") == "moving")
        await page.click("#stop")
        await person.receive(lambda frame: frame.get("cause") == "stop")
    await context.close()
    assert wrong == []


async def test_a_page_that_may_not_connect_cannot_import_it(demo, browser):
    """Nor learn that there is a gateway from what it may read."""
    context = await browser.new_context()
    page = await context.new_page()
    await page.route(
        "http://elsewhere.example/*", lambda route: route.fulfill(body="", content_type="text/html")
    )
    await page.goto("http://elsewhere.example/")
    address = f"{page_address(demo)}shared/gateway.js"
    said = await page.evaluate(
        "address => fetch(address).then(() => 'read', (error) => error.name)", address
    )
    assert said == "TypeError"
    await context.close()


async def test_a_connection_ends_for_good_and_begins_again(evaluate, served):
    address = served.url
    states = await evaluate(
        """async (address) => {
            const { Gateway } = await import("/shared/gateway.js");
            const gateway = new Gateway({ address, token: "" });
            const states = [];
            gateway.on("state", ({ state }) => states.push(state));
            const until = (wanted) => new Promise((done) => {
                const end = gateway.on("state", ({ state }) => state === wanted && (end(), done()));
            });
            for (const _ of [1, 2]) {
                const isOpen = until("open");
                gateway.connect();
                await isOpen;
                gateway.close();
            }
            await new Promise((done) => setTimeout(done, 800)); // longer than it waits to retry
            return [states, gateway.isOpen];
        }""",
        address,
    )
    assert states == [["connecting", "open", "closed"] * 2, False]


async def test_statuses_that_nobody_takes_are_events_and_a_token_stays_in_memory(evaluate, served):
    said = await evaluate(
        """async (address) => {
            const { Gateway } = await import("/shared/gateway.js");
            const gateway = new Gateway({ address, token: "Bearer abc" });
            const status = new Promise((done) => gateway.on("status", done));
            gateway.subscribe("bad name", {}, () => {});
            gateway.connect();
            const { code } = await status;
            gateway.close();
            return { code, kept: Object.keys(sessionStorage) };
        }""",
        f"{served.url}/?status=warning",
    )
    assert said == {"code": "bad_name", "kept": []}


async def test_a_listener_that_throws_starves_no_other(served, open_page):
    """Neither of messages nor of what is said of the topic. The page gets each error."""
    async with open_page(f"{page_address(served)}style.css") as page, client(served.url) as speaker:
        await speaker.send(op="advertise", topic="/talk", type="std_msgs/msg/Bool", latch=True)
        await speaker.send(op="publish", topic="/talk", msg={"data": True})
        await page.evaluate(
            """async (address) => {
                const { Gateway } = await import("/shared/gateway.js");
                window.gateway = new Gateway({ address, token: "" });
                Object.assign(window, { heard: new Set(), thrown: new Set() });
                addEventListener("error", (event) => {
                    event.preventDefault();
                    thrown.add(event.message);
                });
                const fail = (what) => { throw new Error(what); };
                for (const take of [fail, (what) => heard.add(what)]) {
                    gateway.subscribe("/talk", {}, () => take("true"), ({ code }) => take(code));
                }
                gateway.connect();
            }""",
            f"{served.url}/?status=warning",
        )
        await page.wait_for_function("() => heard.has('true') && gateway.arrivals.has('/talk')")
        await speaker.send(op="unadvertise", topic="/talk")
        await page.wait_for_function("() => heard.has('publisher_gone')")
        thrown = await page.evaluate("() => [...thrown]")
        assert {"Uncaught Error: true", "Uncaught Error: publisher_gone"} <= set(thrown)
        await page.evaluate("() => gateway.close()")

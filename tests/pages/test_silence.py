# SPDX-License-Identifier: Apache-2.0
"""A dead connection: nothing arrives any more, and no side is told."""

import contextlib

import pytest

from tests.pages.conftest import page_address
from tests.pages.test_drive_page import Watched, drive_by, watched

__all__ = ["watched"]  # a fixture

pytestmark = pytest.mark.asyncio(loop_scope="package")

# Frames into a dead connection arrive when it is back, as by TCP.
SOCKETS = """
    const Real = WebSocket;
    let late = [];
    window.WebSocket = class extends Real {
        constructor(...all) {
            super(...all);
            this.addEventListener("message", (event) => {
                if (this.isDark) event.stopImmediatePropagation();
            });
            (window.sockets ??= []).push(this);
        }
        send(data) {
            if (this.isDark) late.push([this, data]);
            else super.send(data);
        }
    };
    window.darken = (isIt, those = sockets) => {
        for (const each of those) each.isDark = isIt;
        if (isIt) return;
        for (const [each, data] of late.splice(0)) each.send(data);
    };
"""
SILENT = ".state[data-state=silent]:has-text('no answer for')"
UNCONFIRMED = "() => notice.textContent.startsWith('STOP is not confirmed')"


@pytest.fixture
def on_a_link(demo, open_page):
    """Return a function that opens the drive page, which gives up a silent link after 5 s."""

    async def short(route) -> None:
        response = await route.fetch()
        text = (await response.text()).replace("LOST_BEATS = 15", "LOST_BEATS = 5")
        await route.fulfill(body=text, content_type="text/javascript")

    @contextlib.asynccontextmanager
    async def open_it(*, is_short: bool):
        async with open_page("about:blank", script=SOCKETS) as page:
            if is_short:
                await page.route("**/shared/pulse.js", short)
            await page.goto(f"{page_address(demo)}drive")
            page.wrong.clear()
            await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
            yield page

    return open_it


async def test_a_link_that_is_dark_for_a_moment_is_said_and_what_was_held_moves_nothing(
    on_a_link, watched: Watched
):
    async with on_a_link(is_short=False) as page:
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.evaluate("() => darken(true)")
        await watched.until(state="stopped")
        await page.wait_for_selector(SILENT)
        assert "has not answered for" in await page.inner_text("#control")
        await page.click("#stop")
        await page.wait_for_function(UNCONFIRMED)
        await page.evaluate("() => darken(false)")
        await page.wait_for_function("() => notice.textContent === 'The gateway stopped /cmd_vel.'")
        await page.wait_for_selector(".state[data-state=open]:text-is('connected')")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await page.wait_for_timeout(300)  # in which it would go on, several times over
        assert (await page.inner_text("#control")).startswith("Stopped")
        await page.keyboard.up("ArrowLeft")


async def test_a_link_that_stays_dark_is_given_up_for_another(on_a_link, watched: Watched):
    async with on_a_link(is_short=True) as page:
        await page.evaluate("() => darken(true)")
        await page.click("#stop")
        await page.wait_for_function(UNCONFIRMED)
        await page.wait_for_function("() => state.textContent.startsWith('not connected: no ans')")
        await page.wait_for_function("() => notice.textContent.includes('connection was lost')")
        await page.wait_for_function("() => sockets.length > 1")
        await page.wait_for_selector(".state[data-state=open]")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.keyboard.up("ArrowLeft")
        await watched.until(state="stopped")


async def test_a_gateway_that_takes_connections_and_answers_nothing_is_tried_again(on_a_link):
    darken_each = "() => { setInterval(() => window.isNight && darken(true), 0); isNight = true; }"
    async with on_a_link(is_short=True) as page:
        await page.evaluate(darken_each)
        await page.wait_for_function("() => sockets.length > 2")
        await page.evaluate("() => { isNight = false; }")
        await page.wait_for_selector(".state[data-state=open]")


async def test_a_page_tries_again_at_the_latest_every_two_seconds(demo, open_page):
    attempts = """async () => {
        const { Gateway } = await import("/shared/gateway.js");
        const pauses = [];
        window.WebSocket = class {
            constructor() {
                queueMicrotask(() => this.onclose({ code: 1006, reason: "" }));
            }
        };
        return new Promise((resolve) => {
            window.setTimeout = (attempt, pause) => {
                if (pauses.push(pause) === 6) resolve(pauses);
                else queueMicrotask(attempt);
            };
            new Gateway().connect();
        });
    }"""
    async with open_page(page_address(demo)) as page:
        assert await page.evaluate(attempts) == [500, 1000, 2000, 2000, 2000, 2000]

# SPDX-License-Identifier: Apache-2.0
"""The debug page counts dropped messages, but not those that a rate leaves out."""

import asyncio
import json

import pytest

from tests.client import eventually
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import card, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

PLOT = "#card=plot+{rate}+/imu+linear_acceleration.z"
FOOTER = "document.querySelector('article footer')?.textContent"
BAR = "/dropped ?(\\d+)/.exec(figures.textContent)?.[1]"


class Count:
    """Stands between a page and its gateway, and changes what `meta` says of drops."""

    def __init__(self) -> None:
        self.dropped = 0
        self.step = 0  # that it grows by with each message
        self.answers_pings = True
        self.held: list[str] | None = None  # the frames to the page, while they are held up
        self.is_sent = asyncio.Event()  # a message with that count

    def set(self, dropped: int) -> None:
        """Say from now on that so many were dropped."""
        self.dropped = dropped
        self.is_sent.clear()

    def release(self) -> None:
        """Let the page have what is on its way, in its order."""
        held, self.held = self.held or [], None
        for message in held:
            self._send(message)

    def take(self, route) -> None:
        server = route.connect_to_server()

        def pass_on(message):
            if not self.answers_pings and '"op":"pong"' in message[:40]:
                return
            changed = self._changed(message)
            if self.held is None:
                route.send(changed)
            else:
                self.held.append(changed)

        self._send = route.send

        server.on_message(pass_on)

    def _changed(self, message):
        if '"op":"publish"' not in message[:40]:
            return message
        self.is_sent.set()
        self.dropped += self.step
        return json.dumps(json.loads(message) | {"dropped": self.dropped})


async def opened_at(page, demo, card_text: str, *, answers_pings: bool = True) -> Count:
    """Open the debug page with a card, through a count of ours."""
    count = Count()
    count.answers_pings = answers_pings
    await page.route_web_socket("**/*", count.take)
    await page.goto(page_address(demo) + card_text)
    await until(page, f"() => /Hz/.test({FOOTER})")
    return count


def forgive_the_first_address(page) -> None:
    page.wrong[:] = [each for each in page.wrong if not each.startswith("http")]


async def test_drops_of_the_connection_are_counted_from_message_to_message(demo, open_page):
    async with open_page("about:blank") as page:
        # nothing has been throttled, so that there is nothing to wait for
        count = await opened_at(page, demo, PLOT.format(rate=0), answers_pings=False)
        assert "dropped" not in await page.evaluate(f"() => {FOOTER}")
        count.set(7)
        await until(page, f"() => / 7 dropped/.test({FOOTER})")
        count.set(9)
        await until(page, f"() => / 9 dropped/.test({FOOTER})")
        await until(page, f"() => {BAR} === '9'")
        await page.click(f"{card('/imu')} button[aria-label='close /imu']")
        await page.click("#topics button:has-text('/odom')")
        await until(page, f"() => /Hz/.test({FOOTER})")  # both are written together
        assert await page.evaluate(f"() => {BAR}") == "9"
        forgive_the_first_address(page)


async def test_messages_that_a_rate_leaves_out_are_not_drops_and_the_rate_is_said(demo, open_page):
    async with open_page("about:blank") as page:
        count = await opened_at(page, demo, PLOT.format(rate=5))
        await until(page, f"() => {FOOTER}.endsWith('limited to 5 Hz by this page')")
        count.set(400)  # the gateway counts them as well
        await count.is_sent.wait()
        # without a rate, earlier ones do not count either
        await page.select_option(f"{card('/imu')} select[aria-label^=rate]", "0")
        await until(page, f"() => /^[1-9]\\d Hz/.test({FOOTER}) && !/limited/.test({FOOTER})")
        assert "dropped" not in await page.evaluate(f"() => {FOOTER}")
        assert await page.evaluate(f"() => {BAR}") == "0"
        count.set(403)
        await until(page, f"() => / 3 dropped/.test({FOOTER})")
        forgive_the_first_address(page)


async def test_messages_that_a_rate_left_out_are_not_drops_if_the_last_come_late(demo, open_page):
    async with open_page("about:blank") as page:
        count = await opened_at(page, demo, PLOT.format(rate=5))
        await until(page, f"() => {FOOTER}.endsWith('limited to 5 Hz by this page')")
        count.held, count.step = [], 400
        of_imu = '"op": "publish"'
        await eventually(lambda: sum(of_imu in message for message in count.held) >= 2)
        count.step = 0
        await page.select_option(f"{card('/imu')} select[aria-label^=rate]", "0")
        count.release()
        await until(page, f"() => /^[1-9]\\d Hz/.test({FOOTER}) && !/limited/.test({FOOTER})")
        assert "dropped" not in await page.evaluate(f"() => {FOOTER}")
        assert await page.evaluate(f"() => {BAR}") == "0"
        forgive_the_first_address(page)

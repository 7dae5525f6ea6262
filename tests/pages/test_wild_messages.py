# SPDX-License-Identifier: Apache-2.0
"""Wild messages of a robot: a page says why it cannot show them, and still obeys."""

import contextlib

import pytest

from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import card, until, until_painted

pytestmark = pytest.mark.asyncio(loop_scope="package")

SCAN = "sensor_msgs/msg/LaserScan"
POSE = "geometry_msgs/msg/PoseStamped"
MAP = "nav_msgs/msg/OccupancyGrid"
FLOAT = "std_msgs/msg/Float64"
INFINITE = "Infinity"
NO_HIT = {"angle_increment": 0.1, "range_min": 0.1, "range_max": INFINITE}
FAR_AWAY = "it lies over a million km away"
NO_NUMBER = "a place in it is not a number"
CELLS = {"resolution": 0.05, "width": 3, "height": 2}


def at(x: object, y: object = 0.0) -> dict[str, object]:
    return {"pose": {"position": {"x": x, "y": y}}}


@contextlib.asynccontextmanager
async def said(nowhere, type_name: str, *messages: dict[str, object]):
    """Yield a gateway to which a client publishes these in turn, until the end."""
    async with gateway_process("serve", *nowhere) as gateway, client(gateway.url) as robot:
        await robot.send(op="advertise", topic="/wild", type=type_name)

        async def say() -> None:
            for message in messages:
                await robot.send(op="publish", topic="/wild", msg=message)

        yield gateway, say


@pytest.mark.parametrize(
    ("view", "type_name", "messages", "words"),
    [
        ("scan", SCAN, [NO_HIT | {"ranges": [1.5, INFINITE, 2]}], ""),
        ("scan", SCAN, [NO_HIT | {"ranges": [INFINITE] * 3}], ""),
        ("scan", SCAN, [NO_HIT | {"ranges": [1e20, 2]}], FAR_AWAY),
        ("trail", POSE, [at(1e17, 3), at(1e17, 4)], FAR_AWAY),
        ("trail", POSE, [at("NaN", 3)], NO_NUMBER),
        (
            "map",
            MAP,
            [{"info": CELLS | {"origin": {"position": {"x": 1e17}}}, "data": [0] * 6}],
            FAR_AWAY,
        ),
        ("plot", FLOAT, [{"data": 1e17}, {"data": 1e17 + 16}], ""),
        ("plot", FLOAT, [{"data": 1.7e308}, {"data": -1.7e308}, {"data": 1.7e308}], ""),
        ("plot", FLOAT, [{"data": 5e-324}, {"data": 0.0}], ""),
        ("plot", FLOAT, [{"data": "NaN"}, {"data": INFINITE}], ""),
        ("plot", "std_msgs/msg/String", [{"data": "hello"}], "data is not a number"),
    ],
)
async def test_a_view_shows_it_or_says_why_and_the_page_goes_on(
    open_page, nowhere, view, type_name, messages, words
):
    async with said(nowhere, type_name, *messages) as (gateway, say):
        fields = "+data" if view == "plot" else ""
        address = f"{page_address(gateway)}#card={view}+0+/wild{fields}"
        async with open_page(address) as page:
            problem = "document.querySelector('article .problem').textContent"
            came = "/ Hz · /.test(document.querySelector('article footer').textContent)"
            await page.wait_for_selector(card("/wild"))
            while not await page.evaluate(f"() => {came}"):
                await say()
                await page.wait_for_timeout(100)
            if view == "plot" and not words:
                await until_painted(page, ".uplot canvas")
            if words:
                await until(page, f"words => {problem}.includes(words)", words)
            for _ in range(2):  # frames in which it is drawn
                await page.evaluate("() => new Promise(requestAnimationFrame)")
            assert await page.evaluate(f"() => {problem}") == "" or words


async def test_the_drive_page_says_it_and_stops_the_robot_all_the_same(open_page, nowhere):
    far = {"info": CELLS | {"origin": {"position": {"x": 1e17}}}, "data": [0] * 6}
    async with (
        said(nowhere, MAP, far) as (gateway, say),
        open_page(f"{page_address(gateway)}drive") as page,
    ):
        await page.wait_for_selector("#world canvas")
        while FAR_AWAY not in await page.text_content("#world .problem"):
            await say()
            await page.wait_for_timeout(100)
        await page.click("#stop")


async def test_the_drive_page_says_what_cannot_be_shown_until_something_can(open_page, served):
    async with (
        client(served.url) as robot,
        open_page(f"{page_address(served)}drive") as page,
    ):
        await robot.send(op="advertise", topic="/wild", type=SCAN, latch=True)
        await robot.send(op="publish", topic="/wild", msg=NO_HIT | {"ranges": [1e20, 2]})
        words = "() => document.querySelector('#world .problem')?.textContent"
        await until(page, f"() => /^Cannot show the data/.test(({words})())")
        await robot.send(op="publish", topic="/wild", msg=NO_HIT | {"ranges": [1, 2]})
        await until(page, f"() => ({words})() === ''")


@pytest.mark.parametrize(
    ("type_name", "place", "bad", "words", "good"),
    [
        (
            "sensor_msgs/msg/Image",
            "camera",
            {"encoding": "rgb8"},
            "image is 0x0",
            {"encoding": "rgb8", "width": 2, "height": 1, "step": 6, "data": [0, 0, 0, 9, 99, 250]},
        ),
        (
            MAP,
            "world",
            {"info": {"resolution": 0.05}},
            "no cells",
            {"info": CELLS, "data": [0] * 6},
        ),
    ],
    ids=["picture", "map"],
)
async def test_the_drive_page_says_what_is_empty_until_it_is_not(
    open_page, served, type_name, place, bad, words, good
):
    async with (
        client(served.url) as robot,
        open_page(f"{page_address(served)}drive") as page,
    ):
        await robot.send(op="advertise", topic="/wild", type=type_name, latch=True)
        await robot.send(op="publish", topic="/wild", msg=bad)
        problem = f"document.querySelector('#{place} .problem')?.textContent"
        await until(page, f"words => {problem}?.includes(words)", words)
        await robot.send(op="publish", topic="/wild", msg=good)
        await until(page, f"() => {problem} === ''")


async def test_a_card_that_is_refused_takes_no_part_in_what_another_one_gets(demo, open_page):
    cards = "#card=tree+0+/odom&card=plot+0+/odom+no.such.field"
    async with open_page(page_address(demo) + cards) as page:
        await until(page, "() => /no.such/.test(cards.textContent)")
        tree = "document.querySelector('article footer').textContent"
        await until(page, f"() => /limited to 5 Hz by this page/.test({tree})")
        refused = "() => [...document.querySelectorAll('article footer')].at(-1).textContent"
        fields = "() => document.querySelector('.tree').textContent"
        for _ in range(10):  # between which drops would be counted
            await until(page, f"before => ({fields})() !== before", await page.evaluate(fields))
        assert "dropped" not in await page.evaluate(f"() => {tree}")
        assert "Hz" not in await page.evaluate(refused)
        assert await page.evaluate("() => /dropped ?0/.test(figures.textContent)")


async def test_a_view_that_does_not_fit_does_not_say_that_nothing_comes(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=image+0+/odom") as page:
        await until(page, "() => /not Odometry: choose another view/.test(cards.textContent)")
        await until(page, "() => document.querySelector('article footer').textContent === ''")

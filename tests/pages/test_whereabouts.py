# SPDX-License-Identifier: Apache-2.0
"""The place of the robot on the map of the drive page, which must not be old."""

import asyncio
import contextlib

import pytest

from tests.client import client, eventually
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import until, until_painted
from tests.pages.test_world_views import COUNT

pytestmark = pytest.mark.asyncio(loop_scope="package")

PERIOD_S = 0.1
ROBOT = ["#world canvas", "--warning"]
HITS = ["#world canvas", "--scan"]
SHOWN = f"about => ({COUNT})(about) > 20"
GREY = f"about => ({COUNT})(about) === 0"
AGE = "document.querySelector('#world .age')"
# makes all that has come so far old
AGE_ALL = """() => {
    const now = performance.now.bind(performance);
    performance.now = () => now() + 60_000;
}"""


class Robot:
    """A robot by a client: ten times a second it says what a map needs, if not taken away."""

    def __init__(self, speaker) -> None:
        self._speaker = speaker
        self.transforms: dict[str, str] = {}  # child -> parent
        self._stamp = 1000  # tenths of a second

    async def begin(self) -> None:
        """Say what is said once."""
        for topic, kind in (
            ("/tf", "tf2_msgs/msg/TFMessage"),
            ("/scan", "sensor_msgs/msg/LaserScan"),
        ):
            await self._speaker.send(op="advertise", topic=topic, type=kind)
        await self._speaker.send(op="advertise", topic="/odom", type="nav_msgs/msg/Odometry")
        latched = {"op": "advertise", "latch": True}
        await self._speaker.send(**latched, topic="/map", type="nav_msgs/msg/OccupancyGrid")
        await self._speaker.send(**latched, topic="/tf_static", type="tf2_msgs/msg/TFMessage")
        info = {
            "resolution": 0.1,
            "width": 60,
            "height": 60,
            "origin": {"position": {"x": -3, "y": -3}},
        }
        grid = {"header": {"frame_id": "map"}, "info": info, "data": [0] * 3600}
        await self._speaker.send(op="publish", topic="/map", msg=grid)

    async def fasten(self, parent: str, child: str) -> None:
        """Say once where a frame is forever."""
        message = {"transforms": [self._transform(parent, child)]}
        await self._speaker.send(op="publish", topic="/tf_static", msg=message)

    async def go_on(self) -> None:
        """Say everything else again and again."""
        while True:
            self._stamp += 1
            moving = [self._transform(parent, child) for child, parent in self.transforms.items()]
            if moving:
                await self._say("/tf", {"transforms": moving})
            scan = {"angle_increment": 0.1, "range_max": 5.0, "ranges": [2.0] * 60}
            await self._say("/scan", {"header": {"frame_id": "laser"}} | scan)
            await self._say(
                "/odom", {"header": {"frame_id": "odom"}, "child_frame_id": "base_link"}
            )
            await asyncio.sleep(PERIOD_S)

    async def repeats(self) -> None:
        """Wait until all has been said some times more."""
        begun = self._stamp
        await eventually(lambda: self._stamp > begun + 10)

    async def _say(self, topic: str, message: dict[str, object]) -> None:
        await self._speaker.send(op="publish", topic=topic, msg=message)

    def _transform(self, parent: str, child: str) -> dict[str, object]:
        header = {
            "frame_id": parent,
            "stamp": {"sec": self._stamp // 10, "nanosec": self._stamp % 10 * 10**8},
        }
        return {"header": header, "child_frame_id": child, "transform": {"rotation": {"w": 1.0}}}


@pytest.fixture
def seen(nowhere, open_page):
    """Return a context with such a robot and a page that shows it."""

    @contextlib.asynccontextmanager
    async def see():
        async with gateway_process("serve", *nowhere) as gateway, client(gateway.url) as speaker:
            robot = Robot(speaker)
            await robot.begin()
            async with (
                open_page(f"{page_address(gateway)}drive") as page,
                asyncio.TaskGroup() as tasks,
            ):
                going = tasks.create_task(robot.go_on())
                yield robot, page
                going.cancel()

    return see


async def test_a_robot_whose_transforms_have_ceased_is_grey_and_its_age_is_said(seen):
    async with seen() as (robot, page):
        moving = {"odom": "map", "base_link": "odom", "laser": "base_link"}
        robot.transforms = moving
        for about in (ROBOT, HITS):
            await until(page, SHOWN, about)
        await robot.repeats()  # a transform sent once or twice might be meant to last
        del moving["base_link"]  # the start of the odometry is still sent
        await until(page, f"() => /^place [0-9.]+ m?s old$/.test({AGE}?.textContent)")
        for about in (ROBOT, HITS):
            await until(page, GREY, about)
        moving["base_link"] = "odom"
        for about in (ROBOT, HITS):
            await until(page, SHOWN, about)
        await until(page, f"() => {AGE}.hidden")


async def test_a_robot_that_never_moves_does_not_grow_old(seen):
    async with seen() as (robot, page):
        await robot.fasten("map", "base_link")
        robot.transforms = {"laser": "base_link"}
        for about in (ROBOT, HITS):
            await until(page, SHOWN, about)
        await page.evaluate(AGE_ALL)
        await page.wait_for_timeout(500)  # in which it would turn grey, several times over
        for about in (ROBOT, HITS):
            await until(page, SHOWN, about)
        await until(page, "() => !document.querySelector('#world.stale')")


async def test_transforms_that_are_missing_are_named_until_they_come(seen):
    async with seen() as (robot, page):
        await until_painted(page, "#world canvas")
        missing = "document.querySelector('#world .missing')"
        await until(page, f"() => /laser is in map: the scan/.test({missing}.textContent)")
        words = await page.text_content("#world .missing")
        assert "where base_footprint or base_link is in map: the robot is not shown" in words
        robot.transforms = {"base_link": "map"}
        await until(page, SHOWN, ROBOT)
        await until(page, f"() => /^No.* laser is in map: the scan/.test({missing}.textContent)")
        robot.transforms = {"base_link": "map", "laser": "base_link"}
        await until(page, SHOWN, HITS)
        await until(page, f"() => {missing}.hidden")


async def test_a_place_that_is_said_once_a_second_is_not_old_between(demo, open_page):
    async with open_page(f"{page_address(demo)}drive") as page:
        old = await page.evaluate("""async () => {
            const { Aging } = await import("/shared/aging.js");
            const { Arrivals } = await import("/shared/arrivals.js");
            const begin = performance.now();
            const said = new Arrivals();
            performance.now = () => begin;
            for (let each = 0; each < 3; each += 1) said.add(0, 0);
            const aging = new Aging(document.createElement("div"), { place: 2000 });
            return [1500, 2500].map((later) => {
                performance.now = () => begin + later;
                aging.write({ place: said, scan: said }, true);
                return aging.words;
            });
        }""")
        assert old == ["scan 1.5 s old", "place 2.5 s old · scan 2.5 s old"]

# SPDX-License-Identifier: Apache-2.0
"""Pages whose address names the topics that they show."""

import pytest

from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.lab import SMALL
from tests.pages.test_debug_page import NOTE_SENT

pytestmark = pytest.mark.asyncio(loop_scope="package")

PICTURES = {"op": "advertise", "type": "sensor_msgs/CompressedImage", "latch": True}
SUBSCRIBED = """topic => sent.map(JSON.parse).some(
    (frame) => frame.op === "subscribe" && frame.topic === topic
)"""


@pytest.fixture
def page_at(demo, open_page):
    """Return a function that opens the page of a path, which notes what it sends."""

    def open_it(path):
        return open_page(f"{page_address(demo)}{path}", viewport=SMALL, script=NOTE_SENT)

    return open_it


@pytest.mark.parametrize("path", ["drive", "lab", ""])
async def test_the_camera_of_the_address_is_shown_and_no_other(page_at, speaker, path):
    await speaker.send(**PICTURES, topic="/rear/image")
    async with page_at(f"{path}#camera=/rear/image") as page:
        await page.wait_for_function(SUBSCRIBED, arg="/rear/image")
        assert not await page.evaluate(SUBSCRIBED, "/camera/image_raw")


async def test_a_camera_that_comes_later_is_waited_for_in_words(page_at, speaker):
    async with page_at("drive#camera=/late/image") as page:
        await page.get_by_text("names /late/image, but no node publishes it").wait_for()
        await speaker.send(**PICTURES, topic="/late/image")
        await page.wait_for_function(SUBSCRIBED, arg="/late/image")
        assert not await page.evaluate(SUBSCRIBED, "/camera/image_raw")
        await page.get_by_text("no node publishes").wait_for(state="detached")


async def test_a_scan_that_is_named_lies_on_the_first_map(page_at, speaker):
    scan = {"op": "advertise", "topic": "/upper/scan", "type": "sensor_msgs/LaserScan"}
    await speaker.send(**scan)
    async with page_at("drive#scan=/upper/scan") as page:
        await page.wait_for_function(SUBSCRIBED, arg="/map")
        await page.wait_for_function(SUBSCRIBED, arg="/upper/scan")
        assert not await page.evaluate(SUBSCRIBED, "/scan")


async def test_a_map_that_is_missing_is_not_replaced_by_a_scan(page_at):
    async with page_at("drive#map=/other_map") as page:
        await page.get_by_text("names /other_map, but no node publishes it").wait_for()
        assert not await page.evaluate(SUBSCRIBED, "/scan")


async def test_a_topic_of_another_type_is_told_of(page_at):
    async with page_at("drive#camera=/odom") as page:
        words = "names /odom as camera, but its type is"
        await page.get_by_text(words).wait_for()


async def test_the_lab_says_which_of_its_topics_nobody_publishes(page_at):
    async with page_at("lab#odometry=/other/odom") as page:
        await page.wait_for_function(
            "() => missing.textContent.includes('names /other/odom, but no node publishes it')"
        )
        assert not await page.evaluate(SUBSCRIBED, "/odom")


@pytest.mark.parametrize("path", ["drive", "lab"])
async def test_the_robot_on_the_command_topic_of_the_address_is_driven(page_at, speaker, path):
    async with page_at(f"{path}#command=/cmd_vel") as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
    async with page_at(f"{path}#command=/other/cmd_vel") as page:
        await page.wait_for_function("() => control.textContent.includes('/other/cmd_vel')")
        await page.keyboard.press("ArrowUp")
        commands = "sent.map(JSON.parse).filter(({ op }) => op === 'publish').length"
        assert await page.evaluate(f"() => {commands}") == 0


@pytest.mark.parametrize("path", ["drive", "lab"])
async def test_unknown_names_in_the_address_are_said(page_at, path):
    async with page_at(f"{path}#cam=/rear/image") as page:
        notice = page.locator("#notice")
        await notice.get_by_text('unknown names: "cam". Use camera, map,').wait_for()


async def test_another_address_is_followed(page_at):
    async with page_at("drive#camera=/odom") as page:
        await page.get_by_text("as camera, but").wait_for()
        await page.evaluate("() => { location.hash = ''; }")
        await page.wait_for_selector("#camera canvas, #camera img")


@pytest.mark.parametrize("kind", ["scan", "odometry"])
async def test_the_drive_page_says_which_of_them_is_missing_until_it_comes(page_at, speaker, kind):
    type_name = {"scan": "sensor_msgs/LaserScan", "odometry": "nav_msgs/Odometry"}[kind]
    async with page_at(f"drive#{kind}=/missing/{kind}") as page:
        said = page.locator(f"#notice:has-text('names /missing/{kind}, but no node publishes it')")
        await said.wait_for()
        await speaker.send(op="advertise", topic=f"/missing/{kind}", type=type_name)
        await said.wait_for(state="hidden")


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("#camera=/a&camera=/b", "The address names camera 2 times. The first one counts."),
        ("?camera=/a", "The address has camera after a question mark: write it after #."),
    ],
)
async def test_an_address_that_is_meant_otherwise_is_told_of(page_at, address, words):
    async with page_at(f"drive{address}") as page:
        await page.locator("#notice").get_by_text(words).wait_for()


async def test_a_name_without_its_first_slash_is_understood(page_at, speaker):
    async with page_at("drive#command=cmd_vel&camera=camera/image_raw") as page:
        await page.wait_for_function(SUBSCRIBED, arg="/camera/image_raw")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")


async def test_a_topic_that_takes_no_commands_moves_nothing_and_says_how_to_mend_it(page_at):
    async with page_at("drive#command=/base/cmd_vel") as page:
        await page.get_by_text("See the setting control.topics").wait_for()
        assert await page.get_attribute("#stick", "aria-disabled") == "true"


async def test_of_several_command_topics_the_address_has_to_name_one(open_page, nowhere):
    several = ("--set", "control.topics=/a/cmd_vel,/b/cmd_vel")
    async with (
        gateway_process("serve", *nowhere, *several) as gateway,
        open_page(f"{page_address(gateway)}drive") as page,
    ):
        said = "Several topics take commands, /a/cmd_vel, /b/cmd_vel: name one in the address"
        await page.get_by_text(said).wait_for()
        assert "/drive#command=/a/cmd_vel" in await page.inner_text("#control")

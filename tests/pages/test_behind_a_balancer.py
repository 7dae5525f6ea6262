# SPDX-License-Identifier: Apache-2.0
"""The pages of a robot behind a prefix: a relay serves them, and a load balancer is in front."""

import pytest
import pytest_asyncio

from tests import dds_domain
from tests.client import client
from tests.fleet import started
from tests.pages.test_debug_page import card, until, until_painted

pytestmark = [
    pytest.mark.long,
    pytest.mark.asyncio(loop_scope="package"),
]


@pytest_asyncio.fixture(params=["haproxy", "nginx", "none"], scope="module", loop_scope="package")
async def place(request):
    """Yield where the pages of robot r1 are: behind a balancer, or at a relay itself."""
    balancer = "haproxy" if request.param == "none" else request.param
    async with started(balancer, "--ros", "--domain-id", str(dds_domain.claim())) as fleet:
        url = fleet.relays["relay1"] if request.param == "none" else fleet.url
        yield f"{url}/r1/"


async def test_the_list_of_robots_leads_to_the_cards_and_to_an_image(place, open_page):
    async with open_page(place.removesuffix("r1/")) as page:
        await page.click("text=r1")
        await page.wait_for_url(f"{place}**")
        await page.wait_for_selector("#topics button:has-text('/odom')")
        await until_painted(page, f"{card('/camera/image_raw/compressed')} canvas")
        await until_painted(page, f"{card('/map')} canvas")
        await until(page, "() => /Hz/.test(document.querySelector('footer')?.textContent)")
        assert await page.inner_text("#state") == "connected"


async def test_the_links_between_pages_stay_with_the_robot(place, open_page):
    async with open_page(place) as page:
        links = await page.eval_on_selector_all("nav a", "all => all.map((each) => each.href)")
        assert links
        assert [each for each in links if not each.startswith(place)] == []
        await page.goto(f"{place}lab")
        await page.wait_for_selector(".state[data-state=open]")


async def test_the_robot_is_driven_and_stopped(place, open_page):
    async with client(place.replace("http", "ws")) as watching, open_page(f"{place}drive") as page:
        await watching.send(op="control", topic="/cmd_vel", watch=True)
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")

        async def until_it_is(**wanted: object) -> dict[str, object]:
            return await watching.receive(
                lambda frame: frame["op"] == "control" and wanted.items() <= frame.items()
            )

        await page.keyboard.down("ArrowLeft")
        await until_it_is(state="moving")
        await page.click("#stop")
        await until_it_is(state="stopped", cause="stop")
        await page.keyboard.up("ArrowLeft")
        await until(page, "() => control.textContent.startsWith('Stopped')")

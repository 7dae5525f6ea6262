# SPDX-License-Identifier: Apache-2.0
"""The page of the tutorial, served as it says, in a real browser."""

from urllib.parse import urlsplit

import pytest

from tests.client import client
from tests.demonstration import demonstration, until_it_can_be_driven
from tests.doc_blocks import texts
from tests.pages.conftest import robots_domain
from tests.pages.patient_demo import PATIENT

TUTORIAL = "tutorials/browser-page.md"
SHOWN = "() => document.getElementById('x').textContent.includes(' m')"
MOVED = "() => parseFloat(document.getElementById('x').textContent) > 0.05"

TWIST = "geometry_msgs/msg/Twist"
FORWARD = {"linear": {"x": 0.1}}

pytestmark = pytest.mark.asyncio(loop_scope="package")


def serve(folder, gateway) -> None:
    (html,) = texts(TUTORIAL, "html")
    port = str(urlsplit(gateway.url).port)
    assert "ws://localhost:9090" in html
    (folder / "index.html").write_text(html.replace("9090", port))
    (folder / "favicon.ico").touch()


def patient_demo(*arguments):
    apart = ("env", f"ROS_DOMAIN_ID={robots_domain()}")
    arguments = (*PATIENT, *arguments)
    return demonstration(*arguments, module="tests.pages.patient_demo", before=apart)


async def test_the_page_shows_and_drives_with_the_setting_of_the_tutorial(folder, open_page):
    files, address = folder
    assert texts(TUTORIAL, "sh") == [
        "python3 -m http.server 8000 --bind 127.0.0.1\n",
        "make demo ARGS='--set allowed_origins=http://localhost:8000'\n",
    ]
    async with patient_demo("--set", f"allowed_origins={address}") as gateway:
        serve(files, gateway)
        async with client(gateway.url) as person, open_page(address) as page:
            await until_it_can_be_driven(person)
            await page.get_by_text("connected", exact=True).wait_for()
            await person.send(op="control", topic="/cmd_vel", watch=True)
            await page.hover("#forward")
            await page.mouse.down()
            await page.wait_for_function(MOVED)
            await page.mouse.up()
            await person.receive(
                lambda frame: frame["op"] == "control" and frame["cause"] == "zero"
            )
            await page.hover("#stop")
            await page.mouse.down()
            await person.receive(
                lambda frame: frame["op"] == "control" and frame["cause"] in {"zero", "stop"}
            )
            assert await page.inner_text("#error") == ""


async def test_without_the_setting_the_page_watches_stops_and_says_why(folder, open_page):
    files, address = folder
    async with patient_demo() as gateway:
        serve(files, gateway)
        async with client(gateway.url) as person, open_page(address) as page:
            await until_it_can_be_driven(person)
            await page.wait_for_function(SHOWN)
            await page.hover("#forward")
            await page.mouse.down()
            error = texts(TUTORIAL, "text")[0].strip()
            await page.get_by_text(error, exact=True).wait_for()
            await page.mouse.up()
            await person.send(op="control", topic="/cmd_vel", watch=True)
            await person.send(op="publish", topic="/cmd_vel", type=TWIST, msg=FORWARD)
            await person.receive(lambda frame: frame.get("state") == "moving")
            await page.click("#stop")
            await person.receive(lambda frame: frame.get("cause") == "stop")

# SPDX-License-Identifier: Apache-2.0
"""The frames of docs/how-to/drive-safely.md, carried out by the simulated robot."""

import json
import re

import pytest

from tests.client import client
from tests.demonstration import demonstration
from tests.doc_blocks import DOCS, texts
from tests.e2e.test_protocol_page import drive_once, on_its_own_connection

PAGE = "how-to/drive-safely.md"
FRAMES = [
    *texts(PAGE, "json"),
    *re.findall(r"^\|.*\| `(\{.*?\})`", (DOCS / PAGE).read_text("utf-8"), re.MULTILINE),
]


@pytest.mark.brief
async def test_the_page_shows_how_to_drive_stop_and_share_a_robot():
    assert len(FRAMES) > 4
    async with demonstration() as gateway:
        await drive_once(gateway.url)
        for conversation in texts(PAGE, "wscat"):
            assert await on_its_own_connection(gateway.url, conversation) is None
        async with client(gateway.url) as speaker:
            for frame in FRAMES:
                await speaker.socket.send(frame)
                answers = await speaker.sync()  # or the next stop would overtake it
                assert "status" not in {each["op"] for each in answers}, frame
                await speaker.send(op="publish", topic="/cmd_vel", msg={})
    assert {json.loads(frame)["op"] for frame in FRAMES} >= {"publish", "stop", "acquire_control"}

# SPDX-License-Identifier: Apache-2.0
"""The lines that the README and the demonstration show to paste do what they say."""

import json
import re
from pathlib import Path

from gateway.cli.main import _DEMO_HINT
from tests.client import client
from tests.demonstration import demonstration, until_it_can_be_driven

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
MINUTE = README.partition("## The first minute")[2].partition("\n## ")[0]
LINES = re.findall(r"^```\n(\{.*\})\n^```", MINUTE, re.MULTILINE)


def test_the_first_minute_begins_calmly():
    first = json.loads(LINES[0])
    assert (first["op"], first["throttle_rate"]) == ("subscribe", 1000)
    assert LINES[0] in _DEMO_HINT
    assert LINES[1] in _DEMO_HINT


async def test_the_first_minute_goes_as_the_readme_says():
    subscribe, drive, reset = LINES
    async with demonstration() as gateway, client(gateway.url) as person:
        await until_it_can_be_driven(person)
        await person.socket.send(subscribe)
        start = await person.message("/odom")
        assert list(start) == ["pose"]
        assert list(start["pose"]["pose"]) == ["position"]
        await person.socket.send(drive)
        while (await person.message("/odom"))["pose"]["pose"]["position"]["x"] < 0.02:
            pass
        await person.socket.send(reset)
        answer = await person.receive(lambda frame: frame["op"] == "service_response")
        assert answer["result"]
        await person.socket.send("help")
        shown = await person.receive(lambda frame: frame["op"] == "help")
        assert len(shown["try"]) > 5
        assert not [frame for frame in person.seen if frame["op"] == "status"]


async def test_each_line_of_help_works_in_the_demonstration():
    async with demonstration() as gateway, client(gateway.url) as person:
        await person.socket.send("?")
        shown = await person.receive(lambda frame: frame["op"] == "help")
        for frame in shown["try"].values():
            await person.send(**frame)
        await person.receive(lambda frame: frame["op"] == "list_parameters")
        seen = [*person.seen, *await person.sync()]
        assert {"graph", "describe", "service_response"} <= {frame["op"] for frame in seen}
        assert not [frame for frame in seen if frame["op"] == "status"]

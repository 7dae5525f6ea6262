# SPDX-License-Identifier: Apache-2.0
"""The lines that the README and the demonstration show to paste do what they say."""

import ast
import asyncio
import json
import math
import os
import re
import subprocess
import sys
from asyncio.subprocess import PIPE
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from gateway.cli.demo import lines_to_paste
from gateway.config.model import Config
from tests.client import Client, client, eventually
from tests.clients.driver import ROSLIBPY_2
from tests.demonstration import demonstration, until_it_can_be_driven
from tests.e2e.test_navigation import CANCELED, until_provided
from tests.gateway_process import gateway_process

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
LINES = re.findall(r"^```json\n(\{.*\})\n^```", README, re.MULTILINE)
PYTHON = re.findall(r"^```python\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
ROSBRIDGE = re.findall(r"^\|.*\|.*\| `(--.*?)`.*\|$", README, re.MULTILINE)
SHOWN = re.findall(r"^  (\{.*\})$", lines_to_paste(Config()), re.MULTILINE)


@pytest.mark.brief
def test_the_readme_shows_lines_of_the_demonstration_and_begins_calmly():
    first = json.loads(LINES[0])
    assert (first["op"], first["throttle_rate"]) == ("subscribe", 1000)
    *lines, reset = LINES
    assert lines == [line for line in SHOWN if line in LINES]
    assert json.loads(reset)["service"] == "/reset"


@pytest.mark.brief
def test_a_readme_is_read_in_one_go():
    assert len(README.splitlines()) <= 140


@pytest.mark.parametrize("flags", ROSBRIDGE)
def test_the_flags_that_bring_rosbridges_behavior_back_are_accepted(flags):
    command = [sys.executable, "-m", "gateway", "serve", *flags.split(), "--print-config"]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (finished.returncode, finished.stderr) == (0, "")


def test_there_are_flags_for_each_difference():
    assert len(ROSBRIDGE) == 5


async def drive_by(person: Client, line: str, odometry: str = "/odom") -> None:
    """Paste a line until it has moved the robot, which may be too busy for half a second."""
    await person.socket.send(line)
    while (await person.message(odometry))["pose"]["pose"]["position"]["x"] < 0.02:
        await person.socket.send(line)


@pytest.mark.brief
async def test_the_first_minute_goes_as_the_readme_says():
    subscribe, drive, look_up, go, cancel = SHOWN
    async with demonstration() as gateway, client(gateway.url, level=None) as person:
        await until_it_can_be_driven(person)
        await person.socket.send(subscribe)
        start = await person.message("/odom")
        assert list(start) == ["pose"]
        assert list(start["pose"]["pose"]) == ["position"]
        await drive_by(person, drive)
        await person.socket.send(look_up)
        found = await person.receive(lambda frame: frame["op"] == "lookup_transform")
        assert found["transform"]["transform"]["translation"]["z"] == pytest.approx(0.132)
        await until_provided(person)
        await person.socket.send(go)
        feedback = await person.receive(lambda frame: frame["op"] == "action_feedback")
        straight = math.dist((0, 0), (2.5, 1.5))
        assert feedback["values"]["distance_remaining"] > straight, "around the partition"
        await person.socket.send(cancel)
        result = await person.receive(lambda frame: frame["op"] == "action_result")
        assert result["status"] == CANCELED
        await person.socket.send(LINES[-1])
        answer = await person.receive(lambda frame: frame["op"] == "service_response")
        assert answer["result"]
        await person.socket.send("help")
        shown = await person.receive(lambda frame: frame["op"] == "help")
        assert len(shown["try"]) > 5
        assert not [frame for frame in person.seen if frame["op"] == "status"]


@pytest.mark.skipif(not ROSLIBPY_2.directory.exists(), reason="no roslibpy: tools/make-clients.sh")
async def test_the_python_of_the_readme_prints_where_the_robot_is():
    (code,) = PYTHON
    async with demonstration() as gateway:
        code = code.replace("9090", str(urlsplit(gateway.url).port))
        environment = os.environ | ROSLIBPY_2.environment
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-c", code, env=environment, stdout=PIPE
        )
        output, _ = await process.communicate()
    lines = output.decode().splitlines()
    assert process.returncode == 0
    assert lines
    assert all(ast.literal_eval(line).keys() == {"x", "y", "z"} for line in lines)


async def test_a_robot_that_takes_stamps_is_driven_by_the_line_that_it_shows():
    async with (
        demonstration("--twist-stamped") as gateway,
        client(gateway.url, level=None) as person,
    ):
        lines = [line.strip() for line in gateway.output if '"/cmd_vel"' in line]
        assert len(lines) == 1
        assert json.loads(lines[0])["type"] == "geometry_msgs/msg/TwistStamped"
        await person.socket.send(LINES[0])
        await person.message("/odom")
        await drive_by(person, lines[0])
        assert not [frame for frame in person.seen if frame["op"] == "status"]


@pytest.mark.brief
async def test_a_robot_in_a_namespace_does_what_the_lines_say_that_it_shows():
    demo = gateway_process("demo", "--namespace", "/robot1")
    async with demo as gateway, client(gateway.url) as person:
        await eventually(lambda: "Ctrl-C" in "".join(gateway.output))
        lines = [line.strip() for line in gateway.output if line.startswith("  {")]
        subscribe, drive, look_up, _, _ = lines
        assert json.loads(drive)["topic"] == "/robot1/cmd_vel"
        await person.socket.send(subscribe)
        await drive_by(person, drive, "/robot1/odom")
        await person.send(op="control", topic="/robot1/cmd_vel")
        control = await person.receive(lambda frame: frame["op"] == "control")
        assert control["guard"] == "ready", "it is a command topic, with all that stops a robot"
        await person.socket.send(look_up)
        found = await person.receive(lambda frame: frame["op"] == "lookup_transform")
        assert found["transform"]["header"]["frame_id"] == "robot1/map"


async def test_each_line_of_help_works_in_the_demonstration():
    async with demonstration() as gateway, client(gateway.url, level=None) as person:
        await person.socket.send("?")
        shown = await person.receive(lambda frame: frame["op"] == "help")
        for frame in shown["try"].values():
            await person.send(**frame)
        await person.receive(lambda frame: frame["op"] == "list_parameters")
        seen = [*person.seen, *await person.sync()]
        assert {"graph", "describe", "service_response"} <= {frame["op"] for frame in seen}
        assert not [frame for frame in seen if frame["op"] == "status"]

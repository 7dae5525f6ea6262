# SPDX-License-Identifier: Apache-2.0
"""The lines to paste that pages of docs/how-to/ show: the demonstration carries them out."""

import asyncio
import json
import re
from pathlib import Path

import pytest

from tests.client import TIMEOUT_S, Frame, client
from tests.demonstration import demonstration

HOW_TO = Path(__file__).parents[2] / "docs/how-to"
PAGES = ("cameras.md", "own-messages.md", "slow-networks.md")
LINES = [
    line
    for page in PAGES
    for line in re.findall(
        r"^ *```json\n *(\{\"op\".*\})\n *```", (HOW_TO / page).read_text("utf-8"), re.MULTILINE
    )
]

ANSWERS = {"subscribe": "publish", "ping": "pong"}
SILENT = {"advertise", "unsubscribe"}  # if they are carried out


async def answers(url: str, line: str) -> list[Frame]:
    """Paste a line, and return all frames up to the first that answers it."""
    operation = json.loads(line)
    op = operation["op"]
    async with client(url) as speaker, asyncio.timeout(TIMEOUT_S):
        if op == "unsubscribe":
            await speaker.send(op="subscribe", topic=operation["topic"])
            await speaker.message(operation["topic"])
        await speaker.socket.send(line)
        if op in SILENT:
            return [frame for frame in await speaker.sync() if frame["op"] != "publish"]
        frames: list[Frame] = []
        while not frames or frames[-1]["op"] not in {ANSWERS.get(op, op), "status"}:
            frame = await speaker.socket.recv()
            frames.append({"op": "publish"} if isinstance(frame, bytes) else json.loads(frame))
        return frames


@pytest.mark.brief
async def test_each_line_of_the_pages_is_carried_out():
    assert len(LINES) > 15
    async with demonstration() as gateway:
        found = await asyncio.gather(*(answers(gateway.url, line) for line in LINES))
    faults = [
        f"{line}: {frame}"
        for line, frames in zip(LINES, found, strict=True)
        for frame in frames
        if frame["op"] == "status"
    ]
    assert faults == []

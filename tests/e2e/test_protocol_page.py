# SPDX-License-Identifier: Apache-2.0
"""Every example of docs/reference/protocol/, executed by the gateway and the simulated robot."""

import asyncio
import json
import re
from contextlib import suppress
from typing import Any

import pytest

from tests.client import Client, client
from tests.demonstration import demonstration
from tests.doc_blocks import protocol_examples

CONVERSATIONS = protocol_examples()

# At an example: on a busy machine nodes of ROS answer later than the page expects. Commands are old
# when they are read, and a name may be too new to be suggested.
ATTEMPTS = 3
TWIST = "geometry_msgs/msg/Twist"

ANY = "*any*"  # stands for `...` as a value
MORE = "*more*"  # stands for `...` as a further member or element


def expectation(text: str) -> Any:
    """Parse an expected frame, in which `...` stands for whatever is there."""
    text = re.sub(r'(":\s*)\.\.\.', rf"\1{json.dumps(ANY)}", text)
    text = re.sub(r"([{,]\s*)\.\.\.(\s*\})", rf"\1{json.dumps(MORE)}:0\2", text)
    text = re.sub(r"([\[,]\s*)\.\.\.(\s*\])", rf"\1{json.dumps(MORE)}\2", text)
    return json.loads(text)


def fits(expected: Any, got: Any) -> bool:
    match expected:
        case str() if expected == ANY:
            return True
        case dict():
            if not isinstance(got, dict):
                return False
            named = {key: value for key, value in expected.items() if key != MORE}
            if MORE not in expected and named.keys() != got.keys():
                return False
            return all(key in got and fits(value, got[key]) for key, value in named.items())
        case list():
            if not isinstance(got, list):
                return False
            if MORE not in expected:
                return len(expected) == len(got) and all(map(fits, expected, got))
            return all(any(fits(one, other) for other in got) for one in expected if one != MORE)
    return type(expected) is type(got) and expected == got


class TooBusyError(Exception):
    """A node of ROS has not answered in time, or a command was read too late."""


async def hold(conversation: str, speaker: Client) -> str | None:
    """Speak one example, and return what was expected and did not come, if anything.

    Raises:
        TooBusyError: a request timed out, or a command was old, where the page has another answer.
    """
    for line in conversation.splitlines():
        if line.startswith("> "):
            await speaker.socket.send(line.removeprefix("> "))
        else:
            expected = expectation(line.removeprefix("< "))
            try:
                frame = await speaker.receive(
                    lambda frame, expected=expected: fits(expected, frame) or is_late(frame)
                )
            except TimeoutError:
                if any(is_alone(frame) for frame in speaker.seen):
                    raise TooBusyError(line) from None
                others = "\n".join(json.dumps(frame)[:500] for frame in speaker.seen[-5:])
                return f"no answer {line}\nbut among others\n{others}"
            if not fits(expected, frame):
                raise TooBusyError(line)
    return None


def is_late(frame: Any) -> bool:
    return frame.get("code") in {"timeout", "stale_command"}


def is_alone(frame: Any) -> bool:
    """Whether two commands came so late that the gateway took each for a single one."""
    return frame.get("cause") == "deadline" and frame.get("tripped") is False


@pytest.mark.brief
async def test_every_example_of_the_pages_holds():
    assert len(CONVERSATIONS) > 25
    places = [f"limits.{limit}=64" for limit in ("max_clients", "max_clients_per_address")]
    async with demonstration("--set", places[0], "--set", places[1]) as gateway:
        await drive_once(gateway.url)
        surprises = await asyncio.gather(
            *(on_its_own_connection(gateway.url, each) for each in CONVERSATIONS)
        )
        assert [surprise for surprise in surprises if surprise] == []
        assert await gateway.stop() == 0


async def drive_once(url: str) -> None:
    """Move the robot: commands that come while the first one waits for the guard count as one."""
    async with client(url) as speaker:
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        state = None
        while state != "moving":
            move = {"linear": {"x": 0.1}}
            await speaker.send(op="publish", topic="/cmd_vel", type=TWIST, msg=move)
            frame = await speaker.receive(
                lambda frame: frame.get("state") == "moving" or is_late(frame)
            )
            state = frame.get("state")
        await speaker.send(op="publish", topic="/cmd_vel", msg={})
        await speaker.receive(lambda frame: frame.get("state") == "stopped")


async def on_its_own_connection(url: str, conversation: str) -> str | None:
    surprise: str | None = f"timed out {ATTEMPTS} times: {conversation}"
    for _ in range(ATTEMPTS):
        async with client(url) as speaker:
            with suppress(TooBusyError):
                surprise = await hold(conversation, speaker)
                if surprise is None:
                    break
            if "/cmd_vel" in conversation:  # as it was, for another attempt
                await speaker.send(op="publish", topic="/cmd_vel", type=TWIST, msg={})
    return surprise


@pytest.mark.brief
def test_the_examples_tell_a_wrong_frame_from_a_right_one():
    assert fits(
        expectation('{"a":...,"b":[{"c":1,...},...]}'), {"a": 2, "b": [0, {"c": 1, "d": 2}]}
    )
    assert not fits(expectation('{"a":...}'), {"a": 1, "b": 2})
    assert not fits(expectation('{"a":[{"c":1},...]}'), {"a": [{"c": 2}]})
    assert not fits(expectation('{"a":0}'), {"a": False})

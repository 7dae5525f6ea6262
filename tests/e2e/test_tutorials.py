# SPDX-License-Identifier: Apache-2.0
"""The blocks of the tutorials, executed in their order with the simulated robot."""

import asyncio
import re
import socket
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.client import TIMEOUT_S, Client, client, eventually
from tests.demonstration import demonstration
from tests.doc_blocks import is_like, texts, with_outputs
from tests.e2e.test_navigation import until_provided
from tests.e2e.test_protocol_page import expectation, fits
from tests.gateway_process import gateway_process

FIRST_ROBOT = "tutorials/first-robot.md"
IN_PYTHON = "tutorials/python-client.md"
PROGRAMS = [each for each in with_outputs(IN_PYTHON, "python") if each[0].startswith("import")]
COMMANDS = with_outputs(FIRST_ROBOT, "json")


async def until_stopped(person: Client) -> None:
    """Wait until the command timeout has stopped the robot."""
    cause = None
    while cause != "deadline":
        await person.send(op="control", topic="/cmd_vel")
        frame = await person.receive(lambda frame: frame["op"] == "control")
        cause = frame["cause"] if frame["state"] == "stopped" else None


async def read_until(process: Process, is_wanted: Callable[[str], bool]) -> None:
    """Read lines that a process prints until one is wanted."""
    assert process.stdout is not None
    async with asyncio.timeout(TIMEOUT_S):
        while not is_wanted(line := (await process.stdout.readline()).decode().rstrip("\n")):
            assert line, "the process has ended"


def is_frame(shown: str) -> Callable[[str], bool]:
    expected = expectation(shown.removeprefix("< "))

    def is_wanted(line: str) -> bool:
        found = re.search(r"< (\{.*\})$", line)
        return found is not None and fits(expected, expectation(found[1]))

    return is_wanted


async def python(*arguments: str) -> Process:
    return await asyncio.create_subprocess_exec(
        sys.executable, *arguments, stdin=PIPE, stdout=PIPE, limit=1 << 22
    )


async def test_the_first_robot_does_what_the_tutorial_shows():
    start = with_outputs(FIRST_ROBOT, "sh")[0][1]
    async with demonstration() as gateway, client(gateway.url, level=None) as person:
        await eventually(lambda: "Ctrl-C" in "".join(gateway.output))
        port = str(urlsplit(gateway.url).port)
        shown = [line.replace("9090", port) for line in start if line.strip() != "..."]
        assert set(shown) <= {line.rstrip("\n") for line in gateway.output}
        await until_provided(person)
        terminal = await python("-m", "websockets", gateway.url)
        for line, answers in COMMANDS:
            terminal.stdin.write(line.encode())
            for answer in answers:
                await read_until(terminal, is_frame(answer))
            if '"/cmd_vel"' in line:
                await until_stopped(person)
        terminal.stdin.close()
        assert await terminal.wait() == 0


def test_the_first_tutorial_uses_a_client_that_comes_with_the_gateway():
    assert ".venv/bin/websockets ws://localhost:9090\n" in texts(FIRST_ROBOT, "sh")
    assert Path(sys.executable).with_name("websockets").exists()


@pytest.fixture
async def port():
    async with demonstration() as gateway:
        yield str(urlsplit(gateway.url).port)


async def test_the_programs_of_the_tutorial_print_what_it_shows(port):
    *programs, _ = PROGRAMS
    assert len(programs) == 3
    for program, shown in programs:
        outputs = await output_of(program, port)
        (name, wrong), meant = ("/motor_power", "/motor_powr"), shown
        if name in program:
            *meant, refusal = shown
            assert is_like(refusal, (await output_of(program.replace(name, wrong), port))[0])
        assert len(outputs) == len(meant)
        assert all(map(is_like, meant, outputs))


async def output_of(program: str, port: str) -> list[str]:
    process = await python("-c", program.replace("9090", port))
    try:
        async with asyncio.timeout(TIMEOUT_S):
            output, _ = await process.communicate()
    except TimeoutError:
        process.kill()
        raise
    assert process.returncode == 0
    return output.decode().splitlines()


async def test_the_program_of_the_tutorial_comes_back_after_a_lost_connection():
    program, shown = PROGRAMS[-1]
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = str(server.getsockname()[1])
    first, again = shown[:2], shown[2:]
    async with demonstration("--port", port):
        process = await python("-c", program.replace("9090", port))
        for line in first:
            await read_until(process, lambda got, line=line: is_like(line, got))
    async with demonstration("--port", port):
        for line in again:
            await read_until(process, lambda got, line=line: is_like(line, got))
    process.kill()
    await process.wait()


async def test_the_program_of_the_tutorial_ends_if_the_gateway_refuses_its_token(tmp_path):
    tokens = ("--set", f"access.token_file={tmp_path / 'tokens.json'}")
    async with gateway_process("serve", "--set", "access.authentication=token", *tokens) as gateway:
        outputs = await output_of(PROGRAMS[-1][0], str(urlsplit(gateway.url).port))
    assert "4401" in outputs[-1]

# SPDX-License-Identifier: Apache-2.0
import asyncio
import threading
import time

import pytest

from gateway.core.introspection import client_code
from schemas.generate.request import ClientCodeError
from schemas.installed import InstalledDefinitions
from tests.cli.test_main import ros2_gateway
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.conftest import Bench

GOAL = "nav2_msgs/action/NavigateToPose"
LIMIT = "nav2_msgs/msg/SpeedLimit"


async def test_the_files_are_those_that_the_command_writes(bench: Bench, tmp_path):
    client = bench.client()
    types = [LIMIT, GOAL] * 150
    client.send(op="generate", id=1, language="csharp", types=types, asmdef="Robot.Messages")
    (answer,) = await client.sees(1, "generate")
    assert (answer["id"], answer["notes"]) == (1, [])
    command = ("generate", "csharp", GOAL, LIMIT, "--asmdef", "Robot.Messages")
    written = await asyncio.to_thread(ros2_gateway, *command, "--output", str(tmp_path))
    assert written.returncode == 0
    assert answer["files"] == {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert "Robot.Messages.asmdef" in answer["files"]


@pytest.mark.parametrize("language", ["typescript", "python", "json-schema"])
async def test_other_languages_are_written_too(bench: Bench, language):
    client = bench.sender(op="generate", language=language, types=[LIMIT])
    (answer,) = await client.sees(1, "generate")
    assert any("speed_limit" in text for text in answer["files"].values())


@pytest.mark.parametrize(
    ("types", "text"),
    [
        (["nav2_msgs/msg/SpedLimit"], f"; did you mean {LIMIT}?"),
        (["nonsense"], "type"),
        (["geometry_msgs/msg/Twist"], "the Unity package has all classes of geometry_msgs/msg/Twi"),
    ],
)
async def test_code_that_cannot_be_written_is_refused_with_the_reason(bench: Bench, types, text):
    client = bench.sender(op="generate", language="csharp", types=types)
    ((code, said),) = [(f["code"], f["msg"]) for f in await client.sees(1, "status")]
    assert code == "bad_type"
    assert text in said


@pytest.mark.parametrize(
    "members",
    [
        {"types": []},
        {"types": [LIMIT] * 301},
        {"types": [LIMIT], "asmdef": "../Robot"},
        {"types": [LIMIT], "asmdef": ""},
        {"types": [LIMIT], "asmdef": "Ros2Gateway.Core"},
        {"types": [LIMIT], "asmdef": "a" * 101},
        {"types": [LIMIT], "language": "perl"},
        {"types": [LIMIT], "language": "typescript", "asmdef": "Robot"},
    ],
)
async def test_a_request_beyond_its_bounds_is_refused(bench: Bench, members):
    client = bench.sender(**{"op": "generate", "language": "csharp"} | members)
    assert [code for code, _ in client.statuses] == ["bad_request"]


async def test_more_code_than_a_client_reads_is_refused(bench: Bench, monkeypatch):
    code = "x" * 4 * 1024**2
    monkeypatch.setattr(client_code, "_written", lambda *_: ({"Limit.cs": code}, []))
    client = bench.sender(op="generate", language="csharp", types=[LIMIT])
    await eventually(lambda: len(client.frames) == 1)
    assert client.frames[0].get("files") == {"Limit.cs": code}
    code += "x"
    client.send(op="generate", language="csharp", types=[LIMIT])
    await client.sees(1, "status")
    text = "the code has over 4194304 bytes: ask for fewer types at once"
    assert client.statuses == [("limit_exceeded", text)]


async def test_one_thread_writes_for_all_and_goes_on_when_a_client_leaves(
    bench: Bench, monkeypatch
):
    running = asyncio.Event()
    go_on = asyncio.Event()
    loop = asyncio.get_running_loop()
    count = most = 0

    def written(*_):
        nonlocal count, most
        count += 1
        most = max(most, count)
        loop.call_soon_threadsafe(running.set)
        asyncio.run_coroutine_threadsafe(go_on.wait(), loop).result()
        count -= 1
        return {"a": "b"}, []

    monkeypatch.setattr(client_code, "_written", written)
    first, second = bench.client(), bench.client()
    first.send(op="generate", language="csharp", types=[LIMIT])
    await running.wait()
    bench.router.leave(first.session)
    await bench.settle()
    assert bench.router.introspection._client_code._turn.locked()  # the thread still writes
    second.send(op="generate", language="csharp", types=[LIMIT])
    await bench.settle()
    go_on.set()
    await second.sees(1, "generate")
    assert most == 1


async def test_the_time_of_the_thread_is_the_clients(bench: Bench, monkeypatch):
    def written(*_):
        begin_s = time.thread_time()
        while time.thread_time() < begin_s + 0.02:
            pass
        raise ClientCodeError("there is nothing to write")

    monkeypatch.setattr(client_code, "_written", written)
    client = bench.client()
    spent: list[float] = []
    client.turns.spend = lambda spent_s, _: spent.append(spent_s) or True
    client.send(op="generate", language="csharp", types=[LIMIT])
    await client.sees(1, "status")
    assert max(spent) >= 0.02


async def test_a_request_that_waits_too_long_for_others_fails(bench: Bench, monkeypatch):
    go_on = threading.Event()
    monkeypatch.setattr(client_code, "TURN_S", 0.0)
    monkeypatch.setattr(client_code, "_written", lambda *_: (go_on.wait(), ({}, []))[1])
    first, second = bench.client(), bench.client()
    first.send(op="generate", language="csharp", types=[LIMIT])
    await bench.settle()
    second.send(op="generate", language="csharp", types=[LIMIT])
    await second.sees(1, "status")
    go_on.set()
    await first.sees(1, "generate")
    assert second.statuses == [
        ("limit_exceeded", "other clients are waiting for code too long: try again")
    ]


async def test_many_types_are_counted_in_each_file_and_not_named(bench: Bench):
    client = bench.client()
    types = [name for name in InstalledDefinitions().names() if name.startswith("std_msgs/msg/")]
    client.send(op="generate", language="json-schema", types=types)
    (answer,) = await client.sees(1, "generate")
    head = f"ros2-gateway generate json-schema of {len(types)} types; do not edit."
    assert all(head in text for text in answer["files"].values())


async def test_twenty_types_are_named_in_each_file(bench: Bench):
    client = bench.client()
    types = [name for name in InstalledDefinitions().names() if name.startswith("std_msgs/msg/")]
    client.send(op="generate", language="json-schema", types=types[:20])
    (answer,) = await client.sees(1, "generate")
    assert all(types[19] in text.partition("do not edit")[0] for text in answer["files"].values())
    client.send(op="generate", language="json-schema", types=types[:21])
    *_, answer = await client.sees(2, "generate")
    assert all("of 21 types; do not edit" in text for text in answer["files"].values())


async def test_a_client_waits_8_s_for_others_that_ask_for_code(bench: Bench, monkeypatch):
    go_on = threading.Event()
    monkeypatch.setattr(client_code, "_written", lambda *_: (go_on.wait(), ({}, []))[1])
    clients = [bench.client(), bench.client()]
    clock = StoppedClock(monkeypatch)
    for client in clients:
        client.send(op="generate", language="csharp", types=[LIMIT])
        await clock.advance(0)
    await clock.advance(7.9)
    assert clients[1].statuses == []
    await clock.advance(0.2)
    go_on.set()
    assert [code for code, _ in clients[1].statuses] == ["limit_exceeded"]

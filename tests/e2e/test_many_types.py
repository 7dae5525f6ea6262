# SPDX-License-Identifier: Apache-2.0
"""As many types that are not installed as a gateway takes, one after the other."""

from pathlib import Path

from gateway.sources.rclpy.made_types.classes import MAX_MADE
from tests.client import client
from tests.gateway_process import ALL_TIME, gateway_process

AT_ONCE = 64


async def test_as_many_types_as_there_may_be_are_heard_and_one_more_is_refused(tmp_path: Path):
    folder = tmp_path / "fleet_msgs" / "msg"
    folder.mkdir(parents=True)
    for number in range(MAX_MADE + 1):
        (folder / f"Part{number}.msg").write_text(f"int32 number\nfloat32[{number + 1}] loads\n")
    async with (
        gateway_process("serve", *ALL_TIME, "--set", f"types.paths={tmp_path}") as gateway,
        client(gateway.url) as speaker,
    ):
        for first in range(0, MAX_MADE, AT_ONCE):
            numbers = range(first, first + AT_ONCE)
            for number in numbers:
                there = {"topic": f"/part{number}", "type": f"fleet_msgs/Part{number}"}
                await speaker.send(op="advertise", **there, latch=True)
                await speaker.send(op="publish", topic=f"/part{number}", msg={"number": number})
                await speaker.send(op="subscribe", **there)
            heard: dict[str, tuple[int, int]] = {}
            while len(heard) < AT_ONCE:
                frame = await speaker.receive(lambda frame: frame["op"] == "publish")
                heard[frame["topic"]] = frame["msg"]["number"], len(frame["msg"]["loads"])
            assert heard == {f"/part{number}": (number, number + 1) for number in numbers}
            for number in numbers:
                await speaker.send(op="unsubscribe", topic=f"/part{number}")
                await speaker.send(op="unadvertise", topic=f"/part{number}")
            assert await speaker.sync() == []
        await speaker.send(op="subscribe", topic="/last", type=f"fleet_msgs/Part{MAX_MADE}")
        status = await speaker.receive(lambda frame: frame.get("level") == "error")
        assert status["code"] == "limit_exceeded"
        assert "at most 1024 types that are not installed" in status["msg"]
        await speaker.send(op="subscribe", topic="/text", type="std_msgs/String")
        assert await speaker.sync() == []

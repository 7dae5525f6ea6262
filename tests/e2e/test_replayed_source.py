# SPDX-License-Identifier: Apache-2.0
"""The example of adding-a-source.md: a gateway without rclpy, started by the command line."""

import subprocess
import sys
from pathlib import Path

from tests.client import client
from tests.gateway_process import gateway_process

SOURCE = "tests.sources.replayed:open_source"
EXAMPLE = Path(__file__).parents[1] / "sources" / "replayed.py"


async def test_a_client_of_rosbridge_gets_what_is_replayed_without_rclpy():
    # which concerns nodes: this source carries the definition
    arguments = ("serve", "--source", SOURCE, "--set", "types.ask_nodes=false")
    async with (
        gateway_process(*arguments, module="tests.without_rclpy") as gateway,
        client(gateway.url) as watching,
    ):
        await watching.send(op="subscribe", topic="/battery")
        seen = [await watching.message("/battery") for _ in range(3)]
        assert [each["percent"] for each in seen] in ([9, 8, 9], [8, 9, 8])
        await watching.send(op="call_service", id="t", service="/rosapi/topics")
        answer = await watching.receive(lambda frame: frame["op"] == "service_response")
        assert answer["values"]["topics"] == ["/battery"]
        for operation, part in (
            ({"op": "call_service", "service": "/reboot"}, "services"),
            ({"op": "publish", "topic": "/cmd_vel", "msg": {}}, "publishing"),
        ):
            await watching.send(**operation, id=part)
            refusal = await watching.receive(lambda frame: frame.get("id") == part)  # noqa: B023  # awaited here
            assert f"this source has no {part}: " in str(refusal)


def test_an_unknown_source_is_refused():
    for name in ("tests.sources.replayed", "tests.sources.replayed:nothing", "no_module:open", ""):
        command = (sys.executable, "-m", "tests.without_rclpy", "serve", "--source", name)
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        assert ended.returncode == 2
        assert f"--source: unknown source '{name}'" in ended.stderr
        assert "name it as MODULE:FUNCTION" in ended.stderr


def test_the_example_stays_short():
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 200

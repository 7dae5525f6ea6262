# SPDX-License-Identifier: Apache-2.0
"""Record the simulated robot again, for ``ros2-gateway demo --recorded``.

Run ``python -m tools.demo_recording``, which takes half a minute. The robot drives to a goal. Its
topics of state are recorded, and one picture per second.
"""

import asyncio
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Final

from websockets.asyncio.client import connect

from gateway.sources.recording.options import DEMO

MAX_BYTES: Final = 1_000_000
DOMAIN_ID: Final = "77"
GOAL: Final = {"pose": {"pose": {"position": {"x": 2.5, "y": 1.5}, "orientation": {"w": 1}}}}
TOPICS: Final = (
    *("/odom", "/scan", "/map", "/tf", "/tf_static", "/robot_description", "/battery_state"),
    *("/joint_states", "/camera/image_raw/compressed"),
)


def main() -> None:
    """Start a robot and a gateway, record, and replace the file."""
    with tempfile.TemporaryDirectory() as folder:
        asyncio.run(_record(folder))
        (made,) = Path(folder).rglob("*.mcap")
        size = made.stat().st_size
        if size > MAX_BYTES:
            raise SystemExit(f"{size} bytes are more than {MAX_BYTES}: record for a shorter time")
        shutil.copyfile(made, DEMO)
    sys.stdout.write(f"wrote {DEMO}, {size} bytes\n")


async def _record(folder: str) -> None:
    sim = await _run("sim", "--camera-hz", "0.6", "--seed", "1")
    gateway = await _run("serve", "--port", "0")
    url = (await _line(gateway)).split()[-1]
    chosen = [argument for topic in TOPICS for argument in ("-t", topic)]
    recorder = await _run("record", "-o", folder, *chosen)
    await _line(recorder)  # it records
    async with connect(url) as client:
        goal = {"op": "send_action_goal", "id": "go", "action": "/navigate_to_pose", "args": GOAL}
        await client.send(json.dumps(goal))
        while json.loads(await client.recv())["op"] != "action_result":
            pass
    for process in (recorder, gateway, sim):
        process.terminate()
        await process.wait()


async def _line(process: asyncio.subprocess.Process) -> str:
    if process.stdout is None:
        raise ValueError("its output is not read")
    return (await process.stdout.readline()).decode()


async def _run(*arguments: str) -> asyncio.subprocess.Process:
    environment = {"ROS_DOMAIN_ID": DOMAIN_ID, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "gateway", *arguments),
        stdout=asyncio.subprocess.PIPE,
        env={**os.environ, **environment},
    )


if __name__ == "__main__":
    main()

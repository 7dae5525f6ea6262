# SPDX-License-Identifier: Apache-2.0
"""Recordings, played by the command line without rclpy, as a client of rosbridge sees them."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from gateway.sources.recording.options import DEMO
from tests import recordings
from tests.client import TIMEOUT_S, Client, client
from tests.gateway_process import gateway_process
from tests.recordings import COUNT, NAME, START_NS, STEP_NS

MODULE = "tests.without_rclpy"
REFUSAL = "this is a recording, and nothing in it can be moved or called: "


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    return recordings.write_bag1(tmp_path / "drive.bag")


async def called(watching: Client, service: str, **values: object) -> object:
    await watching.send(op="call_service", id=service, service=service, args=values)
    answer = await watching.receive(lambda frame: frame.get("id") == service)
    return answer["values"]


async def test_clients_see_the_robot_that_was_recorded(bag: Path) -> None:
    async with (
        gateway_process("play", str(bag), "--paused", module=MODULE) as gateway,
        client(gateway.url) as watching,
    ):
        topics = await called(watching, "/rosapi/topics")
        recorded = ["/chatter", "/map_name", "/odom"]
        assert topics["topics"] == sorted([*recorded, "/clock", "/rosbag2_player/state"])
        for topic in ("/odom", "/map_name", "/clock"):
            await watching.send(op="subscribe", topic=topic)
        clock = {"sec": START_NS // 10**9, "nanosec": 0}
        assert (await watching.message("/clock"))["clock"] == clock
        async with client(gateway.url) as operator:
            await called(operator, "/rosbag2_player/resume")
            for number in range(COUNT):
                odometry = await watching.message("/odom")
                assert odometry["pose"]["pose"]["position"]["x"] == number
            while await called(operator, "/rosbag2_player/is_paused") != {"paused": True}:
                pass  # until the end
            async with client(gateway.url) as late:
                await late.send(op="subscribe", topic="/map_name")
                assert (await late.message("/map_name"))["data"] == NAME  # it came long ago
                await late.send(op="subscribe", topic="/odom")
                await called(late, "/rosbag2_player/is_paused")  # it has subscribed
                back_ns = START_NS + COUNT // 2 * STEP_NS
                stamp = {"sec": back_ns // 10**9, "nanosec": back_ns % 10**9}
                sought = await called(operator, "/rosbag2_player/seek", time=stamp)
                assert sought == {"success": True}
                assert (await late.message("/map_name"))["data"] == NAME
                stepped = await called(operator, "/rosbag2_player/burst", num_messages=2)
                assert stepped == {"actually_burst": 2}
                odometry = await late.message("/odom")
                assert odometry["pose"]["pose"]["position"]["x"] == COUNT // 2
            near = await called(operator, "/rosbag2_player/sek")
            assert "did you mean /rosbag2_player/seek?" in str(near)


async def test_nothing_in_a_recording_moves(bag: Path) -> None:
    async with (
        gateway_process("play", str(bag), "--loop", module=MODULE) as gateway,
        client(gateway.url) as driving,
    ):
        twist = {"type": "geometry_msgs/msg/Twist", "msg": {"linear": {"x": 1}}}
        trigger = "std_srvs/srv/Trigger"
        for operation in (
            {"op": "publish", "topic": "/cmd_vel", **twist},
            {"op": "advertise", "topic": "/other", "type": "std_msgs/msg/String"},
            {"op": "call_service", "service": "/reset"},
            {"op": "call_service", "service": "/reset", "type": trigger},
            {"op": "advertise_service", "service": "/mine", "type": trigger},
            {
                "op": "send_action_goal",
                "action": "/turn",
                "action_type": "example_interfaces/action/Fibonacci",
            },
        ):
            await driving.send(**operation, id=str(operation))
            refusal = await driving.receive(lambda frame: frame.get("id") == str(operation))  # noqa: B023  # awaited here
            assert REFUSAL in str(refusal), operation


@pytest.mark.parametrize(
    ("arguments", "code", "why"),
    [
        (("{bag}", "--start", "90"), 1, "--start 90 is behind the end, at 2.0 s: begin earlier"),
        *(
            (("{bag}", "--rate", rate), 2, f"got '{rate}', expected a factor from 0.01 to 100")
            for rate in ("0", "nan", "1000")
        ),
        (("{bag}", "--start", "-1"), 2, "--start: got '-1', expected seconds from 0"),
        (("{bag}.no",), 1, "no such file or directory: name a recording"),
        ((), 2, "FILE"),
        (("",), 2, "FILE: it is empty, name a recording"),
    ],
)
def test_a_missing_file_and_a_wrong_option_are_refused(
    arguments: tuple[str, ...], code: int, why: str, bag: Path
) -> None:
    given = [each.format(bag=bag) for each in arguments]
    ended = subprocess.run(
        (sys.executable, "-m", MODULE, "play", "--port", "0", *given),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == code, ended.stderr
    assert why in ended.stderr


def test_a_recording_that_takes_long_to_open_can_be_given_up() -> None:
    script = (
        "import sys, threading\n"
        "from gateway.cli.main import main\n"
        "from gateway.sources.recording import opening\n"
        "def hang(*_): print('opening', flush=True); threading.Event().wait()\n"
        "opening.open_recording = hang\n"
        "sys.exit(main())"
    )
    command = (sys.executable, "-c", script, "play", "x.mcap", "--port", "0")
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "opening\n"
            process.send_signal(signal.SIGINT)
            assert process.wait(TIMEOUT_S) == 0
        finally:
            process.kill()


async def test_the_demonstration_needs_no_ros_if_it_is_recorded() -> None:
    arguments = ("demo", "--recorded", "--no-browser")
    async with (
        gateway_process(*arguments, module=MODULE) as gateway,
        client(gateway.url) as watching,
    ):
        for topic in ("/map", "/odom", "/camera/image_raw/compressed"):
            await watching.send(op="subscribe", topic=topic)
        assert (await watching.message("/map"))["info"]["width"] > 0
        assert (await watching.message("/camera/image_raw/compressed"))["format"]
        first = (await watching.message("/odom"))["pose"]["pose"]["position"]
        await watching.receive(
            lambda frame: (
                frame.get("topic") == "/odom"
                and frame["msg"]["pose"]["pose"]["position"]["x"] > first["x"]
            )
        )
    assert DEMO.stat().st_size < 1_000_000


def test_missing_readers_are_named_with_the_way_to_get_them(bag: Path) -> None:
    script = (
        "import sys; sys.modules['mcap'] = None\n"
        "from gateway.cli.main import main; sys.exit(main())"
    )
    ended = subprocess.run(
        (sys.executable, "-c", script, "play", bag),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 2
    assert "mcap is missing: install the packages that read and write recordings" in ended.stderr

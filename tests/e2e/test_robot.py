# SPDX-License-Identifier: Apache-2.0
"""The first minute: what a newcomer does with the demonstration, and what can go wrong in it."""

import asyncio
import signal
from collections.abc import AsyncIterator
from contextlib import suppress

import pytest
import pytest_asyncio

from tests.client import TIMEOUT_S, Client, Frame, client, eventually
from tests.demonstration import until_it_can_be_driven
from tests.gateway_process import GatewayProcess, gateway_process

pytestmark = [pytest.mark.brief, pytest.mark.asyncio(loop_scope="module")]

TWIST = "geometry_msgs/msg/Twist"
PATIENCE = 100  # messages, some three seconds of odometry


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def demo() -> AsyncIterator[GatewayProcess]:
    async with gateway_process("demo") as demo:
        async with client(demo.url) as speaker:
            await speaker.send(op="subscribe", topic="/odom", type="nav_msgs/msg/Odometry")
            await speaker.message("/odom")
            await until_it_can_be_driven(speaker)
        yield demo


@pytest_asyncio.fixture(loop_scope="module")
async def speaker(demo: GatewayProcess) -> AsyncIterator[Client]:
    async with client(demo.url) as speaker:
        yield speaker


async def speed(speaker: Client) -> float:
    return (await speaker.message("/odom"))["twist"]["twist"]["linear"]["x"]


async def test_the_first_line_that_drives_works_as_soon_as_it_is_printed():
    async with gateway_process("demo") as fresh, client(fresh.url) as person:
        await person.send(op="subscribe", topic="/odom", type="nav_msgs/msg/Odometry")
        await eventually(lambda: "Ctrl-C" in "".join(fresh.output))
        (pasted,) = [line for line in "".join(fresh.output).splitlines() if '"/cmd_vel"' in line]
        await person.socket.send(pasted)
        while await speed(person) < 0.1:
            assert [frame for frame in person.seen if frame["op"] == "status"] == []


async def test_one_pasted_command_moves_the_robot_and_silence_stops_it(speaker: Client):
    await speaker.send(op="subscribe", topic="/odom")
    command = {"topic": "/cmd_vel", "type": TWIST, "msg": {"linear": {"x": 0.2}}}
    await speaker.send(op="publish", **command)
    heard = 0
    while await speed(speaker) < 0.1:
        heard += 1
        if not heard % PATIENCE:  # the deadline was over before a busy robot has moved
            await speaker.send(op="publish", **command)
    while abs(await speed(speaker)) > 0.001:
        pass


async def test_a_command_beyond_the_robots_limits_is_dismissed_by_it(speaker: Client):
    await speaker.send(op="subscribe", topic="/odom")
    await speaker.send(op="subscribe", topic="/rosout", throttle_rate=0)

    def is_of_command(frame: Frame) -> bool:
        return frame.get("topic") == "/rosout" and "cmd_vel" in frame["msg"]["msg"]

    logged: Frame = {}
    async with asyncio.timeout(TIMEOUT_S):
        while not logged:  # the gateway discovers /rosout of the robot when it can
            await speaker.send(op="publish", topic="/cmd_vel", type=TWIST, msg={})
            await asyncio.sleep(0.3)  # resets what an earlier stop may have set
            await speaker.send(op="publish", topic="/cmd_vel", type=TWIST, msg={"linear": {"x": 5}})
            with suppress(TimeoutError):
                logged = await speaker.receive(is_of_command, within_s=2)
    assert "5" in logged["msg"]["msg"]
    assert abs(await speed(speaker)) < 0.001


async def test_a_gateway_may_send_the_pixels_of_images_unasked():
    async with gateway_process("demo", "--set", "images.default_format=raw") as demo:
        async with client(demo.url) as speaker:
            await speaker.send(
                op="subscribe", topic="/camera/image_raw", type="sensor_msgs/msg/Image"
            )
            image = await speaker.message("/camera/image_raw")
            assert image["step"] == 3 * image["width"]
        async with client(f"{demo.url}?images=jpeg") as speaker:
            await speaker.send(
                op="subscribe", topic="/camera/image_raw", type="sensor_msgs/msg/Image"
            )
            assert (await speaker.message("/camera/image_raw"))["format"] == "jpeg"


async def test_the_gateways_own_log_is_on_rosout(demo: GatewayProcess, speaker: Client):
    await speaker.send(op="subscribe", topic="/rosout")
    await speaker.sync()
    async with client(demo.url) as other:
        await other.sync()
    await speaker.receive(
        lambda frame: (
            frame.get("topic") == "/rosout"
            and frame["msg"]["name"].endswith("_debug")
            and "connected" in frame["msg"]["msg"]
        )
    )


@pytest.mark.parametrize(
    ("frame", "code"),
    [
        ("nonsense", "bad_json"),
        (b'{"op":"\xff"}', "bad_json"),
        ('{"op":"subscribe","topic":"/new","type":"no_msgs/msg/Such"}', "bad_type"),
        ('{"op":"publish","topic":"/cmd_vel","msg":{"linear":{"X":1}}}', "invalid_value"),
        ('{"op":"publish","topic":"/odom","type":"std_msgs/String","msg":{}}', "type_conflict"),
    ],
    ids=lambda value: str(value)[:40],
)
async def test_bad_input_gets_a_status_with_a_reason_and_harms_nobody(
    demo: GatewayProcess, speaker: Client, frame: str | bytes, code: str
):
    async with client(demo.url) as offender:
        await offender.socket.send(frame)
        status = await offender.status()
        assert status["code"] == code
        assert len(status["msg"]) > 10
        await offender.sync()
    await speaker.sync()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGUSR1])
async def test_ending_the_demonstration_closes_clients_with_1001_and_leaves_nothing(
    number: signal.Signals,
):
    async with gateway_process("demo") as demo, client(demo.url) as speaker:
        await speaker.send(op="subscribe", topic="/camera/image_raw", type="sensor_msgs/Image")
        await speaker.message("/camera/image_raw")
        assert await demo.stop(number) == 0
        await speaker.socket.wait_closed()
        assert speaker.socket.close_code == 1001
        assert not [line for line in demo.log if "Traceback" in line]

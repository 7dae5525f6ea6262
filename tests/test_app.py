# SPDX-License-Identifier: Apache-2.0
"""The configuration reaches the parts that it is for."""

import asyncio
import contextlib
import dataclasses
import errno
import json
import logging
import signal
import socket
import threading
from pathlib import Path
from threading import Timer
from types import SimpleNamespace
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from gateway import app, forced_end
from gateway.config.control import ControlConfig
from gateway.config.limits import Limits
from gateway.config.model import Config, RosConfig, TypesConfig
from gateway.definitions import known_definitions
from gateway.guard import MARGIN_S, supervisor
from gateway.log_rate import BURST
from gateway.loop_errors import LoopErrors
from gateway.rosout import logging_to_rosout
from gateway.sources.rclpy import RosOptions, configured, deferred_destruction
from gateway.transport import connections
from schemas.installed import InstalledDefinitions
from tests.client import TIMEOUT_S, client
from tests.gateway_process import gateway_process
from tests.sources.fake import FakeRos

# Each value is unlike every other and unlike every default.
CONFIG = Config(
    ros=RosConfig(node_prefix="arm", namespace="/robot7", domain_id=7, use_sim_time=True),
    limits=Limits(max_ros_entities=1307, reserved_ros_entities=1308),
    control=ControlConfig(topics=("/wheels",)),
    types=TypesConfig(ask_nodes=False),
)
ROS_OPTIONS = RosOptions(
    node_prefix="arm",
    namespace="/robot7",
    domain_id=7,
    use_sim_time=True,
    max_entities=1307,
    reserved_entities=1308,
    reserved_topics=("/wheels",),
    asks_nodes=False,
)
NAV2 = ("SpeedLimit", "Particle")
NOT_CONFIGURED = {
    "arguments",
}  # for tests, and for programs that embed the gateway


def test_every_value_of_the_configuration_reaches_its_place():
    assert configured.ros_options(CONFIG) == ROS_OPTIONS
    # so that a field which nothing sets, or two that are swapped, cannot pass
    for field in dataclasses.fields(ROS_OPTIONS):
        if field.name not in NOT_CONFIGURED:
            assert getattr(ROS_OPTIONS, field.name) != field.default, field.name
    values = [repr(value) for value in dataclasses.astuple(ROS_OPTIONS)]
    assert len(set(values)) == len(values)


def test_the_guard_gets_the_configured_deadline_and_the_nodes_domain():
    config = Config(ros=CONFIG.ros, control=ControlConfig(deadline_s=1.25))
    options = json.loads(configured.guard_of(config).command[-1])
    assert options["silence_ns"] == pytest.approx((1.25 + MARGIN_S) * 1e9)
    assert options["node"]["domain_id"] == 7


async def test_no_traceback_if_the_server_closed_before_asyncio_accepts_again(
    caplog: pytest.LogCaptureFixture,
):
    loop = asyncio.SelectorEventLoop()
    loop.set_exception_handler(LoopErrors())
    listening = socket.socket()
    listening.close()
    try:  # asyncio does this a second after a lack of descriptors
        loop.call_soon(loop._start_serving, asyncio.Protocol, listening)
        await asyncio.to_thread(loop.run_until_complete, asyncio.sleep(0))
        assert caplog.text == ""
        loop.call_soon(int, "no number")
        await asyncio.to_thread(loop.run_until_complete, asyncio.sleep(0))
        assert "Traceback" in caplog.text
    finally:
        loop.close()


def test_refused_connections_are_logged_every_10_s(caplog: pytest.LogCaptureFixture):
    loop: Any = SimpleNamespace()
    errors = LoopErrors()
    said = []
    for now_s in (0.0, 9.9, 10.1, 20.0, 20.2):
        loop.time = lambda now_s=now_s: now_s
        errors(loop, {"exception": OSError(errno.EMFILE, "Too many open files")})
        said.append(len(caplog.messages))
    assert said == [1, 1, 2, 2, 3]
    assert (
        caplog.messages[0]
        == "no client can connect, too many open files: allow more, for example with `ulimit -n`"
    )


def test_configured_definitions_go_before_shipped_ones(tmp_path: Path):
    place = tmp_path / "nav2_msgs" / "msg"
    place.mkdir(parents=True)
    (place / "SpeedLimit.msg").write_text("bool other\n")
    definitions = known_definitions([tmp_path], "types.paths")
    limit, particle = (definitions.get(f"nav2_msgs/msg/{name}") for name in NAV2)
    assert [field.name for field in limit.fields] == ["other"]
    assert [field.name for field in particle.fields] == ["pose", "weight"]


@pytest.mark.parametrize(
    ("packages", "is_made"), [(["std_msgs"], False), (["std_msgs", "my_msgs"], True)]
)
async def test_types_are_made_where_one_is_not_installed(
    packages: list[str], is_made: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for package in packages:
        place = tmp_path / package / "msg"
        place.mkdir(parents=True)
        (place / "Lamp.msg").write_text("bool on\n")
    asked = []

    def opened(options: object, definitions: object, *, makes_types: bool, guard: object) -> Any:
        asked.append(makes_types)
        return contextlib.nullcontext()

    monkeypatch.setattr(configured, "open_ros", opened)
    async with configured.open_source(CONFIG, InstalledDefinitions(folders=[tmp_path])):
        pass
    assert asked == [is_made]


async def test_rosout_gets_client_and_topic_and_no_flood():
    ros = FakeRos()
    logger = logging.getLogger("gateway.test")
    extra = {"client": "10.0.0.5#1", "topic": "/cmd_vel"}
    with logging_to_rosout(ros):
        for _ in range(1000):
            logger.warning("stopped", extra=extra)
        logger.warning("ours")
    await asyncio.sleep(0)
    assert ros.logged[0] == (
        "warning",
        "gateway.test: stopped [client 10.0.0.5#1, topic /cmd_vel]",
    )
    assert ros.logged[-1] == ("warning", "gateway.test: ours")
    assert len(ros.logged) == BURST + 1


async def test_an_allowed_page_may_connect_and_a_foreign_one_gets_403():
    origins = "https://ui.example,https://wall.example"
    async with gateway_process("serve", "--set", f"allowed_origins={origins}") as gateway:
        async with client(gateway.url, origin="https://wall.example") as page:
            await page.sync()
        async with client(gateway.url, origin="http://localhost:1") as local:
            await local.send(op="hello")
            assert (await local.receive(lambda frame: frame["op"] == "hello"))["role"] == "page"
        with pytest.raises(InvalidStatus) as refused:
            async with client(gateway.url, origin="https://foreign.example"):
                pass
        assert refused.value.response.status_code == 403


async def test_the_limits_and_the_path_reach_the_router_and_the_server():
    arguments = ("--path", "/ros", "--set", "limits.max_clients=3")
    bounds = ("--set", "limits.max_clients_per_address=2", "--set", "limits.max_goals=5")
    async with gateway_process("serve", *arguments, *bounds) as gateway:
        assert gateway.url.endswith("/ros")
        async with client(gateway.url) as one, client(gateway.url) as two:
            await one.sync()
            await two.sync()
            await one.send(op="hello")
            hello = await one.receive()
            assert hello["limits"]["goals"] == 5
            with pytest.raises(ConnectionClosed, match="2 clients of one address"):
                async with client(gateway.url) as third:
                    await third.sync()


def test_an_interrupt_before_signals_are_handled_ends_the_start(monkeypatch: pytest.MonkeyPatch):
    loop = SimpleNamespace(add_signal_handler=lambda *_: None)
    monkeypatch.setattr(app.asyncio, "get_running_loop", lambda: loop)
    with pytest.raises(KeyboardInterrupt):
        app.handle_signals(asyncio.Event(), asyncio.Event(), lambda: True)


def test_a_shutdown_that_takes_too_long_ends_by_force(monkeypatch: pytest.MonkeyPatch):
    codes: list[int] = []
    ended = threading.Event()
    monkeypatch.setattr(forced_end, "SHUTDOWN_S", 0.01)
    monkeypatch.setattr(forced_end.os, "_exit", lambda code: (codes.append(code), ended.set()))
    with forced_end.forced_end() as end_by_force:
        end_by_force()
        assert ended.wait(TIMEOUT_S)
    assert codes == [1]


def test_a_shutdown_in_time_does_not_end_by_force(monkeypatch: pytest.MonkeyPatch):
    timers: list[threading.Timer] = []
    monkeypatch.setattr(
        forced_end.threading, "Timer", lambda *args: timers.append(Timer(*args)) or timers[0]
    )
    with forced_end.forced_end() as end_by_force:
        end_by_force()
    (timer,) = timers
    assert timer.interval < 2
    assert timer.finished.is_set()


async def test_sigterm_ends_the_process_in_time_whatever_clients_do():
    async with contextlib.AsyncExitStack() as stack:
        gateway = await stack.enter_async_context(gateway_process())
        clients = [await stack.enter_async_context(client(gateway.url)) for _ in range(2)]
        for number, each in enumerate(clients):
            for topic in range(40):
                name = f"/client{number}/topic{topic}"
                await each.send(op="subscribe", topic=name, type="std_msgs/String")
                await each.send(op="advertise", topic=name, type="std_msgs/String")
                await each.send(op="advertise_service", service=name, type="std_srvs/Empty")
            await each.sync()
            each.socket.transport.pause_reading()  # it never answers the close
            for _ in range(3000):  # more than its budget allows: most of it waits
                await each.send(op="graph")
        assert await gateway.stop(signal.SIGTERM) == 0
        for each in clients:
            each.socket.transport.abort()
    assert not [line for line in gateway.log if "Traceback" in line or "by force" in line]


async def test_a_shutdown_stops_robots_before_it_waits_for_clients():
    async with contextlib.AsyncExitStack() as stack:
        deadline = ("--set", "control.deadline_s=2")
        gateway = await stack.enter_async_context(gateway_process("serve", *deadline))
        page = await stack.enter_async_context(client(gateway.url))
        await page.send(op="control", watch=True)
        await page.send(op="advertise", topic="/cmd_vel", type="geometry_msgs/Twist")
        await page.receive(lambda frame: frame.get("guard") == "ready")

        async def drive() -> None:
            while True:
                await page.send(op="publish", topic="/cmd_vel", msg={"linear": {"x": 0.2}})
                await asyncio.sleep(0.05)

        driving = asyncio.create_task(drive())
        await page.receive(lambda frame: frame.get("state") == "moving")
        page.socket.transport.pause_reading()  # it never answers the close
        assert await gateway.stop(signal.SIGTERM) == 0
        page.socket.transport.abort()
        driving.cancel()
        await asyncio.wait([driving])
    (stop,) = [line for line in gateway.log if "stopped: " in line]
    assert (
        "stopped: the gateway is shutting down" in stop
    )  # neither a client that left, nor a deadline


def test_the_waits_of_a_shutdown_fit_into_its_time():
    waits_s = (connections.MAX_GOODBYE_S, supervisor.END_S, deferred_destruction.SHUTDOWN_S)
    assert sum(waits_s) < forced_end.SHUTDOWN_S < 2

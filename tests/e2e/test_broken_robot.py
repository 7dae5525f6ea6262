# SPDX-License-Identifier: Apache-2.0
"""A robot's computer that is starved or broken: the rows of docs/how-to/broken-robot.md."""

import asyncio
import contextlib
import ctypes
import json
import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from benchmarks.plan import Plan
from benchmarks.robot import CAMERAS, ODOMETRY
from benchmarks.scenarios import robot as robot_scenario
from benchmarks.scenarios.starved import busy_loops
from benchmarks.servers import MeasuredServer
from benchmarks.two_networks import TwoNetworks, reason_against, two_networks
from tests.client import Client, client, eventually
from tests.e2e.faults import scene
from tests.e2e.faults.processes import guard_of, is_running
from tests.gateway_process import gateway_process
from tests.namespaces import needs_namespaces

STRING = "std_msgs/msg/String"
TEXT = b"\0\1\0\0\5\0\0\0text\0"
LATE = "the network came after the start"
HOUR_NS = 3_600_000_000_000
MANY = 20  # messages, more than wait anywhere
CLOCK = Path(__file__).with_name("stepped_clock.c")
SHARED = Path("/dev/shm")  # noqa: S108

# The command after the directory $1 has a small disk there. The test reaches it by /proc/PID/root.
ON_DISK = 'mount -t tmpfs -o size=3m,mode=777 tmpfs "$1" && shift && exec "$@"'

needs_networks = pytest.mark.skipif(reason_against() is not None, reason=str(reason_against()))
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")


async def hears(listener: Client, count: int = MANY) -> None:
    """Receive messages that were published after this call."""
    await listener.sync()
    for _ in range(count):
        assert await listener.message("/talk") == {"data": "text"}


@contextlib.asynccontextmanager
async def talking(topic: str = "/talk", *before: str) -> AsyncIterator[scene.Publisher]:
    async with scene.publisher(topic, STRING, before=before) as talker:
        await talker.repeat(TEXT)
        yield talker


@contextlib.asynccontextmanager
async def listening(url: str) -> AsyncIterator[Client]:
    async with client(url) as listener:
        await listener.send(op="subscribe", topic="/talk", type=STRING)
        await listener.message("/talk")
        yield listener


def fill(directory: Path) -> Path:
    filler = directory / "filler"
    with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
        while file.write(bytes(4096)):
            pass
    assert os.statvfs(directory).f_bavail == 0
    return filler


async def test_next_to_eight_busy_loops_odometry_arrives_and_images_give_way_first():
    def measured() -> robot_scenario.Run:
        with busy_loops():
            (run,) = robot_scenario.runs(MeasuredServer(), Plan(rounds=1, seconds=10, servers=()))
        return run

    run = await asyncio.to_thread(measured)
    assert run.share([ODOMETRY]) >= 0.95
    assert run.share(CAMERAS) <= run.delivered


@needs_namespaces
async def test_a_gateway_whose_disk_is_full_serves(tmp_path: Path, monkeypatch):
    for variable in ("HOME", "XDG_CONFIG_HOME", "ROS_LOG_DIR"):
        monkeypatch.setenv(variable, str(tmp_path))
    before = ("unshare", "--mount", "sh", "-c", ON_DISK, "sh", str(tmp_path))
    audit = ("--set", f"audit.file={tmp_path}/audit.log")
    async with talking(), gateway_process("serve", *audit, before=before) as gateway:
        seen = Path(f"/proc/{gateway.process.pid}/root{tmp_path}")
        async with listening(gateway.url) as listener:
            filler = fill(seen)
            while not any("no space left on device" in line for line in gateway.log):
                async with client(gateway.url) as guest:
                    await guest.sync()
            await hears(listener)
            assert "audit log" in json.dumps(await health(gateway.url))
            filler.unlink()
            while not any("lines are missing" in line for line in gateway.log):
                async with client(gateway.url) as guest:
                    await guest.sync()
        assert await gateway.stop(signal.SIGTERM) == 0
    assert "Traceback" not in "".join(gateway.log)


async def health(url: str, sock: socket.socket | None = None) -> dict[str, object]:
    address = url.removeprefix("ws://").rstrip("/")
    host, _, port = address.partition(":")
    where = {"host": host, "port": int(port)} if sock is None else {"sock": sock}
    reader, writer = await asyncio.open_connection(**where)
    writer.write(f"GET /healthz HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n".encode())
    answer = await reader.read()
    writer.close()
    return json.loads(answer.partition(b"\r\n\r\n")[2])


@needs_namespaces
async def test_a_gateway_goes_on_and_its_guard_stops_the_robot_while_shared_memory_is_full():
    # robot, gateway and guard share a small /dev/shm, which is full from some time on
    holder = await asyncio.create_subprocess_exec(
        *("unshare", "--mount", "sh", "-c", ON_DISK, "sh", str(SHARED), "sleep", "infinity")
    )
    try:
        await eventually(lambda: os.statvfs(f"/proc/{holder.pid}/root{SHARED}").f_blocks < 1000)
        inside = ("nsenter", "--target", str(holder.pid), "--mount", f"--wd={Path.cwd()}")
        async with contextlib.AsyncExitStack() as stack:
            enter = stack.enter_async_context
            robot = await enter(scene.base(before=inside))
            gateway = await enter(gateway_process("serve", before=inside))
            driver = await enter(scene.operator(gateway.url))
            await scene.until_it_moves(robot, driver)
            fill(Path(f"/proc/{holder.pid}/root{SHARED}"))
            full_ns = robot.last_moved_ns
            await scene.until_it_moves(robot, driver, since_ns=full_ns, commands=MANY)
            at_ns = robot.last_moved_ns
            os.kill(gateway.process.pid, signal.SIGKILL)
            await eventually(lambda: robot.zero_after(at_ns) is not None)
            async with gateway_process("serve", before=inside) as gateway:
                driver = await enter(scene.operator(gateway.url))
                await scene.until_it_moves(robot, driver, since_ns=at_ns)
    finally:
        holder.kill()
        await holder.wait()


@pytest.fixture
def clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> "SteppedClock":
    """The wall clock of all processes that the test starts."""
    library = tmp_path / "stepped_clock.so"
    command = ["gcc", "-Wall", "-Werror", "-shared", "-fPIC", "-o", str(library), str(CLOCK)]
    subprocess.run(command, check=True)
    clock = SteppedClock(tmp_path / "offset")
    monkeypatch.setenv("STEPPED_CLOCK", str(clock.file))
    monkeypatch.setenv("LD_PRELOAD", str(library))
    return clock


class SteppedClock:
    def __init__(self, file: Path) -> None:
        self.file = file
        self.step_to(0)

    def step_to(self, offset_ns: int) -> None:
        with self.file.open("r+b" if self.file.exists() else "wb") as file:
            file.write(offset_ns.to_bytes(8, "little", signed=True))


@needs_gcc
async def test_a_clock_that_steps_by_an_hour_changes_nothing(clock: SteppedClock):
    async with contextlib.AsyncExitStack() as stack:
        enter = stack.enter_async_context
        await enter(talking())
        robot = await enter(scene.base())
        gateway = await enter(gateway_process("serve"))
        driver = await enter(scene.operator(gateway.url))
        listener = await enter(listening(gateway.url))
        throttled = await enter(client(gateway.url))
        await throttled.send(op="subscribe", topic="/talk", type=STRING, throttle_rate=100)
        await scene.until_it_moves(robot, driver)
        for offset_ns in (HOUR_NS, 0, -HOUR_NS):
            clock.step_to(offset_ns)
            at_ns = robot.last_moved_ns
            await hears(listener)
            await hears(throttled, 3)
            await scene.until_it_moves(robot, driver, since_ns=at_ns, commands=MANY)
            assert abs(await ros_time_ns(listener) - time.time_ns() - offset_ns) < HOUR_NS / 2
        at_ns = robot.last_moved_ns
        os.kill(gateway.process.pid, signal.SIGKILL)
        await eventually(lambda: robot.zero_after(at_ns) is not None)
    assert "Traceback" not in "".join(gateway.log)


async def ros_time_ns(caller: Client) -> int:
    await caller.send(op="call_service", service="/rosapi/get_time")
    answer = await caller.receive(lambda frame: frame["op"] == "service_response")
    now = answer["values"]["time"]
    return int(now["sec"] * 1e9 + now["nanosec"])


@needs_networks
async def test_without_a_network_at_the_start_robots_here_are_served_and_those_elsewhere_named():
    options = ("--lan", "--no-auth", "--set", "discoverable=false")
    async with contextlib.AsyncExitStack() as stack:
        enter = stack.enter_async_context
        networks = stack.enter_context(two_networks())
        near, far = (
            (*side, "env", "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET")
            for side in (networks.near, networks.far)
        )
        connect(networks, is_up=False)
        await enter(talking("/talk", *near))
        async with gateway_process("serve", *options, before=near) as gateway:
            url, port = gateway.url, int(gateway.url.rstrip("/").rpartition(":")[2])
            reached = partial(connected_in, gateway.process.pid, port)
            assert any("this computer has no network" in line for line in gateway.log)
            async with client(url, sock=reached()) as listener:
                await listener.send(op="subscribe", topic="/talk", type=STRING)
                await hears(listener)
                assert LATE not in json.dumps(await health(url, reached()))
                connect(networks, is_up=True)
                while LATE not in json.dumps(await health(url, reached())):
                    pass
                await hears(listener)
        await enter(talking("/far", *far))
        async with gateway_process("serve", *options, before=near) as gateway:
            port = int(gateway.url.rstrip("/").rpartition(":")[2])
            sock = connected_in(gateway.process.pid, port)
            async with client(gateway.url, sock=sock) as listener:
                await listener.send(op="subscribe", topic="/far", type=STRING)
                assert await listener.message("/far") == {"data": "text"}


def connect(networks: TwoNetworks, *, is_up: bool) -> None:
    state = "up" if is_up else "down"
    subprocess.run([*networks.near, "ip", "link", "set", "near", state], check=True)


def connected_in(pid: int, port: int) -> socket.socket:
    """Return a socket of the network of a process, connected to a port there."""

    def open_socket() -> socket.socket:
        with Path(f"/proc/{pid}/ns/net").open() as namespace:
            assert ctypes.CDLL(None).setns(namespace.fileno(), 0) == 0
        return socket.create_connection(("127.0.0.1", port))

    with ThreadPoolExecutor(1) as other_thread:  # which alone enters
        return other_thread.submit(open_socket).result()


async def test_after_a_restart_of_ros_clients_go_on_without_a_word():
    async with contextlib.AsyncExitStack() as stack:
        enter = stack.enter_async_context
        gateway = await enter(gateway_process("serve"))
        driver = await enter(scene.operator(gateway.url))
        listener = await enter(client(gateway.url))
        await listener.send(op="subscribe", topic="/talk", type=STRING)
        for _ in range(2):
            async with scene.base() as robot, talking() as talker:
                await hears(listener)
                await scene.until_it_moves(robot, driver)
                await talker.end(signal.SIGKILL)
                robot.end(signal.SIGKILL)
        assert await gateway.stop(signal.SIGTERM) == 0
    assert "Traceback" not in "".join(gateway.log)


async def test_after_sigkill_and_a_restart_all_clients_are_back_and_the_robot_is_driven():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    async with contextlib.AsyncExitStack() as stack:
        enter = stack.enter_async_context
        await enter(talking())
        robot = await enter(scene.base())
        url = f"ws://127.0.0.1:{port}/"
        driver = await enter(scene.operator(url))
        at_ns = 0
        for _ in range(2):
            async with scene.gateway("--port", str(port)) as gateway:
                async with asyncio.TaskGroup() as back:
                    for _ in range(MANY):
                        back.create_task(comes_back(url))
                    await scene.until_it_moves(robot, driver, since_ns=at_ns, commands=MANY)
                guard = guard_of(gateway)
                at_ns = robot.last_moved_ns
                gateway.process.kill()
                await eventually(lambda at_ns=at_ns: robot.zero_after(at_ns) is not None)
                await eventually(lambda guard=guard: not is_running(guard))


async def comes_back(url: str) -> None:
    """Connect, as a client does that comes back, and hear messages."""
    while True:
        with contextlib.suppress(OSError):
            async with listening(url) as listener:
                return await hears(listener)
        await asyncio.sleep(0.05)

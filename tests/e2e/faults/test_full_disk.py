# SPDX-License-Identifier: Apache-2.0
"""Disks without room: small file systems that are really full, in a mount namespace of the test."""

import asyncio
import contextlib
import json
import os
import shlex
import signal
import socket
import subprocess
import sys
from collections.abc import AsyncIterator, Callable, Iterator
from pathlib import Path
from typing import IO

import pytest

from gateway.access.token_file import read
from tests.client import client, eventually
from tests.e2e.faults import scene
from tests.gateway_process import GatewayProcess, gateway_process
from tests.namespaces import needs_namespaces

STRING = "std_msgs/msg/String"
PAGE = 4096
TEXT = b"\0\1\0\0\5\0\0\0text\0"

# The command after the folder $1 has a small disk there. The test reaches it by /proc/PID/root.
_MOUNT = 'mount -t tmpfs -o size=64k,mode=755 tmpfs "$1" && shift && exec "$@"'
_SERVE = (sys.executable, "-m", "tests.patient_gateway", "serve", "--port", "0")


@pytest.fixture
def full() -> Iterator[IO[str]]:
    """A file to which nothing can be written."""
    with Path("/dev/full").open("w") as full:
        yield full


def run(*arguments: str, **options: object) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-m", "gateway", *arguments],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        **options,  # type: ignore[call-overload]
    )


def in_a_full_disk(tmp_path: Path, *commands: str, before: str = "true") -> tuple[list[str], str]:
    """Run ros2-gateway in shells on a full disk, and return exit codes, files and errors."""
    disk = tmp_path / "disk"
    disk.mkdir()
    gateway = f"{shlex.quote(sys.executable)} -m gateway"
    script = "; ".join(
        [
            f"mount -t tmpfs -o size=64k,mode=700 tmpfs {disk}",
            before.format(gateway=gateway, disk=disk),
            f"head -c 1000000 /dev/zero > {disk}/filler 2>/dev/null",
            *(f"{each.format(gateway=gateway, disk=disk)}; echo $?" for each in commands),
            f"ls -A {disk}",
        ]
    )
    command = ["unshare", "--mount", "sh", "-c", script]
    finished = subprocess.run(command, capture_output=True, text=True, check=True)
    return finished.stdout.split(), finished.stderr


@needs_namespaces
def test_a_token_that_finds_no_room_is_refused_in_words_and_leaves_the_file_as_it_was(
    tmp_path: Path,
):
    printed, errors = in_a_full_disk(
        tmp_path,
        "{gateway} token --file {disk}/tokens.json create second",
        "{gateway} token --file {disk}/tokens.json list",
        before="{gateway} token --file {disk}/tokens.json create first > /dev/null",
    )
    code, *_ = printed
    assert code != "0"
    assert "no space left on device" in errors
    assert "Traceback" not in errors
    assert "first" in printed
    assert "second" not in printed
    assert [name for name in printed if name.startswith(".")] == []  # no half file


@needs_namespaces
def test_a_certificate_that_finds_no_room_leaves_the_pair_as_it_was(tmp_path: Path):
    pytest.importorskip("cryptography")
    printed, errors = in_a_full_disk(
        tmp_path,
        "{gateway} cert --folder {disk} --replace",
        "sha256sum -c --quiet {disk}/sums",
        before="{gateway} cert --folder {disk} > /dev/null 2>&1;"
        " sha256sum {disk}/key.pem {disk}/cert.pem > {disk}/sums",
    )
    assert printed == ["2", "0", "cert.pem", "filler", "key.pem", "sums"]
    assert "no space left on device" in errors
    assert "Traceback" not in errors


def test_a_token_that_cannot_be_shown_is_not_kept(tmp_path: Path, full: IO[str]):
    path = tmp_path / "tokens.json"
    finished = run("token", "--file", str(path), "create", "a", stdout=full)
    assert finished.returncode == 1
    assert finished.stderr == ("ros2-gateway: cannot write the output, no space left on device\n")
    assert read(path).known == ()


async def test_a_gateway_whose_output_is_full_serves(full: IO[str]):
    process = await asyncio.create_subprocess_exec(
        *_SERVE,
        stdout=full,
        stderr=subprocess.PIPE,
    )
    assert process.stderr is not None
    text = ""
    while "cannot write this, no space left on device: listening on" not in text:
        text = (await process.stderr.readline()).decode()
    async with client(text.split()[-1]) as speaker:
        await speaker.sync()
    process.send_signal(signal.SIGTERM)
    assert await process.wait() == 0


async def test_with_json_a_gateway_whose_output_is_full_serves_and_its_log_says_where(
    full: IO[str],
):
    process = await asyncio.create_subprocess_exec(
        *(*_SERVE, "--log-format", "json"),
        stdout=full,
        stderr=subprocess.PIPE,
    )
    assert process.stderr is not None
    entries = [{"message": ""}]
    while not entries[-1]["message"].startswith("listening on "):
        entries.append(json.loads(await process.stderr.readline()))
    texts = [entry["message"] for entry in entries]
    assert "cannot write standard output, no space left on device" in texts
    async with client(entries[-1]["url"]) as speaker:
        await speaker.sync()
    process.send_signal(signal.SIGTERM)
    _, log = await process.communicate()
    assert process.returncode == 0
    assert [json.loads(line)["level"] for line in log.splitlines()].count("error") == 0


@pytest.mark.parametrize("log_format", ["text", "json"])
async def test_a_gateway_whose_output_and_log_are_on_one_full_disk_serves(
    full: IO[str], log_format: str
):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "gateway", "serve"),
        *("--port", str(port), "--log-format", log_format),
        stdout=full,
        stderr=full,
    )
    is_served = False
    while not is_served:
        assert process.returncode is None
        with contextlib.suppress(ConnectionRefusedError):
            async with client(f"ws://127.0.0.1:{port}") as speaker:
                await speaker.sync()
                is_served = True
        await asyncio.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    assert await process.wait() == 0


@pytest.mark.parametrize("log_format", ["text", "json"])
async def test_a_gateway_whose_log_is_full_serves(full: IO[str], log_format: str):
    process = await asyncio.create_subprocess_exec(
        *(*_SERVE, "--log-level", "debug", "--log-format", log_format),
        stdout=subprocess.PIPE,
        stderr=full,
    )
    assert process.stdout is not None
    said = (await process.stdout.readline()).decode()
    url = json.loads(said)["url"] if log_format == "json" else said.split()[-1]
    for _ in range(3):
        async with client(url) as speaker:
            await speaker.sync()
    process.send_signal(signal.SIGTERM)
    assert await process.wait() == 0


@contextlib.asynccontextmanager
async def gateway_on(disk: Path, *arguments: str) -> AsyncIterator[GatewayProcess]:
    """Run a gateway that sees a small disk on a folder."""
    async with gateway_process("serve", *arguments, before=on_disk(disk)) as gateway:
        yield gateway


def on_disk(disk: Path) -> list[str]:
    return ["unshare", "--mount", "sh", "-c", _MOUNT, "sh", str(disk)]


def fill_page(path: Path) -> None:
    """Append a line that leaves one byte of a page: a full disk has room to its end."""
    empty = json.dumps({"event": ""}) + "\n"
    missing = PAGE - 1 - (path.stat().st_size + len(empty)) % PAGE
    with path.open("a") as file:
        file.write(json.dumps({"event": "x" * missing}) + "\n")


@needs_namespaces
async def test_an_audit_log_without_room_is_said_once_and_goes_on_when_there_is_room_again(
    tmp_path: Path,
):
    disk = tmp_path / "disk"
    disk.mkdir()
    audit = disk / "audit.log"
    async with gateway_on(disk, "--set", f"audit.file={audit}") as gateway:
        seen = Path(f"/proc/{gateway.process.pid}/root{disk}")
        filler = seen / "filler"

        def said(words: str) -> Callable[[], bool]:
            return lambda: any(words in line for line in gateway.log)

        async with client(gateway.url) as stays:
            await stays.sync()
            fill_page(seen / "audit.log")
            with contextlib.suppress(OSError):
                filler.write_bytes(bytes(1_000_000))
            while not said("no space left on device")():
                async with client(gateway.url) as guest:
                    await guest.sync()
            for _ in range(5):
                async with client(gateway.url) as guest:
                    await guest.sync()
            filler.unlink()
            while not said("lines are missing")():
                async with client(gateway.url) as guest:
                    await guest.sync()
            await stays.sync()
        assert len([line for line in gateway.log if "no space left on device" in line]) == 1
        for line in (seen / "audit.log").read_text().splitlines():
            assert json.loads(line)["event"]
        assert await gateway.stop(signal.SIGTERM) == 0


@needs_namespaces
def test_a_machine_without_any_shared_memory_is_told_of_in_words(tmp_path: Path):
    gateway = f"{shlex.quote(sys.executable)} -m gateway serve --port 0"
    script = f"mount -t tmpfs -o size=4k tmpfs /dev/shm; echo > /dev/shm/filler; {gateway}"
    command = ["unshare", "--mount", "sh", "-c", script]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    assert finished.returncode == 1  # after which systemd starts it again
    assert "ROS: no space left in /dev/shm, 0 bytes free" in finished.stderr
    assert "Traceback" not in finished.stderr


@needs_namespaces
async def test_a_robot_is_driven_where_there_is_no_room_for_shared_memory(tmp_path: Path):
    shared = Path("/dev/shm")  # noqa: S108
    async with (
        scene.base() as robot,
        gateway_on(shared) as gateway,
        scene.operator(gateway.url) as driver,
        client(gateway.url) as listener,
        scene.publisher("/talk", STRING) as talker,
    ):
        await listener.send(op="subscribe", topic="/talk", type=STRING)
        await talker.repeat(TEXT)
        assert await listener.message("/talk") == {"data": "text"}
        await scene.until_it_moves(robot, driver)
        assert "Traceback" not in "".join(gateway.log)
        at_ns = robot.last_moved_ns
        os.kill(gateway.process.pid, signal.SIGKILL)
        await eventually(lambda: robot.zero_after(at_ns) is not None)

# SPDX-License-Identifier: Apache-2.0
"""The gateway as the kernel sees it, and as it reports itself over HTTP."""

import asyncio
import contextlib
import json
import os
import re
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

HTTP_S: Final = 30.0
_LOCK: Final = "_el"
_PORT: Final = re.compile(r"/dev/shm/fastrtps_port\d+")  # noqa: S108

# the members of /healthz that are zero when nobody is there
OPENED: Final = (
    *("clients", "subscriptions", "publishers", "services", "action_servers"),
    *("service_clients", "action_clients", "calls", "goals", "ros_entities"),
)


class RefusedError(Exception):
    """A page is not to be had at this moment."""


@dataclass(frozen=True)
class Vitals:
    """One look at the process."""

    at_s: float
    resident_mb: float
    own_mb: float
    """Anonymous memory: not the segments of Fast DDS, which belong to the publishers."""
    descriptors: int
    threads: int
    waited_s: float
    """For how long its threads were ready to run and no core was free: the machine's part."""


@dataclass(frozen=True)
class Leftovers:
    """Everything that must be as it was before."""

    descriptors: int
    threads: int
    tasks: int
    ros_entities: int
    other_opened: int
    shared_memory_files: int
    """Files of /dev/shm that the gateway and its guard have mapped, also deleted ones."""

    def beyond(self, before: "Leftovers") -> dict[str, str]:
        """Return what is more than before."""
        return {
            name: f"{getattr(before, name)} -> {getattr(self, name)}"
            for name in self.__dataclass_fields__
            if getattr(self, name) > getattr(before, name)
        }


def vitals(pid: int) -> Vitals:
    """Look at a process."""
    process = Path("/proc") / str(pid)
    status = dict(
        line.split(":", 1) for line in (process / "status").read_text().splitlines() if ":" in line
    )
    return Vitals(
        at_s=time.monotonic(),
        resident_mb=_mb(status["VmRSS"]),
        own_mb=_mb(status["RssAnon"]),
        descriptors=len(os.listdir(process / "fd")),  # noqa: PTH208  # the names are of no interest
        threads=int(status["Threads"]),
        waited_s=waited_s(pid),
    )


def waited_s(pid: int) -> float:
    """Return for how long the threads of a process were ready to run, and did not."""
    waited_ns = 0
    for thread in Path(f"/proc/{pid}/task").iterdir():
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            # the second number is the time on a run queue: Documentation/scheduler/sched-stats.rst
            waited_ns += int((thread / "schedstat").read_text().split()[1])
    return waited_ns / 1e9


def guard_of(pid: int) -> list[int]:
    """Return the child processes of a gateway: its guard, unless it has just been killed."""
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def shared_memory_files(pid: int) -> set[str]:
    """Return the files of /dev/shm that a process has mapped."""
    with contextlib.suppress(FileNotFoundError, ProcessLookupError):
        lines = Path(f"/proc/{pid}/maps").read_text().splitlines()
        return {line[line.index("/dev/shm") :] for line in lines if "/dev/shm" in line}  # noqa: S108
    return set()


def owned_files(pid: int) -> set[str]:
    """Return the files of /dev/shm that a process has to delete when it ends.

    Fast DDS holds a lock on a second file for each that is its own. Of a port that is all: the
    port itself is deleted by the last of those who send to it, and never if one of them was killed.
    """
    owned = set()
    for descriptor in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(OSError):
            name = str(descriptor.readlink())
            if name.startswith("/dev/shm/") and name.endswith(_LOCK):  # noqa: S108
                owned |= {name, name.removesuffix(_LOCK)}
    return {name for name in owned if not _PORT.fullmatch(name)}


async def leftovers(pid: int, port: int) -> Leftovers:
    """Count what is open."""
    health = json.loads(await http(port, "/healthz"))
    await asyncio.sleep(0.3)  # until the connection of this request is closed
    seen = vitals(pid)
    return Leftovers(
        descriptors=seen.descriptors,
        threads=seen.threads,
        tasks=health["tasks"],
        ros_entities=health["ros_entities"],
        other_opened=sum(health[name] for name in OPENED),
        shared_memory_files=sum(len(shared_memory_files(one)) for one in (pid, *guard_of(pid))),
    )


async def at_rest(pid: int, port: int, within_s: float, most: Leftovers | None) -> Leftovers:
    """Wait until no more is open than *most*, or than a second ago. Return what is open then."""
    end_s = time.monotonic() + within_s
    before = None
    while True:
        try:
            now = await leftovers(pid, port)
        except (RefusedError, OSError, TimeoutError):
            if time.monotonic() > end_s:
                raise
            await asyncio.sleep(1)
            continue
        is_at_rest = not now.other_opened and (not now.beyond(most) if most else now == before)
        if is_at_rest or time.monotonic() > end_s:
            return now
        before = now
        await asyncio.sleep(1)


async def http(port: int, path: str) -> str:
    """Return the body of a page.

    Raises:
        RefusedError: not now.
    """
    async with asyncio.timeout(HTTP_S):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        request = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
        writer.write(request.encode())
        head, _, body = (await reader.read()).partition(b"\r\n\r\n")
        writer.close()
    status = head.split(b"\r\n")[0].decode(errors="replace")
    if " 200 " not in status:
        raise RefusedError(f"{path}: {status}")
    return body.decode()


def _mb(text: str) -> float:
    return int(text.split()[0]) * 1024 / 1e6

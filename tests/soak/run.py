# SPDX-License-Identifier: Apache-2.0
"""One soak, from the start of the gateway to its end."""

import asyncio
import contextlib
import os
import signal
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final
from urllib.parse import urlsplit

from tests.e2e.faults import scene
from tests.e2e.faults.scene import Base
from tests.gateway_process import GatewayProcess, gateway_process
from tests.soak.accounting import Accounting
from tests.soak.actor import Actor, acting
from tests.soak.bad_link import BadLink, FarNetwork, bad_link, far_network
from tests.soak.disturbances import (
    Sensors,
    cut_now_and_then,
    freeze_half_of_the_time,
    sensors,
)
from tests.soak.driving import GIVEN_UP_S, Driving
from tests.soak.isolation import is_isolated
from tests.soak.machine import Machine
from tests.soak.over import Over
from tests.soak.record import BAD_LINK, FROZEN, GOOD, Exit, Record
from tests.soak.vitals import (
    RefusedError,
    Vitals,
    at_rest,
    guard_of,
    http,
    owned_files,
    vitals,
    waited_s,
)

PROGRESS_S: Final = 10.0
# out of three seconds: shorter pauses would measure the machine
ABUSER_RESTS_S: Final = 2.0
WARM_UP_S: Final = 10.0  # until everything that is loaded once, and stays, is loaded
REST_S: Final = 120.0  # DDS knows a killed publisher for 20 s
PAGE_S: Final = 5.0  # between looks at /metrics
# By default, clients of an address beyond loopback need a token. Here there are no other clients.
OPEN: Final = ("--host", "0.0.0.0", "--no-auth", "--anyone-may-drive")  # noqa: S104


async def soak(minutes: float) -> Record:
    """Run all of it."""
    async with contextlib.AsyncExitStack() as stack:
        enter = stack.enter_async_context
        machine = Machine()
        far = await enter(far_network())
        control = await enter(acting("control"))
        robot = await enter(scene.base())
        bare = await enter(acting("bare"))
        publishers = await enter(sensors())
        arguments = OPEN if is_isolated() else ()
        gateway = await enter(gateway_process("serve", "--log-level", "warning", *arguments))
        watching = asyncio.create_task(machine.watch(control))
        try:
            return await _Soak(minutes, gateway, robot, publishers, machine).run(control, bare, far)
        finally:
            watching.cancel()


class _Soak:
    def __init__(
        self,
        minutes: float,
        gateway: GatewayProcess,
        robot: Base,
        publishers: Sensors,
        machine: Machine,
    ) -> None:
        self._minutes = minutes
        self._gateway = gateway
        self._robot = robot
        self._sensors = publishers
        self._machine = machine
        self._pid = gateway.process.pid
        self._port = urlsplit(gateway.url).port or 0
        self._url = f"ws://127.0.0.1:{self._port}/"
        self._vitals: list[Vitals] = []
        self._accounting = Accounting()
        self._counts: dict[str, int] = {}
        self._begin_s = 0.0

    async def run(self, control: Actor, bare: Actor, far: FarNetwork | None) -> Record:
        say("starting")
        await self._warm_up()
        baseline = await at_rest(self._pid, self._port, REST_S, None)
        say(f"at rest: {baseline}")
        async with bad_link(self._port, far) as link:
            say(f"the bad link: {link.description}")
            clients, heard_bare, faults, end_s = await self._load(link, control, bare)
            say("the load is over, clients have left")
            final = await at_rest(self._pid, self._port, REST_S, baseline)
            say(f"at rest: {final}")
            ended = await self._end()
            return Record(
                minutes=self._minutes,
                begin_s=self._begin_s,
                end_s=end_s,
                link=link.description,
                baseline=baseline,
                final=final,
                vitals=self._vitals,
                machine=self._machine,
                accounting=self._accounting,
                clients=clients,
                bare=heard_bare,
                away=self._sensors.away,
                faults=faults,
                exit=ended,
                counts=self._counts,
            )

    async def _warm_up(self) -> None:
        async with (
            acting("listener", self._url),
            acting("churner", self._url),
            scene.operator(self._url) as operator,
            acting("abuser", "127.0.0.1", self._port, 0.1) as abuser,
        ):
            await scene.until_it_moves(self._robot, operator)
            await asyncio.sleep(WARM_UP_S)
            kinds = await abuser.ask("kinds")
            while await abuser.ask("count") < kinds:  # noqa: ASYNC110  # of another process
                await asyncio.sleep(0.2)

    async def _load(
        self, link: BadLink, control: Actor, bare: Actor
    ) -> tuple[dict[str, Any], Any, Any, float]:
        port = await control.ask("port")
        async with contextlib.AsyncExitStack() as stack:
            enter = stack.enter_async_context
            listeners = {
                name: await enter(acting("listener", self._url, "--echo", port, name=name))
                for name in GOOD
            }
            listeners[BAD_LINK] = await enter(
                acting("listener", link.url, "--meta", name=BAD_LINK, before=link.before)
            )
            listeners[FROZEN] = await enter(acting("listener", self._url, "--meta", name=FROZEN))
            churner = await enter(acting("churner", self._url))
            abuser = await enter(acting("abuser", "127.0.0.1", self._port, ABUSER_RESTS_S))
            cable, cable_url = await enter(scene.link(self._port))
            driving = Driving(self._robot, self._pid, cable, cable_url)
            self._begin_s = time.monotonic()
            over = Over(self._minutes * 60)
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(driving.run(over))
                tasks.create_task(self._sensors.die_and_return(over))
                cuts = tasks.create_task(cut_now_and_then(link, over))
                freezes = tasks.create_task(freeze_half_of_the_time(listeners[FROZEN], over))
                watching = tasks.create_task(self._watch(listeners[GOOD[0]], churner))
                pages = tasks.create_task(self._read_pages())
                await asyncio.sleep(self._minutes * 60)
                over.set()
                watching.cancel()
                pages.cancel()
            self._counts = {
                "publishers killed": self._sensors.epoch - 1,
                "bad link cut": cuts.result(),
                "client frozen": freezes.result(),
                "churning client came and left": await churner.ask("count"),
                "abusive client attacked": await abuser.ask("count"),
            }
            end_s = time.monotonic()
            reports = {name: await one.ask("report") for name, one in listeners.items()}
            return reports, await bare.ask("report"), driving.faults, end_s

    async def _watch(self, good: Actor, churner: Actor) -> None:
        """Look at the process every second, and say something every ten."""
        told_s = time.monotonic()
        while True:
            self._vitals.append(vitals(self._pid))
            if time.monotonic() - told_s >= PROGRESS_S:
                told_s = time.monotonic()
                seen = self._vitals[-1]
                heard = await good.ask("count")
                late_ms = self._machine.worst_s(told_s - PROGRESS_S, told_s) * 1e3
                say(
                    f"{told_s - self._begin_s:5.0f} s: {seen.own_mb:.1f} MB of its own,"
                    f" {seen.descriptors} descriptors, {seen.threads} threads,"
                    f" {sum(heard.values())} messages at {good.name},"
                    f" {await churner.ask('count')} visits,"
                    f" load {os.getloadavg()[0]:.1f},"
                    f" sleeps {late_ms:.0f} ms late"
                )
            await asyncio.sleep(1)

    async def _read_pages(self) -> None:
        """Check the sums of /metrics now and then."""
        while True:
            # while it is flooded a gateway may refuse a page. The next one has the same counts
            with contextlib.suppress(OSError, TimeoutError, RefusedError):
                self._accounting.check(await http(self._port, "/metrics"))
            await asyncio.sleep(PAGE_S)

    async def _end(self) -> Exit:
        """End the gateway by SIGTERM while a robot moves and a client listens."""
        own = {name for pid in (self._pid, *guard_of(self._pid)) for name in owned_files(pid)}
        async with acting("listener", self._url), scene.operator(self._url) as operator:
            await scene.until_it_moves(self._robot, operator)
            before_s, waited_before_s = time.monotonic(), waited_s(self._pid)
            self._gateway.process.send_signal(signal.SIGTERM)
            ending = asyncio.create_task(self._gateway.process.wait())
            waited = waited_before_s
            while not ending.done():
                with contextlib.suppress(OSError, IndexError):
                    waited = max(waited, waited_s(self._pid))  # less, as its threads end
                await asyncio.sleep(0.01)
            took_s = time.monotonic() - before_s
            zero_s = await self._zero_after(before_s)
        return Exit(
            code=ending.result(),
            took_s=took_s,
            waited_s=waited - waited_before_s,
            at_s=before_s,
            zero_s=zero_s - before_s,
            files_left=tuple(existing(own)),
            was_forced=any("ending by force" in line for line in self._gateway.log),
            tracebacks=sum("Traceback" in line for line in self._gateway.log),
        )

    async def _zero_after(self, since_s: float) -> float:
        since_ns = int(since_s * 1e9)
        with contextlib.suppress(TimeoutError):
            await scene.until(lambda: self._robot.zero_after(since_ns) is not None, GIVEN_UP_S)
        zero_ns = self._robot.zero_after(since_ns)
        return zero_ns / 1e9 if zero_ns is not None else time.monotonic()


def existing(files: Iterable[str]) -> set[str]:
    """Return those files that exist, or still do."""
    return {name for name in files if Path(name).exists()}


def say(words: str) -> None:
    """Report progress."""
    sys.stdout.write(f"soak: {words}\n")
    sys.stdout.flush()

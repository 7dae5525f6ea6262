# SPDX-License-Identifier: Apache-2.0
"""Slow links: how old are odometry, pictures and commands when they arrive?"""

import contextlib
import math
import statistics
import time
from collections.abc import Iterator
from functools import partial
from typing import Any, Final

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer
from benchmarks.two_networks import TwoNetworks, reason_against, two_networks

_SCENARIO: Final = "links"
_SENT_HZ: Final = {"odometry": 50.0, "image": 15.0}
_COMMANDS_HZ: Final = 20.0
_LINKS_BITS_PER_S: Final = (400_000, 2_000_000, 5_000_000, 20_000_000)
_LOSS_PERCENT: Final = 2
_WARM_UP_S: Final = 8.0  # the rate of the link, and pictures that fit it, are found in the meantime
_SECONDS: Final = 20.0
_OUTAGE_BITS_PER_S: Final = 5_000_000
_OUTAGE_S: Final = 20.0


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    sent = " and ".join(f"{name} at {rate_hz:g} Hz" for name, rate_hz in _SENT_HZ.items())
    print(f"{sent} to one client, commands at {_COMMANDS_HZ:g} Hz from it, over one slow link")
    reason = reason_against()
    if reason is not None:
        print(f"  SKIPPED: {reason}")
        return []
    heads = [f"{f'{name}, Hz':>14}{'p50 ms':>8}{'p99 ms':>8}" for name in (*_SENT_HZ, "commands")]
    print(f"  {'':16}{'link':>18}", *heads, sep="")
    figures: list[Figure] = []
    for server in plan.servers:
        for bits_per_s in _LINKS_BITS_PER_S:
            for loss_percent in (0, _LOSS_PERCENT):
                figures += _measure(server, bits_per_s, loss_percent, plan.rounds)
    print(f"a link of {_OUTAGE_BITS_PER_S / 1e6:g} Mbit/s that was dead for {_OUTAGE_S:g} s")
    for server in plan.servers:
        figures += _return(server)
    return figures


def _return(server: MeasuredServer) -> list[Figure]:
    """Let a client come back after an outage, and look for a picture."""
    with two_networks() as networks:
        networks.shape(_OUTAGE_BITS_PER_S)
        with (
            _serving(server, networks) as url,
            acting("client", url, "image", before=networks.far) as client,
            acting("returning", url, "image", before=networks.far) as returning,
        ):
            client.answer()
            returning.answer()
            time.sleep(_WARM_UP_S)
            networks.cut(is_cut=True)
            returning.send("begin")
            time.sleep(_OUTAGE_S)
            networks.cut(is_cut=False)
            back_ns = time.time_ns()
            seen = returning.answer()
    connected_ms = (seen["connected_ns"] - back_ns) / 1e6
    picture_ms = (seen["first_ns"] - seen["connected_ns"]) / 1e6
    print(
        f"  {server.name:16}connected after {connected_ms:.0f} ms, a picture {picture_ms:.0f} later"
    )
    return [
        Figure(_SCENARIO, f"{server.name} after an outage, connected", connected_ms, "ms"),
        Figure(_SCENARIO, f"{server.name} after an outage, a picture", picture_ms, "ms"),
    ]


def _measure(
    server: MeasuredServer, bits_per_s: int, loss_percent: int, rounds: int
) -> list[Figure]:
    link = f"{bits_per_s / 1e6:g} Mbit/s" + (f", {loss_percent} % lost" if loss_percent else "")
    with two_networks() as networks:
        networks.shape(bits_per_s)
        if loss_percent and not networks.lose(loss_percent):
            print(f"  {server.name:16}{link:>18}  SKIPPED: nft is not installed")
            return []
        with _receiving(server, networks) as (client, listener):
            time.sleep(_WARM_UP_S)
            seen = [_round(client, listener) for _ in range(rounds)]
    line = f"  {server.name:16}{link:>18}"
    figures = []
    for name in seen[0]:
        rate_hz = statistics.median(one[name]["count"] for one in seen) / _SECONDS
        p50_ms, p99_ms = (
            statistics.median(one[name].get(age, math.inf) for one in seen)
            for age in ("p50_ms", "p99_ms")
        )
        line += f"{rate_hz:14.1f}{p50_ms:8.0f}{p99_ms:8.0f}"
        case = f"{server.name} at {link}, {name}"
        figures.append(Figure(_SCENARIO, f"{case}, rate", rate_hz, "Hz"))
        figures.append(Figure(_SCENARIO, f"{case}, p50", p50_ms, "ms"))
        figures.append(Figure(_SCENARIO, f"{case}, p99", p99_ms, "ms"))
    print(line, flush=True)
    return figures


def _round(client: Process, listener: Process) -> dict[str, Any]:
    """Return what came of each kind within `_SECONDS`."""
    client.ask("clear")
    listener.ask("clear")
    time.sleep(_SECONDS)
    seen: dict[str, Any] = client.ask("report")
    return seen | {"commands": listener.ask("report")["twist"]}


@contextlib.contextmanager
def _serving(server: MeasuredServer, networks: TwoNetworks) -> Iterator[str]:
    """Publish in the near network, and serve it. Yield the URL."""
    with contextlib.ExitStack() as stack:
        for name, rate_hz in _SENT_HZ.items():
            stack.enter_context(publishing(name, rate_hz, before=networks.near))
        running = server.running_in(networks.near, networks.url_host)
        url, _ = stack.enter_context(running)
        yield url


@contextlib.contextmanager
def _receiving(server: MeasuredServer, networks: TwoNetworks) -> Iterator[tuple[Process, Process]]:
    """Run everything. Yield the client, and who hears its commands."""
    with (
        _serving(server, networks) as url,
        acting("floor", "twist", "raw", before=networks.near) as listener,
        acting("client", url, *_SENT_HZ, before=networks.far) as client,
        acting("speaker", url, "0/1", before=networks.far) as speaker,
    ):
        for actor in (listener, client, speaker):
            actor.answer()
        speaker.ask("go", _COMMANDS_HZ)
        wait_until(partial(_has_all, client), f"a client gets {list(_SENT_HZ)}")
        yield client, listener


def _has_all(client: Process) -> bool:
    seen: dict[str, Any] = client.ask("report")
    return all(one["count"] > 0 for one in seen.values())

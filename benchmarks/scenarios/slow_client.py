# SPDX-License-Identifier: Apache-2.0
"""One client that reads nothing or slowly, next to some that read: their frames and the memory."""

import contextlib
import statistics
import time
from functools import partial
from typing import Any, Final

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, acting, memory_mb, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "slow-client"
_RATES_HZ: Final = {"image": 30.0, "odometry": 100.0}
_FAST: Final = 3
_WARM_UP_S: Final = 3.0
_SECONDS: Final = 40.0  # enough for a server to cut the slow client off: the gateway takes 30
_SLOW: Final = {"without": None, "one mute": 0, "one at 50 kB/s": 50_000}  # bytes per second


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"{_FAST} clients that read, for {_SECONDS:g} s, without and with one that is slow")
    print(f"  {'':16}{'':24}{'memory grows, MB':>18}", end="")
    print("".join(f"{f'{name}, % got':>18}{'p99 ms':>8}" for name in _RATES_HZ))
    figures: list[Figure] = []
    with contextlib.ExitStack() as stack:
        publishers = {
            name: stack.enter_context(publishing(name, rate_hz))
            for name, rate_hz in _RATES_HZ.items()
        }
        for server in plan.servers:
            for case in _SLOW:
                figures += _measure(server, publishers, case)
    return figures


def _measure(server: MeasuredServer, publishers: dict[str, Process], case: str) -> list[Figure]:
    bytes_per_s = _SLOW[case]
    end = ""
    with contextlib.ExitStack() as stack:
        url, process = stack.enter_context(server.running())
        clients = [stack.enter_context(acting("client", url, *_RATES_HZ)) for _ in range(_FAST)]
        for client in clients:
            client.answer()
            wait_until(partial(_has_all, client), f"a client gets {list(_RATES_HZ)}")
        time.sleep(_WARM_UP_S)
        before_mb = memory_mb(process.pid)
        if bytes_per_s is not None:
            slow = stack.enter_context(acting("slow_reader", url, bytes_per_s, *_RATES_HZ))
            slow.answer()
        for client in clients:
            client.ask("clear")
        before = {name: one.ask("count") for name, one in publishers.items()}
        most_mb = _most_memory_mb(process)
        seen = [client.ask("report") for client in clients]
        sent = {name: one.ask("count") - before[name] for name, one in publishers.items()}
        if bytes_per_s:
            end = ", kept" if slow.ask("is_connected") else ", cut off"
    line = f"  {server.name:16}{case + end:24}{most_mb - before_mb:18.1f}"
    name = f"{server.name}, slow client: {case}"
    figures = [Figure(_SCENARIO, f"{name}, memory grows", most_mb - before_mb, "MB")]
    for sample in _RATES_HZ:
        # frames in transit at either end count as received
        share = min(1.0, min((one[sample]["count"] + 1) / sent[sample] for one in seen))
        p99_ms = statistics.median(one[sample]["p99_ms"] for one in seen)
        line += f"{share * 100:18.1f}{p99_ms:8.1f}"
        figures.append(Figure(_SCENARIO, f"{name}, {sample} got", share * 100, "%"))
        figures.append(Figure(_SCENARIO, f"{name}, {sample} p99", p99_ms, "ms"))
    print(line, flush=True)
    return figures


def _has_all(client: Process) -> bool:
    seen: dict[str, Any] = client.ask("report")
    return all(one["count"] > 0 for one in seen.values())


def _most_memory_mb(process: Process) -> float:
    """Return the most memory that the process uses within the time."""
    most_mb = 0.0
    end_s = time.monotonic() + _SECONDS
    while time.monotonic() < end_s:
        most_mb = max(most_mb, memory_mb(process.pid))
        time.sleep(0.25)
    return most_mb

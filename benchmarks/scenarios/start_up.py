# SPDX-License-Identifier: Apache-2.0
"""The time and the cost from a server's start to the first WebSocket handshake."""

import statistics
import time
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import cpu_s, memory_mb, running
from benchmarks.servers import MeasuredServer, free_port, gateway_command, require_free

_SCENARIO: Final = "start-up"
_STARTS: Final = 5
_TIMEOUT_S: Final = 30.0
_TRY_S: Final = 0.005


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"start to first handshake, median of {_STARTS}")
    print(f"  {'':16}{'ms':>8}{'CPU ms':>8}{'MB':>6}")
    figures: list[Figure] = []
    for server in plan.servers:
        starts = [_start(server) for _ in range(_STARTS)]
        took_s, spent_s, memory = map(statistics.median, zip(*starts, strict=True))
        print(f"  {server.name:16}{took_s * 1e3:8.0f}{spent_s * 1e3:8.0f}{memory:6.0f}", flush=True)
        figures += [
            Figure(_SCENARIO, f"{server.name}, first handshake", took_s * 1e3, "ms"),
            Figure(_SCENARIO, f"{server.name}, CPU", spent_s * 1e3, "ms"),
            Figure(_SCENARIO, f"{server.name}, memory", memory, "MB"),
        ]
    return figures


def _start(server: MeasuredServer) -> tuple[float, float, float]:
    """Return seconds, seconds of CPU and memory up to the first handshake."""
    port = server.port or free_port()
    require_free(port)
    command = server.command or gateway_command(port)
    started_s = time.perf_counter()
    with running(server.name, *command) as process:
        while True:
            try:
                with RawConnection(f"ws://127.0.0.1:{port}"):
                    took_s = time.perf_counter() - started_s
                    return took_s, cpu_s(process.pid), memory_mb(process.pid)
            except OSError as error:
                if not process.is_running() or time.perf_counter() - started_s > _TIMEOUT_S:
                    raise BenchmarkError(f"{server.name} accepts nobody: {error}") from None
            time.sleep(_TRY_S)

# SPDX-License-Identifier: Apache-2.0
"""The time and the cost from a server's start to the first WebSocket handshake.

Also the time from the SIGKILL of a gateway until all its clients have messages again. As under
systemd, the next one starts 0.1 s after the guard of the killed one has ended.
"""

import contextlib
import os
import signal
import statistics
import time
from pathlib import Path
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import acting, cpu_s, memory_mb, running, wait_until
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer, free_port, gateway_command, require_free

_SCENARIO: Final = "start-up"
_STARTS: Final = 5
_TIMEOUT_S: Final = 30.0
_TRY_S: Final = 0.005
_KILLS: Final = 3
_CLIENTS: Final = 5
_SAMPLE: Final = "odometry"
_RATE_HZ: Final = 50.0
_RESTART_S: Final = 0.1  # RestartSec= of gateway/cli/ros2-gateway.service


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
    return figures + _kills()


def _kills() -> list[Figure]:
    """Print the times of the gateway after its SIGKILL."""
    times = zip(*[_kill() for _ in range(_KILLS)], strict=True)
    print(f"SIGKILL to {_CLIENTS} clients, median of {_KILLS}")
    figures: list[Figure] = []
    for name, values in zip(("guard ended", "connected", "messages"), times, strict=True):
        figures.append(Figure(_SCENARIO, f"after SIGKILL, {name}", statistics.median(values), "ms"))
        print(f"  {name:16}{figures[-1].value:8.0f} ms", flush=True)
    return figures


def _kill() -> tuple[float, float, float]:
    """Return the milliseconds until the guard has ended and the last client is back."""
    port = free_port()
    url = f"ws://127.0.0.1:{port}"
    with contextlib.ExitStack() as stack:
        stack.enter_context(publishing(_SAMPLE, _RATE_HZ))
        killed = stack.enter_context(running("gateway", *gateway_command(port)))
        killed.line_with("listening")
        clients = [stack.enter_context(acting("returning", url, _SAMPLE)) for _ in range(_CLIENTS)]
        for client in clients:
            client.answer()
        guard = Path(f"/proc/{killed.pid}/task/{killed.pid}/children").read_text().split()[0]
        at_ns = time.time_ns()
        os.kill(killed.pid, signal.SIGKILL)
        wait_until(lambda: not killed.is_running(), "the gateway is killed")
        for client in clients:
            client.send("begin")
        wait_until(lambda: not Path(f"/proc/{guard}/exe").exists(), "the guard ends")
        guard_ns = time.time_ns()
        time.sleep(_RESTART_S)
        stack.enter_context(running("gateway", *gateway_command(port)))
        seen = [client.answer() for client in clients]
    last = (max(one[name] for one in seen) for name in ("connected_ns", "first_ns"))
    guard_ms, connected_ms, messages_ms = ((each - at_ns) / 1e6 for each in (guard_ns, *last))
    return guard_ms, connected_ms, messages_ms


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

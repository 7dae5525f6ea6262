# SPDX-License-Identifier: Apache-2.0
"""What each further client of a topic costs the gateway: a frame is made once, and sent often."""

import time
from typing import Final

from benchmarks.processes import count, cpu_s, line_with, memory_mb, running

_CLIENTS: Final = (1, 10, 50, 200)
_SAMPLE: Final = "odometry"
_RATE_HZ: Final = 50.0
_SECONDS: Final = 6.0
_ROOM: Final = (
    *("--set", f"limits.max_clients={max(_CLIENTS)}"),
    *("--set", f"limits.max_clients_per_address={max(_CLIENTS)}"),
)


def main() -> None:
    """Print a table."""
    print(f"\n{_SAMPLE} at {_RATE_HZ:g} Hz to many clients")
    print(f"{'clients':>8}{'frames/s':>10}{'CPU us per frame':>18}{'% of a core':>13}{'MB':>6}")
    with running("benchmarks.publisher", _SAMPLE, str(_RATE_HZ)):
        for clients in _CLIENTS:
            _measure(clients)


def _measure(clients: int) -> None:
    with running("gateway", "serve", "--port", "0", "--log-level", "warning", *_ROOM) as gateway:
        url = line_with(gateway, r"ws://\S+")
        with running("benchmarks.many_clients", url, _SAMPLE, str(clients)) as receivers:
            line_with(receivers, "ready")
            time.sleep(1)
            before, before_s = count(receivers), cpu_s(gateway.pid)
            time.sleep(_SECONDS)
            frames, spent_s = count(receivers) - before, cpu_s(gateway.pid) - before_s
            memory = memory_mb(gateway.pid)
    print(
        f"{clients:8}{frames / _SECONDS:10.0f}{spent_s / frames * 1e6:18.1f}"
        f"{spent_s / _SECONDS * 100:13.1f}{memory:6.0f}",
        flush=True,
    )

# SPDX-License-Identifier: Apache-2.0
"""How the processes of a benchmark tell what they saw."""

import json
import signal
import statistics


class Ages:
    """The ages of messages on arrival, in nanoseconds."""

    def __init__(self) -> None:
        self._ages_ns: list[int] = []

    def add(self, age_ns: int) -> None:
        """Note one message."""
        self._ages_ns.append(age_ns)

    def announce(self) -> None:
        """Say that receiving begins; from now on SIGUSR1 asks for the count so far."""
        signal.signal(signal.SIGUSR1, lambda *_: print("count", len(self._ages_ns), flush=True))
        print("ready", flush=True)

    def print(self) -> None:
        """Write the count and the median and 99th percentile as one line of JSON."""
        settled = self._ages_ns[len(self._ages_ns) // 10 :]  # without start-up
        cuts = statistics.quantiles(settled, n=100)
        print(
            json.dumps(
                {
                    "count": len(self._ages_ns),
                    "p50_ms": statistics.median(settled) / 1e6,
                    "p99_ms": cuts[98] / 1e6,
                }
            ),
            flush=True,
        )

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
        """Write the count and the percentiles 50, 90 and 99 as one line of JSON."""
        settled = self._ages_ns[len(self._ages_ns) // 10 :]  # without start-up
        cuts = statistics.quantiles(settled, n=100)
        figures = {f"p{percent}_ms": cuts[percent - 1] / 1e6 for percent in (50, 90, 99)}
        print(json.dumps({"count": len(self._ages_ns)} | figures), flush=True)

# SPDX-License-Identifier: Apache-2.0
"""The plan of a run: precision and servers."""

from dataclasses import dataclass

from benchmarks.servers import MeasuredServer


@dataclass(frozen=True)
class Plan:
    """The options of the command line that every scenario follows."""

    rounds: int
    seconds: float
    """Of each measurement."""
    servers: tuple[MeasuredServer, ...]
    """The gateway, then the servers measured next to it."""
    seeks_highest_rates: bool = True

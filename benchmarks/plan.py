# SPDX-License-Identifier: Apache-2.0
"""How thoroughly to measure, and whom."""

from dataclasses import dataclass

from benchmarks.servers import Server


@dataclass(frozen=True)
class Plan:
    """What the command line asks of every scenario."""

    rounds: int
    seconds: float
    """Of each measurement."""
    servers: tuple[Server, ...]
    """The gateway, then what is measured beside it."""
    seeks_highest_rates: bool = True

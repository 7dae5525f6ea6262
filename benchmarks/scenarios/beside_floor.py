# SPDX-License-Identifier: Apache-2.0
"""Servers next to a bare rclpy subscriber: all receive from the same publisher, in turns.

A large message has no ratio. By default glibc maps its memory again each time, or keeps it, by what
the process did before: that doubles the floor's time, and would halve a ratio to it.
"""

import statistics
from collections.abc import Sequence
from dataclasses import astuple
from typing import Final

from benchmarks.figures import Figure, ratio
from benchmarks.plan import Plan
from benchmarks.receivers import Floor, Receipt, Receiver, ReceivingClient, publishing
from benchmarks.samples import SAMPLES
from benchmarks.scenarios.held_rate import highest_of
from benchmarks.scenarios.picture import encoder_share
from benchmarks.search import Highest

_LARGE_BYTES: Final = 256 * 1024  # twice what glibc begins to map for itself


def measure(name: str, plan: Plan) -> list[Figure]:
    """Measure one kind of message, print a table and return the figures."""
    receivers: list[Receiver] = [Floor(), *(ReceivingClient(server) for server in plan.servers)]
    with publishing(name, SAMPLES[name].rate_hz):
        rounds = [
            [_receipt(one, name, plan.seconds) for one in receivers] for _ in range(plan.rounds)
        ]
    is_large = len(SAMPLES[name].cdr()) > _LARGE_BYTES
    cpu, beside = ("CPU ms", "") if is_large else ("CPU us", "ratio")
    print(f"{name:18}{'Hz':>6}{cpu:>9}{beside:>7}{'p50 ms':>8}{'p90 ms':>8}", end="")
    print(f"{'p99 ms':>8}{'MB':>6}{'held/s':>10}")
    figures: list[Figure] = []
    for column, receiver in enumerate(receivers):
        receipts = [one[column] for one in rounds]
        cpu_ratio = None if is_large else _cpu_ratio(rounds, column)
        held = highest_of(receiver, name, plan.seconds) if plan.seeks_highest_rates else None
        figures += _figures(name, receiver.name, _median(receipts), held, is_large=is_large)
        if column and cpu_ratio is not None:
            figures.append(ratio(name, f"{receiver.name}, CPU beside the floor's", cpu_ratio))
        _print_row(receiver.name, _median(receipts), cpu_ratio, held)
        if name == "image" and column == 1:
            print(encoder_share(_median(receipts).cpu_us_per_message))
    return figures


def _receipt(receiver: Receiver, name: str, seconds: float) -> Receipt:
    with receiver.receiving(name) as reception:
        return reception.receipt(seconds)


def _cpu_ratio(rounds: Sequence[Sequence[Receipt]], column: int) -> float:
    """Return the CPU time of a receiver next to that of the floor, the first column."""
    # each next to the floor that was measured just before: a machine's speed drifts
    return statistics.median(
        one[column].cpu_us_per_message / one[0].cpu_us_per_message for one in rounds
    )


def _median(receipts: Sequence[Receipt]) -> Receipt:
    columns = zip(*map(astuple, receipts), strict=True)
    return Receipt(*(statistics.median(column) for column in columns))


def _print_row(name: str, receipt: Receipt, cpu_ratio: float | None, held: Highest | None) -> None:
    """Print a row. Without a ratio, of a large message, the CPU time is in ms."""
    cpu_us = receipt.cpu_us_per_message
    cpu = f"{cpu_us / 1e3:9.2f}{'':7}" if cpu_ratio is None else f"{cpu_us:9.0f}{cpu_ratio:7.2f}"
    print(
        f"  {name:16}{receipt.rate_hz:6.0f}{cpu}"
        f"{receipt.p50_ms:8.2f}{receipt.p90_ms:8.2f}{receipt.p99_ms:8.2f}{receipt.memory_mb:6.0f}"
        f"{'' if held is None else str(held):>10}",
        flush=True,
    )


def _figures(
    name: str, who: str, receipt: Receipt, held: Highest | None, *, is_large: bool
) -> list[Figure]:
    cpu_us = receipt.cpu_us_per_message
    cpu = (cpu_us / 1e3, "ms per message") if is_large else (cpu_us, "us per message")
    figures = [
        Figure(name, f"{who}, CPU", *cpu),
        Figure(name, f"{who}, p50", receipt.p50_ms, "ms"),
        Figure(name, f"{who}, p90", receipt.p90_ms, "ms"),
        Figure(name, f"{who}, p99", receipt.p99_ms, "ms"),
        Figure(name, f"{who}, memory", receipt.memory_mb, "MB"),
    ]
    if held is not None:
        what = "highest rate sent, all held" if held.is_senders_limit else "highest rate held"
        figures.append(Figure(name, f"{who}, {what}", held.rate_hz, "Hz"))
    return figures

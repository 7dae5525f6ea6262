# SPDX-License-Identifier: Apache-2.0
"""The result of a soak as Markdown, and its place in a page."""

import os
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from tests.soak.record import Record
from tests.soak.verdicts import Verdict

MARK: Final = "<!-- results: written by `make soak`, below this line -->"


def markdown(record: Record, verdicts: Sequence[Verdict], *, strict: bool) -> str:
    """Return the result."""
    return "\n".join([*_head(record, strict=strict), *_table(verdicts), *_load(record), ""])


def write(path: Path, result: str) -> None:
    """Replace the result in a page, which must have the mark."""
    words, mark, _ = path.read_text("utf-8").partition(MARK)
    if not mark:
        raise ValueError(f"{path} has no line {MARK}")
    path.write_text(f"{words}{MARK}\n\n{result}", "utf-8")


def summary(verdicts: Sequence[Verdict]) -> str:
    """Return the outcome in a line."""
    failed = [one.subject for one in verdicts if one.failed]
    text = f"{len(verdicts) - len(failed)} held, {len(failed)} failed"
    return text + (f": {', '.join(failed)}" if failed else "")


def _head(record: Record, *, strict: bool) -> list[str]:
    loads = record.machine.loads or [0.0]
    late = sorted(by_s for _, by_s in record.machine.late)
    cores = len(os.sched_getaffinity(0))
    now = datetime.now(UTC)
    system = f"Linux {platform.release().split('-')[0]}, Python {platform.python_version()}"
    manner = "strictly" if strict else "leniently"
    worst_ms = late[-1] * 1e3 if late else 0.0
    load = f"{sum(loads) / len(loads):.1f} ({max(loads):.1f} at most)"
    lateness = f"up to {worst_ms:.0f} ms late, and {len(late)} times more than 5 ms"
    return [
        f"{record.minutes:g} minutes on {now:%Y-%m-%d}, {cores} cores, {system}. Judged {manner}.",
        f"The load average was {load}.",
        f"A process that only sleeps was {lateness}.",
        f"The bad link: {record.link}.",
        "",
    ]


def _table(verdicts: Sequence[Verdict]) -> list[str]:
    rows = [f"| {one.subject} | {one.figure} | {one.bound} | {one.word} |" for one in verdicts]
    return ["| Subject | Figure | Limit | Verdict |", "|---|---|---|---|", *rows, ""]


def _load(record: Record) -> list[str]:
    topics = list(record.bare["heard"])
    lines = [
        "| Client | " + " | ".join(topics) + " | Connections |",
        "|---|" + "---|" * (len(topics) + 1),
        "| (bare subscriber) | "
        + " | ".join(str(record.bare["heard"][topic]) for topic in topics)
        + " | |",
    ]
    for name, report in record.clients.items():
        heard = " | ".join(str(report["heard"][topic]) for topic in topics)
        lines.append(f"| {name} | {heard} | {report['connections']} |")
    disturbances = [f"- {name}: {count} times" for name, count in record.counts.items()]
    first, last = record.vitals[0], record.vitals[-1]
    resident = f"{first.resident_mb:.0f} -> {last.resident_mb:.0f} MB"
    own = f"{first.own_mb:.0f} -> {last.own_mb:.0f} MB"
    return [
        *lines,
        "",
        "Disturbances:",
        "",
        *disturbances,
        "",
        f"Resident memory: {resident}, of which {own} are the gateway's.",
        "The rest are libraries, and shared memory of the publishers.",
    ]

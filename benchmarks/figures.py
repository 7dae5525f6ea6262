# SPDX-License-Identifier: Apache-2.0
"""Measured numbers with names: stored as JSON, and compared with stored ones."""

import json
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from benchmarks.errors import BenchmarkError

REFERENCES: Final = Path(__file__).parent / "reference"
TOLERANCE: Final = 0.15  # machines are noisy: two runs of the same code differ by as much


@dataclass(frozen=True)
class Figure:
    """One number. Only ratios can be compared between machines. A smaller ratio is better."""

    scenario: str
    name: str
    value: float
    unit: str = ""
    is_ratio: bool = False

    @property
    def key(self) -> tuple[str, str]:
        """The unique key: scenario and name."""
        return self.scenario, self.name


@dataclass(frozen=True)
class Verdict:
    """A ratio next to the stored one."""

    scenario: str
    name: str
    stored: float
    now: float

    @property
    def word(self) -> str:
        """The verdict in one word."""
        if self.now > self.stored * (1 + TOLERANCE):
            return "WORSE"
        return "better" if self.now < self.stored * (1 - TOLERANCE) else "same"


def ratio(scenario: str, name: str, value: float) -> Figure:
    """Return a figure that can be compared between machines."""
    return Figure(scenario, name, value, "ratio", is_ratio=True)


def compare(
    stored: Iterable[Figure],
    measured: Iterable[Figure],
    measure_again: Callable[[str], Sequence[Figure]],
) -> list[Verdict]:
    """Judge every ratio that both have.

    If a ratio looks worse, its whole scenario is measured once more. It is worse only if the median
    of both runs still is.
    """
    known = {one.key: one.value for one in stored if one.is_ratio}
    verdicts = [
        Verdict(*one.key, known[one.key], one.value)
        for one in measured
        if one.is_ratio and one.key in known
    ]
    suspects = dict.fromkeys(one.scenario for one in verdicts if one.word == "WORSE")
    second = {one.key: one.value for name in suspects for one in measure_again(name)}
    return [_confirmed(one, second) if one.word == "WORSE" else one for one in verdicts]


def table(verdicts: Sequence[Verdict]) -> str:
    """Return all verdicts in one table."""
    names = [f"{one.scenario}: {one.name}" for one in verdicts]
    width = max(map(len, names), default=0)
    lines = [f"{'':{width}}{'stored':>9}{'now':>9}  verdict"]
    for name, one in zip(names, verdicts, strict=True):
        lines.append(f"{name:{width}}{one.stored:9.2f}{one.now:9.2f}  {one.word}")
    return "\n".join(lines)


def write(path: Path, figures: Iterable[Figure]) -> None:
    """Store figures, one per line, so that a diff shows which have changed."""
    lines = ",\n".join(f" {json.dumps(asdict(one))}" for one in figures)
    path.write_text(f"[\n{lines}\n]\n")


def read(reference: str) -> list[Figure]:
    """Read the figures stored under a name, or in a file.

    Raises:
        BenchmarkError: they do not exist, or the file holds something else.
    """
    named = REFERENCES / f"{reference}.json"
    path = named if named.is_file() else Path(reference)
    try:
        return [Figure(**one) for one in json.loads(path.read_bytes())]
    except OSError:
        known = ", ".join(sorted(one.stem for one in REFERENCES.glob("*.json"))) or "none"
        raise BenchmarkError(
            f"no stored figures {reference}: neither a file nor a name (there are: {known})"
        ) from None
    except (ValueError, TypeError):
        raise BenchmarkError(f"{path} has no figures: write them with --json") from None


def _confirmed(first: Verdict, second: dict[tuple[str, str], float]) -> Verdict:
    again = second.get((first.scenario, first.name), first.now)
    median = statistics.median((first.now, again))
    return Verdict(first.scenario, first.name, first.stored, median)

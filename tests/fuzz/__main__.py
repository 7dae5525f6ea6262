# SPDX-License-Identifier: Apache-2.0
"""Fuzz some targets, and print each fault as a test, for `make fuzz`."""

import argparse
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz import faults
from tests.fuzz.stopwatch import STOPWATCH
from tests.fuzz.targets import NAMES, load

CONVERSATIONS = "conversations"  # no bytes: steps that hypothesis makes up
CACHE = Path(__file__).parents[2] / ".cache" / "fuzz"
MAX_BYTES = 4096  # of one input: what is wrong shows in less, and short ones are tried more often
HANGS_S = 60  # for one input, on a busy machine
MEMORY_MB = 3000
BAR_S = 0.020  # no operation holds the event loop for longer
ROUNDS = 5  # in which what is slow is tried once more, without atheris
_EXECUTED = re.compile(r"stat::number_of_executed_units:\s*(\d+)")


@dataclass
class Outcome:
    """The outcome of one target."""

    name: str
    executed: int = 0
    found: list[bytes] = field(default_factory=list)
    slow: list[tuple[float, bytes]] = field(default_factory=list)
    slowest_s: float = 0.0


def main() -> int:
    parser = argparse.ArgumentParser(prog="make fuzz", description=__doc__)
    known = (*NAMES, CONVERSATIONS)
    parser.add_argument("targets", nargs="*", metavar="target", help=", ".join(known))
    parser.add_argument("--seconds", type=int, default=60, help="for each target")
    arguments = parser.parse_args()
    if unknown := set(arguments.targets) - set(known):
        parser.error(f"unknown target {', '.join(unknown)}: choose from {', '.join(known)}")
    wanted = arguments.targets or known
    failed = CONVERSATIONS in wanted and converse(arguments.seconds) != 0
    outcomes = [fuzz(name, arguments.seconds) for name in wanted if name != CONVERSATIONS]
    print(f"{'target':16}{'executions':>12}{'faults':>8}{'slowest':>11}")
    for each in outcomes:
        count = len(each.found) + len(each.slow)
        print(f"{each.name:16}{each.executed:12}{count:8}{each.slowest_s * 1e3:8.1f} ms")
    return failed or any(each.found or each.slow for each in outcomes)


def converse(seconds: int) -> int:
    """Let clients say anything to a gateway in a process. Return pytest's exit code."""
    print(f"{CONVERSATIONS}: {seconds} s ...", flush=True)
    test = "tests/fuzz/test_conversations.py::test_nothing_that_clients_say_holds_the_event_loop"
    limit = f"faulthandler_timeout={seconds + 660}"
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-s", "-n0", "-o", limit, test],
        env={**os.environ, "FUZZ_SECONDS": str(seconds)},
        check=False,
    ).returncode


def fuzz(name: str, seconds: int) -> Outcome:
    """Fuzz one target in a separate process, and look at what it has kept."""
    folder = CACHE / name
    for kept in ("faults", "slow", "seeds"):
        shutil.rmtree(folder / kept, ignore_errors=True)
        (folder / kept).mkdir(parents=True)
    (folder / "corpus").mkdir(exist_ok=True)
    target = load(name)
    for number, seed in enumerate(target.seeds()):
        (folder / "seeds" / str(number)).write_bytes(seed)
    print(f"{name}: {target.promise}; {seconds} s ...", flush=True)
    finished = subprocess.run(
        [
            *(sys.executable, "-m", "tests.fuzz.guided", name, str(folder)),
            f"-max_total_time={seconds}",
            f"-max_len={MAX_BYTES}",
            f"-timeout={HANGS_S}",
            f"-rss_limit_mb={MEMORY_MB}",
            f"-report_slow_units={HANGS_S}",
            f"-artifact_prefix={folder / 'faults'}/",
            "-print_final_stats=1",
            str(folder / "corpus"),
            str(folder / "seeds"),
        ],
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    outcome = Outcome(name)
    if counted := _EXECUTED.search(finished.stderr):
        outcome.executed = int(counted[1])
    else:
        print(finished.stderr[-3000:])
    (folder / "log").write_text(finished.stderr)  # with the tracebacks that do not come again
    for path in sorted((folder / "faults").iterdir()):
        data = faults.shortest(target.run, path.read_bytes())
        outcome.found.append(data)
        print(path, faults.text_of(target.run, data), sep="\n")
        print(faults.as_test(name, data))
    for path in sorted((folder / "slow").iterdir()):
        weigh(outcome, path.read_bytes())
    return outcome


def weigh(outcome: Outcome, data: bytes) -> None:
    """Measure what was slow under atheris, which makes everything slower."""
    target = load(outcome.name)
    if faults.fault_of(target.run, data):
        return
    took_s = min(STOPWATCH.longest_s(lambda: target.run(data)) for _ in range(ROUNDS))
    outcome.slowest_s = max(outcome.slowest_s, took_s)
    if took_s > BAR_S:
        outcome.slow.append((took_s, data))
        print(f"# {took_s * 1e3:.0f} ms of CPU, at most {BAR_S * 1e3:g} may be\n")
        print(faults.as_test(outcome.name, data))


if __name__ == "__main__":
    sys.exit(main())

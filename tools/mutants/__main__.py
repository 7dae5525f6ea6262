# SPDX-License-Identifier: Apache-2.0
"""Break the code by rules, one mutant at a time, and check that tests notice.

See docs/contributing/mutants.md.
"""

import argparse
import compileall
import contextlib
import difflib
import os
import py_compile
import queue
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from tools.mutants.rules import EVERYWHERE, IN_SAFETY, Mutant
from tools.mutants.selection import ROOT, all_mutants, select, stages_of, waivers

MIN_KILLED: Final = 0.92
# One group of tests takes three minutes. Beyond this time it hangs, and the mutant is noticed.
TIMEOUT_S: Final = 600
TEST_TIMEOUT_S: Final = 60

_FAILED_TEST: Final = re.compile(r"^(?:FAILED|ERROR) ([^\s:]+)", re.MULTILINE)


class MutantError(Exception):
    """Raised when the tests cannot judge a mutant. The text says which and why."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A mutant, the tests that noticed it, if any did, the seconds that it took, and its diff."""

    mutant: Mutant
    killer: str | None
    took_s: float
    difference: str


class Copies:
    """Copies of the tree, each for one run of tests at a time. The tree itself is not touched."""

    def __init__(self, root: Path, folder: Path, count: int) -> None:
        self._free: queue.Queue[Path] = queue.Queue()
        self._good: dict[str, bool] = {}  # whether tests pass without any mutant
        for number in range(count):
            self._free.put(_copy(root, folder / str(number)))

    def try_out(self, mutant: Mutant) -> Trial:
        """Run the tests of a mutant, the nearest first, until a test fails.

        Raises:
            MutantError: a test fails without any mutant.
        """
        started_s = time.monotonic()
        copy = self._free.get()
        path = copy / mutant.file
        whole = path.read_bytes()
        difference, killer = _difference(mutant, whole), None
        try:
            for tests in stages_of(mutant.file, copy):
                path.write_bytes(mutant.broken(whole))
                killer = _run(copy, tests)
                path.write_bytes(whole)
                if killer is not None:
                    self._check(copy, killer)
                    break
        finally:
            path.write_bytes(whole)
            self._free.put(copy)
        return Trial(mutant, killer, time.monotonic() - started_s, difference)

    def _check(self, copy: Path, tests: str) -> None:
        if tests not in self._good:  # at the second time a busy machine is not to blame
            self._good[tests] = any(_run(copy, tests.split()) is None for _ in range(2))
        if not self._good[tests]:
            raise MutantError(f"{tests} fails without any mutant: repair it, then run again")


def run(
    mutants: Sequence[Mutant],
    jobs: int,
    root: Path = ROOT,
    report: Callable[[str], None] = print,
) -> list[Trial]:
    """Try all mutants and return the trials in the list's order.

    Raises:
        MutantError: tests fail without any mutant.
    """
    with (
        tempfile.TemporaryDirectory(prefix="mutants-") as folder,
        ThreadPoolExecutor(jobs) as pool,
    ):
        copies = Copies(root, Path(folder), jobs)
        tries = [pool.submit(copies.try_out, mutant) for mutant in mutants]
        try:
            for done, tried in enumerate(as_completed(tries), start=1):
                trial = tried.result()
                fate = "SURVIVED" if trial.killer is None else f"killed by {trial.killer}"
                number = f"[{done:{len(str(len(mutants)))}}/{len(mutants)}]"
                mutant = trial.mutant
                report(f"{number} {mutant.rule}: {mutant.name}: {fate} ({trial.took_s:.0f} s)")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [tried.result() for tried in tries]


def verdict(trials: Sequence[Trial], report: Callable[[str], None] = print) -> bool:
    """Report survivors as a diff, and the share of each room. Return whether enough are killed."""
    survivors = [trial for trial in trials if trial.killer is None]
    for trial in survivors:
        report(f"\n{trial.difference}")
    tried, survived = (Counter(_room(each.mutant) for each in some) for some in (trials, survivors))
    for room, count in [*sorted(tried.items()), ("all", len(trials))]:
        killed = count - (survived[room] if room != "all" else len(survivors))
        report(f"{room:30} {count:5} mutants {killed:5} killed {killed / count:5.0%}")
    return len(trials) - len(survivors) >= MIN_KILLED * len(trials)


def _difference(mutant: Mutant, whole: bytes) -> str:
    texts = (text.decode().splitlines() for text in (whole, mutant.broken(whole)))
    places = f"a/{mutant.file}", f"b/{mutant.file}"
    return "\n".join(difflib.unified_diff(*texts, *places, n=2, lineterm=""))


def _room(mutant: Mutant) -> str:
    return "/".join(mutant.file.split("/")[:2])


def _copy(root: Path, copy: Path) -> Path:
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split("\0")
    for name in filter(None, listed):
        if (root / name).is_file():  # deleted ones are also listed
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, copy / name)
    for name in (".venv", ".cache"):  # installed and built by `make`
        if (root / name).exists():
            (copy / name).symlink_to((root / name).resolve())
    # By default bytecode is told to be stale by time and size, which mutants may share.
    checked = py_compile.PycInvalidationMode.CHECKED_HASH
    for package in filter(Path.is_dir, (copy / "gateway", copy / "gateway_sim", copy / "schemas")):
        compileall.compile_dir(package, quiet=1, invalidation_mode=checked)
    return copy


def _run(copy: Path, tests: Sequence[str]) -> str | None:
    """Run tests, and return the file of the one that failed, or all if they hang or crash.

    Raises:
        MutantError: pytest could not run them.
    """
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-p", "no:cacheprovider"]
    command += ["-m", "not long", f"--timeout={TEST_TIMEOUT_S}", *tests]
    # before the working tree, which is installed as an editable package
    environment = {**os.environ, "PYTHONPATH": str(copy)}
    with subprocess.Popen(
        command, cwd=copy, env=environment, text=True, errors="replace", start_new_session=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        try:
            output, _ = process.communicate(timeout=TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return " ".join(tests)
        finally:
            with contextlib.suppress(ProcessLookupError):  # with all that the tests started
                os.killpg(process.pid, signal.SIGKILL)
    if process.returncode in {0, 5}:  # passed, or all of them are long
        return None
    if process.returncode > 2:  # it could not run
        raise MutantError(f"pytest ended with {process.returncode}\n{output}")
    failed = _FAILED_TEST.search(output)
    return failed[1] if failed else " ".join(tests)


def main() -> int:
    """Run the command line. See `--help`."""
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description=__doc__)
    parser.add_argument("what", nargs="*", help="only files and functions with one of these words")
    parser.add_argument("--rule", action="append", default=[], choices=[*EVERYWHERE, *IN_SAFETY])
    parser.add_argument("--sample", type=int, default=0, help="try only so many, chosen at random")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at once")
    parser.add_argument("--list", action="store_true", help="print the mutants, run nothing")
    arguments = parser.parse_args()
    excused = waivers()
    mutants = [mutant for mutant in all_mutants() if mutant.name not in excused]
    chosen = select(mutants, arguments.what, arguments.rule, arguments.sample, arguments.seed)
    print(f"{len(chosen)} of {len(mutants)} mutants, {len(excused)} more are waived", flush=True)
    if arguments.list:
        print("\n".join(f"{mutant.rule}: {mutant.name}" for mutant in chosen))
        return 0
    try:
        is_good = verdict(run(chosen, arguments.jobs, report=partial(print, flush=True)))
    except MutantError as error:
        print(f"mutants: {error}", file=sys.stderr)
        return 2
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())

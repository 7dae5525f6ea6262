# SPDX-License-Identifier: Apache-2.0
"""Run the tests against each mutant, for `make mutants`."""

import argparse
import compileall
import contextlib
import os
import py_compile
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from enum import Enum
from functools import partial
from pathlib import Path
from typing import Final

from tools.mutants.mutant import ROOT, Mutant, MutantError, load, page

MIN_KILLED: Final = 0.92
# The slowest tests of one mutant take a minute. Beyond this they hang, and the mutant is noticed.
TIMEOUT_S: Final = 300
TEST_TIMEOUT_S: Final = 60

_PACKAGES: Final = ("gateway", "gateway_sim", "schemas")
# exit codes of pytest: tests passed, failed, or could not be imported
_PASSED, _FAILED, _INTERRUPTED = 0, 1, 2


class Fate(Enum):
    """The end of a mutant."""

    KILLED = "killed"
    TIMED_OUT = "timed out"  # counts as killed
    SURVIVED = "SURVIVED"


@dataclass(frozen=True, slots=True)
class Trial:
    """A mutant, what became of it, and in how many seconds."""

    mutant: Mutant
    fate: Fate
    took_s: float


class Copies:
    """Copies of the tree, each for one run of tests at a time. The tree itself is not touched."""

    def __init__(self, root: Path, folder: Path, count: int) -> None:
        self._free: queue.Queue[Path] = queue.Queue()
        for number in range(count):
            self._free.put(_copy(root, folder / str(number)))

    def run(self, tests: Sequence[str], mutant: Mutant | None = None) -> tuple[int | None, str]:
        """Run tests, with a line broken. Return pytest's exit code, None for a timeout, and text.

        Raises:
            MutantError: the mutant's line has changed.
        """
        copy = self._free.get()
        try:
            if mutant is None:
                return _pytest(copy, tests)
            path = copy / mutant.file
            whole = path.read_text()
            path.write_text(mutant.broken(copy))
            try:
                return _pytest(copy, tests)
            finally:
                path.write_text(whole)
        finally:
            self._free.put(copy)


def run(
    mutants: Sequence[Mutant],
    jobs: int,
    root: Path = ROOT,
    report: Callable[[str], None] = print,
) -> list[Trial]:
    """Try all mutants and return the trials in the list's order.

    Raises:
        MutantError: a line has changed, or tests fail without any mutant.
    """
    for mutant in mutants:
        mutant.broken(root)
    with (
        tempfile.TemporaryDirectory(prefix="mutants-") as folder,
        ThreadPoolExecutor(jobs) as pool,
    ):
        copies = Copies(root, Path(folder), jobs)
        paths = sorted({test.partition("::")[0] for mutant in mutants for test in mutant.tests})
        report(f"{len(mutants)} mutants, first their tests without any: {len(paths)} files")
        try:
            for checked in as_completed([pool.submit(_check, copies, path) for path in paths]):
                checked.result()
            tries = [pool.submit(_try, copies, mutant) for mutant in mutants]
            for done, tried in enumerate(as_completed(tries), start=1):
                outcome = tried.result()
                mutant, fate = outcome.mutant, outcome.fate.value
                progress = f"[{done:{len(str(len(mutants)))}}/{len(mutants)}] {fate:9}"
                report(f"{progress} {mutant.file}: {mutant.rule} ({outcome.took_s:.0f} s)")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [tried.result() for tried in tries]


def verdict(trials: Sequence[Trial], report: Callable[[str], None] = print) -> bool:
    """Report survivors and sum. Return whether enough are killed, and the rest explained."""
    survivors = [outcome.mutant for outcome in trials if outcome.fate is Fate.SURVIVED]
    for mutant in survivors:
        why = mutant.survives or "NO REASON GIVEN: write a test, or why none can tell"
        report(f"\n{mutant.file}: {mutant.rule}\n- {mutant.old}\n+ {mutant.new}\n  {why}")
    for outcome in trials:
        mutant = outcome.mutant
        if mutant.survives is not None and outcome.fate is not Fate.SURVIVED:
            report(f"\n{mutant.file}: {mutant.rule}\n  is listed as a survivor and was noticed")
    killed = len(trials) - len(survivors)
    share = killed / len(trials) if trials else 1.0
    report(
        f"\n{len(trials)} mutants, {killed} killed ({int(share * 100)} %), {len(survivors)} survive"
    )
    return share >= MIN_KILLED and all(mutant.survives is not None for mutant in survivors)


def _try(copies: Copies, mutant: Mutant) -> Trial:
    started_s = time.monotonic()
    code, output = copies.run(mutant.tests, mutant)
    match code:
        case None:
            fate = Fate.TIMED_OUT
        case int() if code == _PASSED:
            fate = Fate.SURVIVED
        case int() if code in {_FAILED, _INTERRUPTED} or code < 0:  # by a signal: it crashed
            fate = Fate.KILLED
        case _:
            raise MutantError(f"{mutant.file}: {mutant.rule}: pytest ended with {code}\n{output}")
    return Trial(mutant, fate, time.monotonic() - started_s)


def _check(copies: Copies, path: str) -> None:
    code, output = copies.run([path])
    if code != _PASSED:  # once more: a busy machine may be to blame
        code, output = copies.run([path])
    if code != _PASSED:
        raise MutantError(f"{path} fails without any mutant\n{output}")


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
    for package in filter(lambda package: (copy / package).exists(), _PACKAGES):
        # By default bytecode is told to be stale by time and size, which mutants may share.
        compileall.compile_dir(
            copy / package, quiet=1, invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH
        )
    return copy


def _pytest(copy: Path, tests: Sequence[str]) -> tuple[int | None, str]:
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    command += [f"--timeout={TEST_TIMEOUT_S}", *tests]
    # before the working tree, which is installed as an editable package
    environment = {**os.environ, "PYTHONPATH": str(copy)}
    with subprocess.Popen(
        command, cwd=copy, env=environment, text=True, errors="replace", start_new_session=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        try:
            output, _ = process.communicate(timeout=TIMEOUT_S)
        except subprocess.TimeoutExpired:
            output = None
        finally:
            with contextlib.suppress(ProcessLookupError):  # with all that the tests started
                os.killpg(process.pid, signal.SIGKILL)
    return (None, "") if output is None else (process.returncode, output)


def main() -> int:
    """Run the command line. See `--help`."""
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description=__doc__)
    parser.add_argument("what", nargs="*", help="only files or rules with one of these words")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at once")
    parser.add_argument(
        "--page", action="store_true", help="print the page of mutants, run nothing"
    )
    arguments = parser.parse_args()
    words = arguments.what
    try:
        mutants = load()
        if arguments.page:
            print(page(mutants, MIN_KILLED), end="")
            return 0
        if words:
            mutants = [m for m in mutants if any(word in f"{m.file}: {m.rule}" for word in words)]
        is_good = verdict(run(mutants, arguments.jobs, report=partial(print, flush=True)))
    except MutantError as error:
        print(f"mutants: {error}", file=sys.stderr)
        return 2
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())

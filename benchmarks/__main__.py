# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks [WHAT ...]``: what the gateway and the Unity client cost.

Every process is a real one. Figures are medians. CPU time is user and system time of a process and
its children. Read ratios: the times are those of one machine in one mood.
"""

import argparse
import os
import shlex
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks import figures
from benchmarks.catalogue import COMPARED, SCENARIOS
from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.servers import MeasuredServer, require_free

_FAILED = 1
_INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the scenarios that the command line names, and return the exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    unknown = [name for name in options.what if name not in SCENARIOS]
    if unknown:
        parser.error(f"unknown WHAT: {', '.join(unknown)} (there are: {', '.join(SCENARIOS)})")
    if (options.beside is None) != (options.beside_port is None):
        parser.error("--beside needs --beside-port, and the other way round: give both")
    if options.json is not None:  # now rather than after all measurements
        if not options.json.parent.is_dir():
            parser.error(f"--json {options.json}: there is no directory {options.json.parent}")
        if options.json.is_dir():
            parser.error(f"--json {options.json} is a directory")
    try:
        stored = None if options.compare is None else figures.read(options.compare)
        plan = _plan(options)
    except BenchmarkError as error:
        parser.error(str(error))
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # ends its processes
    try:
        return _run(options, plan, stored)
    except (BenchmarkError, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return _FAILED
    except KeyboardInterrupt:
        return _INTERRUPTED


def _run(options: argparse.Namespace, plan: Plan, stored: list[Figure] | None) -> int:
    names = options.what or (SCENARIOS if stored is None else COMPARED)
    measured: list[Figure] = []
    failed = False
    try:
        for name in dict.fromkeys(names):
            try:
                measured += _measure(name, plan)
            except BenchmarkError as error:
                print(f"{name}: {error}", file=sys.stderr)
                failed = True
    finally:  # also the figures so far, at Ctrl-C
        if options.json is not None and measured:
            figures.write(options.json, measured)
    if stored is None or failed:
        return _FAILED if failed else 0
    verdicts = figures.compare(stored, measured, lambda name: _measure(name, plan))
    if not verdicts:
        raise BenchmarkError(f"{options.compare} holds no ratio of what was measured")
    print(f"\nratios compared with {options.compare}, worse from {figures.TOLERANCE:.0%} on")
    print(figures.table(verdicts))
    return _FAILED if any(one.word == "WORSE" for one in verdicts) else 0


def _measure(name: str, plan: Plan) -> Sequence[Figure]:
    print(f"\nmeasuring {name} ...", flush=True)
    return SCENARIOS[name].measure(plan)


def _plan(options: argparse.Namespace) -> Plan:
    servers = [MeasuredServer()]
    if options.beside is not None:
        try:
            command = tuple(shlex.split(options.beside))
        except ValueError as error:
            raise BenchmarkError(f"--beside {options.beside}: {error}") from None
        if not command:
            raise BenchmarkError("--beside is empty: name a command")
        require_free(options.beside_port)
        servers.append(MeasuredServer("other", command, options.beside_port))
    brief = options.quick
    return Plan(
        rounds=options.rounds or (1 if brief else 3),
        seconds=options.seconds or (2.0 if brief else 6.0),
        servers=tuple(servers),
        seeks_highest_rates=not brief and options.compare is None,
    )


def _parser() -> argparse.ArgumentParser:
    width = max(map(len, SCENARIOS))
    kinds = "\n".join(
        f"  {name:{width}}  {one.takes:>5}  {one.about}" for name, one in SCENARIOS.items()
    )
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        epilog=f"values of WHAT, and about how long each takes (all of them by default):\n{kinds}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("what", nargs="*", metavar="WHAT", help="names of measurements, see below")
    add("--rounds", type=_positive(int), help="number of rounds, of which figures are medians (3)")
    add("--seconds", type=_positive(float), help="of each measurement (6)")
    add("--quick", action="store_true", help="1 round of 2 s, and no search for highest rates")
    add("--json", type=Path, metavar="FILE", help="also write the figures to this file")
    add(
        "--compare",
        metavar="REF",
        help="compare ratios with stored ones, a file or a name in benchmarks/reference, and exit"
        f" with 1 if any is worse. Measures {', '.join(COMPARED)} by default, and no highest rates",
    )
    add("--beside", metavar="COMMAND", help="another rosbridge server to measure in the same run")
    add("--beside-port", type=_positive(int), metavar="PORT", help="the port of that server")
    return parser


def _positive(kind: type[Any]) -> Any:
    def number(text: str) -> Any:
        value = kind(text)
        if not value > 0:
            raise argparse.ArgumentTypeError(f"{text}: need a number above 0")
        return value

    number.__name__ = "number"  # its name in argparse's errors
    return number


if __name__ == "__main__":
    sys.exit(main())

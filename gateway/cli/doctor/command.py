# SPDX-License-Identifier: Apache-2.0
"""The command itself: it runs the checks at the same time, each in bounded time, and shows them."""

import argparse
import json
import sys
import textwrap
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Final, TypeAlias

from gateway.cli.doctor.finding import Check, Finding, Result
from gateway.cli.report import EXIT_FAILURE, EXIT_OK
from gateway.errors import UsageError
from gateway.log_fields import counted

DEFAULT_TIMEOUT_S: Final = 20.0  # ROS takes 10 s to load on a busy computer
GRACE_S: Final = 1  # a check that knows the limit itself reports more than that it was reached
_COLUMNS: Final = 100
_INDENT: Final = 16

Checked: TypeAlias = Sequence[tuple[str, Sequence[Result]]]


def doctor(arguments: argparse.Namespace, environment: Mapping[str, str]) -> int:
    """Check this machine, or the gateway that ``--from`` names. Return 1 if there is an error.

    Raises:
        UsageError: this machine cannot be checked, or the gateway cannot be asked.
    """
    timeout_s = arguments.timeout or DEFAULT_TIMEOUT_S
    checked: Checked
    if arguments.source is None:
        if sys.platform == "win32":
            raise UsageError(
                "the checks of a computer need Linux: run doctor on the robot, or ask its gateway"
                " by --from ws://ROBOT:9090"
            )
        from gateway.cli.doctor.local_checks import local_checks

        checks = local_checks(arguments.config, environment, timeout_s)
        checked = run(checks, timeout_s + GRACE_S)
    else:
        from gateway.cli.doctor.remote_checks import remote_gateway, remote_results

        checked = remote_results(remote_gateway(arguments, environment))
    sys.stdout.write("".join(_in_json(checked) if arguments.json else _for_people(checked)))
    return EXIT_FAILURE if _count(checked, "error") else EXIT_OK


def run(checks: Mapping[str, Check], limit_s: float) -> Checked:
    """Run all checks at the same time, and wait for them until the limit."""
    results: dict[str, Sequence[Result]] = {}
    threads = [
        threading.Thread(target=_keep, args=(name, check, results), name=name, daemon=True)
        for name, check in checks.items()
    ]
    for thread in threads:
        thread.start()
    end_s = time.monotonic() + limit_s
    for thread in threads:
        thread.join(max(0.0, end_s - time.monotonic()))
    stuck = Finding(
        "error",
        f"this check did not end within {limit_s:g} s",
        "Something that it reads does not answer, or the computer is very busy",
        "Try again with a longer --timeout, and look at the load and the disks",
    )
    return [(name, results.get(name, [stuck])) for name in checks]


def _keep(name: str, check: Check, results: dict[str, Sequence[Result]]) -> None:
    try:
        results[name] = list(check())
    except Exception as error:  # noqa: BLE001  # one check must not end the others
        what = f"this check failed ({type(error).__name__}: {error})"
        why = "The check has a fault, or this system is unlike those that it knows"
        advice = "Report it in the repository of the gateway"
        results[name] = [Finding("error", what, why, advice)]


def _count(checked: Checked, level: str) -> int:
    results = [each for _, part in checked for each in part]
    return sum(isinstance(each, Finding) and each.level == level for each in results)


def _for_people(checked: Checked) -> Iterator[str]:
    for name, results in checked:
        for each in results:
            if isinstance(each, Finding):
                yield _wrapped(f"{name:<14}", f"{each.level.upper()}: {each.what}")
                yield _wrapped("", f"why: {each.why}")
                yield _wrapped("", f"do:  {each.advice}")
            else:
                yield _wrapped(f"{name:<14}", each.text)
    errors, warnings = _count(checked, "error"), _count(checked, "warning")
    if errors or warnings:
        yield f"found {counted(errors, 'error')} and {counted(warnings, 'warning')}\n"
    else:
        yield "found nothing wrong\n"


def _wrapped(label: str, text: str) -> str:
    start = f"{label:<{_INDENT}}"
    text = "".join(each if each.isprintable() else " " for each in text)  # a gateway may be foreign
    filled = textwrap.fill(
        *(text, _COLUMNS),
        initial_indent=start,
        subsequent_indent=" " * (_INDENT + 5),
        break_long_words=False,
        break_on_hyphens=False,
    )
    return f"{filled}\n"


def _in_json(checked: Checked) -> Iterator[str]:
    found = {
        "ok": not _count(checked, "error"),
        "findings": [
            {"check": name, **asdict(each)}
            for name, results in checked
            for each in results
            if isinstance(each, Finding)
        ],
        "notes": [
            {"check": name, **asdict(each)}
            for name, results in checked
            for each in results
            if not isinstance(each, Finding)
        ],
    }
    yield json.dumps(found, indent=2)
    yield "\n"

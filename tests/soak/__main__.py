# SPDX-License-Identifier: Apache-2.0
"""Soak the gateway: ``python -m tests.soak MINUTES [--lenient] [--write PAGE]``."""

import argparse
import asyncio
import os
import signal
import sys
from pathlib import Path

from tests import dds_domain
from tests.soak import isolation, report
from tests.soak.run import say, soak
from tests.soak.verdicts import judge

MINUTES = (1.0, 600.0)


def minutes(text: str) -> float:
    """Parse the length."""
    value = float(text)
    if not MINUTES[0] <= value <= MINUTES[1]:
        raise argparse.ArgumentTypeError(
            f"{value:g} minutes, need {MINUTES[0]:g} to {MINUTES[1]:g}"
        )
    return value


def main(arguments: list[str]) -> int:
    """Run it. Return 1 if something failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__)
    parser.add_argument("minutes", type=minutes, help="of the load")
    parser.add_argument("--lenient", action="store_true", help="for a machine that is busy")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="also write the result to this page"
    )
    options = parser.parse_args(arguments)
    if not isolation.is_isolated():
        reason = isolation.reason_against()
        if reason is None:
            isolation.enter(arguments)
        say(f"not in a separate network: {reason}")
        os.environ["ROS_DOMAIN_ID"] = str(dds_domain.claim())
    else:
        isolation.furnish()
    for variable in [name for name in os.environ if name.startswith("ROS2_GATEWAY_")]:
        del os.environ[variable]
    # no robot of the developer's may move
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    # a shell ignores it for what it starts in the background, and so would the actors
    signal.signal(signal.SIGINT, signal.default_int_handler)
    record = asyncio.run(soak(options.minutes))
    verdicts = judge(record, strict=not options.lenient)
    result = report.markdown(record, verdicts, strict=not options.lenient)
    sys.stdout.write(f"\n{result}\n")
    if options.write is not None:
        report.write(options.write, result)
    say(report.summary(verdicts))
    return int(any(one.failed for one in verdicts))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

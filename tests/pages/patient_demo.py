# SPDX-License-Identifier: Apache-2.0
"""``ros2-gateway demo`` with more time for commands and for its guard process.

Next to a browser that draws in software a busy machine holds each up for seconds, and a robot that
is rightly stopped for it arrives nowhere. The stops of a robot have their own tests.
"""

from typing import Any

from gateway.core.commands import commands
from gateway.drive import freshness
from gateway.drive.effects import Rules
from gateway.guard import supervisor
from tests.patient_gateway import main

PATIENT = ("--set", "control.lease_s=60")


def patient(**rules: Any) -> Rules:
    """Return rules with a deadline that is longer than may be configured."""
    return Rules(**rules | {"deadline_ns": 10 * 10**9})


if __name__ == "__main__":
    commands.Rules = patient  # type: ignore[misc]
    freshness.MAX_AGE_NS = 60 * 10**9  # type: ignore[misc]  # final everywhere else
    supervisor.MARGIN_S = 30  # type: ignore[misc]
    supervisor.UNANSWERED_S = 60  # type: ignore[misc]
    main()

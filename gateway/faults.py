# SPDX-License-Identifier: Apache-2.0
"""Faults of a running gateway, in words for its operator; see `gateway.server.health`."""

from dataclasses import dataclass
from typing import Literal

Severity = Literal["dead", "not ready", "degraded", "starting"]


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that is wrong. The text goes to whoever asks: no secrets, no names of topics.

    ``dead`` is what only another start will mend, ``not ready`` what keeps clients from being
    served for now, ``degraded`` what takes away a part, and ``starting`` what is over soon.
    """

    severity: Severity
    text: str

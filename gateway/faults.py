# SPDX-License-Identifier: Apache-2.0
"""Faults of a running gateway, in words for its operator. See `gateway.transport.health`."""

from dataclasses import dataclass
from typing import Literal

Severity = Literal["dead", "not ready", "degraded", "starting"]


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that is wrong. Everybody can read the text: no secrets, no names of topics.

    ``dead``: only a restart helps. ``not ready``: clients cannot be served now. ``degraded``: a
    part does not work. ``starting``: over soon.
    """

    severity: Severity
    text: str

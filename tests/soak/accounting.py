# SPDX-License-Identifier: Apache-2.0
"""The sums of /metrics: what came for a client is sent, replaced, dropped, or waits."""

import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Final

PREFIX: Final = "ros2_gateway_client_messages_"
WHERE_TO: Final = ("sent_total", "coalesced_total", "dropped_total", "pending")

_SERIES: Final = re.compile(r"^(\w+)\{(.*)\} (\S+)$", re.MULTILINE)
_LABEL: Final = re.compile(r'(\w+)="((?:[^"\\]|\\.)*)"')
_KEPT: Final = 20  # of the faults: the first ones say it

Series = tuple[str, str]
"""A client and a topic."""


@dataclass
class Accounting:
    """All sums that were checked."""

    pages: int = 0
    sums: int = 0
    faults: list[str] = field(default_factory=list)

    def check(self, page: str) -> None:
        """Check all sums of a page."""
        self.pages += 1
        families = samples(page)
        received = families.get(f"{PREFIX}received_total", {})
        if not received:
            return
        parts = [families.get(f"{PREFIX}{name}", {}) for name in WHERE_TO]
        for series, count in received.items():
            found = [part.get(series, 0.0) for part in parts]
            self.sums += 1
            if count != sum(found) and len(self.faults) < _KEPT:
                said = " + ".join(
                    f"{name} {value:.0f}" for name, value in zip(WHERE_TO, found, strict=True)
                )
                self.faults.append(f"{series}: received {count:.0f}, but {said}")


def samples(page: str) -> dict[str, dict[Series, float]]:
    """Return the values of all families that have a client and a topic."""
    families: dict[str, dict[Series, float]] = defaultdict(dict)
    for name, labels, value in _SERIES.findall(page):
        found = dict(_LABEL.findall(labels))
        if "client" in found and "topic" in found:
            families[name][found["client"], found["topic"]] = float(value)
    return families

# SPDX-License-Identifier: Apache-2.0
"""How late the machine was, whatever the gateway did."""

import asyncio
import os
from dataclasses import dataclass, field

from tests.soak.actor import Actor


@dataclass
class Machine:
    """The pauses of a process that only sleeps, and the load average, over the soak."""

    late: list[tuple[float, float]] = field(default_factory=list)
    """When a sleep ended, and by how much too late, in seconds."""
    loads: list[float] = field(default_factory=list)

    async def watch(self, control: Actor) -> None:
        """Take what the control has noticed, forever."""
        while True:
            self.late += [(at_s, by_s) for at_s, by_s in await control.ask("late")]
            self.loads.append(os.getloadavg()[0])
            await asyncio.sleep(1)

    def worst_s(self, since_s: float, until_s: float) -> float:
        """Return by how much the latest sleep was late that overlaps a time."""
        return max(
            (by_s for at_s, by_s in self.late if at_s >= since_s and at_s - by_s <= until_s),
            default=0.0,
        )

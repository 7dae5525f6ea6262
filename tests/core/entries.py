# SPDX-License-Identifier: Apache-2.0
"""An outbox entry that is ready, and known by its number."""

from dataclasses import dataclass


@dataclass
class Item:
    """The entry."""

    number: int
    size: int = 1
    is_being_encoded: bool = False
    arrived_ns: int = 0

    def frame(self) -> bytes:
        """Return the number."""
        return b"%d" % self.number

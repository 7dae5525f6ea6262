# SPDX-License-Identifier: Apache-2.0
"""Counts of what comes from another gateway about driving, a relay or a robot, and is left out."""

from dataclasses import dataclass

from gateway.metrics.state import Relayed


@dataclass(slots=True)
class RelayedCounts:
    """They begin with the process, and go on when a connection is lost."""

    malformed: int = 0  # messages that no gateway sends
    tokens_refused: int = 0  # of clients that are too many
    dropped: int = 0  # messages that found no room

    def note_malformed(self) -> None:
        """Count a message that cannot be read."""
        self.malformed += 1

    def refuse_token(self) -> None:
        """Count a client that is one too many."""
        self.tokens_refused += 1

    def drop(self) -> None:
        """Count a message that finds no room."""
        self.dropped += 1

    def read(self) -> Relayed:
        """Return the counts of now."""
        return Relayed(self.malformed, self.tokens_refused, self.dropped)

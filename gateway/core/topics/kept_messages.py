# SPDX-License-Identifier: Apache-2.0
"""Large messages that were encoded and are kept: the next late subscriber gets the same bytes."""

from collections import OrderedDict
from typing import Final

from gateway.codec.chunks import Chunks
from gateway.sources.source import Origin

# Of all topics: two maps of 4000 x 4000 cells in JSON, or one of a cell for each 5 cm of 300 m.
MAX_KEPT_BYTES: Final = 128 * 1024**2


class KeptMessages:
    """The newest large message of each encoding, within one budget. The oldest goes first."""

    def __init__(self) -> None:
        self._kept: OrderedDict[object, tuple[Origin, Chunks]] = OrderedDict()
        self._size = 0

    @property
    def size(self) -> int:
        """The bytes that are kept."""
        return self._size

    def keep(self, encoding: object, origin: Origin, message: Chunks) -> None:
        """Keep a message in place of the one that this encoding had."""
        self.forget(encoding)
        if len(message) > MAX_KEPT_BYTES or not origin[0]:
            return  # it would be alone. Or nothing marks its sample
        self._kept[encoding] = origin, message
        self._size += len(message)
        while self._size > MAX_KEPT_BYTES:
            self.forget(next(iter(self._kept)))

    def find(self, encoding: object, origin: Origin) -> Chunks | None:
        """Return the message of a sample, if it is kept in this encoding."""
        known, message = self._kept.get(encoding, (None, None))
        return message if known == origin else None

    def forget(self, encoding: object) -> None:
        """Keep nothing of this encoding."""
        _, message = self._kept.pop(encoding, (None, None))
        if message is not None:
            self._size -= len(message)

# SPDX-License-Identifier: Apache-2.0
"""The ids of a client's advertisements of one topic."""

from typing import Final

# Some programs advertise again, by a new id, for each message. 0.3 MB at most.
MAX_IDS: Final = 1024


class AdvertisementIds:
    """The newest ids. The topic stays advertised until the client has withdrawn these."""

    __slots__ = ("_ids",)

    def __init__(self) -> None:
        self._ids: dict[str | int | None, None] = {}  # the oldest first

    def __contains__(self, request_id: str | int | None) -> bool:
        """Return whether an id is remembered."""
        return request_id in self._ids

    def __len__(self) -> int:
        """Count them."""
        return len(self._ids)

    def add(self, request_id: str | int | None) -> None:
        """Remember an id. Forget the oldest one if there are too many."""
        self._ids[request_id] = None
        if len(self._ids) > MAX_IDS:
            del self._ids[next(iter(self._ids))]

    def discard(self, request_id: str | int | None) -> None:
        """Forget an id."""
        self._ids.pop(request_id, None)

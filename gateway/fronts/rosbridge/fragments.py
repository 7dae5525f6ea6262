# SPDX-License-Identifier: Apache-2.0
"""Messages in pieces: split for clients that ask for it, and put together again.

These are rosbridge's `fragment` operations, not the fragmentation of WebSocket.
"""

from dataclasses import dataclass, field
from typing import Final

import orjson

from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.operations.fragment import Fragment

MAX_INCOMPLETE: Final = 4  # a client sends one after the other, together as large as one message
MAX_REFUSED: Final = 4  # as many as can fail at once. The numbers of their pieces are 1 MB at worst
MAX_PIECES: Final = 4096  # 10 MiB in pieces of 2.5 kB
MAX_AGE_NS: Final = 60 * 1_000_000_000  # by then even a weak WiFi has passed 10 MiB


def split(text: bytes, size: int, fragment_id: str) -> list[bytes]:
    """Split a JSON text of more than *size* characters into `fragment` messages of that many.

    A shorter text is returned as it is. Of one connection's messages no two that may be incomplete
    at the same time may have the same *fragment_id*. It must not be empty, for roslib.
    """
    # a character has a byte at least, so mostly there is no need to count
    if len(text) <= size or len(characters := text.decode()) <= size:
        return [text]
    total = -(-len(characters) // size)
    return [
        orjson.dumps(
            {
                "op": "fragment",
                "id": fragment_id,
                "data": characters[num * size : (num + 1) * size],
                "num": num,
                "total": total,
            }
        )
        for num in range(total)
    ]


@dataclass(slots=True)
class _Incomplete:
    total: int
    begun_ns: int
    size: int = 0  # bytes of UTF-8
    pieces: dict[int, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Refused:
    total: int
    missing: set[int]
    since_ns: int


class Assembly:
    """The incomplete messages of one client.

    When a message is refused, more pieces of it may be under way. They are ignored, or they would
    begin a message that never ends.
    """

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._incomplete: dict[str | int, _Incomplete] = {}
        self._refused: dict[str | int, _Refused] = {}  # oldest first

    def __len__(self) -> int:
        """Count them."""
        return len(self._incomplete)

    def add(self, fragment: Fragment, now_ns: int) -> bytes | None:
        """Take one piece, in any order. Return the whole message with the last one.

        A piece that is there already is ignored.

        Raises:
            ProtocolError: it contradicts the others, or a limit is exceeded. The message is
                refused if it is too large or one too many, else only the piece.
        """
        if self._is_of_refused(fragment, now_ns):
            return None
        message = self._message(fragment, now_ns)
        known = message.pieces.get(fragment.num)
        if known is not None:
            if known != fragment.data:
                text = f"num: piece {fragment.num} has come before with other data"
                raise ProtocolError("bad_request", text)
            return None
        message.pieces[fragment.num] = fragment.data
        message.size += len(fragment.data.encode())
        size = sum(each.size for each in self._incomplete.values())
        if size > self._max_bytes:
            self._refuse(fragment.id, message, now_ns)
            raise ProtocolError(
                "limit_exceeded",
                f"data: {size} bytes so far, at most {self._max_bytes} allowed in all"
                " (limits.max_message_bytes): send less at once",
            )
        if len(message.pieces) < message.total:
            return None
        del self._incomplete[fragment.id]
        return "".join(message.pieces[num] for num in range(message.total)).encode()

    def expire(self, now_ns: int) -> list[tuple[str | int, str]]:
        """Forget messages that take too long. Return their ids, and the progress of each."""
        limit_s = MAX_AGE_NS // 10**9
        expired = [
            (known, f"{len(message.pieces)} of {message.total} pieces came within {limit_s} s")
            for known, message in self._incomplete.items()
            if now_ns - message.begun_ns > MAX_AGE_NS
        ]
        for known, _ in expired:
            self._refuse(known, self._incomplete[known], now_ns)
        return expired

    def _message(self, fragment: Fragment, now_ns: int) -> _Incomplete:
        message = self._incomplete.get(fragment.id)
        total = fragment.total if message is None else message.total
        if fragment.total != total:
            raise ProtocolError("bad_request", f"total: {fragment.total}, but {total} before")
        if fragment.num >= total:
            raise ProtocolError("bad_request", f"num: {fragment.num}, expected less than {total}")
        if message is not None:
            return message
        if total > MAX_PIECES:
            raise ProtocolError("limit_exceeded", f"total: {total}, at most {MAX_PIECES} allowed")
        if len(self._incomplete) >= MAX_INCOMPLETE:
            one_too_many = _Incomplete(total, now_ns, pieces={fragment.num: fragment.data})
            self._refuse(fragment.id, one_too_many, now_ns)
            text = f"at most {MAX_INCOMPLETE} incomplete messages per client"
            raise ProtocolError("limit_exceeded", text)
        message = self._incomplete[fragment.id] = _Incomplete(total, now_ns)
        return message

    def _refuse(self, fragment_id: str | int, message: _Incomplete, now_ns: int) -> None:
        """Forget a message, except for the numbers that are needed to ignore the rest of it."""
        self._incomplete.pop(fragment_id, None)
        missing = set(range(message.total)) - message.pieces.keys()
        if not missing:
            return
        if len(self._refused) >= MAX_REFUSED:
            del self._refused[next(iter(self._refused))]
        self._refused[fragment_id] = _Refused(message.total, missing, now_ns)

    def _is_of_refused(self, fragment: Fragment, now_ns: int) -> bool:
        """Return whether a piece belongs to a refused message, and note that it has come."""
        refused = self._refused.get(fragment.id)
        if refused is None:
            return False
        is_old = now_ns - refused.since_ns > MAX_AGE_NS
        if is_old or fragment.total != refused.total or fragment.num not in refused.missing:
            del self._refused[fragment.id]  # it is another message, or another attempt
            return False
        refused.missing.remove(fragment.num)
        if not refused.missing:
            del self._refused[fragment.id]
        return True

# SPDX-License-Identifier: Apache-2.0
"""Reasons why a transform is not known, as exceptions that say what is known instead."""

import heapq
from collections.abc import Collection, Sequence
from typing import Final

from gateway.codec.error_text import MAX_ECHO, did_you_mean, truncate

# difflib takes up to 0.1 ms for two names of links that differ in a number, and a robot may have
# hundreds: so compare only names that begin and end like the unknown one.
_MAX_COMPARED: Final = 8


class TransformError(Exception):
    """No transform is known between the two frames."""


class UnknownFrameError(TransformError):
    """No transform names the frame. *known* are the frames that transforms name."""

    def __init__(self, frame: str, known: Collection[str]) -> None:
        super().__init__(frame)
        self.frame = frame
        self.known = known

    def __str__(self) -> str:
        # only when it is read: a client that waits for a frame meets this error again and again
        asked = self.frame[:MAX_ECHO]
        alike = heapq.nlargest(
            _MAX_COMPARED, sorted(self.known), key=lambda name: _ends_alike(asked, name)
        )
        return f"frame {self.frame!r} is unknown{did_you_mean(asked, alike)}"


class NotConnectedError(TransformError):
    """No common ancestor. *target* and *source* are the frames with all their ancestors."""

    def __init__(self, target: Sequence[str], source: Sequence[str]) -> None:
        super().__init__(f"frames are not connected: {_tree(target)}, {_tree(source)}")


class LoopError(TransformError):
    """No common ancestor, and one frame is its own ancestor. *frames* lead from it to itself."""

    def __init__(self, frames: Sequence[str]) -> None:
        super().__init__(f"frames are in a loop: {' in '.join(frames)}")


class ExtrapolationError(TransformError):
    """The requested time is before the oldest or after the newest sample of a frame.

    ``is_early`` means before the oldest: no later sample will help.
    """

    def __init__(
        self, frame: str, parent: str, stamp_ns: int, *, oldest_ns: int, newest_ns: int
    ) -> None:
        self.is_early = stamp_ns < oldest_ns
        if self.is_early:
            gap = f"oldest is {(oldest_ns - stamp_ns) / 1e9:.3g} s newer"
        else:
            gap = f"newest is {(stamp_ns - newest_ns) / 1e9:.3g} s older"
        super().__init__(f"{frame} in {parent}: {gap} than asked")


class InvalidTransformError(ValueError):
    """An inserted transform is invalid, or of one frame too many.

    ``fault`` is one of a few texts that fit any frame, so that a caller can report each once.
    """

    def __init__(self, frame: str, fault: str) -> None:
        super().__init__(f"frame {truncate(frame)!r}: {fault}")
        self.frame = frame
        self.fault = fault


def _ends_alike(one: str, other: str) -> int:
    """Return the number of characters that two names share at both ends."""
    return _begins_alike(one, other) + _begins_alike(one[::-1], other[::-1])


def _begins_alike(one: str, other: str) -> int:
    pairs = enumerate(zip(one, other, strict=False))
    return next((at for at, (a, b) in pairs if a != b), min(len(one), len(other)))


def _tree(chain: Sequence[str]) -> str:
    return chain[0] if len(chain) == 1 else f"{chain[-1]} .. {chain[0]}"

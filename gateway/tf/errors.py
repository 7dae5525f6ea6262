# SPDX-License-Identifier: Apache-2.0
"""Why a transform is not known, as exceptions that say what is known instead."""

import difflib
from collections.abc import Collection, Sequence


class TransformError(Exception):
    """Where a frame is in another is not known."""


class UnknownFrameError(TransformError):
    """No transform names the frame; *known* are those that some transform names."""

    def __init__(self, frame: str, known: Collection[str]) -> None:
        super().__init__(frame)
        self.frame = frame
        self.known = known

    def __str__(self) -> str:
        # only where it is read: who waits for a frame meets this error again and again
        near = difflib.get_close_matches(self.frame, sorted(self.known), n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        return f"frame {self.frame!r} is unknown{hint}"


class NotConnectedError(TransformError):
    """No frame is above both; *target* and *source* are the frames with all above them."""

    def __init__(self, target: Sequence[str], source: Sequence[str]) -> None:
        super().__init__(f"frames are not connected: {_tree(target)}, {_tree(source)}")


class LoopError(TransformError):
    """A frame is above itself; *frames* lead from it to itself."""

    def __init__(self, frames: Sequence[str]) -> None:
        super().__init__(f"frames are in a loop: {' in '.join(frames)}")


class ExtrapolationError(TransformError):
    """The time asked for is before the oldest or after the newest sample of a frame.

    ``is_early`` says that it is before: no sample to come will help.
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
    """What was to be inserted is no transform, or one too many."""


def _tree(chain: Sequence[str]) -> str:
    return chain[0] if len(chain) == 1 else f"{chain[-1]} .. {chain[0]}"

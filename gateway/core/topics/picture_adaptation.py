# SPDX-License-Identifier: Apache-2.0
"""Pictures that fit the link: how much smaller than asked for one client's are to be."""

from itertools import compress
from typing import Final, NamedTuple


class Step(NamedTuple):
    """One of the sizes that a picture is sent in.

    They are few, so that clients on links of a like rate share their pictures.
    """

    quality: int  # at most
    reduction: int  # one pixel stands for so many in each direction
    part: float  # of the bytes of the picture as asked for, about. Measured with VGA at quality 80


STEPS: Final = (
    Step(100, 1, 1.0),
    Step(65, 1, 0.67),
    Step(50, 1, 0.50),
    Step(65, 2, 0.23),
    Step(40, 2, 0.16),
    Step(60, 4, 0.09),
    Step(30, 4, 0.06),
    Step(30, 8, 0.03),
)

# A frame cannot be overtaken once it is on its way: for so long a picture may hold up the rest.
MAX_HOLD_S: Final = 0.08
# A larger picture is tried when it would fit with some room, and the smaller one has for a while.
# Else pictures would change all the time.
ROOM: Final = 0.75
LARGER_AFTER_NS: Final = 2_000_000_000


# By how much what is learned about a step may differ from the table: one scene may have changed
# for another between the two pictures that are compared.
_MOST_OFF: Final = 4.0


class PictureAdaptation:
    """The step of one subscription, by the frames that it sends and the rate of its link.

    If a client has set a quality, steps are larger or smaller than in the table. So the effect of a
    step on the size is learned, or the steps would go up and down forever.
    """

    __slots__ = ("_before", "_fits_since_ns", "_outdated", "_parts", "step")

    def __init__(self) -> None:
        self.step = STEPS[0]
        self._parts = [step.part for step in STEPS]
        self._before: float | None = None  # bytes of the whole picture, before the last change
        self._fits_since_ns: int | None = None  # the next larger picture would have fitted
        self._outdated = 0  # frames of the step before, still to be sent

    def sent(self, size: int, bytes_per_s: float | None, now_ns: int) -> bool:
        """Take note of a frame that is sent. Return whether the next ones need another step.

        *bytes_per_s* is ``None`` for a link that never was too slow.
        """
        if self._outdated:
            self._outdated -= 1
            return False
        at = STEPS.index(self.step)
        parts = self._parts
        if self._before is not None:
            least, most = STEPS[at].part / _MOST_OFF, STEPS[at].part * _MOST_OFF
            parts[at] = min(max(size / self._before, least), most)
            self._before = None
        whole = size / parts[at]
        fitting = whole if bytes_per_s is None else bytes_per_s * MAX_HOLD_S
        if size > fitting:
            self._fits_since_ns = None
            fits = (whole * part <= fitting for part in parts[at + 1 :])
            self.step = next(compress(STEPS[at + 1 :], fits), STEPS[-1])
        elif at and whole * parts[at - 1] <= fitting * ROOM:
            if self._fits_since_ns is None:
                self._fits_since_ns = now_ns
            elif now_ns - self._fits_since_ns >= LARGER_AFTER_NS:
                self._fits_since_ns = None
                self.step = STEPS[at - 1]
        else:
            self._fits_since_ns = None
        if self.step is STEPS[at]:
            return False
        self._before = whole
        return True

    def stepped(self, outdated: int) -> None:
        """Take note that the step is applied, while frames of the one before still wait."""
        self._outdated = outdated

# SPDX-License-Identifier: Apache-2.0
"""Pictures that fit the link: how much smaller than asked for one client's are to be."""

from typing import Final, NamedTuple


class Step(NamedTuple):
    """One of the sizes that a picture is sent in.

    They are few, so that clients on links of a like rate share their pictures.
    """

    quality: int  # at most
    reduction: int  # one pixel stands for so many in each direction
    part: float  # of the bytes of the picture as asked for, about; measured with VGA at quality 80


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
# A larger picture is tried when it would fit with some room, and the smaller one has for a while;
# else pictures would change all the time.
ROOM: Final = 0.75
PATIENCE_NS: Final = 2_000_000_000


class PictureAdaptation:
    """The step of one subscription, by the frames that it sends and the rate of its link."""

    __slots__ = ("_fits_since_ns", "_outdated", "step")

    def __init__(self) -> None:
        self.step = STEPS[0]
        self._fits_since_ns: int | None = None  # the next larger picture would have fitted
        self._outdated = 0  # frames of the step before, still to be sent

    def sent(self, size: int, bytes_per_s: float | None, now_ns: int) -> bool:
        """Take note of a frame that is sent; return whether the next ones need another step.

        *bytes_per_s* is ``None`` for a link that never was too slow.
        """
        if self._outdated:
            self._outdated -= 1
            return False
        whole = size / self.step.part
        fitting = whole if bytes_per_s is None else bytes_per_s * MAX_HOLD_S
        at = STEPS.index(self.step)
        if size > fitting:
            self._fits_since_ns = None
            self.step = next((step for step in STEPS if whole * step.part <= fitting), STEPS[-1])
        elif at and whole * STEPS[at - 1].part <= fitting * ROOM:
            if self._fits_since_ns is None:
                self._fits_since_ns = now_ns
            elif now_ns - self._fits_since_ns >= PATIENCE_NS:
                self._fits_since_ns = None
                self.step = STEPS[at - 1]
        else:
            self._fits_since_ns = None
        return self.step is not STEPS[at]

    def stepped(self, outdated: int) -> None:
        """Take note that the step is applied, while frames of the one before still wait."""
        self._outdated = outdated

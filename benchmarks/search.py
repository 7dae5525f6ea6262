# SPDX-License-Identifier: Apache-2.0
"""The search for the highest rate that is held."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final

_PRECISION: Final = 1.1  # between the highest rate held and the lowest that is not
_STEP_DOWN: Final = 0.9  # if a confirmation fails
_LEAST_SHARE: Final = 1 / 64  # of the start rate: below, nothing works at all


class Outcome(Enum):
    """The outcome of a run at some rate."""

    HELD = auto()
    LOST = auto()
    """Samples did not arrive, or late."""
    NOT_SENT = auto()
    """The sender could not keep the rate: nothing is known about the receiver."""


@dataclass(frozen=True)
class Highest:
    """The highest rate held, or 0."""

    rate_hz: float
    is_senders_limit: bool
    """The receiver might hold more."""

    def __str__(self) -> str:
        return f"{'>= ' if self.is_senders_limit else ''}{self.rate_hz:.0f}"


def highest_rate(
    hold: Callable[[float], Outcome], confirm: Callable[[float], Outcome], start_hz: float
) -> Highest:
    """Double from *start_hz* until *hold* fails, bisect to 10 %, and step down to what *confirm*s.

    *hold* may repeat a run that failed by chance, as the search never takes back a step.
    """
    held_hz, failed_hz, failure = _bracket(hold, start_hz)
    if not held_hz:
        return Highest(0.0, failure is Outcome.NOT_SENT)
    while failed_hz / held_hz > _PRECISION:
        rate_hz = math.sqrt(held_hz * failed_hz)
        outcome = hold(rate_hz)
        if outcome is Outcome.HELD:
            held_hz = rate_hz
        else:
            failed_hz, failure = rate_hz, outcome
    while (outcome := confirm(held_hz)) is not Outcome.HELD:
        failure = outcome
        held_hz *= _STEP_DOWN
        if held_hz < start_hz * _LEAST_SHARE:
            return Highest(0.0, failure is Outcome.NOT_SENT)
    return Highest(held_hz, failure is Outcome.NOT_SENT)


def _bracket(hold: Callable[[float], Outcome], start_hz: float) -> tuple[float, float, Outcome]:
    """Return a rate that is held, or 0, one above it that is not, and the reason."""
    rate_hz = start_hz
    outcome = hold(rate_hz)
    if outcome is Outcome.HELD:
        while outcome is Outcome.HELD:
            rate_hz *= 2
            outcome = hold(rate_hz)
        return rate_hz / 2, rate_hz, outcome
    while rate_hz >= start_hz * _LEAST_SHARE:
        failure = outcome
        rate_hz /= 2
        outcome = hold(rate_hz)
        if outcome is Outcome.HELD:
            return rate_hz, rate_hz * 2, failure
    return 0.0, rate_hz, outcome

# SPDX-License-Identifier: Apache-2.0
"""The errors of encoders, and the types that numbers may have."""

from collections.abc import Sequence
from struct import error as StructError  # noqa: N812
from typing import Final

from schemas.json_forms import NON_FINITE

NUMBERS: Final = frozenset({float, int})
INTEGERS: Final = frozenset({int})
LENIENT_NUMBERS: Final = NUMBERS | {type(None), str}
LENIENT_INTEGERS: Final = INTEGERS | {float}
BOOLS: Final = frozenset({bool})


class MisfitError(ValueError):
    """A value does not fit its field."""


class LenientError(MisfitError):
    """One of the numbers has another form, which the lenient encoder may know."""


# Misfits that struct, str.encode and the like find. Their texts are not for clients.
MISFITS: Final = (StructError, AttributeError, TypeError, ValueError, OverflowError)


def misfit(values: Sequence[object], lenient: frozenset[type]) -> MisfitError:
    """Return the error for numbers of which one has not the type that it should have."""
    types = set(map(type, values))
    if not types <= lenient:
        return MisfitError()
    if str not in types:
        return LenientError()
    # few are different: those of a client that sends nothing else take less time at once
    has_numbers = not types.isdisjoint(NUMBERS)
    names = {each for each in values if type(each) is str} if has_numbers else set(values)
    return LenientError() if names <= NON_FINITE.keys() else MisfitError()

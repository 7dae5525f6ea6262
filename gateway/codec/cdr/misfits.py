# SPDX-License-Identifier: Apache-2.0
"""The errors of encoders, the types that numbers may have, and the bounds of one message.

The bounds hold however short a message of a client is as JSON.
"""

from collections.abc import Mapping, Sequence
from struct import error as StructError  # noqa: N812
from typing import Final, NoReturn

from gateway.codec.cdr.layout import Elements, Member, Numbers, Text
from gateway.codec.error_text import CodecError
from schemas.json_forms import NON_FINITE

# 20,000 points. Fields that a client leaves out also take time and count. See `count_fields`.
MAX_FIELDS: Final = 60_000
MAX_CDR_BYTES: Final = 16 * 1024**2  # only what is left out makes CDR longer than its JSON

_FIELDS: Final[Mapping[type[Member], int]] = {Text: 3, Numbers: 8, Elements: 8}

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


class TooManyFieldsError(CodecError):
    """A message is small as JSON and large as CDR."""


def count_fields(members: Sequence[Member]) -> int:
    """Return the number of fields for which an element counts that says any of them.

    The time that one takes is the unit: that of a string is three times, of an empty array eight
    times that of a number (measured).
    """
    fixed = sum(each.length or 0 for each in members if isinstance(each, Elements))
    return fixed + sum(_FIELDS.get(type(member), 1) for member in members)


def refuse_size() -> NoReturn:
    """Raise `TooManyFieldsError`."""
    raise TooManyFieldsError(
        f"over {MAX_FIELDS} values or {MAX_CDR_BYTES} bytes, counted with the fields that are left"
        " out; send fewer elements at once"
    )

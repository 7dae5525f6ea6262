# SPDX-License-Identifier: Apache-2.0
"""The bounds on what one message of a client takes, however short it is as JSON."""

from collections.abc import Mapping, Sequence
from typing import Final, NoReturn

from gateway.codec.cdr.layout import Elements, Member, Numbers, Text
from gateway.codec.errors import CodecError

# 20,000 points. Fields that a client leaves out also take time and count. See `count_fields`.
MAX_FIELDS: Final = 60_000
MAX_CDR_BYTES: Final = 16 * 1024**2  # only what is left out makes CDR longer than its JSON

_FIELDS: Final[Mapping[type[Member], int]] = {Text: 3, Numbers: 8, Elements: 8}


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

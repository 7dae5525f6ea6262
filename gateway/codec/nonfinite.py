# SPDX-License-Identifier: Apache-2.0
"""NaN and infinities in JSON to clients: as null, which loses which one it was, or by name."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final, Literal, TypeAlias

import numpy as np
import orjson

from gateway.codec.json import dumps

NonFinite: TypeAlias = Literal["null", "string", "token"]
"""The form that a client asks for. A token is not JSON, but Python's ``json`` reads it."""

# the bytes of NaN, of infinity and of minus infinity
_NAMES: Final[Mapping[NonFinite, tuple[bytes, bytes, bytes]]] = {
    "string": (b'"NaN"', b'"Infinity"', b'"-Infinity"'),
    "token": (b"NaN", b"Infinity", b"-Infinity"),
}


def writer(form: NonFinite) -> Callable[[object], bytes]:
    """Return a function that writes decoded values as JSON, non-finite numbers in this form."""
    if form == "null":
        return dumps

    def write(value: object) -> bytes:
        text = dumps(value)
        # Messages have no other null, and nearly all have none: those are written once.
        return dumps(named(value, form)) if b"null" in text else text

    return write


def named(value: object, form: NonFinite) -> object:
    """Return decoded values for `gateway.codec.json.dumps`, non-finite numbers in this form."""
    return value if form == "null" else _named(value, _NAMES[form])


def _named(value: object, names: tuple[bytes, bytes, bytes]) -> object:
    if isinstance(value, dict):
        return {name: _named(item, names) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_named(item, names) for item in value]
    if isinstance(value, np.ndarray):
        return _named_array(value, names) if value.dtype.kind == "f" else value
    if not isinstance(value, (float, np.float32)) or math.isfinite(value):
        return value
    return orjson.Fragment(names[0 if math.isnan(value) else 1 if value > 0 else 2])


def _named_array(values: "np.ndarray[Any, Any]", names: tuple[bytes, bytes, bytes]) -> object:
    """Return the JSON of an array: that of orjson, with the names in the places of its nulls."""
    odd = values[~np.isfinite(values)]
    if not odd.size:
        return values
    kinds = np.where(np.isnan(odd), 0, np.where(np.signbit(odd), 2, 1))
    pieces: list[bytes] = [b""] * (2 * odd.size + 1)
    pieces[::2] = dumps(values).split(b"null")
    pieces[1::2] = [names[kind] for kind in kinds.tolist()]
    return orjson.Fragment(b"".join(pieces))

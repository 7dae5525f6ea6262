# SPDX-License-Identifier: Apache-2.0
"""Long arrays of numbers, which numpy has read, as the numbers of a field."""

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from gateway.codec.cdr.layout import CODES
from gateway.codec.cdr.misfits import MAX_CDR_BYTES, refuse_size
from schemas.definition import FLOAT32_OVERFLOW, FLOATS, INTEGER_RANGES
from schemas.json_forms import MAX_WHOLE, NumberArray, octets

Array = npt.NDArray[Any]

_INT8: Final = "int8"  # also one byte: base64 and bytes are read as such


def packed(value: object, base: str) -> memoryview:
    """Return the numbers of a field with elements of type *base*, as they are in CDR.

    Raises:
        TypeError: it is neither a `NumberArray` nor, for int8, base64 or bytes.
        ValueError: a number does not fit, or the base64 is broken.
        TooManyFieldsError: it is too large.
    """
    if base == _INT8 and isinstance(value, str | bytes):
        return memoryview(octets(value)).cast("b")
    if not isinstance(value, NumberArray):
        raise TypeError(base)
    values = value.values
    dtype = np.dtype("<" + CODES[base])
    if values.size * dtype.itemsize > MAX_CDR_BYTES:
        refuse_size()
    if base == "float32" and values.dtype.kind == "f":
        with np.errstate(over="ignore"):
            numbers = values.astype(dtype)
        is_suspicious = bool(np.isinf(numbers).any())
    else:  # a float64 between, as for numbers one by one: rounded twice
        numbers = values.astype(np.float64).astype(dtype) if base in FLOATS else values
        is_suspicious = True
    if is_suspicious and first_misfit(values, base) is not None:
        raise ValueError(base)
    return numbers.astype(dtype, copy=False).data


def listed(value: object, base: str) -> list[Any]:
    """Return them as a list. It raises as `packed` does."""
    return packed(value, base).tolist()


def first_misfit(values: Array, base: str) -> int | None:
    """Return the index of the first number that does not fit a type."""
    if (values.dtype.kind == "b") != (base == "bool"):
        return 0 if values.size else None
    misfits = np.flatnonzero(~_fits(values, base))
    return int(misfits[0]) if misfits.size else None


def _fits(values: Array, base: str) -> npt.NDArray[np.bool_]:
    is_float = values.dtype.kind == "f"
    if base == "float32" and is_float:
        in_range: npt.NDArray[np.bool_] = np.abs(values) < FLOAT32_OVERFLOW
        return in_range | ~np.isfinite(values)
    if base not in INTEGER_RANGES:
        return np.ones(len(values), np.bool_)
    low, high = INTEGER_RANGES[base]
    fits: npt.NDArray[np.bool_] = (values >= low) & (values <= high)
    if is_float:  # one beyond stands for several integers
        fits &= (np.trunc(values) == values) & (np.abs(values) < MAX_WHOLE)
    return fits

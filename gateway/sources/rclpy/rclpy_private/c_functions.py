# SPDX-License-Identifier: Apache-2.0
"""Functions of C, found by their names."""

import ctypes
from collections.abc import Callable
from typing import Any


class MissingFunctionError(Exception):
    """Raised when librcl or libc is not there or lacks a function."""


def rcl_function(name: str, result: type, *, argument_count: int) -> Callable[..., Any]:
    """Find a function of rcl whose arguments are addresses.

    Raises:
        MissingFunctionError: rcl lacks it.
    """
    return c_function("librcl.so", name, result, argument_count)


def c_function(
    library: str, name: str, result: type | None, argument_count: int = 0
) -> Callable[..., Any]:
    """Find a function of a library whose arguments are addresses.

    Raises:
        MissingFunctionError: the library lacks it, or is not there.
    """
    try:
        function = getattr(ctypes.CDLL(library), name)
    except (OSError, AttributeError) as error:
        raise MissingFunctionError(str(error)) from error
    function.argtypes = [ctypes.c_void_p] * argument_count
    function.restype = result
    return function  # type: ignore[no-any-return]  # of ctypes

# SPDX-License-Identifier: Apache-2.0
"""Bytes in and out of an ``eprosima::fastcdr::Cdr``, by which rmw has messages written and read.

Of the functions that are called only the one that writes throws, if a Cdr has no room.
"""

import ctypes
from collections.abc import Callable
from typing import Any, Final

from gateway.sources.source import RosError

# depends on libfastcdr, whose functions are found through it
_LIBRARY: Final = "librmw_fastrtps_cpp.so"
_CDR: Final = "_ZN8eprosima7fastcdr3Cdr"
_BUFFER: Final = "_ZN8eprosima7fastcdr10FastBuffer"
_LITTLE_ENDIAN: Final = 1
_VERSION: Final = 1  # CdrVersion::DDS_CDR
_TRIED_BYTES: Final = (1000, 3456)  # any two numbers
# A Cdr of Fast CDR 2.2 has under 400 bytes and a FastBuffer 40: more than they may ever have.
_ROOM: Final = 4096
_STEP: Final = 10
_IS_INPUT: Final = 1  # a flag of ctypes

_Pointer = ctypes.c_void_p


class FastCdr:
    """The few functions of a Cdr that are needed, for its address."""

    def __init__(self) -> None:
        """Find them, and the place in which a Cdr keeps its end.

        Raises:
            RosError: ``bad_type``: Fast CDR is not as expected here.
        """
        try:
            # With the GIL: what they do takes less time than to give it away
            library = ctypes.PyDLL(_LIBRARY)
            self._position = _function(library, f"{_CDR}20get_current_positionEv", _Pointer)
            self._start = _function(library, f"{_CDR}18get_buffer_pointerEv", _Pointer)
            self._jump = _function(library, f"{_CDR}4jumpEm", ctypes.c_bool, ctypes.c_size_t)
            buffer = f"{_BUFFER}C1EPcm"
            self._buffer = _function(library, buffer, None, _Pointer, ctypes.c_size_t)
            #: Write *octets*, *count* bytes, where *cdr* is, and go behind them. It must have the
            #: room, as it has where rmw knows the size.
            self.write = _write(library)
            cdr = f"{_CDR}C1ERNS0_10FastBufferENS1_10EndiannessENS0_10CdrVersionE"
            self._cdr = _function(library, cdr, None, _Pointer, ctypes.c_int, ctypes.c_int)
        except (OSError, AttributeError) as error:
            raise RosError("bad_type", "this Fast CDR lacks a function") from error
        places = [self._places_of_end(size) for size in _TRIED_BYTES]
        common = set.intersection(*places)
        if len(common) != 1:
            raise RosError("bad_type", "this Fast CDR does not show its end")
        self._end_at = common.pop()

    def read_all(self, cdr: int, start: int) -> tuple[bytes, bytes]:
        """Return the first *start* octets of a Cdr, and those from where it is to its end."""
        at = self._position(cdr)
        return (
            ctypes.string_at(self._start(cdr), start),
            ctypes.string_at(at, self._end(cdr) - at),
        )

    def _end(self, cdr: int) -> int:
        return int(_Pointer.from_address(cdr + self._end_at).value or 0)

    def _places_of_end(self, size: int) -> set[int]:
        """Return the offsets at which a Cdr over so many bytes holds the address of their end."""
        octets = ctypes.create_string_buffer(size)
        buffer, cdr = ctypes.create_string_buffer(_ROOM), ctypes.create_string_buffer(_ROOM)
        self._buffer(buffer, octets, size)
        self._cdr(cdr, buffer, _LITTLE_ENDIAN, _VERSION)  # neither owns anything to be freed
        start = ctypes.addressof(octets)
        is_expected = (
            self._start(cdr) == self._position(cdr) == start
            and self._jump(cdr, _STEP)
            and self._position(cdr) == start + _STEP
            and not self._jump(cdr, size)
        )
        words = (ctypes.c_uint64 * (_ROOM // 8)).from_buffer(cdr)
        return {8 * n for n, word in enumerate(words) if is_expected and word == start + size}


def _function(library: ctypes.PyDLL, name: str, result: Any, *arguments: Any) -> Any:
    function = library[name]
    function.restype = result
    function.argtypes = [_Pointer, *arguments]
    return function


def _write(library: ctypes.PyDLL) -> Callable[..., int]:
    """Return ``Cdr::serialize_array`` of bytes, whose arguments may be given by their names."""
    prototype = ctypes.PYFUNCTYPE(_Pointer, _Pointer, ctypes.c_char_p, ctypes.c_size_t)
    names = ("cdr", "octets", "count")
    function: Any = prototype(
        (f"{_CDR}15serialize_arrayEPKcm", library), tuple((_IS_INPUT, name) for name in names)
    )
    return function  # type: ignore[no-any-return]

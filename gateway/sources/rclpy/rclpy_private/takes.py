# SPDX-License-Identifier: Apache-2.0
"""Taking of large samples from DDS, by C."""

import ctypes
from collections.abc import Callable
from typing import Any, Final

import numpy as np
from rclpy.subscription import Subscription

from gateway.codec.cdr import Cdr
from gateway.sources.rclpy.rclpy_private.c_functions import (
    MissingFunctionError,
    c_function,
    rcl_function,
)
from gateway.sources.rclpy.rclpy_private.handles import handle_of, message_taker
from gateway.sources.source import Sample

_TAKE: Final = "rcl_take_serialized_message"
GUID_BYTES: Final = 16  # of an endpoint
_NOTHING_THERE: Final = 401  # RCL_RET_SUBSCRIPTION_TAKE_FAILED
# A copy of so much takes 20 us, and the memory behind it is not kept for each reader.
HANDED_OVER_BYTES: Final = 256 * 1024

TakeSample = Callable[[Subscription, type], Sample | None]
"""Take one sample, raw, of a subscription and its class, if one has arrived.

It serves one thread. Raises RuntimeError, also where the subscription is destroyed.
"""


def sample_taker() -> TakeSample:
    """Return a function that takes a sample, for one thread."""
    try:
        return _RclTake()
    except MissingFunctionError:
        return _take_by_rclpy


class _Allocator(ctypes.Structure):  # rcutils_allocator_t
    _fields_ = (
        ("allocate", ctypes.c_void_p),
        ("deallocate", ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)),
        ("reallocate", ctypes.c_void_p),
        ("zero_allocate", ctypes.c_void_p),
        ("state", ctypes.c_void_p),
    )


class _SerializedMessage(ctypes.Structure):  # rcl_serialized_message_t: rcutils_uint8_array_t
    _fields_ = (
        ("buffer", ctypes.c_void_p),
        ("length", ctypes.c_size_t),
        ("capacity", ctypes.c_size_t),
        ("allocator", _Allocator),
    )


class _MessageInfo(ctypes.Structure):  # rmw_message_info_t
    _fields_ = (
        ("source_ns", ctypes.c_int64),
        ("received_ns", ctypes.c_int64),
        ("number", ctypes.c_int64),  # unsigned in C, and all ones if there is no number
        ("number_of_reception", ctypes.c_int64),
        ("implementation", ctypes.c_void_p),
        ("publisher", ctypes.c_uint8 * GUID_BYTES),  # its GUID
        ("rest", ctypes.c_uint8 * 104),  # distributions differ
    )


class _ErrorString(ctypes.Structure):  # rcutils_error_string_t
    _fields_ = (("text", ctypes.c_char * 1024),)


class _Block:
    """Memory of rcl that is ours now, as numpy wraps it: it is freed with the last view of it."""

    __slots__ = ("__array_interface__", "_free")

    def __init__(self, address: int, size: int, free: Callable[[int, None], None]) -> None:
        self.__array_interface__: dict[str, Any] = {
            "version": 3,
            "typestr": "|u1",
            "shape": (size,),
            "data": (address, True),  # read-only
        }
        self._free = free

    def __del__(self) -> None:
        self._free(self.__array_interface__["data"][0], None)


class _RclTake:
    """Takes samples without the GIL, and without the two copies that rclpy makes of each.

    Small ones come by way of memory that is used again and again. Of a large one the caller gets
    the memory itself: to copy it would hold the GIL, and so the event loop, for as long as to
    take it. For small ones rclpy is as fast.
    """

    def __init__(self) -> None:
        self._take = rcl_function(_TAKE, ctypes.c_int, argument_count=4)
        self._get_error = c_function("librcutils.so", "rcutils_get_error_string", _ErrorString)
        self._reset_error = c_function("librcutils.so", "rcutils_reset_error", None)
        allocator = c_function("librcutils.so", "rcutils_get_default_allocator", _Allocator)()
        self._message = _SerializedMessage(allocator=allocator)
        self._info = _MessageInfo()
        self._out = ctypes.addressof(self._message), ctypes.addressof(self._info), None

    def __call__(self, subscription: Subscription, message_class: type) -> Sample | None:
        del message_class
        handle = handle_of(subscription)
        with handle:
            code = self._take(handle.pointer, *self._out)
        if code == _NOTHING_THERE:
            return None
        if code != 0:
            raise self._error(code)
        info = self._info
        number = info.number if info.number != -1 else None
        publisher = bytes(info.publisher)
        return Sample(self._cdr(), info.received_ns, info.source_ns, number, publisher)

    def __del__(self) -> None:
        message = getattr(self, "_message", None)  # none where a function is missing
        if message is not None and message.buffer is not None:
            message.allocator.deallocate(message.buffer, None)

    def _cdr(self) -> Cdr:
        message = self._message
        size = message.length
        if size < HANDED_OVER_BYTES:
            return ctypes.string_at(message.buffer, size)
        block = _Block(message.buffer, size, message.allocator.deallocate)
        message.buffer = None
        message.length = message.capacity = 0
        return np.asarray(block).data

    def _error(self, code: int) -> RuntimeError:
        # without memory the old block may be freed already: rather lose it than free it twice
        self._message.buffer = None
        self._message.length = self._message.capacity = 0
        text = self._get_error().text.decode(errors="replace")
        self._reset_error()
        return RuntimeError(f"{_TAKE} returned {code}: {text}")


def _take_by_rclpy(subscription: Subscription, message_class: type) -> Sample | None:
    taken = message_taker(subscription)(message_class, True)  # True: raw
    if taken is None:
        return None
    cdr, info = taken
    received_ns, source_ns = info["received_timestamp"], info["source_timestamp"]
    return Sample(cdr, received_ns, source_ns, info["publication_sequence_number"])

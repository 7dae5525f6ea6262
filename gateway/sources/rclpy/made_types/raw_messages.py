# SPDX-License-Identifier: Apache-2.0
"""Messages that are nothing but CDR: rmw's functions for a type, which copy bytes.

rclpy has C make a message, rmw read or write it, and C convert it from or to a Python object. Here
the message in C is a Python object itself, which rmw knows by its address.

rmw asks for a message's size and writes it while it holds a lock of DDS, so no bytecode may run in
these functions.
"""

import ctypes
import functools
import gc
import operator
from typing import Any, Final

from gateway.sources.rclpy.made_types.fast_cdr import FastCdr
from gateway.sources.rclpy.made_types.type_supports import (
    FASTRTPS,
    MessageCallbacks,
    MessageSupport,
    Pointer,
    address_of,
    capsule,
    found_support,
    keep,
)

ENCAPSULATION_BYTES: Final = 4
# RTPS 2.5, 10.2: CDR_LE, which is the byte order of every machine that this runs on
_LITTLE_ENDIAN: Final = b"\0\1"

_EMPTY: Final = b"\0\1\0\0\0"

# rmw calls the first three, and rclpy the last four
_Serialize = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.py_object, Pointer)
_Size = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.py_object)
_Deserialize = ctypes.CFUNCTYPE(ctypes.c_bool, Pointer, Pointer)
_Create = ctypes.PYFUNCTYPE(Pointer)
_Destroy = ctypes.PYFUNCTYPE(None, Pointer)
_FromPython = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, Pointer)
_ToPython = ctypes.PYFUNCTYPE(ctypes.py_object, Pointer)


class RawMessage:
    """A request or a response as CDR, encapsulation header included.

    Received bytes have up to 3 bytes of padding at their end, and the byte order of their sender.
    """

    __slots__ = ("cdr",)

    def __init__(self, cdr: bytes = _EMPTY) -> None:
        """Hold CDR that is little-endian. By default that of a type without fields.

        Raises:
            ValueError: it has another encapsulation, which rmw would not write before it.
        """
        if cdr[:2] != _LITTLE_ENDIAN or len(cdr) < ENCAPSULATION_BYTES:
            raise ValueError(f"encapsulation 0x{cdr[:2].hex()}, only 0x0001 can be sent")
        self.cdr = cdr


class _MessageInC(functools.partial[int]):
    """A message in C. Called with the address of a Cdr, it writes itself there."""

    size = 0  # of what it writes, in bytes
    received = b""  # encapsulation header included
    pauses_gc = False


class RawMessages:
    """The messages in C that exist now, and the functions that all their types share."""

    def __init__(self) -> None:
        """Make the functions, which are never freed.

        Raises:
            RosError: ``bad_type``: Fast CDR is not as expected here.
        """
        self._fast_cdr = FastCdr()
        self._held: dict[int, _MessageInC] = {}  # by address
        of_rmw = {
            "serialize": _Serialize(_MessageInC.__call__),  # the one of `partial`, in C
            "size": _Size(operator.attrgetter("size")),
            "deserialize": _Deserialize(self._deserialize),
        }
        of_python = {
            "_CREATE_ROS_MESSAGE": _Create(self._create),
            "_CONVERT_FROM_PY": _FromPython(self._from_python),
            "_CONVERT_TO_PY": _ToPython(self._to_python),
            "_DESTROY_ROS_MESSAGE": _Destroy(self._destroy),
        }
        keep(of_rmw, of_python)
        # for a type's `MessageCallbacks`, and for the metaclass of its class
        self.callbacks = {name: address_of(each) for name, each in of_rmw.items()}
        self.callbacks["max_size"] = _unbounded()
        self.members = {name: capsule(address_of(each)) for name, each in of_python.items()}

    def __len__(self) -> int:
        """Count the messages in C."""
        return len(self._held)

    def _create(self) -> int:
        message = _MessageInC(self._fast_cdr.write, octets=b"", count=0)
        self._held[id(message)] = message
        return id(message)

    def _destroy(self, address: int) -> None:
        if self._held.pop(address).pauses_gc:
            gc.enable()

    def _from_python(self, message: RawMessage, address: int) -> bool:
        octets = message.cdr[ENCAPSULATION_BYTES:]
        in_c = self._held[address]
        in_c.size = len(octets)
        in_c.keywords.update(octets=octets, count=in_c.size)
        # Until it is sent and destroyed: a collection may run finalizers, which are bytecode.
        in_c.pauses_gc = gc.isenabled()
        gc.disable()
        return True

    def _deserialize(self, cdr: int, address: int) -> bool:
        """Read a message. rmw has left the locks of DDS by then."""
        whole = b"".join(self._fast_cdr.read_all(cdr, ENCAPSULATION_BYTES))
        self._held[address].received = whole
        return True

    def _to_python(self, address: int) -> RawMessage:
        received: Any = RawMessage.__new__(RawMessage)  # of either byte order
        received.cdr = self._held[address].received
        return received  # type: ignore[no-any-return]


def _unbounded() -> int:
    """Return the function by which a type says that its size is not bounded."""
    from std_msgs.msg import String

    support = MessageSupport.from_address(found_support(String, FASTRTPS))
    return int(MessageCallbacks.from_address(support.data).max_size)

# SPDX-License-Identifier: Apache-2.0
"""Messages that are nothing but CDR: rmw's functions for a type, which copy bytes.

rclpy has C make a message, rmw read or write it, and C convert it from or to a Python object. Here
the message in C is a place in memory, and the CDR that belongs to it is kept beside.
"""

import ctypes
from typing import Any, Final

from gateway.ros.fast_cdr import FastCdr
from gateway.ros.type_supports import Pointer, address_of, capsule, keep

ENCAPSULATION_BYTES: Final = 4
# RTPS 2.5, 10.2: CDR_LE, which is the byte order of every machine that this runs on
_LITTLE_ENDIAN: Final = b"\0\1"

_EMPTY: Final = b"\0\1\0\0\0"

# rmw calls the first two of a type's functions, and rclpy the last four
_Code = ctypes.CFUNCTYPE(ctypes.c_bool, Pointer, Pointer)
_Size = ctypes.CFUNCTYPE(ctypes.c_uint32, Pointer)
_MaxSize = ctypes.CFUNCTYPE(ctypes.c_size_t, Pointer)
_Create = ctypes.PYFUNCTYPE(Pointer)
_Destroy = ctypes.PYFUNCTYPE(None, Pointer)
_FromPython = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, Pointer)
_ToPython = ctypes.PYFUNCTYPE(ctypes.py_object, Pointer)


class RawMessage:
    """A request or a response as CDR, encapsulation header included.

    What was received has up to 3 bytes of padding at its end, and the byte order of its sender.
    """

    __slots__ = ("cdr",)

    def __init__(self, cdr: bytes = _EMPTY) -> None:
        """Hold CDR that is little-endian; by default that of a type without fields.

        Raises:
            ValueError: it has another encapsulation, which rmw would not write before it.
        """
        if cdr[:2] != _LITTLE_ENDIAN or len(cdr) < ENCAPSULATION_BYTES:
            raise ValueError(f"encapsulation 0x{cdr[:2].hex()}, only 0x0001 can be sent")
        self.cdr = cdr


class RawMessages:
    """The messages in C that exist now, and the functions that all their types share."""

    def __init__(self) -> None:
        """Make the functions, which are never freed.

        Raises:
            RosError: ``bad_type``: Fast CDR is not as expected here.
        """
        self._fast_cdr = FastCdr()
        self._held: dict[int, tuple[object, bytes]] = {}  # by address: its place, its CDR
        code = {"serialize": _Code(self._serialize), "deserialize": _Code(self._deserialize)}
        sizes = {"size": _Size(self._size), "max_size": _MaxSize(_write_unbounded)}
        of_python = {
            "_CREATE_ROS_MESSAGE": _Create(self._create),
            "_CONVERT_FROM_PY": _FromPython(self._from_python),
            "_CONVERT_TO_PY": _ToPython(self._to_python),
            "_DESTROY_ROS_MESSAGE": _Destroy(self._destroy),
        }
        keep(code, sizes, of_python)
        # for a type's `MessageCallbacks`, and for the metaclass of its class
        self.callbacks = {name: address_of(each) for name, each in (code | sizes).items()}
        self.members = {name: capsule(address_of(each)) for name, each in of_python.items()}

    def __len__(self) -> int:
        """Count the messages in C."""
        return len(self._held)

    def _create(self) -> int:
        place = ctypes.c_uint64()  # anything with an address of its own
        address = ctypes.addressof(place)
        self._held[address] = (place, b"")
        return address

    def _destroy(self, address: int) -> None:
        del self._held[address]

    def _from_python(self, message: RawMessage, address: int) -> bool:
        place, _ = self._held[address]
        self._held[address] = (place, message.cdr)
        return True

    def _to_python(self, address: int) -> RawMessage:
        received: Any = RawMessage.__new__(RawMessage)  # of either byte order
        received.cdr = self._held[address][1]
        return received  # type: ignore[no-any-return]

    def _serialize(self, address: int, cdr: int) -> bool:
        return self._fast_cdr.write(cdr, self._held[address][1][ENCAPSULATION_BYTES:])

    def _deserialize(self, cdr: int, address: int) -> bool:
        place, _ = self._held[address]
        self._held[address] = (place, b"".join(self._fast_cdr.read_all(cdr, ENCAPSULATION_BYTES)))
        return True

    def _size(self, address: int) -> int:
        return len(self._held[address][1]) - ENCAPSULATION_BYTES


def _write_unbounded(bounds: int) -> int:
    ctypes.c_uint8.from_address(bounds).value = 0  # neither bounded nor plain
    return 0

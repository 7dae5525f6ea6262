# SPDX-License-Identifier: Apache-2.0
"""The structures by which rcl and rmw know a type, made by ctypes.

They are those of ``message_type_support_struct.h``, ``service_type_support_struct.h`` and
``type_hash.h`` in rosidl_runtime_c, and of ``message_type_support.h`` and
``service_type_support.h`` in rosidl_typesupport_fastrtps_cpp, as they are since Jazzy.
"""

import ctypes
import functools
from collections.abc import Mapping
from typing import Any, Final

from gateway.sources.source import RosError

FASTRTPS: Final = b"rosidl_typesupport_fastrtps_c"
INTROSPECTION: Final = b"rosidl_typesupport_introspection_c"
# all for which rmw may ask
_IDENTIFIERS: Final = (
    FASTRTPS,
    INTROSPECTION,
    b"rosidl_typesupport_fastrtps_cpp",
    b"rosidl_typesupport_introspection_cpp",
)

_HASH_VERSION: Final = 1
_HASH_PREFIX: Final = "RIHS01_"

Pointer = ctypes.c_void_p
_kept: Final[list[object]] = []  # until the process ends


class _TypeHash(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


class MessageSupport(ctypes.Structure):
    """rosidl_message_type_support_t."""

    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", Pointer),
        ("find", Pointer),
        ("get_hash", Pointer),
        ("get_description", Pointer),
        ("get_sources", Pointer),
    )


class ServiceSupport(ctypes.Structure):
    """rosidl_service_type_support_t. The event may be missing, as nothing here introspects."""

    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", Pointer),
        ("find", Pointer),
        ("request", Pointer),
        ("response", Pointer),
        ("event", Pointer),
        ("create_event", Pointer),
        ("destroy_event", Pointer),
        ("get_hash", Pointer),
        ("get_description", Pointer),
        ("get_sources", Pointer),
    )


class MessageCallbacks(ctypes.Structure):
    """message_type_support_callbacks_t, and room for what later versions add, which may be zero."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("serialize", Pointer),
        ("deserialize", Pointer),
        ("size", Pointer),
        ("max_size", Pointer),
        ("key", Pointer),
        ("later", Pointer * 8),
    )


class ServiceCallbacks(ctypes.Structure):
    """service_type_support_callbacks_t, and room as above."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("request", Pointer),
        ("response", Pointer),
        ("later", Pointer * 8),
    )


class _Sequence(ctypes.Structure):
    """Any sequence of rosidl_runtime_c."""

    _fields_ = (("data", Pointer), ("size", ctypes.c_size_t), ("capacity", ctypes.c_size_t))


Find = ctypes.CFUNCTYPE(Pointer, Pointer, ctypes.c_char_p)
# The argument that rmw gives, the type support, is not needed.
_Get = ctypes.CFUNCTYPE(Pointer)

_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = [Pointer, ctypes.c_char_p, Pointer]
_capsule_pointer = ctypes.pythonapi.PyCapsule_GetPointer
_capsule_pointer.restype = Pointer
_capsule_pointer.argtypes = [ctypes.py_object, ctypes.c_char_p]


def keep(*objects: object) -> None:
    """Keep objects until the process ends."""
    _kept.extend(objects)


def capsule(address: int) -> object:
    """Return the object by which rclpy finds something of C."""
    return _new_capsule(address, None, None)


def address_of(function: Any) -> int:
    """Return the address of a function that C may call."""
    return int(ctypes.cast(function, Pointer).value or 0)


def support_of(real_class: Any) -> int:
    """Return the address of the type support of a class that a package has."""
    metaclass = real_class.__class__
    if metaclass._TYPE_SUPPORT is None:  # noqa: SLF001  # as rclpy reads it
        metaclass.__import_type_support__()
    return _function(metaclass, "_TYPE_SUPPORT")


def found_support(real_class: Any, identifier: bytes) -> int:
    """Return the address of what an implementation has for a class that a package has."""
    support = support_of(real_class)
    find = Find(MessageSupport.from_address(support).find)
    return int(find(support, identifier))


class Finder:
    """The function by which rmw asks a type for the support that it understands, for all types."""

    def __init__(self, introspection: int | None) -> None:
        """Make it. *introspection* is a support in rosidl_typesupport_introspection_c, if any."""

        @functools.cache
        def find(handle: int, identifier: bytes) -> int | None:
            if identifier == FASTRTPS:
                return handle
            return introspection if identifier == INTROSPECTION else None

        made = Find(find)
        keep(made)
        self._find = find
        self.address = address_of(made)

    def prepare(self, handle: int) -> None:
        """Have the answers for a type in the cache, so that no bytecode runs to give them.

        rmw asks under a lock of DDS.
        """
        for identifier in _IDENTIFIERS:
            self._find(handle, identifier)


def about(hashed: str, description: Mapping[str, Any]) -> dict[str, int]:
    """Return the last three members of a type support: its hash, its description, no sources.

    *hashed* and *description* are as of `schemas.type_hash`.
    """
    return {
        "get_hash": _hash_getter(hashed),
        "get_description": _description_getter(description),
        "get_sources": _getter(_Sequence()),
    }


def _hash_getter(hashed: str) -> int:
    octets = bytes.fromhex(hashed.removeprefix(_HASH_PREFIX))
    return _getter(_TypeHash(_HASH_VERSION, (ctypes.c_uint8 * 32)(*octets)))


def _description_getter(description: Mapping[str, Any]) -> int:
    message = _as_message(description)
    metaclass = type(message).__class__
    support_of(type(message))  # imports the functions below
    create = ctypes.PYFUNCTYPE(Pointer)(_function(metaclass, "_CREATE_ROS_MESSAGE"))
    convert = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, Pointer)(
        _function(metaclass, "_CONVERT_FROM_PY")
    )
    structure = create()  # rosidl_runtime_c's structure of it is the same
    if not convert(message, structure):
        raise RosError("internal", "a type description does not convert")
    return _getting(structure)


def _getter(structure: ctypes.Structure) -> int:
    keep(structure)
    return _getting(ctypes.addressof(structure))


def _getting(address: int) -> int:
    # No bytecode: it runs under a lock of DDS.
    get = _Get(address.__index__)
    keep(get)
    return address_of(get)


def _function(metaclass: Any, name: str) -> int:
    return int(_capsule_pointer(getattr(metaclass, name), None))


def _as_message(description: Mapping[str, Any]) -> Any:
    """Return a description as type_description_interfaces/msg/TypeDescription."""
    from type_description_interfaces.msg import (
        Field,
        FieldType,
        IndividualTypeDescription,
        TypeDescription,
    )

    def individual(one: Mapping[str, Any]) -> Any:
        fields = [
            Field(name=field["name"], type=FieldType(**field["type"])) for field in one["fields"]
        ]
        return IndividualTypeDescription(type_name=one["type_name"], fields=fields)

    nested = description["referenced_type_descriptions"]
    return TypeDescription(
        type_description=individual(description["type_description"]),
        referenced_type_descriptions=list(map(individual, nested)),
    )

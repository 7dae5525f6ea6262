# SPDX-License-Identifier: Apache-2.0
"""Classes for message types whose package is not installed, made at run time.

rclpy gives rmw a type support: a C structure that a package's generated code holds. To publish and
to take samples as CDR, rmw_fastrtps_cpp reads little of it: the type's name, its REP-2011 hash, its
description, and that its size is not bounded. So a structure made by ctypes does as well. Nothing
of it serialises: these classes are for raw subscriptions and `rclpy_private.raw_publisher` alone.

The structures are those of ``rosidl_runtime_c/message_type_support_struct.h``,
``rosidl_runtime_c/type_hash.h`` and ``rosidl_typesupport_fastrtps_cpp/message_type_support.h``, as
they are since Jazzy. Whether they are so here is found out by another process
(`gateway.ros.made_types_check`), as a wrong one may crash it.

What is made is never freed: rmw and rcl keep pointers to it.
"""

import ctypes
from collections.abc import Mapping
from typing import Any, Final

from rclpy.utilities import get_rmw_implementation_identifier

from gateway.ports import RosError
from schemas.definition import Definition
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_description, type_hash

MAX_MADE: Final = 1024  # types, a few kB each
RMW: Final = "rmw_fastrtps_cpp"

_FASTRTPS: Final = b"rosidl_typesupport_fastrtps_c"
_INTROSPECTION: Final = b"rosidl_typesupport_introspection_c"
_HASH_VERSION: Final = 1
_HASH_PREFIX: Final = "RIHS01_"

_Pointer = ctypes.c_void_p
_kept: Final[list[object]] = []  # until the process ends


class _TypeHash(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


class _TypeSupport(ctypes.Structure):
    """rosidl_message_type_support_t."""

    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", _Pointer),
        ("find", _Pointer),
        ("get_hash", _Pointer),
        ("get_description", _Pointer),
        ("get_sources", _Pointer),
    )


class _Callbacks(ctypes.Structure):
    """message_type_support_callbacks_t, and room for what later versions add, which may be zero."""

    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("serialize", _Pointer),
        ("deserialize", _Pointer),
        ("size", _Pointer),
        ("max_size", _Pointer),
        ("key", _Pointer),
        ("later", _Pointer * 8),
    )


class _Sequence(ctypes.Structure):
    """Any sequence of rosidl_runtime_c."""

    _fields_ = (("data", _Pointer), ("size", ctypes.c_size_t), ("capacity", ctypes.c_size_t))


_Find = ctypes.CFUNCTYPE(_Pointer, _Pointer, ctypes.c_char_p)
_Get = ctypes.CFUNCTYPE(_Pointer, _Pointer)
_Code = ctypes.CFUNCTYPE(ctypes.c_bool, _Pointer, _Pointer)
_Size = ctypes.CFUNCTYPE(ctypes.c_uint32, _Pointer)
_MaxSize = ctypes.CFUNCTYPE(ctypes.c_size_t, _Pointer)

_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = [_Pointer, ctypes.c_char_p, _Pointer]
_capsule_pointer = ctypes.pythonapi.PyCapsule_GetPointer
_capsule_pointer.restype = _Pointer
_capsule_pointer.argtypes = [ctypes.py_object, ctypes.c_char_p]


def _write_unbounded(bounds: int) -> int:
    ctypes.c_uint8.from_address(bounds).value = 0  # neither bounded nor plain
    return 0


_refuse = _Code(lambda *_: False)  # serialise and deserialise: no message is an object here
_no_size = _Size(lambda _: 0)
_unbounded = _MaxSize(_write_unbounded)


class MadeTypes:
    """The classes that were made, one for each type and hash."""

    def __init__(self) -> None:
        self._made: dict[tuple[str, str], type] = {}
        self._introspection: int | None = None

    def get(self, definition: Definition, definitions: InstalledDefinitions) -> type:
        """Return the class of a message, made now if it is the first time.

        Raises:
            RosError: ``limit_exceeded``: there are `MAX_MADE` of them.
            UnknownTypeError, DefinitionError: a type that it nests is not known.
        """
        hashed = type_hash(definition, definitions)
        key = (definition.name, hashed)
        if key not in self._made:
            if len(self._made) >= MAX_MADE:
                text = f"at most {MAX_MADE} types that are not installed; start the gateway anew"
                raise RosError("limit_exceeded", text)
            description = type_description(definition, definitions)
            self._made[key] = self._make(definition.name, hashed, description)
        return self._made[key]

    def _make(self, type_name: str, hashed: str, description: Mapping[str, Any]) -> type:
        package, kind, name = type_name.split("/")
        callbacks = _Callbacks(
            namespace=f"{package}::{kind}".encode(),
            name=name.encode(),
            serialize=_address(_refuse),
            deserialize=_address(_refuse),
            size=_address(_no_size),
            max_size=_address(_unbounded),
        )
        support = _TypeSupport(
            identifier=_FASTRTPS,
            data=ctypes.addressof(callbacks),
            find=_address(self._finder()),
            get_hash=_address(_hash_getter(hashed)),
            get_description=_address(_description_getter(description)),
            get_sources=_address(_getter(_Sequence())),
        )
        nothing = _new_capsule(_address(_refuse), None, None)
        members = {
            "_TYPE_SUPPORT": _new_capsule(ctypes.addressof(support), None, None),
            "_CREATE_ROS_MESSAGE": nothing,
            "_CONVERT_FROM_PY": nothing,
            "_CONVERT_TO_PY": nothing,
            "_DESTROY_ROS_MESSAGE": nothing,
        }
        metaclass: Any = type(f"Metaclass_{name}", (type,), members)
        made: type = metaclass(name, (), {"__module__": f"{package}.{kind}"})
        _kept.extend((callbacks, support, made))
        return made

    def _finder(self) -> Any:
        """Return what rmw asks for the type support that it understands."""
        introspection = self._introspection_support()

        def find(handle: int, identifier: bytes) -> int | None:
            if identifier == _FASTRTPS:
                return handle
            return introspection if identifier == _INTROSPECTION else None

        _kept.append(_Find(find))
        return _kept[-1]

    def _introspection_support(self) -> int:
        """Return that of std_msgs/msg/Empty.

        A publisher of Fast DDS 2 registers one, and what that says about the type is not used.
        """
        if self._introspection is None:
            from std_msgs.msg import Empty

            real = _type_support(Empty)
            find = _Find(_TypeSupport.from_address(real).find)
            self._introspection = int(find(real, _INTROSPECTION))
        return self._introspection


def _hash_getter(hashed: str) -> Any:
    octets = bytes.fromhex(hashed.removeprefix(_HASH_PREFIX))
    return _getter(_TypeHash(_HASH_VERSION, (ctypes.c_uint8 * 32)(*octets)))


def _description_getter(description: Mapping[str, Any]) -> Any:
    message = _as_message(description)
    metaclass = type(message).__class__
    _type_support(type(message))  # imports the functions below
    create = ctypes.PYFUNCTYPE(_Pointer)(_function(metaclass, "_CREATE_ROS_MESSAGE"))
    convert = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, _Pointer)(
        _function(metaclass, "_CONVERT_FROM_PY")
    )
    structure = create()  # rosidl_runtime_c's structure of it is the same
    if not convert(message, structure):
        raise RosError("internal", "a type description does not convert")
    return _getting(structure)


def _getter(structure: ctypes.Structure) -> Any:
    _kept.append(structure)
    return _getting(ctypes.addressof(structure))


def _getting(address: int) -> Any:
    get = _Get(lambda _: address)
    _kept.append(get)
    return get


def check_middleware() -> None:
    """Check that the middleware is one that takes such types.

    Raises:
        RosError: ``bad_type``: it is another.
    """
    found = get_rmw_implementation_identifier()
    if found != RMW:
        raise RosError("bad_type", f"types that are not installed need {RMW}, this is {found}")


def _type_support(message_class: Any) -> int:
    metaclass = message_class.__class__
    if metaclass._TYPE_SUPPORT is None:  # noqa: SLF001  # as rclpy reads it
        metaclass.__import_type_support__()
    return _function(metaclass, "_TYPE_SUPPORT")


def _function(metaclass: Any, name: str) -> int:
    return int(_capsule_pointer(getattr(metaclass, name), None))


def _address(function: Any) -> int:
    return int(ctypes.cast(function, _Pointer).value or 0)


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

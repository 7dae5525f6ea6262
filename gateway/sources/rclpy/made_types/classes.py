# SPDX-License-Identifier: Apache-2.0
"""The classes of made types, which rclpy takes as it takes those of packages."""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeVar

from rclpy.utilities import get_rmw_implementation_identifier

from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.made_types.raw_messages import RawMessage, RawMessages
from gateway.sources.rclpy.made_types.type_supports import (
    FASTRTPS,
    INTROSPECTION,
    Finder,
    MessageCallbacks,
    MessageSupport,
    ServiceCallbacks,
    ServiceSupport,
    about,
    capsule,
    found_support,
    keep,
)
from gateway.sources.source import RosError
from schemas.definition import Definition
from schemas.derived import DerivedDefinitions
from schemas.installed import InstalledDefinitions
from schemas.interface import FEEDBACK_MESSAGE, GET_RESULT, SEND_GOAL, Interface
from schemas.type_hash import Definitions, type_description, type_hash

MAX_MADE: Final = 1024  # types, a few kB each. Of an action it is one
RMW: Final = "rmw_fastrtps_cpp"

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class MadeAction:
    """The classes of an action's two services that have its types, and of its feedback."""

    send_goal: Any
    get_result: Any
    feedback: type


class MadeTypes:
    """The classes that were made, one for each type and hash."""

    def __init__(self) -> None:
        self._made: dict[tuple[str, str], Any] = {}
        self._messages: RawMessages | None = None
        self._finder: Finder | None = None

    def get(self, definition: Definition, definitions: InstalledDefinitions) -> type:
        """Return the class of a message, made now if it is the first time.

        Its objects are `gateway.sources.rclpy.made_types.raw_messages.RawMessage`.

        Raises:
            RosError: ``limit_exceeded``: there are `MAX_MADE` of them. ``bad_type``: none can be
                made, as Fast CDR is not as expected.
            UnknownTypeError, DefinitionError: a type that it nests is not known.
        """
        hashed = type_hash(definition, definitions)
        made: type = self._once(
            definition, hashed, lambda: self._message(definition, definitions)[0]
        )
        return made

    def service(self, interface: Interface, definitions: InstalledDefinitions) -> Any:
        """Return the class of a service, whose ``Request`` and ``Response`` are as for `get`.

        Raises:
            RosError, UnknownTypeError, DefinitionError: as for `get`.
        """
        derived = DerivedDefinitions(interface, definitions)
        whole = derived.get(interface.name)
        hashed = type_hash(whole, derived)
        return self._once(whole, hashed, lambda: self._service(interface.name, derived))

    def action(self, interface: Interface, definitions: InstalledDefinitions) -> MadeAction:
        """Return the classes of an action.

        Raises:
            RosError, UnknownTypeError, DefinitionError: as for `get`.
        """
        derived = DerivedDefinitions(interface, definitions)
        name = interface.name
        whole = derived.get(name)

        def make() -> MadeAction:
            return MadeAction(
                self._service(name + SEND_GOAL, derived),
                self._service(name + GET_RESULT, derived),
                self._message(derived.get(name + FEEDBACK_MESSAGE), derived)[0],
            )

        return self._once(whole, type_hash(whole, derived), make)

    def _once(self, definition: Definition, hashed: str, make: Callable[[], _T]) -> _T:
        key = (definition.name, hashed)
        if key not in self._made:
            if len(self._made) >= MAX_MADE:
                text = f"at most {MAX_MADE} types that are not installed; restart the gateway"
                raise RosError("limit_exceeded", text)
            self._made[key] = make()
        made: _T = self._made[key]
        return made

    def _message(self, definition: Definition, definitions: Definitions) -> tuple[Any, int]:
        """Make the class of a message, and its type support."""
        if definition.is_keyed and not fast_dds.is_second():
            # It has readers and writers with and without a key not match. A made type has none.
            raise RosError(
                "bad_type",
                f"{definition.title} has a @key: with Fast DDS 3 such a type needs its package;"
                f" install {definition.package}, and source it before the gateway starts",
            )
        if self._messages is None:
            self._messages = RawMessages()
        finder = self._get_finder()
        package, kind, name = definition.name.split("/")
        callbacks = MessageCallbacks(
            namespace=f"{package}::{kind}".encode(), name=name.encode(), **self._messages.callbacks
        )
        support = MessageSupport(
            identifier=FASTRTPS,
            data=ctypes.addressof(callbacks),
            find=finder.address,
            **about(type_hash(definition, definitions), type_description(definition, definitions)),
        )
        address = ctypes.addressof(support)
        finder.prepare(address)
        members = {"_TYPE_SUPPORT": capsule(address), **self._messages.members}
        metaclass: Any = type(f"Metaclass_{name}", (type,), members)
        made = metaclass(name, (RawMessage,), {"__slots__": (), "__module__": f"{package}.{kind}"})
        keep(callbacks, support, made)
        return made, address

    def _service(self, type_name: str, derived: DerivedDefinitions) -> Any:
        finder = self._get_finder()
        package, kind, name = type_name.split("/")
        request_class, request = self._message(derived.get(f"{type_name}_Request"), derived)
        response_class, response = self._message(derived.get(f"{type_name}_Response"), derived)
        callbacks = ServiceCallbacks(
            namespace=f"{package}::{kind}".encode(),
            name=name.encode(),
            request=request,
            response=response,
        )
        whole = derived.get(type_name)
        support = ServiceSupport(
            identifier=FASTRTPS,
            data=ctypes.addressof(callbacks),
            find=finder.address,
            request=request,
            response=response,
            **about(type_hash(whole, derived), type_description(whole, derived)),
        )
        address = ctypes.addressof(support)
        finder.prepare(address)
        members = {"_TYPE_SUPPORT": capsule(address)}
        metaclass: Any = type(f"Metaclass_{name}", (type,), members)
        parts = {"Request": request_class, "Response": response_class}
        made = metaclass(name, (), parts | {"__module__": f"{package}.{kind}"})
        keep(callbacks, support, made)
        return made

    def _get_finder(self) -> Finder:
        """Return the function by which rmw finds a type support."""
        if self._finder is None:
            self._finder = Finder(_introspection())
        return self._finder


def _introspection() -> int | None:
    """Return a type support of rosidl_typesupport_introspection_c, where rmw cannot do without.

    On Fast DDS 2 rmw registers it for a publisher, and what it says about the type is not used:
    that of std_msgs/msg/Empty does. On Fast DDS 3 endpoints that have it match only those of the
    same type by it, and others by the name alone.
    """
    if not fast_dds.is_second():
        return None
    from std_msgs.msg import Empty

    return found_support(Empty, INTROSPECTION)


def check_middleware() -> None:
    """Check that the middleware is one that takes such types.

    Raises:
        RosError: ``bad_type``: it is another.
    """
    found = get_rmw_implementation_identifier()
    if found != RMW:
        raise RosError("bad_type", f"types that are not installed need {RMW}, this is {found}")

# SPDX-License-Identifier: Apache-2.0
"""The types that rosidl derives from a service or an action, for their hashes and descriptions.

They are what `schemas.interface.derive` returns.
"""

from collections.abc import Iterable
from dataclasses import replace

from schemas.definition import Definition
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.interface import Interface, derive
from schemas.type_hash import type_hash


def hashed(interface: Interface, definitions: InstalledDefinitions) -> Interface:
    """Return a service or an action with its hash, which is computed if none is installed.

    Without one, if a type that the hash covers is not known: ROS before Iron has no service_msgs.

    Raises:
        DefinitionError: a type that it nests cannot be read.
    """
    if interface.type_hash is not None:
        return interface
    derived = DerivedDefinitions(interface, definitions)
    try:
        return replace(interface, type_hash=type_hash(derived.get(interface.name), derived))
    except UnknownTypeError:
        return interface


class DerivedDefinitions:
    """The definitions of one service or action, of its parts, and of what is derived from them."""

    def __init__(self, interface: Interface, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._known = derive(interface)

    def get(self, name: str) -> Definition:
        """Return a definition by rosidl's name of it, such as ``pkg/action/Name_SendGoal_Request``.

        Raises:
            UnknownTypeError, DefinitionError: as for `InstalledDefinitions.get`.
        """
        return self._known.get(name) or self._definitions.get(name)

    def names(self) -> list[str]:
        """List the parts and all that is derived."""
        return list(self._known)

    def closure(self, names: Iterable[str]) -> list[Definition]:
        """Return the definitions of *names* and of all nested types, in no order.

        Raises:
            UnknownTypeError, DefinitionError: as for `InstalledDefinitions.closure`.
        """
        own: dict[str, Definition] = {}
        others: dict[str, None] = {}
        left = list(names)
        while left:
            name = left.pop()
            if name not in self._known:
                others[name] = None
            elif name not in own:
                own[name] = self._known[name]
                left += own[name].nested()
        return [*self._definitions.closure(others), *own.values()]

# SPDX-License-Identifier: Apache-2.0
"""Service and action types by name, or as the ROS graph has them."""

import contextlib
from collections.abc import Callable, Iterable
from typing import Literal, TypeVar, get_args

from gateway.codec.error_text import did_you_mean
from gateway.codec.types import ActionType, ServiceType, Types
from gateway.core.bad_type import bad_type
from gateway.core.errors import ProtocolError
from gateway.core.missing_parts import require
from gateway.core.names import ActionName, ServiceName
from gateway.sources.source import Ros, RosError
from schemas.definition import DefinitionError
from schemas.installed import UnknownTypeError
from schemas.interface import InterfaceKind
from schemas.table import TypeNameError, resolve_interface

T = TypeVar("T", ServiceType, ActionType)


class InterfaceTypes:
    """Finds the type that a client asks for, or that a service or an action has."""

    def __init__(self, ros: Ros, types: Types) -> None:
        self._ros = ros
        self._types = types

    def service(self, requested: str) -> ServiceType:
        """Return the service type that a client names.

        Raises:
            ProtocolError: the name is malformed, or the type is not installed here.
        """
        return self._known(self._types.service, requested, "srv")

    def action(self, requested: str) -> ActionType:
        """Return the action type that a client names.

        Raises:
            ProtocolError: the name is malformed, or the type is not installed here.
        """
        return self._known(self._types.action, requested, "action")

    def described(self, requested: str | int) -> ServiceType | ActionType | None:
        """Return the service or action type of a name. ``None`` if it names a message type.

        Raises:
            ProtocolError: it names a service or action type that is not installed here.
        """
        if not isinstance(requested, str):
            return None
        match requested.split("/"):
            case [_, "srv", _]:
                return self.service(requested)
            case [_, "action", _]:
                return self.action(requested)
            case [_, _]:
                for named in (self.service, self.action):
                    with contextlib.suppress(ProtocolError):
                        return named(requested)
        return None

    def meant(self, requested: str | int) -> str | None:
        """Guess which service or action type a name means, if it does not mean a message type."""
        definitions = self._types.definitions
        if not isinstance(requested, str) or definitions.meant(requested) is not None:
            return None
        guesses = (definitions.meant(requested, kind) for kind in get_args(InterfaceKind))
        return next(filter(None, guesses), None)

    def of_service(
        self, service: ServiceName, requested: str | None, sees: Callable[[str], bool]
    ) -> ServiceType:
        """Return the type to call a service with. *requested* is the one that the client names.

        *sees* returns whether a name exists for the client, and may be proposed to it.

        Raises:
            ProtocolError: nobody provides it, or not with that type.
            RosError: the source has none.
        """
        require(self._ros.services)
        found = self._ros.service_types(service)
        known = (each.name for each in self._ros.graph().services) if not found else ()
        name = self._one("service", service, requested, found, filter(sees, known))
        return self.service(name)

    def of_action(
        self, action: ActionName, requested: str | None, sees: Callable[[str], bool]
    ) -> ActionType:
        """Return the type to send goals to an action with. See `of_service`.

        Raises:
            ProtocolError: nobody provides it, or not with that type.
            RosError: the source has none.
        """
        require(self._ros.actions)
        found = self._ros.action_types(action)
        known = (each.name for each in self._ros.graph().actions) if not found else ()
        name = self._one("action", action, requested, found, filter(sees, known))
        return self.action(name)

    def _known(self, get: Callable[[str], T], requested: str, kind: InterfaceKind) -> T:
        name = self._resolved(requested, kind)
        try:
            return get(name)
        except (UnknownTypeError, DefinitionError) as error:
            raise bad_type(error, self._types.definitions) from error

    def _resolved(self, requested: str, kind: InterfaceKind) -> str:
        try:
            return resolve_interface(requested, kind)
        except TypeNameError as error:
            raise bad_type(error, self._types.definitions) from error

    def _one(
        self,
        kind: Literal["service", "action"],
        name: str,
        requested: str | None,
        found: tuple[str, ...],
        known: Iterable[str],
    ) -> str:
        """Choose among the types that the graph has found for a name."""
        if not found:
            others = (each for each in known if each != name)  # it may have gone just now
            near = did_you_mean(name, others)
            if not near and self._ros.refusal is not None:
                raise RosError("not_found", self._ros.refusal)
            raise ProtocolError("not_found", f"{kind} {name} does not exist{near}")
        if not requested:  # some clients write an empty one
            if len(found) > 1:
                types = " and ".join(found)
                raise ProtocolError("type_conflict", f"{kind} {name} has types {types}: choose one")
            return found[0]
        named = self._resolved(requested, "srv" if kind == "service" else "action")
        if named not in found:
            types = " and ".join(found)
            text = f"{kind} {name} has type {types}, not {named}: use its type, or leave it out"
            raise ProtocolError("type_conflict", text)
        return named

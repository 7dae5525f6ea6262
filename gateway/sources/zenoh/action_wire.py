# SPDX-License-Identifier: Apache-2.0
"""Actions as Zenoh carries them: the services and topics of a type, checked before they go out."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from gateway.codec.types import Types
from gateway.sources.action_cdr import ActionCdr
from gateway.sources.name_checks import split_type
from gateway.sources.realignment import Realignment
from gateway.sources.source import RosError
from gateway.sources.zenoh.service_forms import ServiceWire, service_wire
from schemas.definition import DefinitionError
from schemas.derived import DerivedDefinitions
from schemas.installed import UnknownTypeError
from schemas.interface import FEEDBACK_MESSAGE, GET_RESULT, SEND_GOAL
from schemas.type_hash import type_hash

CANCEL: Final = "action_msgs/srv/CancelGoal"


@dataclass(frozen=True, slots=True)
class ActionWire:
    """An action type: the ways to its messages, and its services."""

    cdr: ActionCdr
    send_goal: ServiceWire
    get_result: ServiceWire
    cancel: ServiceWire
    read_feedback: Callable[[bytes], object]

    @property
    def type_name(self) -> str:
        """The name, such as ``pkg/action/Name``."""
        return self.cdr.type_name

    @property
    def feedback_type(self) -> str:
        """The type of the feedback's topic."""
        return self.type_name + FEEDBACK_MESSAGE


def action_wire(types: Types, type_name: str) -> ActionWire:
    """Return the form of ``pkg/action/Name``.

    Raises:
        RosError: ``bad_type``: the name is malformed, or a definition is not known.
    """
    split_type(type_name, "action")
    known = types.definitions
    try:
        interface = known.interface(type_name, "action")
        derived = DerivedDefinitions(interface, known)

        def service(part: str) -> ServiceWire:
            name = type_name + part
            request, response = (types.get(f"{name}_{end}") for end in ("Request", "Response"))
            hashed = type_hash(derived.get(name), derived)
            return ServiceWire(name, hashed, request.decode, response.decode)

        result = interface.parts["result"]
        cdr = ActionCdr(
            type_name,
            Realignment(result, known),
            lambda: types.get(result.name).encode({}, 0),
        )
        return ActionWire(
            cdr,
            service(SEND_GOAL),
            service(GET_RESULT),
            service_wire(types, CANCEL),
            types.get(type_name + FEEDBACK_MESSAGE).decode,
        )
    except (UnknownTypeError, DefinitionError) as error:
        raise RosError("bad_type", str(error)) from error

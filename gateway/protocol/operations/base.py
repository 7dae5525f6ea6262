# SPDX-License-Identifier: Apache-2.0
"""The common base of all operations."""

from typing import Annotated, Any, ClassVar, Final

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

# rosbridge clients build ids from a topic and a counter, or a UUID
MAX_ID_CHARACTERS: Final = 256
Id = Annotated[str, Field(max_length=MAX_ID_CHARACTERS)] | int

# A quarter of an hour: JSON can write rates so small that the time between two is infinite.
MIN_RATE_HZ: Final = 0.001
Seconds = Annotated[float, Field(ge=0, le=1e9)]


def _without_zero(value: Any) -> Any:
    return None if type(value) is int and value == 0 else value


# An outgoing message longer than this, in characters, is sent in pieces. Below 64 the members
# around a piece would be most of the bytes; some clients send 0 for no fragments.
FragmentSize = Annotated[Annotated[int, Field(ge=64)] | None, BeforeValidator(_without_zero)]


class OperationPart(BaseModel):
    """An object within an operation; unknown keys are refused.

    A key whose value is null counts as absent, because serialisers such as System.Text.Json write
    keys that were never set. In a field of type `Any`, null is a value.
    """

    # a number of an operation itself is finite; messages in fields of type `Any` may hold others
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _without_nulls(cls, values: Any) -> Any:
        if not isinstance(values, dict) or None not in values.values():
            return values
        return {
            name: value for name, value in values.items() if value is not None or cls._is_any(name)
        }

    @classmethod
    def _is_any(cls, name: str) -> bool:
        field = cls.model_fields.get(name)
        return field is not None and field.annotation is Any


class Operation(OperationPart):
    """An operation: its name, and an id that answers carry back."""

    model_config = ConfigDict(extra="ignore")

    op: ClassVar[str]
    # False for what a client has anyway, or what is checked later; of all others the router's
    # `permission_checks` knows the permission, or refuses them to roles that have bounds
    needs_permission: ClassVar[bool] = True
    id: Id | None = None

# SPDX-License-Identifier: Apache-2.0
"""The common base of all operations."""

from typing import Annotated, Any, ClassVar, Final

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError
from typing_extensions import Self

from gateway.codec.error_text import hint
from gateway.core.requests import AnyRequest
from gateway.fronts.rosbridge.own_requests import OwnRequest

# rosbridge clients build ids from a topic and a counter, or a UUID
MAX_ID_CHARACTERS: Final = 256
Id = Annotated[str, Field(max_length=MAX_ID_CHARACTERS)] | int

Seconds = Annotated[float, Field(ge=0, le=1e9)]

UNKNOWN_MEMBER: Final = "unknown_member"  # a type of error next to pydantic's own


def _without_zero(value: Any) -> Any:
    return None if type(value) is int and value == 0 else value


# An outgoing message longer than this, in characters, is sent in pieces. Below 64 the members
# around a piece would be most of the bytes. Some clients send 0 for no fragments.
FragmentSize = Annotated[Annotated[int, Field(ge=64)] | None, BeforeValidator(_without_zero)]


class _Strict(BaseModel):
    # numbers of the operation are finite, messages in fields of type `Any` may have others
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


class OperationPart(_Strict):
    """An object within an operation. Unknown keys are refused, and a null counts as absent."""

    @model_validator(mode="before")
    @classmethod
    def _take_members(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        values = _without_nulls(cls, values)
        fields = cls.model_fields
        unknown = next((name for name in values if name not in fields), None)
        if unknown is not None and cls.model_config["extra"] == "forbid":
            context = {"name": unknown, "hint": hint(unknown, fields, given=values)}
            raise PydanticCustomError(UNKNOWN_MEMBER, "{name}: unknown{hint}", context)
        return values


class Operation(_Strict):
    """An operation: its name, and an id that answers carry back."""

    model_config = ConfigDict(extra="ignore")

    op: ClassVar[str]
    # with the same fields, unless `request` says else
    makes: ClassVar[type[AnyRequest | OwnRequest]]
    id: Id | None = None

    @classmethod
    def read(cls, values: dict[str, Any]) -> Self:
        """Return the operation with these members, of which null counts as absent.

        A `publish` takes 1.1 us. With `model_validate` and the validator of a part it takes 1.6.

        Raises:
            ValidationError: it is malformed.
        """
        validator = cls.__pydantic_validator__
        operation: Self = validator.validate_python(_without_nulls(cls, values))
        return operation

    def request(self) -> AnyRequest | OwnRequest:
        """Return what the core, or this front, is asked to do."""
        request = object.__new__(self.makes)
        # Its constructor would set one field after the other, which takes 1 us of a `publish`.
        request.__dict__.update(self.__dict__)
        return request


def _without_nulls(model: type[BaseModel], values: dict[str, Any]) -> dict[str, Any]:
    """Leave out the keys whose value is null.

    Serialisers such as System.Text.Json write keys that were never set. In a field of type `Any`,
    null is a value.
    """
    if None not in values.values():
        return values
    fields = model.model_fields
    return {
        name: value
        for name, value in values.items()
        if value is not None or (name in fields and fields[name].annotation is Any)
    }

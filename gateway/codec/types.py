# SPDX-License-Identifier: Apache-2.0
"""The types of this machine, each message with its codecs, made when first needed."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache, partial
from typing import Any, Final, TypeVar, cast

from gateway.codec.cdr import (
    Decoder,
    Encoder,
    Octets,
    SlicedDecoder,
    SlicedTranscoder,
    Transcoder,
    compile_decoder,
    compile_encoder,
    compile_sliced_decoder,
    compile_sliced_transcoder,
    compile_transcoder,
)
from gateway.codec.cdr.layout import select
from gateway.codec.cdr.misfits import MISFITS, TooManyFieldsError
from gateway.codec.error_text import CodecError, truncate
from gateway.codec.validation import InvalidValueError, explain_misfit
from schemas.build import json_schema
from schemas.definition import PRIMITIVES, STRINGS, Definition, DefinitionError, FieldType
from schemas.derived import hashed
from schemas.generate.json_schemas import Schema, interface_schema
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.interface import Interface, InterfaceKind
from schemas.json_forms import Clock

# Codecs of selected fields that stay compiled per type. Clients share a few, and compiling takes
# milliseconds, tens of them for the largest types. A client that keeps inventing selections must
# not fill the memory.
MAX_DECODERS: Final = 32
# Elements of an array from which on it makes its message large.
LARGE_ARRAY: Final = 4096

_compile_raw: Final = partial(compile_decoder, octets="raw")


class MessageType:
    """One message type, or one part of a service or an action: definition and codecs."""

    def __init__(self, closure: Sequence[Definition], types: "Types") -> None:
        self.closure = closure  # itself last, after all that it nests
        self.definition = definition = closure[-1]
        self.name = definition.name
        self._definitions = types.definitions
        self._types = types
        self._compiled = lru_cache(MAX_DECODERS)(self._compile)

    @cached_property
    def decode(self) -> Decoder:
        """Turn CDR into values for `gateway.codec.json.dumps`. See `compile_decoder`."""
        return compile_decoder(self.definition, self._definitions)

    @cached_property
    def compiled_encoder(self) -> Encoder:
        """The encoder without words for a client. See `compile_encoder`."""
        return compile_encoder(self.definition, self._definitions)

    def encode(self, value: object, now_ns: Clock, root: str = "msg") -> bytes:
        """Turn decoded JSON into CDR. *now_ns* is, or returns, the time of a ``"now"`` in it.

        Raises:
            InvalidValueError: the value does not fit. Paths in the text begin with *root*.
            TooManyFieldsError: it takes too much. See `compile_encoder`.
        """
        try:
            return self.compiled_encoder(value, now_ns)
        except TooManyFieldsError as error:
            raise TooManyFieldsError(f"{root}: {error}") from None
        except MISFITS as error:
            misfit = explain_misfit(
                value, self.definition, self._definitions, self._types.encoder_of, now_ns, root
            )
            if misfit is None:  # unreachable, unless the encoder has a bug
                raise CodecError(f"{root}: {self.definition.title} cannot be encoded") from error
            raise misfit from None

    @cached_property
    def may_be_large(self) -> bool:
        """True if an array in it may have `LARGE_ARRAY` numbers, or messages of numbers alone.

        Pictures, clouds and maps are such. Odometry, transforms and texts are not.
        """
        numbers = set(PRIMITIVES - STRINGS)  # and the messages that hold nothing else
        for definition in self.closure:
            types = [field.type for field in definition.fields]
            if any(each.base in numbers and _most(each) >= LARGE_ARRAY for each in types):
                return True
            if all(each.base in numbers and not each.is_sequence for each in types):
                numbers.add(definition.name)
        return False

    @cached_property
    def holds_elements(self) -> bool:
        """True if it has an array of messages or of texts, or one that it nests has."""
        types = [field.type for definition in self.closure for field in definition.fields]
        return any(each.is_array and each.base not in PRIMITIVES - STRINGS for each in types)

    def json_schema(self) -> Schema:
        """Return the JSON Schema of the messages on the wire, nested types included."""
        return json_schema(self.name, self._definitions)

    def check_fields(self, fields: tuple[str, ...] | None) -> None:
        """Check the fields for `decoder` and `transcoder`, without compiling anything.

        Raises:
            FieldError: a name in *fields* is not a field.
        """
        select(self.definition, self._definitions, fields or ())

    def decoder(self, fields: tuple[str, ...] | None = None, octets: Octets = "base64") -> Decoder:
        """Return a decoder of some fields, or with octet arrays untouched.

        Raises:
            FieldError: a name in *fields* is not a field. So do the three below.
        """
        if not fields and octets == "base64":
            return self.decode
        compile_it = _compile_raw if octets == "raw" else compile_decoder
        return cast("Decoder", self._compiled(compile_it, _sorted(fields)))

    def transcoder(self, fields: tuple[str, ...] | None = None) -> Transcoder:
        """Return a function from CDR to CBOR, of some fields. See `compile_transcoder`."""
        return cast("Transcoder", self._compiled(compile_transcoder, _sorted(fields)))

    def sliced_decoder(self, fields: tuple[str, ...] | None = None) -> SlicedDecoder:
        """Return a decoder for large messages. See `compile_sliced_decoder`."""
        return cast("SlicedDecoder", self._compiled(compile_sliced_decoder, _sorted(fields)))

    def sliced_transcoder(self, fields: tuple[str, ...] | None = None) -> SlicedTranscoder:
        """Return a transcoder for large messages. See `compile_sliced_transcoder`."""
        return cast("SlicedTranscoder", self._compiled(compile_sliced_transcoder, _sorted(fields)))

    def _compile(self, compile_codec: Callable[..., Any], wanted: tuple[str, ...]) -> Any:
        return compile_codec(self.definition, self._definitions, wanted)

    def named(self, values: Sequence[object], root: str = "args") -> dict[str, object]:
        """Turn the values of the first fields, in order, into the object that `encode` takes.

        Raises:
            InvalidValueError: there are more values than fields.
        """
        names = [field.name for field in self.definition.fields]
        if len(values) > len(names):
            raise InvalidValueError(root, f"{root}: {self._too_many(len(values), names)}")
        return dict(zip(names, values, strict=False))

    def _too_many(self, count: int, names: list[str]) -> str:
        title = self.definition.title
        if not names:
            return f"expected no elements, got {count}: {title} is empty"
        limit = "1 element" if len(names) == 1 else f"{len(names)} elements"
        return f"expected at most {limit}, got {count}: {title} has {truncate(', '.join(names))}"


@dataclass(frozen=True, slots=True, eq=False)
class _InterfaceType:
    """One type of services or actions: its definition, and in further fields those of its parts."""

    definition: Interface

    @property
    def name(self) -> str:
        """The full name, such as ``pkg/srv/Name``."""
        return self.definition.name

    def json_schema(self) -> Schema:
        """Return the JSON Schema of an object with a member for each part."""
        parts = [field.name for field in fields(self)[1:]]
        schemas: dict[Any, Schema] = {part: getattr(self, part).json_schema() for part in parts}
        return interface_schema(self.definition, schemas)


@dataclass(frozen=True, slots=True, eq=False)
class ServiceType(_InterfaceType):
    """One service type and the types of its two messages."""

    request: MessageType
    response: MessageType


@dataclass(frozen=True, slots=True, eq=False)
class ActionType(_InterfaceType):
    """One action type and the types of its three messages."""

    goal: MessageType
    result: MessageType
    feedback: MessageType


_Interface = TypeVar("_Interface", ServiceType, ActionType)


class Types:
    """The types that some definitions describe. Not safe across threads.

    A type whose definition has changed, or that of one that it nests, is another object from then
    on. A holder of the former one still reads messages as they were.
    """

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self.definitions = definitions
        self._revision = definitions.revision
        self._messages: dict[str, MessageType] = {}
        self._interfaces: dict[tuple[InterfaceKind, str], Any] = {}

    def get(self, name: str) -> MessageType:
        """Return the message type ``pkg/msg/Name``, or a part such as ``pkg/srv/Name_Request``.

        Raises:
            UnknownTypeError: *name* is not such a name, or the type or one that it nests is not
                installed.
            DefinitionError: a definition cannot be parsed, or nests itself.
        """
        self._follow()
        known = self._messages.get(name)
        if known is None:
            # Read nested types now: where the codecs are compiled, nobody expects an error.
            known = MessageType(self.definitions.closure([name]), self)
            self._messages[name] = known
        return known

    def encoder_of(self, name: str) -> Encoder:
        """Return the encoder of a message type, whose errors are not for clients.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        return self.get(name).compiled_encoder

    def service(self, name: str) -> ServiceType:
        """Return the service type ``pkg/srv/Name``.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        return self._interface(name, "srv", ServiceType)

    def action(self, name: str) -> ActionType:
        """Return the action type ``pkg/action/Name``. It raises as `service` does."""
        return self._interface(name, "action", ActionType)

    def _follow(self) -> None:
        """Forget the types whose definitions have changed."""
        if self._revision == self.definitions.revision:
            return
        self._revision = self.definitions.revision
        self._interfaces.clear()
        for name, known in list(self._messages.items()):
            try:
                is_same = self.definitions.closure([name]) == known.closure
            except (UnknownTypeError, DefinitionError):
                is_same = False
            if not is_same:
                del self._messages[name]

    def _interface(self, name: str, kind: InterfaceKind, make: type[_Interface]) -> _Interface:
        self._follow()
        known = self._interfaces.get((kind, name))
        if known is None:
            definition = hashed(self.definitions.interface(name, kind), self.definitions)
            parts = [self.get(part.name) for part in definition.parts.values()]
            known = self._interfaces[kind, name] = make(definition, *parts)
        return cast("_Interface", known)


def _most(field: FieldType) -> float:
    """Return how many elements a field may have."""
    if field.is_sequence:
        return math.inf if field.bound is None else field.bound
    return field.length or 1


def _sorted(fields: tuple[str, ...] | None) -> tuple[str, ...]:
    return tuple(sorted(set(fields or ())))

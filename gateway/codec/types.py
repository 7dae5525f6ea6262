# SPDX-License-Identifier: Apache-2.0
"""The message types of this machine, each with its codecs, made when first needed."""

from collections import OrderedDict
from functools import cached_property
from typing import Final

from pydantic import ValidationError

from gateway.codec.cdr import Decoder, Encoder, Octets, compile_decoder, compile_encoder
from gateway.codec.validation import invalid_value
from schemas.build import Models
from schemas.definition import Definition
from schemas.generate.json_schemas import Schema
from schemas.installed import InstalledDefinitions
from schemas.message import Message

# Selections of fields that stay compiled per type. Clients share a few, and compiling takes a
# millisecond; a client that keeps making up new ones must not fill the memory.
MAX_DECODERS: Final = 32


class MessageType:
    """One message type: its definition, its model and its codecs."""

    def __init__(
        self, definition: Definition, definitions: InstalledDefinitions, models: Models
    ) -> None:
        self.name = definition.name
        self.definition = definition
        self._definitions = definitions
        self._models = models
        self._decoders: OrderedDict[tuple[tuple[str, ...], Octets], Decoder] = OrderedDict()

    @cached_property
    def model(self) -> type[Message]:
        """The pydantic model of what clients send."""
        return self._models.get(self.name)

    @cached_property
    def decode(self) -> Decoder:
        """Turn CDR into values for `gateway.codec.json.dumps`; see `compile_decoder`."""
        return compile_decoder(self.definition, self._definitions)

    @cached_property
    def encode(self) -> Encoder:
        """Turn a validated message into CDR; see `compile_encoder`."""
        return compile_encoder(self.definition, self._definitions)

    def json_schema(self) -> Schema:
        """Return the JSON Schema of what the wire carries, nested types included."""
        return self._models.json_schema(self.name)

    def decoder(self, fields: tuple[str, ...] | None = None, octets: Octets = "base64") -> Decoder:
        """Return a decoder of some fields, or with octet arrays untouched.

        Raises:
            FieldError: *fields* names what is no field.
        """
        if not fields and octets == "base64":
            return self.decode
        key = (tuple(sorted(set(fields or ()))), octets)
        known = self._decoders.get(key)
        if known is None:
            known = compile_decoder(self.definition, self._definitions, key[0], octets=octets)
            if len(self._decoders) >= MAX_DECODERS:
                self._decoders.popitem(last=False)
            self._decoders[key] = known
        self._decoders.move_to_end(key)
        return known

    def validate(self, value: object, now_ns: int, root: str = "msg") -> Message:
        """Turn decoded JSON into a message; *now_ns* is what its ``"now"`` stands for.

        Raises:
            InvalidValueError: it is no such message; paths in the text begin with *root*.
        """
        try:
            return self.model.model_validate(value, context={"now_ns": now_ns})
        except ValidationError as error:
            raise invalid_value(error, self.definition, self._definitions, root) from None


class Types:
    """The message types that some definitions describe. Not safe across threads."""

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._models = Models(definitions)
        self._known: dict[str, MessageType] = {}

    def get(self, name: str) -> MessageType:
        """Return the type ``pkg/msg/Name``.

        Raises:
            UnknownTypeError: it is not installed, or *name* is no such name.
            DefinitionError: its definition cannot be parsed.
        """
        known = self._known.get(name)
        if known is None:
            definition = self._definitions.get(name)
            known = MessageType(definition, self._definitions, self._models)
            self._known[name] = known
        return known

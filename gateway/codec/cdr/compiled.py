# SPDX-License-Identifier: Apache-2.0
"""Functions from CDR to values or CBOR, compiled for a type and some of its fields.

Each `compile_` raises what `compile_decoder` raises.
"""

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import TypeAlias

from gateway.codec.cdr.decoder import compile_for
from gateway.codec.cdr.layout import Cdr
from gateway.codec.cdr.target import Octets, SlicedValues, Values
from gateway.codec.cdr.to_cbor import Cbor, SlicedCbor
from gateway.codec.chunks import Chunk
from gateway.codec.json_slices import Write
from schemas.definition import Definition
from schemas.installed import InstalledDefinitions

Decoder: TypeAlias = Callable[[Cdr], dict[str, object]]
Transcoder: TypeAlias = Callable[[Cdr], bytes]
SlicedDecoder: TypeAlias = Callable[[Cdr, Write], Generator[bytes, None, dict[str, object]]]
SlicedTranscoder: TypeAlias = Callable[[Cdr], Generator[bytes, None, Sequence[Chunk]]]


def compile_decoder(
    definition: Definition,
    definitions: InstalledDefinitions,
    fields: Iterable[str] | None = None,
    *,
    octets: Octets = "base64",
) -> Decoder:
    """Compile a function from CDR, encapsulation header included, to a dict.

    The dict has the fields in the order of the definition. Messages are dicts. Arrays are
    lists, tuples or numpy views on the bytes, octet arrays are base64 (or, ``raw``,
    memoryviews). A float32 is a `numpy.float32`, non-finite floats are unchanged. A string ends
    at its first NUL, and invalid UTF-8 is replaced: one sloppy node must not silence a topic.

    With *fields* (dotted paths) the dict holds only these, and reading stops after the last one.

    The function raises only `CodecError`, with the offset, if the bytes are not such a message.
    It allocates in proportion to the bytes given, whatever counts they state.

    Raises:
        FieldError: a name in *fields* is not a field.
        UnknownTypeError: a nested type is not installed.
    """
    note = ", octets raw" if octets == "raw" else ""
    return compile_for(definition, definitions, fields, Values(octets), "CDR decoder", note)


def compile_transcoder(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str] | None = None
) -> Transcoder:
    """Compile a function from CDR, encapsulation header included, to CBOR: a map.

    As in rosbridge, octet arrays are byte strings, and all other arrays of numbers are
    little-endian typed arrays (RFC 8746), short and empty ones too. Every float is a float64.
    *fields* and the errors of the function are those of `compile_decoder`.
    """
    return compile_for(definition, definitions, fields, Cbor(), "CDR to CBOR transcoder", "")


def compile_sliced_decoder(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str] | None = None
) -> SlicedDecoder:
    """Compile a decoder for large messages, as a generator, which the caller can pause.

    It yields empty pieces and returns the dict, for `json_slices`. Octet arrays are views. Arrays
    of messages or strings are JSON already, written by a function that it is given.
    """
    note = ", in slices"
    return compile_for(definition, definitions, fields, SlicedValues(), "CDR decoder", note)


def compile_sliced_transcoder(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str] | None = None
) -> SlicedTranscoder:
    """Compile a transcoder for large messages, as such a generator.

    It returns the item in pieces. Large arrays are not copied.
    """
    note = ", in slices"
    return compile_for(
        definition, definitions, fields, SlicedCbor(), "CDR to CBOR transcoder", note
    )

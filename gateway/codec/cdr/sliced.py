# SPDX-License-Identifier: Apache-2.0
"""CDR of large messages to values or CBOR, by generators, which the caller can pause."""

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import TypeAlias

from gateway.codec.cdr.decoder import compile_for
from gateway.codec.cdr.layout import Cdr
from gateway.codec.cdr.target import SlicedValues
from gateway.codec.cdr.to_cbor import SlicedCbor
from gateway.codec.json_slices import Write
from gateway.codec.pieces import Piece
from schemas.definition import Definition
from schemas.installed import InstalledDefinitions

SlicedDecoder: TypeAlias = Callable[[Cdr, Write], Generator[bytes, None, dict[str, object]]]
SlicedTranscoder: TypeAlias = Callable[[Cdr], Generator[bytes, None, Sequence[Piece]]]


def compile_sliced_decoder(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str] | None = None
) -> SlicedDecoder:
    """Compile a decoder for large messages, as a generator, which the caller can pause.

    It yields empty pieces and returns the dict, for `json_slices`. Octet arrays are views. Arrays
    of messages or strings are JSON already, written by a function that it is given.

    Raises:
        FieldError: a name in *fields* is not a field.
        UnknownTypeError: a nested type is not installed.
    """
    note = ", in slices"
    return compile_for(definition, definitions, fields, SlicedValues(), "CDR decoder", note)


def compile_sliced_transcoder(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str] | None = None
) -> SlicedTranscoder:
    """Compile a transcoder for large messages, as such a generator.

    It returns the item in pieces. Large arrays are not copied.

    Raises:
        FieldError: a name in *fields* is not a field.
        UnknownTypeError: a nested type is not installed.
    """
    note = ", in slices"
    return compile_for(
        definition, definitions, fields, SlicedCbor(), "CDR to CBOR transcoder", note
    )

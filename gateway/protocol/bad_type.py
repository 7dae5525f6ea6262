# SPDX-License-Identifier: Apache-2.0
"""The error for a type that cannot be used."""

from gateway.codec.error_text import truncate
from gateway.protocol.errors import ProtocolError
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.table import TypeNameError


def bad_type(
    error: UnknownTypeError | DefinitionError | TypeNameError,
    definitions: InstalledDefinitions,
) -> ProtocolError:
    """Return ``bad_type``, with the name that was probably meant if a type is not installed."""
    near = definitions.nearest(error.name) if isinstance(error, UnknownTypeError) else None
    hint = f"; did you mean {near}?" if near else ""
    return ProtocolError("bad_type", f"type: {truncate(str(error))}{hint}")

# SPDX-License-Identifier: Apache-2.0
"""The error for a type that cannot be used."""

from typing import Final

from gateway.codec.error_text import suggestion, truncate
from gateway.core.errors import ProtocolError
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.table import TypeNameError

# It has the place in a file of this machine, what was expected there and a way out.
MAX_DEFINITION_ERROR: Final = 512
_MISSING: Final = ": install its package, or name a folder that has the definition in types.paths"


def bad_type(
    error: UnknownTypeError | DefinitionError | TypeNameError,
    definitions: InstalledDefinitions,
) -> ProtocolError:
    """Return ``bad_type``, with the name that was probably meant by one that is wrong."""
    match error:
        case UnknownTypeError():
            near = definitions.nearest(error.name)
        case TypeNameError(requested=str(text)) if text:
            near = definitions.meant(text, error.kind)
        case _:
            near = None
    hint = suggestion(near)
    is_missing = isinstance(error, UnknownTypeError) and error.is_missing
    if is_missing and not hint:
        hint = _MISSING
    is_own_text = isinstance(error, DefinitionError) or is_missing
    text = str(error)[:MAX_DEFINITION_ERROR] if is_own_text else truncate(str(error))
    return ProtocolError("bad_type", f"type: {text}{hint}")

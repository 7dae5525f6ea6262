# SPDX-License-Identifier: Apache-2.0
"""JSON Schemas for clients: a file for each type, or one with all of them."""

from schemas.generate.json_schemas import bundle, catalogue_schema, file_name, text_of
from schemas.generate.request import GenerateRequest


def files(request: GenerateRequest) -> dict[str, str]:
    """Return the schema of each type, by the paths of `file_name`."""
    return {
        str(file_name(name)): text_of(catalogue_schema(request.catalogue, name), request.generated)
        for name in request.names
    }


def text(request: GenerateRequest) -> str:
    """Return the schema of the type or, of several, one that has them in its ``$defs``."""
    schemas = [catalogue_schema(request.catalogue, name) for name in request.names]
    whole = schemas[0] if len(schemas) == 1 else bundle(schemas)
    return text_of(whole, request.generated)

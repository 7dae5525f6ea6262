# SPDX-License-Identifier: Apache-2.0
"""Error texts for values that clients sent."""

import json
from collections.abc import Mapping
from typing import Final

MAX_ECHO: Final = 128  # characters of a client's own text that come back; logs stay readable

# by pydantic's name of the error
EXPECTED: Final = {
    "bool_type": "true or false",
    "dict_type": "an object",
    "finite_number": "a finite number",
    "float_type": "a number",
    "int_type": "an integer",
    "list_type": "an array",
    "model_attributes_type": "an object",
    "model_type": "an object",
    "string_type": "a string",
    "tuple_type": "an array",
}


def kind(value: object) -> str:
    """Name the kind of a value of JSON or CBOR; of numbers and booleans, the value."""
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case int() | float():
            return truncate(json.dumps(value))
        case str():
            return "a string"
        case bytes():
            return "a byte string"
        case list() | tuple():
            return "an array"
        case Mapping():
            return "an object"
    return type(value).__name__


def truncate(text: str) -> str:
    """Shorten a client's own text for an error text."""
    return text if len(text) <= MAX_ECHO else f"{text[: MAX_ECHO - 3]}..."

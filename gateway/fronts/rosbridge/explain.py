# SPDX-License-Identifier: Apache-2.0
"""Error texts for malformed operations."""

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from gateway.codec.error_text import EXPECTED, kind, truncate
from gateway.fronts.rosbridge.operations.base import UNKNOWN_MEMBER


def explain(error: ValidationError) -> str:
    """Describe the first wrong field: ``throttle_rate: expected a number, ...``."""
    details = [_placed(detail) for detail in error.errors(include_url=False)]
    # A duration is a number, an object or "infinite": who sent an object meant that one.
    same = [each for each in details if each["loc"][:2] == details[0]["loc"][:2]]
    first = next((each for each in same if len(each["loc"]) > _DURATION), details[0])
    name = _name(first)
    # A field that may be of several kinds has one error for each.
    same_field = [detail for detail in details if _name(detail) == name]
    expected = list(dict.fromkeys(_expected(detail) for detail in same_field))
    if first["type"] == "missing":
        return f"{name}: missing"
    if first["type"] == UNKNOWN_MEMBER:
        return f"{name}: unknown{first['ctx']['hint']}"
    if first["type"] == "value_error":
        return str(first["ctx"]["error"])
    if first["type"].startswith("model") and not first["loc"]:
        return "expected an object"
    return f"{name}: expected {' or '.join(expected)}, got {_value(first)}"


def _placed(detail: ErrorDetails) -> ErrorDetails:
    """Return an error with an unknown member behind its object in the path, as pydantic has it."""
    if detail["type"] != UNKNOWN_MEMBER:
        return detail
    placed = detail.copy()
    placed["loc"] = (*detail["loc"], detail["ctx"]["name"])
    return placed


def _name(detail: ErrorDetails) -> str:
    """Return the path to the field, without the tags that unions add to it."""
    first, *rest = detail["loc"]
    parts = [first]
    if first in _OBJECTS:
        parts += rest[:1]
        parts += [part for part in rest[_DURATION - 1 :] if isinstance(part, str)]
    parts += [part for part in rest if isinstance(part, int)]  # which element
    return truncate(".".join(map(str, parts)))


# Operations nest no deeper, except for the durations of `qos`.
_OBJECTS = frozenset({"qos", "image", "cloud", "time", "timeout"})
_DURATION = 3  # parts of the path to one, behind which its own members are


def _expected(detail: ErrorDetails) -> str:
    kind_of_error = detail["type"]
    context = detail.get("ctx", {})
    if kind_of_error in EXPECTED:
        return EXPECTED[kind_of_error]
    match kind_of_error:
        case "literal_error":
            return str(context["expected"])
        case "greater_than_equal" | "greater_than" | "less_than_equal" | "less_than":
            sign = {"ge": "at least", "gt": "more than", "le": "at most", "lt": "less than"}
            name, limit = next(iter(context.items()))
            return f"{sign[name]} {limit:g}"
        case "string_too_long":
            return f"at most {context['max_length']} characters"
        case "too_long":
            return f"at most {_items(context['max_length'])}"
        case "too_short":
            return f"at least {_items(context['min_length'])}"
    return detail["msg"][:1].lower() + detail["msg"][1:]


def _items(count: int) -> str:
    return f"{count} item" if count == 1 else f"{count} items"


def _value(detail: ErrorDetails) -> str:
    value = detail["input"]
    if detail["type"] in {"too_short", "too_long"}:
        return str(len(value))
    if isinstance(value, str) and detail["type"] != "string_too_long":
        return f"{truncate(value)!r}"
    return kind(value)

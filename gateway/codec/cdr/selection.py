# SPDX-License-Identifier: Apache-2.0
"""A selection of the fields of a message, as a tree."""

from collections.abc import Iterable
from typing import TypeAlias

from gateway.codec.errors import FieldError
from schemas.definition import Definition, Field
from schemas.installed import InstalledDefinitions

# The selected fields by name, each with the selection within it. None selects everything.
Selection: TypeAlias = "dict[str, Selection] | None"


def select(
    definition: Definition, definitions: InstalledDefinitions, fields: Iterable[str]
) -> Selection:
    """Turn dotted paths such as ``pose.pose.position`` into a tree. No path means everything.

    A path through an array of messages applies to each of its elements.

    Raises:
        FieldError: a path names no field.
    """
    tree: dict[str, Selection] = {}
    for path in fields:
        _add(tree, definition, definitions, path)
    return tree or None


def _add(
    tree: dict[str, Selection], definition: Definition, definitions: InstalledDefinitions, path: str
) -> None:
    *parents, last = path.split(".")
    for depth, name in enumerate(parents, start=1):
        field = _field(definition, name, path)
        if field.type.is_primitive:
            reached = ".".join(parents[:depth])
            raise FieldError(f"unknown field {path}: {reached} is {field.type}, it has no fields")
        definition = definitions.get(field.type.base)
        below = tree.setdefault(name, {})
        if below is None:  # an earlier path selects all of it, but this one must also exist
            below = {}
        tree = below
    _field(definition, last, path)
    tree[last] = None


def _field(definition: Definition, name: str, path: str) -> Field:
    for field in definition.fields:
        if field.name == name:
            return field
    names = ", ".join(field.name for field in definition.fields) or "no fields"
    raise FieldError(f"unknown field {path}: {definition.title} has {names}")

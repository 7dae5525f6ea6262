# SPDX-License-Identifier: Apache-2.0
"""Definitions of types for relays. The uplink has them for all nodes of the robot."""

from collections.abc import Mapping
from typing import Any

from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.type_hash import type_description, type_hash


def description_of(definitions: InstalledDefinitions, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the response to a request of type_description_interfaces/srv/GetTypeDescription."""
    name, wanted = asked["type_name"], asked["type_hash"]
    try:
        definition = definitions.get(name)
        known = type_hash(definition, definitions)
        closure = definitions.closure([name])
    except (UnknownTypeError, DefinitionError) as error:
        return {"successful": False, "failure_reason": str(error)}
    if wanted not in {"", known}:
        reason = f"the robot has another definition of {name}"
        return {"successful": False, "failure_reason": reason}
    sources = [
        {"type_name": each.name, "encoding": "msg", "raw_file_contents": each.text}
        for each in closure
    ]
    return {
        "successful": True,
        "type_description": type_description(definition, definitions),
        "type_sources": sources if asked["include_type_sources"] else [],
    }

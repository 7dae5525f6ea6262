# SPDX-License-Identifier: Apache-2.0
"""Checking a node's definition of a type: it is believed if it has the type's hash."""

from collections.abc import Container, Mapping
from typing import Final

from schemas.definition import Definition, DefinitionError
from schemas.installed import (
    MAX_TOLD,
    InstalledDefinitions,
    UnknownTypeError,
    is_message_name,
)
from schemas.type_hash import computed_type_hash

MAX_TOLD_CHARACTERS: Final = 16 * 1024 * 1024  # of all texts. Those of a robot have about 100,000
_SHOWN: Final = 100  # characters of a name that a node sent


def believed(
    definitions: InstalledDefinitions,
    name: str,
    told: Mapping[str, Definition],
    type_hash: str,
    in_use: Mapping[str, str],
) -> dict[str, Definition]:
    """Return the definition of a type that a node has told, and those of the types that it nests.

    Those that *definitions* has already are left out. Installed packages keep theirs. *told* is as
    `described_definitions` returns it. *type_hash* is that of the type in the ROS graph. *in_use*
    has the hashes of types that have to stay as they are.

    Raises:
        DefinitionError: the definition has another hash, or contradicts others, or is too much.
        UnknownTypeError: the definition of a type that it nests was not told.
    """
    for each in told:
        if not is_message_name(each):
            raise DefinitionError(f"{each[:_SHOWN]!r} is not a valid message type name")
    offered = {each: told[each] for each in told if not definitions.is_installed(each)}
    trial = definitions.with_told(offered)
    closure = trial.closure([name])
    if computed_type_hash(trial.get(name), trial) != type_hash:
        raise DefinitionError(_contradiction(definitions, told, name))
    new = {
        each.name: each
        for each in closure
        if each.name in offered and not _is_known(each, trial, definitions)
    }
    _check_room({**definitions.told, **new})
    changed = new.keys() & definitions.told.keys()
    for other in in_use.keys() - {name} if changed else ():
        if _nests(other, changed, definitions) and _hash(other, trial) != in_use[other]:
            raise DefinitionError(f"{name} nests other definitions than {other}, which is in use")
    return new


def _is_known(
    told: Definition, trial: InstalledDefinitions, definitions: InstalledDefinitions
) -> bool:
    return _hash(told.name, definitions) == _hash(told.name, trial)


def _nests(name: str, others: Container[str], definitions: InstalledDefinitions) -> bool:
    return any(each.name in others for each in definitions.closure([name]))


def _hash(name: str, definitions: InstalledDefinitions) -> str | None:
    try:
        return computed_type_hash(definitions.get(name), definitions)
    except (UnknownTypeError, DefinitionError):
        return None


def _contradiction(
    definitions: InstalledDefinitions, told: Mapping[str, Definition], name: str
) -> str:
    alone = definitions.with_told(told)
    for each in told:
        if definitions.is_installed(each) and _hash(each, alone) != _hash(each, definitions):
            return f"{name} nests another {each} than the one that is installed here"
    return f"the definition of {name} has another hash than the type"


def _check_room(told: Mapping[str, Definition]) -> None:
    size = sum(len(each.text) for each in told.values())
    if len(told) > MAX_TOLD or size > MAX_TOLD_CHARACTERS:
        text = f"at most {MAX_TOLD} definitions of nodes, {MAX_TOLD_CHARACTERS} characters in all"
        raise DefinitionError(f"{text}; restart the gateway")

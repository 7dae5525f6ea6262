# SPDX-License-Identifier: Apache-2.0
"""A node's description of a type: accepted if code can be made of it, or refused."""

import contextlib
from typing import Any

from gateway.codec.cdr.misfits import TooManyFieldsError
from gateway.codec.json import dumps, loads
from gateway.codec.types import Types
from schemas.definition import Definition, DefinitionError
from schemas.definition_text import parse_definition
from schemas.described import described_definitions
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.learning import believed
from schemas.type_hash import computed_type_hash, individual_description
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check
from tests.fuzz.targets.idl import check_definition

NAME = "a_msgs/msg/A"
NAMES = (
    *(NAME, "a_msgs/msg/B", "a_msgs/msg/C", "std_msgs/msg/Header", "builtin_interfaces/msg/Time"),
    *("a_msgs/srv/A_Request", "A", "", "a_msgs/msg/A\n", "../msg/A", "a_msgs/msg/Größe", "x" * 300),
)
FIELDS = (
    *("x", "y", "stamp", "sec", "frame_id", "from", "x__y", "X", "_x", "", "x y", "x\nint8 z", "#"),
    *("structure_needs_at_least_one_member", "x" * 300, "ß", "x=1", "\u2028", "import os"),
)
TEXTS = (
    "",
    "bool x\n",
    "int32 x 5\nuint8 Y=1\n",
    "B b\n",
    "string<=3 x\n",
    "# only\n",
    "bool x x x",
)
ENCODINGS = ("msg", "idl", "srv", "implicit", "", "msg\0")
SIZES = (0, 1, 2, 3, 255, 65536, 2**31, 2**63, 2**64 - 1)
INSTALLED = InstalledDefinitions()


def run(data: bytes) -> None:
    choices = Choices(data)
    answer = {
        "type_description": {
            "type_description": individual(choices, NAME),
            "referenced_type_descriptions": [
                individual(choices, choices.pick(NAMES)) for _ in range(choices.below(5))
            ],
        },
        "type_sources": [source(choices) for _ in range(choices.below(3))],
    }
    definitions = INSTALLED.with_told({})
    try:
        told = described_definitions(answer)
        there = definitions.with_told(told)
        hashed = computed_type_hash(there.get(NAME), there)
        definitions.tell(believed(definitions, NAME, told, hashed, {}))
    except (DefinitionError, UnknownTypeError) as error:
        check(0 < len(str(error)) < 2000, "a long refusal", str(error)[:2000])
        check(not definitions.told, "refused and learned")
        return
    check_learned(definitions, hashed)


def check_learned(definitions: InstalledDefinitions, hashed: str) -> None:
    learned: list[Definition] = list(definitions.told.values())
    check(NAME in definitions.told, learned)
    check(computed_type_hash(definitions.get(NAME), definitions) == hashed, learned)
    found = Types(definitions).get(NAME)
    with contextlib.suppress(TooManyFieldsError):  # large arrays within arrays
        cdr = found.encode({}, 0)
        check(found.encode(loads(dumps(found.decode(cdr))), 0) == cdr, learned)
    for each in learned:
        check(not INSTALLED.is_installed(each.name), each)
        check_definition(each)
        again = parse_definition(each.name, each.text)
        check(individual_description(again) == individual_description(each), each)


def individual(choices: Choices, name: str) -> dict[str, Any]:
    return {
        "type_name": name,
        "fields": [
            {
                "name": choices.pick(FIELDS),
                "type": {
                    "type_id": choices.pick((1, 6, 15, 17, 21, 22, 49, 97, 145, choices.byte())),
                    "capacity": choices.pick(SIZES),
                    "string_capacity": choices.pick(SIZES),
                    "nested_type_name": choices.pick(NAMES),
                },
            }
            for _ in range(choices.below(4))
        ],
    }


def source(choices: Choices) -> dict[str, str]:
    return {
        "type_name": choices.pick(NAMES),
        "encoding": choices.pick(ENCODINGS),
        "raw_file_contents": choices.text() if choices.happens(128) else choices.pick(TEXTS),
    }


def corpus() -> list[bytes]:
    return [b"", bytes([2, 0, 1, 0, 0, 0, 1, 5, 0, 0, 0]), bytes([1, 0, 0, 0, 0, 1, 1, 1, 0, 2])]


TARGET = Target("what a node says of a type is safe to make code of, or refused", run, corpus)

# SPDX-License-Identifier: Apache-2.0
"""The REP-2011 hash."""

import dataclasses

from schemas.definition import parse_definition
from schemas.installed import InstalledDefinitions
from schemas.type_hash import computed_type_hash, type_hash


def test_the_computed_hash_is_the_installed_one_for_every_type():
    definitions = InstalledDefinitions()
    for name in definitions.names():
        definition = definitions.get(name)
        assert computed_type_hash(definition, definitions) == definition.type_hash, name


def test_the_computed_hash_is_the_installed_one_for_every_part_of_a_service_or_an_action():
    definitions = InstalledDefinitions()
    for name in definitions.names(kind="srv") + definitions.names(kind="action"):
        for part in definitions.interface(name).parts.values():
            assert computed_type_hash(part, definitions) == part.type_hash, part.name


def test_a_type_without_installed_hash_gets_the_computed_one():
    definitions = InstalledDefinitions()
    definition = definitions.get("geometry_msgs/msg/Twist")

    assert type_hash(dataclasses.replace(definition, type_hash=None), definitions) == (
        definition.type_hash
    )


def test_defaults_and_comments_do_not_change_the_hash():
    plain = parse_definition("some_msgs/msg/Thing", "int8 x")
    adorned = parse_definition("some_msgs/msg/Thing", "# words\nint8 ONE=1\nint8 x 5 # more")
    other = parse_definition("some_msgs/msg/Thing", "int8 y")
    definitions = InstalledDefinitions([])

    assert computed_type_hash(plain, definitions) == computed_type_hash(adorned, definitions)
    assert computed_type_hash(plain, definitions) != computed_type_hash(other, definitions)

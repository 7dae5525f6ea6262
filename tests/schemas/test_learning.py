# SPDX-License-Identifier: Apache-2.0
"""The types that are learned from nodes."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from schemas import learning
from schemas.definition import DefinitionError
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.learning import believed
from schemas.type_hash import computed_type_hash

LAMP, BULB, POLE = "my_msgs/msg/Lamp", "my_msgs/msg/Bulb", "my_msgs/msg/Pole"
POINT = "geometry_msgs/msg/Point"


@pytest.fixture
def definitions(tmp_path: Path) -> InstalledDefinitions:
    return InstalledDefinitions(None, [tmp_path])


def tell(
    definitions: InstalledDefinitions,
    name: str,
    texts: Mapping[str, str],
    in_use: Mapping[str, str] | None = None,
) -> str:
    """Learn a type as an honest node tells it. Return its hash."""
    told = {each: parse_definition(each, text) for each, text in texts.items()}
    there = definitions.with_told(told)  # as that node has them
    hashed = computed_type_hash(there.get(name), there)
    definitions.tell(believed(definitions, name, told, hashed, in_use or {}))
    return hashed


def test_a_type_and_those_that_it_nests_are_known_from_then_on(definitions: InstalledDefinitions):
    revision = definitions.revision
    assert LAMP not in definitions.names()
    tell(definitions, LAMP, {LAMP: "Bulb[] bulbs\n", BULB: "float32 power\n"})
    assert [each.name for each in definitions.closure([LAMP])] == [BULB, LAMP]
    assert {LAMP, BULB} <= set(definitions.names()) & set(definitions.all_names())
    assert definitions.revision > revision


def test_a_definition_with_another_hash_is_refused(definitions: InstalledDefinitions):
    told = {LAMP: parse_definition(LAMP, "bool on\n")}
    with pytest.raises(DefinitionError, match=f"the definition of {LAMP} has another hash"):
        believed(definitions, LAMP, told, "RIHS01_" + "0" * 64, {})
    assert definitions.told == {}


def test_installed_types_stay(definitions: InstalledDefinitions):
    tell(
        definitions,
        LAMP,
        {LAMP: "geometry_msgs/Point p\n", POINT: "float64 x\nfloat64 y\nfloat64 z"},
    )
    assert definitions.told.keys() == {LAMP}
    with pytest.raises(DefinitionError, match=f"nests another {POINT} than the one .* installed"):
        tell(definitions, POLE, {POLE: "geometry_msgs/Point p\n", POINT: "float32 x\n"})
    assert len(definitions.get(POINT).fields) == 3


def test_a_node_knows_better_than_a_folder(tmp_path: Path):
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Lamp.msg").write_text("bool on\n")
    definitions = InstalledDefinitions(None, [tmp_path])
    assert definitions.get(LAMP).fields[0].name == "on"
    tell(definitions, LAMP, {LAMP: "bool off\n"})
    assert definitions.get(LAMP).fields[0].name == "off"


def test_a_nested_type_that_was_not_told_is_named(definitions: InstalledDefinitions):
    told = {LAMP: parse_definition(LAMP, "Bulb bulb\n")}
    with pytest.raises(UnknownTypeError, match=BULB):
        believed(definitions, LAMP, told, "RIHS01_", {})


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        ({LAMP: "Lamp lamp\n"}, f"{LAMP} nests itself"),
        ({LAMP: "Bulb bulb\n", BULB: "Lamp lamp\n"}, "nests itself"),
        ({LAMP: "uint64[1000000000] x\n"}, "over 50000 values"),
        ({LAMP: "bool on\n", "../../etc": ""}, "'../../etc' is not a valid message type name"),
        ({LAMP: "bool on\n", "." * 101: ""}, r"^'\.{100}' is not a valid message type name"),
    ],
)
def test_too_many_definitions_are_refused(definitions, texts, words):
    told = {name: parse_definition(name, text) for name, text in texts.items()}
    with pytest.raises(DefinitionError, match=words):
        believed(definitions, LAMP, told, "RIHS01_", {})
    assert definitions.told == {}


def test_a_definition_that_changes_replaces_the_former(definitions: InstalledDefinitions):
    first = tell(definitions, LAMP, {LAMP: "Bulb bulb\n", BULB: "bool on\n"})
    second = tell(definitions, LAMP, {LAMP: "Bulb bulb\n", BULB: "bool off\n"}, {LAMP: first})
    assert first != second
    assert definitions.get(BULB).fields[0].name == "off"


def test_a_type_that_others_in_use_nest_stays(definitions: InstalledDefinitions):
    known = tell(definitions, LAMP, {LAMP: "Bulb bulb\n", BULB: "bool on\n"})
    other = {POLE: "Bulb bulb\n", BULB: "bool off\n"}
    with pytest.raises(DefinitionError, match=f"{POLE} nests other definitions than {LAMP}"):
        tell(definitions, POLE, other, {LAMP: known})
    assert definitions.get(BULB).fields[0].name == "on"
    tell(definitions, POLE, other)  # the lamp has gone
    assert definitions.get(BULB).fields[0].name == "off"


def test_the_number_of_learned_types_is_bounded(definitions: InstalledDefinitions, monkeypatch):
    monkeypatch.setattr(learning, "MAX_TOLD", 1)
    tell(definitions, LAMP, {LAMP: "bool on\n"})
    with pytest.raises(DefinitionError, match="at most 1 definitions of nodes"):
        tell(definitions, BULB, {BULB: "bool on\n"})
    tell(definitions, LAMP, {LAMP: "bool off\n"})  # instead of the former
    monkeypatch.setattr(learning, "MAX_TOLD_CHARACTERS", 20)
    with pytest.raises(DefinitionError, match="20 characters in all; restart the gateway"):
        tell(definitions, LAMP, {LAMP: "bool on # and a long comment\n"})


def test_the_reason_why_a_type_is_not_known_is_said(definitions: InstalledDefinitions, monkeypatch):
    definitions.note_untold(LAMP, "its node says no")
    with pytest.raises(UnknownTypeError, match=f"no definition of {LAMP} .*, and its node says no"):
        definitions.get(LAMP)
    monkeypatch.setattr("schemas.installed.MAX_TOLD", 1)
    definitions.note_untold(BULB, "nor that one")
    with pytest.raises(UnknownTypeError, match=r"is installed$"):
        definitions.get(LAMP)

# SPDX-License-Identifier: Apache-2.0
"""The types that rosidl derives from services and actions, against those that it has derived."""

import json
from pathlib import Path

import pytest

from schemas.definition import DefinitionError
from schemas.derived import DerivedDefinitions
from schemas.installed import InstalledDefinitions, UnknownTypeError, installed_prefixes
from schemas.type_hash import computed_type_hash, type_description

DEFINITIONS = InstalledDefinitions()
NAMES = DEFINITIONS.names(kind="srv") + DEFINITIONS.names(kind="action")


def installed(name: str) -> dict[str, dict]:
    """Return what is installed of a type and of all that it nests: each its hash and fields."""
    package, kind, short_name = name.split("/")
    places = (prefix / "share" / package / kind for prefix in installed_prefixes())
    path = next(
        path for path in (place / f"{short_name}.json" for place in places) if path.exists()
    )
    text = json.loads(Path(path).read_bytes())
    description = text["type_description_msg"]
    described = [description["type_description"], *description["referenced_type_descriptions"]]
    found = {each["type_name"]: {"fields": each["fields"]} for each in described}
    for each in text["type_hashes"]:
        found[each["type_name"]]["hash"] = each["hash_string"]
    return found


def test_the_hash_of_whatever_is_derived_is_the_installed_one():
    assert {name.split("/")[1] for name in NAMES} == {"srv", "action"}
    for name in NAMES:
        derived = DerivedDefinitions(DEFINITIONS.interface(name), DEFINITIONS)
        known = installed(name)
        of_it = {each for each in known if each == name or each.startswith(f"{name}_")}
        assert set(derived.names()) == of_it
        for each in derived.names():
            assert computed_type_hash(derived.get(each), derived) == known[each]["hash"], each
            if not each.endswith((name, "_SendGoal", "_GetResult")):  # those are not messages
                assert DEFINITIONS.get(each) == derived.get(each)


def test_the_descriptions_equal_the_installed_ones():
    name = "rcl_interfaces/srv/GetParameters"
    derived = DerivedDefinitions(DEFINITIONS.interface(name), DEFINITIONS)
    description = type_description(derived.get(name), derived)
    described = [description["type_description"], *description["referenced_type_descriptions"]]
    known = installed(name)
    assert [each["type_name"] for each in described] == [name, *sorted(set(known) - {name})]


def test_nested_types_of_a_part_must_be_known(tmp_path: Path):
    folder = tmp_path / "my_msgs" / "action"
    folder.mkdir(parents=True)
    (folder / "Odd.action").write_text("---\nNobody x\n---\n")
    definitions = InstalledDefinitions(None, [tmp_path])
    derived = DerivedDefinitions(definitions.interface("my_msgs/action/Odd"), definitions)
    assert derived.closure(["my_msgs/action/Odd_SendGoal"])
    with pytest.raises(UnknownTypeError, match="my_msgs/msg/Nobody"):
        derived.closure(["my_msgs/action/Odd_GetResult"])


def test_a_type_that_nests_itself_is_refused(tmp_path: Path):
    (tmp_path / "my_msgs/msg").mkdir(parents=True)
    (tmp_path / "my_msgs/srv").mkdir()
    (tmp_path / "my_msgs/msg/Ring.msg").write_text("Ring[] rings\n")
    (tmp_path / "my_msgs/srv/Get.srv").write_text("---\nRing ring\n")
    definitions = InstalledDefinitions(None, [tmp_path])
    derived = DerivedDefinitions(definitions.interface("my_msgs/srv/Get"), definitions)
    with pytest.raises(DefinitionError, match="nests itself"):
        derived.closure(["my_msgs/srv/Get"])

# SPDX-License-Identifier: Apache-2.0
import json
import os
import re
from pathlib import Path

import pytest

from gateway.codec.types import Types
from schemas import folders
from schemas.backports import tomllib
from schemas.definition import DefinitionError
from schemas.folders import SHIPPED, STANDARD, TooManyFoldersError, find_definitions
from schemas.installed import (
    MAX_DEFINITION_BYTES,
    InstalledDefinitions,
    UnknownTypeError,
    installed_prefixes,
)
from schemas.interface import Interface
from schemas.type_hash import type_hash
from tests import interfaces

NAME = "my_msgs/msg/Lamp"


def write(path: Path, text: str = "bool on\n") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def names(folder: Path) -> list[str]:
    return [f"{each.package}/{each.kind}/{each.name}" for each in find_definitions(folder)]


@pytest.mark.parametrize(
    "place",
    [
        "src/robot/my_msgs/msg",  # of a workspace
        "install/my_msgs/share/my_msgs/msg",  # colcon's, each package for itself
        "install/share/my_msgs/msg",  # and merged
        "my_msgs/msg",
        "msg",
    ],
)
def test_definitions_are_found_at_any_depth(tmp_path: Path, place: str):
    folder = tmp_path / "my_msgs"
    write(folder / place / "Lamp.msg")
    assert names(folder) == [NAME]


def test_the_package_is_named_by_its_file(tmp_path: Path):
    write(tmp_path / "lamps-2.0/package.xml", "<package><name> my_msgs </name></package>")
    write(tmp_path / "lamps-2.0/msg/Lamp.msg")
    write(tmp_path / "other-1.0/msg/Lamp.msg")  # has none, and the folder's name is not one
    assert names(tmp_path) == [NAME]


@pytest.mark.parametrize(
    "place", ["msg/lights", "lights/msg", "ros2", "lights/msg/of/houses", "interfaces/msg/msg"]
)
def test_a_package_may_have_its_definitions_in_any_of_its_folders(tmp_path: Path, place: str):
    write(tmp_path / "lamps-2.0/package.xml", "<package><name>my_msgs</name></package>")
    write(tmp_path / "lamps-2.0" / place / "Lamp.msg", "bool on\n")
    for old in ("Lamp", "Old", "msg/Lamp", "msg/Old", "more/Old"):
        write(tmp_path / f"lamps-2.0/ros1/{old}.msg", "time stamp\n")
    assert names(tmp_path) == [NAME]
    assert InstalledDefinitions([], [tmp_path]).get(NAME).text == "bool on\n"


def test_a_folder_named_by_the_kind_goes_before_the_others_of_its_package(tmp_path: Path):
    write(tmp_path / "package.xml", "<package><name>my_msgs</name></package>")
    write(tmp_path / "example/Lamp.msg", "bool other\n")
    write(tmp_path / "msg/Lamp.msg", "bool on\n")
    write(tmp_path / "plain/Set.idl")  # whose kind nothing says
    assert names(tmp_path) == [NAME, NAME]
    assert InstalledDefinitions([], [tmp_path]).get(NAME).text == "bool on\n"


def test_each_kind_has_its_files_and_plain_ones_come_before_idl(tmp_path: Path):
    for file in ("msg/Lamp.idl", "msg/Lamp.msg", "msg/Lamp.json", "msg/lamp.msg", "msg/A.srv"):
        write(tmp_path / "my_msgs" / file)
    for file in ("srv/Set.srv", "action/Dim.action", "action/Dim_2.action", "other/B.msg"):
        write(tmp_path / "my_msgs" / file)
    found = [each.path.relative_to(tmp_path / "my_msgs") for each in find_definitions(tmp_path)]
    assert list(map(str, found)) == [
        "action/Dim.action",
        "msg/Lamp.msg",
        "msg/Lamp.idl",
        "srv/Set.srv",
    ]


def test_hidden_and_ignored_folders_are_left_out(tmp_path: Path):
    write(tmp_path / "COLCON_IGNORE")  # of the folder that was named: it is meant
    for place in (".git", "build", "log"):
        write(tmp_path / place / "my_msgs/msg/Lamp.msg")
    for mark in ("build/COLCON_IGNORE", "log/AMENT_IGNORE"):
        write(tmp_path / mark)
    assert names(tmp_path) == []


def test_links_are_followed_and_end(tmp_path: Path):
    write(tmp_path / "elsewhere/my_msgs/msg/Lamp.msg")
    (tmp_path / "src").mkdir()
    (tmp_path / "src/linked").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "src/circle").symlink_to(tmp_path / "src")
    assert names(tmp_path / "src") == [NAME]


def test_a_folder_with_too_much_below_it_is_refused(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(folders, "MAX_FOLDERS", 3)
    write(tmp_path / "my_msgs/msg/Lamp.msg")
    assert names(tmp_path) == [NAME]
    write(tmp_path / "other/file")
    with pytest.raises(TooManyFoldersError, match="over 3 folders below it"):
        names(tmp_path)


def test_a_folder_that_goes_while_others_are_read_is_left_out(tmp_path: Path, monkeypatch):
    write(tmp_path / "my_msgs" / "msg" / "Lamp.msg")
    found = list(os.walk(tmp_path))
    gone = (str(tmp_path / "gone"), ["msg"], [])
    monkeypatch.setattr(os, "walk", lambda *_, **__: [found[0], gone, *found[1:]])
    assert names(tmp_path) == [NAME]


@pytest.mark.parametrize("path", ["nowhere", "file"])
def test_a_path_that_is_not_a_folder_raises(tmp_path: Path, path: str):
    write(tmp_path / "file")
    with pytest.raises(OSError, match=r"No such file|Not a directory"):
        names(tmp_path / path)


def test_definitions_of_folders_are_used_where_no_prefix_has_the_type(tmp_path: Path):
    write(tmp_path / "prefix/share/my_msgs/msg/Lamp.msg", "bool on\n")
    write(tmp_path / "first/my_msgs/msg/Lamp.msg", "bool other\n")
    write(tmp_path / "first/my_msgs/msg/Bulb.msg", "my_msgs/Lamp lamp\n")
    write(tmp_path / "second/my_msgs/msg/Bulb.msg", "bool other\n")
    write(tmp_path / "second/my_msgs/srv/Set.srv", "bool on\n---\n")
    definitions = InstalledDefinitions(
        [tmp_path / "prefix"], [tmp_path / "first", tmp_path / "second"]
    )
    assert [field.name for field in definitions.get(NAME).fields] == ["on"]
    assert [field.name for field in definitions.get("my_msgs/msg/Bulb").fields] == ["lamp"]
    assert definitions.all_names() == ["my_msgs/msg/Bulb", NAME, "my_msgs/srv/Set"]
    assert definitions.nearest("my_msgs/msg/Bulp") == "my_msgs/msg/Bulb"
    with pytest.raises(UnknownTypeError):
        definitions.get("my_msgs/msg/Other")


def test_installed_types_are_guessed_first(tmp_path: Path):
    write(tmp_path / "prefix/share/their_msgs/msg/Lamp.msg")
    write(tmp_path / "folder/my_msgs/msg/Lamp.msg")
    definitions = InstalledDefinitions([tmp_path / "prefix"], [tmp_path / "folder"])
    assert definitions.meant("lamp") == "their_msgs/msg/Lamp"
    assert definitions.nearest("other/msg/Lamp") == "their_msgs/msg/Lamp"


def test_a_definition_that_is_too_long_is_not_read(tmp_path: Path):
    write(tmp_path / "my_msgs/msg/Lamp.msg", "#" * (MAX_DEFINITION_BYTES - 8) + "\nbool on")
    write(tmp_path / "my_msgs/msg/Bulb.msg", "#" * (MAX_DEFINITION_BYTES - 7) + "\nbool on")
    definitions = InstalledDefinitions([], [tmp_path])
    assert [field.name for field in definitions.get(NAME).fields] == ["on"]
    with pytest.raises(UnknownTypeError, match="Bulb has over 262144 bytes"):
        definitions.get("my_msgs/msg/Bulb")


@pytest.mark.parametrize(
    "text",
    [
        "float64[50000] a\n",
        "Lamp[100] a\n",
        "Lamp[] a\n",
        "uint8[10000000] a\n",
        "float64[<=1000000000] a\n",
    ],
)
def test_arrays_of_fixed_length_are_bounded_by_their_values(tmp_path: Path, text: str):
    write(tmp_path / "my_msgs/msg/Lamp.msg", "float64[500] on\n")
    write(tmp_path / "my_msgs/msg/Fits.msg", text)
    write(tmp_path / "my_msgs/msg/Not.msg", f"Fits[2] b\n{text}")
    definitions = InstalledDefinitions([], [tmp_path])
    assert definitions.closure(["my_msgs/msg/Fits"])[-1].name == "my_msgs/msg/Fits"
    if "[]" in text or "<=" in text:
        assert definitions.closure(["my_msgs/msg/Not"])
        return
    reason = "my_msgs/msg/Not: each message has over 50000 values, by its fixed arrays"
    with pytest.raises(DefinitionError, match=reason):
        definitions.closure(["my_msgs/msg/Not"])


def test_elements_without_a_value_count_as_well(tmp_path: Path):
    write(tmp_path / "my_msgs/msg/Nothing.msg", "")
    write(tmp_path / "my_msgs/msg/Much.msg", "Nothing[1000000000] x\n")
    with pytest.raises(DefinitionError, match="my_msgs/msg/Much: each message has over 50000"):
        InstalledDefinitions([], [tmp_path]).closure(["my_msgs/msg/Much"])


@pytest.mark.parametrize("more", [0, 1])
def test_a_type_and_what_it_nests_have_2000_fields_at_most(tmp_path: Path, more: int):
    write(tmp_path / "my_msgs/msg/Part.msg", "".join(f"bool a{n}\n" for n in range(499)))
    whole = "".join(f"bool b{n}\n" for n in range(1000 + more))
    write(tmp_path / "my_msgs/msg/Whole.msg", f"Part one\nPart two\n{whole}")
    definitions = InstalledDefinitions([], [tmp_path])
    found = ["my_msgs/msg/Part", "my_msgs/msg/Whole"]
    if not more:
        assert [each.name for each in definitions.closure(found)] == found
        return
    with pytest.raises(DefinitionError, match="my_msgs/msg/Whole: over 2000 fields, nested"):
        definitions.closure(found)


def test_types_nest_64_levels_at_most(tmp_path: Path):
    write(tmp_path / "my_msgs/msg/A0.msg")
    for level in range(1, 66):
        write(tmp_path / f"my_msgs/msg/A{level}.msg", f"A{level - 1} a\n")
    definitions = InstalledDefinitions([], [tmp_path])
    assert Types(definitions).get("my_msgs/msg/A64").encode({}, 0)  # the type works
    with pytest.raises(DefinitionError, match="my_msgs/msg/A65 nests types deeper than 64 levels"):
        definitions.closure(["my_msgs/msg/A65"])


def test_a_folder_is_not_a_definition(tmp_path: Path):
    (tmp_path / "my_msgs/msg/Folder.msg").mkdir(parents=True)
    (tmp_path / "my_msgs/msg/Dangling.msg").symlink_to(tmp_path / "nowhere")
    os.mkfifo(tmp_path / "my_msgs/msg/Fifo.msg")
    assert names(tmp_path) == []


def test_a_hash_next_to_a_definition_in_a_folder_is_not_believed(tmp_path: Path):
    write(tmp_path / "my_msgs/msg/Lamp.msg")
    hashes = [{"type_name": NAME, "hash_string": "RIHS01_nonsense"}]
    write(tmp_path / "my_msgs/msg/Lamp.json", json.dumps({"type_hashes": hashes}))
    definitions = InstalledDefinitions([], [tmp_path])
    assert definitions.get(NAME).type_hash is None
    assert re.fullmatch("RIHS01_[0-9a-f]{64}", type_hash(definitions.get(NAME), definitions))


def test_sources_have_the_hash_of_what_is_built_of_them():
    built = InstalledDefinitions()
    if not built.names(["tf2_msgs", "idl_msgs"]):
        pytest.skip(interfaces.HOW)
    installed = [path for path in built._prefixes if "interfaces" not in str(path)]
    sources = InstalledDefinitions(installed, interfaces.SOURCES.values())
    for name in built.names(["tf2_msgs", "idl_msgs"]):
        assert sources.get(name).type_hash is None
        assert type_hash(sources.get(name), sources) == built.get(name).type_hash


def shipped() -> tuple[InstalledDefinitions, list[str]]:
    """Return the definitions with those of PyPI's wheels alone, and all types that are shipped."""
    found = find_definitions(SHIPPED)
    return InstalledDefinitions(installed_prefixes()[-1:], [SHIPPED]), [
        f"{each.package}/{each.kind}/{each.name}" for each in found
    ]


def test_shipped_types_have_the_hashes_that_robots_have():
    definitions, _ = shipped()
    published_hashes = Path(__file__).with_name("published_hashes.toml").read_text("utf-8")
    for package, hashes in tomllib.loads(published_hashes).items():
        for name, published in hashes.items():
            found = definitions.get(f"{package}/{name}")
            assert type_hash(found, definitions) == f"RIHS01_{published}", name


def test_all_that_is_shipped_makes_messages():
    definitions, names = shipped()
    types = Types(definitions)
    assert len(names) > 100
    for name in names:
        found = definitions.get_any(name)
        parts = found.parts.values() if isinstance(found, Interface) else [found]
        for part in parts:
            cdr = types.get(part.name).encode({}, 0)
            assert types.get(part.name).decode(cdr).keys() == {each.name for each in part.fields}
            assert re.fullmatch("RIHS01_[0-9a-f]{64}", type_hash(part, definitions))


def test_standard_types_are_those_of_the_wheels_for_machines_without_them():
    installed, alone = InstalledDefinitions(), InstalledDefinitions([], [STANDARD])
    for each in find_definitions(STANDARD):
        name = f"{each.package}/{each.kind}/{each.name}"
        found, expected = alone.get_any(name), installed.get_any(name)
        parts = found.parts.values() if isinstance(found, Interface) else [found]
        for part in parts:
            assert type_hash(part, alone) == type_hash(installed.get(part.name), installed)
        if not isinstance(found, Interface):
            values = [(one.name, one.value) for one in expected.constants]
            assert [(one.name, one.value) for one in found.constants] == values
    for package in ("std_msgs", "geometry_msgs", "rcl_interfaces", "type_description_interfaces"):
        assert set(installed.names([package])) == set(alone.names([package]))


def test_shipped_types_are_of_packages_that_the_wheels_lack():
    definitions, names = shipped()
    wheels = InstalledDefinitions(installed_prefixes()[-1:])
    assert not wheels.names(definitions.packages_in_folders())
    readme = (SHIPPED / "README.md").read_text("utf-8")
    listed = re.findall(r"^\| `(\w+)` \|", readme, re.MULTILINE)
    assert listed == sorted({name.split("/")[0] for name in names})
    assert set(listed) == definitions.packages_in_folders()

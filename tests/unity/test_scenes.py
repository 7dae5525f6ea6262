# SPDX-License-Identifier: Apache-2.0
"""Prefabs and scenes are what the generator writes, and everything in them refers to something.

No Unity editor is here to open them: these tests read them as Unity documents its format, and
compare every script and field with the C# sources.
"""

import re
from pathlib import Path

import pytest

from tests.unity.package import CLIENT, DISPLAYS, HOME, PACKAGES, STUB, installed_with
from tests.unity.unity_yaml import Document, all_fields, documents, links, read_script
from tools.unity_scenes.__main__ import main
from tools.unity_scenes.asset import Asset, Node, quaternion

# Unity's own assets: the same GUIDs and file IDs in every project.
LIBRARY = {"0000000000000000e000000000000000", "0000000000000000f000000000000000"}
LIBRARY_ASSETS = {46, 10202, 10206, 10207, 10209, 10210, 10303, 10306, 10102, 10100}
URP_LIT = "933532a4fcc9baf4fa0491de14d08ed7"  # of com.unity.render-pipelines.universal
CLASSES = {
    1: "GameObject",
    4: "Transform",
    20: "Camera",
    21: "Material",
    23: "MeshRenderer",
    29: "OcclusionCullingSettings",
    33: "MeshFilter",
    64: "MeshCollider",
    102: "TextMesh",
    104: "RenderSettings",
    108: "Light",
    114: "MonoBehaviour",
    120: "LineRenderer",
    157: "LightmapSettings",
    196: "NavMeshSettings",
}
MONO_BEHAVIOUR = 114
SCRIPT = 11500000
OWN_MEMBERS = {"m_ObjectHideFlags", "m_GameObject", "m_Enabled", "m_Script", "m_Name"}

SOURCES = {
    path.stem: path
    for one in PACKAGES
    for folder in ("Runtime/Unity", "Samples~")
    for path in (one / folder).rglob("*.cs")
}
GUIDS = {
    re.findall(r"^guid: (\w+)$", meta.read_text(), re.MULTILINE)[0]: meta.with_suffix("")
    for meta in HOME.rglob("*.meta")
}
BUILDERS = DISPLAYS / "Runtime/Unity/Scenes"  # the common parts of both scenes
SCENES = sorted((DISPLAYS / "Samples~").rglob("*.unity"))
FILES = [*sorted(HOME.rglob("*.prefab")), *SCENES]
ASSETS = sorted([*HOME.rglob("*.mat"), *HOME.rglob("*.asset")])

ints = re.compile(r"-?\d+")
VALUES = {
    "string": re.compile(r"|'([^']|'')*'"),
    "bool": re.compile(r"[01]"),
    "int": ints,
    "float": re.compile(r"-?\d+(\.\d+)?(e-?\d+)?"),
}


def read(path: Path) -> list[Document]:
    return documents(path.read_text())


def package_of(path: Path) -> Path:
    return HOME / path.relative_to(HOME).parts[0]


def test_they_are_up_to_date(capsys):
    assert main(["--check"]) == 0, "run make docs\n" + capsys.readouterr().out


def test_parts_name_their_topic_and_type():
    parts = [path for path in FILES if path.parents[1].name in {"Publishers", "Subscribers"}]
    assert len(parts) == 12
    for path in parts:
        [component] = [d for d in read(path) if d.class_id == MONO_BEHAVIOUR]
        assert component.members["_type"] == f"'{path.parent.name}/msg/{path.stem}'"
        assert re.fullmatch(r"'(/[a-z0-9_]+)+'", component.members["_topic"])


def test_every_component_that_the_menu_offers_is_in_a_prefab():
    menus = " ".join(path.read_text() for path in HOME.glob("*/Editor/*Menu.cs"))
    offered = set(re.findall(r"AddComponent<(\w+)>|typeof\((\w+)\)\)", menus))
    names = {one or other for one, other in offered} & set(SOURCES)
    used = {
        GUIDS[document.link("m_Script").guid].stem
        for path in FILES
        for document in read(path)
        if document.class_id == MONO_BEHAVIOUR
    }
    assert len(names) > 20
    assert names - used == set()


def test_the_menu_makes_every_component_of_the_documentations_table():
    index = (CLIENT / "Documentation~/index.md").read_text()
    (table,) = re.findall(r"^\| Component \|.*\n((?:\|.*\n)+)", index, re.MULTILINE)
    cells = re.findall(r"^\| ([^|-]+) \|", table, re.MULTILINE)
    wanted = {name.strip().replace(" ", "").lower() for cell in cells for name in cell.split(",")}
    menus = "".join(path.read_text() for path in HOME.glob("*/Editor/*Menu.cs"))
    entry = r"\[MenuItem\(Path [^\]]*\]\s+public static void \w+\(MenuCommand \w+\)(.*?)\n {8}\}"
    made = {
        name.removesuffix("s").removesuffix("Display").lower()
        for body in re.findall(entry, menus, re.DOTALL)
        for name in re.findall(r"(?:AddComponent<|typeof\()(\w+)", body)
    }
    missing = {name for name in wanted if re.sub("(display)?s?$", "", name) not in made}
    assert len(wanted) > 20
    assert missing == set()


def test_the_drawing_of_the_tutorial_names_fields_of_the_components():
    drawing = (HOME.parent / "docs/images/unity-scene.svg").read_text()
    components = re.findall(r'<g data-component="(\w+)">(.*?)</g>', drawing, re.DOTALL)
    assert len(components) > 5
    for component, group in components:
        public = re.findall(r"public \w+ (\w+) =", SOURCES[component].read_text())
        names = [*all_fields(read_script(SOURCES[component]), SOURCES), *public]
        fields = {name.strip("_").lower() for name in names}
        for label in re.findall(r'class="field"[^>]*>([^<]+)<', group):
            assert label.replace(" ", "").lower() in fields, f"{component}: {label}"


def test_everything_refers_to_something():
    for path in (*FILES, *ASSETS):
        found = read(path)
        by_id = {document.file_id: document for document in found}
        assert len(by_id) == len(found), f"{path.name}: two objects of one file ID"
        for link in (link for document in found for link in document.links):
            if link.guid in LIBRARY:
                assert link.file_id in LIBRARY_ASSETS, path.name
            elif link.guid and link.guid != URP_LIT:
                to = GUIDS[link.guid]
                assert to.exists(), path.name
                assert package_of(to) in installed_with(package_of(path)), f"{path.name}: {to.name}"
                if to.suffix != ".cs":
                    assert link.kind == "2"
                    assert link.file_id in {document.file_id for document in read(to)}, path.name
            elif not link.guid:
                assert link.file_id == 0 or link.file_id in by_id, path.name


def test_objects_and_components_know_each_other():
    for path in FILES:
        check_objects(path, read(path))


def check_objects(path, found):
    by_id = {document.file_id: document for document in found}
    roots = 0
    for document in found:
        if document.class_id == 1:
            listed = [link.file_id for link in document.links]
            components = [d for d in found if d.members.get("m_GameObject")]
            assert listed == [
                d.file_id for d in components if d.link("m_GameObject").file_id == document.file_id
            ], path
            assert by_id[listed[0]].class_id == 4, f"{path}: the first component is no Transform"
        elif document.class_id == 4:
            father = document.link("m_Father").file_id
            roots += father == 0
            if father:
                children = by_id[father].members["m_Children"]
                assert f"fileID: {document.file_id}}}" in children, path
        assert CLASSES[document.class_id] == document.name, path
    assert roots == 1 or path in SCENES, path


def test_every_field_is_one_of_its_script_and_has_a_value_of_its_type():
    for path in FILES:
        check_fields(path, read(path))


def check_fields(path, found):
    for document in found:
        if document.class_id != MONO_BEHAVIOUR:
            continue
        link = document.link("m_Script")
        assert (link.file_id, link.kind) == (SCRIPT, "3"), path
        fields = all_fields(read_script(GUIDS[link.guid]), SOURCES)
        for name in document.members.keys() - OWN_MEMBERS:
            assert name in fields, f"{path}: {GUIDS[link.guid].stem} has no field {name}"
            if fields[name] in VALUES:
                assert VALUES[fields[name]].fullmatch(document.members[name]), f"{path}: {name}"
            elif name.startswith("_on"):
                check_calls(document.members[name], found)
            else:
                check_reference(document.link(name), fields[name], found, path)


def check_reference(link, wanted, found, path):
    """Check that a field of a type refers to an object of that type."""
    documents_there = read(GUIDS[link.guid]) if link.guid else found
    [to] = [document for document in documents_there if document.file_id == link.file_id]
    kind = to.name
    if to.class_id == MONO_BEHAVIOUR:
        kind = GUIDS[to.link("m_Script").guid].stem
    assert kind == wanted, path


def check_calls(text, found):
    """Check that an event calls a method with the text that it brings."""
    [target] = links(text)
    [to] = [document for document in found if document.file_id == target.file_id]
    assert to.name == "TextMesh"
    assert "m_TargetAssemblyTypeName: 'UnityEngine.TextMesh, UnityEngine'" in text
    assert "m_MethodName: 'set_text'" in text
    assert "UnityEngine.TextMesh { string text get set }" in (STUB / "members.txt").read_text()


def test_both_demonstrations_are_scenes_with_materials_for_both_pipelines():
    assert [path.stem for path in SCENES] == ["Teleoperation", "XrTarget"]
    for path in SCENES:
        materials = {asset.stem for asset in (path.parent / "Materials").glob("*.mat")}
        assert materials == {*materials} | {f"{m.removesuffix(' URP')} URP" for m in materials}
        used = {GUIDS[link.guid] for d in read(path) for link in d.links if link.guid in GUIDS}
        built_in = {m for m in materials if not m.endswith(" URP")}
        assert {asset.stem for asset in used if asset.suffix == ".mat"} == built_in
        [settings] = [asset for asset in used if asset.suffix == ".asset"]
        [document] = read(settings)
        assert document.members["Address"] == "'ws://localhost:9090'"
        assert re.search(r"public string Address\b", SOURCES["GatewaySettings"].read_text())


def test_a_scene_has_the_components_that_its_builder_adds():
    shared = "".join(path.read_text() for path in BUILDERS.glob("*.cs"))
    for path in SCENES:
        builder = (path.parent / f"{path.stem}Scene.cs").read_text() + shared
        added = set(re.findall(r"AddComponent<(\w+)>", builder)) & set(SOURCES)
        present = {
            GUIDS[document.link("m_Script").guid].stem
            for document in read(path)
            if document.class_id == MONO_BEHAVIOUR
        }
        assert added == present


def test_a_component_has_what_its_class_requires():
    for path in FILES:
        by_object: dict[int, set[str]] = {}
        for document in read(path):
            if "m_GameObject" in document.members:
                name = document.name
                if document.class_id == MONO_BEHAVIOUR:
                    name = GUIDS[document.link("m_Script").guid].stem
                by_object.setdefault(document.link("m_GameObject").file_id, set()).add(name)
        for present in by_object.values():
            for name in present & set(SOURCES):
                assert required(name) <= present, f"{path.name}: {name}"


def required(name: str) -> set[str]:
    wanted: set[str] = set()
    while name in SOURCES:
        text = SOURCES[name].read_text()
        for types in re.findall(r"\[RequireComponent\((.*?)\)\]", text):
            wanted |= set(re.findall(r"typeof\((\w+)\)", types))
        name = read_script(SOURCES[name]).base
    return wanted


def test_two_nodes_of_one_name_are_refused():
    with pytest.raises(ValueError, match="same name"):
        Asset("a").text([Node("a", children=[Node("a")])])


def test_turns_are_those_of_unity():
    # about x by a right angle, then about y: Unity's forward, z, looks down
    assert quaternion((90, 0, 0)) == pytest.approx((0.70710678, 0, 0, 0.70710678))
    assert quaternion((90, 90, 0)) == pytest.approx((0.5, 0.5, -0.5, 0.5))

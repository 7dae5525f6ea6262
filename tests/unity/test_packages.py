# SPDX-License-Identifier: Apache-2.0
"""The three packages: an upgrade by the note, what old scenes refer to, and how many lines."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.unity import mono, package
from tests.unity.csharp import IN_EDITOR
from tests.unity.package import HOME, PACKAGES, AssemblyDefinition
from tools import unity_lines

HERE = Path(__file__).parent
NOTE = package.CLIENT / "Documentation~/upgrade.md"
OLD_MANIFEST = {
    "dependencies": {
        "com.ros2-json-gateway.client": "https://example.com/gateway.git?path=unity_client",
        "com.unity.ugui": "2.0.0",
    }
}
# Hand-written lines of C# in what a build or the editor has. They only go down.
MOST_LINES = {"client": 6714, "displays": 5655, "robots": 1483}
OLD_ASSEMBLY = {"name": "Users", "references": ["Ros2Gateway.Core", "Ros2Gateway.Unity"]}


def blocks():
    """Return the note's blocks of JSON: the lines before and after, and the references."""
    found = re.findall(r"^```json\n(.*?)^```$", NOTE.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    return [json.loads(block) for block in found]


def upgraded(manifest):
    """Return a manifest after the first step of the note."""
    before, after, _ = blocks()
    (name, line), *_ = before["dependencies"].items()
    address = manifest["dependencies"][name].removesuffix(line.removeprefix("ADDRESS"))
    added = {n: text.replace("ADDRESS", address) for n, text in after["dependencies"].items()}
    return {**manifest, "dependencies": {**manifest["dependencies"], **added}}


def test_a_project_of_the_single_package_installs_the_three_by_the_note():
    dependencies = upgraded(OLD_MANIFEST)["dependencies"]
    for one in PACKAGES:
        manifest = json.loads((one / "package.json").read_text("utf-8"))
        place = one.relative_to(HOME.parent).as_posix()
        assert dependencies[manifest["name"]] == f"https://example.com/gateway.git?path={place}"
        own = {name for name in manifest["dependencies"] if name.startswith("com.ros2")}
        assert own <= set(dependencies)
    assert dependencies["com.unity.ugui"] == "2.0.0"


@pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())
def test_a_script_of_such_a_project_compiles_after_the_note(tmp_path):
    path = tmp_path / "Users.asmdef"
    path.write_text(json.dumps(OLD_ASSEMBLY))
    old = AssemblyDefinition.read(path)
    script = [HERE / "upgrade/UsersScript.cs"]
    with pytest.raises(mono.CompileError):
        package.compiled_definition(old, IN_EDITOR, script)
    *_, references = blocks()
    new = replace(old, references=tuple(references))
    assert package.compiled_definition(new, IN_EDITOR, script).path.exists()


@pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())
def test_the_note_names_every_assembly():
    runtime = {binary.name for binary in package.libraries(IN_EDITOR)}
    assert runtime == set(blocks()[2])


def test_scripts_and_prefabs_of_the_single_package_keep_their_guids():
    owners = {}
    for meta in HOME.rglob("*.meta"):
        (guid,) = re.findall(r"^guid: (\w+)$", meta.read_text("utf-8"), re.MULTILINE)
        owners[guid] = meta.stem
    for line in (HERE / "guids.txt").read_text("utf-8").splitlines():
        guid, _, name = line.partition(" ")
        assert owners.get(guid) == name


@pytest.mark.parametrize("one", PACKAGES, ids=lambda one: one.name)
def test_a_package_has_at_most_so_many_lines(one):
    counts = unity_lines.lines_of(one)
    assert sum(counts[part] for part in unity_lines.CODE) <= MOST_LINES[one.name]


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("// a comment\n\nint a; // and code\n", 1),
        ('string url = "ws://a"; /* two\nlines */\n', 1),
        ("void A()\n{\n    B();\n}\n", 2),
        ('string verbatim = @"a\n// no comment\n";\n', 3),
        ("char quote = '\"'; // one\n// two\n", 1),
    ],
)
def test_lines_that_count(source, count):
    assert unity_lines.lines(source) == count

# SPDX-License-Identifier: Apache-2.0
"""The trees on the packages' pages hold what prefabs and scenes do: objects, components, fields.

No Unity editor is here to take pictures. To write a tree again, run
``python -m tests.unity.test_trees FILE``.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.unity.package import HOME, PACKAGES
from tests.unity.unity_yaml import Document, documents, links

GAME_OBJECT, TRANSFORM, MONO_BEHAVIOUR = 1, 4, 114
SHOWN = [
    (page, *shown)
    for page in sorted(HOME.glob("*/Documentation~/*.md"))
    for shown in re.findall(
        r"`([^`\n]+\.(?:prefab|unity))`:\n\n```text\n(.*?)```", page.read_text(), re.DOTALL
    )
]
SCRIPTS = {
    re.findall(r"^guid: (\w+)$", meta.read_text(), re.MULTILINE)[0]: meta.name.split(".")[0]
    for folder in ("Runtime/Unity", "Samples~")
    for meta in HOME.glob(f"*/{folder}/**/*.cs.meta")
}


def tree(path: Path) -> str:
    """Return the objects of a file, each with its components and below it its children."""
    by_id = {document.file_id: document for document in documents(path.read_text())}
    transforms = (one for one in by_id.values() if one.class_id == TRANSFORM)
    roots = (one for one in transforms if one.link("m_Father").file_id == 0)
    return "".join(f"{line}\n" for root in roots for line in _object(root, by_id, ""))


def _object(transform: Document, by_id: dict[int, Document], indent: str) -> Iterator[str]:
    thing = by_id[transform.link("m_GameObject").file_id]
    yield indent + thing.members["m_Name"].strip("'").replace("''", "'")
    for link in links(thing.members["m_Component"]):
        if (component := by_id[link.file_id]).class_id != TRANSFORM:
            yield f"{indent}  - {_component(component)}"
    for link in links(transform.members["m_Children"]):
        yield from _object(by_id[link.file_id], by_id, indent + "  ")


def _component(component: Document) -> str:
    if component.class_id != MONO_BEHAVIOUR:
        return _words(component.name)
    name = _words(SCRIPTS.get(component.link("m_Script").guid or "", "a script of another package"))
    fields = (
        f"{_words(member)} = {value}"
        for member, text in component.members.items()
        if member.startswith("_") and (value := text.strip("'")) and "\n" not in value
    )
    shown = ", ".join(one for one in fields if "{" not in one)
    return f"{name}: {shown}" if shown else name


def _words(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.lstrip("_")[0].upper() + name.lstrip("_")[1:])


@pytest.mark.parametrize(("page", "name", "shown"), SHOWN)
def test_a_tree_on_a_page_is_that_of_its_file(page, name, shown):
    assert tree(page.parents[1] / name) == shown


def test_each_package_shows_a_tree():
    assert {page.parents[1] for page, *_ in SHOWN} == set(PACKAGES)


if __name__ == "__main__":
    print(tree(Path(sys.argv[1])), end="")  # noqa: T201  # a command's output

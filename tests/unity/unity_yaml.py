# SPDX-License-Identifier: Apache-2.0
"""Reads Unity's text format and the sources that it refers to. Knows nothing of what writes it."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

_DOCUMENT: Final = re.compile(r"^--- !u!(\d+) &(-?\d+)$")
_MEMBER: Final = re.compile(r"^  (\w+):(?: (.*))?$")
_REFERENCE: Final = re.compile(r"\{fileID: (-?\d+)(?:, guid: ([0-9a-f]{32}), type: ([0-3]))?\}")
_FIELD: Final = re.compile(r"^private ([\w<>\[\]]+) (_\w+)(?: = .*)?;(?: //.*)?$")
_CLASS: Final = re.compile(r"class (\w+)(?:<\w+>)?\s*(?::\s*(\w+))?")


@dataclass(frozen=True)
class Link:
    """A reference as it stands in a file."""

    file_id: int
    guid: str | None
    kind: str | None


@dataclass
class Document:
    """One object or component."""

    class_id: int
    file_id: int
    name: str = ""
    members: dict[str, str] = field(default_factory=dict)
    links: list[Link] = field(default_factory=list)

    def link(self, member: str) -> Link:
        """Return the reference that a member is."""
        [found] = links(self.members[member])
        return found


def links(text: str) -> list[Link]:
    """Return the references in a text."""
    return [Link(int(m[1]), m[2], m[3]) for m in _REFERENCE.finditer(text)]


def documents(text: str) -> list[Document]:
    """Read a file.

    Raises:
        ValueError: it is not in Unity's format.
    """
    lines = text.splitlines()
    if lines[:2] != ["%YAML 1.1", "%TAG !u! tag:unity3d.com,2011:"]:
        raise ValueError("it does not begin as Unity's files do")
    found: list[Document] = []
    member = ""
    for line in lines[2:]:
        if start := _DOCUMENT.match(line):
            found.append(Document(int(start[1]), int(start[2])))
        elif not line.startswith(" "):
            found[-1].name = line.removesuffix(":")
        elif top := _MEMBER.match(line):
            member = top[1]
            if member in found[-1].members:
                raise ValueError(f"{found[-1].name} has two members {member}")
            found[-1].members[member] = top[2] or ""
        else:
            found[-1].members[member] += "\n" + line
        if found and line.startswith(" "):
            found[-1].links += links(line)
    return found


@dataclass(frozen=True)
class Script:
    """A source of the package, as far as Unity serializes it."""

    name: str
    base: str
    fields: dict[str, str]
    """Each serialized field's type."""


def read_script(path: Path) -> Script:
    """Read a source whose first class of the file's name is a component."""
    text = path.read_text()
    [(name, base)] = [m for m in _CLASS.findall(text) if m[0] == path.stem]
    fields: dict[str, str] = {}
    attributes = ""
    for line in map(str.strip, text.splitlines()):
        if line.startswith(("[", "+", '"')):
            attributes += line
        elif line:
            found = _FIELD.match(line)
            if found and "[SerializeField]" in attributes:
                fields[found[2]] = found[1]
            attributes = ""
    return Script(name, base, fields)


def all_fields(script: Script, sources: dict[str, Path]) -> dict[str, str]:
    """Return a script's fields with those of the classes that it extends."""
    fields = dict(script.fields)
    while script.base in sources:
        script = read_script(sources[script.base])
        fields = {**script.fields, **fields}
    return fields

# SPDX-License-Identifier: Apache-2.0
"""Unity's text format (https://docs.unity3d.com/Manual/FormatDescription.html): objects to text.

An asset is a list of documents, one for each object and component, which refer to each other by
file IDs, and to other assets by their GUIDs. Fields without a value keep that of the class, so
only differences are written.
"""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

HEADER: Final = "%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n"

_GAME_OBJECT: Final = 1
_TRANSFORM: Final = 4
_MONO_BEHAVIOUR: Final = 114

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Reference:
    """Another object: of this asset, by the names of its node and component, or of another one."""

    node: str = ""
    component: str = ""
    file_id: int = 0
    guid: str = ""
    kind: int = 3
    """2 for assets that Unity stores as they are, 3 for those that it imports, 0 for its own."""


Value = str | int | float | bool | Reference | Mapping[str, "Value"] | Sequence["Value"]


@dataclass(frozen=True)
class Component:
    """A component of Unity's own, or with a *script* one of the package."""

    name: str
    class_id: int
    fields: Mapping[str, Value]
    script: str = ""
    """The GUID of its source."""
    can_be_disabled: bool = True


@dataclass(frozen=True)
class Node:
    """A game object. Its name is unique in its asset."""

    name: str
    components: Sequence[Component] = ()
    children: Sequence["Node"] = ()
    position: Vector = (0.0, 0.0, 0.0)
    turn: Vector = (0.0, 0.0, 0.0)
    """Degrees about x, y and z, as the Inspector shows them."""
    scale: Vector = (1.0, 1.0, 1.0)
    tag: str = "Untagged"

    def below(self) -> Iterator["Node"]:
        """Yield it and all below it."""
        yield self
        for child in self.children:
            yield from child.below()


@dataclass
class Asset:
    """One file. *key* is what its file IDs are derived from, so that they stay the same."""

    key: str
    _lines: list[str] = field(default_factory=list)

    def text(self, roots: Sequence[Node], first: str = "") -> str:
        """Return the file's text.

        Raises:
            ValueError: two nodes have the same name.
        """
        names = [node.name for root in roots for node in root.below()]
        if len(set(names)) < len(names):
            raise ValueError(f"{self.key}: two nodes of the same name")
        self._lines = []
        for order, root in enumerate(roots):
            self._node(root, parent=None, order=order)
        return HEADER + first + "\n".join(self._lines) + "\n"

    def single(self, class_id: int, kind: str, file_id: int, fields: Mapping[str, Value]) -> str:
        """Return the text of an asset that is one object, such as a material."""
        lines = [f"--- !u!{class_id} &{file_id}", f"{kind}:", "  m_ObjectHideFlags: 0"]
        for name, value in fields.items():
            lines += self._field(name, value, "  ")
        return HEADER + "\n".join(lines) + "\n"

    def file_id(self, node: str, component: str) -> int:
        """Return the number of an object in this file."""
        digest = hashlib.md5(f"{self.key}:{node}:{component}".encode(), usedforsecurity=False)
        return (
            int(digest.hexdigest()[:15], 16) + 1
        )  # of 60 bits, and never 0, which means no object

    def _node(self, node: Node, parent: Node | None, order: int) -> None:
        own = ["Transform", *(component.name for component in node.components)]
        self._document(
            *(_GAME_OBJECT, "GameObject", node.name, "GameObject"),
            {
                "serializedVersion": 6,
                "m_Component": [{"component": Reference(node.name, name)} for name in own],
                "m_Layer": 0,
                "m_Name": node.name,
                "m_TagString": node.tag,
                "m_IsActive": True,
            },
        )
        self._document(
            *(_TRANSFORM, "Transform", node.name, "Transform"),
            {
                "m_GameObject": Reference(node.name, "GameObject"),
                "m_LocalRotation": _named("xyzw", quaternion(node.turn)),
                "m_LocalPosition": _named("xyz", node.position),
                "m_LocalScale": _named("xyz", node.scale),
                "m_Children": [Reference(child.name, "Transform") for child in node.children],
                "m_Father": Reference(parent.name, "Transform") if parent else Reference(),
                "m_RootOrder": order,
                "m_LocalEulerAnglesHint": _named("xyz", node.turn),
            },
        )
        for component in node.components:
            script: dict[str, Value] = {}
            if component.script:
                script = {
                    "m_Script": Reference(file_id=11500000, guid=component.script),
                    "m_Name": "",
                }
            self._document(
                component.class_id,
                "MonoBehaviour" if component.script else component.name,
                node.name,
                component.name,
                {
                    "m_GameObject": Reference(node.name, "GameObject"),
                    **({"m_Enabled": True} if component.can_be_disabled else {}),
                    **script,
                    **component.fields,
                },
            )
        for index, child in enumerate(node.children):
            self._node(child, node, index)

    def _document(
        self, class_id: int, kind: str, node: str, component: str, fields: Mapping[str, Value]
    ) -> None:
        self._lines += [f"--- !u!{class_id} &{self.file_id(node, component)}", f"{kind}:"]
        self._lines.append("  m_ObjectHideFlags: 0")
        for name, value in fields.items():
            self._lines += self._field(name, value, "  ")

    def _field(self, name: str, value: Value, indent: str) -> Iterator[str]:
        if isinstance(value, Mapping) and not _is_flat(value):
            yield f"{indent}{name}:"
            for inner, one in value.items():
                yield from self._field(inner, one, indent + "  ")
        elif isinstance(value, Sequence) and not isinstance(value, str) and value:
            yield f"{indent}{name}:"
            for one in value:
                yield from self._element(one, indent)
        else:
            yield f"{indent}{name}: {self._inline(value)}".rstrip()

    def _element(self, value: Value, indent: str) -> Iterator[str]:
        if not isinstance(value, Mapping):
            yield f"{indent}- {self._inline(value)}"
            return
        start = f"{indent}- "
        for inner, one in value.items():
            for line in self._field(inner, one, ""):
                yield start + line
                start = f"{indent}  "

    def _inline(self, value: Value) -> str:
        match value:
            case Reference():
                return self._reference(value)
            case bool() | int():
                return str(int(value))
            case float():
                return f"{value:.9g}"
            case str():
                return "'" + value.replace("'", "''") + "'" if value else ""
            case Mapping():
                return "{" + ", ".join(f"{k}: {self._inline(v)}" for k, v in value.items()) + "}"
            case _:
                return "[]"

    def _reference(self, to: Reference) -> str:
        if to.guid:
            return f"{{fileID: {to.file_id}, guid: {to.guid}, type: {to.kind}}}"
        return f"{{fileID: {self.file_id(to.node, to.component) if to.node else to.file_id}}}"


def script(name: str, guid: str, fields: Mapping[str, Value]) -> Component:
    """Return a component of the package."""
    return Component(name, _MONO_BEHAVIOUR, fields, guid)


def quaternion(turn: Vector) -> tuple[float, float, float, float]:
    """Return Unity's ``Quaternion.Euler``: about z first, then x, then y, in degrees."""
    (sx, cx), (sy, cy), (sz, cz) = (
        (math.sin(math.radians(angle) / 2), math.cos(math.radians(angle) / 2)) for angle in turn
    )
    return (
        cy * sx * cz + sy * cx * sz,
        sy * cx * cz - cy * sx * sz,
        cy * cx * sz - sy * sx * cz,
        cy * cx * cz + sy * sx * sz,
    )


def _named(names: str, values: Sequence[float]) -> dict[str, Value]:
    return dict(zip(names, values, strict=True))


def _is_flat(value: Mapping[str, Value]) -> bool:
    """Return whether Unity writes it on one line: vectors and colours are numbers alone."""
    return all(isinstance(one, int | float) for one in value.values())

# SPDX-License-Identifier: Apache-2.0
"""Components as prefabs and scenes use them: Unity's own, and by their sources the packages'."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from tools import unity_metas
from tools.unity_scenes.asset import Component, Reference, Value, script

# Unity's own assets have these GUIDs in every project.
_LIBRARY: Final = "0000000000000000e000000000000000"
_BUILT_IN: Final = "0000000000000000f000000000000000"
_MESHES: Final = {"Cube": 10202, "Cylinder": 10206, "Sphere": 10207, "Plane": 10209, "Quad": 10210}
_DEFAULT_MATERIAL: Final = Reference(file_id=10303, guid=_BUILT_IN, kind=0)
_FONT: Final = Reference(file_id=10102, guid=_LIBRARY, kind=0)
_FONT_MATERIAL: Final = Reference(file_id=10100, guid=_LIBRARY, kind=0)

_GUID: Final = re.compile(r"^guid: ([0-9a-f]{32})$", re.MULTILINE)


def behaviour(name: str, **fields: Value) -> Component:
    """Return one of the packages' components, with the fields that differ from its defaults."""
    return script(name, guid_of(source_of(name)), {f"_{key}": fields[key] for key in fields})


def source_of(name: str) -> Path:
    """Return the file of a component: Unity demands that it has the name of the class."""
    folders = [one / part for one in unity_metas.PACKAGES for part in ("Runtime/Unity", "Samples~")]
    [found] = (path for folder in folders for path in folder.rglob(f"{name}.cs"))
    return found


def guid_of(asset: Path) -> str:
    """Return the GUID of an asset, also if its meta is not written yet."""
    meta = unity_metas.meta_of(asset)
    package = next(one for one in unity_metas.PACKAGES if one in asset.parents)
    text = meta.read_text() if meta.exists() else unity_metas.content(package, asset)
    [guid] = _GUID.findall(text)
    return str(guid)


def mesh(shape: str = "") -> Component:
    """Return a mesh filter with one of Unity's shapes, or empty for a display to fill."""
    shown = Reference(file_id=_MESHES[shape], guid=_LIBRARY, kind=0) if shape else Reference()
    return Component("MeshFilter", 33, {"m_Mesh": shown}, can_be_disabled=False)


def renderer(material: Reference | None = _DEFAULT_MATERIAL) -> Component:
    """Return a mesh renderer, without a material if the display makes it."""
    return Component("MeshRenderer", 23, {"m_Materials": [material or Reference()]})


def collider(shape: str) -> Component:
    """Return what rays hit of one of Unity's shapes."""
    if shape in {"Plane", "Quad"}:
        own = Reference(file_id=_MESHES[shape], guid=_LIBRARY, kind=0)
        return Component("MeshCollider", 64, {"m_Mesh": own})
    return Component("BoxCollider", 65, {})


def light() -> Component:
    """Return a sun."""
    color: Mapping[str, Value] = {"r": 1, "g": 1, "b": 1, "a": 1}
    return Component("Light", 108, {"m_Type": 1, "m_Color": color, "m_Intensity": 1})


def camera() -> Component:
    """Return a camera as Unity makes them."""
    return Component("Camera", 20, {})


def line(width: float) -> Component:
    """Return a line that a component moves."""
    points: Sequence[Value] = [{"x": 0, "y": 0, "z": 0}, {"x": 0, "y": 0, "z": 1}]
    shape: Mapping[str, Value] = {"serializedVersion": 3, "widthMultiplier": width}
    material = Reference(file_id=10306, guid=_BUILT_IN, kind=0)
    return Component(
        *("LineRenderer", 120),
        {"m_Materials": [material], "m_Positions": points, "m_Parameters": shape},
    )


def shows_text(node: str) -> Value:
    """Return what an event of the Inspector does that writes its text to a node's TextMesh."""
    call: Mapping[str, Value] = {
        "m_Target": Reference(node, "TextMesh"),
        "m_TargetAssemblyTypeName": "UnityEngine.TextMesh, UnityEngine",
        "m_MethodName": "set_text",
        "m_Mode": 0,  # with the event's own argument
        "m_CallState": 2,  # at run time only
    }
    return {"m_PersistentCalls": {"m_Calls": [call]}}


def material(path: Path) -> Reference:
    """Return a material of the samples."""
    return Reference(file_id=2100000, guid=guid_of(path), kind=2)


def words() -> tuple[Component, Component]:
    """Return a text display, in letters of about 7 cm."""
    white: Mapping[str, Value] = {"serializedVersion": 2, "rgba": 4294967295}
    text = {
        "m_Text": "",
        "m_CharacterSize": 0.015,
        "m_LineSpacing": 1,
        "m_Anchor": 0,
        "m_Alignment": 0,
        "m_TabSize": 4,
        "m_FontSize": 48,
        "m_FontStyle": 0,
        "m_RichText": True,
        "m_Font": _FONT,
        "m_Color": white,
    }
    return renderer(_FONT_MATERIAL), Component("TextMesh", 102, text, can_be_disabled=False)


def subscriber(topic: str, type_: str, **fields: Value) -> Component:
    """Return a Topic Subscriber."""
    return behaviour("TopicSubscriber", topic=topic, type=type_, **fields)

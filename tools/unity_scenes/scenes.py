# SPDX-License-Identifier: Apache-2.0
"""The demonstrations as scenes, with the settings and materials that they refer to."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from tools.unity_metas import HOME
from tools.unity_scenes.asset import Asset, Component, Node, Reference, Value, Vector
from tools.unity_scenes.parts import (
    behaviour,
    camera,
    collider,
    guid_of,
    light,
    line,
    material,
    mesh,
    renderer,
    shows_text,
    source_of,
    subscriber,
    words,
)

_SAMPLES: Final = HOME / "displays/Samples~"
_TELEOPERATION: Final = _SAMPLES / "Teleoperation"
_XR_TARGET: Final = _SAMPLES / "XrTarget"

_COLOURS: Final = {
    "Floor": (0.35, 0.37, 0.4),
    "Robot": (0.2, 0.2, 0.22),
    "Nose": (1.0, 0.92, 0.016),
    "Target": (0.0, 1.0, 0.0),
}
# the parts of each sample that have materials
_PARTS: Final = {
    _TELEOPERATION: ("Floor", "Robot", "Nose"),
    _XR_TARGET: ("Floor", "Robot", "Nose", "Target"),
}
# Standard, and URP's Lit. A material of one is pink in the other.
_SHADERS: Final = {
    "": Reference(file_id=46, guid="0000000000000000f000000000000000", kind=0),
    " URP": Reference(file_id=4800000, guid="933532a4fcc9baf4fa0491de14d08ed7", kind=3),
}


def scenes() -> Iterator[tuple[Path, str]]:
    """Yield every file and its text."""
    for folder, parts in _PARTS.items():
        yield folder / "Gateway.asset", _settings()
        for name in parts:
            for pipeline in _SHADERS:
                yield (
                    folder / "Materials" / f"{name}{pipeline}.mat",
                    _material(name, pipeline, _COLOURS[name]),
                )
    for path, roots in (
        (_TELEOPERATION / "Teleoperation.unity", list(_teleoperation())),
        (_XR_TARGET / "XrTarget.unity", list(_xr_target())),
    ):
        yield path, Asset(path.stem).text(roots, _scene_settings())


def _teleoperation() -> Iterator[Node]:
    folder = _TELEOPERATION
    yield from _room(folder)
    eyes = Node("Eyes", [camera()], position=(0.0, 1.6, 0.0), tag="MainCamera")
    walk = behaviour("PlayerWalk", eyes=Reference("Eyes", "Transform"))
    yield Node("Player", [walk], [eyes], position=(0.0, 0.0, -2.0))
    yield _picture((0.0, 2.0, 3.0))
    odometry = subscriber("/odom", "nav_msgs/msg/Odometry", maxRate=5.0)
    yield Node(
        *("Text Screen", [*words(), odometry, behaviour("TextScreen")]), position=(-3.0, 2.6, 3.0)
    )
    yield Node("Log Screen", [*words(), behaviour("LogScreen")], position=(1.2, 2.6, 3.0))
    battery = subscriber("/battery_state", "sensor_msgs/msg/BatteryState", maxRate=1.0)
    yield Node(
        *("Battery", [*words(), battery, behaviour("BatteryDisplay")]), position=(-0.8, 1.2, 3.0)
    )
    yield Node("Connection HUD", [*words(), behaviour("ConnectionHud")], position=(0.0, 1.2, 3.0))
    yield Node("Drive's State", words(), position=(1.2, 1.2, 3.0))
    status = shows_text("Drive's State")
    yield Node("Teleop Driver", [behaviour("TeleopDriver", onStatus=status)])
    scan: list[Component] = [
        *(mesh(), renderer(None), subscriber("/scan", "sensor_msgs/msg/LaserScan")),
        behaviour("LaserScanDisplay"),
    ]
    yield _twin(folder, [Node("Scan", scan, position=(0.0, 0.15, 0.0))])


def _xr_target() -> Iterator[Node]:
    folder = _XR_TARGET
    yield from _room(folder)
    yield _picture((0.0, 2.0, 4.0))
    yield Node("Connection HUD", [*words(), behaviour("ConnectionHud")], position=(-2.5, 2.6, 4.0))
    yield Node("Drive's State", words(), position=(-2.5, 1.2, 4.0))
    yield _twin(folder, [])
    yield _part(folder, "Cylinder", "Target", "Target", (0.0, 0.0, 0.0), (0.2, 0.005, 0.2))
    driver = behaviour(
        "TargetDriver",
        odometry=Reference("Digital Twin", "TopicSubscriber"),
        origin=Reference("Odometry's Origin", "Transform"),
        marker=Reference("Target", "Transform"),
        onStatus=shows_text("Drive's State"),
    )
    yield Node("Target Driver", [driver])
    head = Node(
        *("Eyes", [camera(), behaviour("XrHead")]),
        position=(0.0, 1.6, 0.0),
        turn=(25.0, 0.0, 0.0),
        tag="MainCamera",
    )
    control = behaviour(
        "XrTargetControl",
        driver=Reference("Target Driver", "TargetDriver"),
        rig=Reference("Rig", "Transform"),
        head=Reference("Eyes", "Transform"),
        line=Reference("Rig", "LineRenderer"),
    )
    yield Node("Rig", [line(0.005), control], [head], position=(0.0, 0.0, -2.0))


def _room(folder: Path) -> Iterator[Node]:
    settings = Reference(file_id=11400000, guid=guid_of(folder / "Gateway.asset"), kind=2)
    yield Node("Gateway Connection", [behaviour("GatewayConnection", settings=settings)])
    floor = [mesh("Plane"), renderer(_surface(folder, "Floor")), collider("Plane")]
    yield Node("Floor", floor)
    yield Node("Light", [light()], turn=(50.0, -30.0, 0.0))


def _picture(position: Vector) -> Node:
    camera_topic = subscriber("/camera/image_raw", "sensor_msgs/msg/Image", maxRate=15.0)
    screen: list[Component] = [mesh("Quad"), renderer(), camera_topic, behaviour("ImageScreen")]
    return Node("Image Screen", screen, position=position, scale=(1.6, 1.2, 1.0))


def _twin(folder: Path, more: list[Node]) -> Node:
    parts = [
        _part(folder, "Cylinder", "Body", "Robot", (0.0, 0.08, 0.0), (0.28, 0.05, 0.28)),
        _part(folder, "Cube", "Nose", "Nose", (0.0, 0.1, 0.12), (0.05, 0.03, 0.05)),
        *more,
    ]
    odometry = subscriber("/odom", "nav_msgs/msg/Odometry")
    twin = Node("Digital Twin", [odometry, behaviour("DigitalTwin")], parts)
    return Node("Odometry's Origin", children=[twin])


def _part(
    folder: Path, shape: str, name: str, colour: str, position: Vector, scale: Vector
) -> Node:
    """Return a visible object at the floor that rays go through."""
    parts = [mesh(shape), renderer(_surface(folder, colour))]
    return Node(name, parts, position=position, scale=scale)


def _surface(folder: Path, name: str) -> Reference:
    return material(folder / "Materials" / f"{name}.mat")


def _material(name: str, pipeline: str, color: tuple[float, float, float]) -> str:
    shown: Value = dict(zip("rgba", (*color, 1.0), strict=True))
    return Asset(name + pipeline).single(
        *(21, "Material", 2100000),
        {
            "serializedVersion": 8,
            "m_Name": name + pipeline,
            "m_Shader": _SHADERS[pipeline],
            "m_SavedProperties": {
                "serializedVersion": 3,
                "m_Colors": [{"_BaseColor" if pipeline else "_Color": shown}],
            },
        },
    )


def _settings() -> str:
    return Asset("Gateway").single(
        *(114, "MonoBehaviour", 11400000),
        {
            "m_Enabled": True,
            "m_Script": Reference(file_id=11500000, guid=guid_of(source_of("GatewaySettings"))),
            "m_Name": "Gateway",
            "Address": "ws://localhost:9090",
        },
    )


def _scene_settings() -> str:
    """Return what every scene has. All of it keeps Unity's defaults."""
    kinds = ((29, "OcclusionCullingSettings"), (104, "RenderSettings"), (157, "LightmapSettings"))
    return "".join(
        f"--- !u!{class_id} &{number}\n{kind}:\n  m_ObjectHideFlags: 0\n"
        for number, (class_id, kind) in enumerate((*kinds, (196, "NavMeshSettings")), start=1)
    )

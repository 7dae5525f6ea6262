# SPDX-License-Identifier: Apache-2.0
"""The prefabs: each component, and topics of the types that scenes often have."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from tools.unity_metas import PACKAGES
from tools.unity_scenes.asset import Asset, Node, Reference
from tools.unity_scenes.parts import behaviour, camera, mesh, renderer, subscriber, words

# The topics of these types by convention. Other types get a topic after their name.
_TOPICS: Final = {
    "std_msgs/msg/String": "/chatter",
    "geometry_msgs/msg/Twist": "/cmd_vel",
    "geometry_msgs/msg/TwistStamped": "/cmd_vel",
    "geometry_msgs/msg/PoseStamped": "/goal_pose",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "/initialpose",
    "nav_msgs/msg/Odometry": "/odom",
}
# Topics that scenes often have with nothing next to them: commands, and simple values.
_PUBLISHED: Final = (
    *("std_msgs/msg/Bool", "std_msgs/msg/Float64", "std_msgs/msg/String"),
    *("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"),
    *("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"),
)
_HEARD: Final = (
    *("std_msgs/msg/Bool", "std_msgs/msg/Float64", "std_msgs/msg/String"),
    *("nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu"),
)


def prefabs() -> Iterator[tuple[Path, str]]:
    """Yield each prefab's path and its text."""
    client, displays, robots = (one / "Prefabs" for one in PACKAGES)
    for name in _PUBLISHED:
        yield _part(client, "Publisher", name)
    for name in _HEARD:
        yield _part(client, "Subscriber", name)
    for folder, nodes in (
        (client, _basics()),
        (displays, (*_screens(), *_displays(), *_drivers())),
        (robots, _robots()),
    ):
        for node in nodes:
            yield folder / f"{node.name}.prefab", Asset(f"Components/{node.name}").text([node])


def topic_of(type_: str) -> str:
    """Return a likely topic of a type."""
    name = type_.rsplit("/", 1)[-1]
    return _TOPICS.get(type_, "/" + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower())


def _part(folder: Path, kind: str, type_: str) -> tuple[Path, str]:
    package, _, name = type_.split("/")
    key = f"{kind}s/{package}/{name}"
    part = behaviour(f"Topic{kind}", topic=topic_of(type_), type=type_)
    return folder / f"{key}.prefab", Asset(key).text([Node(f"{name} {kind}", [part])])


def _basics() -> Iterator[Node]:
    yield Node("Gateway Connection", [behaviour("GatewayConnection")])
    yield Node("Topic Subscriber", [behaviour("TopicSubscriber")])
    yield Node("Topic Publisher", [behaviour("TopicPublisher")])


def _screens() -> Iterator[Node]:
    picture = [
        *(mesh("Quad"), renderer()),
        subscriber("/camera/image_raw", "sensor_msgs/msg/Image"),
        behaviour("ImageScreen"),
    ]
    yield Node("Image Screen", picture, scale=(1.6, 1.2, 1.0))
    yield Node("Text Screen", [*words(), subscriber("/chatter", ""), behaviour("TextScreen")])
    yield Node("Log Screen", [*words(), behaviour("LogScreen")])
    battery = subscriber("/battery_state", "sensor_msgs/msg/BatteryState")
    yield Node("Battery", [*words(), battery, behaviour("BatteryDisplay")])
    yield Node("Connection HUD", [*words(), behaviour("ConnectionHud")])


def _displays() -> Iterator[Node]:
    for name, component, topic, type_ in (
        ("Laser Scan", "LaserScanDisplay", "/scan", "sensor_msgs/msg/LaserScan"),
        ("Point Cloud", "PointCloudDisplay", "/points", "sensor_msgs/msg/PointCloud2"),
        ("Map", "OccupancyGridDisplay", "/map", "nav_msgs/msg/OccupancyGrid"),
        ("Path", "PathDisplay", "/plan", "nav_msgs/msg/Path"),
        ("Pose", "PoseDisplay", "/goal_pose", "geometry_msgs/msg/PoseStamped"),
        ("Pose Array", "PoseArrayDisplay", "/particle_cloud", "geometry_msgs/msg/PoseArray"),
        ("Odometry Trail", "OdometryTrail", "/odom", "nav_msgs/msg/Odometry"),
    ):
        drawn = [mesh(), renderer(None), subscriber(topic, type_), behaviour(component)]
        yield Node(name, drawn)
    depth = subscriber(
        *("/camera/depth/image_raw", "sensor_msgs/msg/Image"), imageFormat="png", maxRate=5.0
    )
    yield Node("Depth", [mesh(), renderer(None), depth, behaviour("DepthDisplay")])
    markers = subscriber("/markers", "visualization_msgs/msg/MarkerArray", queue=32)
    yield Node("Markers", [markers, behaviour("MarkerArrayDisplay")])
    odometry = subscriber("/odom", "nav_msgs/msg/Odometry")
    yield Node("Digital Twin", [odometry, behaviour("DigitalTwin")])


def _robots() -> Iterator[Node]:
    joints = subscriber("/joint_states", "sensor_msgs/msg/JointState")
    yield Node(
        "Robot",
        [
            subscriber("/robot_description", "std_msgs/msg/String"),
            behaviour("RobotDescriptionDisplay"),
        ],
        [Node("Joint States", [joints, behaviour("JointStateDisplay")])],
    )


def _drivers() -> Iterator[Node]:
    for name in (
        *("TeleopDriver", "TargetDriver", "FixedFrame", "FrameFollower"),
        *("GoalPosePublisher", "NavigateToPose", "RobotRecorder"),
    ):
        yield Node(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name), [behaviour(name)])
    pictures = behaviour(
        "TopicPublisher",
        topic="/unity/image/compressed",
        type="sensor_msgs/msg/CompressedImage",
        rate=10.0,
    )
    seen = behaviour("TexturePublisher", camera=Reference("Texture Publisher", "Camera"))
    yield Node("Texture Publisher", [camera(), pictures, seen])

# SPDX-License-Identifier: Apache-2.0
"""The prefabs: a subscriber and a publisher for each message type, and each component."""

import re
from collections.abc import Iterator
from typing import Final

from schemas.table import Row, Table
from tools.unity_scenes.asset import Node, Reference
from tools.unity_scenes.parts import behaviour, camera, mesh, renderer, subscriber, words

# The topics of these types by convention. Other types get a topic after their name.
_TOPICS: Final = {
    "std_msgs/msg/String": "/chatter",
    "geometry_msgs/msg/Twist": "/cmd_vel",
    "geometry_msgs/msg/TwistStamped": "/cmd_vel",
    "geometry_msgs/msg/PoseStamped": "/goal_pose",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "/initialpose",
    "sensor_msgs/msg/Image": "/camera/image_raw",
    "sensor_msgs/msg/CompressedImage": "/camera/image_raw/compressed",
    "sensor_msgs/msg/LaserScan": "/scan",
    "sensor_msgs/msg/PointCloud2": "/points",
    "sensor_msgs/msg/JointState": "/joint_states",
    "nav_msgs/msg/Odometry": "/odom",
    "nav_msgs/msg/OccupancyGrid": "/map",
    "nav_msgs/msg/Path": "/plan",
    "rosgraph_msgs/msg/Clock": "/clock",
    "diagnostic_msgs/msg/DiagnosticArray": "/diagnostics",
    "visualization_msgs/msg/MarkerArray": "/markers",
}


def prefabs() -> Iterator[tuple[str, Node]]:
    """Yield each prefab's path below the folder of prefabs, without its ending, and its object."""
    for row in Table.load().rows:
        package, _, name = row.name.split("/")
        if row.directions in {"both", "subscribe"}:
            yield f"Subscribers/{package}/{name}", _subscriber(row, name)
        if row.directions in {"both", "publish"}:
            yield f"Publishers/{package}/{name}", _publisher(row, name)
    for node in (*_screens(), *_displays(), *_others()):
        yield f"Components/{node.name}", node


def topic_of(row: Row) -> str:
    """Return a likely topic of a type."""
    name = row.name.rsplit("/", 1)[-1]
    return _TOPICS.get(row.name, "/" + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower())


def _subscriber(row: Row, name: str) -> Node:
    return Node(f"{name} Subscriber", [subscriber(topic_of(row), row.name)])


def _publisher(row: Row, name: str) -> Node:
    made = behaviour("TopicPublisher", topic=topic_of(row), type=row.name)
    return Node(f"{name} Publisher", [made])


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
    joints = subscriber("/joint_states", "sensor_msgs/msg/JointState")
    yield Node(
        "Robot",
        [
            subscriber("/robot_description", "std_msgs/msg/String"),
            behaviour("RobotDescriptionDisplay"),
        ],
        [Node("Joint States", [joints, behaviour("JointStateDisplay")])],
    )
    odometry = subscriber("/odom", "nav_msgs/msg/Odometry")
    yield Node("Digital Twin", [odometry, behaviour("DigitalTwin")])


def _others() -> Iterator[Node]:
    for name in (
        *("GatewayConnection", "TeleopDriver", "TargetDriver", "FixedFrame", "FrameFollower"),
        *("GoalPosePublisher", "NavigateToPose"),
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

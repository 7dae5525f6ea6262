# SPDX-License-Identifier: Apache-2.0
"""Lines to try, fit for the ROS graph of this moment."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Final

from gateway.access.permissions import Action
from gateway.sources.graph import Graph, TopicInfo

DOCS: Final = "run ros2-gateway --help on the gateway's computer: it names the documentation there"

May = Callable[[Action, str], bool]

_STRING: Final = "std_msgs/msg/String"
_CHATTER: Final = "/chatter"
_ROSAPI: Final = "/rosapi/nodes"  # a call that changes nothing, and that the gateway answers itself
# Topics of every system: a person wants to see those of the robot.
_COMMON: Final = frozenset(
    {"/rosout", "/parameter_events", "/diagnostics", "/tf", "/tf_static", "/clock"}
)
# A single message of these fills a terminal.
_LARGE: Final = frozenset(
    {
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/CompressedImage",
        "sensor_msgs/msg/PointCloud",
        "sensor_msgs/msg/PointCloud2",
        "sensor_msgs/msg/LaserScan",
        "nav_msgs/msg/OccupancyGrid",
        "nav_msgs/msg/Path",
        "visualization_msgs/msg/MarkerArray",
    }
)
_PARAMETERS: Final = "/list_parameters"


def frames_to_try(graph: Graph, may: May) -> Mapping[str, dict[str, Any]]:
    """Return a few frames by what they are for. Each is accepted as it is.

    *graph* has the names that the client may see, and *may* returns what it may do. Nothing
    here moves a robot.
    """
    return dict(_frames(graph, may))


def _frames(graph: Graph, may: May) -> Iterator[tuple[str, dict[str, Any]]]:
    yield "what there is", {"op": "graph"}
    topic = _topic(graph.topics, may)
    if topic is not None:
        subscribe = {"op": "subscribe", "topic": topic, "throttle_rate": 1000}
        yield "a topic, at most once a second", subscribe
        yield "no more of it", {"op": "unsubscribe", "topic": topic}
        yield "its type, and how to publish it", {"op": "describe", "type": topic}
    if may("publish", _CHATTER) and _is_free(_CHATTER, graph.topics):
        hello = {"op": "publish", "topic": _CHATTER, "type": _STRING, "msg": {"data": "hello"}}
        yield "publish", hello
    if may("call", _ROSAPI):
        yield "call a service", {"op": "call_service", "service": _ROSAPI}
    action = next(
        (e.name for e in graph.actions if len(e.types) == 1 and may("call", e.name)), None
    )
    if action is not None:
        yield "an action, and how to send a goal", {"op": "describe", "type": action}
    node = _node(graph, may)
    if node is not None:
        yield "the parameters of a node", {"op": "list_parameters", "node": node}


def _topic(topics: Iterable[TopicInfo], may: May) -> str | None:
    """Choose a topic that shows something: of the robot rather than of ROS, and of small messages.

    Of one type, or a subscription would have to name it.
    """
    heard = (
        each
        for each in topics
        if each.publishers and len(each.types) == 1 and may("subscribe", each.name)
    )
    ranked = ((each.name in _COMMON, each.types[0] in _LARGE, each.name) for each in heard)
    best = min(ranked, default=None)
    return None if best is None else best[2]


def _is_free(name: str, topics: Iterable[TopicInfo]) -> bool:
    """Return whether a string may be published there: by its type, and with nobody who acts."""
    return all(each.types == (_STRING,) for each in topics if each.name == name)


def _node(graph: Graph, may: May) -> str | None:
    services = (each.name for each in graph.services)
    nodes = (each.removesuffix(_PARAMETERS) for each in services if each.endswith(_PARAMETERS))
    seen = set(graph.nodes)
    return next((each for each in nodes if each in seen and may("call", each + _PARAMETERS)), None)

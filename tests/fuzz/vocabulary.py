# SPDX-License-Identifier: Apache-2.0
"""The operations of the conversations: right, nearly right, and hostile, each with a verdict."""

import random
from dataclasses import dataclass
from typing import Any, Literal

from hypothesis import strategies as st

from benchmarks import bombs as of_arrays
from benchmarks import hostile_frames
from benchmarks.hostile_frames import HostileFrame
from gateway.fronts.rosbridge.operations import OPERATIONS
from tests.core import test_bad_input, test_extreme_numbers
from tests.fuzz import types
from tests.fuzz.stage import SETTINGS, TOPICS

Verdict = Literal["good", "maybe", "bad"]


@dataclass(frozen=True)
class Said:
    """A part of an operation. "bad" is refused, "maybe" is where the model does not decide."""

    members: dict[str, Any]
    verdict: Verdict = "good"
    codes: frozenset[str] = frozenset({"bad_request"})

    def is_part_of(self, operation: dict[str, Any]) -> bool:
        """True unless a later one has replaced a member. Compares by identity: 1 equals True."""
        return all(operation[key] is value for key, value in self.members.items())


def bad(members: dict[str, Any], *codes: str) -> Said:
    return Said(members, "bad", frozenset(codes or ("bad_request",)))


def maybe(members: dict[str, Any], *codes: str) -> Said:
    return Said(members, "maybe", frozenset(codes or ("bad_request",)))


NAMES = [*TOPICS, "/own", "/own/deeper", "words"]
TYPE_OF = {**TOPICS, "words": TOPICS["/words"], "/own": "std_msgs/msg/String"} | {
    "/own/deeper": "geometry_msgs/msg/PoseStamped"
}
IDS = ["a", "b", 3]

SUBSCRIBING = [
    Said({}),
    *(Said({"throttle_rate": rate}) for rate in (0, 1, 0.5, 1e-300, 3_600_000, 20.0)),
    *(bad({"throttle_rate": rate}) for rate in (-1, 1e9, "9", True, [])),
    *(Said({"queue_length": length}) for length in (0, 1, 5, 100)),
    *(bad({"queue_length": length}) for length in (-1, 0.5, "1")),
    maybe({"queue_length": 2**62}, "limit_exceeded"),
    *(Said({"compression": name}) for name in ("none", "cbor", "cbor-raw", "png", "zip", "")),
    *(Said({"fragment_size": size}) for size in (0, 64, 500, 2**31 - 1, None)),
    *(bad({"fragment_size": size}) for size in (1, 63, -1, 64.5, "64")),
    *(
        maybe({"image": options})
        for options in (
            {},
            {"format": "png"},
            {"max_width": 2, "quality": 1},
            {"max_fps": 0.001},
            {"format": "raw"},
            {"depth_range_m": [0, 0.05]},
            {"depth_range_m": [0, 1e300]},
        )
    ),
    *(
        bad({"image": options})
        for options in (
            {"quality": 0},
            {"max_fps": 1e-320},
            {"format": "tiff"},
            {"max_width": 0},
            {"depth_range_m": [1]},
            {"other": 1},
        )
    ),
    *(
        maybe({"cloud": options})
        for options in ({}, {"max_points": 5}, {"voxel_m": 0.1, "fields": ["x"]})
    ),
    *(
        bad({"cloud": options})
        for options in ({"max_points": 0}, {"voxel_m": 0}, {"fields": 1}, {"other": 1})
    ),
    *(
        maybe({"qos": qos}, "bad_request", "qos_incompatible")
        for qos in ({"depth": 1}, {"reliability": "reliable"}, {"durability": "transient_local"})
    ),
    *(
        maybe({"qos": qos}, "bad_request", "qos_incompatible", "internal")
        for qos in ({"deadline": 1e-9}, {"lifespan": 1e9}, {"deadline": {"secs": 1}})
    ),
    *(bad({"qos": qos}) for qos in ({"depth": 0}, {"depth": 1025}, {"deadline": -1}, {"x": 1}, 7)),
    maybe({"fields": ["header.stamp", "data"]}),
    Said({"fields": []}),
    Said({"meta": True}),
    bad({"meta": 1}),
]
# of a String. The second ones do not fit
GOOD_MESSAGES: list[Any] = [
    {},
    *({"data": text} for text in ("", "grüße", "x" * 5000, "\U0001f916")),
]
BAD_MESSAGES: list[Any] = [
    *({"data": value} for value in (1, None, {}, "a\0b", [1] * 10)),
    *({"nonsense": 1}, [], "x", 5, None),
]
BAD_NAMES = ["", "/", "a b", "//x", "/a/", "~", "~/x", "{node}", "/1a", "/a" * 300, "/cmd_vel\0z"]
SILENT_S = 0.05  # for a service that never answers
ROSAPI = [
    *("topics", "services", "nodes", "get_time", "interfaces", "action_servers", "nope"),
    *("topics_and_raw_types", "get_ros_version", "topics_for_type", "topic_type", "publishers"),
    *("subscribers", "service_type", "service_node", "node_details", "message_details"),
    *("action_goal_details", "service_request_details", "get_param", "set_param", "has_param"),
    *("delete_param", "get_param_names", "service_providers", "services_for_type"),
]
ARGUMENTS: list[Any] = [
    *(None, {}, [], [1], ["std_msgs/String"], ["/words"], {"type": "nope"}, {"x": 1}, "text", 5),
    *({"name": "/ros2_gateway_debug:use_sim_time"}, {"name": ":"}, ["a:b", "["], ["a" * 2000]),
    *({"type": "geometry_msgs/Twist"}, {"topic": "/words"}, {"service": "/arm"}, {"node": "/"}),
]
CALLS: list[Any] = [{"data": True}, [True], {}, [], None, {"data": 1}, [True, 2], "x", {"y": {}}]
ANSWERS: list[dict[str, Any]] = [
    {"values": {"success": True, "message": "done"}},
    {"values": {"success": "yes"}},
    {"values": [True, "done", 3]},
    {"values": None},
    {"result": False},
    {"result": False, "values": "broken"},
    {"result": "yes", "values": {}},
    {"values": {"message": "m" * 3000}},
]
RESULTS: list[dict[str, Any]] = [
    *({"values": {"sequence": [1]}, "status": status} for status in (4, 5, 6, 0, 99, -1)),
    {"values": {"sequence": ["x"]}, "status": 4},
    {"result": False},
    {"values": {"sequence": [2**40]}, "status": 4},
    {"status": "done"},
]
# operations that need nothing, and have an answer of that name. The codes are those of a refusal
ASKED: list[tuple[dict[str, Any], str, frozenset[str]]] = [
    *(
        ({"op": "ping", "value": value}, "pong", frozenset())
        for value in (None, 1.5, 2**63, "x" * 900, [[{}]], 1e308)
    ),
    ({"op": "hello"}, "hello", frozenset()),
    ({"op": "help"}, "help", frozenset()),
    *(
        ({"op": "describe", "type": name}, "describe", frozenset({"bad_type"}))
        for name in (1, 0, -7, 10**12, "std_msgs/String", "std_srvs/SetBool", "a/b", "", "x" * 500)
    ),
    *(({"op": "graph", "watch": watch}, "graph", frozenset()) for watch in (None, True, False)),
    ({"op": "graph", "watch": "x"}, "graph", frozenset({"bad_request"})),
    *(
        ({"op": op, "topic": topic}, op, frozenset({"not_found", "bad_name", "tripped"}))
        for op in ("stop", "control", "acquire_control", "release_control")
        for topic in (None, "/cmd_vel", "/words", "a b")
    ),
    ({"op": "control", "watch": True}, "control", frozenset()),
    ({"op": "auth", "token": "any"}, "auth", frozenset()),
    ({"op": "auth", "token": 7}, "auth", frozenset({"bad_request"})),
]
# the same, but a node has to answer, a frame to appear, or a thread to write
ASKED_OF_NODES: list[dict[str, Any]] = [
    *(
        {"op": "generate", "language": language, "types": [name], "asmdef": asmdef}
        for language in ("csharp", "python", "perl")
        for name in ("std_msgs/msg/String", "tf2_msgs/srv/FrameGraph", "a/b", "", "x" * 500, 7)
        for asmdef in (None, "A.B", "../x", 7)
    ),
    *(
        {"op": "fetch_asset", "uri": uri, "offset": offset}
        for uri in ("package://rclpy/x.stl", "package://%00/%ff.stl", "x" * 500, "", 7)
        for offset in (0, -1, 2**63, 1e308, "x")
    ),
    *(
        {"op": "record", "action": action, "topics": topics, "episode": episode, "text": text}
        for action in ("start", "stop", "mark", "status", "x")
        for topics in (None, ["**"], ["/a b"], [], 7)
        for episode, text in (("start", "x"), ("end", "x" * 201), (7, None))
    ),
    *(
        {"op": op, "node": node}
        for op in ("list_parameters", "get_parameters", "describe_parameters")
        for node in ("/ros2_gateway_debug", "outside", "/nobody", "", "a b", "/" * 9)
    ),
    *(
        {"op": "get_parameters", "node": "/ros2_gateway_debug", "names": names}
        for names in ([], ["use_sim_time"], ["nope"], [""], ["a\0"], ["x"] * 1025, "use_sim_time")
    ),
    *(
        {"op": "set_parameters", "node": "/ros2_gateway_debug", "values": values}
        for values in (
            {"use_sim_time": "yes"},
            {"use_sim_time": False},
            {"nope": 1e308, "": None},
            {"a\0": 1},
            {},
            {"x": [1, "a"]},
            {"x": {"y": 1}},
            {"use_sim_time": 2**64},
        )
    ),
    *(
        {"op": "lookup_transform", "target_frame": a, "source_frame": b, "timeout": 0.01, **more}
        for a, b in (("a", "b"), ("", ""), ("x" * 257, "a"), ("a", "a\0"))
        for more in ({}, {"time": {"sec": 1}}, {"time": {"sec": -1}}, {"timeout": 1e9})
    ),
]
# requests to tf2_web_republisher, in no order
TF_NODE = "/tf2_web_republisher"
ASKED_FOR_ARRAYS: list[dict[str, Any]] = [
    *(
        operation
        for frames in ({}, {"rate": 200, "timeout": {"secs": 0, "nsecs": 1}}, {"rate": 1e-320})
        for request in ({"source_frames": ["a", "/b", ""], "target_frame": "b", **frames},)
        for operation in (
            {"op": "send_action_goal", "action": TF_NODE, "feedback": True, "args": request},
            {"op": "call_service", "service": "republish_tfs", "args": request},
            {"op": "subscribe", "topic": f"{TF_NODE}/tf_repub_1", "fragment_size": 64},
            {"op": "unsubscribe", "topic": f"{TF_NODE}/tf_repub_1"},
            {"op": "publish", "topic": f"{TF_NODE}/goal", "msg": {"goal_id": {}, "goal": request}},
            {"op": "subscribe", "topic": f"{TF_NODE}/feedback"},
            {"op": "publish", "topic": f"{TF_NODE}/cancel", "msg": {}},
            {"op": "unsubscribe", "topic": f"{TF_NODE}/feedback"},
        )
    ),
]
GARBAGE: list[str | bytes] = [
    *("", " ", "{", "[]", "null", "[" * 5000, '{"op":5}', '{"op":"x"}', '{"op":"subscribe"}'),
    *('{"op":"ping","op":"ping"}', '{"op":null}', '"' + "a" * 60_000 + '"', "{}" * 9, "NaN"),
    *('{"op":"publish","topic":"/own","msg":{"data":1e999}}', '{"op":"ping","id":"' + "i" * 300),
    *('{"op":"ping","value":"\\ud800"}', '{"op":"fragment","id":"f","num":-1,"total":1,"data":""}'),
    *(b"\xff\xfe", b'{"op":"ping"', b"\0" * 100, b"[" + b"[]," * 15_000 + b"0]"),
]
TOO_LONG = SETTINGS["limits.max_message_bytes"] + 1
# bytes on the wire, and the close codes of docs/reference/errors.md that may answer them
BROKEN_WIRE: list[tuple[bytes, frozenset[int]]] = [
    (b"\x81\x82\0\0\0\0\xff\xfe", frozenset({1007})),  # a text that is not UTF-8
    (b"\x83\x80\0\0\0\0", frozenset({1002})),  # a reserved opcode
    (b"\xc1\x80\0\0\0\0", frozenset({1002})),  # a reserved bit
    (b"\x81\x02{}", frozenset({1002})),  # without a mask
    (b"\x89\xfe\x00\x80\0\0\0\0" + b"p" * 128, frozenset({1002})),  # a ping too long
    (b"\x80\x80\0\0\0\0", frozenset({1002})),  # a continuation of nothing
    (b"\x81\xff" + (TOO_LONG).to_bytes(8, "big") + bytes(4), frozenset({1009})),
    (b"\x81\xff" + b"\x7f" + b"\xff" * 7 + bytes(4), frozenset({1009})),
    (b"\x88\x81\0\0\0\0\x03", frozenset({1002})),  # half a close code
]


def bombs() -> list[HostileFrame]:
    """Return messages that take most for what they say: as many elements as are looked at."""
    found = [
        each.frame(min(20_000, 900_000 // (len(each.element) + 1)))
        for each in of_arrays.bombs(types.definitions())
        if each.type_name.startswith(("visualization_msgs", "nav_msgs", "trajectory_msgs"))
    ]
    plain = [each for each in hostile_frames.plain_frames() if len(each.data) < 2**20]
    return found[::7] + plain


def nearly_right(op: str, seed: int) -> dict[str, Any]:
    return test_bad_input.operations(random.Random(seed), op)


operations = sorted(OPERATIONS)
extremes = st.sampled_from(operations).flatmap(
    lambda op: test_extreme_numbers.operations(op).map(
        lambda members: test_extreme_numbers.written({**members, "op": op})
    )
)
pick = st.sampled_from
numbers = st.integers(0, 1000)

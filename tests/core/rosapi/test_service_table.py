# SPDX-License-Identifier: Apache-2.0
from collections.abc import Sequence
from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.core.errors import ProtocolError
from gateway.core.rosapi import Parameters, Rosapi, interfaces_prefix
from gateway.core.service_clients import ServiceClients
from schemas.installed import InstalledDefinitions, installed_prefixes
from tests.sources.fake import FakeRos

# the services of the contract, with their requests
ARGUMENTS: dict[str, dict[str, str]] = {
    "topics": {},
    "topics_for_type": {"type": "nav_msgs/msg/Odometry"},
    "topics_and_raw_types": {},
    "topic_type": {"topic": "/odom"},
    "services": {},
    "services_for_type": {"type": "std_srvs/srv/SetBool"},
    "service_type": {"service": "/light"},
    "service_node": {"service": "/light"},
    "service_providers": {"service": "std_srvs/srv/SetBool"},
    "nodes": {},
    "node_details": {"node": "/lamp"},
    "publishers": {"topic": "/odom"},
    "subscribers": {"topic": "/odom"},
    "action_servers": {},
    "message_details": {"type": "nav_msgs/Odometry"},
    "service_request_details": {"type": "rcl_interfaces/SetParameters"},
    "service_response_details": {"type": "rcl_interfaces/SetParameters"},
    "get_param": {"name": "/lamp:level", "default_value": "1"},
    "set_param": {"name": "/lamp:level", "value": "1"},
    "delete_param": {"name": "/lamp:level"},
    "has_param": {"name": "/lamp:level"},
    "get_param_names": {},
    "get_time": {},
    "get_ros_version": {},
    "interfaces": {},
    "action_type": {"action": "/fibonacci"},
    "action_goal_details": {"type": "test_msgs/Fibonacci"},
    "action_result_details": {"type": "test_msgs/Fibonacci"},
    "action_feedback_details": {"type": "test_msgs/Fibonacci"},
}
LOCAL = [name for name in ARGUMENTS if "param" not in name]


def build(ros: FakeRos) -> Rosapi:
    definitions = InstalledDefinitions([*installed_prefixes(), interfaces_prefix()])
    return Rosapi(ros, definitions, Parameters(ros, Types(definitions), ServiceClients(ros)))


@pytest.fixture
async def ros() -> FakeRos:
    ros = FakeRos()
    ros.add_publisher("/odom", "nav_msgs/msg/Odometry", node="/base")
    ros.add_publisher("/odom", "nav_msgs/msg/Odometry", node="/base")
    ros.add_subscription("/odom", "nav_msgs/msg/Odometry", _ignore, node="/planner")
    ros.add_publisher("/_hidden/topic", "std_msgs/msg/String", node="/_daemon")
    ros.add_service("/light", "std_srvs/srv/SetBool", _ignore, node="/lamp")
    ros.add_action_server("/fibonacci", "test_msgs/action/Fibonacci", _ignore, _ignore)
    return ros


@pytest.fixture
async def rosapi(ros: FakeRos) -> Rosapi:
    return build(ros)


def _ignore(_: Any) -> None: ...


async def answer(
    rosapi: Rosapi, name: str, args: Any = None, timeout_s: float | None = None
) -> Any:
    answered = rosapi.answer(f"/rosapi/{name}", args, timeout_s)
    return answered if isinstance(answered, dict) else await answered()


async def test_every_service_of_the_contract_is_there(rosapi: Rosapi) -> None:
    assert set(rosapi.types()) == {f"/rosapi/{name}" for name in ARGUMENTS}


@pytest.mark.parametrize("name", sorted(ARGUMENTS))
async def test_every_answer_fits_its_type(rosapi: Rosapi, name: str) -> None:
    types = Types(InstalledDefinitions([interfaces_prefix(), *installed_prefixes()]))
    answered = await answer(rosapi, name, ARGUMENTS[name], timeout_s=0.05)  # of a silent node
    if name == "get_time":
        answered = {"time": {key: answered["time"][key] for key in ("sec", "nanosec")}}
    response = types.service(rosapi.type_of(f"/rosapi/{name}")).response
    response.encode(answered, 0)
    assert set(answered) == {field.name for field in response.definition.fields}


@pytest.mark.parametrize("name", LOCAL)
async def test_a_request_that_needs_no_other_node_is_answered_at_once(
    rosapi: Rosapi, name: str
) -> None:
    assert isinstance(rosapi.answer(f"/rosapi/{name}", ARGUMENTS[name]), dict)


@pytest.mark.parametrize("args", [None, {}, [], {"topic": ""}, [""]])
async def test_arguments_may_be_left_out(rosapi: Rosapi, args: Any) -> None:
    assert await answer(rosapi, "topic_type", args) == {"type": ""}


async def test_arguments_may_come_in_order(rosapi: Rosapi) -> None:
    assert await answer(rosapi, "topic_type", ["/odom"]) == {"type": "nav_msgs/msg/Odometry"}


@pytest.mark.parametrize(
    ("args", "reason"),
    [
        ({"topic": 5}, "args.topic: expected a string, got 5"),
        ({"topics": "/odom"}, "args.topics: unknown field"),
        (["/odom", "more"], "args: expected at most 1 element, got 2"),
        ("/odom", "args: expected an object, got a string"),
    ],
)
async def test_arguments_that_do_not_fit_are_refused(
    rosapi: Rosapi, args: Any, reason: str
) -> None:
    with pytest.raises(ProtocolError) as caught:
        await answer(rosapi, "topic_type", args)
    assert caught.value.code == "invalid_value"
    assert reason in str(caught.value)


async def test_topics_come_with_their_types_and_without_hidden_ones(rosapi: Rosapi) -> None:
    assert await answer(rosapi, "topics") == {
        "topics": ["/odom"],
        "types": ["nav_msgs/msg/Odometry"],
    }


@pytest.mark.parametrize(
    ("name", "args", "expected"),
    [
        ("topics_for_type", {"type": "nav_msgs/Odometry"}, {"topics": ["/odom"]}),
        ("topics_for_type", {"type": "nothing"}, {"topics": []}),
        ("topic_type", {"topic": "odom"}, {"type": "nav_msgs/msg/Odometry"}),
        ("topic_type", {"topic": "/nowhere"}, {"type": ""}),
        ("publishers", {"topic": "/odom"}, {"publishers": ["/base"]}),
        ("publishers", {"topic": "/nowhere"}, {"publishers": []}),
        ("subscribers", {"topic": "/odom"}, {"subscribers": ["/planner"]}),
        ("services_for_type", {"type": "std_srvs/SetBool"}, {"services": ["/light"]}),
        ("service_type", {"service": "light"}, {"type": "std_srvs/srv/SetBool"}),
        ("service_type", {"service": "/nowhere"}, {"type": ""}),
        ("service_node", {"service": "/light"}, {"node": "/lamp"}),
        ("service_node", {"service": "/nowhere"}, {"node": ""}),
        ("service_providers", {"service": "std_srvs/SetBool"}, {"providers": ["/lamp"]}),
        ("service_providers", {"service": "std_srvs/srv/Empty"}, {"providers": []}),
        ("action_servers", {}, {"action_servers": ["/fibonacci"]}),
        ("action_type", {"action": "/fibonacci"}, {"type": "test_msgs/action/Fibonacci"}),
        ("action_type", {"action": "/nowhere"}, {"type": ""}),
        ("get_ros_version", {}, {"version": 2, "distro": "jazzy"}),
    ],
)
async def test_the_graph_is_told(rosapi: Rosapi, name: str, args: Any, expected: Any) -> None:
    assert await answer(rosapi, name, args) == expected


async def test_a_node_is_told_by_what_it_has(rosapi: Rosapi) -> None:
    assert await answer(rosapi, "node_details", ["/planner"]) == {
        "subscribing": ["/odom"],
        "publishing": [],
        "services": [],
    }
    details = await answer(rosapi, "node_details", ["/base"])
    assert details["publishing"] == ["/odom"]


async def test_nodes_are_listed_without_hidden_ones(rosapi: Rosapi) -> None:
    nodes = (await answer(rosapi, "nodes"))["nodes"]
    assert {"/base", "/planner", "/lamp", "/rosapi"} <= set(nodes)
    assert "/_daemon" not in nodes


async def test_rosapi_tells_of_itself_as_a_node(rosapi: Rosapi) -> None:
    services = (await answer(rosapi, "services"))["services"]
    assert {"/light", "/rosapi/topics", "/rosapi/get_param"} <= set(services)
    assert services == sorted(services)
    assert await answer(rosapi, "service_type", ["/rosapi/topics"]) == {
        "type": "rosapi_msgs/srv/Topics"
    }
    assert await answer(rosapi, "service_node", ["/rosapi/topics"]) == {"node": "/rosapi"}
    own = (await answer(rosapi, "node_details", ["/rosapi"]))["services"]
    assert own == sorted(rosapi.types())


async def test_a_real_rosapi_node_is_not_listed_twice(ros: FakeRos, rosapi: Rosapi) -> None:
    ros.add_service("/rosapi/topics", "rosapi_msgs/srv/Topics", _ignore, node="/rosapi")
    services = (await answer(rosapi, "services"))["services"]
    assert services.count("/rosapi/topics") == 1


async def test_time_has_the_names_of_both_ros(ros: FakeRos, rosapi: Rosapi) -> None:
    ros.now = 5_000_000_007
    assert await answer(rosapi, "get_time") == {
        "time": {"sec": 5, "nanosec": 7, "secs": 5, "nsecs": 7}
    }


async def test_interfaces_of_all_kinds_are_listed(rosapi: Rosapi) -> None:
    interfaces: Sequence[str] = (await answer(rosapi, "interfaces"))["interfaces"]
    assert {
        "nav_msgs/msg/Odometry",
        "std_srvs/srv/SetBool",
        "test_msgs/action/Fibonacci",
        "rosapi_msgs/srv/Topics",
    } <= set(interfaces)


async def test_raw_types_hold_the_definitions_of_all_that_is_nested(rosapi: Rosapi) -> None:
    answered = await answer(rosapi, "topics_and_raw_types")
    (text,) = answered["typedefs_full_text"]
    own, *nested = text.split("=" * 80 + "\n")
    assert "geometry_msgs/PoseWithCovariance pose" in own
    titles = [part.splitlines()[0] for part in nested]
    assert "MSG: geometry_msgs/PoseWithCovariance" in titles
    assert "MSG: builtin_interfaces/Time" in titles
    assert len(set(titles)) == len(titles)


async def test_a_topic_of_a_type_that_is_not_installed_has_a_comment_for_a_definition(
    ros: FakeRos, rosapi: Rosapi
) -> None:
    ros.add_publisher("/strange", "strange_msgs/msg/Thing")
    answered = await answer(rosapi, "topics_and_raw_types")
    text = dict(zip(answered["topics"], answered["typedefs_full_text"], strict=True))["/strange"]
    assert text == "# no definition of strange_msgs/msg/Thing is installed\n"

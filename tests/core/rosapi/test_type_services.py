# SPDX-License-Identifier: Apache-2.0
from pathlib import Path
from typing import Any

import pytest

from gateway.codec.error_text import MAX_ECHO
from gateway.core.errors import ProtocolError
from gateway.core.rosapi.graph_services import GraphServices
from gateway.core.rosapi.type_services import TypeServices
from gateway.core.rosapi.typedefs import typedefs
from schemas.installed import InstalledDefinitions
from tests.sources.fake import FakeRos


@pytest.fixture
def definitions() -> InstalledDefinitions:
    return InstalledDefinitions()


@pytest.fixture
async def services(definitions: InstalledDefinitions) -> TypeServices:
    return TypeServices(GraphServices(FakeRos(), dict), definitions)


def member(definition: dict[str, Any], name: str) -> tuple[str, int, str]:
    """Return type, array length and example of a field."""
    index = definition["fieldnames"].index(name)
    lists = ("fieldtypes", "fieldarraylen", "examples")
    kind, length, example = (definition[each][index] for each in lists)
    return kind, length, example


def test_the_type_asked_for_comes_first_and_each_nested_one_once(
    definitions: InstalledDefinitions,
) -> None:
    names = [str(each["type"]) for each in typedefs("nav_msgs/msg/Odometry", definitions)]
    assert names[0] == "nav_msgs/Odometry"
    assert sorted(names) == [
        "builtin_interfaces/Time",
        "geometry_msgs/Point",
        "geometry_msgs/Pose",
        "geometry_msgs/PoseWithCovariance",
        "geometry_msgs/Quaternion",
        "geometry_msgs/Twist",
        "geometry_msgs/TwistWithCovariance",
        "geometry_msgs/Vector3",
        "nav_msgs/Odometry",
        "std_msgs/Header",
    ]


def test_every_nested_type_of_a_field_is_found_by_its_form(
    definitions: InstalledDefinitions,
) -> None:
    all_of: list[Any] = typedefs("sensor_msgs/msg/PointCloud2", definitions)
    known = {each["type"] for each in all_of}
    used = {name for each in all_of for name in each["fieldtypes"] if "/" in name}
    assert used <= known


@pytest.mark.parametrize(
    ("type_name", "field", "expected"),
    [
        ("test_msgs/msg/BasicTypes", "bool_value", ("boolean", -1, "False")),
        ("test_msgs/msg/BasicTypes", "byte_value", ("octet", -1, "0")),
        ("test_msgs/msg/BasicTypes", "char_value", ("uint8", -1, "0")),
        ("test_msgs/msg/BasicTypes", "float32_value", ("float", -1, "0.0")),
        ("test_msgs/msg/BasicTypes", "float64_value", ("double", -1, "0.0")),
        ("test_msgs/msg/BasicTypes", "int64_value", ("int64", -1, "0")),
        ("test_msgs/msg/Defaults", "int32_value", ("int32", -1, "-30000")),
        ("test_msgs/msg/Strings", "string_value", ("string", -1, "")),
        ("test_msgs/msg/Strings", "string_value_default1", ("string", -1, "Hello world!")),
        ("test_msgs/msg/Arrays", "int8_values", ("int8", 3, "[]")),
        (
            "test_msgs/msg/UnboundedSequences",
            "basic_types_values",
            ("test_msgs/BasicTypes", 0, "[]"),
        ),
        ("test_msgs/msg/BoundedSequences", "int8_values", ("int8", 0, "[]")),
        ("std_msgs/msg/Header", "stamp", ("builtin_interfaces/Time", -1, "{}")),
    ],
)
def test_fields_are_told_as_rosidl_has_them(
    definitions: InstalledDefinitions, type_name: str, field: str, expected: Any
) -> None:
    assert member(typedefs(type_name, definitions)[0], field) == expected


def test_constants_are_told_with_their_values(definitions: InstalledDefinitions) -> None:
    constants = typedefs("sensor_msgs/msg/NavSatStatus", definitions)[0]
    values = dict(zip(constants["constnames"], constants["constvalues"], strict=True))  # type: ignore[call-overload]  # lists, by contract
    assert values["STATUS_NO_FIX"] == "-1"
    assert values["SERVICE_GPS"] == "1"


def test_a_request_has_the_name_that_rosidl_gives_it(services: TypeServices) -> None:
    answered: Any = services.details("srv", "request")({"type": "std_srvs/SetBool"})
    (only,) = answered["typedefs"]
    assert only["type"] == "std_srvs/SetBool_Request"
    assert only["fieldnames"] == ["data"]


def test_details_of_result_and_feedback_are_returned(services: TypeServices) -> None:
    for role in ("result", "feedback"):
        answered: Any = services.details("action", role)({"type": "test_msgs/action/Fibonacci"})
        assert answered["typedefs"][0]["fieldnames"] == ["sequence"]


@pytest.mark.parametrize(
    ("type_name", "reason"),
    [
        ("", "'' is not a valid message type"),
        ("Odometry", "'Odometry' is not a valid message type"),
        ("Odometry", "did you mean nav_msgs/msg/Odometry?"),
        ("nav_msgs/Odometri", "did you mean nav_msgs/msg/Odometry?"),
        ("std_srvs/srv/SetBool", "is not a valid message type"),
    ],
)
def test_an_invalid_message_type_is_an_error(
    services: TypeServices, type_name: str, reason: str
) -> None:
    with pytest.raises(ProtocolError) as caught:
        services.message_details({"type": type_name})
    assert caught.value.code == "bad_type"
    assert reason in str(caught.value)


def test_an_invalid_service_type_is_an_error(services: TypeServices) -> None:
    with pytest.raises(ProtocolError, match=r"did you mean std_srvs/srv/SetBool\?") as caught:
        services.details("srv", "response")({"type": "std_srvs/SetBoool"})
    assert caught.value.code == "bad_type"


def test_a_long_invalid_type_name_comes_back_shortened(services: TypeServices) -> None:
    for name in ("x" * 10_000, f"{'x' * 10_000}/Thing"):
        with pytest.raises(ProtocolError) as caught:
            services.message_details({"type": name})
        assert caught.value.code == "bad_type"
        assert len(str(caught.value)) < 2 * MAX_ECHO


async def test_a_type_that_cannot_be_read_hides_no_other_topic(tmp_path: Path) -> None:
    messages = tmp_path / "share" / "some_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "Broken.msg").write_text("lost_msgs/Thing thing", encoding="utf-8")
    (messages / "Broken.json").write_text("{}", encoding="utf-8")
    (messages / "Fine.msg").write_text("int8 x", encoding="utf-8")
    ros = FakeRos()
    for name in ("Broken", "Fine"):
        ros.add_publisher(f"/{name.lower()}", f"some_msgs/msg/{name}")
    services = TypeServices(GraphServices(ros, dict), InstalledDefinitions([tmp_path]))
    assert services.topics_and_raw_types({})["typedefs_full_text"] == [
        "# no definition of lost_msgs/msg/Thing is installed\n",
        "int8 x",
    ]

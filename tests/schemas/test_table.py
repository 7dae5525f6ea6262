# SPDX-License-Identifier: Apache-2.0
"""The list of message types."""

import pytest

from schemas.installed import InstalledDefinitions
from schemas.table import (
    Table,
    TableError,
    TypeNameError,
    resolve_any,
    resolve_interface,
    resolve_type,
)

COMMON_INTERFACES = [
    "actionlib_msgs",
    "diagnostic_msgs",
    "geometry_msgs",
    "nav_msgs",
    "sensor_msgs",
    "shape_msgs",
    "std_msgs",
    "stereo_msgs",
    "trajectory_msgs",
    "visualization_msgs",
]


@pytest.fixture(scope="module")
def table():
    return Table.load()


def load(tmp_path, text):
    path = tmp_path / "messages.toml"
    path.write_text(text, encoding="utf-8")
    return Table.load(path)


def row(number, name):
    return f'{{ number = {number}, name = "{name}", directions = "both", purpose = "x" }}'


SERVICE_ROW = '{ name = "a/srv/B", purpose = "x" }'


def test_the_first_ten_numbers_are_the_historical_ones(table):
    assert [table.by_number[number].name for number in range(10)] == [
        "std_msgs/msg/String",
        "geometry_msgs/msg/Twist",
        "std_msgs/msg/Header",
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        "geometry_msgs/msg/PoseStamped",
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/BatteryState",
        "sensor_msgs/msg/LaserScan",
        "sensor_msgs/msg/CompressedImage",
        "nav_msgs/msg/Odometry",
    ]


# A sample from each package: moving a row breaks clients that use its number.
@pytest.mark.parametrize(
    ("number", "name"),
    [
        (10, "actionlib_msgs/msg/GoalID"),
        (13, "diagnostic_msgs/msg/DiagnosticArray"),
        (37, "geometry_msgs/msg/TwistStamped"),
        (49, "nav_msgs/msg/Path"),
        (54, "sensor_msgs/msg/Imu"),
        (73, "shape_msgs/msg/Mesh"),
        (77, "std_msgs/msg/Bool"),
        (105, "stereo_msgs/msg/DisparityImage"),
        (106, "trajectory_msgs/msg/JointTrajectory"),
        (117, "visualization_msgs/msg/Marker"),
        (122, "builtin_interfaces/msg/Time"),
        (123, "builtin_interfaces/msg/Duration"),
        (124, "rcl_interfaces/msg/Log"),
        (125, "rosgraph_msgs/msg/Clock"),
    ],
)
def test_a_number_never_changes(table, number, name):
    assert table.by_number[number].name == name


def test_the_table_has_every_message_of_common_interfaces(table):
    assert set(InstalledDefinitions().names(COMMON_INTERFACES)) <= table.by_name.keys()


def test_the_table_has_every_type_that_its_types_nest(table):
    closure = InstalledDefinitions().closure(table.by_name)

    assert {definition.name for definition in closure} == table.by_name.keys()


def test_every_row_goes_both_ways_and_says_what_it_is_for(table):
    assert {row.directions for row in table.rows} == {"both"}
    assert all(row.purpose[0].isupper() and row.purpose[-1] != "." for row in table.rows)


def test_the_table_has_every_service_of_common_interfaces(table):
    names = {row.name for row in table.interfaces}

    assert set(InstalledDefinitions().names([*COMMON_INTERFACES, "std_srvs"], kind="srv")) <= names


def test_every_service_says_what_it_is_for(table):
    assert table.interfaces
    assert all(row.purpose[0].isupper() and row.purpose[-1] != "." for row in table.interfaces)


@pytest.mark.parametrize("form", ["geometry_msgs/Twist", "geometry_msgs/msg/Twist", 1, "1", "01"])
def test_a_type_is_resolved_in_every_form(table, form):
    assert resolve_type(form, table) == "geometry_msgs/msg/Twist"


def test_a_type_outside_the_table_is_resolved_too(table):
    assert resolve_type("my_msgs/Thing", table) == "my_msgs/msg/Thing"


@pytest.mark.parametrize(
    "name",
    [
        "test_msgs/action/Fibonacci_FeedbackMessage",
        "test_msgs/action/Fibonacci_SendGoal_Event",
        "test_msgs/action/Fibonacci_GetResult_Event",
        "std_srvs/srv/SetBool_Event",
    ],
)
def test_topics_of_actions_and_services_have_message_types(table, name):
    assert resolve_type(name, table) == name
    for other in (name.replace("_Event", "_Request"), name.rpartition("_")[0]):
        if other != name:
            with pytest.raises(TypeNameError):
                resolve_type(other, table)


@pytest.mark.parametrize(
    "form",
    [
        "",
        "Twist",
        "geometry_msgs",
        "geometry_msgs/srv/Twist/",
        "geometry_msgs/msg/Twist/",
        "geometry_msgs/msg/Twist\n",
        "/geometry_msgs/Twist",
        "../msg/Twist",
        "-1",
        "1.0",
        "٣",
        "9" * 5000,
        True,
    ],
)
def test_an_invalid_type_is_refused_with_the_valid_forms(table, form):
    with pytest.raises(TypeNameError, match="expected pkg/msg/Name, pkg/Name or a table"):
        resolve_type(form, table)


@pytest.mark.parametrize("kind", ["srv", "action"])
def test_a_service_or_an_action_is_resolved_in_every_form(kind):
    assert resolve_interface("some_msgs/Thing", kind) == f"some_msgs/{kind}/Thing"
    assert resolve_interface(f"some_msgs/{kind}/Thing", kind) == f"some_msgs/{kind}/Thing"


@pytest.mark.parametrize(
    ("kind", "form"),
    [
        *(("srv", form) for form in ("", "1", "SetBool", "std_srvs/message/SetBool")),
        *(("srv", f"std_srvs/srv/SetBool{end}") for end in ("_Request", "\n")),
        ("srv", "../srv/SetBool"),
        ("action", "SetBool"),
    ],
)
def test_an_invalid_service_or_action_type_is_refused_with_the_valid_forms(kind, form):
    noun = "service" if kind == "srv" else "action"
    words = f"not a valid {noun} type: expected pkg/{kind}/Name or pkg/"
    with pytest.raises(TypeNameError, match=words):
        resolve_interface(form, kind)


def test_the_name_of_another_kind_is_refused_as_such(table):
    with pytest.raises(TypeNameError, match="is a service type, not a message type"):
        resolve_type("std_srvs/srv/SetBool", table)
    with pytest.raises(TypeNameError, match="is an action type, not a service type"):
        resolve_interface("test_msgs/action/Fibonacci", "srv")
    with pytest.raises(TypeNameError, match="is a message type, not an action type"):
        resolve_interface("std_msgs/msg/String", "action")


def test_a_refusal_has_what_is_needed_for_a_guess(table):
    with pytest.raises(TypeNameError) as message:
        resolve_type("twist", table)
    with pytest.raises(TypeNameError) as service:
        resolve_interface("set_bool", "srv")
    with pytest.raises(TypeNameError) as number:
        resolve_type(4711, table)
    refusals = [(each.value.requested, each.value.kind) for each in (message, service, number)]
    assert refusals == [("twist", "msg"), ("set_bool", "srv"), ("", "msg")]


@pytest.mark.parametrize(
    ("form", "name"),
    [
        ("a/srv/B", "a/srv/B"),
        ("a/action/B", "a/action/B"),
        ("a/msg/B", "a/msg/B"),
        ("a/Message", "a/msg/Message"),
        ("a/Service", "a/srv/Service"),
        ("a/Action", "a/action/Action"),
        ("a/All", "a/msg/All"),
        ("a/None", "a/msg/None"),
        (1, "geometry_msgs/msg/Twist"),
        ("1", "geometry_msgs/msg/Twist"),
    ],
)
def test_a_name_without_kind_is_a_message_unless_only_a_service_or_an_action_has_it(
    table, form, name
):
    known = {"a/msg/Message", "a/srv/Service", "a/action/Action", "a/msg/All", "a/srv/All"}
    assert resolve_any(form, table, known) == name


@pytest.mark.parametrize("form", ["", "a", "a/srv/b", "a/foo/B", 99999, "a/srv/action/B"])
def test_a_name_that_is_not_a_type_of_any_kind_is_refused(table, form):
    with pytest.raises(TypeNameError):
        resolve_any(form, table, {})


@pytest.mark.parametrize("number", [99999, "99999", -1])
def test_a_number_without_row_is_refused_by_name(table, number):
    with pytest.raises(TypeNameError, match=f"the message table has no number {number}"):
        resolve_type(number, table)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("messages = [", "messages.toml: "),
        ("", "messages: Input should be a valid list"),
        ("messages = [{}]", r"messages\[0\]\[number\]: Field required"),
        (f"messages = [{row(-1, 'a/msg/B')}]", r"messages\[0\]\[number\]: "),
        (f"messages = [{row(0, 'a/B')}]", r"messages\[0\]\[name\]: "),
        (f"messages = [{row(0, 'a/msg/B')}, {row(0, 'a/msg/C')}]", "number 0 has two rows"),
        (f"messages = [{row(0, 'a/msg/B')}, {row(1, 'a/msg/B')}]", "a/msg/B has two rows"),
        ("messages = []\ninterfaces = 1", "interfaces: Input should be a valid list"),
        ("messages = []\ninterfaces = [{}]", r"interfaces\[0\]\[name\]: Field required"),
        (
            'messages = []\ninterfaces = [{ name = "a/msg/B", purpose = "x" }]',
            r"interfaces\[0\]\[name\]: ",
        ),
        (
            f"messages = []\ninterfaces = [{SERVICE_ROW}, {SERVICE_ROW}]",
            "a/srv/B has two rows",
        ),
    ],
)
def test_a_malformed_table_raises_table_error_with_the_reason(tmp_path, text, reason):
    with pytest.raises(TableError, match=reason):
        load(tmp_path, text)

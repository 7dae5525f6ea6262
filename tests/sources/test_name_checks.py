# SPDX-License-Identifier: Apache-2.0
"""Names that ROS would bend never get there."""

from collections.abc import Callable

import pytest

from gateway.sources.name_checks import (
    MAX_ACTION_CHARACTERS,
    MAX_TOPIC_CHARACTERS,
    check_action,
    check_service,
    check_topic,
    split_type,
)
from gateway.sources.source import RosError


@pytest.mark.parametrize("topic", ["/a", "/odom", "/_hidden", "/robot1/camera/image_raw", "/A__b"])
def test_fully_qualified_names_pass(topic: str) -> None:
    check_topic(topic)


def test_a_name_may_be_as_long_as_rmw_takes() -> None:
    check_topic("/" + "a" * (MAX_TOPIC_CHARACTERS - 1))
    with pytest.raises(RosError, match="topic name has 248 characters, at most 247"):
        check_topic("/" + "a" * MAX_TOPIC_CHARACTERS)


def test_an_action_leaves_room_for_the_names_of_its_parts() -> None:
    check_action("/" + "a" * (MAX_ACTION_CHARACTERS - 1))
    with pytest.raises(RosError, match="action name has 228 characters, at most 227"):
        check_action("/" + "a" * MAX_ACTION_CHARACTERS)


@pytest.mark.parametrize(
    ("check", "words"),
    [
        (check_topic, "topic name such as /odom"),
        (check_service, "service name such as /reset"),
        (check_action, "action name such as /dock"),
    ],
)
def test_a_refusal_says_what_a_name_looks_like(check: Callable[[str], None], words: str) -> None:
    with pytest.raises(RosError, match=f"'a/' is not a fully qualified {words}"):
        check("a/")


@pytest.mark.parametrize("name", ["/a b", "/a\n", "/a/", "/a\0b", "/a-b", "/1a", "/ä", ""])
@pytest.mark.parametrize("check", [check_topic, check_service, check_action])
def test_nothing_else_stands_in_a_name(check: Callable[[str], None], name: str) -> None:
    with pytest.raises(RosError, match="is not a fully qualified"):
        check(name)


def test_a_type_name_is_split() -> None:
    assert split_type("std_msgs/msg/String") == ("std_msgs", "String")
    assert split_type("std_srvs/srv/SetBool", "srv") == ("std_srvs", "SetBool")
    assert split_type("test_msgs/action/Fibonacci", "action") == ("test_msgs", "Fibonacci")


def test_a_type_of_another_kind_is_refused() -> None:
    with pytest.raises(RosError, match="is not a valid service type name: expected pkg/srv/Name"):
        split_type("std_msgs/msg/String", "srv")
    with pytest.raises(RosError, match="is not a valid message type name: expected pkg/msg/Name"):
        split_type("std_srvs/srv/SetBool")


@pytest.mark.parametrize("name", ["std_msgs/String", "a/msg/b", "../msg/String", "a.b/msg/C", ""])
def test_an_invalid_type_name_is_refused(name: str) -> None:
    with pytest.raises(RosError, match="is not a valid message type name") as caught:
        split_type(name)
    assert caught.value.code == "bad_type"

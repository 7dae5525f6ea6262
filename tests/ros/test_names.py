# SPDX-License-Identifier: Apache-2.0
"""Names that ROS would bend never get there."""

import pytest

from gateway.ports import RosError
from gateway.ros.names import MAX_TOPIC_CHARACTERS, check_topic, split_type


@pytest.mark.parametrize("topic", ["/a", "/odom", "/_hidden", "/robot1/camera/image_raw", "/A__b"])
def test_fully_qualified_names_pass(topic: str) -> None:
    check_topic(topic)


def test_a_name_may_be_as_long_as_rmw_takes() -> None:
    check_topic("/" + "a" * (MAX_TOPIC_CHARACTERS - 1))
    with pytest.raises(RosError, match="topic name has 248 characters, at most 247"):
        check_topic("/" + "a" * MAX_TOPIC_CHARACTERS)


def test_a_type_name_is_split() -> None:
    assert split_type("std_msgs/msg/String") == ("std_msgs", "String")


@pytest.mark.parametrize("name", ["std_msgs/String", "a/msg/b", "../msg/String", "a.b/msg/C", ""])
def test_what_is_no_type_name_is_refused(name: str) -> None:
    with pytest.raises(RosError, match="is no message type name") as caught:
        split_type(name)
    assert caught.value.code == "bad_type"

# SPDX-License-Identifier: Apache-2.0
"""From type names to generated classes, and to nothing else."""

import sys

import pytest

from gateway.sources.rclpy.interfaces import action_class, message_class, service_class
from gateway.sources.source import RosError


def test_a_message_type_gives_its_class() -> None:
    from std_msgs.msg import String

    assert message_class("std_msgs/msg/String") is String


def test_a_service_and_an_action_type_give_their_classes() -> None:
    from std_srvs.srv import SetBool
    from test_msgs.action import Fibonacci

    assert service_class("std_srvs/srv/SetBool") is SetBool
    assert action_class("test_msgs/action/Fibonacci") is Fibonacci


def test_a_package_without_a_kind_is_a_bad_type() -> None:
    with pytest.raises(RosError, match="no ROS package std_srvs is installed here") as caught:
        message_class("std_srvs/msg/SetBool")
    assert caught.value.code == "bad_type"
    with pytest.raises(RosError, match="test_msgs has no Nothing"):
        action_class("test_msgs/action/Nothing")


def test_a_missing_message_names_type_and_package() -> None:
    with pytest.raises(RosError, match="has geometry_msgs/msg/Foo; geometry_msgs has no Foo"):
        message_class("geometry_msgs/msg/Foo")


@pytest.mark.parametrize(
    ("find", "kind"), [(message_class, "msg"), (service_class, "srv"), (action_class, "action")]
)
def test_a_package_that_is_not_a_ros_package_is_not_imported(tmp_path, monkeypatch, find, kind):
    for folder in (tmp_path / "innocent", tmp_path / "innocent" / kind):
        folder.mkdir()
        (folder / "__init__.py").write_text("raise SystemExit('imported')")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(RosError, match="no ROS package innocent is installed here"):
        find(f"innocent/{kind}/Foo")
    assert "innocent" not in sys.modules


def test_a_broken_ros_package_is_a_bad_type(tmp_path, monkeypatch):
    package = tmp_path / "broken_msgs"
    (package / "msg").mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "broken_msgs_s__rosidl_typesupport_c.so").touch()
    (package / "msg" / "__init__.py").write_text("import nothing_of_this_name")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(RosError, match="package broken_msgs cannot be imported"):
        message_class("broken_msgs/msg/Foo")

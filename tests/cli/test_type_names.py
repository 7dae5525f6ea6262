# SPDX-License-Identifier: Apache-2.0
"""The types that commands take, and patterns of them."""

import pytest

from gateway.cli.type_names import TypeNames, is_pattern, matching
from gateway.errors import UsageError
from schemas.installed import InstalledDefinitions

NAMES = ["a_msgs/msg/A", "a_msgs/srv/A", "b_msgs/action/B", "b_msgs/msg/B"]


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ("*", NAMES),
        ("a_msgs/*", NAMES[:2]),
        ("a_msgs/srv/*", NAMES[1:2]),
        ("b_msgs/action/*", NAMES[2:3]),
    ],
)
def test_a_pattern_stands_for_a_package_or_a_kind_of_it(pattern, found):
    assert is_pattern(pattern)
    assert matching(pattern, NAMES) == found


@pytest.mark.parametrize(
    "text", ["a_msgs/A*", "a*/msg/A", "a_msgs/idl/*", "**", "/a/*", "a_msgs/*\n"]
)
def test_another_text_is_not_a_pattern(text):
    assert not is_pattern(text)


@pytest.mark.parametrize(
    ("pattern", "hint"),
    [
        ("a_msg/*", ", did you mean a_msgs/*"),
        ("a_msgs/action/*", ", did you mean b_msgs/*"),
        ("zzz/*", ""),
    ],
)
def test_a_pattern_without_types_is_refused_with_a_package(pattern, hint):
    with pytest.raises(UsageError) as refused:
        matching(pattern, NAMES)
    assert str(refused.value) == f"no known type fits {pattern}{hint}"


def test_a_known_name_has_no_nearer_one():
    names = TypeNames(InstalledDefinitions())
    assert names.nearest("std_msgs/msg/String") is None
    assert names.nearest("std_msgs/msg/Strng") == "std_msgs/msg/String"
    assert names.resolve("1") == "geometry_msgs/msg/Twist"

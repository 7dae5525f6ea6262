# SPDX-License-Identifier: Apache-2.0
"""The mock system publishes every type and writes down what arrives."""

import json
import math
from select import select

import pytest
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Joy
from std_msgs.msg import String

from gateway.errors import ConfigError
from gateway_sim.instances import message_class
from gateway_sim.mock import MockOptions, run, topic_of
from schemas.table import Table
from tests.gateway_sim.ros import Watcher, child

MOCK = """
from gateway_sim.mock import MockOptions, run
raise SystemExit(run(MockOptions({options})))
"""


@pytest.fixture
def watcher():
    watcher = Watcher("mock_watcher")
    yield watcher
    watcher.close()


@pytest.mark.parametrize(
    ("name", "topic"),
    [
        ("std_msgs/msg/String", "/mock/std_msgs/string"),
        (
            "geometry_msgs/msg/PoseWithCovarianceStamped",
            "/mock/geometry_msgs/pose_with_covariance_stamped",
        ),
        ("std_msgs/msg/UInt8MultiArray", "/mock/std_msgs/u_int8_multi_array"),
        ("actionlib_msgs/msg/GoalID", "/mock/actionlib_msgs/goal_id"),
        ("sensor_msgs/msg/PointCloud2", "/mock/sensor_msgs/point_cloud2"),
        ("std_msgs/msg/ColorRGBA", "/mock/std_msgs/color_rgba"),
    ],
)
def test_a_topic_is_named_after_its_type(name, topic):
    assert topic_of(name, "/mock") == topic


def test_every_type_has_a_separate_topic():
    names = MockOptions().type_names()
    assert names == tuple(row.name for row in Table.load().rows)
    assert len({topic_of(name, "/mock") for name in names}) == len(names)


def test_types_are_chosen_by_name_or_number():
    options = MockOptions(types=(0, "9", "geometry_msgs/Twist", "std_msgs/msg/String"))
    assert options.type_names() == (
        "std_msgs/msg/String",
        "nav_msgs/msg/Odometry",
        "geometry_msgs/msg/Twist",
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rate_hz": 0}, "rate_hz 0 is not above 0"),
        ({"rate_hz": math.nan}, "rate_hz nan"),
        ({"rate_hz": 1000.1}, "up to 1000 Hz"),
        ({"types": (9999,)}, "no number 9999"),
        ({"types": ("nonsense",)}, "'nonsense' is not a valid message type"),
    ],
)
def test_wrong_options_are_refused_in_words(options, words):
    with pytest.raises(ConfigError, match=words):
        MockOptions(**options)


def test_every_type_of_the_table_is_published(watcher):
    with child(MOCK.format(options="rate_hz=2, listen=False")):
        names = MockOptions().type_names()
        for name in names:
            watcher.subscribe(message_class(name), topic_of(name, "/mock"))
        watcher.until(lambda: all(watcher.received.values()), what="a message of each type")


def test_messages_count_up_without_a_gap(watcher):
    # Reliable DDS keeps the last 10: at 1 Hz, a busy machine may hold either process up for 10 s.
    with child(MOCK.format(options="rate_hz=1, types=(0,), listen=False")):
        strings = watcher.subscribe(String, "/mock/std_msgs/string")
        watcher.until(lambda: len(strings) >= 5, what="5 strings")
        # Fast DDS may deliver one while it still matches the two, and skip the next.
        numbers = [int(each.data.removeprefix("String ")) for each in strings[1:]]
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


def test_each_message_is_written_as_one_line(watcher):
    with child(MOCK.format(options="publish=False, types=('sensor_msgs/Joy', 0)")) as mock:
        topic = "/mock_in/sensor_msgs/joy"
        publisher = watcher.node.create_publisher(Joy, topic, QoSProfile(depth=10))
        message = Joy(axes=[1.0, 0.5], buttons=[3])
        watcher.until(
            lambda: select([mock.stdout], [], [], 0)[0],
            lambda: publisher.publish(message),
            "a line",
        )
        line = mock.stdout.readline().decode()
        # the mock system's own messages are not there: it was told not to publish
        topics = [name for name, _ in watcher.node.get_topic_names_and_types()]
        assert not [name for name in topics if name.startswith("/mock/")]
    assert line == (
        f"{topic} sensor_msgs/msg/Joy {{header: {{stamp: {{sec: 0, nanosec: 0}}, "
        f"frame_id: {json.dumps('')}}}, axes: [1, 0.5], buttons: [3]}}\n"
    )


NOT_INSTALLED = """
from gateway_sim import mock
find = mock.message_class
def message_class(name):
    if name == "std_msgs/msg/Bool":
        raise ImportError("no module of that name")
    return find(name)
mock.message_class = message_class
"""


def test_a_type_that_is_not_installed_is_left_out(watcher):
    with child(NOT_INSTALLED + MOCK.format(options="rate_hz=20")):
        strings = watcher.subscribe(String, "/mock/std_msgs/string")
        watcher.until(lambda: strings, what="a type that is installed")
        topics = [name for name, _ in watcher.node.get_topic_names_and_types()]
        assert "/mock/std_msgs/bool" not in topics


def test_a_type_that_is_asked_for_by_name_must_be_installed():
    options = MockOptions(types=("no_such_msgs/Thing", 0, "std_msgs/Thing"))
    with pytest.raises(ConfigError) as caught:
        run(options)
    assert caught.value.problems == (
        "no_such_msgs/msg/Thing is not installed: No module named 'no_such_msgs'",
        "std_msgs/msg/Thing is not installed: package std_msgs has no message Thing",
    )
